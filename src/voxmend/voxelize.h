/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/voxelize.h
 * Grids made of meshes, one or many of each.
 */
#ifndef VOXMEND_VOXELIZE_H
#define VOXMEND_VOXELIZE_H

#include "voxmend/engine.h"
#include "voxmend/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Voxelization ---- */

/** How a grid fits around a model. */
typedef enum vxm_fit {
  VXM_FIT_CUBE = 0, /**< equal dimensions; the longest side of the model fills them, the model is centred */
  VXM_FIT_TIGHT,    /**< the box of the model */
  VXM_FIT_SPHERE    /**< equal dimensions; the diagonal of the box fills them: safe under rotation */
} vxm_fit;

/** Which voxels of a mesh are set. */
typedef enum vxm_mode {
  VXM_MODE_SOLID = 0, /**< inside, by their centres and vxm_thin_parts */
  VXM_MODE_SURFACE,   /**< on the surface, as vxm_surface_kind says */
  VXM_MODE_BOTH       /**< either */
} vxm_mode;

/** Which voxels are the surface. A shell is a part of the solid, so that it adds nothing in VXM_MODE_BOTH. */
typedef enum vxm_surface_kind {
  VXM_SURFACE_CONSERVATIVE = 0, /**< every voxel whose closed box meets a face, no more and no less */
  VXM_SURFACE_THIN,             /**< 6-separating: no path over 6-neighbours crosses a face outside of it */
  VXM_SURFACE_SHELL26, /**< voxels of the solid with an empty one among the 26 around; outside the grid all
                          are empty */
  VXM_SURFACE_SHELL18, /**< among the 18 that share a face or an edge */
  VXM_SURFACE_SHELL6   /**< among the 6 that share a face */
} vxm_surface_kind;

/** How a voxel is decided. */
typedef enum vxm_method {
  VXM_METHOD_VOTE = 0, /**< parity along x, y, z and the tetrahedra, combined by vxm_vote */
  VXM_METHOD_X,        /**< parity of crossings along x */
  VXM_METHOD_Y,
  VXM_METHOD_Z,
  VXM_METHOD_TETRA,  /**< XOR of the tetrahedra from the centroid to every triangle (Rueda et al.) */
  VXM_METHOD_WINDING /**< winding number above 1/2 at every voxel, after turning all patches outward */
} vxm_method;

/** How voters are combined. */
typedef enum vxm_vote {
  VXM_VOTE_AUTO = 0, /**< holes closed by caps over their rims; what stays open by agreement of x, y and z,
                        as far as a line along them meets an even number of faces, and by the winding number
                        where not all three say inside, nor two outside and none inside */
  VXM_VOTE_MAJORITY, /**< at least two of x, y and z (Chen & Tu); the tetrahedra cannot overturn that */
  VXM_VOTE_ANY,      /**< at least one voter */
  VXM_VOTE_ALL       /**< every voter */
} vxm_vote;

/** Which components are voxelized apart. */
typedef enum vxm_split_mode {
  VXM_SPLIT_MODE_AUTO = 0, /**< every closed component alone, all others together; united */
  VXM_SPLIT_MODE_GROUP,    /**< every component alone (Chen & Tu); united */
  VXM_SPLIT_MODE_WHOLE     /**< no splitting */
} vxm_split_mode;

/** What a closed component inside another one is, with VXM_SPLIT_MODE_AUTO. */
typedef enum vxm_cavities {
  VXM_CAVITIES_AUTO = 0, /**< a cavity if it is wound against the one around it, else solid */
  VXM_CAVITIES_KEEP,     /**< a cavity */
  VXM_CAVITIES_FILL      /**< solid */
} vxm_cavities;

/** What becomes of parts thinner than a voxel, which hold few voxel centres or none. */
typedef enum vxm_thin_parts {
  VXM_THIN_AUTO = 0, /**< VXM_THIN_KEEP with VXM_METHOD_VOTE and VXM_VOTE_AUTO, else VXM_THIN_DROP */
  VXM_THIN_KEEP,     /**< they hold together: voxels are added so that no path over empty 6-neighbours leads
                        across a face, and what is connected in the mesh is 26-connected in the grid */
  VXM_THIN_DROP,     /**< voxels whose centre is inside, and no others */
  VXM_THIN_KEEP26    /**< as VXM_THIN_KEEP, and no path over 26-neighbours leads across a face either */
} vxm_thin_parts;

/** Which voxel space to use. Give resolution or voxel_size, or `like`. */
typedef struct vxm_space_options {
  size_t size;           /**< as the initializer sets it */
  int64_t resolution[3]; /**< voxels per axis; {N,0,0} = N along the longest side; all 0 and no voxel_size =
                            128 */
  double voxel_size;     /**< model units */
  vxm_fit fit;           /**< how the grid fits around the model */
  int64_t pad; /**< empty voxels kept free on each side; within `resolution`, in addition with voxel_size */
  bool use_bounds;       /**< cover `bounds` instead of fitting to the model: from their minimum corner
                              on, rounded up to whole voxels; exactly if three numbers are given */
  double bounds[6];      /**< x0 y0 z0 x1 y1 z1 */
  const vxm_space *like; /**< take exactly this space; overrides the rest */
  double voxel_sizes[3]; /**< model units along each axis, instead of voxel_size; all 0 = not used */
} vxm_space_options;

