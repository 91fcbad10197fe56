/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about labels: they check arguments and call down. */
#include "api/api_results.h"
#include "export/labels.h"
#include "grid/bit_transpose.h"
#include "voxel/labels/divide.h"

static vxm_status check_kind(vxm_label_by by, vxm_error *error) {
  return (unsigned)by <= VXM_LABEL_MATERIAL
             ? VXM_OK
             : vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: %d is none of the kinds of labels", (int)by);
}

static vxm_status check(vxm_label_options *chosen, const vxm_space *space, const vxm_label_options *options,
                        vxm_error *error) {
  *chosen = (vxm_label_options)VXM_LABEL_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "labels", error);
  if (status == VXM_OK)
    status = check_kind(chosen->by, error);
  return status == VXM_OK ? vxm_space_check(space, error) : status;
}

vxm_status vxm_mesh_divide(vxm_mesh **out, const vxm_mesh *mesh, vxm_label_by by, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: an argument is NULL");
  vxm_mesh *made = NULL;
  vxm_status status = check_kind(by, error);
  if (status == VXM_OK)
    status = vxm_soup_copy(&made, mesh, error);
  if (status == VXM_OK)
    status = vxm_labels_divide(made, by, error);
  if (status == VXM_OK)
    *out = made;
  else
    vxm_soup_destroy(made);
  return status;
}

vxm_status vxm_model_labels(uint16_t *values, vxm_label_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_label_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_label_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!values || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: an argument is NULL");
  vxm_label_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  if (status != VXM_OK)
    return status;
  vxm_face_labels face_labels;
  status = vxm_face_labels_create(&face_labels, model->analysis.soup, chosen.by, error);
  if (status == VXM_OK)
    status = vxm_labels_run(values, (vxm_layout)VXM_PLANE_Z_FAST, &results.made, model, space, &face_labels,
                            error);
  vxm_face_labels_destroy(&face_labels);
  VXM_RESULTS_END(&results, status);
  return status;
}

vxm_status vxm_model_write_labels(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_label_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_label_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!model || !space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "labels: an argument is NULL");
  vxm_label_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  if (status == VXM_OK)
    status = vxm_labels_write(&results.made, model, space, path, &chosen, error);
  VXM_RESULTS_END(&results, status);
  return status;
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
