/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/grid.h
 * Voxel spaces and grids of bits: made, read, written, drawn and compared.
 */
#ifndef VOXMEND_GRID_H
#define VOXMEND_GRID_H

#include "voxmend/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Grids ---- */

/** A box of dims[0] x dims[1] x dims[2] cells: the centre of (i,j,k) is origin + ((i,j,k) + 1/2) *
 * voxel_size. */
typedef struct vxm_space {
  int64_t dims[3];      /**< cells along x, y and z */
  double origin[3];     /**< minimum corner, model units */
  double voxel_size[3]; /**< model units per axis */
} vxm_space;

/** One bit per voxel, x fastest, rows padded to whole 64-bit words with zero bits. */
typedef struct vxm_grid vxm_grid;

/** Makes an empty grid. @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
VXM_API vxm_status vxm_grid_create(vxm_grid **out, vxm_context *context, const vxm_space *space,
                                   vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_grid_destroy(vxm_grid *grid);

/** Where its voxels lie. */
VXM_API const vxm_space *vxm_grid_space(const vxm_grid *grid);
/** Whether voxel (i,j,k) is set; false outside the grid. */
VXM_API bool vxm_grid_get(const vxm_grid *grid, int64_t i, int64_t j, int64_t k);
/** Sets or clears voxel (i,j,k); outside the grid it does nothing. */
VXM_API void vxm_grid_set(vxm_grid *grid, int64_t i, int64_t j, int64_t k, bool value);
/** Words of a row: (dims[0] + 63) / 64. */
VXM_API int64_t vxm_grid_row_words(const vxm_grid *grid);
/** Row (j,k) starts at word (k * dims[1] + j) * row_words; voxel i is bit i % 64 of its word i / 64. */
VXM_API const uint64_t *vxm_grid_words(const vxm_grid *grid);
/** Number of set voxels. */
VXM_API int64_t vxm_grid_count(const vxm_grid *grid);
/** The smallest box that has all set voxels, begin..end-1 along each axis, as vxm_grid_window takes it.
 * @return false, and 0 in all six, if no voxel is set */
VXM_API bool vxm_grid_box(int64_t begin[3], int64_t end[3], const vxm_grid *grid);
/** A 64-bit hash of dimensions and bits, the same on every machine. */
VXM_API uint64_t vxm_grid_hash(const vxm_grid *grid);
/** One byte, 0 or 1, per voxel into dims[0]*dims[1]*dims[2] bytes, as [x][y][z] in C order (z fastest). */
VXM_API void vxm_grid_unpack(const vxm_grid *grid, uint8_t *bytes);
/** Sets all voxels from such bytes: those that are not 0. */
VXM_API void vxm_grid_pack(vxm_grid *grid, const uint8_t *bytes);
/**
 * As vxm_grid_unpack, of the voxels (i,j,k) with i from begin to end - 1, into (end - begin)*dims[1]*dims[2]
 * bytes; with progress, and to be cancelled.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if an argument is NULL or the range does not lie within the grid;
 *         VXM_ERROR_CANCELLED, then the bytes are unspecified
 */
VXM_API vxm_status vxm_grid_unpack_range(const vxm_grid *grid, int64_t begin, int64_t end, uint8_t *bytes,
                                         vxm_error *error);
/** The same the other way; voxels outside of the range stay. @return as vxm_grid_unpack_range; after
 * VXM_ERROR_CANCELLED some are set */
VXM_API vxm_status vxm_grid_pack_range(vxm_grid *grid, int64_t begin, int64_t end, const uint8_t *bytes,
                                       vxm_error *error);
/**
 * Sets all voxels from words as vxm_grid_words gives them; bits beyond the end of a row are left out.
 *
 * @param count row_words * dims[1] * dims[2]
 * @return VXM_OK; VXM_ERROR_ARGUMENT if an argument is NULL or `count` is another number
 */
VXM_API vxm_status vxm_grid_set_words(vxm_grid *grid, const uint64_t *words, size_t count, vxm_error *error);
/**
 * How sure each voxel is, 0 (a guess) to 255 (proven), dims[0]*dims[1]*dims[2] bytes with x fastest; NULL
 * unless the grid was made with vxm_voxelize_options.confidence. A voxel decided by closed parts alone has
 * 255, one decided by the winding number w has 255 times the smaller of 1 and |2 w - 1|, any other the share
 * of the voters x, y, z and tetra that agree with it; what the surface sets has 255.
 */
