/* SPDX-License-Identifier: BSD-3-Clause */
/** The surface as a mesh: exactly the exposed faces, each once, in rectangles, closed mod 2, facing outward.
 */
#include "grids.h"

#include "base/file.h"
#include "gridio/gridio.h"
#include "gridio/mesh/split_vertices.h"
#include "gridio/mesh/surface_mesh.h"
#include "meshio/meshio.h"

#include <math.h>

static vxm_soup *surface_of(const vxm_grid *grid) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup = NULL;
  if (vxm_gridio_surface_mesh(&soup, grid, 0, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return soup;
}

/* ---- Edges ---- */

/** An edge with the smaller vertex first, and +1 or -1 for the direction a face runs along it. */
typedef struct edge {
  uint32_t a, b;
  int turn;
} edge;

static int compare_edges(const void *p, const void *q) {
  const edge *x = p, *y = q;
  if (x->a != y->a)
    return x->a < y->a ? -1 : 1;
  return x->b != y->b ? (x->b < y->b ? -1 : 1) : 0;
}

/** Every edge has an even number of faces, as many in one direction as in the other. */
static void assert_closed(const vxm_soup *soup) {
  edge *edges = malloc((soup->corner_count + 1) * sizeof *edges);
  assert_non_null(edges);
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++) {
      uint32_t a = corner[c], b = corner[(c + 1) % n];
      edges[count++] = a < b ? (edge){a, b, 1} : (edge){b, a, -1};
    }
  }
  qsort(edges, count, sizeof *edges, compare_edges);
  for (size_t e = 0; e < count;) {
    size_t begin = e;
    int turns = 0;
    for (; e < count && compare_edges(&edges[begin], &edges[e]) == 0; e++)
      turns += edges[e].turn;
    assert_true((e - begin) % 2 == 0);
    assert_int_equal(turns, 0);
  }
  free(edges);
}

/* ---- Unit faces ---- */

/** Lattice coordinate of a model coordinate, which must be exactly where the lattice point is. */
static int64_t lattice(const vxm_space *space, int axis, double at) {
  double guess = (at - space->origin[axis]) / space->voxel_size[axis];
  int64_t index = (int64_t)floor(guess + 0.5);
  assert_true(index >= 0 && index <= space->dims[axis]);
  assert_true(space->origin[axis] + (double)index * space->voxel_size[axis] == at);
  return index;
}

/** Faces found, by the voxel behind them and the side: 2 * axis + (1 if it looks forward). */
typedef struct painted {
  const vxm_grid *grid;
  uint8_t *sides;
} painted;

static void paint(painted *p, const int64_t voxel[3], int side) {
  const vxm_space *space = &p->grid->space;
  int64_t beside[3] = {voxel[0], voxel[1], voxel[2]};
  beside[side / 2] += side % 2 ? 1 : -1;
  assert_true(vxm_grid_get(p->grid, voxel[0], voxel[1], voxel[2]));
  assert_false(vxm_grid_get(p->grid, beside[0], beside[1], beside[2]));
  uint8_t *sides = &p->sides[(voxel[2] * space->dims[1] + voxel[1]) * space->dims[0] + voxel[0]];
  assert_false(*sides >> side & 1);
  *sides = (uint8_t)(*sides | 1u << side);
}

/** A polygon must run round its bounding rectangle once; paints the unit faces in it. Returns their number.
 */
