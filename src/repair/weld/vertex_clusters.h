/* SPDX-License-Identifier: BSD-3-Clause */
/** Clusters of near vertices that are to become one vertex each, without a face that loses a corner by it. */
#ifndef VXM_REPAIR_WELD_VERTEX_CLUSTERS_H
#define VXM_REPAIR_WELD_VERTEX_CLUSTERS_H

#include "mesh/disjoint_sets.h"
#include "mesh/soup.h"

/** A union-find structure, whose clusters know their vertices and their boxes. */
typedef struct vxm_vertex_clusters {
  vxm_context *context;
  const vxm_soup *soup;
  double scale; /**< of positions, see vxm_unit_scale */
  double width; /**< scaled: of the box of a cluster at most */
  uint32_t *parent, *size;
  uint32_t *ring;               /**< per vertex: the next of its cluster */
  struct vxm_vertex_box *boxes; /**< per root of a cluster of more than one */
  size_t *first_face;
  size_t *faces; /**< of vertex v: faces[first_face[v]] to faces[first_face[v + 1] - 1] */
} vxm_vertex_clusters;

/**
 * Puts each vertex into a cluster of its own. Destroyed with vxm_vertex_clusters_destroy, also after a
 * failure.
 *
 * @param soup has to stay
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_vertex_clusters_create(vxm_vertex_clusters *clusters, const vxm_soup *soup, double scale,
                                      double width, vxm_context *context, vxm_error *error);
void vxm_vertex_clusters_destroy(vxm_vertex_clusters *clusters);
/** The lowest vertex of a vertex's cluster, its root. */
static inline uint32_t vxm_vertex_clusters_root(const vxm_vertex_clusters *clusters, uint32_t v) {
  return vxm_set_of_u32(clusters->parent, v);
}

/** Whether the clusters of two roots may become one: not too wide or large, and no face with corners in both.
 */
bool vxm_vertex_clusters_may_unite(const vxm_vertex_clusters *clusters, uint32_t p, uint32_t q);
/** Makes one cluster of those of two roots. */
void vxm_vertex_clusters_unite(vxm_vertex_clusters *clusters, uint32_t p, uint32_t q);

#endif
