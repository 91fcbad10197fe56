/* SPDX-License-Identifier: BSD-3-Clause */
/** Patches: faces that edges of exactly two sides connect, in a soup without edges of more. */
#ifndef VXM_MESH_PATCHES_H
#define VXM_MESH_PATCHES_H

#include "mesh/edges.h"

typedef struct vxm_patches {
  vxm_context *context;
  uint32_t *of_face; /**< numbered in the order of their first faces */
  size_t count;
  bool is_closed;  /**< every edge has two sides */
  bool may_repeat; /**< a face shares all its sides with one other face, which may be the same once more; if
                      not, no face repeats another (mesh/duplicate_faces.h) */
} vxm_patches;

/**
 * @param[out] out freed with vxm_patches_destroy; empty after a failure
 * @param edges    of the soup as it is, with their sides or what lies across these; none has more than two
 * @return VXM_OK, VXM_ERROR_RANGE beyond 2^32 - 1 faces, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_patches_build(vxm_patches *out, const vxm_soup *soup, const vxm_edges *edges,
                             vxm_error *error);
void vxm_patches_destroy(vxm_patches *patches);

/** Whether no vertex has faces of two patches, so that they are the components of the soup (vxm_components).
 */
vxm_status vxm_patches_are_apart(bool *apart, const vxm_patches *patches, const vxm_soup *soup,
                                 vxm_error *error);

#endif
