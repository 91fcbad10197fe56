/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The surface of a grid as a mesh. A rectangle becomes a polygon with a corner at every lattice point of its
 * border where any rectangle has a corner. So a piece of border between two such points belongs, whole, to
 * every rectangle that it bounds. Around a unit edge of the lattice 0, 2 or 4 voxel faces are exposed, and
 * the edge lies on the border of a rectangle for each of them, except where two faces are in the same
 * rectangle: an even number is left, on every edge of the mesh.
 *
 * Where voxels touch in an edge or a corner alone, either side has vertices of its own, which are moved a
 * little. So polygons are split into triangles on the lattice, where no triangle lies on a border.
 */
#include "gridio/mesh/surface_mesh.h"
#include "gridio/mesh/split_vertices.h"
#include "mesh/triangulate.h"

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

/** What the faces of rectangles are made with. */
typedef struct builder {
  vxm_soup *soup;
  const vxm_quad_vertices *lattice;
  const vxm_split_vertices *split; /**< NULL = the vertices are those of the lattice */
  bool triangles;
  vxm_triangulator tri;
  uint32_t *ring;     /**< vertices of the lattice */
  uint32_t *vertices; /**< those of the mesh, with what lies between */
  uint32_t *numbers;  /**< 0, 1, 2 ... */
  double *places;     /**< of the vertices, on the lattice */
  size_t capacity;
} builder;

static vxm_status reserve(builder *b, size_t n, vxm_error *error) {
  if (n <= b->capacity)
    return VXM_OK;
  const struct {
    void **block;
    size_t size;
  } blocks[] = {{(void **)&b->ring, sizeof *b->ring},
                {(void **)&b->vertices, sizeof *b->vertices},
                {(void **)&b->numbers, sizeof *b->numbers},
                {(void **)&b->places, 3 * sizeof *b->places}};
  size_t capacity = 0;
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
    capacity = b->capacity;
    vxm_status status = vxm_grow(b->soup->context, blocks[i].block, &capacity, n, blocks[i].size, error);
    if (status != VXM_OK)
      return status;
  }
  for (size_t i = b->capacity; i < capacity; i++)
    b->numbers[i] = (uint32_t)i;
  b->capacity = capacity;
  return VXM_OK;
}

static void builder_close(builder *b) {
  vxm_context *context = b->soup->context;
  vxm_triangulator_close(&b->tri);
  vxm_free(context, b->ring);
  vxm_free(context, b->vertices);
  vxm_free(context, b->numbers);
  vxm_free(context, b->places);
}

/** The face of a rectangle about a point on its border, as vxm_lattice_face numbers it there. */
static unsigned face_about(const vxm_greedy_quad *quad, int axis, uint64_t point) {
  axes a = axes_of(axis);
  return vxm_lattice_face(axis, vxm_quad_point_coordinate(point, a.u) < quad->u1,
                          vxm_quad_point_coordinate(point, a.v) < quad->v1);
}

static void put_place(const builder *b, size_t at, uint64_t p, uint64_t q) {
  for (int a = 0; a < 3; a++)
    b->places[3 * at + (size_t)a] =
        ((double)vxm_quad_point_coordinate(p, a) + (double)vxm_quad_point_coordinate(q, a)) / 2;
}

/** The vertices of the mesh for those of a ring, and in the middles of edges. Returns their number. */
static size_t split_ring(const builder *b, const vxm_greedy_quad *quad, int axis, size_t count) {
  const uint64_t *points = b->lattice->points;
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t at = b->ring[i], next = b->ring[i + 1 < count ? i + 1 : 0], low = at < next ? at : next;
    put_place(b, n, points[at], points[at]);
    b->vertices[n++] = b->split ? vxm_split_vertex(b->split, at, face_about(quad, axis, points[at])) : at;
    if (!b->split || b->split->middles == 0)
      continue;
    int along = 0;
    while (vxm_quad_point_coordinate(points[at], along) == vxm_quad_point_coordinate(points[next], along))
      along++;
    uint32_t middle = vxm_split_middle(b->split, low, along, face_about(quad, axis, points[low]));
    if (middle == VXM_NO_CORNER)
      continue;
    put_place(b, n, points[at], points[next]);
    b->vertices[n++] = middle;
  }
  return n;
}

static void put_face(vxm_soup *soup, const uint32_t *vertices, const uint32_t *corner, size_t count) {
  for (size_t i = 0; i < count; i++)
    soup->indices[soup->corner_count++] = corner ? vertices[corner[i]] : vertices[i];
  soup->offsets[++soup->face_count] = soup->corner_count;
}

