/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/images/images.h"

#include <string.h>

#include "config.h"

bool vxm_picture_is_png(const vxm_picture_file *file) {
  return file->size >= 8 && memcmp(file->data, "\x89PNG\r\n\x1a\n", 8) == 0;
}

#ifdef HAVE_PNG

#include <png.h>

/** libpng's own simple functions: they keep the long jumps to themselves, and turn 16 bits, palettes and
 * other gammas into bytes of sRGB. */
vxm_status vxm_picture_read_png(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                vxm_error *error) {
  png_image png;
  memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&png, file->data, file->size))
    return vxm_fail(error, VXM_ERROR_FORMAT, "damaged PNG: %s", png.message);
  png.format = PNG_FORMAT_RGBA;
  vxm_status status = vxm_picture_begin(image, context, png.width, png.height, file, error);
  if (status == VXM_OK && !png_image_finish_read(&png, NULL, image->bytes, 0, NULL))
    status = vxm_fail(error, VXM_ERROR_FORMAT, "damaged PNG: %s", png.message);
  png_image_free(&png);
  return status;
}

/** A picture that is read number by number, of which the simple functions make light. */
typedef struct slice {
  const vxm_picture_file *file;
  size_t at;
  png_structp reader;
  png_infop info;
  int passes;
  vxm_error error;
} slice;

static void on_error(png_structp reader, png_const_charp text) {
  slice *s = png_get_error_ptr(reader);
  vxm_fail(&s->error, VXM_ERROR_FORMAT, "damaged PNG: %s", text);
  png_longjmp(reader, 1);
}

static void on_warning(png_structp reader, png_const_charp text) {
  (void)reader, (void)text;
}

static void on_read(png_structp reader, png_bytep to, size_t size) {
  slice *s = png_get_io_ptr(reader);
  if (size > s->file->size - s->at)
    png_error(reader, "it is cut short");
  memcpy(to, s->file->data + s->at, size);
  s->at += size;
}

/** Asks for grey of 8 or 16 bits as they are, or for RGBA. */
static bool read_header(slice *s) {
  if (setjmp(png_jmpbuf(s->reader)))
    return false;
  png_set_read_fn(s->reader, s, on_read);
  png_read_info(s->reader, s->info);
  png_byte type = png_get_color_type(s->reader, s->info);
  png_set_packing(s->reader);
  if (type == PNG_COLOR_TYPE_GRAY)
    return true;
  if (type == PNG_COLOR_TYPE_GRAY_ALPHA || png_get_bit_depth(s->reader, s->info) > 8)
    png_error(s->reader, "its pixels are of a kind that is not read");
  png_set_expand(s->reader);
  png_set_add_alpha(s->reader, UINT8_MAX, PNG_FILLER_AFTER);
  return true;
}

/** The rows of all passes, over those of earlier ones; a row of grey has at most half of its room. */
static bool read_rows(slice *s, vxm_image *image) {
  if (setjmp(png_jmpbuf(s->reader)))
    return false;
  s->passes = png_set_interlace_handling(s->reader);
  png_read_update_info(s->reader, s->info);
  if (png_get_rowbytes(s->reader, s->info) > 4 * (size_t)image->width)
    png_error(s->reader, "its rows are longer than its size says");
  for (int pass = 0; pass < s->passes; pass++)
    for (size_t y = 0; y < image->height; y++)
      png_read_row(s->reader, image->bytes + 4 * y * image->width, NULL);
  png_read_end(s->reader, NULL);
  return true;
}

/** Spreads the numbers of a row over 4 bytes each, from the last one on. */
static void spread(unsigned char *row, size_t width, bool is_wide) {
  for (size_t x = width; x-- > 0;) {
    unsigned char high = is_wide ? row[2 * x] : 0, low = is_wide ? row[2 * x + 1] : row[x];
    row[4 * x] = low;
    row[4 * x + 1] = high;
    row[4 * x + 2] = row[4 * x + 3] = 0;
  }
}

static vxm_status read_slice(slice *s, vxm_image *image, vxm_context *context, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (!read_header(s))
    return vxm_fail(error, VXM_ERROR_FORMAT, "%s", s->error.text);
  status = vxm_picture_begin(image, context, png_get_image_width(s->reader, s->info),
                             png_get_image_height(s->reader, s->info), s->file, error);
  if (status != VXM_OK)
    return status;
  bool is_grey = png_get_color_type(s->reader, s->info) == PNG_COLOR_TYPE_GRAY,
       is_wide = png_get_bit_depth(s->reader, s->info) == 16;
  memset(image->bytes, 0, (size_t)image->size);
  if (!read_rows(s, image))
    return vxm_fail(error, VXM_ERROR_FORMAT, "%s", s->error.text);
  for (size_t y = 0; y < image->height && is_grey; y++)
    spread(image->bytes + 4 * y * image->width, image->width, is_wide);
  return VXM_OK;
}

vxm_status vxm_picture_read_slice(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                  vxm_error *error) {
  slice s = {.file = file, .error = VXM_ERROR_INIT};
  s.reader = png_create_read_struct(PNG_LIBPNG_VER_STRING, &s, on_error, on_warning);
  if (s.reader)
    s.info = png_create_info_struct(s.reader);
  vxm_status status = s.info ? read_slice(&s, image, context, error)
                             : vxm_fail(error, VXM_ERROR_MEMORY, "out of memory for a picture");
  png_destroy_read_struct(&s.reader, &s.info, NULL);
  return status;
}

#else

vxm_status vxm_picture_read_slice(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                  vxm_error *error) {
  return vxm_picture_read_png(image, context, file, error);
}

vxm_status vxm_picture_read_png(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                vxm_error *error) {
  (void)image;
  (void)context;
  (void)file;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "this build reads no PNG (Debian: libpng-dev)");
}

#endif
