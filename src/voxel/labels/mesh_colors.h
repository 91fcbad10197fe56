/* SPDX-License-Identifier: BSD-3-Clause */
/** Colours of voxels from the mesh that they were made of: its vertices, faces, materials and textures. */
#ifndef VXM_VOXEL_LABELS_MESH_COLORS_H
#define VXM_VOXEL_LABELS_MESH_COLORS_H

#include "grid/node_values.h"
#include "mesh/soup.h"

/** Refuses a mesh without colours, and says what it lacks. @return VXM_OK, VXM_ERROR_ARGUMENT */
vxm_status vxm_mesh_colors_check(const vxm_soup *mesh, vxm_error *error);

/**
 * Gives each set voxel the colour of the nearest point of the mesh, or the mean over the surface within it
 * where there is any.
 *
 * @param values [x][y][z][4] in C order; red, green, blue in sRGB and 255, or zeros
 * @param mesh   as it was read; has passed vxm_mesh_colors_check
 * @return VXM_OK; VXM_ERROR_EMPTY; VXM_ERROR_RANGE; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_mesh_colors(uint8_t *values, const vxm_grid *grid, const vxm_soup *mesh, bool average,
                           vxm_error *error);

/** A mesh that gives colours. */
typedef struct vxm_mesh_painter vxm_mesh_painter;

/** @param mesh kept; has passed vxm_mesh_colors_check. @return as vxm_mesh_colors */
vxm_status vxm_mesh_painter_create(vxm_mesh_painter **out, vxm_context *context, const vxm_soup *mesh,
                                   vxm_error *error);
/** NULL is allowed. */
void vxm_mesh_painter_destroy(vxm_mesh_painter *painter);
/**
 * Gives voxels of a node the colours of the nearest points of the mesh.
 *
 * @param values x fastest, 16 to a row; zeros at first
 * @param at     its first voxel
 * @param rows   its set voxels, as vxm_node_bits has them
 * @param near   what was near before, to begin with; 0 is allowed
 */
void vxm_mesh_painter_node(const vxm_mesh_painter *painter, uint8_t *values, const vxm_space *space,
                           const int64_t at[3], const uint64_t *rows, uint32_t *near);

/** Bytes that it takes beside the values, about. */
uint64_t vxm_mesh_colors_bytes(const vxm_soup *mesh, const vxm_space *space, bool average);

#endif
