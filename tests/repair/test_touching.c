/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids that touch themselves, with their cavities or from outside: made manifold, and closed, they are the
 * same solids. */
#include "../base/rounds.h"
#include "solids.h"

#include "repair/repair.h"
#include "repair_test.h"

enum { POINTS_MAX = 16, PROBES = 12 };

typedef struct cloud {
  double p[POINTS_MAX][3];
  uint32_t count;
} cloud;

/* ---- Hulls ---- */

static void add_point(cloud *c, const double p[3]) {
  assert_true(c->count < POINTS_MAX);
  memcpy(c->p[c->count++], p, sizeof *c->p);
}

/** A random point within a sphere about `middle`, or on it. */
static void add_random(cloud *c, const double middle[3], double radius, bool on_it, vxm_rng *rng) {
  double p[3], length;
  do {
    length = 0;
    for (int a = 0; a < 3; a++) {
      p[a] = 2 * vxm_rng_unit(rng) - 1;
      length += p[a] * p[a];
    }
  } while (length > 1 || length < 0.01);
  double scale = on_it ? radius / sqrt(length) : radius;
  for (int a = 0; a < 3; a++)
    p[a] = middle[a] + scale * p[a];
  add_point(c, p);
}

/** On which side of the plane through three points a fourth one lies. */
static double side_of(const cloud *c, uint32_t i, uint32_t j, uint32_t k, uint32_t l) {
  vxm_vec3 u = vxm_vec3_between(c->p[j], c->p[i], 1), v = vxm_vec3_between(c->p[k], c->p[i], 1);
  return vxm_vec3_dot(vxm_vec3_cross(u, v), vxm_vec3_between(c->p[l], c->p[i], 1));
}

static bool is_on_hull(const cloud *c, uint32_t i, uint32_t j, uint32_t k) {
  for (uint32_t l = 0; l < c->count; l++)
    if (l != i && l != j && l != k && side_of(c, i, j, k, l) > 0)
      return false;
  return true;
}

/** The faces of the hull of points, no four of which lie in a plane: all triangles are tried. */
static void add_hull(vxm_soup *soup, const cloud *c, bool inward) {
  uint32_t first = (uint32_t)soup->vertex_count;
  size_t face = soup->face_count;
  for (uint32_t i = 0; i < c->count; i++)
    add_vertex(soup, c->p[i][0], c->p[i][1], c->p[i][2]);
  for (uint32_t i = 0; i < c->count; i++)
    for (uint32_t j = i + 1; j < c->count; j++)
      for (uint32_t k = j + 1; k < c->count; k++)
        for (int turned = 0; turned < 2; turned++)
          if (is_on_hull(c, i, turned ? k : j, turned ? j : k))
            add_triangle(soup, first + i, first + (turned ? k : j), first + (turned ? j : k));
  if (inward)
    turn_faces(soup, face);
}

/** As the hull, but dented so that of it only the points themselves are left. */
static void add_star(vxm_soup *soup, const cloud *c, bool inward) {
  static const double depth[3] = {0, 0.5, 0.3}; /* of edges and of faces */
  vxm_soup *hull = new_soup(soup->context);
  add_hull(hull, c, inward);
  for (size_t f = 0; f < hull->face_count; f++) {
    uint32_t v[7], first = (uint32_t)soup->vertex_count;
    double p[7][3] = {{0}};
    for (int i = 0; i < 3; i++)
      for (int a = 0; a < 3; a++) {
        double x = vxm_position(hull, hull->indices[3 * f + (size_t)i])[a];
        p[i][a] = x;
        p[3 + i][a] += depth[1] * x / 2;
        p[3 + (i + 2) % 3][a] += depth[1] * x / 2;
        p[6][a] += depth[2] * x / 3;
      }
    for (uint32_t i = 0; i < 7; i++) {
      add_vertex(soup, p[i][0], p[i][1], p[i][2]);
      v[i] = first + i;
    }
    for (int i = 0; i < 3; i++) {
      add_triangle(soup, v[i], v[3 + i], v[6]);
      add_triangle(soup, v[3 + i], v[(i + 1) % 3], v[6]);
    }
  }
  vxm_soup_destroy(hull);
}

/* ---- What must hold ---- */

