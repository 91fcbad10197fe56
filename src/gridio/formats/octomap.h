/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The module "octomap": what the library asks of OctoMap, as a table of functions.
 *
 * A map of OctoMap is an octree of 16 levels over the origin: voxel k along an axis, from -32768 to 32767,
 * has its centre at (k + 1/2) * resolution. Files are written in our process, and read in one of their own
 * (sandbox/reader_process.h), because OctoMap trusts them.
 */
#ifndef VXM_GRIDIO_FORMATS_OCTOMAP_H
#define VXM_GRIDIO_FORMATS_OCTOMAP_H

#include "base/module.h"
#include "base/output.h"
#include "sandbox/reader.h"
#include "voxmend/sparse.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Voxels on either side of the origin. */
enum { VXM_OCTOMAP_HALF = 32768 };

/** A map in the making. */
typedef struct vxm_octomap vxm_octomap;

typedef struct vxm_octomap_functions {
  vxm_reader reader; /**< first: to the reading process the table is this alone */
  /** @param first where in the map voxel (0,0,0) of the pieces lies. @return VXM_OK, VXM_ERROR_MEMORY */
  vxm_status (*create)(vxm_octomap **out, vxm_context *context, double resolution, const int64_t first[3],
                       vxm_error *error);
  void (*destroy)(vxm_octomap *map);
  /** Makes the voxels of a piece occupied. Pieces do not overlap. @return VXM_OK, VXM_ERROR_MEMORY,
   * VXM_ERROR_MEMORY_LIMIT */
  vxm_status (*put)(vxm_octomap *map, const vxm_sparse_piece *piece, vxm_error *error);
  /** Writes the file; whether that failed the output tells. The same voxels give the same bytes. @return
   * VXM_OK, VXM_ERROR_MEMORY */
  vxm_status (*write)(const vxm_octomap *map, vxm_output *output, vxm_error *error);
} vxm_octomap_functions;

extern const vxm_module_need vxm_octomap_need;

/** Where a grid lies on the lattice of OctoMap: the nearest place. Voxels have to be cubes.
 *
 * @param out index of voxel (0,0,0)
 * @return whether the map has all of it */
bool vxm_octomap_place(int64_t out[3], const vxm_space *space);

#ifdef __cplusplus
}
#endif
#endif
