/* SPDX-License-Identifier: BSD-3-Clause */
/** Rows of bits as bytes, floats, or bits without padding. */
#ifndef VXM_AUGMENT_UNPACK_BITS_H
#define VXM_AUGMENT_UNPACK_BITS_H

#include "base/context.h"
#include "voxmend/sampler.h"

/** Bytes of a row of `dim` voxels. */
size_t vxm_unpack_row_bytes(vxm_voxel_format voxels, int64_t dim);

/**
 * Writes `rows` rows of `dim` voxels one after another.
 *
 * @param words each row in whole words, its unused bits zero
 * @param streaming  floats go past the cache, as they are so many that they would not stay in it
 */
void vxm_unpack_row(void *out, vxm_voxel_format voxels, const uint64_t *words, size_t rows, int64_t dim,
                    bool streaming);

#endif
