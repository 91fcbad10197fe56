/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A file of a value per voxel that is written slice by slice, in the format's own order, without the whole
 * field. Fields that are there already are written in the same way.
 */
#ifndef VXM_GRIDIO_COMMON_VALUES_WRITER_H
#define VXM_GRIDIO_COMMON_VALUES_WRITER_H

#include "grid/value_tile.h"
#include "gridio/common/format.h"

/** What is written. */
typedef struct vxm_values_spec {
  vxm_scalar scalar;      /**< of the values that are put */
  int channels;           /**< 4 of colours, else 1 */
  const vxm_about *about; /**< what is said of them, until the file is complete */
  bool is_bits;           /**< 0 and 1 in bytes, for set and clear */
  bool is_signed;         /**< distances have a sign */
  bool in_tiles;          /**< they come by put_tile, where the kind has it */
  float background;       /**< the distance beyond the band */
} vxm_values_spec;

typedef struct vxm_values_writer {
  vxm_context *context;
  const struct vxm_values_writer_kind *kind;
  const char *path; /**< the caller's */
  vxm_space space;
  vxm_values_spec values;
  vxm_output *output;  /**< NULL after its failure has been reported, or where the kind has its own files */
  vxm_output *sidecar; /**< NULL if there is none */
  struct vxm_file_transaction_file *kept; /**< complete files of the kind's own, named with the sidecar */
  size_t slice_bytes;
  int64_t next; /**< slice */
  void *state;  /**< the kind's own, NULL at first */
} vxm_values_writer;

/** How a format is written. */
typedef struct vxm_values_writer_kind {
  vxm_layout layout;
  unsigned holds; /**< what can be written so: VXM_HOLDS_... */
  /** What the JSON beside the file says, of colours the second if it is not NULL. There is one always, or
   * else with a table of labels; NULL = never. */
  const vxm_sidecar_text *sidecar, *color_sidecar;
  bool has_sidecar;
  bool has_own_files; /**< `begin` opens what it needs; there is no output */
  /** The type of the values that are put, of fields of this one; NULL = the same. */
  vxm_scalar (*stored)(vxm_scalar scalar);
  /** Makes stored values of others; called where the types differ, with a slice for a field. */
  void (*convert)(void *out, const vxm_field *slice, size_t count);
  /** Refuses what it cannot hold, before anything is opened; NULL = it holds all. */
  vxm_status (*check)(const vxm_space *space, const vxm_values_spec *values, const char *path,
                      vxm_error *error);
  /** What the file will have at least, without its header; NULL = that is not known. */
  uint64_t (*file_bytes)(const vxm_space *space, const vxm_values_spec *values);
  /** What is held beside the slices, about; NULL = nothing. */
  uint64_t (*held_bytes)(const vxm_space *space, const vxm_values_spec *values);
  vxm_status (*begin)(vxm_values_writer *writer, vxm_error *error);
  /** Slices begin to end - 1, in the machine's byte order; NULL = they are written as they are, the lowest
   * byte first. A failed write may be left to the output. */
  vxm_status (*put)(vxm_values_writer *writer, const void *values, int64_t begin, int64_t end,
                    vxm_error *error);
  /** Tiles that begin at multiples of 8 voxels, in the order of slices, from several threads at once; what
   * never comes is the background. In place of `put`; NULL = slices only. */
  vxm_status (*put_tile)(vxm_values_writer *writer, const vxm_value_tile *tile, vxm_error *error);
  /** Values in their order, any number of them, each with its lowest byte first on machines of either byte
   * order; NULL, without `put`, = they are written so. */
  void (*put_bytes)(vxm_values_writer *writer, const void *bytes, size_t size);
  /** What is left after the last slice; NULL = nothing. With files of its own it gives them their names. */
  vxm_status (*end)(vxm_values_writer *writer, vxm_error *error);
  /** Frees what `state` holds, whether or not the file was written; NULL = it holds nothing. */
  void (*drop)(vxm_values_writer *writer);
} vxm_values_writer_kind;

/** The bytes of all values: vxm_values_writer_kind.file_bytes of formats that do not compress. */
uint64_t vxm_values_plain_bytes(const vxm_space *space, const vxm_values_spec *values);

/** For formats without 16-bit floats, which become those of 32: vxm_values_writer_kind.stored and convert. */
vxm_scalar vxm_values_no_halves(vxm_scalar scalar);
void vxm_values_widen_halves(void *out, const vxm_field *slice, size_t count);

/** What a writer holds, without the slices that are put. */
uint64_t vxm_values_writer_bytes(const vxm_values_writer_kind *kind, const vxm_space *space,
                                 const vxm_values_spec *values);

/** Begins a file; see vxm_grid_writer_open. `values` may be checked before, with the kind's `check`. */
vxm_status vxm_values_writer_open(vxm_values_writer *out, const vxm_values_writer_kind *kind,
                                  vxm_context *context, const vxm_space *space, const vxm_values_spec *values,
                                  const char *path, vxm_error *error);
/** Takes the next slices. @return VXM_OK; VXM_ERROR_IO as soon as a write failed, and what the kind returns.
 * After a failure only vxm_values_writer_abort is allowed. */
vxm_status vxm_values_writer_put(vxm_values_writer *writer, const void *values, int64_t begin, int64_t end,
                                 vxm_error *error);
/** Hands values to `put_bytes`, or to the output, with the lowest byte of each first. */
void vxm_values_writer_pass(vxm_values_writer *writer, const void *values, size_t size);
/** Takes the next bytes of values, which may be parts of slices, where the kind has no `put`. */
vxm_status vxm_values_writer_put_bytes(vxm_values_writer *writer, const void *bytes, size_t size,
                                       vxm_error *error);
/** Completes the file; after a failure none is left. It ends the writer either way. */
vxm_status vxm_values_writer_commit(vxm_values_writer *writer, vxm_error *error);
/** Drops the file. A writer of zeros is allowed. */
void vxm_values_writer_abort(vxm_values_writer *writer);

/** Writes a whole field slice by slice, and reports progress as "writing". */
vxm_status vxm_values_write_field(const vxm_values_writer_kind *kind, const vxm_field *field,
                                  const char *path, vxm_error *error);

#endif