static vxm_soup *reversed(const vxm_soup *soup) {
  vxm_soup *out;
  assert_int_equal(vxm_soup_copy(&out, soup, NULL), VXM_OK);
  turn_faces(out, 0);
  return out;
}

/** The windings round random points in the box of a soup whose middle is 0. */
static void probe(const vxm_soup *soup, double half, int windings[PROBES]) {
  vxm_rng rng = {77};
  for (int i = 0; i < PROBES; i++) {
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] = half * (2 * vxm_rng_unit(&rng) - 1);
    windings[i] = (int)rint(winding_at(soup, p));
  }
}

/** `solid` is what it should be, which is none but closed. */
static void check_level(const vxm_soup *in, const vxm_soup *solid, vxm_level level, bool single,
                        double half) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  options.level = level;
  options.single_precision = single;
  vxm_soup *out = repaired(in, &options, &report);
  double volume = volume_of(solid);
  if (!(fabs(volume_of(out) - volume) < 1e-4 * half * half * half))
    fail_msg("a volume of %g became %g", volume, volume_of(out));
  int before[PROBES], after[PROBES];
  probe(solid, half, before);
  probe(out, half, after);
  assert_memory_equal(before, after, sizeof before);
  assert_int_equal(count_of(&report, "orientation"), in == solid ? 0 : (int64_t)in->face_count);
  weld_positions(out);
  assert_closed_manifold(out);
  assert_repair_is_done(out, &options);
  vxm_soup_destroy(out);
}

static void check(const vxm_soup *soup, double half) {
  vxm_soup *inside_out = reversed(soup);
  for (int single = 0; single < 2; single++)
    for (int level = VXM_LEVEL_MANIFOLD; level <= VXM_LEVEL_CLOSED; level++) {
      check_level(soup, soup, (vxm_level)level, single, half);
      check_level(inside_out, soup, (vxm_level)level, single, half);
    }
  vxm_soup_destroy(inside_out);
}

/* ---- Hulls with cavities that touch them, or each other ---- */

typedef enum touching {
  AT_A_VERTEX,
  AT_AN_EDGE,
  AT_TWO_VERTICES,
  AT_ALL_VERTICES,
  SHRUNK_TO_A_VERTEX,
  ISLAND_AT_A_VERTEX,
  ISLAND_AT_AN_EDGE,
  KINDS
} touching;

/** Some corners of the hull of one that was added, and points about a middle. */
static cloud cavity_at(const cloud *around, const uint32_t *corners, int count, const double middle[3],
                       double radius, vxm_rng *rng) {
  cloud c = {.count = 0};
  for (int i = 0; i < count; i++)
    add_point(&c, around->p[corners[i]]);
  for (int i = 0; i < 5; i++)
    add_random(&c, middle, radius, true, rng);
  return c;
}

/** A random edge of the hull, in triangles from face `first` on, whose vertices are from `vertex` on. */
static void random_edge(const vxm_soup *soup, size_t first, uint32_t vertex, uint32_t edge[2], vxm_rng *rng) {
  size_t face = first + (size_t)vxm_rng_below(rng, soup->face_count - first);
  for (int i = 0; i < 2; i++)
    edge[i] = soup->indices[3 * face + (size_t)i] - vertex;
}

static uint32_t farthest_from(const cloud *c, uint32_t from) {
  uint32_t best = from;
  double most = 0;
  for (uint32_t i = 0; i < c->count; i++) {
    double length = vxm_vec3_length(vxm_vec3_between(c->p[i], c->p[from], 1));
    if (length > most) {
      most = length;
      best = i;
    }
  }
  return best;
}

static void add_island(vxm_soup *soup, int corners, const double middle[3], vxm_rng *rng) {
  cloud cavity = {.count = 0};
  uint32_t vertex = (uint32_t)soup->vertex_count, edge[2];
  size_t face = soup->face_count;
  for (int i = 0; i < 10; i++)
    add_random(&cavity, middle, 2.5, true, rng);
  add_hull(soup, &cavity, true);
  random_edge(soup, face, vertex, edge, rng);
  cloud island = cavity_at(&cavity, edge, corners, middle, 0.3, rng);
  add_hull(soup, &island, false);
}

