/* SPDX-License-Identifier: BSD-3-Clause */
/** .nrrd: a text header with the transform, and the values behind it. */
#ifndef VXM_GRIDIO_NRRD_H
#define VXM_GRIDIO_NRRD_H

#include "base/file.h"

/**
 * Writes the header, an empty line last. The values follow raw, x fastest, then y, then z.
 *
 * @param type NRRD's name of the values, such as "uchar" or "float"
 * @param size of a value in bytes
 */
void vxm_nrrd_header_write(vxm_output *output, const char *type, size_t size, const vxm_space *space);

#endif