VXM_API const uint8_t *vxm_grid_confidence(const vxm_grid *grid);
/**
 * Writes the confidence as .npy: uint8, indexed [x][y][z], stored with x fastest.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the grid has none or the extension is another; VXM_ERROR_IO,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_grid_write_confidence(const vxm_grid *grid, const char *path, vxm_error *error);
/**
 * The voxels begin..end-1 along each axis as a new grid, which lies where they lie, without their confidence.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a window that is empty or not within the dimensions;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_grid_window(vxm_grid **out, const vxm_grid *grid, const int64_t begin[3],
                                   const int64_t end[3], vxm_error *error);
/** Warnings from voxelizing or reading, one line each. */
VXM_API int64_t vxm_grid_warning_count(const vxm_grid *grid);
/** One of them; "" if there is none of this number. */
VXM_API const char *vxm_grid_warning(const vxm_grid *grid, int64_t index);

/**
 * Reads a grid: .binvox, .npy, .raw (with its .json beside it), .rle, .nrrd, .nii, .nii.gz, .vti, .vtk, .tif,
 * slices as .png or .tif (slice_%04d.png), .octree, .bt, .h5, .zarr (a folder), .vox, .schem, .litematic or
 * .vdb, told by content first and by name second. Of .vdb, the first grid of bool, mask
 * or float: of bool and mask, what is active (and true) is set. "-" reads standard input (not .raw).
 *
 * Numbers are taken as voxels only if nothing is lost: where all of them are 0 or 1, whatever their type, or
 * unsigned bytes of which some are 0 and the others 255. Distances and confidences, and colours, never are.
 *
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT with offset; VXM_ERROR_NUMBERS for other numbers, which
 *         vxm_field_read reads; VXM_ERROR_UNAVAILABLE if the library that the format needs is not
 *         there; VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error);

/** The format of a grid file. */
typedef struct vxm_grid_write_options {
  size_t size;        /**< as the initializer sets it */
  const char *format; /**< one that vxm_grid_format_traits calls VXM_FORMAT_BITS, such as "binvox"; NULL =
                         by extension */
  bool keep_polygons; /**< obj, ply, off: polygons, rather than triangles: rectangles with further corners */
  bool keep_contacts; /**< meshes: where voxels touch in an edge or a corner alone they share its vertices, so
                         that edges may have four faces, rather than having vertices of their own */
  const char *blocks; /**< schem, litematic: names of blocks between commas: the first for voxels, all in turn
                         for labels, those to choose from for colours; NULL = stone, dyed blocks, and all that
                         are known */
  int up;             /**< schem, litematic, glb: axis that points up: 0 = default (z), 1 = x, 2 = y, 3 = z */
} vxm_grid_write_options;

/** Initial value of vxm_grid_write_options. */
#define VXM_GRID_WRITE_OPTIONS_INIT \
  { sizeof(vxm_grid_write_options), NULL, false, false, NULL, 0 }

/**
 * Writes a grid, under a temporary name first. "-" writes standard output (not .raw). The mesh formats hold
 * the grid's surface as vxm_grid_surface_mesh makes it. .binvox pads a grid that is not cubic at its far
 * side.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown format, or .binvox with voxels that are not cubes;
 * VXM_ERROR_UNAVAILABLE if the library that the format needs is not there; VXM_ERROR_IO; VXM_ERROR_RANGE,
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_write(const vxm_grid *grid, const char *path,
                                  const vxm_grid_write_options *options, vxm_error *error);

/**
 * Makes a mesh of the exposed voxel faces in model units, facing outward, merged into rectangles that share
 * vertices, and split into triangles. Every edge has two faces: where voxels touch in an edge or a corner
 * alone each side has vertices of its own, 1/256 of a voxel within its own voxels along the axes concerned,
 * so that programs that merge vertices leave them be.
 *
 * @param[out] out  owned by the caller (vxm_mesh_destroy)
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_RANGE beyond 2^32 - 2 vertices; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_surface_mesh(vxm_mesh **out, const vxm_grid *grid, vxm_error *error);

/** From where a picture is taken, and its size. */
typedef struct vxm_picture_options {
  size_t size;      /**< as the initializer sets it */
  int width;        /**< pixels; 0 = 800 */
  int height;       /**< pixels; 0 = 600 */
  double azimuth;   /**< degrees about the up axis */
  double elevation; /**< degrees above the horizon */
  int up;           /**< axis that points up: 0 = default (z), 1 = x, 2 = y, 3 = z */
  int slice_axis;   /**< draw the cross-section along 1 = x, 2 = y or 3 = z; 0 = all (engines count from 0) */
  double slice;     /**< where: a share of the grid's length along that axis, 0 to 1 */
} vxm_picture_options;

/** Initial value of vxm_picture_options. */
#define VXM_PICTURE_OPTIONS_INIT \
  { sizeof(vxm_picture_options), 0, 0, 30.0, 25.0, 0, 0, 0.0 }

