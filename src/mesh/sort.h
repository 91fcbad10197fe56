/* SPDX-License-Identifier: BSD-3-Clause */
/** Sorting of 64-bit keys in linear time. */
#ifndef VXM_MESH_SORT_H
#define VXM_MESH_SORT_H

#include <stddef.h>
#include <stdint.h>

/** Sorts `count` keys upward; `scratch` has room for as many. */
void vxm_sort_keys(uint64_t *keys, uint64_t *scratch, size_t count);

/** Sorts by the bits from `shift` on; keys that are alike in these stay in their order. */
void vxm_sort_keys_above(uint64_t *keys, uint64_t *scratch, size_t count, unsigned shift);

#endif
