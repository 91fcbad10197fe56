/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .png and .tif: a picture for each z, numbered by a pattern in the name such as slice_%04d.png; rows are
 * along x, the first that of y 0. Place and kind stand in a JSON file beside them, slice_%04d.png.json. In
 * .png bits are 0 and 255, bytes and 16-bit numbers grey, colours RGBA; a .tif is a stack of one page
 * (tiff.h).
 */
#ifndef VXM_GRIDIO_FORMATS_SLICES_H
#define VXM_GRIDIO_FORMATS_SLICES_H

#include "gridio/common/format.h"

#include <limits.h>

/** libpng reads no picture that is wider or higher. */
enum { VXM_SLICES_SIDE_MAX = 1000000, VXM_SLICES_MAX = 1 << 20 };

/** Whether a path ends in .png or .tif, and its last part has one '%', of %d or %0Nd with N of 1 to 9. */
bool vxm_slices_is_pattern(const char *path);
/** Whether it is one of TIFF files. */
bool vxm_slices_are_tiff(const char *path);
/** The name of a slice; false if it is too long. The path is a pattern. */
bool vxm_slices_name(char out[PATH_MAX], const char *path, int64_t number);
/** Refuses a path that is no pattern, and says what one is. */
vxm_status vxm_slices_check_pattern(const char *path, vxm_error *error);

extern const struct vxm_values_writer_kind vxm_slices_values, vxm_slices_tiff_values;

vxm_status vxm_slices_check_field(const vxm_field *field, const char *path, vxm_error *error);

#endif