/** About 0, and of radius 10. */
static vxm_soup *random_touching(touching kind, vxm_rng *rng) {
  vxm_soup *soup = new_soup(context);
  static const double middle[3] = {0, 0, 0};
  /* the corners of a tetrahedron are there always, so that the middle is within */
  cloud hull = {{{6, 5.5, 6.2}, {-6.1, -5.6, 5.9}, {-5.8, 6, -5.7}, {5.6, -6.1, -6}}, 4};
  for (uint64_t more = kind == AT_ALL_VERTICES ? 0 : vxm_rng_below(rng, 9); more > 0; more--)
    add_random(&hull, middle, 10, true, rng);
  add_hull(soup, &hull, false);
  uint32_t corners[2];
  random_edge(soup, 0, 0, corners, rng);
  if (kind == AT_TWO_VERTICES)
    corners[1] = farthest_from(&hull, corners[0]);
  if (kind == ISLAND_AT_A_VERTEX || kind == ISLAND_AT_AN_EDGE)
    add_island(soup, kind == ISLAND_AT_A_VERTEX ? 1 : 2, middle, rng);
  else if (kind == AT_ALL_VERTICES)
    add_star(soup, &hull, true);
  else if (kind == SHRUNK_TO_A_VERTEX) {
    double size = 0.2 + 0.5 * vxm_rng_unit(rng);
    cloud shrunk = hull;
    for (uint32_t i = 0; i < hull.count; i++)
      for (int a = 0; a < 3; a++)
        shrunk.p[i][a] += (1 - size) * (hull.p[corners[0]][a] - hull.p[i][a]);
    memcpy(shrunk.p[corners[0]], hull.p[corners[0]], sizeof *shrunk.p);
    add_hull(soup, &shrunk, true);
  } else {
    cloud cavity = cavity_at(&hull, corners, kind == AT_A_VERTEX ? 1 : 2, middle, 1, rng);
    add_hull(soup, &cavity, true);
  }
  weld_positions(soup);
  return soup;
}

static void cavities_that_touch(void **state) {
  (void)state;
  vxm_rng rng = {4};
  for (int round = 0; round < ROUNDS(140); round++) {
    vxm_soup *soup = random_touching((touching)(round % KINDS), &rng);
    assert_true(volume_of(soup) > 0);
    check(soup, 10);
    vxm_soup_destroy(soup);
  }
}

/** A spindle between two corners of a cube has the cube's box. */
static void a_cavity_with_the_box_of_its_body(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  add_box(soup, low, high, &upright, true, false);
  static const double ring[3][3] = {{0.2, -0.1, -0.1}, {-0.1, 0.2, -0.1}, {-0.1, -0.1, 0.2}};
  for (uint32_t i = 0; i < 3; i++)
    add_vertex(soup, ring[i][0], ring[i][1], ring[i][2]);
  for (uint32_t i = 0; i < 3; i++) {
    add_triangle(soup, 0, 8 + i, 8 + (i + 1) % 3);
    add_triangle(soup, 7, 8 + (i + 1) % 3, 8 + i);
  }
  assert_true(volume_of(soup) < 8 && volume_of(soup) > 7);
  check(soup, 1);
  vxm_soup_destroy(soup);
}

/* ---- Cells ---- */

/** The surface of cells that are full or not at random, as triangles in random order, about 0; *count: of
 * full ones. */
static vxm_soup *random_cells(unsigned n, const frame3 *frame, vxm_rng *rng, size_t *count) {
  uint8_t full[125] = {0};
  double part = 0.3 + 0.6 * vxm_rng_unit(rng);
  *count = 0;
  for (unsigned i = 0; i < n * n * n; i++)
    *count += full[i] = vxm_rng_unit(rng) < part;
  vxm_soup *cells = cell_surface(context, n, full), *mixed = shuffled(cells, rng, 0, true);
  vxm_soup *out = new_soup(context);
  for (size_t v = 0; v < mixed->vertex_count; v++) {
    const double *p = vxm_position(mixed, v);
    add_framed(out, frame, p[0] - n / 2.0, p[1] - n / 2.0, p[2] - n / 2.0);
  }
  for (size_t f = 0; f < mixed->face_count; f++)
    add_face(out, mixed->indices + mixed->offsets[f], 3);
  vxm_soup_destroy(mixed);
  vxm_soup_destroy(cells);
  return out;
}