/** Initial value of vxm_space_options. */
#define VXM_SPACE_OPTIONS_INIT                                                                     \
  {                                                                                                \
    sizeof(vxm_space_options), {0, 0, 0}, 0.0, VXM_FIT_CUBE, 0, false, {0, 0, 0, 0, 0, 0}, NULL, { \
      0, 0, 0                                                                                      \
    }                                                                                              \
  }

/**
 * Chooses a voxel space for a mesh.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if the mesh has no extent; VXM_ERROR_RANGE beyond 2^20
 * voxels along an axis, or for voxels below 2^-1007, about 7e-304
 */
VXM_API vxm_status vxm_space_fit(vxm_space *out, const vxm_mesh *mesh, const vxm_space_options *options,
                                 vxm_error *error);

/** How a mesh is voxelized. */
typedef struct vxm_voxelize_options {
  size_t size;               /**< as the initializer sets it */
  vxm_method method;         /**< how inside is told, where `mode` is not the surface alone */
  vxm_vote vote;             /**< how voters are combined, with VXM_METHOD_VOTE */
  vxm_split_mode split_mode; /**< which components are voxelized apart */
  vxm_cavities cavities;     /**< what closed components inside others are, with VXM_SPLIT_MODE_AUTO */
  vxm_mode mode;             /**< which voxels are set */
  bool confidence;           /**< keep for every voxel how sure it is: vxm_grid_confidence */
  bool vote_always; /**< with `vote` majority, any or all: on closed parts too, where the voters agree anyway
                     */
  vxm_surface_kind surface; /**< with `mode` surface and both */
  vxm_engine *engine;       /**< NULL = the CPU. Must outlive the models made with these options */
  vxm_thin_parts
      thin; /**< what becomes of parts thinner than a voxel; not in VXM_MODE_SURFACE, but for shells */
} vxm_voxelize_options;

/** Initial value of vxm_voxelize_options. */
#define VXM_VOXELIZE_OPTIONS_INIT                                                                         \
  {                                                                                                       \
    sizeof(vxm_voxelize_options), VXM_METHOD_VOTE, VXM_VOTE_AUTO, VXM_SPLIT_MODE_AUTO, VXM_CAVITIES_AUTO, \
        VXM_MODE_SOLID, false, false, VXM_SURFACE_CONSERVATIVE, NULL, VXM_THIN_AUTO                       \
  }

/** What came of voxelizing. */
typedef struct vxm_voxelize_report {
  size_t size;          /**< as the initializer sets it, or 0 */
  int64_t parts;        /**< parts that were voxelized apart and united */
  int64_t closed_parts; /**< those in which every edge has an even number of faces: all voters agree there */
  int64_t capped_parts; /**< those that were closed by caps over the rims of their holes */
  int64_t cavities;     /**< components that were taken for cavities of the one around them */
  int64_t caps;         /**< rims that were capped */
  int64_t contested;    /**< voxels on which the voters of the parts that stayed open disagreed */
  int64_t winding_decided; /**< voxels that the winding number decided: all with VXM_METHOD_WINDING */
  int64_t voxels;          /**< set voxels */
  uint64_t hash;           /**< vxm_grid_hash */
  int64_t empty_parts;     /**< parts that set no voxel; of open parts, all if together they set none */
  int64_t
      outside_parts;   /**< parts that set none because they lie outside of the grid: not among empty_parts */
  double fill_ms;      /**< of what is written to a file: time for making the voxels; else 0 */
  double write_ms;     /**< and for writing them */
  int64_t thin_voxels; /**< voxels that were added because parts are thinner than one */
  double thin_share;  /**< the share of the surface that needed them: 0 to 1; of signed distances, that has no
                         voxel inside */
  int64_t components; /**< pieces that share vertices, also after a repair has cut them apart, of which the
                         parts are made: those that stay open are one part. 1 with VXM_SPLIT_MODE_WHOLE.
                         Labels by part count what touches as one */
  int64_t self_overlapping_parts; /**< closed or capped parts that run through themselves, and are filled
                                     there, where parity would leave them hollow; 0 with another method than
                                     VXM_METHOD_VOTE, another vote than VXM_VOTE_AUTO, VXM_SPLIT_MODE_WHOLE,
                                     and without a solid */
  int64_t hollow_overlaps; /**< those that seem to, but whose faces are wound against each other, so that they
                              are left hollow there; 0 as self_overlapping_parts is */
  int64_t filled_overlaps; /**< parts with cavities that overlap each other, where what these share is filled;
                              0 as self_overlapping_parts is */
} vxm_voxelize_report;

