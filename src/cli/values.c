/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of convert, compare and view hold: bits, or numbers, which become bits only by a threshold.
 */
#include "cli/values.h"

#include <inttypes.h>
#include <string.h>

int cli_take_threshold(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_threshold_options *threshold = member;
  bool is_below = strcmp(option->name, "below") == 0;
  if (!cli_read_number(is_below ? &threshold->below : &threshold->at_least, value))
    return cli_usage(cli, "--%s '%s' is not a number", option->name, value);
  *(is_below ? &threshold->use_below : &threshold->use_at_least) = true;
  return CLI_END;
}

bool cli_threshold_given(const vxm_threshold_options *threshold) {
  return threshold->use_at_least || threshold->use_below;
}

vxm_status cli_values_read(cli_run *cli, cli_values *out, const char *path) {
  vxm_status status = vxm_grid_or_field_read(&out->grid, &out->field, cli->context, path, &cli->error);
  if (status == VXM_OK && out->grid)
    cli_warn_grid(cli, path, out->grid);
  for (int64_t i = 0; status == VXM_OK && out->field && i < vxm_field_warning_count(out->field); i++)
    cli_warn(cli, "%s: %s", cli_shown(path, "<stdin>"), vxm_field_warning(out->field, i));
  return status;
}

void cli_values_free(cli_values *values) {
  vxm_grid_destroy(values->grid);
  vxm_field_destroy(values->field);
  *values = (cli_values){NULL, NULL};
}

const vxm_space *cli_values_space(const cli_values *values) {
  return values->grid ? vxm_grid_space(values->grid) : vxm_field_space(values->field);
}

void cli_values_text(char text[128], const vxm_field *field) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_kind kind = vxm_field_kind_of(field);
  if (kind == VXM_FIELD_COLORS) {
    snprintf(text, 128, "colours, red, green, blue and opacity, %s",
             vxm_scalar_name(vxm_field_scalar(field)));
    return;
  }
  vxm_field_measure(&range, field, NULL);
  snprintf(text, 128, "%s%s%s from %.6g to %.6g", kind == VXM_FIELD_NUMBERS ? "" : vxm_field_kind_name(kind),
           kind == VXM_FIELD_NUMBERS ? "" : ", ", vxm_scalar_name(vxm_field_scalar(field)), range.min,
           range.max);
}

static int refuse(cli_run *cli, const vxm_field *field, const char *path, const char *why) {
  char text[128];
  cli_values_text(text, field);
  return cli_fail_text(cli,
                       "%s: it holds numbers (%s), but %s: choose --threshold T (set where T or greater) or "
                       "--below T (set where less)",
                       cli_shown(path, "<stdin>"), text, why);
}

int cli_values_to_bits(cli_run *cli, cli_values *values, const vxm_threshold_options *threshold,
                       const char *path, const char *why) {
  vxm_threshold_options used = *threshold;
  bool is_given = cli_threshold_given(threshold);
  if (values->grid)
    return CLI_DONE;
  if (!is_given && !vxm_field_is_mask(values->field))
    return refuse(cli, values->field, path, why);
  if (!is_given) {
    used.use_at_least = true;
    used.at_least = 1;
  }
  vxm_grid *grid;
  if (vxm_field_threshold(&grid, values->field, &used, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_grid(cli, path, grid);
  cli_values_free(values);
  values->grid = grid;
  return CLI_DONE;
}

int cli_bits_read(cli_run *cli, vxm_grid **out, const vxm_threshold_options *threshold, const char *path,
                  const char *why) {
  cli_values values = {NULL, NULL};
  if (cli_values_read(cli, &values, path) != VXM_OK)
    return cli_fail(cli);
  if (cli_values_to_bits(cli, &values, threshold, path, why) != CLI_DONE) {
    cli_values_free(&values);
    return CLI_FAILED;
  }
  *out = values.grid;
  return CLI_DONE;
}

/** By way of a grid where numbers become bits, and of standard input, which cannot be read again. */
int cli_sparse_read(cli_run *cli, vxm_sparse **out, const vxm_threshold_options *threshold, const char *path,
                    const char *why) {
  vxm_status status = VXM_ERROR_NUMBERS;
  if (strcmp(path, "-") != 0 && !cli_threshold_given(threshold))
    status = vxm_sparse_read(out, cli->context, path, &cli->error);
  for (int64_t i = 0; i < vxm_sparse_warning_count(*out); i++)
    cli_warn(cli, "%s: %s", path, vxm_sparse_warning(*out, i));
  if (status != VXM_ERROR_NUMBERS)
    return status == VXM_OK ? CLI_DONE : cli_fail(cli);
  cli->error = (vxm_error)VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  int result = cli_bits_read(cli, &grid, threshold, path, why);
  if (result == CLI_DONE && vxm_sparse_from_grid(out, grid, &cli->error) != VXM_OK)
    result = cli_fail(cli);
  vxm_grid_destroy(grid);
  return result;
}

void cli_values_row(const cli_run *cli, const cli_values *values) {
  char text[128];
  if (values->grid) {
    cli_row(cli, "voxels", "%" PRId64, vxm_grid_count(values->grid));
    return;
  }
  cli_values_text(text, values->field);
  cli_row(cli, "values", "%s", text);
}

void cli_values_json(json_t *report, const cli_values *values, bool has_hash) {
  if (values->grid) {
    json_object_set_new(report, "voxels", json_integer(vxm_grid_count(values->grid)));
    if (has_hash)
      json_object_set_new(report, "hash", cli_json_hash(vxm_grid_hash(values->grid)));
    return;
  }
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_measure(&range, values->field, NULL);
  json_t *object = json_object();
  json_object_set_new(object, "kind", json_string(vxm_field_kind_name(vxm_field_kind_of(values->field))));
  json_object_set_new(object, "type", json_string(vxm_scalar_name(vxm_field_scalar(values->field))));
  json_object_set_new(object, "min", cli_json_number(range.min));
  json_object_set_new(object, "max", cli_json_number(range.max));
  json_object_set_new(object, "not_numbers", json_integer(range.not_numbers));
  json_object_set_new(report, "values", object);
}
