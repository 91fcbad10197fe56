/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the image module share. */
#ifndef VXM_MODULES_IMAGES_IMAGES_H
#define VXM_MODULES_IMAGES_IMAGES_H

#include "sandbox/reader.h"

/** A picture in memory that is to be decoded. */
typedef struct vxm_picture_file {
  const unsigned char *data;
  size_t size;
  const char *name; /**< for messages */
} vxm_picture_file;

/** Gives an image its size, and room for its pixels. @return VXM_OK; VXM_ERROR_RANGE if it has none or too
 * many; VXM_ERROR_MEMORY */
vxm_status vxm_picture_begin(vxm_image *image, vxm_context *context, uint64_t width, uint64_t height,
                             const vxm_picture_file *file, vxm_error *error);

bool vxm_picture_is_png(const vxm_picture_file *file);
bool vxm_picture_is_jpeg(const vxm_picture_file *file);

/* Each decodes into an image that has nothing yet. @return VXM_OK; VXM_ERROR_FORMAT; VXM_ERROR_UNAVAILABLE if
 * this build lacks the library; as vxm_picture_begin */
vxm_status vxm_picture_read_png(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                vxm_error *error);
/* The numbers of a slice, as they stand in the file: grey as two bytes, the low one first, and two of 0;
 * colours as RGBA. */
vxm_status vxm_picture_read_slice(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                  vxm_error *error);
vxm_status vxm_picture_read_jpeg(vxm_image *image, vxm_context *context, const vxm_picture_file *file,
                                 vxm_error *error);

#endif
