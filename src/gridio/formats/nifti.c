/* SPDX-License-Identifier: BSD-3-Clause */
/** .nii and .nii.gz: NIfTI, a value per voxel behind a header with the transform, x fastest, then y, then z.
 */
#include "base/endian.h"
#include "gridio/common/deflate.h"
#include "gridio/formats/nifti_header.h"

#include <inttypes.h>
#include <string.h>

/* ---- Reading ---- */

/** The bytes of a file in their order, compressed or not. */
typedef struct byte_source {
  const vxm_input *input;
  vxm_inflater *inflater; /**< NULL: they lie as they are */
  uint64_t at;
} byte_source;

static vxm_status take_bytes(void *payload, void *to, size_t size, vxm_error *error) {
  byte_source *s = payload;
  if (s->inflater) {
    s->at += size;
    return vxm_inflater_read(s->inflater, to, size, error);
  }
  if (s->at > s->input->size || size > s->input->size - s->at)
    return vxm_fail_byte(error, s->input, s->input->size, "the file is cut short");
  memcpy(to, s->input->data + s->at, size);
  s->at += size;
  return VXM_OK;
}

/** Reads the header, and leaves the source behind it. */
static vxm_status take_header(vxm_nifti_header *h, byte_source *s, vxm_error *error) {
  unsigned char data[VXM_NIFTI_2] = {0};
  vxm_status status = take_bytes(s, data, VXM_NIFTI_1, error);
  size_t size = VXM_NIFTI_1;
  int32_t first;
  memcpy(&first, data, sizeof first);
  if (status == VXM_OK && (first == VXM_NIFTI_2 || first == (int32_t)__builtin_bswap32(VXM_NIFTI_2))) {
    status = take_bytes(s, data + VXM_NIFTI_1, VXM_NIFTI_2 - VXM_NIFTI_1, error);
    size = VXM_NIFTI_2;
  }
  if (status == VXM_OK && vxm_nifti_header_size(data, size) != size)
    status = vxm_fail_byte(error, s->input, 0,
                           "not a NIfTI file of one piece: it does not say \"n+1\" or \"n+2\"");
  return status == VXM_OK ? vxm_nifti_header_read(h, data, size, s->input, error) : status;
}

/** Reads what lies between header and values. */
static vxm_status take_extensions(vxm_nifti_header *h, byte_source *s, vxm_error *error) {
  unsigned char block[4096];
  vxm_status status = VXM_OK;
  bool is_first = true;
  while (s->at < h->data && status == VXM_OK) {
    uint64_t left = h->data - s->at;
    size_t some = left < sizeof block ? (size_t)left : sizeof block;
    status = take_bytes(s, block, some, error);
    if (status == VXM_OK && is_first && some > VXM_NIFTI_MARK && block[0] != 0)
      vxm_nifti_extension_read(h, block + VXM_NIFTI_MARK, some - VXM_NIFTI_MARK);
    is_first = false;
  }
  return status;
}

static vxm_status check_length(const vxm_nifti_header *h, const byte_source *s, vxm_error *error) {
  uint64_t bytes = vxm_raster_bytes(&h->raster), there = s->input->size;
  bool fits =
      s->inflater ? bytes / VXM_INFLATE_RATIO_MAX <= there : h->data <= there && bytes <= there - h->data;
  if (fits)
    return VXM_OK;
  return vxm_fail_byte(error, s->input, there,
                       "the file is cut short: %" PRIu64 " bytes cannot hold its %" PRIu64 " voxels", there,
                       vxm_space_voxels(&h->raster.space));
}

static vxm_status read_values(vxm_field **out, vxm_nifti_header *h, byte_source *s, bool is_space_only,
                              vxm_error *error) {
  vxm_status status = check_length(h, s, error);
  if (status == VXM_OK)
    status = take_extensions(h, s, error);
  if (status != VXM_OK || is_space_only)
    return status;
  vxm_sidecar_take_labels(&h->about, h->raster.space.dims, s->input);
  return vxm_raster_read(out, &h->raster, s->input->context, &h->about, take_bytes, s, error);
}

