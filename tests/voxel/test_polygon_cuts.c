/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons of many corners: what they are cut into for thin parts. */
#include "thin_meshes.h"
#include "thin_rule.h"

#include "voxel/parts/triangle_set.h"

enum { CORNERS_MOST = 200 };

/** Outlines: a star that does not cross itself; a comb; corners here and there, which cross each other; a
 * ring whose hole is joined to the rim; a rim that goes round twice. */
enum { STAR, COMB, TANGLE, RING, TWICE, OUTLINES };

static size_t outline(double at[CORNERS_MOST][2], vxm_rng *rng, int kind) {
  size_t n = VXM_CUT_CORNERS + vxm_rng_below(rng, 60);
  n += n % 2;
  for (size_t i = 0; i < n; i++) {
    size_t half = n / 2, in_ring = i < half ? i : n - 1 - i;
    double turn = 6.283185307179586 / (double)n * (double)i, radius = 0.1 + 0.4 * vxm_rng_unit(rng);
    if (kind == RING) { /* out and back */
      turn = 6.283185307179586 / (double)(half - 1) * (double)in_ring;
      radius = i < half ? 0.5 : 0.2;
    } else if (kind == TWICE)
      turn *= 2;
    at[i][0] = 0.5 + radius * cos(turn);
    at[i][1] = 0.5 + radius * sin(turn);
    if (kind == COMB) {
      at[i][0] = i + 2 < n ? (double)i / (double)n : i + 2 == n ? 1 : 0;
      at[i][1] = i + 2 < n ? (i % 2 ? 0.95 : 0.1 + 0.1 * vxm_rng_unit(rng)) : 0;
    } else if (kind == TANGLE)
      for (int c = 0; c < 2; c++)
        at[i][c] = vxm_rng_unit(rng);
  }
  return n;
}

/** The same vertex where a ring comes back to where it began. */
static uint32_t vertex_of(int kind, size_t n, size_t i) {
  bool back = kind == RING && (i + 1 == n / 2 || i == n / 2);
  return (uint32_t)(!back ? i : i < n / 2 ? 0 : n - 1);
}

/** A polygon across an axis. */
static void add_polygon(vxm_soup *soup, vxm_rng *rng, int kind, const double low[3], double size, int axis) {
  double at[CORNERS_MOST][2];
  uint32_t face[CORNERS_MOST], first = (uint32_t)soup->vertex_count;
  size_t n = outline(at, rng, kind);
  for (size_t i = 0; i < n; i++) {
    double p[3];
    p[axis] = low[axis];
    p[(axis + 1) % 3] = low[(axis + 1) % 3] + size * at[i][0];
    p[(axis + 2) % 3] = low[(axis + 2) % 3] + size * at[i][1];
    shape_vertex(soup, p[0], p[1], p[2]);
    face[i] = first + vertex_of(kind, n, i);
  }
  shape_face(soup, face, n);
}

/* ---- Pieces ---- */

