/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about labels: they check arguments and call down. */
#include "base/sized.h"
#include "export/labels.h"
#include "grid/bit_transpose.h"

/** What is made, and where it goes; pointers of the caller stay. */
typedef struct label_results {
  vxm_label_report *report;
  vxm_voxelize_report *to;
  vxm_label_report made;
  vxm_voxelize_report voxelize;
} label_results;

static void begin_label(label_results *r, vxm_label_report *report) {
  *r = (label_results){.report = report,
                       .to = report && VXM_RESULT_HAS(report, voxelize) ? report->voxelize : NULL};
  r->made.voxelize = r->to;
  VXM_RESULT_WRITE(report, &r->made);
  VXM_RESULT_CLEAR(r->to);
  r->made.voxelize = &r->voxelize;
}

static vxm_status end_label(label_results *r, vxm_status status) {
  if (status != VXM_OK)
    return status;
  r->made.voxelize = r->to;
  VXM_RESULT_WRITE(r->report, &r->made);
  VXM_RESULT_WRITE(r->to, &r->voxelize);
  return status;
}

static vxm_status check(vxm_label_options *chosen, const vxm_space *space, const vxm_label_options *options,
                        vxm_error *error) {
  *chosen = (vxm_label_options)VXM_LABEL_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "labels", error);
  if (status != VXM_OK)
    return status;
  if ((unsigned)chosen->by > VXM_LABEL_MATERIAL)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: %d is none of the kinds of labels", (int)chosen->by);
  return vxm_space_check(space, error);
}

vxm_status vxm_model_labels(uint16_t *values, vxm_label_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_label_options *options, vxm_error *error) {
  label_results results;
  begin_label(&results, report);
  if (!values || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: an argument is NULL");
  vxm_label_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  if (status != VXM_OK)
    return status;
  vxm_face_labels labelling;
  status = vxm_face_labels_create(&labelling, model->analysis.soup, chosen.by, error);
  if (status == VXM_OK)
    status =
        vxm_labels_run(values, (vxm_layout)VXM_PLANE_Z_FAST, &results.made, model, space, &labelling, error);
  vxm_face_labels_destroy(&labelling);
  return end_label(&results, status);
}

vxm_status vxm_model_write_labels(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_label_options *options, vxm_error *error) {
  label_results results;
  begin_label(&results, report);
  if (!model || !space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: an argument is NULL");
  vxm_label_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  if (status == VXM_OK)
    status = vxm_labels_write(&results.made, model, space, path, &chosen, error);
  return end_label(&results, status);
}

/** The table of the calling thread, or an empty one. */
static const vxm_label_table *table_of(const vxm_model *model) {
  static const vxm_label_table none = {.count = 0};
  const vxm_model_result *result = model ? vxm_model_results_read(model->results) : NULL;
  return result ? &result->labels : &none;
}

int64_t vxm_model_label_count(const vxm_model *model) {
  return (int64_t)table_of(model)->count;
}

static bool is_label(const vxm_label_table *table, int64_t label) {
  return label >= 1 && label <= (int64_t)table->count;
}

const char *vxm_model_label_name(const vxm_model *model, int64_t label) {
  const vxm_label_table *table = table_of(model);
  return is_label(table, label) ? vxm_label_table_name(table, (size_t)label) : "";
}

int64_t vxm_model_label_voxels(const vxm_model *model, int64_t label) {
  const vxm_label_table *table = table_of(model);
  return is_label(table, label) ? table->voxels[label - 1] : 0;
}
