/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY with faces, and rods for edges and vertices, in colour, to show what is wrong where. */
#ifndef VXM_MESHIO_FORMATS_WRITE_MARKED_H
#define VXM_MESHIO_FORMATS_WRITE_MARKED_H

#include "mesh/soup.h"

typedef struct vxm_colour {
  uint8_t red, green, blue;
} vxm_colour;

typedef struct vxm_marked_edge {
  uint32_t a, b; /**< vertices; the same one twice marks a vertex */
  vxm_colour colour;
} vxm_marked_edge;

/** What is shown in colour on a mesh. */
typedef struct vxm_marks {
  vxm_colour grey;   /**< of what is not marked */
  vxm_colour *faces; /**< face_count */
  vxm_marked_edge *edges;
  size_t edge_count;
} vxm_marks;

/** Writes a .ply of triangles in colour: those of the faces, then eight and six vertices for each edge, in
 * their order, but for those at places that are not finite. @return VXM_OK, VXM_ERROR_ARGUMENT for another
 * extension, VXM_ERROR_RANGE where numbers of vertices do not suffice, VXM_ERROR_MEMORY,
 * VXM_ERROR_IO */
vxm_status vxm_meshio_write_marked(const vxm_soup *soup, const vxm_marks *marks, const char *path,
                                   vxm_error *error);

#endif
