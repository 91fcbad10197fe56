/* SPDX-License-Identifier: BSD-3-Clause */
/** .nrrd: a byte per voxel behind a header with the transform, x fastest, then y, then z. */
#include "base/endian.h"
#include "config.h"
#include "gridio/common/byte_rows.h"
#include "gridio/common/deflate.h"
#include "gridio/common/scalar_type.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/nrrd_header.h"

#include <inttypes.h>
#include <string.h>

/* ---- Reading ---- */

static vxm_status check_length(const vxm_nrrd_header *h, const vxm_input *input, vxm_warnings *warnings,
                               vxm_error *error) {
  size_t size = h->size * (size_t)h->channels;
  uint64_t voxels = vxm_space_voxels(&h->space), there = input->size - h->data;
  if (h->gzip && voxels * size / VXM_INFLATE_RATIO_MAX <= there)
    return VXM_OK;
  if (h->gzip || there / size < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: %" PRIu64 " bytes cannot hold %" PRIu64 " values", there,
                         voxels);
  if (there > voxels * size)
    vxm_warn(warnings, "%" PRIu64 " bytes behind the values are ignored", there - voxels * size);
  return VXM_OK;
}

/** Where values go, row after row along x. */
typedef struct rows_to {
  vxm_grid *grid;   /**< or, if NULL, */
  vxm_field *field; /**< whose rows come in whole slices */
  vxm_scalar_type element;
  atomic_uint *seen;
  bool is_swapped;
} rows_to;

#ifdef HAVE_ZLIB
/** Rows that are unpacked together: up to 4 MiB, but at least one; of fields, whole slices. */
static size_t rows_at_once(const vxm_space *space, bool is_field, size_t row_bytes) {
  enum { CHUNK = 1 << 22 };
  size_t step = is_field ? (size_t)space->dims[1] : 1, all = (size_t)space->dims[1] * (size_t)space->dims[2],
         some = row_bytes < CHUNK ? CHUNK / row_bytes / step * step : step;
  return some < step ? step : some < all ? some : all;
}

static void put_rows(const rows_to *to, size_t row, size_t rows, const unsigned char *bytes) {
  if (to->grid) {
    vxm_scalar_types_to_rows(to->grid, row, rows, bytes, to->element, to->seen);
    return;
  }
  size_t step = (size_t)to->field->space.dims[1];
  vxm_field_put_slices(to->field, bytes, (int64_t)(row / step), (int64_t)((row + rows) / step),
                       to->is_swapped);
}

static vxm_status unpack_rows(vxm_inflater *inflater, const rows_to *to, const vxm_nrrd_header *h,
                              vxm_context *context, vxm_error *error) {
  size_t row_bytes = (size_t)h->space.dims[0] * h->size * (size_t)h->channels,
         all = (size_t)h->space.dims[1] * (size_t)h->space.dims[2],
         most = rows_at_once(&h->space, !to->grid, row_bytes);
  vxm_error local = VXM_ERROR_INIT;
  unsigned char *bytes = vxm_alloc(context, most, row_bytes, &local);
  vxm_status status = local.code;
  for (size_t row = 0; row < all && status == VXM_OK; row += most) {
    size_t rows = all - row < most ? all - row : most;
    status = vxm_inflater_read(inflater, bytes, rows * row_bytes, &local);
    if (status != VXM_OK)
      break;
    put_rows(to, row, rows, bytes);
    status = vxm_progress(context, "reading", (double)(row + rows) / (double)all, &local);
  }
  vxm_free(context, bytes);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status read_gzip(const rows_to *to, const vxm_nrrd_header *h, const vxm_input *input,
                            vxm_error *error) {
  vxm_inflater *inflater;
  vxm_status status = vxm_inflater_create(&inflater, input, h->data, error);
  if (status == VXM_OK)
    status = unpack_rows(inflater, to, h, input->context, error);
  vxm_inflater_destroy(inflater);
  return status;
}
#else
static vxm_status read_gzip(const rows_to *to, const vxm_nrrd_header *h, const vxm_input *input,
                            vxm_error *error) {
  (void)to;
  return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, (vxm_place){input->name, 0, (int64_t)h->data, -1},
                     "compressed values need zlib, without which this build was made (configure --with-zlib; "
                     "Debian: zlib1g-dev); write the file with the encoding raw");
}
#endif

