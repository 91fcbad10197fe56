/* SPDX-License-Identifier: BSD-3-Clause */
/** Orientation of faces. */
#include "../base/rounds.h"
#include "repair_test.h"

#include "../mesh/shared.h"

#include "base/hash.h"
#include "mesh/edges.h"

#include <math.h>

static void reverse_face(vxm_soup *soup, size_t face) {
  size_t count;
  uint32_t *corner = soup->indices + soup->offsets[face];
  vxm_face(soup, face, &count);
  for (size_t i = 1, j = count - 1; i < j; i++, j--) {
    uint32_t kept = corner[i];
    corner[i] = corner[j];
    corner[j] = kept;
  }
}

static size_t flip_some(vxm_soup *soup, double part, uint64_t seed) {
  vxm_rng rng = {seed};
  size_t flipped = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    if (vxm_rng_unit(&rng) < part) {
      reverse_face(soup, f);
      flipped++;
    }
  return flipped;
}

/** The same faces, each as it is in the other soup or reversed. */
static void check_only_turned(const vxm_soup *in, const vxm_soup *out, int64_t turned) {
  assert_int_equal(in->face_count, out->face_count);
  assert_int_equal(in->vertex_count, out->vertex_count);
  assert_memory_equal(in->offsets, out->offsets, (in->face_count + 1) * sizeof *in->offsets);
  assert_memory_equal(in->positions, out->positions, 3 * in->vertex_count * sizeof *in->positions);
  int64_t found = 0;
  for (size_t f = 0; f < in->face_count; f++) {
    size_t count;
    const uint32_t *p = vxm_face(in, f, &count), *q = vxm_face(out, f, &count);
    bool same = true, reversed = true;
    for (size_t c = 0; c < count; c++) {
      same &= p[c] == q[c];
      reversed &= p[(count - c) % count] == q[c];
    }
    assert_true(same || reversed);
    found += !same;
  }
  assert_int_equal(found, turned);
}

/** Repairs a soup that needs no other repair. */
static vxm_soup *oriented(const vxm_soup *soup, vxm_repair_report *report) {
  vxm_soup *out = repaired(soup, NULL, report);
  check_only_turned(soup, out, count_of(report, "orientation"));
  assert_repair_is_done(out, NULL);
  return out;
}

static void add_box(vxm_soup *soup, double x, double y, double z, double half, bool inward) {
  size_t first = soup->vertex_count, face = soup->face_count;
  add_cube(soup, 0);
  for (size_t v = first; v < soup->vertex_count; v++) {
    double *p = soup->positions + 3 * v;
    p[0] = x + (2 * p[0] - 1) * half;
    p[1] = y + (2 * p[1] - 1) * half;
    p[2] = z + (2 * p[2] - 1) * half;
  }
  for (; inward && face < soup->face_count; face++)
    reverse_face(soup, face);
}

/** Signed volume of the faces from `begin` on. */
static double volume_of(const vxm_soup *soup, size_t begin, size_t end) {
  double sum = 0;
  for (size_t f = begin; f < end; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    const double *a = vxm_position(soup, corner[0]);
    for (size_t c = 2; c < count; c++) {
      const double *p = vxm_position(soup, corner[c - 1]), *q = vxm_position(soup, corner[c]);
      sum += (a[0] * (p[1] * q[2] - p[2] * q[1]) + a[1] * (p[2] * q[0] - p[0] * q[2]) +
              a[2] * (p[0] * q[1] - p[1] * q[0])) /
             6;
    }
  }
  return sum;
}

