/* SPDX-License-Identifier: BSD-3-Clause */
#include "config.h"

#include "gridio/common/png_write.h"

#ifdef HAVE_PNG

#include <png.h>

/**
 * libpng leaves a failed call by longjmp. Each function below sets its own return point, calls libpng and
 * keeps no local variable that changes in between, so nothing is lost by the jump.
 */
struct vxm_png {
  vxm_context *context;
  vxm_output *output;
  png_structp writer;
  png_infop info;
  size_t row_bytes;
  vxm_error error; /**< of the allocation that failed, or libpng's own words */
};

static void on_error(png_structp writer, png_const_charp text) {
  vxm_png *png = png_get_error_ptr(writer);
  if (png->error.code == VXM_OK)
    vxm_fail(&png->error, VXM_ERROR_IO, "the picture cannot be written: %s", text);
  png_longjmp(writer, 1);
}

static void on_warning(png_structp writer, png_const_charp text) {
  (void)writer;
  (void)text;
}

static png_voidp on_allocate(png_structp writer, png_alloc_size_t size) {
  vxm_png *png = png_get_mem_ptr(writer);
  return vxm_alloc(png->context, size, 1, &png->error);
}

static void on_free(png_structp writer, png_voidp block) {
  vxm_png *png = png_get_mem_ptr(writer);
  vxm_free(png->context, block);
}

static void on_write(png_structp writer, png_bytep data, size_t size) {
  vxm_png *png = png_get_io_ptr(writer);
  vxm_output_write(png->output, data, size);
}

static void on_flush(png_structp writer) {
  (void)writer;
}

static vxm_status fail(const vxm_png *png, vxm_error *error) {
  if (png->error.code == VXM_OK)
    return vxm_fail(error, VXM_ERROR_MEMORY, "the picture cannot be written: out of memory");
  vxm_error_pass(error, &png->error);
  return png->error.code;
}

vxm_status vxm_png_check(vxm_error *error) {
  (void)error;
  return VXM_OK;
}

static int color_type(vxm_png_pixels pixels) {
  return pixels.channels == 1   ? PNG_COLOR_TYPE_GRAY
         : pixels.channels == 3 ? PNG_COLOR_TYPE_RGB
                                : PNG_COLOR_TYPE_RGB_ALPHA;
}

/** Grey is numbers, and no light of any kind. */
static vxm_status begin(vxm_png *png, int width, int height, vxm_png_pixels pixels, vxm_error *error) {
  if (setjmp(png_jmpbuf(png->writer)))
    return fail(png, error);
  png_set_write_fn(png->writer, png, on_write, on_flush);
  png_set_IHDR(png->writer, png->info, (png_uint_32)width, (png_uint_32)height, pixels.bits,
               color_type(pixels), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  /* Above this level drawing would wait for zlib, for a few hundredths of the size. */
  png_set_compression_level(png->writer, 4);
  if (pixels.channels > 1)
    png_set_sRGB(png->writer, png->info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png->writer, png->info);
  return VXM_OK;
}

vxm_status vxm_png_create_of(vxm_png **out, vxm_context *context, vxm_output *output, int width, int height,
                             vxm_png_pixels pixels, vxm_error *error) {
  *out = NULL;
  vxm_status status = VXM_OK;
  vxm_png *png = vxm_try_calloc(context, 1, sizeof *png, &status, error);
  if (!png)
    return status;
  png->context = context;
  png->output = output;
  png->row_bytes = (size_t)(pixels.channels * pixels.bits / 8) * (size_t)width;
  png->writer =
      png_create_write_struct_2(PNG_LIBPNG_VER_STRING, png, on_error, on_warning, png, on_allocate, on_free);
  if (png->writer)
    png->info = png_create_info_struct(png->writer);
  status = png->info ? begin(png, width, height, pixels, error) : fail(png, error);
  if (status != VXM_OK) {
    vxm_png_destroy(png);
    return status;
  }
  *out = png;
  return VXM_OK;
}

vxm_status vxm_png_rows(vxm_png *png, const unsigned char *rows, int count, vxm_error *error) {
  if (setjmp(png_jmpbuf(png->writer)))
    return fail(png, error);
  for (int r = 0; r < count; r++)
    png_write_row(png->writer, rows + (size_t)r * png->row_bytes);
  return VXM_OK;
}

vxm_status vxm_png_finish(vxm_png *png, vxm_error *error) {
  if (setjmp(png_jmpbuf(png->writer)))
    return fail(png, error);
  png_write_end(png->writer, png->info);
  return VXM_OK;
}

void vxm_png_destroy(vxm_png *png) {
  if (!png)
    return;
  if (png->writer)
    png_destroy_write_struct(&png->writer, &png->info);
  vxm_free(png->context, png);
}

#else

vxm_status vxm_png_check(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "pictures need libpng, which this build lacks; configure voxmend with --with-png");
}

vxm_status vxm_png_create_of(vxm_png **out, vxm_context *context, vxm_output *output, int width, int height,
                             vxm_png_pixels pixels, vxm_error *error) {
  (void)context, (void)output, (void)width, (void)height, (void)pixels;
  *out = NULL;
  return vxm_png_check(error);
}

vxm_status vxm_png_rows(vxm_png *png, const unsigned char *rows, int count, vxm_error *error) {
  (void)png, (void)rows, (void)count;
  return vxm_png_check(error);
}

vxm_status vxm_png_finish(vxm_png *png, vxm_error *error) {
  (void)png;
  return vxm_png_check(error);
}

void vxm_png_destroy(vxm_png *png) {
  (void)png;
}

#endif

vxm_status vxm_png_create(vxm_png **out, vxm_context *context, vxm_output *output, int width, int height,
                          vxm_error *error) {
  return vxm_png_create_of(out, context, output, width, height, (vxm_png_pixels){3, 8}, error);
}
