/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/field.h
 * Fields: a number, label or colour for each voxel, of a model or in a file.
 */
#ifndef VOXMEND_FIELD_H
#define VOXMEND_FIELD_H

#include "voxmend/voxelize.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Fields in files: numbers, labels and colours ---- */

/** What the numbers of a field are, as far as its file says. */
typedef enum vxm_field_kind {
  VXM_FIELD_NUMBERS = 0, /**< it does not say */
  VXM_FIELD_DISTANCE,    /**< model units, negative inside where it has a sign */
  VXM_FIELD_COVERAGE,    /**< the share of a voxel that is filled: 0 to 1, or 0 to 255 of unsigned bytes */
  VXM_FIELD_LABELS,      /**< 0 = none */
  VXM_FIELD_CONFIDENCE,  /**< 0 = a guess, to 255 = proven */
  VXM_FIELD_COLORS       /**< red, green, blue and opacity, 0 = no voxel: VXM_UINT8, four channels */
} vxm_field_kind;

/** One number (or colour) for each voxel of a space. Its numbers do not change once it is made; labels and
 * metadata may be added until it is used by others. */
typedef struct vxm_field vxm_field;

/**
 * Makes a field of a copy of values.
 *
 * @param values [x][y][z] in C order (z fastest); of VXM_FIELD_COLORS [x][y][z][4]
 * @return VXM_OK; VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_field_create(vxm_field **out, vxm_context *context, const vxm_space *space,
                                    vxm_field_kind kind, vxm_scalar scalar, const void *values,
                                    vxm_error *error);

/**
 * Reads the numbers of a file as they are, in any format that vxm_grid_format_traits calls VXM_FORMAT_READ.
 * Files that hold bits give 0 and 1, as VXM_UINT8. Floats of 16 bits in .vdb become VXM_FLOAT32.
 *
 * @return as vxm_grid_read, without VXM_ERROR_NUMBERS
 */
VXM_API vxm_status vxm_field_read(vxm_field **out, vxm_context *context, const char *path, vxm_error *error);

/**
 * Reads what a file holds: a grid where it stores bits (booleans, or unsigned bytes of which all are 0 or 1),
 * else a field. Of *grid and *field one is NULL. @return as vxm_field_read
 */
