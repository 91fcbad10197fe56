/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend combine with values: what is read, what goes together, and files of octrees. */
#include "cli/combine.h"
#include "cli/values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- Operands ---- */

void combine_free(combine_operand *operand) {
  vxm_grid_destroy(operand->grid);
  vxm_sparse_destroy(operand->sparse);
  vxm_field_destroy(operand->field);
  *operand = (combine_operand){NULL, NULL, NULL};
}

const vxm_space *combine_space(const combine_operand *operand) {
  return operand->sparse  ? vxm_sparse_space(operand->sparse)
         : operand->field ? vxm_field_space(operand->field)
                          : vxm_grid_space(operand->grid);
}

/** An octree as it is; `*out` stays NULL where the file holds numbers, or is none that can be read so. */
static int read_octree(cli_run *cli, vxm_sparse **out, const combine_request *given, const char *path) {
  if (!given->sparse || strcmp(path, "-") == 0 || cli_threshold_given(&given->threshold))
    return CLI_DONE;
  vxm_status status = vxm_sparse_read(out, cli->context, path, &cli->error);
  for (int64_t i = 0; i < vxm_sparse_warning_count(*out); i++)
    cli_warn(cli, "%s: %s", path, vxm_sparse_warning(*out, i));
  if (status != VXM_OK && status != VXM_ERROR_NUMBERS)
    return cli_fail(cli);
  cli->error = (vxm_error)VXM_ERROR_INIT;
  return CLI_DONE;
}

int combine_read(cli_run *cli, combine_operand *out, const combine_request *given, const char *path,
                 const combine_operand *with) {
  static const char why[] = "only set and clear voxels can be combined";
  int result = read_octree(cli, &out->sparse, given, path);
  if (result != CLI_DONE || (out->sparse && !(with && with->field)))
    return result;
  cli_values values = {NULL, NULL};
  if (!out->sparse && cli_values_read(cli, &values, path) != VXM_OK)
    return cli_fail(cli);
  bool is_mask =
      values.field && vxm_field_kind_of(values.field) == VXM_FIELD_NUMBERS &&
      vxm_field_is_mask(values.field); /* labels and shares stay what they are, whatever they are */
  bool is_bits = !values.field || cli_threshold_given(&given->threshold) || is_mask;
  if (with && with->field && is_bits) {
    char text[128];
    cli_values_text(text, with->field);
    cli_values_free(&values);
    return cli_fail_text(
        cli,
        "%s: it holds set and clear voxels, and what is before values (%s): only values of one "
        "kind go together; --threshold T or --below T makes set and clear voxels of them",
        cli_shown(path, "<stdin>"), text);
  }
  if (is_bits || (with && !with->field))
    result = cli_values_to_bits(cli, &values, &given->threshold, path, why);
  out->grid = values.grid;
  out->field = values.field;
  if (result == CLI_DONE && out->grid && given->sparse) {
    if (vxm_sparse_from_grid(&out->sparse, out->grid, &cli->error) != VXM_OK)
      result = cli_fail(cli);
    vxm_grid_destroy(out->grid);
    out->grid = NULL;
  }
  return result;
}

/* ---- Labels ---- */

/** An object with the number of each label name: the lowest where several labels share it. Labels without a
 * name are left out. */
static json_t *numbers_of(const vxm_field *field) {
  json_t *numbers = json_object();
  for (int64_t label = vxm_field_label_count(field); label > 0; label--)
    if (*vxm_field_label_name(field, label))
      json_object_set_new(numbers, vxm_field_label_name(field, label), json_integer(label));
  return numbers;
}

