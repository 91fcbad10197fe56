/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The sides of faces, dealt out by the lower of their two vertices: the first step towards the edge map, and
 * all that is needed to see that a soup is closed.
 */
#ifndef VXM_MESH_SIDE_TABLE_H
#define VXM_MESH_SIDE_TABLE_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Records are (higher vertex, corner at which the side begins). Those of a vertex follow one another, first
 * the sides that run upward from it, then those that run down to it, each in the order of faces as long as
 * nobody has sorted them.
 */
typedef struct vxm_side_table {
  vxm_context *context;
  uint64_t *records;
  size_t count;
  uint32_t *ends; /**< two per vertex: where its upward sides end, and where its downward ones do */
  size_t vertex_count;
  size_t largest;    /**< most upward, or downward, sides of a vertex */
  bool is_balanced;  /**< each vertex has as many of the one as of the other */
  bool is_triangles; /**< all faces are, so that corner c is of face c / 3 */
} vxm_side_table;

/** The sides of one vertex: `up` and `down` are where records of the one and the other kind begin. */
typedef struct vxm_side_group {
  size_t up, down, end;
} vxm_side_group;

/**
 * @param[out] out   freed with vxm_side_table_destroy; a failure leaves nothing to free
 * @param vertex_map vertex to take in place of each vertex, or NULL
 *
 * Faces with fewer than three distinct corners (after mapping) take no part, and a side from a vertex to
 * itself is none. Takes 8 bytes for each corner and each vertex; with several threads up to twice as much.
 *
 * @return VXM_OK; VXM_ERROR_RANGE beyond 2^32 - 2 corners; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_side_table_build(vxm_side_table *out, vxm_context *context, const vxm_soup *soup,
                                const uint32_t *vertex_map, vxm_error *error);
void vxm_side_table_destroy(vxm_side_table *table);

static inline vxm_side_group vxm_side_group_of(const vxm_side_table *table, size_t vertex) {
  const uint32_t *ends = table->ends + 2 * vertex;
  return (vxm_side_group){vertex > 0 ? ends[-1] : 0, ends[0], ends[1]};
}

static inline uint32_t vxm_side_high(uint64_t record) {
  return (uint32_t)(record >> 32);
}

static inline uint32_t vxm_side_corner(uint64_t record) {
  return (uint32_t)record;
}

/** Whether a face has at least three distinct corners after mapping. */
static inline bool vxm_face_has_three(const uint32_t *corners, size_t count, const uint32_t *vertex_map) {
  uint32_t first = VXM_NO_VERTEX, second = VXM_NO_VERTEX;
  for (size_t i = 0; i < count; i++) {
    uint32_t v = vertex_map ? vertex_map[corners[i]] : corners[i];
    if (first == VXM_NO_VERTEX)
      first = v;
    else if (v != first) {
      if (second == VXM_NO_VERTEX)
        second = v;
      else if (v != second)
        return true;
    }
  }
  return false;
}

#ifdef __cplusplus
}
#endif
#endif
