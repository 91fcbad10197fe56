/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What a reader of voxels hands over: first the texts of a grid, then the grid, its extent, and its voxels as
 * blocks and cubes; or, instead of these, an array and its values in their order. The module that reads calls
 * a sink that sends it all, and our process one that makes a grid of it: both ends of the channel
 * (wire_voxels.h) look the same.
 */
#ifndef VXM_SANDBOX_VOXEL_SINK_H
#define VXM_SANDBOX_VOXEL_SINK_H

#include "base/error.h"
#include "voxmend/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Voxels along a block, and in it; the most along a cube. */
enum { VXM_SINK_SIDE = 8, VXM_SINK_VOXELS = 512, VXM_SINK_CUBE_MAX = 4096 };
/** Bytes of a key and its value; longer ones are left out. */
enum { VXM_SINK_TEXT_MAX = 1 << 20 };

/** What is known before the tree is read. Voxels have indices of their own, negative ones too. */
typedef struct vxm_sink_grid {
  char name[64];   /**< cut */
  bool is_numbers; /**< 32-bit floats, else bits */
  uint32_t grids;  /**< that the file has; this is the first that can be read */
  uint64_t at;     /**< where it stands in the file, for messages */
  double voxel_size[3];
  double first[3]; /**< centre of the voxel with index 0 0 0 */
  bool has_space;  /**< voxmend has written it, as this */
  vxm_space space;
} vxm_sink_grid;

typedef struct vxm_sink_extent {
  bool is_empty;           /**< no active voxel; the box is then zeros */
  int64_t low[3], high[3]; /**< active voxels, both included */
  float background;        /**< of the voxels that are in no block and no cube */
} vxm_sink_extent;

/** What is there of where an array lies: bits. */
enum { VXM_PLACE_ORIGIN = 1, VXM_PLACE_SIZE = 2 };

/** An array with a value for each voxel, or the 4 bytes of a colour. */
typedef struct vxm_sink_array {
  uint32_t scalar;      /**< vxm_scalar */
  uint32_t is_color;    /**< 0 or 1 */
  int64_t shape[3];     /**< the last is the fastest */
  double place[6];      /**< origin, and size of voxels */
  uint32_t known_place; /**< VXM_PLACE_ORIGIN, VXM_PLACE_SIZE */
  uint32_t fits;        /**< arrays of the file that could have been read */
} vxm_sink_array;

typedef struct vxm_voxel_sink {
  vxm_status (*text)(void *payload, const char *key, size_t key_size, const char *value, size_t value_size,
                     vxm_error *error);
  vxm_status (*grid)(void *payload, const vxm_sink_grid *grid, vxm_error *error);
  vxm_status (*extent)(void *payload, const vxm_sink_extent *extent, vxm_error *error);
  /* Blocks and cubes do not overlap, if the reader is sound; `at` is any. */
  /** A block of 8 x 8 x 8: voxel (x,y,z) of it is bit 8 y + z of word x. */
  void (*bits)(void *payload, const int64_t at[3], const uint64_t bits[8]);
  /** A block of numbers, z fastest, then y, then x. */
  void (*numbers)(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]);
  /** A cube of which all voxels are set, or of this number. */
  void (*cube)(void *payload, const int64_t at[3], int64_t side, float number);
  void *payload;
  /* Both NULL if no array is wanted. */
  vxm_status (*array)(void *payload, const vxm_sink_array *array, vxm_error *error);
  /** The next values; pieces may end within one. */
  vxm_status (*values)(void *payload, const void *values, size_t size, vxm_error *error);
  bool is_full; /**< set by one of these functions that wants no more */
} vxm_voxel_sink;

#ifdef __cplusplus
}
#endif
#endif