/** @param out NULL: only the header is read, for its space */
static vxm_status read_file(vxm_field **out, vxm_nifti_header *h, const vxm_input *input, vxm_error *error) {
  byte_source s = {.input = input};
  vxm_status status = vxm_is_gzip(input) ? vxm_inflater_create(&s.inflater, input, 0, error) : VXM_OK;
  *h = (vxm_nifti_header){.data = 0};
  if (status == VXM_OK)
    status = take_header(h, &s, error);
  if (status == VXM_OK)
    status = read_values(out, h, &s, !out, error);
  vxm_inflater_destroy(s.inflater);
  return status;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  vxm_nifti_header h;
  return read_file(out, &h, input, error);
}

static vxm_status read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  if (rule != VXM_BITS_NONE)
    return vxm_raster_bits_of_file(out, read_field, input, rule, error);
  vxm_nifti_header h;
  vxm_status status = read_file(NULL, &h, input, error);
  return status == VXM_OK ? vxm_grid_create(out, input->context, &h.raster.space, error) : status;
}

static bool sniff(const vxm_input *input) {
  return vxm_nifti_header_size(input->data, input->size) != 0;
}

/* ---- Writing ---- */

static vxm_status begin(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_nifti_block block;
  vxm_nifti_header_make(&block, &w->space, &w->values);
  vxm_output_write(w->output, block.bytes, block.size);
  return VXM_OK;
}

static vxm_status begin_packed(vxm_values_writer *w, vxm_error *error) {
  vxm_nifti_block block;
  vxm_deflater *deflater = NULL;
  vxm_nifti_header_make(&block, &w->space, &w->values);
  vxm_status status = vxm_deflater_create(&deflater, w->context, w->output, VXM_DEFLATE_GZIP, error);
  w->state = deflater;
  if (status == VXM_OK)
    vxm_deflater_write(deflater, block.bytes, block.size);
  return status;
}

static void put_packed(vxm_values_writer *w, const void *bytes, size_t size) {
  vxm_deflater_write(w->state, bytes, size);
}

static vxm_status end_packed(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  vxm_deflater_end(w->state);
  return VXM_OK;
}

static void drop_packed(vxm_values_writer *w) {
  vxm_deflater_destroy(w->state);
  w->state = NULL;
}

static vxm_status check_packed(const vxm_space *space, const vxm_values_spec *values, const char *path,
                               vxm_error *error) {
  (void)space, (void)values;
  return vxm_deflate_check(path, error);
}

static uint64_t held_packed(const vxm_space *space, const vxm_values_spec *values) {
  (void)space, (void)values;
  return VXM_DEFLATE_BYTES;
}

static const vxm_values_writer_kind plain_kind = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &vxm_sidecar_labels,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .file_bytes = vxm_values_plain_bytes,
    .begin = begin,
};

static const vxm_values_writer_kind packed_kind = {
    .layout = VXM_LAYOUT_GRID,
    .holds = VXM_HOLDS_ALL,
    .sidecar = &vxm_sidecar_labels,
    .stored = vxm_values_no_halves,
    .convert = vxm_values_widen_halves,
    .check = check_packed,
    .held_bytes = held_packed,
    .begin = begin_packed,
    .put_bytes = put_packed,
    .end = end_packed,
    .drop = drop_packed,
};

const vxm_grid_format vxm_format_nii = {
    .name = "nii",
    .holds = VXM_HOLDS_ALL,
    .sniff = sniff,
    .read = read_bits,
    .read_field = read_field,
    .values = &plain_kind,
};

const vxm_grid_format vxm_format_nii_gz = {
    .name = "nii.gz",
    .holds = VXM_HOLDS_ALL,
    .read = read_bits,
    .read_field = read_field,
    .values = &packed_kind,
};
