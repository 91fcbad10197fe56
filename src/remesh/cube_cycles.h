/* SPDX-License-Identifier: BSD-3-Clause */
/** How a surface passes through a cell between eight voxel centres. */
#ifndef VXM_REMESH_CUBE_CYCLES_H
#define VXM_REMESH_CUBE_CYCLES_H

#include <stdbool.h>
#include <stdint.h>

enum { VXM_CUBE_LINKS = 12, VXM_CUBE_CONFIGURATIONS = 256, VXM_NO_CYCLE = 0xff };

/**
 * Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2). Link 4 a + b + 2 c runs along axis a from the corner
 * with coordinates b and c along the next two axes. The surface crosses the links from a set corner to one
 * that is not; in each face of the cell it joins two of these. Where a face has four, those around each set
 * corner are joined, so that voxels which touch along an edge alone stay apart. The links then form cycles,
 * and each is one sheet of the surface (Nielson, Dual Marching Cubes, 2004).
 */
typedef struct vxm_cube_cycles {
  uint8_t count;                 /**< of cycles, at most 4 */
  uint8_t cycle[VXM_CUBE_LINKS]; /**< per link: its cycle, or VXM_NO_CYCLE */
  bool meets_itself; /**< a cycle passes a face twice: it may have an edge in common with itself */
} vxm_cube_cycles;

/** Those of all configurations: bit c is set where corner c is. */
void vxm_cube_cycles_find(vxm_cube_cycles out[VXM_CUBE_CONFIGURATIONS]);

/** The corner that a link begins at. */
static inline int vxm_cube_link_begin(int link) {
  int axis = link / 4, b = (axis + 1) % 3, c = (axis + 2) % 3;
  return (link & 1) << b | (link >> 1 & 1) << c;
}

#endif
