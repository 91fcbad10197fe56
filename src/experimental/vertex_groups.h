/* SPDX-License-Identifier: BSD-3-Clause */
/** Vertex grouping as Chen and Tu publish it (their algorithm of section 4). */
#ifndef VXM_EXPERIMENTAL_VERTEX_GROUPS_H
#define VXM_EXPERIMENTAL_VERTEX_GROUPS_H

#include "experimental/baseline.h"

/** Which group each triangle belongs to, and the triangles ordered by it. */
typedef struct vxm_vertex_groups {
  vxm_context *context;
  uint32_t *tags;    /**< of each vertex: the smallest number of a vertex of its group */
  uint32_t *members; /**< numbers of triangles, group after group */
  size_t *begin;     /**< group g has the members begin[g] to begin[g + 1] - 1 */
  size_t count;
} vxm_vertex_groups;

/** Finds them; `grouped` false makes one group of all. @param[out] out freed with vxm_vertex_groups_destroy,
 * also after a failure */
vxm_status vxm_vertex_groups_find(vxm_vertex_groups *out, const vxm_baseline_job *job, bool grouped,
                                  vxm_error *error);
void vxm_vertex_groups_destroy(vxm_vertex_groups *groups);

#endif
