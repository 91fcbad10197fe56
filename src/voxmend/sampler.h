/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/sampler.h
 * Variants of meshes: augmented voxel grids for training.
 */
#ifndef VOXMEND_SAMPLER_H
#define VOXMEND_SAMPLER_H

#include "voxmend/voxelize.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Variants: augmented voxel grids for training ---- */

/** How variants are rotated. */
typedef enum vxm_rotation {
  VXM_ROTATION_NONE = 0,
  VXM_ROTATION_ANY,  /**< uniform over all rotations (Marsaglia 1972) */
  VXM_ROTATION_AXIS, /**< about `axis`, uniform over all angles */
  VXM_ROTATION_LIST  /**< variant `index` has rotation `index` modulo `rotation_count` */
} vxm_rotation;

/** How vertices are displaced. */
typedef enum vxm_displacement {
  VXM_DISPLACEMENT_UNIFORM = 0, /**< each coordinate uniform in -displace to displace */
  VXM_DISPLACEMENT_NORMAL /**< each nearly normal with deviation `displace`, cut off at three times that */
} vxm_displacement;

/** What a voxel is in memory. */
typedef enum vxm_voxel_format {
  VXM_VOXEL_FORMAT_PACKED = 0, /**< a bit; each row along z begins with a byte of its own:
                            numpy.unpackbits(..., count=D, bitorder="little") */
  VXM_VOXEL_FORMAT_UINT8,      /**< a byte, 0 or 1; a share (vxm_sampler_options.coverage) 0 to 255 */
  VXM_VOXEL_FORMAT_FLOAT32     /**< a float, 0 or 1; a share between them */
} vxm_voxel_format;

/**
 * What is drawn at random for each variant. All of it starts from the same box: the model is scaled along its
 * own axes, mirrored, rotated, and fitted into the grid so that nothing can lie outside of it; then its
 * vertices are displaced, and it is moved.
 */
typedef struct vxm_sampler_options {
  size_t size;             /**< as the initializer sets it */
  int64_t resolution;      /**< voxels along each axis; 0 = 64 */
  int64_t pad;             /**< voxels kept free on each side of the model before it is moved */
  uint64_t seed;           /**< of all that is drawn */
  vxm_rotation rotation;   /**< how variants are rotated */
  double axis[3];          /**< with VXM_ROTATION_AXIS; all 0 = z */
  const double *rotations; /**< with VXM_ROTATION_LIST: rotation_count x 3 x 3, row after row, none that
                              mirrors; they are copied */
  int64_t rotation_count;  /**< of the list */
  double scale; /**< each axis is scaled by a factor of its own, uniform in 1 - scale to 1 + scale; below 1 */
  vxm_displacement displacement; /**< how vertices are displaced */
  double displace;               /**< as a fraction of the width of the grid; 0 = vertices stay */
  uint32_t noise;   /**< displacements in the circular buffer that all variants read, each from another place;
                       0 = 65536 */
  unsigned mirror;  /**< axes of the model, or-ed 1 (x), 2 (y) and 4 (z), along each of which half of the
                       variants are mirrored */
  double translate; /**< moved along each axis by up to this part, 0 to 1, of the room on either side */
  bool fill;        /**< the longest side fills the grid rather than the diagonal; without rotation only */
  const vxm_voxelize_options *voxelize; /**< how, without the confidence; NULL = defaults. It is copied. An
                                    engine, which must outlive the sampler, makes one variant after another,
                                    and moves the vertices if it says so (vxm_engine_info.moves) */
  int coverage; /**< 0 = voxels are set or clear; 2, 4 or 8: each is the share of its sub-voxels, so many
                   along each axis, whose centres are inside, as of vxm_model_coverage: 0 to 255 of
                   VXM_VOXEL_FORMAT_UINT8, 0 to 1 of VXM_VOXEL_FORMAT_FLOAT32. Then `voxelize` is of
                   VXM_MODE_SOLID */
} vxm_sampler_options;

/** Initial value of vxm_sampler_options. */
#define VXM_SAMPLER_OPTIONS_INIT                                                      \
  {                                                                                   \
    sizeof(vxm_sampler_options), 0, 0, 0, VXM_ROTATION_NONE, {0, 0, 0}, NULL, 0, 0.0, \
        VXM_DISPLACEMENT_UNIFORM, 0.0, 0, 0, 0.0, false, NULL, 0                      \
  }

