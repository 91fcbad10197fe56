/* SPDX-License-Identifier: BSD-3-Clause */
/** An engine on an OpenCL device: its programs and buffers, kept from one grid to the next. */
#ifndef VXM_GPU_OPENCL_OPENCL_H
#define VXM_GPU_OPENCL_OPENCL_H

#include "gpu/common/device_cache.h"
#include "gpu/opencl/cl_device.h"
#include "voxel/engine/engine.h"

/** Work-items that every group can have. */
enum { VXM_CL_GROUP_LEAST = 8 };

/** Programs: each is compiled when one of its kernels is first asked for. */
typedef enum vxm_cl_program_id {
  VXM_CL_SOLID = 0, /**< triangle by triangle */
  VXM_CL_SURFACE,
  VXM_CL_SORT,
  VXM_CL_TILES_PROGRAM,
  VXM_CL_TREE,        /**< octrees: their nodes */
  VXM_CL_BRICK_FLIPS, /**< and their voxels */
  VXM_CL_SURFACE_BRICKS,
  VXM_CL_COVERAGE,
  VXM_CL_MOVE,
  VXM_CL_PUBLISHED,
  VXM_CL_DEVICE_VOXELS,
  VXM_CL_PROGRAMS
} vxm_cl_program_id;

typedef enum vxm_cl_kernel_id {
  VXM_CL_FLIP_COLUMNS = 0,
  VXM_CL_FLIP_LARGE,
  VXM_CL_FLIP_BITS,
  VXM_CL_FOLD_ROWS,
  VXM_CL_FOLD_ACROSS,
  VXM_CL_TOUCH,
  VXM_CL_VOTE,
  VXM_CL_SET_SURFACE,
  VXM_CL_SET_LARGE,
  VXM_CL_SCAN_BLOCKS,
  VXM_CL_SCAN_ADD,
  VXM_CL_SORT_COUNT,
  VXM_CL_SORT_SCATTER,
  VXM_CL_COUNT_TILES,
  VXM_CL_LIST_TILES,
  VXM_CL_FIND_TILES,
  VXM_CL_FILL_TILES,
  VXM_CL_MARK_CELLS,
  VXM_CL_MARK_LARGE,
  VXM_CL_MARK_BOX,
  VXM_CL_COUNT_CELLS,
  VXM_CL_LIST_CELLS,
  VXM_CL_COUNT_NODES,
  VXM_CL_FLAG_PARENTS,
  VXM_CL_MAKE_PARENTS,
  VXM_CL_LINK_NODES,
  VXM_CL_FOLD_NODES,
  VXM_CL_PUSH_NODES,
  VXM_CL_UNITE_NODES,
  VXM_CL_PRUNE_BRICKS,
  VXM_CL_PRUNE_NODES,
  VXM_CL_COUNT_KEPT,
  VXM_CL_TAKE_NODES,
  VXM_CL_TAKE_BRICKS,
  VXM_CL_FLIP_BRICKS,
  VXM_CL_FLIP_BRICKS_LARGE,
  VXM_CL_FOLD_BRICKS,
  VXM_CL_PUSH_BRICKS,
  VXM_CL_SET_BRICKS,
  VXM_CL_SET_BRICKS_LARGE,
  VXM_CL_COUNT_GROUPS,
  VXM_CL_MOVE_POINTS,
  VXM_CL_PUBLISHED_FACETS,
  VXM_CL_PUBLISHED_VOXELS,
  VXM_CL_DEVICE_VOXELS_BYTES,
  VXM_CL_DEVICE_VOXELS_FLOATS,
  VXM_CL_KERNELS
} vxm_cl_kernel_id;

