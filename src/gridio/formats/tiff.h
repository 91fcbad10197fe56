/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .tif: a stack of slices across z as pages of a TIFF file, uncompressed; rows are along x, the first that of
 * y 0. The sizes of voxels and the origin are told as ImageJ does, and exactly in a line of ours.
 */
#ifndef VXM_GRIDIO_FORMATS_TIFF_H
#define VXM_GRIDIO_FORMATS_TIFF_H

#include "gridio/common/raster.h"

/** What of TIFF's fields is written or looked at. */
enum {
  VXM_TIFF_WIDTH = 256,
  VXM_TIFF_LENGTH = 257,
  VXM_TIFF_BITS = 258,
  VXM_TIFF_COMPRESSION = 259,
  VXM_TIFF_PHOTOMETRIC = 262,
  VXM_TIFF_DESCRIPTION = 270,
  VXM_TIFF_STRIP_OFFSETS = 273,
  VXM_TIFF_SAMPLES = 277,
  VXM_TIFF_ROWS_PER_STRIP = 278,
  VXM_TIFF_STRIP_BYTES = 279,
  VXM_TIFF_X_RESOLUTION = 282,
  VXM_TIFF_Y_RESOLUTION = 283,
  VXM_TIFF_PLANAR = 284,
  VXM_TIFF_UNIT = 296,
  VXM_TIFF_TILE_WIDTH = 322,
  VXM_TIFF_EXTRA = 338,
  VXM_TIFF_SAMPLE_FORMAT = 339
};

/** Types of fields. */
enum {
  VXM_TIFF_ASCII = 2,
  VXM_TIFF_SHORT = 3,
  VXM_TIFF_LONG = 4,
  VXM_TIFF_RATIONAL = 5,
  VXM_TIFF_LONG8 = 16
};

/** What begins the line that says exactly what ImageJ's lines say: "voxmend=KIND ORIGIN SIZE". */
#define VXM_TIFF_LINE "voxmend="

struct vxm_values_writer;
/** Writes slice z of a file of values as a TIFF file of its own. */
vxm_status vxm_tiff_write_page(const struct vxm_values_writer *writer, vxm_output *output, const void *values,
                               int64_t z, vxm_error *error);

bool vxm_tiff_sniff(const vxm_input *input);
vxm_status vxm_tiff_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
vxm_status vxm_tiff_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);

#endif
