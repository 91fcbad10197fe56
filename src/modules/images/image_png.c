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

#else

vxm_status vxm_picture_read_png(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                vxm_error *error) {
  (void)image;
  (void)context;
  (void)file;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "this build reads no PNG (Debian: libpng-dev)");
}

#endif
