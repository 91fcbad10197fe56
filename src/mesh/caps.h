/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles that close loops of odd edges. */
#ifndef VXM_MESH_CAPS_H
#define VXM_MESH_CAPS_H

#include "mesh/boundary_loops.h"
#include "mesh/unit_scale.h"

/** Caps of the loops added so far. New vertices are numbered on from those of the soup. */
typedef struct vxm_caps {
  const vxm_soup *soup;
  const vxm_edges *edges;
  double scale; /**< of positions where lengths and areas are computed, see vxm_unit_scale */
  uint32_t (*triangles)[3];
  size_t triangle_count, triangle_capacity;
  double (*points)[3]; /**< new vertices, model units */
  size_t point_count, point_capacity;
  struct vxm_cap_step *steps; /**< scratch: a stack of loops */
  size_t step_capacity;
  uint64_t *chords; /**< a hash of the edges made so far between old vertices, by both vertices; 0 = free */
  size_t chord_count, chord_slots;
  double *along; /**< scratch: length of the walk up to each step */
  size_t along_capacity;
} vxm_caps;

/**
 * Adds the cap of a loop: triangles that have each edge of the loop as a side once, against its majority of
 * sides, and all their other edges twice.
 *
 * A triangle closes a loop of three edges (`plain`: no face has the same three corners), two triangles one of
 * four, and a fan about a new vertex at the centroid a longer one. A loop of more than 64 edges, or one far
 * from flat, is first cut along chords between vertices that are much nearer to each other than along the
 * walk; a bounded number of chords is tried for each cut. Any loop is cut at the mouth of a slit, where the
 * chord is shorter still: it would draw the centroid away from where the loop is flat.
 *
 * @return VXM_OK, VXM_ERROR_RANGE beyond VXM_VERTICES_MAX, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_caps_add(vxm_caps *caps, const vxm_boundary_loops *loops, size_t loop, bool plain,
                        vxm_error *error);
/** Position of a vertex of the soup or a new one. */
const double *vxm_caps_position(const vxm_caps *caps, uint32_t vertex);
/** The area of some of the triangles, scaled. */
double vxm_caps_area(const vxm_caps *caps, size_t first, size_t end);
void vxm_caps_destroy(vxm_caps *caps);

#endif