/** Names a variant. Its voxels follow from this, the options and the mesh: on any machine, in any order. */
typedef struct vxm_variant {
  uint32_t model; /**< its number */
  uint32_t epoch; /**< of the training */
  uint32_t index; /**< of the variant in the epoch */
} vxm_variant;

/** How a variant lies in its grid, before its vertices are displaced. */
typedef struct vxm_pose {
  size_t size;          /**< as the initializer sets it, or 0 */
  double transform[12]; /**< takes (x, y, z, 1) of the mesh to voxels: voxel (i,j,k) is i to i + 1, ... */
  double rotation[9];   /**< row after row */
  double scale[3];      /**< voxels per model unit along the model's axes; negative where it is mirrored */
  double shift[3];      /**< of the middle of its box from the middle of the grid, voxels */
} vxm_pose;

/** Initial value of vxm_pose. */
#define VXM_POSE_INIT                        \
  {                                          \
    sizeof(vxm_pose), {0}, {0}, {0, 0, 0}, { \
      0, 0, 0                                \
    }                                        \
  }

/**
 * Makes variants of meshes: Ogayar et al.'s direct connection, with an implicit dataset. Meshes are prepared
 * once; after the first few variants none takes memory, but what an engine takes. One sampler may be used by
 * one thread at a time, and works with all threads of its context.
 */
typedef struct vxm_sampler vxm_sampler;

/**
 * Makes a sampler, which has no models yet (vxm_sampler_put).
 *
 * @param context NULL = a new one
 * @param options NULL = defaults: no augmentation
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if pad and displacement leave no room for a model; VXM_ERROR_RANGE
 *         beyond 4096 voxels, or sub-voxels, along an axis; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sampler_create(vxm_sampler **out, vxm_context *context,
                                      const vxm_sampler_options *options, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_sampler_destroy(vxm_sampler *sampler);

/**
 * Puts a mesh in as model number `model`, in place of the one that had the number.
 *
 * @param mesh as for vxm_model_create; must outlive its use here. NULL takes the model out
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners, or all vertices
 *         lie in one place; VXM_ERROR_RANGE for vertices that are not finite; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. After a failure there is no model of this number
 */
VXM_API vxm_status vxm_sampler_put(vxm_sampler *sampler, uint32_t model, const vxm_mesh *mesh,
                                   vxm_error *error);

/** The space of all variants: a cube of side 1 at the origin. */
VXM_API vxm_space vxm_sampler_space(const vxm_sampler *sampler);
/** Bytes of one variant in memory; 0 if `format` is unknown. */
VXM_API size_t vxm_sampler_bytes(const vxm_sampler *sampler, vxm_voxel_format format);

/** Tells how a variant lies. @return VXM_OK, VXM_ERROR_ARGUMENT if there is no such model */
VXM_API vxm_status vxm_sampler_pose(vxm_pose *out, const vxm_sampler *sampler, const vxm_variant *variant,
                                    vxm_error *error);

/**
 * Makes one variant in a grid: all its bits are replaced. Not of a sampler of shares, as with
 * vxm_sampler_files.
 *
 * @param grid of the dimensions of vxm_sampler_space
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if there is no such model; VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. After a failure the content of the grid is unspecified
 */
VXM_API vxm_status vxm_sampler_grid(vxm_grid *grid, vxm_sampler *sampler, const vxm_variant *variant,
                                    vxm_error *error);

/**
 * Makes many variants, of one model or of several, one after another in memory: each as [x][y][z] in C order.
 *
 * @param out  room for count * vxm_sampler_bytes bytes, aligned as floats are
 * @return as vxm_sampler_grid. After a failure the content of `out` is unspecified
 */
VXM_API vxm_status vxm_sampler_batch(void *out, vxm_sampler *sampler, const vxm_variant *variants,
                                     size_t count, vxm_voxel_format format, vxm_error *error);

/**
 * Makes many variants, and writes each into a file of its own.
 *
 * @param paths   one for each variant, all different; written as by vxm_grid_write
 * @param options NULL = defaults
 * @param[out] written NULL, or for each variant whether its file was written: after a failure some may be
 * @return as vxm_sampler_grid and vxm_grid_write
 */
VXM_API vxm_status vxm_sampler_files(const char *const *paths, vxm_sampler *sampler,
                                     const vxm_variant *variants, size_t count,
                                     const vxm_grid_write_options *options, bool *written, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