static int64_t paint_polygon(painted *p, const vxm_soup *soup, size_t face) {
  size_t n;
  const uint32_t *corner = vxm_face(soup, face, &n);
  int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {-1, -1, -1}, area[3] = {0, 0, 0};
  int64_t(*at)[3] = malloc(n * sizeof *at);
  assert_non_null(at);
  for (size_t c = 0; c < n; c++)
    for (int a = 0; a < 3; a++) {
      at[c][a] = lattice(&p->grid->space, a, vxm_position(soup, corner[c])[a]);
      low[a] = at[c][a] < low[a] ? at[c][a] : low[a];
      high[a] = at[c][a] > high[a] ? at[c][a] : high[a];
    }
  for (size_t c = 0; c < n; c++) {
    const int64_t *q = at[c], *r = at[(c + 1) % n];
    int moved = 0;
    for (int a = 0; a < 3; a++) {
      moved += q[a] != r[a];
      area[a] += q[(a + 1) % 3] * r[(a + 2) % 3] - q[(a + 2) % 3] * r[(a + 1) % 3];
    }
    assert_int_equal(moved, 1);
  }
  free(at);
  int axis = low[0] == high[0] ? 0 : low[1] == high[1] ? 1 : 2;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int64_t faces = (high[u] - low[u]) * (high[v] - low[v]);
  assert_true(low[axis] == high[axis] && faces > 0);
  assert_true(area[axis] == 2 * faces || area[axis] == -2 * faces);
  bool forward = area[axis] > 0;
  int64_t voxel[3];
  voxel[axis] = low[axis] - forward;
  for (voxel[u] = low[u]; voxel[u] < high[u]; voxel[u]++)
    for (voxel[v] = low[v]; voxel[v] < high[v]; voxel[v]++)
      paint(p, voxel, 2 * axis + forward);
  return faces;
}

static int64_t count_exposed(const vxm_grid *grid) {
  const int64_t *n = grid->space.dims;
  int64_t count = 0;
  for (int64_t k = 0; k < n[2]; k++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t i = 0; i < n[0]; i++)
        if (vxm_grid_get(grid, i, j, k))
          count += !vxm_grid_get(grid, i - 1, j, k) + !vxm_grid_get(grid, i + 1, j, k) +
                   !vxm_grid_get(grid, i, j - 1, k) + !vxm_grid_get(grid, i, j + 1, k) +
                   !vxm_grid_get(grid, i, j, k - 1) + !vxm_grid_get(grid, i, j, k + 1);
  return count;
}

/** Six times the volume inside, by the divergence theorem over fans, in lattice units: exact in doubles. */
static double volume_in_voxels(const vxm_soup *soup, const vxm_space *space) {
  double sum = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    double p[3][3];
    for (size_t c = 1; c + 1 < n; c++) {
      const uint32_t three[3] = {corner[0], corner[c], corner[c + 1]};
      for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
          p[i][a] = (double)lattice(space, a, vxm_position(soup, three[i])[a]);
      for (int a = 0; a < 3; a++)
        sum += p[0][a] * (p[1][(a + 1) % 3] * p[2][(a + 2) % 3] - p[1][(a + 2) % 3] * p[2][(a + 1) % 3]);
    }
  }
  return sum / 6;
}

/** No two vertices at one place, none without a face. */
static void assert_vertices_shared(const vxm_soup *soup) {
  bool *used = calloc(soup->vertex_count + 1, sizeof *used);
  assert_non_null(used);
  for (size_t c = 0; c < soup->corner_count; c++)
    used[soup->indices[c]] = true;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    assert_true(used[v]);
    if (v == 0)
      continue;
    /* The vertices are in the order of z, y, x. */
    const double *p = vxm_position(soup, v - 1), *q = vxm_position(soup, v);
    assert_true(p[2] < q[2] || (p[2] == q[2] && (p[1] < q[1] || (p[1] == q[1] && p[0] < q[0]))));
  }
  free(used);
}

static void check_surface(const vxm_grid *grid) {
  const vxm_space *space = &grid->space;
  vxm_soup *soup = surface_of(grid);
  painted p = {grid, calloc((size_t)(space->dims[0] * space->dims[1] * space->dims[2]), 1)};
  assert_non_null(p.sides);
  int64_t faces = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    faces += paint_polygon(&p, soup, f);
  assert_int_equal(faces, count_exposed(grid));
  assert_closed(soup);
  assert_vertices_shared(soup);
  assert_true(volume_in_voxels(soup, space) == (double)vxm_grid_count(grid));
  free(p.sides);
  vxm_soup_destroy(soup);
}

/* ---- Tests ---- */

static void test_random_grids(void **state) {
  (void)state;
  vxm_rng rng = {9};
  for (int round = 0; round < 90; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_space space = random_space(&rng, round < 60 ? 24 : 12, false);
    if (round % 10 == 3)
      space.dims[round / 10 % 3] = 60 + (int64_t)vxm_rng_below(&rng, 80);
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % KINDS);
    check_surface(grid);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
}

