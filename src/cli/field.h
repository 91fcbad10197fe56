/* SPDX-License-Identifier: BSD-3-Clause */
/** What voxelize makes that is more than bits: coverage, distances, labels and colours. */
#ifndef VXM_CLI_FIELD_H
#define VXM_CLI_FIELD_H

#include "cli/repair_common.h"

typedef struct cli_field {
  bool coverage, distance, labels, color; /**< which options were given */
  const char *color_name;                 /**< a function that is built in, or a file */
  const char *color_mesh;                 /**< the mesh that gives the colours, for messages */
  vxm_coverage_options coverage_options;
  vxm_distance_options distance_options;
  vxm_label_options label_options;
  vxm_color_options color_options;
  vxm_coverage_report coverage_report;
  vxm_distance_report distance_report;
  vxm_label_report label_report;
  json_t *label_table; /**< of the labels that were made, or NULL */
} cli_field;

#define CLI_FIELD_INIT                                                                            \
  {                                                                                               \
    .coverage_options = VXM_COVERAGE_OPTIONS_INIT, .distance_options = VXM_DISTANCE_OPTIONS_INIT, \
    .label_options = VXM_LABEL_OPTIONS_INIT, .color_options = VXM_COLOR_OPTIONS_INIT,             \
    .coverage_report = VXM_COVERAGE_REPORT_INIT, .distance_report = VXM_DISTANCE_REPORT_INIT,     \
    .label_report = VXM_LABEL_REPORT_INIT                                                         \
  }

/** The formats of what is wanted. */
cli_formats cli_field_formats(const cli_field *field);
/** Whether a number per voxel is wanted rather than a grid. */
bool cli_field_wanted(const cli_field *field);
/** Choices of --scalar (the first is VXM_FLOAT32), --distance and --labels; NULL ends each list. */
extern const char *const cli_scalars[], *const cli_signs[], *const cli_label_kinds[];
/** Of --coverage 2|4|8, into an int; of --color, into a cli_field (colors.c). */
cli_reader cli_take_subdivision, cli_take_color;
/** Tell what a mesh looks like that was read with its colours; nothing where there is nothing (look.c). */
void cli_look_json(json_t *report, const vxm_mesh *mesh);
void cli_look_print(const cli_run *cli, const vxm_mesh *mesh);

/** Takes the mesh that gives the colours. */
void cli_color_take(cli_field *field, const cli_input *input);
/** Says of the mesh what it lacks: puts its name before the error. */
void cli_color_name_mesh(cli_run *cli, const char *path);
/** Writes the file of --color; a failure is in cli->error. */
vxm_status cli_color_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format);
/** CLI_STOP if they contradict each other, --mode, --dry-run (`is_tried`) or --confidence (`is_sure`). */
int cli_field_check(cli_run *cli, const cli_field *field, vxm_mode mode, bool is_tried, bool is_sure);
/** Writes the file; a failure is in cli->error. */
vxm_status cli_field_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format);
/** What that will take; zeros for labels. A failure is in cli->error. */
vxm_status cli_field_estimate(cli_run *cli, const cli_field *field, vxm_estimate *out, const vxm_model *model,
                              const vxm_space *space, const char *path, const char *format);
/** Adds "coverage", "distance", "labels" or "color". */
void cli_field_json(json_t *report, const cli_field *field);
void cli_field_summarize(const cli_run *cli, const cli_field *field);
/* The same for labels alone. */
vxm_status cli_labels_write(cli_run *cli, cli_field *field, vxm_model *model, const vxm_space *space,
                            const char *path);
void cli_labels_json(json_t *report, const cli_field *field);
void cli_labels_summarize(const cli_run *cli, const cli_field *field);

#endif
