/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons are the triangles that they become when they are split, whichever way a mesh is turned. */
#include "thin_meshes.h"
#include "thin_rule.h"

enum { CORNERS_MOST = 200 };

/** Outlines: a star that does not cross itself; a comb; corners here and there, which cross each other; a
 * ring whose hole is joined to the rim; a rim that goes round twice. */
enum { STAR, COMB, TANGLE, RING, TWICE, OUTLINES };

static size_t outline(double at[CORNERS_MOST][2], vxm_rng *rng, int kind) {
  size_t n = 64 + vxm_rng_below(rng, 60);
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

/* ---- Thin parts ---- */

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

/** Flat polygons have the voxels that the oracle finds by their triangles, also where they cross themselves.
 */
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

/* ---- Bent polygons ---- */

/** A block of cells, `SIDE` along each axis, of which the outside is covered by quads. */
enum { SIDE = 4 };

/** The vertex of a lattice point on the outside, made where it is met first. */
static uint32_t outside_vertex(vxm_soup *soup, vxm_rng *rng, uint32_t known[SIDE + 1][SIDE + 1][SIDE + 1],
                               const int at[3], double bend) {
  uint32_t *vertex = &known[at[0]][at[1]][at[2]];
  if (*vertex == UINT32_MAX) {
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] = 5.0 * (at[a] / (double)SIDE * 2 - 1) + bend * (2 * vxm_rng_unit(rng) - 1);
    *vertex = shape_vertex(soup, p[0], p[1], p[2]);
  }
  return *vertex;
}

/** A closed body of bent quads, and hexagons of two each, which begin with any corner. */
static vxm_soup *bent_body(vxm_rng *rng, double bend, bool hexagons) {
  uint32_t known[SIDE + 1][SIDE + 1][SIDE + 1];
  vxm_soup *soup = shape_empty(context);
  memset(known, 0xff, sizeof known);
  for (int side = 0; side < 6; side++)
    for (int row = 0; row < SIDE; row++)
      for (int i = 0, wide; i < SIDE; i += wide) {
        static const int step[6][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}};
        uint32_t corner[6], turned[6];
        size_t n = 0, first;
        wide = hexagons && i + 1 < SIDE && vxm_rng_below(rng, 2) ? 2 : 1;
        for (int k = 0; k < 6; k++) {
          if (wide == 1 && (k == 2 || k == 3))
            continue;
          int at[3], axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
          at[axis] = side % 2 ? SIDE : 0;
          at[side % 2 ? u : v] = i + step[k][0];
          at[side % 2 ? v : u] = row + step[k][1];
          corner[n++] = outside_vertex(soup, rng, known, at, bend);
        }
        first = (size_t)vxm_rng_below(rng, n);
        for (size_t k = 0; k < n; k++)
          turned[k] = corner[(first + k) % n];
        shape_face(soup, turned, n);
      }
  return soup;
}

/** A way to permute and mirror the axes. */
typedef struct symmetry {
  int from[3]; /**< axis a of what is turned is axis from[a] of what was there */
  bool mirrored[3];
} symmetry;

static symmetry symmetry_of(int number) {
  static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  symmetry s;
  for (int a = 0; a < 3; a++) {
    s.from[a] = orders[number / 8][a];
    s.mirrored[a] = number >> a & 1;
  }
  return s;
}

/** Faces begin with other corners, too, and some are wound the other way with all others. */
static vxm_soup *turned_body(const vxm_soup *body, vxm_rng *rng, const symmetry *s) {
  vxm_soup *soup = shape_empty(context);
  bool back = vxm_rng_below(rng, 2);
  for (size_t v = 0; v < body->vertex_count; v++) {
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] = (s->mirrored[a] ? -1 : 1) * vxm_position(body, (uint32_t)v)[s->from[a]];
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (size_t f = 0; f < body->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(body, f, &n);
    uint32_t turned[6];
    size_t first = (size_t)vxm_rng_below(rng, n);
    for (size_t k = 0; k < n; k++)
      turned[k] = corner[(first + (back ? n - k : k)) % n];
    shape_face(soup, turned, n);
  }
  return soup;
}

