/* SPDX-License-Identifier: BSD-3-Clause */
/** The picture of a field: which of its voxels are drawn, and in what colours. */
#include "gridio/common/label_color.h"
#include "gridio/picture/picture.h"
#include "gridio/picture/slice.h"
#include "mesh/appearance.h"

#include <math.h>

/* ---- What is drawn ---- */

vxm_field_kind vxm_gridio_field_guess(const vxm_field *field, const vxm_field_range *range) {
  vxm_field_kind kind = field->about.kind;
  if (kind != VXM_FIELD_NUMBERS)
    return kind;
  if (!vxm_scalar_is_float(field->scalar))
    return range->min >= 0 ? VXM_FIELD_LABELS : kind;
  if (range->min < 0 && range->max > 0)
    return VXM_FIELD_DISTANCE;
  return range->min >= 0 && range->max <= 1 ? VXM_FIELD_COVERAGE : kind;
}

static vxm_threshold_options from(double at_least) {
  return (vxm_threshold_options){sizeof(vxm_threshold_options), true, at_least, false, 0};
}

static vxm_threshold_options below(double bound) {
  return (vxm_threshold_options){sizeof(vxm_threshold_options), false, 0, true, bound};
}

/** The level of a distance: 0, or, without a sign, as far as a surface in a voxel can be from its centre. */
static double distance_level(const vxm_field *field, const vxm_field_range *range) {
  const double *size = field->space.voxel_size;
  if (range->min < 0)
    return 0;
  return 0.5 * sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);
}

vxm_status vxm_gridio_field_shown(vxm_threshold_options *out, vxm_field_kind kind, const vxm_field *field,
                                  const vxm_field_range *range, vxm_error *error) {
  bool is_byte = field->scalar == VXM_UINT8;
  switch (kind) {
  case VXM_FIELD_DISTANCE:
    *out = below(distance_level(field, range));
    return VXM_OK;
  case VXM_FIELD_COVERAGE:
    *out = from(is_byte ? 127.5 : 0.5);
    return VXM_OK;
  case VXM_FIELD_LABELS:
    *out = from(1);
    return VXM_OK;
  case VXM_FIELD_COLORS:
    *out = from(1);
    return VXM_OK;
  case VXM_FIELD_CONFIDENCE:
    *out = below(255);
    return VXM_OK;
  case VXM_FIELD_NUMBERS:
    break;
  }
  return vxm_fail(error, VXM_ERROR_NUMBERS,
                  "picture: what the numbers (%s from %g to %g) are is not known: choose which are drawn, by "
                  "--threshold or --below",
                  vxm_scalar_name(field->scalar), range->min, range->max);
}

/* ---- Colours ---- */

static size_t index_of(const vxm_field *field, const int64_t voxel[3]) {
  const int64_t *n = field->space.dims;
  return (size_t)((voxel[0] * n[1] + voxel[1]) * n[2] + voxel[2]);
}

static vxm_ray_vec3 paint_color(const void *payload, const int64_t voxel[3]) {
  const vxm_field *field = payload;
  const unsigned char *rgb = field->values + 4 * index_of(field, voxel);
  return vxm_ray_vec3_of(vxm_srgb_decode(rgb[0] / 255.0), vxm_srgb_decode(rgb[1] / 255.0),
                         vxm_srgb_decode(rgb[2] / 255.0));
}

static vxm_ray_vec3 paint_label(const void *payload, const int64_t voxel[3]) {
  const vxm_field *field = payload;
  double label, rgb[3];
  vxm_field_doubles(&label, field, index_of(field, voxel), 1);
  vxm_label_color(rgb, label);
  return vxm_ray_vec3_of(vxm_srgb_decode(rgb[0]), vxm_srgb_decode(rgb[1]), vxm_srgb_decode(rgb[2]));
}

/* ---- The picture ---- */

vxm_status vxm_gridio_field_picture(const vxm_field *field, const char *path,
                                    const vxm_picture_options *options,
                                    const vxm_threshold_options *threshold, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_threshold_options own;
  vxm_status status = vxm_gridio_picture_check(options, error);
  if (status == VXM_OK)
    status = vxm_field_measure(&range, field, error);
  if (status != VXM_OK)
    return status;
  vxm_field_kind kind = vxm_gridio_field_guess(field, &range);
  if (options->slice_axis != 0)
    return vxm_gridio_slice(NULL, field, kind, &range, path, options, error);
  if (!threshold) {
    status = vxm_gridio_field_shown(&own, kind, field, &range, error);
    threshold = &own;
  }
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_field_threshold(&grid, field, threshold, error);
  vxm_paint_fn paint = kind == VXM_FIELD_COLORS ? paint_color : kind == VXM_FIELD_LABELS ? paint_label : NULL;
  if (status == VXM_OK)
    status = vxm_gridio_picture(grid, paint, field, path, options, error);
  vxm_grid_destroy(grid);
  return status;
}