/** Initial value of vxm_voxelize_report. */
#define VXM_VOXELIZE_REPORT_INIT \
  { sizeof(vxm_voxelize_report), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0, 0.0, 0, 0, 0, 0 }

/**
 * Voxelizes the inside of a mesh: voxel (i,j,k) is set where its centre is inside, and where parts thinner
 * than a voxel would fall apart otherwise (vxm_thin_parts).
 *
 * @param[out] out    new grid
 * @param[out] report may be NULL
 * @param mesh        polygons in model units; need not be closed, oriented or manifold; parts are found by
 * vertex index, so repair (or at least weld) it first
 * @param space       where the voxels lie; NULL = defaults
 * @param options     how; NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners;
 *         VXM_ERROR_RANGE if a vertex lies too far outside the grid, or voxels are too small, as
 * vxm_space_fit says; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Parity is computed exactly on an integer lattice (at least 1/256 voxel). For parts closed mod 2 all methods
 * give the same bits, except where a part cuts through itself, which the winding number fills, and the
 * default where it notices (more than some 10^-5 of the part), and for the winding number where a centre lies
 * on a face. With VXM_METHOD_WINDING the parts of the report are those of the solid that is made first, to
 * turn the faces.
 */
VXM_API vxm_status vxm_voxelize(vxm_grid **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                                const vxm_space_options *space, const vxm_voxelize_options *options,
                                vxm_error *error);

/**
 * Makes a closed surface of the solid of a mesh, at the resolution of a grid: between voxel centres that are
 * inside and those that are not, where the line between them meets the faces. Smooth surfaces come out
 * smooth, edges and corners cut by half a voxel at most. Thin parts are kept unless they are to be dropped,
 * as with VXM_THIN_KEEP26: plates and walls come out whole, at least as thick as two thirds of a voxel, with
 * their middle within half a voxel. All edges have two faces, and faces look outward.
 *
 * @param[out] report of the solid; may be NULL
 * @param mesh        repaired by vxm_mesh_prepare, as for vxm_voxelize
 * @param space       NULL = defaults; the grid is two voxels larger on each side
 * @param options     NULL = defaults; of VXM_MODE_SOLID
 * @return as vxm_voxelize and vxm_model_distance; the mesh has no face where no voxel is inside
 */
VXM_API vxm_status vxm_mesh_remesh(vxm_mesh **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                                   const vxm_space_options *space, const vxm_voxelize_options *options,
                                   vxm_error *error);

/* ---- Models: many grids of one mesh ---- */

/**
 * A mesh made ready for voxelizing: its parts are found, its holes capped. Making one costs more than a small
 * grid does; all its grids share its memory.
 *
 * Several threads may use one model at once, in any calls, each with memory of its own that is kept for the
 * next grid; the bits are the same. But a model with an engine other than the CPU may be used by one thread
 * at a time, as the engine may.
 */
typedef struct vxm_model vxm_model;

/**
 * Makes a model. Each grid brings its own space.
 *
 * @param mesh as for vxm_voxelize; must outlive the model and stay as it is
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_model_create(vxm_model **out, const vxm_mesh *mesh,
                                    const vxm_voxelize_options *options, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_model_destroy(vxm_model *model);

/**
 * Voxelizes a model into a grid: all bits of the grid are replaced.
 *
 * @param grid      says the space
 * @param report    NULL = not wanted, nor are warnings, which saves counting and hashing
 * @param transform NULL, or the 3 x 4 matrix, row after row, that takes (x, y, z, 1) of the mesh to where it
 * is voxelized, in model units
 * @return as vxm_voxelize; VXM_ERROR_ARGUMENT too for a matrix that is not finite or has determinant 0. After
 *         a failure the content of the grid is unspecified
 */
VXM_API vxm_status vxm_model_voxelize(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                                      const double transform[12], vxm_error *error);

/** What voxelizing a model into a file takes. */
typedef struct vxm_estimate {
  size_t size;           /**< as the initializer sets it, or 0 */
  uint64_t grid_bytes;   /**< one bit per voxel; of a field, its values */
  uint64_t memory_bytes; /**< held at most, beyond what the context holds already */
  int64_t passes;        /**< ranges of slices that are made and written one after another; 1 = all at once */
} vxm_estimate;

/** Initial value of vxm_estimate. */
#define VXM_ESTIMATE_INIT \
  { sizeof(vxm_estimate), 0, 0, 0 }

/** Estimates vxm_model_write under the memory limit of the mesh's context. @return as vxm_model_write, before
 * the work. Nothing is opened */
VXM_API vxm_status vxm_model_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                      const char *path, const vxm_grid_write_options *options,
                                      vxm_error *error);

/**
 * Voxelizes a model straight into a grid file. What does not fit the memory limit at once is made and written
 * range after range of slices, in the order of the file; the file is the same.
 *
 * @param report may be NULL
 * @param path as for vxm_grid_write, and so are the options. The mesh formats and the confidence need the
 * whole grid in memory
 * @return as vxm_voxelize and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                   const char *path, const vxm_grid_write_options *options, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