/** Every set of voxels in 2 x 2 x 2, also those that touch only at an edge or a corner. */
static void test_all_of_eight(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (int set = 0; set < 256; set++) {
    vxm_grid *grid = new_grid(context, (vxm_space){{2, 2, 2}, {0.1, -0.2, 0.3}, {0.7, 1.1, 1.3}});
    for (int v = 0; v < 8; v++)
      vxm_grid_set(grid, v & 1, v >> 1 & 1, v >> 2, set >> v & 1);
    check_surface(grid);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

/* ---- Voxels that touch in an edge or a corner alone ---- */

/** Every edge has two faces that run along it in opposite directions, also for who merges positions that are
 * the same after rounding to 1e-8; returns the volume in voxels. */
static double check_manifold(vxm_soup *soup, const vxm_space *space) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    for (size_t w = 0; w < v; w++) {
      bool same = true;
      for (int a = 0; a < 3; a++)
        same = same && rint(vxm_position(soup, v)[a] * 1e8) == rint(vxm_position(soup, w)[a] * 1e8);
      assert_false(same);
    }
  edge *edges = malloc((soup->corner_count + 1) * sizeof *edges);
  assert_non_null(edges);
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++) {
      uint32_t a = corner[c], b = corner[(c + 1) % n];
      assert_true(a != b);
      edges[count++] = a < b ? (edge){a, b, 1} : (edge){b, a, -1};
    }
  }
  qsort(edges, count, sizeof *edges, compare_edges);
  for (size_t e = 0; e < count; e += 2) {
    assert_true(e + 1 < count && compare_edges(&edges[e], &edges[e + 1]) == 0);
    assert_int_equal(edges[e].turn + edges[e + 1].turn, 0);
    assert_true(e + 2 == count || compare_edges(&edges[e], &edges[e + 2]) != 0);
  }
  free(edges);
  double volume = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 1; c + 1 < n; c++) {
      double p[3][3];
      for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
          p[i][a] = (vxm_position(soup, corner[i == 0 ? 0 : c + (size_t)i - 1])[a] - space->origin[a]) /
                    space->voxel_size[a];
      for (int a = 0; a < 3; a++) {
        int u = (a + 1) % 3, v = (a + 2) % 3;
        volume += p[0][a] * (p[1][u] * p[2][v] - p[1][v] * p[2][u]) / 6;
      }
    }
  }
  return volume;
}

static vxm_soup *split_surface_of(const vxm_grid *grid, unsigned how) {
  vxm_soup *soup = NULL;
  assert_int_equal(vxm_gridio_surface_mesh(&soup, grid, VXM_SURFACE_MESH_MANIFOLD | how, NULL), VXM_OK);
  return soup;
}

static void check_split(const vxm_grid *grid) {
  vxm_soup *plain = surface_of(grid);
  for (unsigned how = 0; how <= VXM_SURFACE_MESH_TRIANGLES; how += VXM_SURFACE_MESH_TRIANGLES) {
    vxm_soup *soup = split_surface_of(grid, how);
    double voxels = (double)vxm_grid_count(grid), volume = check_manifold(soup, &grid->space);
    /* a vertex that is moved takes a part of the faces about it along */
    double most = VXM_SPLIT_SHARE * (double)count_exposed(grid);
    assert_true(fabs(volume - voxels) <= most);
    assert_true(soup->vertex_count > plain->vertex_count || fabs(volume - voxels) < 1e-9 * voxels);
    for (size_t f = 0; f < soup->face_count && how; f++)
      assert_true(soup->offsets[f + 1] - soup->offsets[f] == 3);
    vxm_soup_destroy(soup);
  }
  vxm_soup_destroy(plain);
}

/** All ways in which the eight voxels about a point may be set, and the twelve about an edge: among
 * them a hole of an edge's length through two voxels that touch in it. */