typedef enum vxm_cl_buffer_id {
  VXM_CL_POINTS = VXM_CACHED_POINTS,
  VXM_CL_CORNERS = VXM_CACHED_CORNERS,
  VXM_CL_ORDER = VXM_CACHED_ORDER,
  VXM_CL_BOXES = VXM_CACHED_BOXES,
  VXM_CL_SURFACE_POINTS = VXM_CACHED_SURFACE_POINTS,
  VXM_CL_SURFACE_CORNERS = VXM_CACHED_SURFACE_CORNERS,
  VXM_CL_ORIGINALS = VXM_CACHED_ORIGINALS,
  VXM_CL_ENTRIES = VXM_CACHED_ENTRIES,
  VXM_CL_NOISE = VXM_CACHED_NOISE,
  VXM_CL_FLIPS = VXM_CACHED_COUNT, /**< a bit per voxel of a slab; zero between uses */
  VXM_CL_LARGE,                    /**< how many triangles of many columns, and which */
  VXM_CL_RESULT,                   /**< two: one is read while the other is made */
  VXM_CL_RESULT2,
  VXM_CL_VOTER_X, /**< four of them */
  VXM_CL_VOTER_T = VXM_CL_VOTER_X + 3,
  VXM_CL_TALLY,
  VXM_CL_TOUCHED,
  VXM_CL_SUMS,   /**< of blocks of what is scanned */
  VXM_CL_DIGITS, /**< how often each occurs in each block of what is sorted */
  VXM_CL_SORT_KEYS,
  VXM_CL_SORT_VALUES,
  VXM_CL_PARTS,  /**< of each triangle the part, and above it the role */
  VXM_CL_COUNTS, /**< tiles of each triangle, then where its pairs begin */
  VXM_CL_TILE_KEYS,
  VXM_CL_TILE_TRIANGLES,
  VXM_CL_GROUPS,  /**< how many voxels of each are set */
  VXM_CL_LISTS,   /**< where the pairs of each tile begin and end */
  VXM_CL_STAYING, /**< the bits of a window that stays */
  /* Octrees, freed when one is made. Arrays "of all nodes" hold level after level, the lowest first. */
  VXM_CL_CELLS,  /**< a bit for each cell of 16^3 voxels: whether it is a node */
  VXM_CL_BEFORE, /**< of each word of them: how many nodes lie before it */
  VXM_CL_PLACES, /**< of each x, y and z what it adds to the number of a cell */
  VXM_CL_LEVELS, /**< how many nodes each has */
  VXM_CL_CODES,  /**< of all nodes: Morton codes, in order within a level */
  VXM_CL_PARENTS,
  VXM_CL_NEXT,     /**< of all nodes: the next one along x */
  VXM_CL_EXITS,    /**< of all nodes: whether a row of nodes that ends here leaves flipped what follows */
  VXM_CL_CHILDREN, /**< of all nodes: a bit for each child that is a node */
  VXM_CL_FIRSTS,   /**< of all nodes: the first of these */
  VXM_CL_INSIDE,   /**< of all nodes: 4 bits for each row of children */
  VXM_CL_UNITED_INSIDE,
  VXM_CL_MIXED,  /**< of all nodes: a bit for each child that is neither empty nor full */
  VXM_CL_FULL,   /**< of all nodes: a bit for each child that is full */
  VXM_CL_BRICKS, /**< 64 words for each node of the lowest level, in Morton order; zero between passes */
  VXM_CL_UNITED_BRICKS,
  VXM_CL_KEPT, /**< two: nodes that stay, then how many before */
  VXM_CL_KEPT2,
  VXM_CL_TAKEN, /**< nodes or bricks to be read */
  VXM_CL_OCTREE_END = VXM_CL_TAKEN,
  VXM_CL_BUFFERS
} vxm_cl_buffer_id;

typedef struct vxm_cl_buffer {
  cl_mem mem;
  size_t bytes; /**< counted against the memory limit */
} vxm_cl_buffer;

/** How long the stages of an octree take, in milliseconds (Schwarz & Seidel 2010, table 3), and its nodes
 * before it is pruned; those of tiles (table 2), and how many tiles, and pairs of a tile and a triangle. */
typedef struct vxm_cl_stages {
  double cells, construct, voxelize, propagate, prune;
  double pairs, sort, tiles;
  size_t cells_active, nodes, pair_count, tile_count;
} vxm_cl_stages;

typedef struct vxm_opencl {
  vxm_engine base; /**< first, so that an engine is one */
  vxm_engine_options options;
  const vxm_cl *cl;
  vxm_cl_device device;
  int number; /**< of the device, in the order in which the loader lists them */
  cl_context context;
  cl_command_queue queue;    /**< kernels, in order */
  cl_command_queue transfer; /**< what is read while kernels run */
  cl_program programs[VXM_CL_PROGRAMS];
  cl_kernel kernels[VXM_CL_KERNELS];
  size_t group; /**< work-items of a group: a power of two that all kernels made so far can have */
  vxm_cl_buffer buffers[VXM_CL_BUFFERS];
  vxm_device_cache device_cache;
  uint64_t parts_serial;    /**< of the triangles whose parts are there, too */
  vxm_cl_stages *stages;    /**< NULL; else the device is waited for after each, and its time is added */
  vxm_cl_stages own_stages; /**< of vxm_engine_measure */
} vxm_opencl;

static inline vxm_opencl *vxm_opencl_of(vxm_engine *engine) {
  return (vxm_opencl *)engine;
}

/** Makes an engine on a device, which it takes over, also after a failure; the reference to `context` is the
 * caller's. @return VXM_OK, VXM_ERROR_UNAVAILABLE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_opencl_create(vxm_engine **out, vxm_context *context, const vxm_cl *cl,
                             const vxm_cl_device *device, int number, const vxm_engine_options *options,
                             vxm_error *error);

/* ---- Programs (cl_program.c) ---- */

/** Makes a program and all its kernels, if that is still to be done; `group` may shrink and what was made for
 * a larger one goes. */
