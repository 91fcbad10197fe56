/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers in a file that become voxels: a voxel is set where its number is not zero. */
#ifndef VXM_GRIDIO_ELEMENTS_H
#define VXM_GRIDIO_ELEMENTS_H

#include "gridio/planes.h"

/** What of a number makes it nonzero: all bytes, but for the sign of a floating-point number (-0 is 0). */
typedef struct vxm_element {
  size_t size;   /**< 1, 2, 4 or 8 bytes */
  uint64_t mask; /**< over the bytes as they lie in the file, the first lowest */
} vxm_element;

/** @param kind 'b' boolean, 'i' signed, 'u' unsigned, 'f' floating */
vxm_element vxm_element_of(char kind, size_t size, bool big_endian);

/** Fills `rows` rows of a grid from `row` on, out of elements that lie x fastest, row after row. */
void vxm_elements_to_rows(vxm_grid *grid, size_t row, size_t rows, const unsigned char *data,
                          vxm_element element);
/** Fills `count` planes, row after row of each. */
void vxm_elements_to_planes(const vxm_planes *planes, size_t count, const unsigned char *data,
                            vxm_element element);
/** Fills a whole grid out of elements that lie x fastest, then y, then z, and reports progress. */
vxm_status vxm_elements_to_grid(vxm_grid *grid, const unsigned char *data, vxm_element element,
                                vxm_error *error);

#endif