enum { VOXELS = 26 };

static const vxm_space bent_space = {{VOXELS, VOXELS, VOXELS}, {-6.5, -6.5, -6.5}, {0.5, 0.5, 0.5}};

/** What voxels are asked for: centres, all that the surface meets, thin parts by both rules. */
enum { CENTRES, SURFACE, THIN, THIN26, KINDS };

static vxm_grid *bent_grid(const vxm_soup *soup, int kind) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  if (kind == SURFACE)
    options.mode = VXM_MODE_SURFACE;
  else
    options.thin = kind == CENTRES ? VXM_THIN_DROP : kind == THIN ? VXM_THIN_KEEP : VXM_THIN_KEEP26;
  return engine_solid(soup, &bent_space, &options, NULL);
}

static void assert_turned(const vxm_grid *grid, const vxm_grid *turned, const symmetry *s) {
  int64_t v[3];
  for (v[0] = 0; v[0] < VOXELS; v[0]++)
    for (v[1] = 0; v[1] < VOXELS; v[1]++)
      for (v[2] = 0; v[2] < VOXELS; v[2]++) {
        int64_t was[3];
        for (int a = 0; a < 3; a++)
          was[s->from[a]] = s->mirrored[a] ? VOXELS - 1 - v[a] : v[a];
        if (vxm_grid_get(turned, v[0], v[1], v[2]) != vxm_grid_get(grid, was[0], was[1], was[2]))
          fail_msg("voxel %d %d %d differs", (int)was[0], (int)was[1], (int)was[2]);
      }
}

/** A mesh that is turned by right angles, or mirrored, has its voxels turned or mirrored. */
static void test_symmetries(void **state) {
  (void)state;
  vxm_rng rng = {604};
  for (int round = 0; round < ROUNDS(6); round++) {
    vxm_soup *body = bent_body(&rng, round % 3 ? 1 : 0.3, round % 2);
    for (int kind = 0; kind <= THIN; kind++) {
      vxm_grid *grid = bent_grid(body, kind);
      assert_true(vxm_grid_count(grid) > 1000);
      for (int number = 1; number < 48; number++) {
        symmetry s = symmetry_of(number);
        vxm_soup *soup = turned_body(body, &rng, &s);
        vxm_grid *turned = bent_grid(soup, kind);
        assert_turned(grid, turned, &s);
        vxm_grid_destroy(turned);
        vxm_soup_destroy(soup);
      }
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(body);
  }
}

/** What a mesh is split into has the same voxels; and it matters along which diagonals. */
static void test_split(void **state) {
  (void)state;
  vxm_rng rng = {605};
  int64_t others = 0;
  for (int round = 0; round < ROUNDS(30); round++) {
    vxm_soup *body = bent_body(&rng, round % 3 ? 1 : 0.3, round % 2), *split, *fans = shape_empty(context);
    assert_int_equal(vxm_mesh_triangulate(&split, body, NULL), VXM_OK);
    for (size_t v = 0; v < body->vertex_count; v++)
      shape_vertex(fans, body->positions[3 * v], body->positions[3 * v + 1], body->positions[3 * v + 2]);
    for (size_t f = 0, n; f < body->face_count; f++) {
      const uint32_t *corner = vxm_face(body, f, &n);
      for (size_t k = 1; k + 1 < n; k++)
        shape_triangle(fans, corner[0], corner[k], corner[k + 1]);
    }
    for (int kind = 0; kind < KINDS; kind++) {
      vxm_grid *grid = bent_grid(body, kind), *after = bent_grid(split, kind), *other = bent_grid(fans, kind);
      assert_equal_bits(grid, after);
      others += memcmp(grid->words, other->words, grid->word_count * sizeof *grid->words) != 0;
      vxm_grid_destroy(grid);
      vxm_grid_destroy(after);
      vxm_grid_destroy(other);
    }
    vxm_soup_destroy(fans);
    vxm_soup_destroy(split);
    vxm_soup_destroy(body);
  }
  assert_true(others > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_voxels),
      cmocka_unit_test(test_symmetries),
      cmocka_unit_test(test_split),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
