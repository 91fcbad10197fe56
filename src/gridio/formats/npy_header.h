/* SPDX-License-Identifier: BSD-3-Clause */
/** The header of a .npy file: a magic number, a version and a Python dictionary as text. */
#ifndef VXM_GRIDIO_FORMATS_NPY_HEADER_H
#define VXM_GRIDIO_FORMATS_NPY_HEADER_H

#include "base/output.h"

typedef struct vxm_npy_header {
  char kind;           /**< 'b' boolean, 'i' signed, 'u' unsigned, 'f' floating */
  bool big_endian;     /**< of elements longer than a byte */
  size_t size;         /**< bytes of an element: 1, 2, 4 or 8 */
  bool fortran;        /**< the first index is the fastest */
  int64_t shape[3];    /**< not checked */
  int channels;        /**< 4 if each place has four bytes, a colour; else 1 */
  size_t data;         /**< offset of the first element */
  size_t shape_offset; /**< for messages */
} vxm_npy_header;

bool vxm_npy_sniff(const vxm_input *input);
/** VXM_ERROR_FORMAT with the offset of what is wrong, or of what voxmend cannot take as a grid. */
vxm_status vxm_npy_header_read(vxm_npy_header *out, const vxm_input *input, vxm_error *error);
/**
 * Writes the header of an array, which begins at a multiple of 64 bytes.
 *
 * @param type    numpy's name of the elements, such as "|b1" or "|u1"
 * @param fortran whether the first index is the fastest
 */
void vxm_npy_header_write(vxm_output *output, const char *type, bool fortran, const int64_t shape[3]);
/** The same for an array of `last` bytes at each place of `shape`. */
void vxm_npy_header_write_bytes(vxm_output *output, const int64_t shape[3], int last);
/** The same for a table of rows, each of which lies together. */
void vxm_npy_header_write_table(vxm_output *output, const char *type, int64_t rows, int64_t columns);

#endif
