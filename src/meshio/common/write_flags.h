/* SPDX-License-Identifier: BSD-3-Clause */
/** In which form a mesh is written. */
#ifndef VXM_MESHIO_COMMON_WRITE_FLAGS_H
#define VXM_MESHIO_COMMON_WRITE_FLAGS_H

#include "mesh/soup.h"

/** How a mesh is written; together or 0. */
enum vxm_write_flags {
  VXM_WRITE_ASCII = 1,   /**< as text, where the format has two forms */
  VXM_WRITE_POLYGONS = 2 /**< faces as they are, rather than as triangles; .stl has triangles in any case */
};

/** What options of the public header say of it. */
static inline unsigned vxm_write_flags_of(const vxm_mesh_write_options *options) {
  return (options->ascii ? VXM_WRITE_ASCII : 0u) | (options->keep_polygons ? VXM_WRITE_POLYGONS : 0u);
}

#endif