void combine_note_labels(json_t *renumbered, const char *path, const vxm_field *from, int64_t named,
                         vxm_set_operation operation, const vxm_field *result) {
  if (named == 0 || (operation != VXM_SET_UNION && operation != VXM_SET_SYMMETRIC_DIFFERENCE))
    return; /* labels of one number are one, or none of these comes into the result */
  json_t *numbers = numbers_of(result);
  for (int64_t label = 1; label <= vxm_field_label_count(from); label++) {
    const char *name = vxm_field_label_name(from, label);
    const json_t *number = json_object_get(numbers, name);
    if (!number || json_integer_value(number) == label)
      continue;
    json_t *entry = json_object();
    json_object_set_new(entry, "input", cli_json_text(path));
    json_object_set_new(entry, "name", cli_json_text(name));
    json_object_set_new(entry, "label", json_integer(label));
    json_object_set_new(entry, "becomes", json_integer(json_integer_value(number)));
    json_array_append_new(renumbered, entry);
  }
  json_decref(numbers);
}

/** The table of a field. */
static json_t *table_of(const vxm_field *field) {
  json_t *table = json_array();
  for (int64_t label = 1; label <= vxm_field_label_count(field); label++) {
    json_t *entry = json_object();
    json_object_set_new(entry, "label", json_integer(label));
    json_object_set_new(entry, "name", cli_json_text(vxm_field_label_name(field, label)));
    json_array_append_new(table, entry);
  }
  return table;
}

/** Rows of the first labels that have another number; of all with --verbose. */
static void tell_renumbered(const cli_run *cli, const json_t *renumbered) {
  enum { SHOWN = 12 };
  size_t count = json_array_size(renumbered), shown = cli->verbose || count <= SHOWN ? count : SHOWN;
  for (size_t i = 0; i < shown; i++) {
    const json_t *entry = json_array_get(renumbered, i);
    cli_row(cli, i == 0 ? "renumbered" : "",
            "%s: label %" JSON_INTEGER_FORMAT ", \"%s\", becomes %" JSON_INTEGER_FORMAT,
            json_string_value(json_object_get(entry, "input")),
            json_integer_value(json_object_get(entry, "label")),
            json_string_value(json_object_get(entry, "name")),
            json_integer_value(json_object_get(entry, "becomes")));
  }
  if (shown < count)
    cli_row(cli, "", "... and %zu more (-v shows all)", count - shown);
}

/** Completes the report of values with their labels, and ends the run. @param names a field with the table of
 * labels */
static int finish(cli_run *cli, const combine_request *given, const vxm_field *names, json_t *report,
                  const json_t *renumbered) {
  if (vxm_field_kind_of(names) == VXM_FIELD_LABELS) {
    json_object_set_new(report, "labels", table_of(names));
    json_object_set(report, "renumbered", (json_t *)renumbered);
  }
  json_object_set(report, "warnings", cli->warnings);
  if (cli_summary(cli)) {
    if (vxm_field_label_count(names) > 0)
      cli_row(cli, "labels", "%" PRId64, vxm_field_label_count(names));
    tell_renumbered(cli, renumbered);
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
  }
  return cli_finish(cli, report);
}

int combine_write_field(cli_run *cli, const combine_request *given, const vxm_field *field, json_t *report,
                        const json_t *renumbered) {
  const cli_values values = {NULL, (vxm_field *)field};
  if (vxm_field_write(field, given->output, &given->write, &cli->error) != VXM_OK) {
    json_decref(report);
    return cli_fail(cli);
  }
  cli_progress_clear(cli);
  cli_warn_lattice(cli, given->output, given->write.format, vxm_field_space(field));
  json_object_set_new(report, "grid", cli_json_space(vxm_field_space(field)));
  cli_values_json(report, &values, false);
  if (cli_summary(cli)) {
    cli_rows_space(cli, vxm_field_space(field));
    cli_values_row(cli, &values);
  }
  return finish(cli, given, field, report, renumbered);
}

/* ---- Octree files ---- */

bool combine_are_octrees(const cli_run *cli, const combine_request *given) {
  bool yes = strcmp(given->write.format, "octree") == 0 && strcmp(given->output, "-") != 0 &&
             !cli_threshold_given(&given->threshold);
  for (int i = 0; i < cli->argument_count; i++)
    yes = yes && cli_is_extension(cli->arguments[i], "octree");
  return yes;
}

/** A field of one voxel, for what the file says of its values. */
static vxm_status read_names(vxm_field **out, const vxm_sparse_file *file, vxm_error *error) {
  static const int64_t begin[3] = {0, 0, 0}, end[3] = {1, 1, 1};
  return vxm_sparse_file_field(out, file, begin, end, error);
}

