/* SPDX-License-Identifier: BSD-3-Clause */
/** The surface of a mesh in voxels, exactly, window by window. */
#ifndef VXM_VOXEL_SURFACE_SURFACE_H
#define VXM_VOXEL_SURFACE_SURFACE_H

#include "grid/window.h"
#include "mesh/soup.h"
#include "voxel/parity/snapped_points.h"

/** The triangles of a soup on a lattice. */
typedef struct vxm_surface {
  vxm_context *context;    /**< one reference held */
  uint64_t serial;         /**< no two that hold different points have the same */
  uint64_t corners_serial; /**< no two that hold different corners have the same */
  const vxm_soup *soup;
  vxm_lattice lattice;
  int32_t (*narrow)[4];    /**< a point for each vertex of the soup; the fourth number is 0 */
  vxm_point *wide;         /**< instead, where a point lies beyond VXM_NARROW_MAX */
  const uint32_t *corners; /**< triangle_count x 3: the soup's own, or `cut` */
  uint32_t *cut;           /**< NULL where all faces are triangles */
  size_t triangle_count;
} vxm_surface;

/**
 * Snaps a soup to the lattice and cuts its polygons into triangles inside them. The soup must outlive the
 * surface.
 *
 * @param transform NULL, or 3 rows of 4: position p counts as (row . (p, 1)) for each row
 * @return VXM_OK; VXM_ERROR_RANGE if a vertex that a face uses is not finite or lies too far outside the
 * grid; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_surface_create(vxm_surface **out, const vxm_soup *soup, const vxm_lattice *lattice,
                              const double transform[12], vxm_error *error);
/** The first half of that, in a context that may be another than the soup's: cuts the polygons. Place the
 * surface before it is used. */
vxm_status vxm_surface_make(vxm_surface **out, vxm_context *context, const vxm_soup *soup, vxm_error *error);
/** Puts the same soup on another lattice, or elsewhere on it; the surface cannot be used if that fails.
 * Returns as vxm_surface_create. */
vxm_status vxm_surface_place(vxm_surface *surface, const vxm_lattice *lattice, const double transform[12],
                             vxm_error *error);
/** The same where the vertices have moved to `positions`; the polygons stay cut as they are. */
vxm_status vxm_surface_place_moved(vxm_surface *surface, const double (*positions)[3],
                                   const vxm_lattice *lattice, vxm_error *error);
static inline vxm_point vxm_surface_at(const vxm_surface *surface, uint32_t vertex) {
  if (surface->wide)
    return surface->wide[vertex];
  const int32_t *p = surface->narrow[vertex];
  return (vxm_point){{p[0], p[1], p[2]}};
}

/** NULL is allowed. */
void vxm_surface_destroy(vxm_surface *surface);

/**
 * Sets the voxels of the surface that lie in a window of the lattice's space; the others keep their values.
 * How the space is cut into windows makes no difference, nor does the number of threads.
 *
 * @param kind     conservative or thin
 * @param is_fresh the words have no values yet: they are cleared along the way, while they are in cache
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_surface_add(const vxm_surface *surface, const vxm_window *window, vxm_surface_kind kind,
                           bool is_fresh, vxm_error *error);

/**
 * As vxm_surface_add, onto a whole grid.
 *
 * @param whole      all of a space, in the layout of a grid
 * @param confidence a byte per voxel, x fastest: 255 where the surface sets a voxel
 */
vxm_status vxm_surface_add_sure(const vxm_surface *surface, const vxm_window *whole, vxm_surface_kind kind,
                                uint8_t *confidence, vxm_error *error);

/** What a surface of so many triangles holds once it is made. */
uint64_t vxm_surface_held_bytes(const vxm_soup *soup, size_t *triangles);
/** What a surface takes at most, and what adding it takes meanwhile. */
uint64_t vxm_surface_bytes(const vxm_soup *soup, int threads);

#endif