/**
 * Draws the grid as shaded voxels, or a slice of it as cells, into a PNG file.
 *
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE without libpng; VXM_ERROR_ARGUMENT, VXM_ERROR_IO, VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_picture(const vxm_grid *grid, const char *path,
                                    const vxm_picture_options *options, vxm_error *error);

/** What can be done with a format of grid files. */
typedef enum vxm_format_trait {
  VXM_FORMAT_BITS = 1,         /**< set and clear voxels are written */
  VXM_FORMAT_NUMBERS = 2,      /**< a number per voxel is */
  VXM_FORMAT_LABELS = 4,       /**< a label per voxel is */
  VXM_FORMAT_COLORS = 8,       /**< a colour per voxel is */
  VXM_FORMAT_READ = 16,        /**< files are read too */
  VXM_FORMAT_SURFACE = 32,     /**< of set voxels the surface is written, as a mesh */
  VXM_FORMAT_SLICES = 64,      /**< set voxels are written slice by slice, without the whole grid */
  VXM_FORMAT_JSON = 128,       /**< a file of the same name with .json added is written too */
  VXM_FORMAT_LABELS_JSON = 256 /**< that is so where there is a table of labels */
} vxm_format_trait;

/** The formats of grid files that this build knows, in a fixed order: the name of one, which is also its
 * extension, or "" beyond the last. */
VXM_API const char *vxm_grid_format_name(int64_t index);
/** The traits of a format by its name, in any case; 0 if there is none of this name. */
VXM_API unsigned vxm_grid_format_traits(const char *name);
/** The name of the format that a file's name tells, or "". */
VXM_API const char *vxm_grid_format_of(const char *path);

/** What a page shows beside the voxels. */
typedef struct vxm_page_options {
  size_t size;              /**< as the initializer sets it */
  const char *title;        /**< UTF-8; NULL = none */
  const vxm_mesh *mesh;     /**< drawn over the voxels, with its defects as layers; NULL = none */
  const vxm_mesh *repaired; /**< what became of it by a repair, to show what that changed; NULL = nothing */
  int up;                   /**< axis that points up: 0 = default (z), 1 = x, 2 = y, 3 = z */
} vxm_page_options;

/** Initial value of vxm_page_options. */
#define VXM_PAGE_OPTIONS_INIT \
  { sizeof(vxm_page_options), NULL, NULL, NULL, 0 }

/**
 * Writes a page that shows the grid in a browser, whole in one file (HTML, WebGL 2): to be turned, cut along
 * the axes and, with a mesh, compared with that. A mesh of more than four million triangles is left out.
 *
 * @param options NULL = defaults
 * @return VXM_OK; VXM_ERROR_RANGE beyond 2^27 voxels, or 2048 along a side; VXM_ERROR_ARGUMENT, VXM_ERROR_IO,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_grid_page(const vxm_grid *grid, const char *path, const vxm_page_options *options,
                                 vxm_error *error);

/**
 * Reads only where the voxels of a grid or field lie: a grid in which none is set.
 *
 * @return as vxm_grid_read, without VXM_ERROR_NUMBERS
 */
VXM_API vxm_status vxm_grid_read_space(vxm_grid **out, vxm_context *context, const char *path,
                                       vxm_error *error);

/** How two grids differ. */
typedef struct vxm_comparison {
  size_t size;      /**< as the initializer sets it, or 0 */
  int64_t voxels_a; /**< set in the first */
  int64_t voxels_b; /**< set in the second */
  int64_t both;     /**< set in both */
  int64_t only_a;   /**< set in the first alone */
  int64_t only_b;   /**< set in the second alone */
  double iou;       /**< both / (both + only_a + only_b); 1 if both grids are empty */
} vxm_comparison;

/** Initial value of vxm_comparison. */
#define VXM_COMPARISON_INIT \
  { sizeof(vxm_comparison), 0, 0, 0, 0, 0, 0.0 }

/** Compares two grids of equal dimensions. @return VXM_OK; VXM_ERROR_ARGUMENT if the dimensions differ */
VXM_API vxm_status vxm_grid_compare(vxm_comparison *out, const vxm_grid *a, const vxm_grid *b,
                                    vxm_error *error);

/** What two sets of voxels are combined to. */
typedef enum vxm_set_operation {
  VXM_SET_UNION = 0,
  VXM_SET_INTERSECTION,
  VXM_SET_DIFFERENCE, /**< what `a` has and `b` has not */
  VXM_SET_SYMMETRIC_DIFFERENCE,
  VXM_SET_COMPLEMENT /**< what `a` has not, within its box; `b` is NULL */
} vxm_set_operation;

/**
 * Makes a new grid of two of equal dimensions; it takes the space of `a`, and has no confidence.
 *
 * @param[out] out owned by the caller (vxm_grid_destroy)
 * @return VXM_OK; VXM_ERROR_ARGUMENT, also if the dimensions differ; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_grid_combine(vxm_grid **out, const vxm_grid *a, const vxm_grid *b,
                                    vxm_set_operation operation, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
