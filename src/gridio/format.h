/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of grid formats, and what its readers and writers share. */
#ifndef VXM_GRIDIO_FORMAT_H
#define VXM_GRIDIO_FORMAT_H

#include "base/file.h"
#include "grid/bitgrid.h"

typedef struct vxm_grid_format {
  const char *name; /**< also the extension */
  /** Whether the content is this format; NULL = never told by content. */
  bool (*sniff)(const vxm_input *input);
  /** NULL = the format is only written. */
  vxm_status (*read)(vxm_grid **out, const vxm_input *input, vxm_error *error);
  vxm_status (*write)(const vxm_grid *grid, const char *path, vxm_error *error);
} vxm_grid_format;

/** One per file of this room. */
extern const vxm_grid_format vxm_format_binvox, vxm_format_npy, vxm_format_raw, vxm_format_rle;

/** VXM_ERROR_FORMAT at a byte of the input. */
#define vxm_fail_byte(error, input, offset, ...) \
  vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){(input)->name, 0, (int64_t)(offset), -1}, __VA_ARGS__)

/**
 * Checks the space that a file claims: VXM_ERROR_FORMAT with the offset for what can never be,
 * VXM_ERROR_RANGE for what is too large.
 */
vxm_status vxm_space_check_file(const vxm_space *space, const vxm_input *input, size_t offset,
                                vxm_error *error);

/** Voxels of a checked space; below 2^60 and so a plain product. */
static inline uint64_t vxm_space_voxels(const vxm_space *space) {
  return (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
}

#endif
