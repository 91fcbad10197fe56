/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Slices in. Each picture is decoded in a process of its own, as textures are; of the file only the size and
 * the type of its pixels are looked at here.
 */
#include "gridio/common/raster.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/slices.h"
#include "gridio/formats/tiff.h"
#include "mesh/appearance.h"
#include "sandbox/reader_process.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { HEADER = 33, GREY = 0, RGB = 2, PALETTE = 3, RGBA = 6 };

/** What a picture says at its begin. */
typedef struct header {
  uint32_t width, height;
  int bits, type; /**< of a TIFF file its vxm_scalar, and RGBA or GREY */
} header;

/** A sequence on its way in. */
typedef struct sequence {
  vxm_context *context;
  const char *path; /**< the pattern */
  int64_t number, begin;
  header first;
  vxm_raster raster;
  vxm_about about;
  bool has_place;
  int64_t beyond; /**< a slice that is there although the JSON counts fewer; 0 = none */
} sequence;

/* ---- Which there are ---- */

static bool is_there(const char *path, int64_t number) {
  char name[PATH_MAX];
  return vxm_slices_name(name, path, number) && access(name, F_OK) == 0;
}

/** From the first number, 0 or 1, to before the first gap. */
static vxm_status count_slices(sequence *s, vxm_error *error) {
  s->begin = is_there(s->path, 0) ? 0 : 1;
  int64_t end = s->begin;
  while (end - s->begin < VXM_SLICES_MAX && is_there(s->path, end))
    end++;
  s->raster.space.dims[2] = end - s->begin;
  s->number = s->begin;
  if (end > s->begin)
    return VXM_OK;
  errno = ENOENT;
  return vxm_fail_errno(error, s->path, "there is no slice 0 or 1");
}

/* ---- A picture ---- */

