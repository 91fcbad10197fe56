/* SPDX-License-Identifier: BSD-3-Clause */
/* What surfaces are for: thin ones separate, and faces cover what they are, however they are cut up. */
#include "../mesh/polygons.h"
#include "surfaces.h"

#include "voxel/model/voxelize.h"

#include <string.h>

/* ---- Separation ---- */

/** Two 6-neighbours outside the thin surface are both inside the mesh or both outside. */
static void assert_separates(const vxm_soup *soup, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = space;
  options.method = VXM_METHOD_X;
  options.split_mode = VXM_SPLIT_MODE_WHOLE;
  vxm_grid *solid;
  assert_int_equal(vxm_voxelize(&solid, NULL, soup, &space_options, &options, NULL), VXM_OK);
  vxm_lattice lattice = vxm_lattice_of(space);
  vxm_surface *surface = surface_of(soup, &lattice, NULL);
  vxm_window thin = window_make(space, layouts[0], 0, space->dims[2]);
  draw(surface, &thin, VXM_SURFACE_THIN, true);
  int64_t v[3], steps = 0;
  for (v[2] = 0; v[2] < space->dims[2]; v[2]++)
    for (v[1] = 0; v[1] < space->dims[1]; v[1]++)
      for (v[0] = 0; v[0] < space->dims[0]; v[0]++)
        for (int a = 0; a < 3; a++) {
          int64_t next[3] = {v[0] + (a == 0), v[1] + (a == 1), v[2] + (a == 2)};
          if (next[a] == space->dims[a] || window_get(&thin, v) || window_get(&thin, next))
            continue;
          assert_int_equal(vxm_grid_get(solid, v[0], v[1], v[2]),
                           vxm_grid_get(solid, next[0], next[1], next[2]));
          steps++;
        }
  assert_true(steps > 0);
  free(thin.words);
  vxm_surface_destroy(surface);
  vxm_grid_destroy(solid);
}

/** What a flood from the corner of the grid reaches over 6-neighbours outside the thin surface. */
static size_t flood(const vxm_window *thin, const vxm_space *space, uint8_t *reached) {
  const int64_t *d = space->dims;
  size_t count = (size_t)(d[0] * d[1] * d[2]), top = 0, done = 0;
  int64_t(*stack)[3] = malloc(count * sizeof *stack);
  memset(reached, 0, count);
  reached[0] = 1;
  memset(stack[top++], 0, sizeof *stack);
  while (top > 0) {
    int64_t v[3];
    memcpy(v, stack[--top], sizeof v);
    done++;
    for (int side = 0; side < 6; side++) {
      int64_t next[3] = {v[0], v[1], v[2]};
      next[side / 2] += side % 2 ? 1 : -1;
      if (next[side / 2] < 0 || next[side / 2] == d[side / 2] || window_get(thin, next))
        continue;
      uint8_t *mark = &reached[(next[2] * d[1] + next[1]) * d[0] + next[0]];
      if (!*mark)
        memcpy(stack[top++], next, sizeof next);
      *mark = 1;
    }
  }
  free(stack);
  return done;
}