static vxm_status add_rectangle(builder *b, const vxm_greedy_quad *quad, int axis, const uint32_t corner[4],
                                vxm_error *error) {
  /* x cross z is -y, the other two products point forward. */
  bool positive = quad->level % 2 == 1, backward = positive == (axis == 1);
  size_t count = count_polygon(b->lattice, corner, axes_of(axis));
  vxm_status status = reserve(b, 2 * count, error);
  if (status != VXM_OK)
    return status;
  fill_polygon(b->lattice, corner, axes_of(axis), backward, b->ring);
  count = split_ring(b, quad, axis, count);
  if (!b->triangles) {
    put_face(b->soup, b->vertices, NULL, count);
    return VXM_OK;
  }
  const uint32_t *triangles;
  status = vxm_triangulate(&b->tri, b->places, b->numbers, count, &triangles, error);
  for (size_t t = 0; t + 2 < count && status == VXM_OK; t++)
    put_face(b->soup, b->vertices, triangles + 3 * t, 3);
  return status;
}

static size_t count_all(const vxm_quad_vertices *c, const vxm_greedy_quads *quads) {
  const uint32_t *corner = c->vertex;
  size_t corners = 0;
  for (size_t l = 0; l < quads->list_count; l++)
    for (size_t r = 0; r < quads->lists[l].count; r++, corner += 4)
      corners += count_polygon(c, corner, axes_of(quads->lists[l].axis));
  return corners;
}

static vxm_status add_all(builder *b, const vxm_greedy_quads *quads, vxm_error *error) {
  const uint32_t *corner = b->lattice->vertex;
  vxm_status status = VXM_OK;
  for (size_t l = 0; l < quads->list_count && status == VXM_OK; l++) {
    const vxm_greedy_quad_list *list = &quads->lists[l];
    status = vxm_check_cancelled(b->soup->context, error);
    for (size_t r = 0; r < list->count && status == VXM_OK; r++, corner += 4)
      status = add_rectangle(b, &list->items[r], list->axis, corner, error);
  }
  return status;
}

static void place_vertices(vxm_soup *soup, const vxm_quad_vertices *c, const vxm_space *space) {
  for (size_t v = 0; v < c->vertex_count; v++)
    for (int a = 0; a < 3; a++)
      soup->positions[3 * v + (size_t)a] =
          space->origin[a] + (double)vxm_quad_point_coordinate(c->points[v], a) * space->voxel_size[a];
}

/** Makes the faces, once all is known that they are made of. */
static vxm_status fill(vxm_soup *soup, const vxm_greedy_quads *quads, const vxm_quad_vertices *lattice,
                       const vxm_split_vertices *split, const vxm_grid *grid, bool triangles,
                       vxm_error *error) {
  /* the middle of an edge of four faces is a corner of each */
  size_t corners = count_all(lattice, quads) + (split ? 4 * split->middles : 0);
  size_t faces = triangles ? corners - 2 * quads->count : quads->count;
  size_t vertices = split ? split->vertex_count : lattice->vertex_count;
  vxm_status status = vxm_soup_reserve(soup, vertices, faces, triangles ? 3 * faces : corners, error);
  if (status != VXM_OK)
    return status;
  if (split)
    vxm_split_vertices_place(split, &grid->space, soup->positions);
  else
    place_vertices(soup, lattice, &grid->space);
  soup->vertex_count = vertices;
  builder b = {.soup = soup, .lattice = lattice, .split = split, .triangles = triangles};
  vxm_triangulator_open(&b.tri, soup->context);
  status = add_all(&b, quads, error);
  builder_close(&b);
  return status;
}

static vxm_status build(vxm_soup *soup, const vxm_grid *grid, unsigned flags, vxm_error *error) {
  vxm_greedy_quads quads;
  vxm_quad_vertices corners;
  vxm_split_vertices split;
  const bool splits = flags & VXM_SURFACE_MESH_MANIFOLD;
  vxm_status status = vxm_greedy_quads_find(&quads, grid, error);
  if (status != VXM_OK)
    return status;
  status = vxm_quad_vertices_find(&corners, &quads, grid->space.dims, error);
  if (status == VXM_OK) {
    if (splits)
      status = vxm_split_vertices_find(&split, &corners, grid, error);
    if (status == VXM_OK) {
      status = fill(soup, &quads, &corners, splits ? &split : NULL, grid, flags & VXM_SURFACE_MESH_TRIANGLES,
                    error);
      if (splits)
        vxm_split_vertices_destroy(&split);
    }
    vxm_quad_vertices_destroy(&corners);
  }
  vxm_greedy_quads_destroy(&quads);
  return status;
}

vxm_status vxm_gridio_surface_mesh(vxm_soup **out, const vxm_grid *grid, unsigned flags, vxm_error *error) {
  *out = NULL;
  vxm_soup *soup;
  vxm_status status = vxm_soup_create(&soup, grid->context, "grid", error);
  if (status != VXM_OK)
    return status;
  status = build(soup, grid, flags, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(soup);
    return status;
  }
  *out = soup;
  return VXM_OK;
}
