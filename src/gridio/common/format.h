/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of grid formats, and what its readers and writers share. */
#ifndef VXM_GRIDIO_COMMON_FORMAT_H
#define VXM_GRIDIO_COMMON_FORMAT_H

#include "base/output.h"
#include "gridio/common/grid_writer.h"
#include "gridio/common/scalar_type.h"
#include "gridio/common/sidecar.h"
#include "voxmend/sparse.h"

/** A file in the making; what its format needs lies in `state`. */
struct vxm_grid_writer {
  vxm_context *context; /**< one reference held */
  const struct vxm_grid_format *format;
  vxm_space space;
  vxm_output *output;  /**< NULL after its failure has been reported */
  vxm_output *sidecar; /**< NULL if there is none */
  bool report;
  int64_t next; /**< slice */
  int64_t
      length; /**< slices of the file, its padding included; those of the space unless `begin` says more */
  void *state;
  bool is_begun; /**< `begin` was called */
  struct vxm_values_writer
      *values; /**< where the format takes numbers: bits become bytes, and all else is its matter; or NULL */
};

/** Voxels of a checked space; below 2^60 and so a plain product. A byte each is what .npy and .nrrd take. */
static inline uint64_t vxm_space_voxels(const vxm_space *space) {
  return (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
}

/** How a format is written. */
typedef struct vxm_grid_writer_kind {
  vxm_layout layout;
  const vxm_sidecar_text *sidecar; /**< what the JSON beside the file says; NULL = there is none */
  /** Refuses what the format cannot hold; NULL = it holds all. */
  vxm_status (*check)(const vxm_space *space, const char *path, vxm_error *error);
  size_t (*state_bytes)(const vxm_space *space);
  /** Sets up `state` and writes the header. */
  vxm_status (*begin)(vxm_grid_writer *writer, vxm_error *error);
  vxm_status (*put)(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);
  /** Writes what is left after the last slice; NULL = nothing. */
  vxm_status (*end)(vxm_grid_writer *writer, vxm_error *error);
  /** Frees what `state` holds, whether or not the file was written; NULL = it holds nothing. */
  void (*drop)(vxm_grid_writer *writer);
  /** About what `state` holds beside itself; NULL = nothing. */
  uint64_t (*held_bytes)(const vxm_space *space);
  /** What the file will have at least, without its header; NULL = that is not known. */
  uint64_t (*file_bytes)(const vxm_space *space);
} vxm_grid_writer_kind;

/** For `put` and `end`, now and then: notices a failed write, and reports progress if that is wanted. */
vxm_status vxm_grid_writer_step(vxm_grid_writer *writer, double slices_done, vxm_error *error);
/** The same after some rows, counted through the slices of a window. */
static inline vxm_status vxm_grid_writer_step_rows(vxm_grid_writer *writer, const vxm_window *window,
                                                   size_t rows, vxm_error *error) {
  return vxm_grid_writer_step(writer, (double)window->begin + (double)rows / (double)window->middle_dim,
                              error);
}

/** What a file may hold. */
enum {
  VXM_HOLDS_BITS = VXM_FORMAT_BITS,
  VXM_HOLDS_NUMBERS = VXM_FORMAT_NUMBERS, /**< any field of one number per voxel that is not labels */
  VXM_HOLDS_LABELS = VXM_FORMAT_LABELS,
  VXM_HOLDS_COLORS = VXM_FORMAT_COLORS,
  VXM_HOLDS_ALL = VXM_HOLDS_BITS | VXM_HOLDS_NUMBERS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS
};

/** A row of the table: all that is known of a format. What is NULL it cannot do, unless more is said. */
typedef struct vxm_grid_format {
  const char *name; /**< also the extension */
  unsigned holds;   /**< what is written of it: VXM_HOLDS_... */
  /** Whether the content is this format; NULL = never told by content. */
  bool (*sniff)(const vxm_input *input);
  bool is_told_by_name; /**< `sniff` asks the name, since any content would do; it is asked first */
  /** Reads bits; VXM_ERROR_NUMBERS if there are numbers that the rule does not take for them. NULL = the
   * format is only written. */
  vxm_status (*read)(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
  /** Reads numbers, where `read` does not take them for bits; NULL = it holds only bits. */
  vxm_status (*read_field)(vxm_field **out, const vxm_input *input, vxm_error *error);
  /** Reads an octree, where it stores bits; VXM_ERROR_NUMBERS where not. NULL = by way of a grid. */
  vxm_status (*read_sparse)(vxm_sparse **out, const vxm_input *input, vxm_error *error);
  /** Writes bits slice by slice. NULL = they are written as a field of bytes, through `values` or
   * `write_field`. */
  const vxm_grid_writer_kind *writer;
  bool is_surface;  /**< of bits the surface is written, as a mesh of this name */
  bool is_mesh;     /**< what `write_field` writes is a mesh */
  bool is_sequence; /**< a path is a pattern of several names; nothing is opened under it */
  bool is_folder;   /**< a path is that of a folder, and may end in slashes */
  /** Writes an octree as it is; NULL = slice by slice. */
  vxm_status (*write_sparse)(const vxm_sparse *sparse, const char *path, vxm_error *error);
  /** Writes fields slice by slice, as they are made; NULL = only whole ones. */
  const struct vxm_values_writer_kind *values;
  /** Refuses a field that it cannot hold, of a kind that it holds, before anything is opened; NULL = it holds
   * all. */
  vxm_status (*check_field)(const vxm_field *field, const char *path, vxm_error *error);
  /** Writes a whole field, which has been checked; NULL = through `values`. */
  vxm_status (*write_field)(const vxm_field *field, const char *path, vxm_error *error);
} vxm_grid_format;

/** The format of a file of bits to be written; NULL with VXM_ERROR_ARGUMENT if there is none. */
const vxm_grid_format *vxm_grid_format_for(const char *path, const char *format, vxm_error *error);
/** The format of a file to be written that holds one of these kinds of values, as model's are made.
 * @param what begins the message, such as "labels go" */
const vxm_grid_format *vxm_grid_format_holding(const char *path, const char *format, unsigned holds,
                                               const char *what, vxm_error *error);
/** The format of this name, in any case, or NULL. */
const vxm_grid_format *vxm_grid_format_named(const char *name);
/** The format that a file's name tells, or NULL. A name may have two extensions. */
const vxm_grid_format *vxm_grid_format_of_path(const char *path);
/** The one of a file to be written: by a name, or, if that is NULL, by its path; or NULL. */
const vxm_grid_format *vxm_grid_format_chosen(const char *path, const char *format);

/** Room for a list of formats. */
typedef struct vxm_format_list {
  char text[300];
} vxm_format_list;

/** All formats that hold one of these, such as ".npy, .nrrd or .vdb"; `before` stands before each name. */
vxm_format_list vxm_grid_formats_holding(unsigned holds, const char *before);
/** Those that can be read. */
vxm_format_list vxm_grid_formats_read(void);

/** Whether bits are written slice by slice. */
static inline bool vxm_grid_format_streams(const vxm_grid_format *format) {
  return !format->is_surface && (format->writer || format->values);
}

/** What a field needs of a format. */
static inline unsigned vxm_field_needs(const vxm_field *field) {
  return field->channels == 4                    ? VXM_HOLDS_COLORS
         : field->about.kind == VXM_FIELD_LABELS ? VXM_HOLDS_LABELS
                                                 : VXM_HOLDS_NUMBERS;
}

/** The colour of a voxel, or NULL outside the grid. */
static inline const uint8_t *vxm_field_color(const vxm_field *field, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = field->space.dims;
  if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2])
    return NULL;
  return field->values + 4 * (size_t)((i * dims[1] + j) * dims[2] + k);
}

