/* SPDX-License-Identifier: BSD-3-Clause */
/** PNG pictures written row by row through libpng, if the build has it. */
#ifndef VXM_GRIDIO_COMMON_PNG_WRITE_H
#define VXM_GRIDIO_COMMON_PNG_WRITE_H

#include "base/output.h"

typedef struct vxm_png vxm_png;

/** Whether this build can write pictures; VXM_ERROR_UNAVAILABLE if not. */
vxm_status vxm_png_check(vxm_error *error);

/** Begins a picture of 8-bit red, green and blue. The output stays the caller's. */
vxm_status vxm_png_create(vxm_png **out, vxm_context *context, vxm_output *output, int width, int height,
                          vxm_error *error);
/** What a pixel is. */
typedef struct vxm_png_pixels {
  int channels; /**< 1 grey, 3 red, green and blue, 4 with opacity */
  int bits;     /**< of each: 8, or 16, the high byte first */
} vxm_png_pixels;

/** The same for other pixels. */
vxm_status vxm_png_create_of(vxm_png **out, vxm_context *context, vxm_output *output, int width, int height,
                             vxm_png_pixels pixels, vxm_error *error);
/** Adds `count` rows of width pixels, from the top down. */
vxm_status vxm_png_rows(vxm_png *png, const unsigned char *rows, int count, vxm_error *error);
/** Writes the end; all rows must have been added. */
vxm_status vxm_png_finish(vxm_png *png, vxm_error *error);
/** NULL is allowed. */
void vxm_png_destroy(vxm_png *png);

#endif
