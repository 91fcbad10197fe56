/* SPDX-License-Identifier: BSD-3-Clause */
/** Which parts a soup is voxelized in, and how each of them becomes closed. */
#ifndef VXM_VOXEL_PARTS_PARTS_H
#define VXM_VOXEL_PARTS_PARTS_H

#include "mesh/boundary_loops.h"
#include "mesh/caps.h"
#include "voxmend/voxelize.h"

typedef enum vxm_part_kind {
  VXM_PART_CLOSED, /**< every edge has an even number of faces */
  VXM_PART_CAPPED, /**< has holes; with caps over their rims it is closed */
  VXM_PART_OPEN    /**< sheets and fragments, which caps would only cover a second time */
} vxm_part_kind;

/** How to split. */
typedef struct vxm_split_rule {
  vxm_split_mode split_mode;
  vxm_cavities cavities;
  bool cap; /**< parts with holes are to be capped; else they are open */
} vxm_split_rule;

typedef struct vxm_split {
  vxm_context *context;
  uint32_t *component; /**< of every face */
  uint32_t *part;      /**< of every component */
  size_t component_count;
  size_t part_count;   /**< numbered closed first, then capped, then open */
  size_t kind_end[3];  /**< by kind: the first part behind those of the kind */
  size_t cavity_count; /**< components that share the part of the one around them, to be cut out of it */
  size_t capped_loops; /**< loops of capped parts */
  size_t odd_edge_count;
  uint8_t *lone; /**< per component: a lone sheet (lone_sheets.h); NULL if there is none */
  vxm_edges edges;
  vxm_boundary_loops loops;
  uint32_t *loop_part; /**< part of every loop */
  vxm_caps caps;       /**< of all loops, if parts are to be capped */
  size_t *cap_begin;   /**< loop l has the caps' triangles cap_begin[l] to cap_begin[l + 1] - 1; NULL without
                          caps */
} vxm_split;

/**
 * Splits a soup. A component is capped rather than open if its caps (the triangles from the centre of each
 * rim to its edges) have less than three quarters of its area: a body with holes. A panel would vanish under
 * its own cap.
 *
 * With VXM_SPLIT_MODE_AUTO every closed or capped component is a part, a cavity shares the part of the
 * component around it (parity then leaves it hollow), and all open components are one part, so that panels
 * which touch without sharing vertices are seen together. Those of them that are lone sheets are marked.
 *
 * @param[out] out freed with vxm_split_destroy, also after a failure
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_split_create(vxm_split *out, const vxm_soup *soup, vxm_split_rule rule, vxm_error *error);
/** Frees what is needed no more once triangles are made: all but the counts and the ends of the kinds. */
void vxm_split_trim(vxm_split *split);
void vxm_split_destroy(vxm_split *split);

#endif
