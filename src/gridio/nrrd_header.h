/* SPDX-License-Identifier: BSD-3-Clause */
/** The header of a .nrrd file: lines of text with the type, the sizes and the transform; the values behind
 * it.
 */
#ifndef VXM_GRIDIO_NRRD_HEADER_H
#define VXM_GRIDIO_NRRD_HEADER_H

#include "base/notes.h"
#include "base/output.h"

typedef struct vxm_nrrd_header {
  char kind;       /**< 'i' signed, 'u' unsigned, 'f' floating */
  size_t size;     /**< bytes of a value: 1, 2, 4 or 8 */
  bool big_endian; /**< of values longer than a byte */
  bool gzip;       /**< the values are compressed */
  vxm_space space; /**< not checked */
  size_t sizes_offset, data;
} vxm_nrrd_header;

bool vxm_nrrd_sniff(const vxm_input *input);
/** VXM_ERROR_FORMAT with the offset of what is wrong, or of what voxmend cannot take as a grid. */
vxm_status vxm_nrrd_header_read(vxm_nrrd_header *out, const vxm_input *input, vxm_notes *notes,
                                vxm_error *error);
/**
 * Writes the header, an empty line last. The values follow raw, x fastest, then y, then z.
 *
 * @param what a comment that says what the values are
 * @param type NRRD's name of the values, such as "uchar" or "float"
 * @param size of a value in bytes
 * @return VXM_OK, VXM_ERROR_MEMORY
 */
vxm_status vxm_nrrd_header_write(vxm_output *output, const char *what, const char *type, size_t size,
                                 const vxm_space *space, vxm_error *error);

#endif
