/* SPDX-License-Identifier: BSD-3-Clause */
/** Sets of things in a row that are joined two at a time. */
#ifndef VXM_MESH_DISJOINT_SETS_H
#define VXM_MESH_DISJOINT_SETS_H

#include <stdbool.h>
#include <stdint.h>

/**
 * Joins the sets of u and v (Rem's algorithm with splicing: Dijkstra, "A Discipline of Programming", 1976).
 * Each points to itself at first; afterwards to one of its set that does not come later, and the first of a
 * set to itself.
 */
static inline void vxm_sets_join(uint32_t *parent, uint32_t u, uint32_t v) {
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