static void test_thin_separates(void **state) {
  (void)state;
  vxm_rng rng = {4};
  vxm_space space = unit_space(14, 13, 12);
  for (int round = 0; round < 400; round++) {
    vxm_soup *soup = shape_empty(context);
    shape_random_octahedron(soup, &rng, 4, 44);
    if (round % 2)
      shape_random_octahedron(soup, &rng, 4, 44);
    assert_separates(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Boxes whose faces lie on borders, on centres and between: the flood stays outside, the inside is left
 * free. */
static void test_flood_stays_outside(void **state) {
  (void)state;
  vxm_space space = unit_space(12, 12, 12);
  vxm_lattice lattice = vxm_lattice_of(&space);
  uint8_t *reached = malloc(12 * 12 * 12);
  for (int shift = 0; shift < 4; shift++) {
    vxm_soup *soup = shape_empty(context);
    double low = 2 + 0.25 * shift, high = 9 + 0.25 * shift;
    shape_box(soup, (double[]){low, low, low}, (double[]){high, high, high});
    vxm_surface *surface = surface_of(soup, &lattice, NULL);
    vxm_window thin = window_make(&space, layouts[0], 0, 12);
    draw(surface, &thin, VXM_SURFACE_THIN, true);
    size_t outside = flood(&thin, &space, reached);
    assert_false(reached[(5 * 12 + 5) * 12 + 5]);
    /* On a border both voxels beside it belong to the surface, elsewhere one layer does. */
    size_t across = shift == 0 ? 9 : 8;
    assert_int_equal(outside, 12 * 12 * 12 - across * across * across);
    free(thin.words);
    vxm_surface_destroy(surface);
    vxm_soup_destroy(soup);
  }
  free(reached);
}

/* ---- Polygons ---- */

/** A flat polygon covers the same voxels however it is cut into triangles. */
static void test_planar_faces_do_not_depend_on_their_triangles(void **state) {
  (void)state;
  enum { CORNERS = 6 };
  static const int shape[CORNERS][2] = {{0, 0}, {4, -1}, {7, 1}, {8, 4}, {5, 7}, {1, 5}};
  vxm_rng rng = {5};
  vxm_space space = unit_space(16, 16, 16);
  vxm_lattice lattice = vxm_lattice_of(&space);
  for (int round = 0; round < 60; round++) {
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
      u[a] = shape_quarter(&rng, -5, 5) + (double)vxm_rng_below(&rng, 9) / 64;
      v[a] = shape_quarter(&rng, -5, 5) - (double)vxm_rng_below(&rng, 9) / 64;
    }
    vxm_window first = window_make(&space, layouts[0], 0, 16), other = window_make(&space, layouts[0], 0, 16);
    for (int turn = 0; turn <= CORNERS; turn++) {
      vxm_soup *soup = shape_empty(context);
      uint32_t corner[CORNERS];
      for (int i = 0; i < CORNERS; i++) {
        const int *at = shape[(i + turn) % CORNERS];
        corner[i] = shape_vertex(soup, 8 + at[0] * u[0] + at[1] * v[0] - 4 * u[0] - 3 * v[0],
                                 8 + at[0] * u[1] + at[1] * v[1] - 4 * u[1] - 3 * v[1],
                                 8 + at[0] * u[2] + at[1] * v[2] - 4 * u[2] - 3 * v[2]);
      }
      if (turn == CORNERS) /* as one polygon; otherwise as a fan around one of its corners */
        shape_face(soup, corner, CORNERS);
      for (uint32_t i = 1; i + 1 < CORNERS && turn < CORNERS; i++)
        shape_triangle(soup, corner[0], corner[i], corner[i + 1]);
      vxm_surface *surface = surface_of(soup, &lattice, NULL);
      draw(surface, turn == 0 ? &first : &other, VXM_SURFACE_CONSERVATIVE, true);
      if (turn > 0)
        assert_memory_equal(first.words, other.words, 256 * sizeof *first.words);
      vxm_surface_destroy(surface);
      vxm_soup_destroy(soup);
    }
    free(first.words);
    free(other.words);
  }
}

/** A plane through the middle of the grid, in quarters of voxels. */
typedef struct plane {
  double origin[3], u[3], v[3];
} plane;

static plane random_plane(vxm_rng *rng) {
  plane p;
  for (int a = 0; a < 3; a++) {
    p.u[a] = shape_quarter(rng, -1, 1);
    p.v[a] = shape_quarter(rng, -1, 1);
    p.origin[a] = 8 - FLAT_SIDE / 2 * (p.u[a] + p.v[a]);
  }
  return p;
}

static uint32_t add_at(vxm_soup *soup, const plane *p, int64_t x, int64_t y) {
  double at[3];
  for (int a = 0; a < 3; a++)
    at[a] = p->origin[a] + (double)x * p->u[a] + (double)y * p->v[a];
  return shape_vertex(soup, at[0], at[1], at[2]);
}

static void cover_of(const vxm_soup *soup, const vxm_window *window, const vxm_lattice *lattice) {
  vxm_surface *surface = surface_of(soup, lattice, NULL);
  draw(surface, window, VXM_SURFACE_CONSERVATIVE, true);
  vxm_surface_destroy(surface);
}

/** The cells themselves, two triangles each. */
static vxm_soup *soup_of_cells(const heap *h, const plane *p) {
  vxm_soup *soup = shape_empty(context);
  for (int64_t y = 0; y < FLAT_SIDE; y++)
    for (int64_t x = 0; x < FLAT_SIDE; x++) {
      if (!h->cell[y][x])
        continue;
      uint32_t a = add_at(soup, p, x, y), b = add_at(soup, p, x + 1, y), c = add_at(soup, p, x + 1, y + 1),
               d = add_at(soup, p, x, y + 1);
      shape_triangle(soup, a, b, c);
      shape_triangle(soup, a, c, d);
    }
  return soup;
}

/** The outline of a heap of cells as one face; its corners are vertices of their own, or one for each place.
 */
static vxm_soup *soup_of_outline(const flat *f, const plane *p, bool is_shared) {
  vxm_soup *soup = shape_empty(context);
  uint32_t corners[FLAT_MAX];
  for (size_t i = 0; i < f->n; i++) {
    size_t same = i;
    for (size_t k = 0; k < i && is_shared && same == i; k++)
      if (memcmp(f->at[k], f->at[i], sizeof *f->at) == 0)
        same = k;
    corners[i] = same < i ? corners[same] : add_at(soup, p, f->at[i][0], f->at[i][1]);
  }
  shape_face(soup, corners, f->n);
  return soup;
}

/** Whether some edge runs there and back. */
static bool has_seam(const flat *f) {
  for (size_t i = 0; i < f->n; i++)
    for (size_t k = 0; k < i; k++)
      if (memcmp(f->at[i], f->at[(k + 1) % f->n], sizeof *f->at) == 0 &&
          memcmp(f->at[k], f->at[(i + 1) % f->n], sizeof *f->at) == 0)
        return true;
  return false;
}

/** Holes joined to the rim by edges there and back are left open, in whichever plane. */
static void test_polygons_with_holes(void **state) {
  (void)state;
  static flat f;
  static heap h;
  vxm_rng rng = {8};
  vxm_space space = unit_space(16, 16, 16);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_window right = window_make(&space, layouts[0], 0, 16), made = window_make(&space, layouts[0], 0, 16);
  int seams = 0;
  for (int round = 0; round < 1500; round++) {
    heap_grow(&h, 8 + (size_t)vxm_rng_below(&rng, 80), &rng);
    if (!heap_outline(&f, &h, &rng))
      continue;
    seams += has_seam(&f);
    plane p = random_plane(&rng);
    vxm_soup *cells = soup_of_cells(&h, &p), *face = soup_of_outline(&f, &p, round % 2);
    cover_of(cells, &right, &lattice);
    cover_of(face, &made, &lattice);
    if (memcmp(right.words, made.words, 256 * sizeof *right.words) != 0)
      fail_msg("round %d: a face of %zu corners covers other voxels than its cells", round, f.n);
    vxm_soup_destroy(cells);
    vxm_soup_destroy(face);
  }
  assert_true(seams > 500);
  free(right.words);
  free(made.words);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_thin_separates),
      cmocka_unit_test(test_flood_stays_outside),
      cmocka_unit_test(test_planar_faces_do_not_depend_on_their_triangles),
      cmocka_unit_test(test_polygons_with_holes),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
