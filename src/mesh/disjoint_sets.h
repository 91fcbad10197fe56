/* SPDX-License-Identifier: BSD-3-Clause */
/** Sets of things in a row that are joined two at a time. */
#ifndef VXM_MESH_DISJOINT_SETS_H
#define VXM_MESH_DISJOINT_SETS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The member that stands for a set; `parent` of a new set is itself. Halves the way there. */
static inline size_t vxm_set_of(size_t *parent, size_t member) {
  while (parent[member] != member)
    member = parent[member] = parent[parent[member]];
  return member;
}

/** The same in 32 bits. */
static inline uint32_t vxm_set_of_u32(uint32_t *parent, uint32_t member) {
  while (parent[member] != member)
    member = parent[member] = parent[parent[member]];
  return member;
}

/** Joins two sets; what stands for the second one does for both. */
static inline void vxm_set_unite(size_t *parent, size_t one, size_t other) {
  parent[vxm_set_of(parent, one)] = vxm_set_of(parent, other);
}

/**
 * Joins the sets of u and v (Rem's algorithm with splicing: Dijkstra, "A Discipline of Programming", 1976).
 * Each points to itself at first; afterwards to one of its set that does not come later, and the first of a
 * set to itself.
 */
static inline void vxm_set_unite_in_order(uint32_t *parent, uint32_t u, uint32_t v) {
  while (parent[u] != parent[v]) {
    bool swaps = parent[u] < parent[v];
    uint32_t later = swaps ? v : u, earlier = swaps ? u : v, above = parent[later];
    parent[later] = parent[earlier];
    if (above == later)
      return;
    u = above;
    v = earlier;
  }
}

#endif