static vxm_status read_front(vxm_nrrd_header *h, vxm_warnings *warnings, const vxm_input *input,
                             vxm_error *error) {
  vxm_status status = vxm_nrrd_header_read(h, input, warnings, error);
  if (status == VXM_OK)
    status = vxm_space_check_file(&h->space, input, h->sizes_offset, error);
  return status == VXM_OK ? check_length(h, input, warnings, error) : status;
}

static const char *type_of(const vxm_nrrd_header *h) {
  return h->channels == 4 ? "colors" : vxm_scalar_name(vxm_scalar_of(h->kind, h->size));
}

static vxm_status read_bits(vxm_grid *grid, const vxm_nrrd_header *h, const vxm_input *input,
                            vxm_bits_rule rule, vxm_error *error) {
  atomic_uint seen = 0;
  vxm_scalar_type element = vxm_scalar_type_of(h->kind, h->size, h->big_endian);
  const rows_to to = {.grid = grid, .element = element, .seen = &seen};
  vxm_status status = VXM_OK;
  if (h->gzip)
    status = read_gzip(&to, h, input, error);
  else
    status = vxm_scalar_types_to_grid(grid, input->data + h->data, element, &seen, error);
  if (status == VXM_OK && !vxm_seen_bits(seen, element, rule))
    status = vxm_fail_numbers(error, input->name, type_of(h));
  return status;
}

static bool may_be_bits(const vxm_nrrd_header *h, vxm_bits_rule rule) {
  return h->channels == 1 && vxm_about_may_be_bits(&h->about, rule) &&
         vxm_scalar_type_may_be_bits(vxm_scalar_type_of(h->kind, h->size, h->big_endian), rule);
}

static vxm_status read_nrrd(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_nrrd_header h;
  vxm_warnings warnings = {0};
  vxm_grid *grid = NULL;
  vxm_status status = read_front(&h, &warnings, input, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE && !may_be_bits(&h, rule))
    status = vxm_fail_numbers(error, input->name, type_of(&h));
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &h.space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = read_bits(grid, &h, input, rule, error);
  vxm_about_destroy(&h.about);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->warnings = warnings;
  *out = grid;
  return VXM_OK;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  vxm_nrrd_header h;
  vxm_warnings warnings = {0};
  vxm_field *field = NULL;
  vxm_status status = read_front(&h, &warnings, input, error);
  if (status == VXM_OK)
    status = vxm_field_make(&field, input->context, &h.space,
                            h.channels == 4 ? VXM_FIELD_COLORS : VXM_FIELD_NUMBERS,
                            vxm_scalar_of(h.kind, h.size), error);
  if (status != VXM_OK) {
    vxm_about_destroy(&h.about);
    return status;
  }
  const rows_to to = {.field = field, .is_swapped = h.size > 1 && h.big_endian != (vxm_le64(1) != 1)};
  vxm_sidecar_take_labels(&h.about, h.space.dims, input);
  vxm_field_describe(field, &h.about);
  field->warnings = warnings;
  if (h.gzip)
    status = read_gzip(&to, &h, input, error);
  else
    vxm_field_put_slices(field, input->data + h.data, 0, h.space.dims[2], to.is_swapped);
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, error);
  return vxm_field_hand_over(out, field, status, error);
}

/* ---- Writing ---- */

static size_t state_bytes(const vxm_space *space) {
  return vxm_byte_rows_bytes(space, (vxm_layout)VXM_LAYOUT_GRID);
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  const vxm_nrrd_values values = {"1 where a voxel is set", VXM_UINT8, 1, NULL};
  (void)error;
  vxm_nrrd_header_write(writer->output, &values, &writer->space);
  return VXM_OK;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_byte_rows_put,
    .file_bytes = vxm_space_voxels,
};

/* ---- Writing numbers ---- */

static vxm_status begin_values(vxm_values_writer *w, vxm_error *error) {
  const vxm_nrrd_values header = {"a number per voxel, at its centre", w->values.scalar, w->values.channels,
                                  w->values.about};
  (void)error;
  vxm_nrrd_header_write(w->output, &header, &w->space);
  return VXM_OK;
}

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_NUMBERS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .sidecar = &vxm_sidecar_labels,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .file_bytes = vxm_values_plain_bytes,
    .begin = begin_values,
};

const vxm_grid_format vxm_format_nrrd = {
    .name = "nrrd",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_nrrd_sniff,
    .read = read_nrrd,
    .read_field = read_field,
    .writer = &writer_kind,
    .values = &values_kind,
};
