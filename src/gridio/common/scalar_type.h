/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Numbers in a file that become voxels: a voxel is set where its number is not zero. Whether anything is lost
 * by that is noted on the way.
 */
#ifndef VXM_GRIDIO_COMMON_SCALAR_TYPE_H
#define VXM_GRIDIO_COMMON_SCALAR_TYPE_H

#include "grid/bit_transpose.h"

#include <stdatomic.h>

/** What of a number makes it nonzero: all bytes, but for the sign of a floating-point number (-0 is 0). */
typedef struct vxm_scalar_type {
  size_t size;   /**< 1, 2, 4 or 8 bytes */
  uint64_t mask; /**< over the bytes as they lie in the file, the first lowest */
  uint64_t one;  /**< what 1 is, masked so */
  bool is_bool;  /**< whatever is not 0 is true */
  bool is_byte;  /**< unsigned */
} vxm_scalar_type;

/** Which numbers have been met, as bits. */
enum { VXM_SEEN_ZERO = 1, VXM_SEEN_ONE = 2, VXM_SEEN_FULL = 4 /**< the byte 255 */, VXM_SEEN_OTHER = 8 };

/** What is taken for bits. */
typedef enum vxm_bits_rule {
  VXM_BITS_ANY,    /**< numbers of which nothing is lost: vxm_grid_read in voxmend.h has the rule */
  VXM_BITS_STORED, /**< only what was meant so: booleans, and unsigned bytes of which all are 0 or 1 */
  VXM_BITS_NONE    /**< the values do not matter and are not read: only the space is wanted */
} vxm_bits_rule;

/** Whether numbers of which these have been met are bits. */
bool vxm_seen_bits(unsigned seen, vxm_scalar_type element, vxm_bits_rule rule);
/** Whether they can be, before they are looked at. */
bool vxm_scalar_type_may_be_bits(vxm_scalar_type element, vxm_bits_rule rule);

/** @param kind 'b' boolean, 'i' signed, 'u' unsigned, 'f' floating */
vxm_scalar_type vxm_scalar_type_of(char kind, size_t size, bool big_endian);

/** Fills `rows` rows of a grid from `row` on, out of elements that lie x fastest, row after row. Here
 * and below, what is met is added to `seen`. */
void vxm_scalar_types_to_rows(vxm_grid *grid, size_t row, size_t rows, const unsigned char *data,
                              vxm_scalar_type element, atomic_uint *seen);
/** Fills `count` planes, row after row of each. */
void vxm_scalar_types_to_planes(const vxm_bit_transpose *planes, size_t count, const unsigned char *data,
                                vxm_scalar_type element, atomic_uint *seen);
/** Fills a whole grid out of elements that lie x fastest, then y, then z, and reports progress. */
vxm_status vxm_scalar_types_to_grid(vxm_grid *grid, const unsigned char *data, vxm_scalar_type element,
                                    atomic_uint *seen, vxm_error *error);

#endif