static double area_of(const vxm_triangle_set *triangles, const uint32_t (*list)[3]) {
  double twice = 0;
  for (size_t t = 0; t < triangles->parts[0].caps; t++) {
    const double *p = triangles->positions[list[t][0]], *q = triangles->positions[list[t][1]],
                 *r = triangles->positions[list[t][2]];
    twice += fabs((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
  }
  return twice / 2;
}

/** How many sides between two vertices there are, of the polygon and of pieces. */
typedef struct sides {
  uint8_t edges[CORNERS_MOST][CORNERS_MOST], told[CORNERS_MOST][CORNERS_MOST],
      inner[CORNERS_MOST][CORNERS_MOST];
} sides;

static void count_side(uint8_t counts[CORNERS_MOST][CORNERS_MOST], uint32_t p, uint32_t q) {
  counts[p < q ? p : q][p < q ? q : p]++;
}

/** Each edge is the side of one piece that says so; all others cancel. */
static void check_sides(const vxm_soup *soup, const vxm_triangle_set *triangles) {
  static sides s;
  memset(&s, 0, sizeof s);
  for (size_t i = 0; i < soup->corner_count; i++)
    count_side(s.edges, soup->indices[i], soup->indices[(i + 1) % soup->corner_count]);
  for (size_t t = 0; t < triangles->parts[0].caps; t++) {
    assert_int_equal(triangles->edges[t] & VXM_CUT_PIECE, VXM_CUT_PIECE);
    for (int k = 0; k < 3; k++)
      count_side(triangles->edges[t] >> k & 1 ? s.told : s.inner, triangles->vertex[triangles->pieces[t][k]],
                 triangles->vertex[triangles->pieces[t][(k + 1) % 3]]);
  }
  for (int p = 0; p < CORNERS_MOST; p++)
    for (int q = p; q < CORNERS_MOST; q++) {
      assert_int_equal(s.told[p][q], s.edges[p][q]);
      assert_int_equal(s.inner[p][q] % 2, 0);
    }
}

static void test_pieces(void **state) {
  (void)state;
  vxm_rng rng = {601};
  const double low[3] = {0, 0, 0};
  const vxm_split_rule rule = {.split_mode = VXM_SPLIT_MODE_WHOLE};
  for (int round = 0; round < ROUNDS(20 * OUTLINES); round++) {
    int kind = round % OUTLINES;
    vxm_soup *soup = shape_empty(context);
    add_polygon(soup, &rng, kind, low, 10, 2);
    vxm_triangle_set triangles;
    assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
    if (triangles.pieces) {
      assert_int_equal(triangles.parts[0].caps, soup->corner_count - 2);
      check_sides(soup, &triangles);
    } else
      assert_int_equal(kind, RING); /* covered from a corner that is there twice */
    if (kind == COMB)               /* the work that there is for each voxel */
      assert_true(4 * area_of(&triangles, vxm_pieces_of(&triangles)) <
                  area_of(&triangles, (const uint32_t(*)[3])triangles.corners));
    vxm_triangle_set_destroy(&triangles);
    vxm_soup_destroy(soup);
  }
}

/** Polygons of fewer corners, and triangles beside them, stay what they are. */
static void test_other_faces(void **state) {
  (void)state;
  vxm_rng rng = {602};
  const double low[3] = {0, 0, 0}, high[3] = {2, 3, 4};
  const vxm_split_rule rule = {.split_mode = VXM_SPLIT_MODE_WHOLE};
  vxm_soup *soup = shape_empty(context);
  vxm_triangle_set triangles;
  shape_box(soup, low, high);
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  assert_null(triangles.pieces);
  vxm_triangle_set_destroy(&triangles);
  add_polygon(soup, &rng, STAR, low, 5, 1);
  shape_triangle(soup, 0, 1, 2);
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  assert_non_null(triangles.pieces);
  size_t others = 0;
  for (size_t t = 0; t < triangles.triangle_count; t++)
    if (!triangles.edges[t]) {
      assert_memory_equal(triangles.pieces[t], triangles.corners[t], sizeof *triangles.corners);
      others++;
    }
  assert_true(others > 12); /* of the box and the triangle; the others are caps and cones */
  vxm_triangle_set_destroy(&triangles);
  vxm_soup_destroy(soup);
}

/* ---- Voxels ---- */

static void check_voxels(const vxm_soup *soup, const vxm_space *space, vxm_thin_parts thin) {
  int directions = thin == VXM_THIN_KEEP26 ? 13 : 3;
  thin_mesh mesh = thin_mesh_of(soup, space);
  vxm_grid *centres = thin_grid(soup, space, VXM_THIN_DROP, NULL), *grid = thin_grid(soup, space, thin, NULL);
  uint8_t *solid = thin_bytes(centres), *kept = thin_bytes(grid);
  thin_assert_contract(&mesh, solid, kept, directions);
  thin_apply_rule(&mesh, solid, directions);
  assert_memory_equal(kept, solid, thin_size(space));
  free(solid);
  free(kept);
  vxm_grid_destroy(centres);
  vxm_grid_destroy(grid);
  thin_mesh_free(&mesh);
}

/** Flat polygons have the voxels that the oracle finds by covering them from one corner, also where they
 * cross themselves: an even number of times is none. */
static void test_voxels(void **state) {
  (void)state;
  vxm_rng rng = {603};
  for (int round = 0; round < ROUNDS(12 * OUTLINES); round++) {
    vxm_space space = engine_space(10, 11, 12);
    vxm_soup *soup = shape_empty(context);
    double low[3], size = 1 + 6 * vxm_rng_unit(&rng);
    for (int a = 0; a < 3; a++)
      low[a] = 1.5 + vxm_rng_unit(&rng);
    add_polygon(soup, &rng, round % OUTLINES, low, size, round / OUTLINES % 3);
    check_voxels(soup, &space, round % 4 ? VXM_THIN_KEEP : VXM_THIN_KEEP26);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pieces),
      cmocka_unit_test(test_other_faces),
      cmocka_unit_test(test_voxels),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
