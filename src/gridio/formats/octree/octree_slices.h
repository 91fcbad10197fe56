/* SPDX-License-Identifier: BSD-3-Clause */
/** Slices that become an octree before they are written: what writers of trees share (vxm_grid_writer_kind,
 * in VXM_LAYOUT_GRID). */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_SLICES_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_SLICES_H

#include "grid/octree.h"
#include "gridio/common/format.h"

size_t vxm_octree_slices_state_bytes(const vxm_space *space);
uint64_t vxm_octree_slices_held_bytes(const vxm_space *space);
vxm_status vxm_octree_slices_begin(vxm_grid_writer *writer, vxm_error *error);
vxm_status vxm_octree_slices_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);
/** Makes the octree of all slices; *out is NULL after a failure. @return as vxm_octree_builder_end */
vxm_status vxm_octree_slices_end(vxm_sparse **out, vxm_grid_writer *writer, vxm_error *error);
void vxm_octree_slices_drop(vxm_grid_writer *writer);

#endif
