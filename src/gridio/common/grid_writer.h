/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A grid file that is written slice by slice, in the format's own layout, without the whole grid. All grid
 * formats are written so (.vdb keeps what is set in a tree until the end); the surface as a mesh needs the
 * whole grid.
 */
#ifndef VXM_GRIDIO_COMMON_GRID_WRITER_H
#define VXM_GRIDIO_COMMON_GRID_WRITER_H

#include "grid/window.h"

typedef struct vxm_grid_writer vxm_grid_writer;

/** How a file would be written. */
typedef struct vxm_grid_writer_plan {
  bool streams;      /**< false for the surface as a mesh; the rest is then 0 */
  vxm_layout layout; /**< of the windows to be put */
  uint64_t
      bytes; /**< the most that the writer itself holds; of .vdb, whose tree follows the surface, about */
  uint64_t gather_bytes; /**< what vxm_gridio_write of a whole grid holds besides */
} vxm_grid_writer_plan;

/**
 * Tells how a file would be written. Nothing is opened.
 *
 * @param path, format as for vxm_gridio_write
 * @return VXM_OK; VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE for what vxm_gridio_write would refuse of the format,
 *         the path "-" or the space
 */
vxm_status vxm_grid_writer_plan_of(vxm_grid_writer_plan *out, const vxm_space *space, const char *path,
                                   const char *format, vxm_error *error);

/**
 * Begins a file, which appears under its name in vxm_grid_writer_commit.
 *
 * @param space checked
 * @return VXM_OK; as vxm_grid_writer_plan_of, and VXM_ERROR_ARGUMENT for a mesh; VXM_ERROR_IO,
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_grid_writer_open(vxm_grid_writer **out, vxm_context *context, const vxm_space *space,
                                const char *path, const char *format, vxm_error *error);

vxm_layout vxm_grid_writer_layout(const vxm_grid_writer *writer);

/** From now on puts report the progress of the file, as "writing". Otherwise their caller reports. */
void vxm_grid_writer_report(vxm_grid_writer *writer);

/**
 * Writes the next slices; the first window begins at slice 0. It uses the context's threads.
 *
 * @param window in the file's layout, of any number of slices
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the window is not next; VXM_ERROR_IO as soon as a write failed;
 *         VXM_ERROR_CANCELLED. After a failure only vxm_grid_writer_abort is allowed.
 */
vxm_status vxm_grid_writer_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);

/**
 * Completes the file after the last slice, and frees the slices either way; after a failure no file is left.
 * Padding behind the last slice (.binvox of a grid that is longer along y or z than along x) is written here,
 * under the phase "writing".
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if slices are missing; VXM_ERROR_IO, VXM_ERROR_CANCELLED
 */
vxm_status vxm_grid_writer_commit(vxm_grid_writer *writer, vxm_error *error);

/** Drops the file: none is left. NULL is allowed. */
void vxm_grid_writer_abort(vxm_grid_writer *writer);

#endif
