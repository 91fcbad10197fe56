/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of grid formats, and what its readers and writers share. */
#ifndef VXM_GRIDIO_COMMON_FORMAT_H
#define VXM_GRIDIO_COMMON_FORMAT_H

#include "base/output.h"
#include "gridio/common/grid_writer.h"
#include "gridio/common/scalar_type.h"
#include "gridio/common/sidecar.h"

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
  /** Writes what is left after the last slice. */
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

typedef struct vxm_grid_format {
  const char *name; /**< also the extension */
  /** Whether the content is this format; NULL = never told by content. */
  bool (*sniff)(const vxm_input *input);
  /** Reads bits; VXM_ERROR_NUMBERS if there are numbers that the rule does not take for them. NULL = the
   * format is only written. */
  vxm_status (*read)(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
  /** Reads numbers, where `read` does not take them for bits; NULL = it holds only bits. */
  vxm_status (*read_field)(vxm_field **out, const vxm_input *input, vxm_error *error);
  /** NULL = the surface is written as a mesh of this name. */
  const vxm_grid_writer_kind *writer;
  /** Writes an octree as it is; NULL = slice by slice. */
  vxm_status (*write_sparse)(const vxm_sparse *sparse, const char *path, vxm_error *error);
} vxm_grid_format;

/** The format of a file to be written; NULL with VXM_ERROR_ARGUMENT if there is none. */
const vxm_grid_format *vxm_grid_format_for(const char *path, const char *format, vxm_error *error);

/** One per file of this room. */
extern const vxm_grid_format vxm_format_binvox, vxm_format_npy, vxm_format_nrrd, vxm_format_raw,
    vxm_format_rle, vxm_format_vdb;

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
