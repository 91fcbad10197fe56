/* SPDX-License-Identifier: BSD-3-Clause */
/** A number per voxel instead of a bit: the options, files and reports of coverage, distance, labels and
 * colours. */
#include "cli/field.h"

#include <inttypes.h>
#include <string.h>

cli_formats cli_field_formats(const cli_field *field) {
  cli_formats formats = cli_formats_with(field->color    ? VXM_FORMAT_COLORS
                                         : field->labels ? VXM_FORMAT_LABELS
                                                         : VXM_FORMAT_NUMBERS);
  bool is_float = field->distance || (field->coverage && field->coverage_options.scalar == VXM_FLOAT32);
  return is_float ? cli_formats_without(formats, "png") : formats; /* which holds whole numbers */
}

bool cli_field_wanted(const cli_field *field) {
  return field->coverage || field->distance || field->labels || field->color;
}

/* ---- Options ---- */

const char *const cli_scalars[] = {"float32", "uint8", NULL};
const char *const cli_signs[] = {"signed", "unsigned", NULL};

int cli_take_subdivision(cli_run *cli, const cli_option *option, const char *value, void *member) {
  static const char *const choices[] = {"2", "4", "8", NULL};
  int choice;
  if (cli_choose(cli, &choice, option->name, value, choices) == CLI_STOP)
    return CLI_STOP;
  *(int *)member = 2 << choice;
  return CLI_END;
}

int cli_field_check(cli_run *cli, const cli_field *field, vxm_mode mode, bool is_tried, bool is_sure) {
  const char *name = field->coverage   ? "coverage"
                     : field->distance ? "distance"
                     : field->labels   ? "labels"
                                       : "color";
  if (field->coverage + field->distance + field->labels + field->color > 1)
    return cli_usage(cli, "--coverage, --distance, --labels and --color exclude each other");
  if (cli_is_given(cli, "scalar") && !field->coverage)
    return cli_usage(cli, "--scalar goes with --coverage");
  if (field->color_options.average && !(field->color && field->color_options.by == VXM_COLOR_MESH))
    return cli_usage(cli, "--color-average goes with --color mesh");
  if (cli_is_given(cli, "band") && !field->distance)
    return cli_usage(cli, "--band goes with --distance");
  if (!cli_field_wanted(field))
    return CLI_END;
  if (is_sure)
    return cli_usage(cli, "--confidence is of a grid; leave it out with --%s", name);
  if (is_tried && (field->labels || field->color))
    return cli_usage(cli, "--dry-run tells nothing of %s; leave it out with --%s",
                     field->labels ? "labels" : "colours", name);
  if (field->distance && mode != VXM_MODE_SOLID)
    return cli_usage(cli, "--distance goes with --mode solid, which gives the sign");
  return CLI_END;
}

/* ---- Work ---- */

vxm_status cli_field_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format) {
  vxm_status status;
  field->coverage_options.format = field->distance_options.format = format;
  field->coverage_report.voxelize = field->label_report.voxelize = field->distance_report.voxelize = report;
  if (field->coverage)
    status = vxm_model_write_coverage(&field->coverage_report, model, space, path, &field->coverage_options,
                                      &cli->error);
  else if (field->color)
    status = cli_color_write(cli, field, report, model, space, path, format);
  else if (field->labels) {
    field->label_options.format = format;
    status = cli_labels_write(cli, field, model, space, path);
  } else
    status = vxm_model_write_distance(&field->distance_report, model, space, path, &field->distance_options,
                                      &cli->error);
  return status;
}

vxm_status cli_field_estimate(cli_run *cli, const cli_field *field, vxm_estimate *out, const vxm_model *model,
                              const vxm_space *space, const char *path, const char *format) {
  vxm_coverage_options coverage = field->coverage_options;
  vxm_distance_options distance = field->distance_options;
  coverage.format = distance.format = format;
  if (field->coverage)
    return vxm_model_estimate_coverage(out, model, space, path, &coverage, &cli->error);
  return field->distance ? vxm_model_estimate_distance(out, model, space, path, &distance, &cli->error)
                         : VXM_OK;
}

/* ---- Results ---- */

static json_t *coverage_json(const cli_field *field) {
  const vxm_coverage_report *report = &field->coverage_report;
  json_t *object = json_object();
  json_object_set_new(object, "subdivision", json_integer(field->coverage_options.subdivision));
  json_object_set_new(object, "scalar",
                      json_string(field->coverage_options.scalar == VXM_UINT8 ? "uint8" : "float32"));
  json_object_set_new(object, "full", json_integer(report->full));
  json_object_set_new(object, "partial", json_integer(report->partial));
  json_object_set_new(object, "volume", cli_json_number(report->volume));
  return object;
}

static json_t *distance_json(const cli_field *field) {
  const vxm_distance_report *report = &field->distance_report;
  json_t *object = json_object();
  json_object_set_new(object, "signed", json_boolean(!field->distance_options.is_unsigned));
  json_object_set_new(object, "band", cli_json_number(field->distance_options.band));
  json_object_set_new(object, "exact", json_integer(report->exact));
  json_object_set_new(object, "min", cli_json_number(report->min));
  json_object_set_new(object, "max", cli_json_number(report->max));
  return object;
}

void cli_field_json(json_t *report, const cli_field *field) {
  if (field->coverage)
    json_object_set_new(report, "coverage", coverage_json(field));
  else if (field->color) {
    json_object_set_new(report, "voxels", json_integer(field->coverage_report.voxelize->voxels));
    json_object_set_new(report, "color", cli_json_text(field->color_name));
    if (field->color_options.average)
      json_object_set_new(report, "color_average", json_true());
  } else if (field->labels)
    cli_labels_json(report, field);
  else
    json_object_set_new(report, "distance", distance_json(field));
}

void cli_field_summarize(const cli_run *cli, const cli_field *field) {
  const vxm_coverage_report *coverage = &field->coverage_report;
  const vxm_distance_report *distance = &field->distance_report;
  if (field->coverage) {
    cli_row(cli, "coverage", "%" PRId64 " voxels full, %" PRId64 " in part", coverage->full,
            coverage->partial);
    cli_row(cli, "volume", "%.6g", coverage->volume);
  } else if (field->color) {
    cli_row(cli, "voxels", "%" PRId64, field->coverage_report.voxelize->voxels);
    cli_row(cli, "colour", "%s%s", field->color_name,
            field->color_options.average ? ", the mean over the surface within a voxel" : "");
  } else if (field->labels)
    cli_labels_summarize(cli, field);
  else if (field->distance_options.band == 0)
    cli_row(cli, "distance", "%.6g to %.6g; exact everywhere", distance->min, distance->max);
  else
    cli_row(cli, "distance", "%.6g to %.6g; %" PRId64 " voxels within the band", distance->min, distance->max,
            distance->exact);
}
