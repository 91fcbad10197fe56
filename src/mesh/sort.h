/* SPDX-License-Identifier: BSD-3-Clause */
/** Sorting of 64-bit keys: of many in linear time, of few by insertion; and comparing pairs of them. */
#ifndef VXM_MESH_SORT_H
#define VXM_MESH_SORT_H

#include <stddef.h>
#include <stdint.h>

/** Sorts `count` keys upward; `scratch` has room for as many. */
void vxm_sort_keys(uint64_t *keys, uint64_t *scratch, size_t count);

/** Sorts by the bits from `shift` on; keys that are alike in these stay in their order. */
void vxm_sort_keys_above(uint64_t *keys, uint64_t *scratch, size_t count, unsigned shift);

/** Sorts a few keys upward. */
static inline void vxm_sort_few_keys(uint64_t *keys, size_t count) {
  for (size_t i = 1; i < count; i++) {
    uint64_t key = keys[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] > key; j--)
      keys[j] = keys[j - 1];
    keys[j] = key;
  }
}

/** Compares two pairs, for qsort: by their first numbers, and where these are equal by their second ones. */
static inline int vxm_compare_pairs(uint64_t p1, uint64_t p2, uint64_t q1, uint64_t q2) {
  return p1 != q1 ? (p1 < q1 ? -1 : 1) : (p2 > q2) - (p2 < q2);
}

#endif