static uint32_t big_endian(const unsigned char *bytes) {
  return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static vxm_status read_header(header *out, const vxm_input *input, vxm_error *error) {
  if (input->size < HEADER || memcmp(input->data, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) != 0)
    return vxm_fail_byte(error, input, 0, "not a PNG file");
  *out =
      (header){big_endian(input->data + 16), big_endian(input->data + 20), input->data[24], input->data[25]};
  if (out->width == 0 || out->height == 0 || out->width > VXM_SLICES_SIDE_MAX ||
      out->height > VXM_SLICES_SIDE_MAX)
    return vxm_fail_byte(error, input, 16, "a picture of %" PRIu32 " x %" PRIu32 " pixels is not read",
                         out->width, out->height);
  bool is_color = out->type == RGB || out->type == RGBA || out->type == PALETTE;
  if (!is_color && out->type != GREY)
    return vxm_fail_byte(error, input, 25, "grey with opacity is not read; write it as grey or as RGBA");
  if (is_color && out->bits > 8)
    return vxm_fail_byte(error, input, 24, "colours of 16 bits are not read; write them with 8");
  return VXM_OK;
}

static bool is_color(const header *h) {
  return h->type != GREY;
}

/** Takes the values of decoded pixels, 4 bytes each: of grey the first two, the low one first. */
static void take_pixels(unsigned char *to, const unsigned char *pixels, const sequence *s) {
  size_t count = (size_t)s->first.width * s->first.height;
  if (is_color(&s->first)) {
    memcpy(to, pixels, 4 * count);
    return;
  }
  for (size_t p = 0; p < count; p++, pixels += 4)
    if (s->first.bits == 16) {
      uint16_t number = (uint16_t)(pixels[0] | pixels[1] << 8);
      memcpy(to + 2 * p, &number, sizeof number);
    } else
      to[p] = pixels[0];
}

static vxm_status decode(unsigned char *to, const sequence *s, const vxm_input *input, vxm_error *error) {
  const vxm_reader_request request = {
      .data = input->data, .size = input->size, .name = input->name, .hint = "slice"};
  vxm_error local = VXM_ERROR_INIT;
  vxm_soup *made;
  vxm_status status = vxm_reader_process_picture(&made, s->context, "reading slices", &request, &local);
  const vxm_image *image =
      status == VXM_OK && made->appearance->image_count == 1 ? made->appearance->images : NULL;
  if (image && image->bytes && image->width == s->first.width && image->height == s->first.height)
    take_pixels(to, image->bytes, s);
  else if (status == VXM_OK)
    status = vxm_fail_byte(error, input, 0, "no picture was made of it");
  else
    vxm_fail_at(error, status, (vxm_place){input->name, 0, -1, -1}, "%s", local.text);
  vxm_soup_destroy(made);
  return status;
}

/* ---- A TIFF file ---- */

/** Reads a file of one page, whose header is made to be compared; `to` may be NULL. */
static vxm_status read_page(unsigned char *to, header *out, const sequence *s, const vxm_input *input,
                            vxm_error *error) {
  vxm_field *field = NULL;
  vxm_status status = vxm_tiff_sniff(input) ? vxm_tiff_read_field(&field, input, error)
                                            : vxm_fail_byte(error, input, 0, "not a TIFF file");
  if (status != VXM_OK)
    return status;
  const int64_t *n = field->space.dims;
  const size_t size = vxm_field_voxel_bytes(field), columns = (size_t)n[0], rows = (size_t)n[1];
  *out = (header){(uint32_t)n[0], (uint32_t)n[1], (int)field->scalar, field->channels == 4 ? RGBA : GREY};
  if (n[2] != 1)
    status = vxm_fail_byte(error, input, 0, "it has %" PRId64 " pages, not the one of a slice", n[2]);
  else if (to && memcmp(out, &s->first, sizeof *out) == 0)
    for (size_t y = 0; y < rows; y++)
      for (size_t x = 0; x < columns; x++)
        memcpy(to + (y * columns + x) * size, field->values + (x * rows + y) * size, size);
  vxm_field_destroy(field);
  return status;
}

/** The next slice. */
static vxm_status take_slice(void *payload, void *slice, size_t size, vxm_error *error) {
  sequence *s = payload;
  char name[PATH_MAX];
  vxm_input input;
  header found;
  (void)size;
  vxm_slices_name(name, s->path, s->number++);
  vxm_status status = vxm_input_open(&input, s->context, name, error);
  if (status != VXM_OK)
    return status;
  const bool is_tiff = vxm_slices_are_tiff(s->path);
  status = is_tiff ? read_page(slice, &found, s, &input, error) : read_header(&found, &input, error);
  if (status == VXM_OK && memcmp(&found, &s->first, sizeof found) != 0)
    status = vxm_fail_byte(error, &input, 16, "its size or type is not that of the first slice");
  if (status == VXM_OK && !is_tiff)
    status = decode(slice, s, &input, error);
  vxm_input_close(&input);
  return status;
}

/* ---- The sequence ---- */

static vxm_status read_first(sequence *s, vxm_error *error) {
  char name[PATH_MAX];
  vxm_input input;
  vxm_slices_name(name, s->path, s->begin);
  vxm_status status = vxm_input_open(&input, s->context, name, error);
  if (status != VXM_OK)
    return status;
  const bool is_tiff = vxm_slices_are_tiff(s->path);
  status = is_tiff ? read_page(NULL, &s->first, s, &input, error) : read_header(&s->first, &input, error);
  vxm_input_close(&input);
  int channels = is_color(&s->first) ? 4 : 1;
  vxm_space space = s->raster.space;
  space.dims[0] = s->first.width;
  space.dims[1] = s->first.height;
  s->raster = vxm_raster_plain(&space,
                               is_tiff               ? (vxm_scalar)s->first.bits
                               : s->first.bits == 16 ? VXM_UINT16
                                                     : VXM_UINT8,
                               channels);
  return status;
}

static vxm_status read_place(sequence *s, vxm_error *error) {
  vxm_space *space = &s->raster.space, told;
  for (int a = 0; a < 3; a++)
    space->voxel_size[a] = 1;
  if (!vxm_sidecar_exists(s->path))
    return VXM_OK;
  vxm_status status = vxm_sidecar_read(&told, &s->about, s->context, s->path, "voxmend slices", error);
  if (status != VXM_OK)
    return status;
  if (told.dims[0] != space->dims[0] || told.dims[1] != space->dims[1] || told.dims[2] > space->dims[2])
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, (vxm_place){s->path, 0, -1, -1},
        "there are %" PRId64 " x %" PRId64 " x %" PRId64 " voxels without a gap, but the .json "
        "beside them has %" PRId64 " x %" PRId64 " x %" PRId64,
        space->dims[0], space->dims[1], space->dims[2], told.dims[0], told.dims[1], told.dims[2]);
  s->beyond = space->dims[2] > told.dims[2] ? s->begin + told.dims[2] : 0;
  s->has_place = true;
  *space = told;
  return VXM_OK;
}

