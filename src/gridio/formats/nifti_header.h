/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The header of NIfTI-1 and NIfTI-2 files, where image and header are one file. The world of a NIfTI file has
 * its axes to the right, to the front and up (RAS+); model coordinates x, y, z are taken for these as they
 * are.
 */
#ifndef VXM_GRIDIO_FORMATS_NIFTI_HEADER_H
#define VXM_GRIDIO_FORMATS_NIFTI_HEADER_H

#include "gridio/common/raster.h"
#include "gridio/common/values_writer.h"

/** Of the header alone, without the 4 bytes that say whether extensions follow. */
enum { VXM_NIFTI_1 = 348, VXM_NIFTI_2 = 540, VXM_NIFTI_MARK = 4 };

/** What a header says. */
typedef struct vxm_nifti_header {
  vxm_raster raster;
  bool is_swapped;
  uint64_t data; /**< offset of the first value */
  vxm_about about;
} vxm_nifti_header;

/** Bytes of the header that these bytes begin, VXM_NIFTI_1 or VXM_NIFTI_2; 0 if they begin none. */
size_t vxm_nifti_header_size(const unsigned char *data, size_t size);
/**
 * Reads a header.
 *
 * @param data vxm_nifti_header_size bytes
 * @return VXM_OK; VXM_ERROR_FORMAT, VXM_ERROR_RANGE with what voxmend cannot take as a grid
 */
vxm_status vxm_nifti_header_read(vxm_nifti_header *out, const unsigned char *data, size_t size,
                                 const vxm_input *input, vxm_error *error);
/** Takes what voxmend has written between header and values: the exact place. */
void vxm_nifti_extension_read(vxm_nifti_header *header, const unsigned char *data, size_t size);

/** A header to be written, with the extension behind it. */
typedef struct vxm_nifti_block {
  unsigned char bytes[1024];
  size_t size; /**< the values follow */
} vxm_nifti_block;

void vxm_nifti_header_make(vxm_nifti_block *out, const vxm_space *space, const vxm_values_spec *values);

#endif
