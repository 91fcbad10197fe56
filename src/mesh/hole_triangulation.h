/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangulation of the rim of a hole without new vertices. */
#ifndef VXM_MESH_HOLE_TRIANGULATION_H
#define VXM_MESH_HOLE_TRIANGULATION_H

#include "base/context.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A closed walk of different vertices, in the direction in which the triangles are to run along it. */
typedef struct vxm_rim {
  vxm_context *context;
  double fraction; /**< told with progress */
  size_t count;    /**< of vertices and of edges, at least 3 */
  const double (*points)[3];
  const double (*normals)[3]; /**< unit normal of the face beyond the edge from i to i + 1; zero = none */
  bool (*is_edge)(size_t i, size_t j, void *payload); /**< whether the mesh has an edge between i and j;
                                                         called from any thread */
  void *payload;
  double no_area; /**< triangles have more area than this, if there is a way */
} vxm_rim;

/**
 * Fills a rim with count - 2 triangles, no two of which share an edge that the mesh has already. Of all ways
 * to do it, that with the least sharp bend between neighbours, the faces beyond the rim included; of these
 * that with the least area (Liepa 2003, sec. 3; Barequet & Sharir 1995), of these that with the shortest
 * inner edges. So a hole in a plane is filled in the plane, whatever its shape. A slit whose corners lie in
 * line takes triangles without area. Cubic time and quadratic
 * memory: rims of more than VXM_RIM_WHOLE edges are cut by short chords first, and if that turns triangles
 * over, clipped ear by ear.
 *
 * @param[out] triangles room for count - 2, as places in the rim
 * @param[out] filled    false if there is no such triangulation
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_hole_triangulate(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim, vxm_error *error);

enum { VXM_RIM_WHOLE = 500 };

/**
 * The same for a rim that is a part of a longer one, in any case as a whole.
 *
 * @param loop places in the rim, `count` of them; consecutive ones that are not consecutive in the rim are
 *             the ends of a chord, beyond which nothing is known
 */
vxm_status vxm_hole_subdivide(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim,
                              const uint32_t *loop, size_t count, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