/** Opens all; `*with_values` are those that have some. */
static int open_files(cli_run *cli, vxm_sparse_file **files, int *with_values) {
  const char *first = cli->arguments[0];
  *with_values = 0;
  for (int i = 0; i < cli->argument_count; i++) {
    if (vxm_sparse_file_open(&files[i], cli->context, cli->arguments[i], &cli->error) != VXM_OK)
      return cli_fail(cli);
    *with_values += vxm_sparse_file_has_values(files[i]);
    const char *paths[2] = {first, cli->arguments[i]};
    if (*with_values > 0 && i > 0 &&
        combine_check_spaces(cli, vxm_sparse_file_space(files[0]), vxm_sparse_file_space(files[i]), paths) !=
            CLI_DONE)
      return CLI_FAILED;
  }
  return CLI_DONE;
}

/** What the result says of its values, in a field of one voxel. */
static int make_names(cli_run *cli, vxm_field **out, vxm_sparse_file **files,
                      const vxm_set_operation *operations, json_t *renumbered) {
  vxm_status status = read_names(out, files[0], &cli->error);
  for (int i = 1; i < cli->argument_count && status == VXM_OK; i++) {
    vxm_field *own = NULL, *both = NULL;
    status = read_names(&own, files[i], &cli->error);
    if (status == VXM_OK)
      status = vxm_field_combine(&both, *out, own, operations[i - 1], &cli->error);
    if (status == VXM_OK) {
      combine_note_labels(renumbered, cli->arguments[i], own, vxm_field_label_count(*out), operations[i - 1],
                          both);
      vxm_field_destroy(*out);
      *out = both;
    }
    vxm_field_destroy(own);
  }
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

static int tell_file(cli_run *cli, const combine_request *given, const vxm_space *space,
                     const vxm_field *names, json_t *report, const json_t *renumbered) {
  vxm_field_kind kind = vxm_field_kind_of(names);
  json_t *values = json_object();
  json_object_set_new(values, "kind", json_string(vxm_field_kind_name(kind)));
  json_object_set_new(values, "type", json_string(vxm_scalar_name(vxm_field_scalar(names))));
  json_object_set_new(report, "grid", cli_json_space(space));
  json_object_set_new(report, "values", values);
  cli_progress_clear(cli);
  cli_warn_lattice(cli, given->output, given->write.format, space);
  if (cli_summary(cli)) {
    cli_rows_space(cli, space);
    cli_row(cli, "values", "%s%s%s", kind == VXM_FIELD_NUMBERS ? "" : vxm_field_kind_name(kind),
            kind == VXM_FIELD_NUMBERS ? "" : ", ", vxm_scalar_name(vxm_field_scalar(names)));
  }
  return finish(cli, given, names, report, renumbered);
}

int combine_files(cli_run *cli, const combine_request *given, const vxm_set_operation *operations,
                  json_t *report, bool *made) {
  int count = cli->argument_count, with_values = 0;
  vxm_field *names = NULL;
  json_t *renumbered = json_array();
  vxm_sparse_file **files = calloc((size_t)count, sizeof *files);
  int result =
      files ? open_files(cli, files, &with_values) : cli_fail_text(cli, "out of memory for the command line");
  *made = result == CLI_DONE && with_values > 0;
  if (*made && with_values == count)
    result = make_names(cli, &names, files, operations, renumbered);
  if (*made && result == CLI_DONE &&
      vxm_sparse_file_combine(given->output, (const vxm_sparse_file *const *)files, count, operations,
                              &cli->error) != VXM_OK)
    result = cli_fail(cli);
  if (*made && result == CLI_DONE)
    result = tell_file(cli, given, vxm_sparse_file_space(files[0]), names, report, renumbered);
  else
    json_decref(report);
  for (int i = 0; files && i < count; i++)
    vxm_sparse_file_close(files[i]);
  free(files);
  vxm_field_destroy(names);
  json_decref(renumbered);
  return result;
}
