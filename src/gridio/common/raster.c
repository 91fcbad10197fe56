/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/raster.h"

#include <string.h>

vxm_raster vxm_raster_plain(const vxm_space *space, vxm_scalar scalar, int channels) {
  return (vxm_raster){
      .space = *space, .scalar = scalar, .channels = channels, .stored = channels, .axis = {0, 1, 2}};
}

/** Voxels along an axis of the file. */
static int64_t file_dim(const vxm_raster *r, int axis) {
  return r->space.dims[r->axis[axis]];
}

static size_t voxel_bytes(const vxm_raster *r) {
  return vxm_scalar_bytes(r->scalar) * (size_t)r->stored;
}

uint64_t vxm_raster_bytes(const vxm_raster *r) {
  return vxm_space_voxels(&r->space) * voxel_bytes(r);
}

/** Whether slices of the file are slices of the field. */
static bool is_plain(const vxm_raster *r) {
  bool plain = r->stored == r->channels;
  for (int a = 0; a < 3; a++)
    plain = plain && r->axis[a] == a && !r->is_flipped[a];
  return plain;
}

/** How far apart voxels of the field lie along an axis of the file, and where the first lies. */
typedef struct steps {
  int64_t step[3], first;
} steps;

static steps steps_of(const vxm_raster *r) {
  const int64_t *n = r->space.dims, strides[3] = {n[1] * n[2], n[2], 1};
  steps s = {.first = 0};
  for (int a = 0; a < 3; a++) {
    s.step[a] = strides[r->axis[a]];
    if (r->is_flipped[a]) {
      s.first += (file_dim(r, a) - 1) * s.step[a];
      s.step[a] = -s.step[a];
    }
  }
  return s;
}

static void put_value(unsigned char *to, const unsigned char *from, const vxm_raster *r) {
  size_t size = vxm_scalar_bytes(r->scalar);
  if (r->stored == 3) {
    memcpy(to, from, 3);
    to[3] = UINT8_MAX;
  } else if (r->is_swapped)
    for (size_t b = 0; b < size; b++)
      to[b] = from[size - 1 - b];
  else
    memcpy(to, from, size * (size_t)r->stored);
}

/** Puts a slice of the file into its place, voxel by voxel. */
static void put_slice(vxm_field *field, const unsigned char *slice, const vxm_raster *r, const steps *s,
                      int64_t k) {
  size_t size = vxm_field_voxel_bytes(field);
  for (int64_t j = 0; j < file_dim(r, 1); j++)
    for (int64_t i = 0; i < file_dim(r, 0); i++, slice += voxel_bytes(r))
      put_value(field->values + (size_t)(s->first + i * s->step[0] + j * s->step[1] + k * s->step[2]) * size,
                slice, r);
}

static vxm_status fill(vxm_field *field, const vxm_raster *r, vxm_raster_source source, void *payload,
                       vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t bytes = (size_t)(file_dim(r, 0) * file_dim(r, 1)) * voxel_bytes(r);
  unsigned char *slice = vxm_alloc(field->context, bytes, 1, &local);
  vxm_status status = local.code;
  const steps s = steps_of(r);
  int64_t slices = file_dim(r, 2);
  for (int64_t k = 0; k < slices && status == VXM_OK; k++) {
    status = source(payload, slice, bytes, &local);
    if (status != VXM_OK)
      break;
    if (is_plain(r))
      vxm_field_put_slices(field, slice, k, k + 1, r->is_swapped);
    else
      put_slice(field, slice, r, &s, k);
    status = vxm_progress(field->context, "reading", (double)(k + 1) / (double)slices, &local);
  }
  vxm_free(field->context, slice);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Replaces a field by its scaled numbers: 32-bit floats where these hold them, else 64-bit ones. */
static vxm_status scale(vxm_field **field, const vxm_raster *r, vxm_error *error) {
  vxm_field *scaled, *raw = *field;
  vxm_status status =
      vxm_field_make(&scaled, raw->context, &raw->space, VXM_FIELD_NUMBERS, VXM_FLOAT64, error);
  if (status != VXM_OK)
    return status;
  double *values = (double *)(void *)scaled->values;
  size_t count = vxm_field_count(raw);
  vxm_field_doubles(values, raw, 0, count);
  for (size_t v = 0; v < count; v++)
    values[v] = values[v] * r->slope + r->intercept;
  vxm_field_destroy(raw);
  *field = scaled;
  return vxm_field_narrow(scaled, VXM_FLOAT32, error);
}

vxm_status vxm_raster_read(vxm_field **out, const vxm_raster *r, vxm_context *context, vxm_about *about,
                           vxm_raster_source source, void *payload, vxm_error *error) {
  vxm_field *field = NULL;
  *out = NULL;
  vxm_status status = vxm_field_make(
      &field, context, &r->space, r->channels == 4 ? VXM_FIELD_COLORS : VXM_FIELD_NUMBERS, r->scalar, error);
  if (status == VXM_OK)
    status = fill(field, r, source, payload, error);
  if (status == VXM_OK && r->is_scaled)
    status = scale(&field, r, error);
  if (status != VXM_OK) {
    vxm_field_destroy(field);
    vxm_about_destroy(about);
    return status;
  }
  vxm_field_describe(field, about);
  return vxm_field_hand_over(out, field, status, error);
}

/* ---- Bits ---- */

static bool all_binary(const vxm_field *field) {
  for (size_t v = 0, count = vxm_field_count(field); v < count; v++)
    if (field->values[v] > 1)
      return false;
  return true;
}

vxm_status vxm_raster_bits(vxm_grid **out, const vxm_field *field, vxm_bits_rule rule, const char *file,
                           vxm_error *error) {
  vxm_status status;
  if (rule == VXM_BITS_NONE)
    status = vxm_grid_create(out, field->context, &field->space, error);
  else if (rule == VXM_BITS_STORED && (field->channels == 4 || field->scalar != VXM_UINT8 ||
                                       !vxm_about_may_be_bits(&field->about, rule) || !all_binary(field)))
    status = vxm_fail_numbers(error, file, field->channels == 4 ? "colors" : vxm_scalar_name(field->scalar));
  else
    status = vxm_field_to_bits(out, field, file, error);
  if (status == VXM_OK)
    (*out)->warnings = field->warnings;
  return status;
}

vxm_status vxm_raster_bits_of_file(vxm_grid **out,
                                   vxm_status (*read_field)(vxm_field **out, const vxm_input *input,
                                                            vxm_error *error),
                                   const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_field *field = NULL;
  vxm_status status = read_field(&field, input, error);
  if (status == VXM_OK)
    status = vxm_raster_bits(out, field, rule, input->name, error);
  vxm_field_destroy(field);
  return status;
}