static void test_split_all(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (unsigned set = 1; set < 1u << 12; set++) {
    vxm_grid *grid = new_grid(context, unit_space(2, 2, set < 256 ? 2 : 3));
    for (unsigned o = 0; o < (set < 256 ? 8u : 12u); o++)
      if (set >> o & 1)
        vxm_grid_set(grid, o & 1, o >> 1 & 1, o >> 2, true);
    check_split(grid);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

static void test_split_random(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {41};
  for (int trial = 0; trial < 60; trial++) {
    vxm_space space = unit_space(1 + (int64_t)vxm_rng_below(&rng, 9), 1 + (int64_t)vxm_rng_below(&rng, 9),
                                 1 + (int64_t)vxm_rng_below(&rng, 9));
    for (int a = 0; a < 3; a++) {
      space.origin[a] = 10 * (vxm_rng_unit(&rng) - 0.5);
      space.voxel_size[a] = 0.01 + vxm_rng_unit(&rng);
    }
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, 1 + trial % 3);
    check_split(grid);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

static void assert_sizes(const vxm_grid *grid, size_t vertices, size_t faces) {
  vxm_soup *soup = surface_of(grid);
  assert_int_equal(soup->vertex_count, vertices);
  assert_int_equal(soup->face_count, faces);
  vxm_soup_destroy(soup);
  check_surface(grid);
}

/** A box of any size is six rectangles; a checkerboard is all unit faces. */
static void test_known_sizes(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(130, 65, 3));
  assert_sizes(grid, 0, 0);
  for (int64_t k = 0; k < 3; k++)
    for (int64_t j = 0; j < 65; j++)
      vxm_row_set_span(vxm_grid_row(grid, j, k), 0, 130);
  assert_sizes(grid, 8, 6);
  vxm_grid_destroy(grid);

  grid = new_grid(context, unit_space(6, 6, 6));
  for (int64_t v = 0; v < 216; v++)
    vxm_grid_set(grid, v % 6, v / 6 % 6, v / 36, (v % 6 + v / 6 % 6 + v / 36) % 2 == 0);
  /* Of the 7^3 lattice points the 8 corners of the box have one voxel around them, and half of those are
     clear; every other point has two voxels that share a face, so one is set. */
  assert_sizes(grid, 343 - 4, 108 * 6);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

static void test_same_for_all_threads(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  vxm_soup *first = NULL;
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_with(threads[t], 0, NULL, NULL);
    vxm_rng rng = {10};
    vxm_grid *grid = new_grid(context, unit_space(200, 70, 90));
    fill_random(grid, &rng, 3);
    vxm_soup *soup = surface_of(grid);
    if (first) {
      assert_int_equal(soup->vertex_count, first->vertex_count);
      assert_int_equal(soup->corner_count, first->corner_count);
      assert_memory_equal(soup->positions, first->positions, 3 * soup->vertex_count * sizeof(double));
      assert_memory_equal(soup->indices, first->indices, soup->corner_count * sizeof(uint32_t));
      vxm_soup_destroy(soup);
    } else
      first = soup;
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  vxm_soup_destroy(first);
}

static int stop_later(const char *phase, double fraction, void *payload) {
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return --*(int *)payload < 0;
}

static void test_cancel_and_limit(void **state) {
  (void)state;
  vxm_rng rng = {11};
  int calls = 1 << 30, stop = 0;
  vxm_context *context = context_with(2, 0, stop_later, &calls);
  vxm_grid *grid = new_grid(context, unit_space(70, 50, 40));
  fill_random(grid, &rng, 1);
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup = NULL;
  for (;; stop++) {
    calls = stop;
    vxm_status status = vxm_gridio_surface_mesh(&soup, grid, 0, &error);
    if (status == VXM_OK)
      break;
    assert_int_equal(status, VXM_ERROR_CANCELLED);
    assert_null(soup);
  }
  assert_true(stop > 3);
  vxm_soup_destroy(soup);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);

  bool done = false;
  for (uint64_t limit = 64 << 10; !done; limit += limit / 2) {
    context = context_with(2, limit, NULL, NULL);
    grid = new_grid(context, unit_space(70, 50, 40));
    fill_random(grid, &rng, 1);
    vxm_status status = vxm_gridio_surface_mesh(&soup, grid, 0, &error);
    done = status == VXM_OK;
    assert_true(done || status == VXM_ERROR_MEMORY_LIMIT);
    assert_true(vxm_context_peak_bytes(context) <= limit);
    vxm_soup_destroy(soup);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
}

/* ---- Through mesh files ---- */

static vxm_soup *load_mesh(vxm_context *context, const char *path) {
  size_t size;
  unsigned char *data = load_file(path, &size);
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup = NULL;
  if (vxm_meshio_read(&soup, context, data, size, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  free(data);
  return soup;
}

/** obj, ply and off hold the polygons as they are; stl holds triangles, all of which have area. */
static void test_mesh_files(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {12};
  vxm_grid *grid = new_grid(context, unit_space(12, 9, 8));
  fill_random(grid, &rng, 1);
  for (int64_t j = 0; j < 9; j++) /* a flat side, so that there are long rectangles with many corners */
    vxm_row_set_span(vxm_grid_row(grid, j, 0), 0, 12);
  vxm_soup *surface = surface_of(grid);
  static const char *const formats[] = {"obj", "ply", "off", "stl"};
  for (int f = 0; f < 4; f++) {
    char path[80];
    snprintf(path, sizeof path, "%s/s.%s", folder, formats[f]);
    vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
    options.keep_polygons = options.keep_contacts = true;
    assert_int_equal(vxm_gridio_write_with(grid, path, &options, NULL), VXM_OK);
    vxm_soup *back = load_mesh(context, path);
    if (f < 3) {
      assert_int_equal(back->vertex_count, surface->vertex_count);
      assert_int_equal(back->corner_count, surface->corner_count);
      assert_memory_equal(back->positions, surface->positions, 3 * back->vertex_count * sizeof(double));
      assert_memory_equal(back->indices, surface->indices, back->corner_count * sizeof(uint32_t));
    } else {
      assert_int_equal(back->face_count, surface->corner_count - 2 * surface->face_count);
      assert_true(volume_in_voxels(back, &grid->space) == (double)vxm_grid_count(grid));
      for (size_t t = 0; t < back->face_count; t++) {
        size_t n;
        const uint32_t *corner = vxm_face(back, t, &n);
        const double *p = vxm_position(back, corner[0]), *q = vxm_position(back, corner[1]),
                     *r = vxm_position(back, corner[2]);
        double area = 0;
        for (int a = 0; a < 3; a++) {
          int u = (a + 1) % 3, v = (a + 2) % 3;
          area += fabs((q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]));
        }
        assert_true(area > 0);
      }
    }
    vxm_soup_destroy(back);
  }
  vxm_soup_destroy(surface);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Far from the origin a file is written as long as its numbers tell vertices apart, and none is beyond that.
 */
static void test_far_from_origin(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  static const struct {
    double far; /* voxels */
    const char *format;
    bool touching, joined, written;
  } cases[] = {
      {30000, "stl", true, false, true},   {300000, "stl", true, false, false},
      {300000, "stl", false, false, true}, {300000, "stl", true, true, true},
      {8e6, "stl", false, false, true},    {2e7, "stl", false, false, false},
      {2e7, "stl", true, true, false},     {2e7, "ply", true, false, true},
      {2e7, "obj", true, false, true},     {1e15, "off", false, false, true},
      {1e15, "off", true, false, false},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    vxm_space space = unit_space(6, 5, 4);
    for (int a = 0; a < 3; a++) {
      space.voxel_size[a] = 0.25;
      space.origin[a] = 0.25 * cases[i].far;
    }
    vxm_grid *grid = new_grid(context, space);
    vxm_row_set_span(vxm_grid_row(grid, 1, 1), 1, 2);
    vxm_row_set_span(vxm_grid_row(grid, 2, 1), cases[i].touching ? 2 : 1, 4);
    snprintf(path, sizeof path, "%s/s%zu.%s", folder, i, cases[i].format);
    vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
    options.keep_contacts = cases[i].joined;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_gridio_write_with(grid, path, &options, &error),
                     cases[i].written ? VXM_OK : VXM_ERROR_RANGE);
    assert_int_equal(access(path, F_OK), cases[i].written ? 0 : -1);
    assert_true(cases[i].written || strstr(error.text, "too coarse"));
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_grids),     cmocka_unit_test(test_all_of_eight),
      cmocka_unit_test(test_known_sizes),      cmocka_unit_test(test_split_all),
      cmocka_unit_test(test_split_random),     cmocka_unit_test(test_same_for_all_threads),
      cmocka_unit_test(test_cancel_and_limit), cmocka_unit_test(test_mesh_files),
      cmocka_unit_test(test_far_from_origin),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
