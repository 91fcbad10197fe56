/* SPDX-License-Identifier: BSD-3-Clause */
/** What stays on a device from one use to the next, the same for OpenGL and OpenCL: triangles and their
 * points, lists of passes, surfaces, and what variants are made of. */
#ifndef VXM_GPU_COMMON_DEVICE_CACHE_H
#define VXM_GPU_COMMON_DEVICE_CACHE_H

#include "gpu/common/device_transform.h"
#include "gpu/common/oversized_triangles.h"

/** Buffers; those of each engine begin with them. */
typedef enum vxm_device_cache_id {
  VXM_CACHED_POINTS = 0,
  VXM_CACHED_CORNERS,
  VXM_CACHED_APEXES, /**< points that are the apexes of triangles; only where they are wanted */
  VXM_CACHED_ORDER,  /**< numbers of triangles, pass after pass */
  VXM_CACHED_BOXES,
  VXM_CACHED_SURFACE_POINTS,
  VXM_CACHED_SURFACE_CORNERS,
  VXM_CACHED_ORIGINALS, /**< points before they are moved */
  VXM_CACHED_ENTRIES,   /**< of each of them in the noise */
  VXM_CACHED_NOISE,
  VXM_CACHED_COUNT
} vxm_device_cache_id;

/** Makes room for so many bytes in a buffer and, unless data is NULL, puts these into it from `offset` on;
 * those before it stay if there was room. */
typedef vxm_status (*vxm_device_cache_upload)(vxm_engine *engine, vxm_device_cache_id id, size_t offset,
                                              const void *data, size_t bytes, vxm_error *error);

typedef void (*vxm_device_cache_release)(vxm_engine *engine, vxm_device_cache_id id);

typedef struct vxm_device_cache {
  vxm_engine *engine;
  vxm_device_cache_upload upload;
  vxm_device_cache_release release;
  vxm_oversized oversized; /**< triangles beyond the numbers of the shaders */
  vxm_oversized_surface oversized_surface;
  size_t tried[2]; /**< points that the CPU has moved, too: without displacements and with them */
  /** What the buffers hold; 0 = nothing. */
  uint64_t triangles_serial, placed_serial, surface_serial, surface_corners_serial, originals_serial,
      noise_serial;
} vxm_device_cache;

vxm_device_cache vxm_device_cache_of(vxm_engine *engine, vxm_device_cache_upload upload,
                                     vxm_device_cache_release release);
void vxm_device_cache_destroy(vxm_device_cache *cache);

/** Brings points and corners, unless they are there. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_RANGE (more than fits a buffer), VXM_ERROR_UNAVAILABLE; as all of these
 */
vxm_status vxm_device_cache_triangles(vxm_device_cache *cache, const vxm_triangle_set *triangles,
                                      const vxm_snapped_points *placed, vxm_error *error);
/** The same for a surface. */
vxm_status vxm_device_cache_surface(vxm_device_cache *cache, const vxm_surface *surface, vxm_error *error);
/** Divides the triangles of a job's parts as vxm_disjoint_passes_create does, and brings the lists. Destroy
 * with vxm_disjoint_passes_destroy, also after a failure. */
vxm_status vxm_device_cache_passes(vxm_disjoint_passes *out, vxm_device_cache *cache,
                                   const vxm_window *window, const vxm_parity_union_job *job, int64_t margin,
                                   size_t most, vxm_error *error);

/** Brings what variants have in common, and makes room for so many points. False where that is more than the
 * device or the memory limit has room for: the CPU moves the points then. */
bool vxm_device_cache_motion(vxm_device_cache *cache, const vxm_vertex_transform *motion, size_t points);
/** Completes what the device has moved, here and there; `*done` stays false where the CPU has to do it all.
 */
vxm_status vxm_device_cache_moved(vxm_device_cache *cache, vxm_snapped_points *placed,
                                  const vxm_move_job *job, bool *done, vxm_error *error);

#endif