static void boxes_turn_outward(void **state) {
  for (int mask = 0; mask < 64; mask++) {
    vxm_soup *soup = new_soup(*state);
    add_cube(soup, 3);
    for (int f = 0; f < 6; f++)
      if (mask >> f & 1)
        reverse_face(soup, (size_t)f);
    REPAIR_REPORT(report);
    vxm_soup *out = oriented(soup, &report);
    assert_int_equal(report.after->inconsistent_edges, 0);
    assert_true(fabs(report.after->volume - 1) < 1e-12);
    assert_int_equal(count_of(&report, "orientation"), __builtin_popcount((unsigned)mask));
    assert_int_equal(report.nonorientable_patches, 0);
    vxm_soup_destroy(out);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.keep_orientation = true;
    out = repaired(soup, &options, &report);
    check_only_turned(soup, out, 0);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** Boxes in boxes: inward is in the end where fewer wind round the points within than round those without. */
static void cavities_stay(void **state) {
  enum { LEVELS = 4 };
  for (int mask = 0; mask < 1 << LEVELS; mask++)
    for (int flips = 0; flips < 2; flips++) {
      vxm_soup *soup = new_soup(*state);
      for (int i = 0; i < LEVELS; i++)
        add_box(soup, 2, 1, 0, 1.0 / (1 + i), mask >> i & 1);
      if (flips) /* one face of six in each box */
        for (int i = 0; i < LEVELS; i++)
          reverse_face(soup, (size_t)(6 * i + (mask + i) % 6));
      REPAIR_REPORT(report);
      vxm_soup *out = oriented(soup, &report);
      assert_int_equal(report.after->inconsistent_edges, 0);
      int winding = 0;
      for (int i = 0; i < LEVELS; i++) {
        int without = abs(winding);
        winding += mask >> i & 1 ? -1 : 1;
        bool wanted = abs(winding) < without; /* inward */
        double volume = volume_of(out, 6 * (size_t)i, 6 * (size_t)i + 6);
        assert_true(wanted ? volume < 0 : volume > 0);
      }
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
}

/** Two boxes along a diagonal share an edge with four sides: each is a body of its own. */
static void boxes_that_share_an_edge(void **state) {
  for (int mask = 0; mask < 4; mask++) {
    vxm_soup *soup = new_soup(*state);
    add_box(soup, 0, 0, 0, 1, mask & 1);
    add_box(soup, 2, 2, 0, 1, mask >> 1);
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, NULL, &report);
    assert_int_equal(report.after->nonmanifold_edges, 1);
    assert_true(fabs(report.after->volume - 16) < 1e-9);
    assert_repair_is_done(out, NULL);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void sheets_keep_their_side(void **state) {
  for (int side = 0; side < 2; side++)
    for (int round = 0; round < 5; round++) {
      vxm_soup *soup = grid_sheet(*state, 12);
      flip_some(soup, side ? 0.7 : 0.3, (uint64_t)round);
      REPAIR_REPORT(report);
      vxm_soup *out = oriented(soup, &report);
      assert_int_equal(report.after->inconsistent_edges, 0);
      /* counter-clockwise from above before the flips */
      const double *a = vxm_position(out, out->indices[0]), *b = vxm_position(out, out->indices[1]);
      const double *c = vxm_position(out, out->indices[2]);
      double z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      assert_true(side ? z < 0 : z > 0);
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
}

/** A band of quadrilaterals with half a twist: consistent but for one seam. */
static void moebius_bands_are_reported(void **state) {
  enum { N = 40 };
  vxm_soup *soup = new_soup(*state);
  for (int i = 0; i < N; i++)
    for (int side = -1; side <= 1; side += 2) {
      double u = 2 * M_PI * i / N, w = 0.3 * side;
      add_vertex(soup, (1 + w * cos(u / 2)) * cos(u), (1 + w * cos(u / 2)) * sin(u), w * sin(u / 2));
    }
  for (uint32_t i = 0; i < N; i++) {
    uint32_t j = (i + 1) % N, swap = i + 1 == N;
    uint32_t quad[4] = {2 * i, 2 * i + 1, 2 * j + (swap ? 0 : 1), 2 * j + (swap ? 1 : 0)};
    add_face(soup, quad, 4);
  }
  add_cube(soup, 5);
  for (int round = 0; round < 3; round++) {
    REPAIR_REPORT(report);
    vxm_soup *out = oriented(soup, &report);
    assert_int_equal(report.nonorientable_patches, 1);
    assert_int_equal(report.after->inconsistent_edges, 1);
    if (round == 0) /* it has the fewest possible already */
      assert_int_equal(count_of(&report, "orientation"), 0);
    vxm_soup_destroy(out);
    flip_some(soup, 0.4, (uint64_t)round);
  }
  vxm_soup_destroy(soup);
}

/** Puts the faces of a soup of equal faces into a random order. */
static void shuffle_faces(vxm_soup *soup, size_t corners, vxm_rng *rng) {
  for (size_t f = soup->face_count - 1; f > 0; f--)
    for (size_t k = 0, g = vxm_rng_below(rng, f + 1); k < corners; k++) {
      uint32_t kept = soup->indices[corners * f + k];
      soup->indices[corners * f + k] = soup->indices[corners * g + k];
      soup->indices[corners * g + k] = kept;
    }
}

/** The same whatever the order of faces, but not if one is turned. */
static uint64_t sum_of_sides(const vxm_soup *soup) {
  uint64_t sum = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++)
      sum += vxm_mix((uint64_t)corner[i] << 32 | corner[(i + 1) % count]);
  }
  return sum;
}

/** A bent band on a wall that runs along its middle, drawn from both sides: which of two faces stays, and
 * which way patches face that have no side, hangs on where they lie. */
static void numbers_decide_nothing(void **state) {
  enum { N = 8 };
  vxm_rng rng = {31};
  vxm_soup *soup = new_soup(*state);
  for (int i = 0; i <= N; i++)
    for (int k = 0; k < 4; k++)
      add_vertex(soup, i, k < 3 ? k : 1, k < 3 ? 0.1 * i * k : -2);
  for (uint32_t i = 0; i < N; i++)
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t p = 4 * i + (k < 2 ? k : 1), q = 4 * i + (k < 2 ? k + 1 : 3);
      add_face(soup, (uint32_t[]){p, q, q + 4, p + 4}, 4);
      add_face(soup, (uint32_t[]){p + 4, q + 4, q, p}, 4);
    }
  uint64_t expected = 0;
  for (int round = 0; round < 20; round++) {
    vxm_soup *out = repaired(soup, NULL, NULL);
    assert_int_equal(out->face_count, 3 * N);
    if (round == 0)
      expected = sum_of_sides(out);
    assert_int_equal(sum_of_sides(out), expected);
    vxm_soup_destroy(out);
    shuffle_faces(soup, 4, &rng);
  }
  vxm_soup_destroy(soup);
}

/** A net on a Moebius band, of edges of many lengths: where it stays inconsistent does not hang on the face
 * with which a walk begins. */
static void moebius_nets_are_cut_alike(void **state) {
  enum { N = 20, ROWS = 3 };
  vxm_rng rng = {32};
  vxm_soup *soup = new_soup(*state);
  for (int i = 0; i < N; i++)
    for (int k = 0; k <= ROWS; k++) {
      double u = 2 * M_PI * i / N, w = 0.2 * (2 * k - ROWS) + 0.1 * vxm_rng_unit(&rng);
      add_vertex(soup, (2 + w * cos(u / 2)) * cos(u), (2 + w * cos(u / 2)) * sin(u), w * sin(u / 2));
    }
  for (uint32_t i = 0; i < N; i++)
    for (uint32_t k = 0; k < ROWS; k++) {
      uint32_t j = (i + 1) % N, first = (ROWS + 1) * i + k, other = (ROWS + 1) * j;
      bool swap = j == 0;
      add_face(soup,
               (uint32_t[]){first, first + 1, other + (swap ? ROWS - k - 1 : k + 1),
                            other + (swap ? ROWS - k : k)},
               4);
    }
  uint64_t expected = 0;
  for (size_t f = 0; f < soup->face_count / 3; f++)
    reverse_face(soup, f);
  for (int round = 0; round < 20; round++) {
    vxm_soup *out = repaired(soup, NULL, NULL);
    if (round == 0)
      expected = sum_of_sides(out);
    assert_int_equal(sum_of_sides(out), expected);
    vxm_soup_destroy(out);
    shuffle_faces(soup, 4, &rng);
  }
  vxm_soup_destroy(soup);
}

/** Against brute force: a patch is orientable if some turning of its faces makes it consistent. */
static void small_random_soups(void **state) {
  vxm_rng rng = {6};
  int orientable = 0, others = 0;
  for (int round = 0; round < ROUNDS(3000); round++) {
    vxm_soup *soup = new_soup(*state);
    size_t vertices = 5 + (size_t)vxm_rng_below(&rng, 4), faces = 3 + (size_t)vxm_rng_below(&rng, 8);
    for (size_t v = 0; v < vertices; v++)
      add_vertex(soup, vxm_rng_unit(&rng), vxm_rng_unit(&rng), vxm_rng_unit(&rng));
    for (size_t f = 0; f < faces; f++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, vertices), b, c;
      do
        b = (uint32_t)vxm_rng_below(&rng, vertices);
      while (b == a);
      do
        c = (uint32_t)vxm_rng_below(&rng, vertices);
      while (c == a || c == b);
      add_triangle(soup, a, b, c);
    }
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, NULL, &report);
    assert_repair_is_done(out, NULL);
    size_t fewest = SIZE_MAX;
    for (unsigned mask = 0; mask < 1u << out->face_count; mask += 2) {
      int8_t along[9][9] = {{0}}, count[9][9] = {{0}};
      for (size_t f = 0; f < out->face_count; f++)
        for (size_t i = 0; i < 3; i++) {
          uint32_t p = out->indices[3 * f + i], q = out->indices[3 * f + (i + 1) % 3];
          int sign = (p < q) == (mask >> f & 1) ? 1 : -1;
          along[p < q ? p : q][p < q ? q : p] = (int8_t)(along[p < q ? p : q][p < q ? q : p] + sign);
          count[p < q ? p : q][p < q ? q : p]++;
        }
      size_t wrong = 0;
      for (int p = 0; p < 9; p++)
        for (int q = p + 1; q < 9; q++)
          wrong += count[p][q] == 2 && along[p][q] != 0;
      fewest = wrong < fewest ? wrong : fewest;
    }
    if (out->face_count > 0) {
      assert_int_equal(fewest == 0, report.after->inconsistent_edges == 0);
      assert_int_equal(fewest == 0, report.nonorientable_patches == 0);
      orientable += fewest == 0;
      others += fewest != 0;
    }
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  print_message("%d orientable, %d not\n", orientable, others);
  assert_true(orientable > ROUNDS(100) && others > ROUNDS(10));
}

static void flip_real_mesh(const shared_mesh *mesh, void *payload) {
  int *count = payload;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = read_soup(context, mesh->path);
  if (soup->face_count < 60000) {
    REPAIR_REPORT(report);
    REPAIR_REPORT(again);
    vxm_soup *clean = repaired(soup, NULL, &report);
    if (report.after->closed && report.after->nonmanifold_edges == 0 && report.nonorientable_patches == 0) {
      vxm_soup *flipped;
      assert_int_equal(vxm_soup_copy(&flipped, clean, NULL), VXM_OK);
      size_t flips = flip_some(flipped, 0.3, 1);
      vxm_soup *out = oriented(flipped, &again);
      assert_int_equal(again.after->inconsistent_edges, 0);
      if (memcmp(out->indices, clean->indices, clean->corner_count * sizeof *clean->indices) == 0)
        assert_int_equal(count_of(&again, "orientation"), flips);
      else
        print_message("%s: not as it was; volume %g, was %g\n", mesh->values[0], again.after->volume,
                      report.after->volume);
      count[0]++;
      count[1] += memcmp(out->indices, clean->indices, clean->corner_count * sizeof *clean->indices) == 0;
      vxm_soup_destroy(out);
      vxm_soup_destroy(flipped);
    }
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** A mesh of which every edge is in balance encloses a volume that is there to stay, but for its sign. */
static void balanced_mesh_stays_balanced(const shared_mesh *mesh, void *payload) {
  int *count = payload;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = read_soup(context, mesh->path), *clean, *out;
  if (soup->face_count < 30000) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.keep_orientation = true;
    vxm_edges edges;
    clean = repaired(soup, &options, NULL);
    out = repaired(clean, NULL, NULL);
    bool balanced = true;
    assert_int_equal(vxm_edges_build(&edges, context, clean, NULL, NULL), VXM_OK);
    for (size_t e = 0; e < edges.count; e++)
      balanced &= 2 * edges.edges[e].forward == edges.edges[e].count;
    vxm_edges_destroy(&edges);
    assert_int_equal(vxm_edges_build(&edges, context, out, NULL, NULL), VXM_OK);
    for (size_t e = 0; e < edges.count && balanced; e++)
      assert_int_equal(2 * edges.edges[e].forward, edges.edges[e].count);
    vxm_edges_destroy(&edges);
    *count += balanced;
    vxm_soup_destroy(out);
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void balance_is_kept(void **state) {
  (void)state;
  int count = 0;
  if (for_each_shared_mesh(balanced_mesh_stays_balanced, &count) == 0)
    skip();
  print_message("%d meshes are in balance\n", count);
  assert_true(count > 30);
}

/** Closed meshes of which 30 % of the faces are turned come back as they were. */
static void real_meshes(void **state) {
  (void)state;
  int count[2] = {0};
  if (for_each_shared_mesh(flip_real_mesh, count) == 0)
    skip();
  print_message("%d of %d closed meshes come back as they were\n", count[1], count[0]);
  assert_true(100 * count[1] >= 95 * count[0]);
}

/* ---- All faces the other way ---- */

static bool is_turned(const vxm_soup *soup, const vxm_soup *other, size_t face) {
  size_t count, at = 0;
  const uint32_t *p = vxm_face(soup, face, &count), *q = vxm_face(other, face, &count);
  while (q[at] != p[0])
    at++;
  bool same = true, turned = true;
  for (size_t c = 0; c < count; c++) {
    same &= q[(at + c) % count] == p[c];
    turned &= q[(at + count - c) % count] == p[c];
  }
  assert_true(same != turned);
  return turned;
}

typedef enum likeness { SAME, REVERSED, MIXED } likeness;

/** Repairs a soup and its reverse, without what cuts faces apart, and compares: they differ in all faces,
 * where nothing tells outside from inside, in none, or in some, where little bounds a volume. */
static likeness check_reversed(const vxm_soup *soup) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLEAN;
  options.keep_duplicates = true; /* which of two doubled faces stays, the file's order tells */
  vxm_soup *reversed;
  assert_int_equal(vxm_soup_copy(&reversed, soup, NULL), VXM_OK);
  for (size_t f = 0; f < reversed->face_count; f++)
    reverse_face(reversed, f);
  vxm_soup *out = repaired(soup, &options, NULL), *other = repaired(reversed, &options, NULL);
  size_t turned = 0;
  assert_int_equal(out->face_count, other->face_count);
  for (size_t f = 0; f < out->face_count; f++)
    turned += is_turned(out, other, f);
  likeness found = turned == 0 ? SAME : turned == out->face_count ? REVERSED : MIXED;
  vxm_soup_destroy(other);
  vxm_soup_destroy(out);
  vxm_soup_destroy(reversed);
  return found;
}

/** Boxes, some inward, that share edges and have walls and fins: what has no side of its own goes with the
 * boxes. */
static void reversed_soups_come_out_alike(void **state) {
  vxm_rng rng = {11};
  for (int round = 0; round < ROUNDS(2000); round++) {
    vxm_soup *soup = new_soup(*state);
    size_t boxes = vxm_rng_below(&rng, 2) ? 3 : 1, fins = (size_t)vxm_rng_below(&rng, 4);
    for (size_t i = 0, cell = (size_t)vxm_rng_below(&rng, 8); i < boxes; i++, cell += 3) /* an odd number */
      add_box(soup, 2.0 * (double)(cell % 2), 2.0 * (double)(cell / 2 % 2), 2.0 * (double)(cell / 4 % 2), 1,
              vxm_rng_below(&rng, 2));
    for (size_t i = 0; i < fins; i++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, soup->vertex_count), b = (a + 1) % 8, c;
      if (a == b)
        continue;
      c = (uint32_t)soup->vertex_count;
      const double *at = vxm_position(soup, a); /* small, so that boxes are most of it */
      const double x = at[0], y = at[1], z = at[2];
      add_vertex(soup, x + vxm_rng_unit(&rng), y + vxm_rng_unit(&rng), z + vxm_rng_unit(&rng));
      add_triangle(soup, a, b, c);
    }
    assert_true(check_reversed(soup) != MIXED);
    vxm_soup_destroy(soup);
  }
}

/** A box that is inside out, and a wall of it that goes on as a sheet: both are turned, or neither. */
static void sheets_go_with_the_model(void **state) {
  for (int inward = 0; inward < 2; inward++) {
    vxm_soup *soup = new_soup(*state);
    add_box(soup, 0, 0, 0, 1, inward);
    uint32_t far = (uint32_t)soup->vertex_count;
    add_vertex(soup, 5, 0, 0);
    add_vertex(soup, 6, 0, 0);
    add_vertex(soup, 5, 1, 0);
    add_triangle(soup, far, far + (inward ? 2 : 1), far + (inward ? 1 : 2));
    vxm_soup *out = repaired(soup, NULL, NULL);
    const uint32_t *corner = out->indices + out->corner_count - 3;
    assert_true(volume_of(out, 0, out->face_count - 1) > 0);
    double turn = 0;
    for (int c = 0; c < 3; c++) {
      const double *p = vxm_position(out, corner[c]), *q = vxm_position(out, corner[(c + 1) % 3]);
      turn += p[0] * q[1] - p[1] * q[0];
    }
    assert_true(turn > 0);
    assert_int_equal(check_reversed(soup), SAME);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void reverse_real_mesh(const shared_mesh *mesh, void *payload) {
  int *count = payload;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = read_soup(context, mesh->path);
  if (soup->face_count < 20000) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = VXM_LEVEL_CLEAN;
    options.keep_orientation = true;
    vxm_soup *clean = repaired(soup, &options, NULL); /* which of two doubled faces is kept is not asked */
    count[check_reversed(clean)]++;
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void real_meshes_reversed(void **state) {
  (void)state;
  int count[3] = {0};
  if (for_each_shared_mesh(reverse_real_mesh, count) == 0)
    skip();
  print_message("%d meshes have an outside, %d have none, of %d little has\n", count[SAME], count[REVERSED],
                count[MIXED]);
  assert_true(count[SAME] >= count[REVERSED] && 10 * count[MIXED] <= count[SAME]);
}

static void memory_may_run_out(void **state) {
  (void)state;
  bool passed = false;
  for (uint64_t limit = 8000; !passed; limit += 300) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    options.memory_limit = limit;
    vxm_context *context;
    vxm_soup *soup = NULL, *out = NULL;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    if (vxm_soup_create(&soup, context, "arrays", NULL) == VXM_OK &&
        vxm_soup_reserve(soup, 32, 32, 128, NULL) == VXM_OK) {
      for (int i = 0; i < 4; i++)
        add_box(soup, 0, 0, 0, 1 + i, i % 2);
      flip_some(soup, 0.2, 1);
      vxm_status status = vxm_repair_run(&out, NULL, soup, NULL, NULL);
      passed = status == VXM_OK;
      assert_true(passed || status == VXM_ERROR_MEMORY_LIMIT);
    }
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_turn_outward),
      cmocka_unit_test(cavities_stay),
      cmocka_unit_test(boxes_that_share_an_edge),
      cmocka_unit_test(sheets_keep_their_side),
      cmocka_unit_test(moebius_bands_are_reported),
      cmocka_unit_test(numbers_decide_nothing),
      cmocka_unit_test(moebius_nets_are_cut_alike),
      cmocka_unit_test(small_random_soups),
      cmocka_unit_test(balance_is_kept),
      cmocka_unit_test(real_meshes),
      cmocka_unit_test(reversed_soups_come_out_alike),
      cmocka_unit_test(sheets_go_with_the_model),
      cmocka_unit_test(real_meshes_reversed),
      cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