/** Blocks of cells touch themselves along many edges and at many vertices. */
static void blocks_of_cells(void **state) {
  (void)state;
  vxm_rng rng = {9};
  for (int round = 0; round < ROUNDS(60); round++) {
    unsigned n = 3 + (unsigned)vxm_rng_below(&rng, 3);
    size_t count;
    frame3 frame = round % 2 ? random_frame(&rng) : upright;
    vxm_soup *soup = random_cells(n, &frame, &rng, &count);
    assert_true(fabs(volume_of(soup) - (double)count) < 1e-9);
    check(soup, n);
    vxm_soup_destroy(soup);
  }
}

/** Blocks that overlap, and share edges and vertices, keep their volume and what they wind round when they
 * are cut apart. */
static void overlapping_blocks(void **state) {
  (void)state;
  vxm_rng rng = {12};
  int checked = 0;
  for (int round = 0; round < ROUNDS(60); round++) {
    unsigned n = 3 + (unsigned)vxm_rng_below(&rng, 3);
    vxm_soup *soup = new_soup(context);
    for (int block = 0; block < 2 + round % 2; block++) {
      size_t count;
      vxm_soup *one = random_cells(n, &upright, &rng, &count);
      uint32_t first = (uint32_t)soup->vertex_count;
      for (size_t v = 0; v < one->vertex_count; v++)
        add_vertex(soup, vxm_position(one, v)[0], vxm_position(one, v)[1], vxm_position(one, v)[2]);
      for (size_t f = 0; f < one->face_count; f++)
        add_triangle(soup, first + one->indices[3 * f], first + one->indices[3 * f + 1],
                     first + one->indices[3 * f + 2]);
      vxm_soup_destroy(one);
    }
    weld_positions(soup);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    options.level = VXM_LEVEL_CLEAN;
    vxm_soup *clean = repaired(soup, &options, &report);
    /* what repeats is gone; seldom a cavity is the only patch that is closed by itself, and is turned already
     */
    if (count_of(&report, "orientation") == 0) {
      for (int level = VXM_LEVEL_MANIFOLD; level <= VXM_LEVEL_CLOSED; level++)
        check_level(clean, clean, (vxm_level)level, round % 2 == 0, n);
      checked++;
    }
    vxm_soup_destroy(clean);
    vxm_soup_destroy(soup);
  }
  assert_true(checked >= ROUNDS(60) * 9 / 10);
}

/** Bodies, or voids in a block, that share whole faces: however often each was drawn, they are what they are
 * once.
 */
static void drawn_several_times(void **state) {
  (void)state;
  vxm_rng rng = {73};
  for (int round = 0; round < 60; round++) {
    int cells[3][3], count = 2 + round / 2 % 2, order[9], drawn = 0;
    bool voids = round % 2;
    for (int a = 0; a < 3; a++)
      cells[0][a] = 2 + (int)vxm_rng_below(&rng, 3);
    for (int c = 1; c < count; c++) { /* beside the first one, at sides of it that differ */
      memcpy(cells[c], cells[0], sizeof *cells);
      cells[c][(round + c) % 3] += vxm_rng_below(&rng, 2) ? 1 : -1;
    }
    for (int c = 0; c < count; c++)
      for (int copies = 1 + (int)vxm_rng_below(&rng, count == 2 ? 3 : 2); copies > 0; copies--)
        order[drawn++] = c;
    for (int i = drawn - 1; i > 0; i--) {
      int other = (int)vxm_rng_below(&rng, (uint64_t)i + 1), kept = order[i];
      order[i] = order[other];
      order[other] = kept;
    }
    vxm_soup *soup = new_soup(context);
    if (voids)
      add_cuboid(soup, 0, 0, 0, 8, 8, 8);
    for (int i = 0; i < drawn; i++) {
      const int *c = cells[order[i]];
      (voids ? add_hollow : add_cuboid)(soup, c[0], c[1], c[2], c[0] + 1, c[1] + 1, c[2] + 1);
    }
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_soup *clean = repaired(soup, &options, NULL);
    assert_true(fabs(volume_of(clean) - (voids ? 512 - count : count)) < 1e-9);
    vxm_soup_destroy(clean);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cavities_that_touch), cmocka_unit_test(a_cavity_with_the_box_of_its_body),
      cmocka_unit_test(blocks_of_cells),     cmocka_unit_test(overlapping_blocks),
      cmocka_unit_test(drawn_several_times),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