VXM_API vxm_status vxm_grid_or_field_read(vxm_grid **grid, vxm_field **field, vxm_context *context,
                                          const char *path, vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_field_destroy(vxm_field *field);

/** Where its voxels lie. */
VXM_API const vxm_space *vxm_field_space(const vxm_field *field);
/** What its numbers are. */
VXM_API vxm_field_kind vxm_field_kind_of(const vxm_field *field);
/** Of which type they are. */
VXM_API vxm_scalar vxm_field_scalar(const vxm_field *field);
/** 4 of colours, else 1. */
VXM_API int vxm_field_channels(const vxm_field *field);
/** [x][y][z] in C order (z fastest), of colours [x][y][z][4]. */
VXM_API const void *vxm_field_values(const vxm_field *field);
/** Short fixed name of a kind, such as "distance", or "" for none. */
VXM_API const char *vxm_field_kind_name(vxm_field_kind kind);

/** The range of the values of a field. */
typedef struct vxm_field_range {
  size_t size;         /**< as the initializer sets it, or 0 */
  double min;          /**< of those that are numbers; of colours the opacity; 0 and 0 if none are */
  double max;          /**< in the same way */
  int64_t not_numbers; /**< NaN */
} vxm_field_range;

/** Initial value of vxm_field_range. */
#define VXM_FIELD_RANGE_INIT \
  { sizeof(vxm_field_range), 0.0, 0.0, 0 }

/** The range of the values. @return VXM_OK, VXM_ERROR_ARGUMENT */
VXM_API vxm_status vxm_field_measure(vxm_field_range *out, const vxm_field *field, vxm_error *error);

/** Number of labels that have an entry in the table beside the file, numbered from 1; 0 if there is none. */
VXM_API int64_t vxm_field_label_count(const vxm_field *field);
/** Name of label 1 to vxm_field_label_count; "" for others. */
VXM_API const char *vxm_field_label_name(const vxm_field *field, int64_t label);

/** What else a file says of its values, such as units, as pairs of texts; it goes along into .npy (its
 * .json), .nrrd, .vdb, .h5 and .zarr. */
VXM_API int64_t vxm_field_metadata_count(const vxm_field *field);
/** The first text of pair 0 to vxm_field_metadata_count - 1; "" for others. */
VXM_API const char *vxm_field_metadata_key(const vxm_field *field, int64_t index);
/** The second text of such a pair. */
VXM_API const char *vxm_field_metadata_value(const vxm_field *field, int64_t index);

/**
 * Adds the next label to the table of a field that has just been made.
 *
 * @param name   of the label, copied
 * @param voxels that have the label
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_RANGE beyond what a file may say, which is 1 MiB;
 * VXM_ERROR_MEMORY
 */
VXM_API vxm_status vxm_field_add_label(vxm_field *field, const char *name, int64_t voxels, vxm_error *error);
/** Adds a pair to the metadata. @return as vxm_field_add_label */
VXM_API vxm_status vxm_field_add_metadata(vxm_field *field, const char *key, const char *value,
                                          vxm_error *error);

/**
 * The values of voxels begin..end-1 along each axis as a new field, which lies where they lie, with what is
 * said of the values; of labels the voxels are counted anew.
 *
 * @return as vxm_grid_window
 */
VXM_API vxm_status vxm_field_window(vxm_field **out, const vxm_field *field, const int64_t begin[3],
                                    const int64_t end[3], vxm_error *error);

/** Warnings from reading, one line each. */
VXM_API int64_t vxm_field_warning_count(const vxm_field *field);
/** One of them; "" if there is none of this number. */
VXM_API const char *vxm_field_warning(const vxm_field *field, int64_t index);

/** Whether the numbers are bits in another type, of which nothing is lost: see vxm_grid_read. */
VXM_API bool vxm_field_is_mask(const vxm_field *field);

/** Which numbers become set voxels. */
typedef struct vxm_threshold_options {
  size_t size;       /**< as the initializer sets it */
  bool use_at_least; /**< at least one of the two */
  double at_least;   /**< voxels are set where the value is this or greater */
  bool use_below;    /**< the other of them */
  double below;      /**< and less than this */
} vxm_threshold_options;

/** Initial value of vxm_threshold_options. */
#define VXM_THRESHOLD_OPTIONS_INIT \
  { sizeof(vxm_threshold_options), false, 0.0, false, 0.0 }

/**
 * Makes a grid of a field: voxel (i,j,k) is set where its value is at least one number, below another, or
 * both. -0 counts as below 0: a distance has it inside, on the surface. What is not a number is never set. Of
 * colours the opacity counts.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT without a bound, or if one is not a number; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_field_threshold(vxm_grid **out, const vxm_field *field,
                                       const vxm_threshold_options *options, vxm_error *error);

/**
 * Writes a field, under a temporary name first; "-" writes standard output.
 *
 * .npy (with its .json beside it) and .nrrd hold every type (VXM_FLOAT16 becomes VXM_FLOAT32 in .nrrd), .vdb
 * 32-bit floats, if each value is one exactly; it remembers the type. .binvox (version 2) holds whole numbers
 * from 0 to 255. .octree, .h5, .zarr, .nii, .vti, .vtk and .tif hold what .nrrd does, slices as .png whole
 * numbers of 8 and 16 bits. Colours go into all of these but .vdb and .binvox, and into .ply, .glb, .vox,
 * .schem and .litematic; labels, as whole numbers, into the last four, too. Labels have their table in a
 * .json beside the file.
 *
 * @param options NULL = defaults
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a format that holds only bits or is unknown; VXM_ERROR_RANGE if it
 *         cannot hold the values; as vxm_grid_write
 */
VXM_API vxm_status vxm_field_write(const vxm_field *field, const char *path,
                                   const vxm_grid_write_options *options, vxm_error *error);

/**
 * Draws a field into a PNG file as vxm_grid_picture does: of distances what is below 0, or nearer than half a
 * voxel's diagonal if none is; coverage from one half on; labels in colours that depend on the label alone;
 * confidence below 255; colours as they are. Numbers of which the file does not say what they are count as
 * labels if they are whole and not negative, as distances if some are below 0 and some above, as coverage if
 * all are from 0 to 1.
 *
 * A slice shows all cells: labels and colours as they are; distances in blue below 0 and red above, with a
 * line where they are 0; coverage in grey; other numbers from dark blue to yellow; beside it the range of
 * colours.
 *
 * @param options   NULL = defaults
 * @param threshold the voxels to be drawn, but in a slice; NULL = as above
 * @return as vxm_grid_picture; VXM_ERROR_NUMBERS for other numbers without a threshold
 */
VXM_API vxm_status vxm_field_picture(const vxm_field *field, const char *path,
                                     const vxm_picture_options *options,
                                     const vxm_threshold_options *threshold, vxm_error *error);

/**
 * Writes a page as vxm_grid_page does, with labels to be switched on and off, and a threshold of numbers,
 * which are rounded to 1/32766 of the largest.
 *
 * @param options   NULL = defaults
 * @param threshold what is shown at first; NULL = as vxm_field_picture, and the upper half of other numbers
 * @return as vxm_grid_page; VXM_ERROR_RANGE beyond 2^26 numbers or 2^25 colours
 */
VXM_API vxm_status vxm_field_page(const vxm_field *field, const char *path, const vxm_page_options *options,
                                  const vxm_threshold_options *threshold, vxm_error *error);

/* ---- Fields: a number per voxel ---- */

/** How finely coverage is counted, and as what. */
typedef struct vxm_coverage_options {
  size_t size;       /**< as the initializer sets it */
  int subdivision;   /**< 2, 4 or 8: a voxel is cut into so many sub-voxels along each axis */
  vxm_scalar scalar; /**< VXM_FLOAT32: the fraction, 0 to 1; VXM_UINT8: 255 times that, rounded, halves up */
  const char *
      format; /**< of a file: one that vxm_grid_format_traits calls VXM_FORMAT_NUMBERS; NULL = by extension */
} vxm_coverage_options;

/** Initial value of vxm_coverage_options. */
#define VXM_COVERAGE_OPTIONS_INIT \
  { sizeof(vxm_coverage_options), 4, VXM_FLOAT32, NULL }

/** What came of coverage. */
typedef struct vxm_coverage_report {
  size_t size; /**< as the initializer sets it, or 0 */
  vxm_voxelize_report
      *voxelize;   /**< set by the caller: NULL, or where that of the sub-voxels goes, without their hash */
  int64_t full;    /**< voxels of which all sub-voxels are set */
  int64_t partial; /**< voxels of which some are, but not all */
  double volume;   /**< sum of the fractions times the volume of a voxel */
} vxm_coverage_report;

/** Initial value of vxm_coverage_report. */
#define VXM_COVERAGE_REPORT_INIT \
  { sizeof(vxm_coverage_report), NULL, 0, 0, 0.0 }

/**
 * Computes how much of each voxel of a space the model fills: the fraction of its sub-voxels that are set, as
 * the options of the model say. They are made a few slices at a time, never all at once.
 * Voxels that vxm_thin_parts adds are not counted: they have no share.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] float or uint8_t, as [x][y][z] in C order (z fastest);
 *                aligned as these are, or VXM_ERROR_ARGUMENT
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_RANGE beyond 2^20 sub-voxels along an axis. After a failure the
 * values are unspecified
 */
VXM_API vxm_status vxm_model_coverage(void *values, vxm_coverage_report *report, vxm_model *model,
                                      const vxm_space *space, const vxm_coverage_options *options,
                                      vxm_error *error);

/** As vxm_model_coverage, into a file: .npy (with its .json beside it), .nrrd, .vdb and others; as much at a
 * time as the memory limit allows. @return as vxm_model_coverage and vxm_grid_write */
VXM_API vxm_status vxm_model_write_coverage(vxm_coverage_report *report, vxm_model *model,
                                            const vxm_space *space, const char *path,
                                            const vxm_coverage_options *options, vxm_error *error);

/** Estimates vxm_model_write_coverage, as vxm_model_estimate does; what a .vdb holds until it is written
 * follows the surface, and is not counted. */
VXM_API vxm_status vxm_model_estimate_coverage(vxm_estimate *out, const vxm_model *model,
                                               const vxm_space *space, const char *path,
                                               const vxm_coverage_options *options, vxm_error *error);

/** Which distances, and how far. */
typedef struct vxm_distance_options {
  size_t size;      /**< as the initializer sets it */
  bool is_unsigned; /**< false = negative where the centre is inside the solid */
  double band;      /**< voxels, of the longest side; 0 = everywhere */
  const char *
      format; /**< of a file: one that vxm_grid_format_traits calls VXM_FORMAT_NUMBERS; NULL = by extension */
} vxm_distance_options;

/** Initial value of vxm_distance_options. */
#define VXM_DISTANCE_OPTIONS_INIT \
  { sizeof(vxm_distance_options), false, 3.0, NULL }

/** What came of distances. */
typedef struct vxm_distance_report {
  size_t size;                   /**< as the initializer sets it, or 0 */
  vxm_voxelize_report *voxelize; /**< set by the caller: NULL, or where that of the solid that gives the sign
                                    goes, without its hash; zeros if unsigned */
  int64_t exact;                 /**< voxels that are not clamped */
  double min;                    /**< of all values */
  double max;                    /**< of all values */
} vxm_distance_report;

/** Initial value of vxm_distance_report. */
#define VXM_DISTANCE_REPORT_INIT \
  { sizeof(vxm_distance_report), NULL, 0, 0.0, 0.0 }

/**
 * Computes the distance from the centre of each voxel to the faces of the mesh, in model units. Within the
 * band it is exact: off by some 1e-14 of the distance and the longest edges, and then rounded to the nearest
 * 32-bit float (which holds 1e-5 voxel up to 168 voxels). Beyond, it is plus or minus the width of the band,
 * which is `band` times the longest side of a voxel. The sign is that of the solid of centres
 * (vxm_voxelize with VXM_THIN_DROP). With a band, time follows surface times band, beside that of the solid.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] values, as [x][y][z] in C order (z fastest)
 * @param report  may be NULL
 * @param model   of VXM_MODE_SOLID
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT for another mode; VXM_ERROR_RANGE for voxels so large or
 * small that 32-bit floats do not hold the distances. After a failure the values are unspecified
 */
VXM_API vxm_status vxm_model_distance(float *values, vxm_distance_report *report, vxm_model *model,
                                      const vxm_space *space, const vxm_distance_options *options,
                                      vxm_error *error);

/** As vxm_model_distance, into a file: .npy (with its .json beside it), .nrrd, .vdb and others; as much at a
 * time as the memory limit allows. For .octree, with a band, only what is near the surface is measured.
 * @return as vxm_model_distance and vxm_grid_write */
VXM_API vxm_status vxm_model_write_distance(vxm_distance_report *report, vxm_model *model,
                                            const vxm_space *space, const char *path,
                                            const vxm_distance_options *options, vxm_error *error);

/** Estimates vxm_model_write_distance, as vxm_model_estimate does; what a .vdb or .octree holds until it is
 * written follows the surface, and is not counted. */
VXM_API vxm_status vxm_model_estimate_distance(vxm_estimate *out, const vxm_model *model,
                                               const vxm_space *space, const char *path,
                                               const vxm_distance_options *options, vxm_error *error);

/* ---- Labels: which part, group or material a voxel belongs to ---- */

/** What faces are labelled by. A part here, in colours and in the account of a repair is a connected
 * component; in vxm_voxelize_report it is what is voxelized by itself, and all open components are one. */
typedef enum vxm_label_by {
  VXM_LABEL_PART = 0, /**< connected components */
  VXM_LABEL_GROUP,    /**< groups, or parts named in the file: of a face tag what lies before the first '/' */
  VXM_LABEL_MATERIAL  /**< materials: what lies behind it */
} vxm_label_by;

/**
 * Takes a mesh apart by its groups or materials, to be repaired, voxelized and labelled: bodies of an
 * assembly share walls, which a repair of all together would remove, or take for those of one body. Each
 * label that is closed by itself, every edge with an even number of its faces, gets vertices of its own;
 * vxm_mesh_prepare repairs its faces as if they were alone, and what is a cavity is first looked for within
 * it. So vxm_model_labels gives each closed label what it encloses. All other labels stay together, as
 * patches of one surface are closed by each other. It is what voxmend voxelize --labels group and the Python
 * package's labels do before they repair, or leave that out.
 *
 * The result has the faces and tags of the mesh. It is to be used with the functions of models and
 * vxm_mesh_prepare; others, such as vxm_mesh_repair, take it for any mesh.
 *
 * @param by with VXM_LABEL_PART, or if no label is closed or there is but one, the result is a plain copy
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_RANGE beyond 65535 labels, or too many vertices;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_mesh_divide(vxm_mesh **out, const vxm_mesh *mesh, vxm_label_by by, vxm_error *error);

/** What labels are of, and the format of their file. */
typedef struct vxm_label_options {
  size_t size;     /**< as the initializer sets it */
  vxm_label_by by; /**< what faces are labelled by */
  const char
      *format; /**< of a file: one that vxm_grid_format_traits calls VXM_FORMAT_LABELS; NULL = by extension */
  const char *blocks; /**< of a file: as in vxm_grid_write_options */
  int up;             /**< of a file: as in vxm_grid_write_options */
} vxm_label_options;

/** Initial value of vxm_label_options. */
#define VXM_LABEL_OPTIONS_INIT \
  { sizeof(vxm_label_options), VXM_LABEL_PART, NULL, NULL, 0 }

/** What came of labels. */
typedef struct vxm_label_report {
  size_t size;                   /**< as the initializer sets it, or 0 */
  vxm_voxelize_report *voxelize; /**< set by the caller: NULL, or where that of the set voxels goes */
  int64_t labels;                /**< numbered from 1 in the order of their first faces */
  int64_t contested;             /**< voxels that several labels claim */
  int64_t unassigned;            /**< voxels that none claims: they have the label of the nearest face of all.
                                    Those that vxm_thin_parts adds are among them */
} vxm_label_report;

/** Initial value of vxm_label_report. */
#define VXM_LABEL_REPORT_INIT \
  { sizeof(vxm_label_report), NULL, 0, 0, 0 }

/**
 * Labels the voxels of a model: 0 where none is set, else the part, group or material that it belongs to. Set
 * are the voxels that vxm_model_voxelize sets. A label claims the voxels whose centres are inside its own
 * faces, voxelized alone as the options of the model say with VXM_MODE_SOLID, within their bounds. Of several
 * labels that claim a voxel, or of all where none does, it has the one with the face nearest to its centre;
 * among equally near ones, to seven digits, the lowest. The number of threads makes no difference.
 *
 * Bodies that share walls keep these for labels of groups or materials if the mesh went through
 * vxm_mesh_divide before it was repaired; the voxels set are then those of each closed group, and of the
 * rest.
 *
 * Groups and materials need not be bodies of their own. One is open if an odd number of its faces meet at an
 * edge, as those of a patch of a surface do at its border, or if no centre is inside its faces. What an open
 * one encloses is a guess, and it may be nothing, so at the surface the faces count: a voxel of an open
 * label, no farther from the nearest face of all than the longest side of a voxel, has the label of that face
 * if that is open too; where a face of its own is as near it keeps its own. Closed labels keep their voxels,
 * and take none of others. Parts are bodies, also where they are open.
 *
 * @param values  room for dims[0]*dims[1]*dims[2] values, as [x][y][z] in C order (z fastest)
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_RANGE beyond 65535 labels. After a failure the values are
 * unspecified
 */
VXM_API vxm_status vxm_model_labels(uint16_t *values, vxm_label_report *report, vxm_model *model,
                                    const vxm_space *space, const vxm_label_options *options,
                                    vxm_error *error);

/**
 * As vxm_model_labels, into a file: .npy, .nrrd and others, or .binvox (version 2), which holds 255 labels at
 * most. The table of labels goes into a .json beside it. All values are in memory meanwhile, but for .octree,
 * of which only voxels that are set are made: vxm_sparse_file_field reads parts of that. @return as
 * vxm_model_labels and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write_labels(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                                          const char *path, const vxm_label_options *options,
                                          vxm_error *error);

/* ---- Colours ---- */

/** What gives a voxel its colour (Rueda et al., section 5). */
typedef enum vxm_color_by {
  VXM_COLOR_NOISE = 0, /**< Perlin's noise in three dimensions, four octaves */
  VXM_COLOR_POSITION,  /**< red, green and blue along x, y and z */
  VXM_COLOR_PART,      /**< a hue for each connected component */
  VXM_COLOR_GLSL,      /**< a function in GLSL: needs an engine of OpenGL */
  VXM_COLOR_MESH,      /**< the mesh as it was read: its vertices, faces, materials and textures */
  VXM_COLOR_VOLUME     /**< a field that is sampled at the voxels' centres */
} vxm_color_by;

/** Which colours, and the format of their file. */
typedef struct vxm_color_options {
  size_t size;     /**< as the initializer sets it */
  vxm_color_by by; /**< what gives the colours */
  const char
      *source; /**< with VXM_COLOR_GLSL: defines vec3 color(vec3 position, vec3 unit, uint part), of the
                  centre in model units, the same from the grid's corner on with its longest side as 1,
                  and the number of the component, from 1 on; may call float noise(vec3), -1 to 1 */
  const char
      *format; /**< of a file: one that vxm_grid_format_traits calls VXM_FORMAT_COLORS; NULL = by extension */
  const vxm_mesh *mesh; /**< with VXM_COLOR_MESH: read with its colours (vxm_mesh_read_options), not repaired,
                           and in the same coordinates as the model's, which may be its repair */
  bool average; /**< with VXM_COLOR_MESH: the mean over the surface within a voxel, by area and in linear
                   light, where there is any; else the colour of the nearest point to its centre.
                   Of two walls upon each other that of the voxel's own body counts */
  const char *blocks;      /**< of a file: as in vxm_grid_write_options */
  int up;                  /**< of a file: as in vxm_grid_write_options */
  const vxm_field *volume; /**< with VXM_COLOR_VOLUME: numbers or colours, in the same coordinates as the
                              model's. Between the centres of its voxels they are interpolated along x, y and
                              z; beyond the outermost centres the nearest point counts. Numbers are grey,
                              black the least and white the greatest of the volume; what is no finite number,
                              or has no colour, does not count, and is black where nothing else is near */
} vxm_color_options;

/** Initial value of vxm_color_options. */
#define VXM_COLOR_OPTIONS_INIT \
  { sizeof(vxm_color_options), VXM_COLOR_NOISE, NULL, NULL, NULL, false, NULL, 0, NULL }

/**
 * Gives each set voxel of a model a colour.
 *
 * @param values  room for dims[0]*dims[1]*dims[2]*4 bytes, as [x][y][z][4] in C order: red, green, blue and
 *                255; zeros where no voxel is set
 * @param report  may be NULL
 * @param options NULL = defaults
 * @return as vxm_model_voxelize; VXM_ERROR_ARGUMENT too, with what the driver says, for a function that does
 *         not compile, for a mesh without colours, and for a volume of labels or one beside the grid;
 * VXM_ERROR_UNAVAILABLE for GLSL without an engine of OpenGL. The engine and the CPU may differ by 1 in the
 * built-in functions. After a failure the values are unspecified
 */
VXM_API vxm_status vxm_model_colors(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                                    const vxm_space *space, const vxm_color_options *options,
                                    vxm_error *error);

/**
 * As vxm_model_colors, into a file: .npy, uint8 [x][y][z][4] (with its .json beside it); .ply, the faces
 * between set and empty voxels with coloured corners; .vox of MagicaVoxel, where colours are
 * told apart by 5 bits each and reduced to at most 255, and every 256 voxels along an axis begin another
 * model; .octree, of which only voxels that are set are made, unless an engine makes the colours, or
 * `average` is wanted. @return as vxm_model_colors and vxm_grid_write
 */
VXM_API vxm_status vxm_model_write_colors(vxm_voxelize_report *report, vxm_model *model,
                                          const vxm_space *space, const char *path,
                                          const vxm_color_options *options, vxm_error *error);

/* What a call leaves in the model, labels and warnings, belongs to the thread that made it, until that
 * thread's next call. A thread that has made nothing of the model is told what another has made last, which
 * it may read while that one is not at work. */

/** Number of labels of the last labels made of the model; 0 if there are none. */
VXM_API int64_t vxm_model_label_count(const vxm_model *model);
/** Name of label 1 to vxm_model_label_count: that of the group or material, or "unnamed"; of a part that of
 * its tag, or of its group, if its faces share one, else "part " and its number. Names may repeat. "" for
 * others. */
VXM_API const char *vxm_model_label_name(const vxm_model *model, int64_t label);
/** Voxels that have a label. */
VXM_API int64_t vxm_model_label_voxels(const vxm_model *model, int64_t label);

/** Warnings from the last grid or file made of the model, one line each. */
VXM_API int64_t vxm_model_warning_count(const vxm_model *model);
/** One of them; "" if there is none of this number. */
VXM_API const char *vxm_model_warning(const vxm_model *model, int64_t index);

#ifdef __cplusplus
}
#endif
#endif
