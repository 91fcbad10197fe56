/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/sparse.h
 * Sparse sets of voxels, whose memory follows the surface.
 */
#ifndef VOXMEND_SPARSE_H
#define VOXMEND_SPARSE_H

#include "voxmend/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Sparse sets of voxels: memory follows the surface ---- */

/**
 * A set of voxels as a sparse octree over bricks of 4 x 4 x 4 voxels (Schwarz & Seidel 2010, section 5): only
 * bricks that are neither empty nor full are held. Equal sets in equal spaces have the same content.
 */
typedef struct vxm_sparse vxm_sparse;

/**
 * Voxelizes a model into an octree, straight from the triangles where its parts are closed, or closed by
 * caps, and for surfaces (then an OpenCL engine makes it on its device); else, and for shells of the solid,
 * by way of ranges of slices. The voxels are those of vxm_model_voxelize.
 *
 * @param report    NULL = not wanted, which saves counting and hashing
 * @param space     the octree's
 * @param transform as for vxm_model_voxelize
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT too if the model's options ask for the confidence
 */
VXM_API vxm_status vxm_model_sparse(vxm_sparse **out, vxm_voxelize_report *report, vxm_model *model,
                                    const vxm_space *space, const double transform[12], vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_sparse_destroy(vxm_sparse *sparse);

/** Where its voxels lie. */
VXM_API const vxm_space *vxm_sparse_space(const vxm_sparse *sparse);
/** Whether voxel (i,j,k) is set; false outside. */
VXM_API bool vxm_sparse_get(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k);
/** Number of set voxels. */
VXM_API int64_t vxm_sparse_count(const vxm_sparse *sparse);
/** vxm_grid_hash of the same voxels. */
VXM_API uint64_t vxm_sparse_hash(const vxm_sparse *sparse);
/** Bricks that are held. */
VXM_API int64_t vxm_sparse_bricks(const vxm_sparse *sparse);
/** Nodes of all levels. */
VXM_API int64_t vxm_sparse_nodes(const vxm_sparse *sparse);
/** Bytes that bricks and nodes take. */
VXM_API uint64_t vxm_sparse_bytes(const vxm_sparse *sparse);

/** Warnings from reading, one line each. */
VXM_API int64_t vxm_sparse_warning_count(const vxm_sparse *sparse);
/** One of them; "" if there is none of this number. */
VXM_API const char *vxm_sparse_warning(const vxm_sparse *sparse, int64_t index);

/** Makes an octree of the set voxels of a grid. @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
VXM_API vxm_status vxm_sparse_from_grid(vxm_sparse **out, const vxm_grid *grid, vxm_error *error);
/** Makes a grid of the set voxels of an octree. @return as vxm_grid_create */
VXM_API vxm_status vxm_sparse_to_grid(vxm_grid **out, const vxm_sparse *sparse, vxm_error *error);

/**
 * The voxels begin..end-1 along each axis as a new grid, which lies where they lie.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a window that is empty or not within the dimensions;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sparse_window(vxm_grid **out, const vxm_sparse *sparse, const int64_t begin[3],
                                     const int64_t end[3], vxm_error *error);

/**
 * Counts how much is set of each cube of voxels: the coverage of a grid that is coarser by a power of two. It
 * has the same minimum corner, and cubes at the far sides may reach beyond the dimensions, where nothing is
 * set. Counts are exact; each number is rounded once.
 *
 * @param options subdivision: voxels along a cube, 1, 2, 4, ... 2^20; scalar: VXM_FLOAT32 or VXM_FLOAT64, the
 * share, 0 to 1; VXM_UINT8, 255 times that, rounded, halves up; VXM_UINT64, the number of voxels, as
 * VXM_FIELD_NUMBERS; NULL = defaults
 * @param begin   cubes begin..end-1 along each axis; NULL = from the first, to the last
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_sparse_coverage(vxm_field **out, const vxm_sparse *sparse,
                                       const vxm_coverage_options *options, const int64_t begin[3],
                                       const int64_t end[3], vxm_error *error);

/**
 * Makes a new set of two of equal dimensions; it takes the space of `a`.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if the dimensions differ; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sparse_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                                      vxm_set_operation operation, vxm_error *error);

/** A cube of voxels that is full, or a brick of 4 x 4 x 4 that is not. */
typedef struct vxm_sparse_piece {
  size_t size;         /**< bytes that there are of it */
  int64_t position[3]; /**< its first voxel */
  int64_t side;        /**< voxels along it: 4 to the power of 1, 2, ... */
  uint64_t bits;       /**< of a brick: voxel (x,y,z) of it is bit 16 z + 4 y + x; all set for a cube */
} vxm_sparse_piece;

/** Called for a piece; `piece` is gone when it returns, which it has to (see "Callbacks" in voxmend/base.h).
 */
typedef void (*vxm_sparse_fn)(const vxm_sparse_piece *piece, void *payload);

/** Calls for each piece, in Morton order. */
VXM_API void vxm_sparse_visit(const vxm_sparse *sparse, vxm_sparse_fn function, void *payload);

/** As vxm_grid_write, slice by slice, but for .vdb and .bt, whose trees are made of the octree's pieces; not
 * as a mesh. @return as vxm_grid_write */
VXM_API vxm_status vxm_sparse_write(const vxm_sparse *sparse, const char *path,
                                    const vxm_grid_write_options *options, vxm_error *error);

/**
 * Reads a file of set voxels as an octree. Memory follows the surface for .octree, .bt, and for .vdb of bits;
 * other formats go by way of a grid.
 *
 * @return as vxm_grid_read
 */
VXM_API vxm_status vxm_sparse_read(vxm_sparse **out, vxm_context *context, const char *path,
                                   vxm_error *error);

/** An open .octree file, of which parts can be read. It does not change: several threads may read it. */
typedef struct vxm_sparse_file vxm_sparse_file;

/**
 * Opens an .octree file: it is mapped, and its header and index are read.
 *
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT with the byte offset; VXM_ERROR_RANGE, VXM_ERROR_ARGUMENT,
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_sparse_file_open(vxm_sparse_file **out, vxm_context *context, const char *path,
                                        vxm_error *error);
/** Closes it; NULL is allowed. */
VXM_API void vxm_sparse_file_close(vxm_sparse_file *file);
/** Where its voxels lie. */
VXM_API const vxm_space *vxm_sparse_file_space(const vxm_sparse_file *file);
/** Whether it holds numbers, labels or colours rather than set and clear voxels. */
VXM_API bool vxm_sparse_file_has_values(const vxm_sparse_file *file);
/** Number of set voxels, as the file tells it; of values, those that are not the background. */
VXM_API int64_t vxm_sparse_file_count(const vxm_sparse_file *file);
/**
 * Reads the voxels begin..end-1 along each axis as a grid; only what they need of the file is looked at.
 *
 * @return as vxm_sparse_window; VXM_ERROR_FORMAT with the byte offset where the file is damaged;
 * VXM_ERROR_NUMBERS if it has values
 */
VXM_API vxm_status vxm_sparse_file_window(vxm_grid **out, const vxm_sparse_file *file, const int64_t begin[3],
                                          const int64_t end[3], vxm_error *error);

/**
 * Reads the values of voxels begin..end-1 along each axis as a field; only what they need of the file is
 * looked at. A file of set voxels gives 0 and 1, as VXM_UINT8.
 *
 * @return as vxm_sparse_window; VXM_ERROR_FORMAT with the byte offset where the file is damaged
 */
VXM_API vxm_status vxm_sparse_file_field(vxm_field **out, const vxm_sparse_file *file, const int64_t begin[3],
                                         const int64_t end[3], vxm_error *error);

/**
 * As vxm_sparse_coverage, of a file: cubes of 256 voxels or more are counted by its index alone, of smaller
 * ones each thread has a row of tiles in memory at a time.
 *
 * @return as vxm_sparse_coverage; VXM_ERROR_FORMAT with the byte offset where the file is damaged;
 * VXM_ERROR_NUMBERS if it has values
 */
VXM_API vxm_status vxm_sparse_file_coverage(vxm_field **out, const vxm_sparse_file *file,
                                            const vxm_coverage_options *options, const int64_t begin[3],
                                            const int64_t end[3], vxm_error *error);

/**
 * Makes a new field of two of one kind and type and of equal dimensions; it takes the space of `a`.
 *
 * Labels, colours and numbers belong to the voxels that have any but 0, of colours to those that can be seen.
 * A voxel of the result has the value of `a`, or if that has none that of `b`; the others have 0. Labels of
 * one name are one, and those of `b` whose names `a` has not are numbered behind its own; without names, in
 * either, labels of one number are one. Numbers that a table lacks stay what they are. They become
 * VXM_UINT16.
 *
 * Of signed distances the union is the lesser, the intersection the greater, and the difference the greater
 * of a and -b (A. Ricci, A Constructive Geometry for Computer Graphics, The Computer Journal 16, 1973); the
 * symmetric difference is that of union and intersection. Signs are right everywhere, and distances on one
 * side of the surface; on the other they may be too short where both meet.
 *
 * @param operation not VXM_SET_COMPLEMENT
 * @return VXM_OK; VXM_ERROR_ARGUMENT for other dimensions, kinds or types, and for labels that are not of one
 * or two bytes; VXM_ERROR_RANGE beyond 65535 labels; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_field_combine(vxm_field **out, const vxm_field *a, const vxm_field *b,
                                     vxm_set_operation operation, vxm_error *error);

/**
 * Combines files with values to another, an .octree: as vxm_field_combine does, from the first to the last,
 * but memory follows what the files hold; time does, too, and has a share that follows the (dims / 16)^3
 * nodes.
 *
 * @param path       of the new file
 * @param files      `count` of them, two or more, of equal dimensions
 * @param operations count - 1 of them; the first is that of the first and the second file
 * @return as vxm_field_combine, vxm_sparse_file_field and vxm_grid_write; VXM_ERROR_ARGUMENT if one has no
 * values
 */
VXM_API vxm_status vxm_sparse_file_combine(const char *path, const vxm_sparse_file *const *files,
                                           int64_t count, const vxm_set_operation *operations,
                                           vxm_error *error);

/**
 * Writes the coordinates of all set voxels as .npy: int32, n rows of (i, j, k), sorted by i, then j, then k,
 * as numpy.argwhere gives them for the .npy of the grid.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the extension is another; VXM_ERROR_IO, VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_sparse_write_coords(const vxm_sparse *sparse, const char *path, vxm_error *error);
/** The same of a grid. @return as vxm_sparse_write_coords */
VXM_API vxm_status vxm_grid_write_coords(const vxm_grid *grid, const char *path, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
