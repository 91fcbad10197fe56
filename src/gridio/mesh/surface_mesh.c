/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The surface of a grid as a mesh. A rectangle becomes a polygon with a corner at every lattice point of its
 * border where any rectangle has a corner. So a piece of border between two such points belongs, whole, to
 * every rectangle that it bounds. Around a unit edge of the lattice 0, 2 or 4 voxel faces are exposed, and
 * the edge lies on the border of a rectangle for each of them, except where two faces are in the same
 * rectangle: an even number is left, on every edge of the mesh.
 */
#include "gridio/mesh/surface_mesh.h"
#include "gridio/mesh/quad_vertices.h"

/** The point on the lattice in model units; the same expression for every vertex, so equal points are equal.
 */
static double place(const vxm_space *space, uint64_t point, int axis) {
  return space->origin[axis] + (double)vxm_quad_point_coordinate(point, axis) * space->voxel_size[axis];
}

/** Vertices strictly between `from` and `to`, which lies in the positive direction of `axis`. */
static size_t walk(const vxm_quad_vertices *c, uint32_t from, uint32_t to, int axis, uint32_t *out) {
  size_t count = 0;
  for (uint32_t v = c->next[axis][from]; v != to; v = c->next[axis][v]) {
    if (out)
      out[count] = v;
    count++;
  }
  return count;
}

static void reverse(uint32_t *items, size_t count) {
  for (size_t i = 0; i < count / 2; i++) {
    uint32_t other = items[count - 1 - i];
    items[count - 1 - i] = items[i];
    items[i] = other;
  }
}

typedef struct axes {
  int u, v;
} axes;

static axes axes_of(int axis) {
  return (axes){axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

static size_t count_polygon(const vxm_quad_vertices *c, const uint32_t corner[4], axes a) {
  return 4 + walk(c, corner[0], corner[1], a.u, NULL) + walk(c, corner[1], corner[2], a.v, NULL) +
         walk(c, corner[3], corner[2], a.u, NULL) + walk(c, corner[0], corner[3], a.v, NULL);
}

/** Around the rectangle as u turns to v, then the other way round if the face looks the other way. */
static size_t fill_polygon(const vxm_quad_vertices *c, const uint32_t corner[4], axes a, bool backward,
                           uint32_t *out) {
  size_t n = 0, begin;
  out[n++] = corner[0];
  n += walk(c, corner[0], corner[1], a.u, out + n);
  out[n++] = corner[1];
  n += walk(c, corner[1], corner[2], a.v, out + n);
  out[n++] = corner[2];
  begin = n;
  n += walk(c, corner[3], corner[2], a.u, out + n);
  reverse(out + begin, n - begin);
  out[n++] = corner[3];
  begin = n;
  n += walk(c, corner[0], corner[3], a.v, out + n);
  reverse(out + begin, n - begin);
  if (backward)
    reverse(out, n);
  return n;
}

static void fill_vertices(vxm_soup *soup, const vxm_quad_vertices *c, const vxm_space *space) {
  for (size_t v = 0; v < c->vertex_count; v++)
    for (int a = 0; a < 3; a++)
      soup->positions[3 * v + (size_t)a] = place(space, c->points[v], a);
  soup->vertex_count = c->vertex_count;
}

static size_t count_all(const vxm_quad_vertices *c, const vxm_greedy_quads *rectangles) {
  const uint32_t *corner = c->vertex;
  size_t corners = 0;
  for (size_t l = 0; l < rectangles->list_count; l++)
    for (size_t r = 0; r < rectangles->lists[l].count; r++, corner += 4)
      corners += count_polygon(c, corner, axes_of(rectangles->lists[l].axis));
  return corners;
}

static void fill_faces(vxm_soup *soup, const vxm_quad_vertices *c, const vxm_greedy_quads *rectangles) {
  const uint32_t *corner = c->vertex;
  for (size_t l = 0; l < rectangles->list_count; l++) {
    const vxm_greedy_quad_list *list = &rectangles->lists[l];
    for (size_t r = 0; r < list->count; r++, corner += 4) {
      /* x cross z is -y, the other two products point forward. */
      bool positive = list->items[r].level % 2 == 1, backward = positive == (list->axis == 1);
      soup->corner_count +=
          fill_polygon(c, corner, axes_of(list->axis), backward, soup->indices + soup->corner_count);
      soup->offsets[++soup->face_count] = soup->corner_count;
    }
  }
}

static vxm_status build(vxm_soup *soup, const vxm_grid *grid, vxm_error *error) {
  vxm_greedy_quads rectangles;
  vxm_quad_vertices corners;
  vxm_status status = vxm_greedy_quads_find(&rectangles, grid, error);
  if (status != VXM_OK)
    return status;
  status = vxm_quad_vertices_find(&corners, &rectangles, grid->space.dims, error);
  if (status == VXM_OK) {
    status = vxm_soup_reserve(soup, corners.vertex_count, rectangles.count, count_all(&corners, &rectangles),
                              error);
    if (status == VXM_OK) {
      fill_vertices(soup, &corners, &grid->space);
      fill_faces(soup, &corners, &rectangles);
    }
    vxm_quad_vertices_destroy(&corners);
  }
  vxm_greedy_quads_destroy(&rectangles);
  return status;
}

vxm_status vxm_gridio_surface_mesh(vxm_soup **out, const vxm_grid *grid, vxm_error *error) {
  *out = NULL;
  vxm_soup *soup;
  vxm_status status = vxm_soup_create(&soup, grid->context, "grid", error);
  if (status != VXM_OK)
    return status;
  status = build(soup, grid, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(soup);
    return status;
  }
  *out = soup;
  return VXM_OK;
}