static vxm_status open_sequence(sequence *s, const vxm_input *input, vxm_error *error) {
  *s = (sequence){.context = input->context, .path = input->name};
  vxm_status status = vxm_slices_check_pattern(s->path, error);
  if (status == VXM_OK)
    status = count_slices(s, error);
  if (status == VXM_OK)
    status = read_first(s, error);
  if (status == VXM_OK)
    status = read_place(s, error);
  return status == VXM_OK ? vxm_space_check_file(&s->raster.space, input, 0, error) : status;
}

static void warn(const sequence *s, vxm_warnings *warnings) {
  if (!s->has_place)
    vxm_warn(warnings, "there is no .json beside them: origin 0 0 0 and voxel size 1 are taken");
  if (s->beyond)
    vxm_warn(warnings, "slices from %" PRId64 " on are not those of the .json beside them, and are left out",
             s->beyond);
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  sequence s;
  vxm_status status = open_sequence(&s, input, error);
  if (status != VXM_OK) {
    vxm_about_destroy(&s.about);
    return status;
  }
  status = vxm_raster_read(out, &s.raster, s.context, &s.about, take_slice, &s, error);
  if (status == VXM_OK)
    warn(&s, &(*out)->warnings);
  return status;
}

/** Black and white of a field that is not said to be anything else are bits. */
static void take_bits(vxm_field *field) {
  size_t count = vxm_field_count(field);
  if (field->scalar != VXM_UINT8 || field->channels != 1 || field->about.is_declared)
    return;
  for (size_t v = 0; v < count; v++)
    if (field->values[v] != 0 && field->values[v] != UINT8_MAX)
      return;
  for (size_t v = 0; v < count; v++)
    field->values[v] &= 1;
}

static vxm_status read_pictures(vxm_field **out, const vxm_input *input, vxm_error *error) {
  vxm_status status = read_field(out, input, error);
  if (status == VXM_OK)
    take_bits(*out);
  return status;
}

static vxm_status read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  if (rule != VXM_BITS_NONE)
    return vxm_raster_bits_of_file(out, read_pictures, input, rule, error);
  sequence s;
  vxm_status status = open_sequence(&s, input, error);
  vxm_about_destroy(&s.about);
  if (status == VXM_OK)
    status = vxm_grid_create(out, s.context, &s.raster.space, error);
  if (status == VXM_OK)
    warn(&s, &(*out)->warnings);
  return status;
}

const vxm_grid_format vxm_format_png = {
    .name = "png",
    .holds = VXM_HOLDS_ALL,
    .read = read_bits,
    .read_field = read_field,
    .is_sequence = true,
    .values = &vxm_slices_values,
    .check_field = vxm_slices_check_field,
};

/** Not in the table of formats, where .tif is a stack: the pattern of a name leads here. */
const vxm_grid_format vxm_format_tif_slices = {
    .name = "tif",
    .holds = VXM_HOLDS_ALL,
    .read = read_bits,
    .read_field = read_field,
    .is_sequence = true,
    .values = &vxm_slices_tiff_values,
    .check_field = vxm_slices_check_field,
};
