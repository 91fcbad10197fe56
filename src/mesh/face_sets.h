/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Sets of faces that have nothing to do with each other: bodies of an assembly, which may share walls. Each
 * is repaired as a mesh of its own (repair/repair_sets.h), and what is a cavity is first looked for within
 * it.
 */
#ifndef VXM_MESH_FACE_SETS_H
#define VXM_MESH_FACE_SETS_H

#include "mesh/soup.h"

/** The faces of each set. */
typedef struct vxm_set_faces {
  vxm_context *context;
  uint32_t *faces; /**< those of set 0 first, each in the order of the soup */
  size_t *begin;   /**< set s has faces[begin[s]] to faces[begin[s + 1] - 1] */
} vxm_set_faces;

/**
 * Lists them; soup->face_sets is given.
 *
 * @param[out] out destroyed with vxm_set_faces_destroy, also after a failure
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_set_faces_create(vxm_set_faces *out, const vxm_soup *soup, vxm_error *error);
void vxm_set_faces_destroy(vxm_set_faces *list);

/** Makes vertices that several sets have one each. @return also VXM_ERROR_RANGE for too many vertices */
vxm_status vxm_face_sets_part(vxm_soup *soup, vxm_error *error);

/**
 * Which way faces are wound that are closed together: 1 = outward, -1 = inward, 0 = they enclose next to
 * nothing.
 *
 * @param faces numbers of them; NULL = the first `count`
 */
int vxm_faces_winding(const vxm_soup *soup, const uint32_t *faces, size_t count);

#endif
