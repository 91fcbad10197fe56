/* SPDX-License-Identifier: BSD-3-Clause */
/** The shell of a solid: its voxels that are adjacent to an empty one (Ogayar et al., sec. III-A). */
#ifndef VXM_GRID_SHELL_H
#define VXM_GRID_SHELL_H

#include "grid/window.h"

/** Which voxels are adjacent, by their number: those that share a face, an edge too, or a corner too. */
typedef enum vxm_adjacency { VXM_ADJACENT_6 = 6, VXM_ADJACENT_18 = 18, VXM_ADJACENT_26 = 26 } vxm_adjacency;

/**
 * Replaces the words of a window by the shell of the solid there. Outside of the space all is empty.
 *
 * @param out   with words of its own
 * @param solid of the same space and layout; has the slices of `out`, and the one before and the one behind
 * them where the space has such
 */
void vxm_shell_fill(const vxm_window *out, const vxm_window *solid, vxm_adjacency adjacency,
                    vxm_context *context);

#endif
