/* SPDX-License-Identifier: BSD-3-Clause */
/** The module voxmend-images.so: textures of meshes, and slices of grids, through libpng and libjpeg. */
#include "modules/images/images.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/module.h"
#include "config.h"

vxm_status vxm_picture_begin(vxm_image *image, vxm_context *context, uint64_t width, uint64_t height,
                             const vxm_picture_file *file, vxm_error *error) {
  (void)file;
  if (width == 0 || height == 0 || width > UINT32_MAX || height > UINT32_MAX ||
      width > VXM_PIXELS_MAX / height)
    return vxm_fail(error, VXM_ERROR_RANGE, "a picture of %" PRIu64 " x %" PRIu64 " pixels is not read",
                    width, height);
  vxm_error local = VXM_ERROR_INIT;
  image->bytes = vxm_alloc(context, (size_t)(width * height), 4, &local);
  if (!image->bytes)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "there is not enough memory for a picture of %" PRIu64 " x %" PRIu64 " pixels", width,
                    height);
  image->width = (uint32_t)width;
  image->height = (uint32_t)height;
  image->size = 4 * width * height;
  return VXM_OK;
}

/** What a picture is that is neither PNG nor JPEG. */
static const char *kind_of(const vxm_picture_file *file) {
  static const struct {
    size_t at;
    const char *magic, *name;
  } kinds[] = {{0, "BM", "BMP"},     {0, "GIF8", "GIF"},       {0, "DDS ", "DDS"},   {0, "II*", "TIFF"},
               {0, "MM", "TIFF"},    {8, "WEBP", "WebP"},      {0, "#?RADI", "HDR"}, {0, "8BPS", "PSD"},
               {1, "KTX 20", "KTX"}, {0, "v/1\x01", "OpenEXR"}};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    size_t length = strlen(kinds[k].magic);
    if (file->size >= kinds[k].at + length && memcmp(file->data + kinds[k].at, kinds[k].magic, length) == 0)
      return kinds[k].name;
  }
  return "unknown";
}

static vxm_status decode(vxm_image *image, vxm_context *context, const vxm_picture_file *file, bool is_slice,
                         vxm_error *error) {
  if (is_slice)
    return vxm_picture_read_slice(image, context, file, error);
  if (vxm_picture_is_png(file))
    return vxm_picture_read_png(image, context, file, error);
  if (vxm_picture_is_jpeg(file))
    return vxm_picture_read_jpeg(image, context, file, error);
  return vxm_fail(error, VXM_ERROR_FORMAT, "its format is %s; PNG and JPEG are read", kind_of(file));
}

static vxm_status read_image(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  const vxm_picture_file file = {request->data, request->size, request->name};
  uint32_t index;
  if (!soup->appearance)
    return vxm_fail(error, VXM_ERROR_FORMAT, "a picture is no mesh");
  vxm_status status = vxm_appearance_image(soup->appearance, "", 0, &index, error);
  if (status != VXM_OK)
    return status;
  return decode(&soup->appearance->images[index], soup->context, &file, strcmp(request->hint, "slice") == 0,
                error);
}

static void prepare(void) {
}

static const vxm_reader reader = {prepare, read_image, NULL};

__attribute__((visibility("default"))) extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "libpng, libjpeg", "BSD-3-Clause", &reader};
