/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids slab by slab, the same for OpenGL and OpenCL: unions of parts, and votes of unions along x, y and z
 * and by tetrahedra. */
#ifndef VXM_GPU_COMMON_SLAB_SOLID_H
#define VXM_GPU_COMMON_SLAB_SOLID_H

#include "gpu/common/device_cache.h"
#include "gpu/common/slab.h"

/** Makes the words of a slab in a buffer. */
typedef vxm_status (*vxm_slab_fn)(vxm_engine *engine, const vxm_slab *slab, int into, void *payload,
                                  vxm_error *error);

/** What an engine does of it. Buffers are numbered as the engine's own. */
typedef struct vxm_slab_solid {
  int voter_x; /**< the buffer of what x votes; those of y, z and the tetrahedra follow */
  /** Makes a window slab by slab, and takes each back while the next is made; `is_or`: adds to the window. */
  vxm_status (*each_slab)(vxm_engine *engine, const vxm_window *window, bool is_or, vxm_slab_fn make,
                          void *payload, vxm_error *error);
  /** Divides a job's parts into passes, and brings the lists. */
  vxm_status (*divide)(vxm_disjoint_passes *out, vxm_engine *engine, const vxm_window *window,
                       const vxm_parity_union_job *job, vxm_error *error);
  /** Unites the parts of a job in a buffer. */
  vxm_status (*unite)(vxm_engine *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                      vxm_disjoint_passes *passes, int into, vxm_error *error);
  /** Puts what the window has, here or on the device, into a buffer. */
  vxm_status (*bring)(vxm_engine *engine, const vxm_slab *slab, int into, vxm_error *error);
  /** Adds what the voters elect to a result; how many voxels are contested, and whether any is new. */
  vxm_status (*count_votes)(vxm_engine *engine, const vxm_slab *slab, const int voters[VXM_VOTERS],
                            uint32_t rule, int result, uint32_t counted[2], vxm_error *error);
  /** The marks of parts that set a voxel. */
  vxm_status (*clear_touched)(vxm_engine *engine, size_t part_count, vxm_error *error);
  vxm_status (*read_touched)(vxm_engine *engine, uint32_t *out, size_t part_count, vxm_error *error);
} vxm_slab_solid;

/** As the engine's operations of these names (voxel/engine/engine.h). */
vxm_status vxm_slab_solid_unite(const vxm_slab_solid *solid, vxm_device_cache *cache,
                                const vxm_window *window, const vxm_parity_union_job *job, vxm_error *error);
vxm_status vxm_slab_solid_vote(const vxm_slab_solid *solid, vxm_device_cache *cache, const vxm_window *window,
                               const vxm_vote_job *job, vxm_vote_tally *tally, vxm_error *error);

/** Reads which parts set a voxel: those whose mark is 1. */
vxm_status vxm_slab_solid_touched(const vxm_slab_solid *solid, vxm_engine *engine, atomic_uchar *has_voxels,
                                  size_t part_count, vxm_error *error);

#endif
