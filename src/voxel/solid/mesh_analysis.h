/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What is known of a mesh whatever the grid: made once, then only read, and shared by all passes over it, in
 * whatever thread each of them works.
 */
#ifndef VXM_VOXEL_SOLID_MESH_ANALYSIS_H
#define VXM_VOXEL_SOLID_MESH_ANALYSIS_H

#include "voxel/winding/oriented_chain.h"
#include "voxel/winding/self_overlap.h"

#include <pthread.h>

typedef struct vxm_mesh_analysis vxm_mesh_analysis;

/** A chain that costs much, is rarely needed, and so is made by the first thread that asks for it. */
typedef struct vxm_chain_once {
  pthread_mutex_t mutex;   /**< held while the chain is made, and to look whether it is */
  vxm_winding_chain chain; /**< `closed` NULL = not made yet; else it stays as it is */
} vxm_chain_once;

typedef struct vxm_orientation {
  vxm_chain_once open, all; /**< of the open parts, and of all */
} vxm_orientation;

struct vxm_mesh_analysis {
  vxm_context *context;
  const vxm_soup *soup;
  vxm_triangle_set triangles;
  vxm_self_overlap self_overlap; /**< none if they were not looked for */
  vxm_orientation *orientation;  /**< see solid/orient_open.h and solid/orient_all.h */
};

/** Destroy with vxm_mesh_analysis_destroy, also after a failure. `overlaps`: whether parts that lie in
 * themselves are looked for. @return as vxm_model_create */
vxm_status vxm_mesh_analysis_create(vxm_mesh_analysis *out, const vxm_soup *soup, vxm_split_rule rule,
                                    bool overlaps, vxm_error *error);
void vxm_mesh_analysis_destroy(vxm_mesh_analysis *analysis);

/** Finds out which triangles face inward, from what `payload` says. */
typedef vxm_status (*vxm_facing_finder)(vxm_facings *out, const vxm_mesh_analysis *analysis, void *payload,
                                        vxm_error *error);

/**
 * The chain of the triangles that `find` finds, made if there is none yet. Threads that ask for it meanwhile
 * wait, and are asked whether to go on; after a failure the next that asks tries again.
 *
 * @return what `find` does; VXM_ERROR_CANCELLED
 */
vxm_status vxm_chain_once_get(const vxm_winding_chain **out, vxm_chain_once *once,
                              const vxm_mesh_analysis *analysis, vxm_facing_finder find, void *payload,
                              vxm_error *error);

#endif