/** Writes a field into one file by a function that needs it whole; there is nothing beside the file. */
vxm_status vxm_field_write_file(const vxm_field *field, const char *path,
                                vxm_status (*write)(vxm_output *output, const vxm_field *field,
                                                    vxm_error *error),
                                vxm_error *error);

/** Refuses a field: "the field (distance, float32) WHY". */
vxm_status vxm_field_refuse(const vxm_field *field, const char *path, vxm_status status, const char *why,
                            vxm_error *error);

/** Refuses numbers that are no labels from 0 to `max`; colours are right. VXM_ERROR_RANGE */
vxm_status vxm_field_check_labels(const vxm_field *field, const char *path, int max, const char *why,
                                  vxm_error *error);

/** One per file format. */
extern const vxm_grid_format vxm_format_binvox, vxm_format_bt, vxm_format_glb, vxm_format_h5,
    vxm_format_litematic, vxm_format_nii, vxm_format_nii_gz, vxm_format_npy, vxm_format_nrrd,
    vxm_format_octree, vxm_format_ply, vxm_format_png, vxm_format_raw, vxm_format_rle, vxm_format_schem,
    vxm_format_tif, vxm_format_tif_slices, vxm_format_vdb, vxm_format_vox, vxm_format_vti, vxm_format_vtk,
    vxm_format_zarr;

/** VXM_ERROR_FORMAT at a byte of the input. */
#define vxm_fail_byte(error, input, offset, ...) \
  vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){(input)->name, 0, (int64_t)(offset), -1}, __VA_ARGS__)

/**
 * Checks the space that a file claims: VXM_ERROR_FORMAT with the offset for what can never be,
 * VXM_ERROR_RANGE for what is too large.
 */
vxm_status vxm_space_check_file(const vxm_space *space, const vxm_input *input, size_t offset,
                                vxm_error *error);

#endif
