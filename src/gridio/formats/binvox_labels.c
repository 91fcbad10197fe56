/* SPDX-License-Identifier: BSD-3-Clause */
/** .binvox with labels: pairs of a label and a count, no run going on from slice to slice. */
#include "gridio/formats/binvox.h"

enum { LABELS_MAX = 255 };

vxm_status vxm_binvox_check_field(const vxm_field *field, const char *path, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_kind what = field->about.kind;
  if ((what != VXM_FIELD_LABELS && what != VXM_FIELD_NUMBERS) || vxm_scalar_is_float(field->scalar))
    return vxm_field_refuse(
        field, path, VXM_ERROR_ARGUMENT,
        "cannot be written as .binvox, which holds labels from 0 to 255; choose a threshold, or .npy "
        "or .nrrd",
        error);
  vxm_status status = vxm_field_measure(&range, field, error);
  if (status == VXM_OK && (range.min < 0 || range.max > LABELS_MAX))
    return vxm_field_refuse(
        field, path, VXM_ERROR_RANGE,
        "has numbers beyond 0 to 255, which .binvox does not hold; choose .npy or .nrrd, or set and clear "
        "voxels by a threshold",
        error);
  return status == VXM_OK ? vxm_binvox_check(&field->space, path, error) : status;
}

static vxm_status check(const vxm_space *space, const vxm_values_spec *values, const char *path,
                        vxm_error *error) {
  size_t labels = values->about->table.count;
  if (labels > LABELS_MAX)
    return vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){path, 0, -1, -1},
                       "%zu labels are more than .binvox holds, which is %d; use .npy or .nrrd", labels,
                       LABELS_MAX);
  return vxm_binvox_check(space, path, error);
}

static vxm_scalar stored(vxm_scalar scalar) {
  (void)scalar;
  return VXM_UINT16;
}

/** All numbers are from 0 to 255. */
static void convert(void *out, const vxm_field *slice, size_t count) {
  enum { SOME = 256 };
  uint16_t *labels = out;
  double some[SOME];
  for (size_t begin = 0; begin < count; begin += SOME) {
    size_t length = count - begin < SOME ? count - begin : SOME;
    vxm_field_doubles(some, slice, begin, length);
    for (size_t i = 0; i < length; i++)
      labels[begin + i] = (uint16_t)some[i];
  }
}

static uint64_t file_bytes(const vxm_space *space, const vxm_values_spec *values) {
  (void)values;
  return vxm_binvox_bytes(space);
}

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_binvox_header_write(w->output, &w->space, 2);
  return VXM_OK;
}

static vxm_status put(vxm_values_writer *w, const void *values, int64_t begin, int64_t end,
                      vxm_error *error) {
  (void)error;
  const uint16_t *slice = values;
  for (int64_t x = begin; x < end && !vxm_output_failed(w->output); x++) {
    vxm_binvox_put_slice(w->output, &w->space, slice);
    slice += w->slice_bytes / sizeof *slice;
  }
  return VXM_OK;
}

static vxm_status end(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_binvox_put_end(w->output, &w->space);
  return VXM_OK;
}

static const vxm_sidecar_text description = {"voxmend labels", "y fastest, then z, then x", NULL};

const vxm_values_writer_kind vxm_binvox_labels = {
    .layout = VXM_PLANE_Y_FAST,
    .holds = VXM_HOLDS_LABELS,
    .sidecar = &description,
    .stored = stored,
    .convert = convert,
    .check = check,
    .file_bytes = file_bytes,
    .begin = begin,
    .put = put,
    .end = end,
};