vxm_status vxm_cl_ready(vxm_opencl *engine, vxm_cl_program_id id, vxm_error *error);
void vxm_cl_programs_release(vxm_opencl *engine);

/** An argument of a kernel. */
typedef struct vxm_cl_arg {
  size_t size;
  const void *value; /**< NULL: so many bytes of local memory */
} vxm_cl_arg;
#define VXM_CL_VALUE(variable) \
  { sizeof(variable), &(variable) }
#define VXM_CL_MEM(engine, id) \
  { sizeof(cl_mem), &(engine)->buffers[id].mem }
#define VXM_CL_ARGS(...) \
  (const vxm_cl_arg[]){__VA_ARGS__}, sizeof((const vxm_cl_arg[]){__VA_ARGS__}) / sizeof(vxm_cl_arg)

/** Queues a kernel for at least `items` work-items in groups of engine->group; its program is ready. */
vxm_status vxm_cl_run(vxm_opencl *engine, vxm_cl_kernel_id id, uint64_t items, const vxm_cl_arg *args,
                      size_t count, vxm_error *error);
/** As vxm_cl_run, for so many groups. */
vxm_status vxm_cl_run_groups(vxm_opencl *engine, vxm_cl_kernel_id id, uint64_t groups, const vxm_cl_arg *args,
                             size_t count, vxm_error *error);
/** Groups that keep the device busy where each goes on to another piece of work. */
uint64_t vxm_cl_busy_groups(const vxm_opencl *engine);

/* ---- Buffers (cl_buffer.c) ---- */

/** Room for so many bytes; what was in it is lost if it grows. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_RANGE (more than the device gives to one buffer) */
vxm_status vxm_cl_reserve(vxm_opencl *engine, vxm_cl_buffer_id id, size_t bytes, vxm_error *error);
/** As vxm_cl_reserve, of VXM_CL_FLIPS, with all bytes zero if it grows. */
vxm_status vxm_cl_reserve_flips(vxm_opencl *engine, size_t bytes, vxm_error *error);
/** Room, and the first bytes zero. */
vxm_status vxm_cl_clear(vxm_opencl *engine, vxm_cl_buffer_id id, size_t bytes, vxm_error *error);
void vxm_cl_release(vxm_opencl *engine, vxm_cl_buffer_id id);
/** Room, and these bytes in it; the data may go when this returns. */
vxm_status vxm_cl_upload(vxm_opencl *engine, vxm_cl_buffer_id id, const void *data, size_t bytes,
                         vxm_error *error);
/** How buffers of the engine's device cache are filled and freed. */
vxm_status vxm_cl_device_cache_upload(vxm_engine *engine, vxm_device_cache_id id, size_t offset,
                                      const void *data, size_t bytes, vxm_error *error);
void vxm_cl_device_cache_release(vxm_engine *engine, vxm_device_cache_id id);
/** Reads bytes of a buffer, once all is done that was queued. */
vxm_status vxm_cl_download(vxm_opencl *engine, vxm_cl_buffer_id id, size_t offset, void *out, size_t bytes,
                           vxm_error *error);

/* ---- Slabs (cl_buffer.c) ---- */

/** How many slices of a window fit a slab. @return VXM_OK; VXM_ERROR_RANGE if not even one does */
vxm_status vxm_cl_slab_slices(int64_t *out, const vxm_opencl *engine, const vxm_window *window,
                              vxm_error *error);
/** Puts the words of a slab into a buffer. */
vxm_status vxm_cl_slab_upload(vxm_opencl *engine, vxm_cl_buffer_id id, const vxm_slab *slab,
                              vxm_error *error);

/** A slab on its way back. Start from {0}. */
typedef struct vxm_cl_return {
  vxm_slab slab;
  vxm_cl_buffer_id from;
  bool is_or;      /**< added to the window's words */
  uint64_t *block; /**< what is added waits here */
  cl_event event;  /**< NULL: none is under way */
} vxm_cl_return;

/** Begins to take back a slab, once all is done that was queued. */
vxm_status vxm_cl_return_begin(vxm_opencl *engine, vxm_cl_return *back, vxm_error *error);
/** Waits for it; also after a failure. Returns `status`, or the first failure. */
vxm_status vxm_cl_return_end(vxm_opencl *engine, vxm_cl_return *back, vxm_status status, vxm_error *error);

/* ---- Triangles ---- */

/** Brings to the device which part each triangle belongs to, and above ROLE_SHIFT its role (cl_tiles.c). */
vxm_status vxm_cl_place_parts(vxm_opencl *engine, const vxm_triangle_set *triangles, vxm_error *error);
/** Empties the list of triangles that work-groups do, with room for all of so many. */
vxm_status vxm_cl_clear_large(vxm_opencl *engine, size_t triangles, vxm_error *error);

#endif
