/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Winding numbers against the sum of all solid angles in doubles: chains and rests, numbers of closed chains,
 * the walk through cells, in windows, along any axis, by every build, for what is asked about.
 * VOXMEND_TEST_WINDING=1 looks at all meshes of the shared collection, at all voxels where they are small.
 */
#include "../base/rounds.h"
#include "shapes.h"

#include "meshes.h"
#include "voxel/winding/oriented_chain.h"
#include "voxel/winding/winding_exact.h"
#include "voxel/winding/winding_fill.h"
#include "voxel/winding/winding_walk.h"

#include <math.h>
#include <string.h>

/** A soup on a lattice, as it is oriented. */
typedef struct subject {
  vxm_triangle_set triangles;
  vxm_snapped_points placed;
  vxm_winding_chain chain;
  vxm_winding_mesh mesh;
  vxm_workspace workspace;
} subject;

static void begin(subject *s, const vxm_soup *soup, const vxm_space *space) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_split_rule rule = {VXM_SPLIT_MODE_WHOLE, VXM_CAVITIES_FILL, false};
  *s = (subject){.placed = {.context = context}, .workspace = vxm_workspace_of(context)};
  vxm_lattice lattice = vxm_lattice_of(space);
  if (vxm_triangle_set_create(&s->triangles, soup, rule, &error) != VXM_OK ||
      vxm_snapped_points_set(&s->placed, &s->triangles, &lattice, NULL, false, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_facings turns = {.context = context, .part_end = s->triangles.split.part_count};
  for (size_t p = 0; p < turns.part_end; p++)
    turns.count += s->triangles.parts[p].caps - s->triangles.parts[p].begin;
  turns.facing = calloc(turns.count + 1, 1);
  assert_int_equal(vxm_oriented_chain_create(&s->chain, &s->triangles, &turns, NULL), VXM_OK);
  free(turns.facing);
  s->mesh = vxm_winding_mesh_of(context);
}

static void end(subject *s) {
  vxm_winding_mesh_destroy(&s->mesh);
  vxm_winding_chain_destroy(&s->chain);
  vxm_workspace_destroy(&s->workspace);
  vxm_snapped_points_destroy(&s->placed);
  vxm_triangle_set_destroy(&s->triangles);
}

/** All voxels of a grid, in windows of so many slices in a layout. The caller frees. */
static uint64_t *fill(subject *s, vxm_layout layout, int64_t slices, const uint64_t *asked,
                      uint8_t *confidence) {
  const vxm_space *space = &s->placed.lattice.space;
  vxm_window all = vxm_window_of(space, layout, 0, space->dims[layout.slow]);
  uint64_t *words = calloc(all.slice_words * (size_t)all.slow_dim, sizeof *words);
  assert_int_equal(vxm_winding_mesh_place(&s->mesh, &s->chain, &s->placed, layout.fast, false, NULL), VXM_OK);
  for (int64_t at = 0; at < all.slow_dim; at += slices) {
    bool added = false;
    vxm_error error = VXM_ERROR_INIT;
    vxm_window window = vxm_window_of(space, layout, at, vxm_min(at + slices, all.slow_dim));
    size_t offset = (size_t)at * all.slice_words;
    window.words = words + offset;
    if (vxm_winding_fill(&s->mesh, &window, asked ? asked + offset : NULL, confidence, &s->workspace, &added,
                         &error) != VXM_OK)
      fail_msg("%s", error.text);
  }
  return words;
}

static bool bit_at(const uint64_t *words, const vxm_space *space, vxm_layout layout, const int64_t at[3]) {
  vxm_window all = vxm_window_of(space, layout, 0, 1);
  size_t row = (size_t)at[layout.slow] * all.slice_words + (size_t)at[layout.middle] * all.row_words;
  return words[row + (size_t)at[layout.fast] / 64] >> (at[layout.fast] % 64) & 1;
}

/** The solid angle of a triangle from the centre of a voxel, by 4 pi; *touches if that lies on it. */
static double share_of(const subject *s, const uint32_t corners[3], const int64_t voxel[3], bool *touches) {
  long double v[3][3], length[3], dot[3], volume = 0;
  for (int k = 0; k < 3; k++) {
    vxm_point p = vxm_snapped_points_at(&s->placed, corners[k]);
    for (int a = 0; a < 3; a++)
      v[k][a] = (long double)(p.at[a] - vxm_lattice_centre(&s->placed.lattice, voxel[a])) /
                (long double)s->placed.lattice.unit;
  }
  for (int k = 0; k < 3; k++) {
    length[k] = sqrtl(v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2]);
    const long double *next = v[(k + 1) % 3];
    dot[k] = v[k][0] * next[0] + v[k][1] * next[1] + v[k][2] * next[2];
  }
  for (int a = 0; a < 3; a++)
    volume += v[0][a] * (v[1][(a + 1) % 3] * v[2][(a + 2) % 3] - v[1][(a + 2) % 3] * v[2][(a + 1) % 3]);
  long double sides =
      length[0] * length[1] * length[2] + dot[0] * length[2] + dot[1] * length[0] + dot[2] * length[1];
  *touches |= fabsl(volume) < 1e-12L && sides <= 1e-12L;
  return (double)(atan2l(volume, sides) / (2 * 3.14159265358979323846L));
}

/** The sum of all solid angles, term by term; *touches: the centre of the voxel lies on a triangle. */
static double oracle(const subject *s, const int64_t voxel[3], bool *touches) {
  double sum = 0;
  *touches = false;
  for (size_t t = 0; t < s->triangles.triangle_count; t++)
    if (vxm_role_of(&s->triangles, t) == VXM_ROLE_FACE)
      sum += share_of(s, s->triangles.corners[t], voxel, touches);
  return sum;
}

static vxm_rng rng = {21};

/** Triangles of all sizes between few vertices, some of them closed bodies with pieces missing. */
static vxm_soup *random_soup(int round, double side) {
  vxm_soup *soup = shape_empty(context);
  int vertices = 5 + (int)vxm_rng_below(&rng, 20), faces = 1 + (int)vxm_rng_below(&rng, 60);
  double size = side * pow(0.5, (double)(round % 5)), from[3];
  for (int a = 0; a < 3; a++)
    from[a] = (side - size) * vxm_rng_unit(&rng);
  for (int v = 0; v < vertices; v++) {
    double p[3];
    for (int a = 0; a < 3; a++) {
      p[a] = from[a] + size * (1.4 * vxm_rng_unit(&rng) - 0.2);
      p[a] = round % 3 == 0 ? rint(4 * p[a]) / 4 : p[a];
    }
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (int f = 0; f < faces; f++) {
    uint32_t c[3];
    for (int k = 0; k < 3; k++)
      c[k] = (uint32_t)vxm_rng_below(&rng, (uint64_t)vertices);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
      shape_triangle(soup, c[0], c[1], c[2]);
  }
  if (soup->face_count == 0)
    shape_triangle(soup, 0, 1, 2);
  for (int b = 0; b < round % 4; b++) { /* boxes, the first ones in whole voxels */
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = side * 0.6 * vxm_rng_unit(&rng);
      high[a] = low[a] + 1 + side * 0.3 * vxm_rng_unit(&rng);
      if (b == 0) {
        low[a] = floor(low[a]) + 0.5;
        high[a] = ceil(high[a]) + 0.5;
      }
    }
    shape_box(soup, low, high);
  }
  return soup;
}

enum { SIDE = 20 };
static const vxm_space cube = {{SIDE, SIDE, SIDE}, {0, 0, 0}, {1, 1, 1}};

/** The sign at every voxel of a cube is that of the sum; where that is one half to within `tie`, or jumps, it
 * may be either. */
static void check_signs(const vxm_soup *soup, const vxm_space *space, int round, double tie, size_t *set,
                        size_t *ties) {
  subject s;
  begin(&s, soup, space);
  uint64_t *words = fill(&s, (vxm_layout)VXM_LAYOUT_GRID, SIDE, NULL, NULL);
  int64_t at[3];
  for (at[2] = 0; at[2] < SIDE; at[2]++)
    for (at[1] = 0; at[1] < SIDE; at[1]++)
      for (at[0] = 0; at[0] < SIDE; at[0]++) {
        bool touches, bit = bit_at(words, space, (vxm_layout)VXM_LAYOUT_GRID, at);
        double w = oracle(&s, at, &touches);
        *set += bit;
        if (touches || fabs(w - 0.5) < tie)
          ++*ties;
        else if (bit != (w > 0.5))
          fail_msg("round %d, voxel %d %d %d: w %.7f, but %d", round, (int)at[0], (int)at[1], (int)at[2], w,
                   bit);
      }
  free(words);
  end(&s);
}

static void test_signs_are_those_of_the_sum(void **state) {
  (void)state;
  size_t ties = 0, set = 0;
  for (int round = 0; round < ROUNDS(60); round++) {
    vxm_soup *soup = random_soup(round, SIDE);
    check_signs(soup, &cube, round, 2e-6, &set, &ties);
    vxm_soup_destroy(soup);
  }
  assert_true(set > 80 * ROUNDS(60) && ties < ROUNDS(60) * SIDE * SIDE);
}

/** Triangles with corners as far as a million voxels from a cube in their midst, and others within it. */
static void test_signs_amid_far_corners(void **state) {
  (void)state;
  size_t ties = 0, set = 0;
  for (int round = 0; round < ROUNDS(30); round++) {
    double far = pow(10, 4 + round % 3);
    vxm_soup *soup = shape_empty(context);
    for (int v = 0; v < 18; v++) {
      double p[3];
      for (int a = 0; a < 3; a++)
        p[a] = v < 12 ? far * (2 * vxm_rng_unit(&rng) - 1) : SIDE * vxm_rng_unit(&rng);
      shape_vertex(soup, p[0], p[1], p[2]);
    }
    for (int t = 0; t < 25; t++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, 18), b = (a + 1 + (uint32_t)vxm_rng_below(&rng, 8)) % 18;
      shape_triangle(soup, a, b, (b + 1 + (uint32_t)vxm_rng_below(&rng, 8)) % 18);
    }
    check_signs(soup, &cube, round, 1e-5, &set, &ties);
    vxm_soup_destroy(soup);
  }
  assert_true(set > 1000);
}

/* ---- What floats say ---- */

/** A walk whose numbers are held to those of the rest, which are what it sums up. */
typedef struct checked_walk {
  vxm_winding_walk walk; /**< first, so that what is called back finds the subject */
  const subject *s;
  size_t voxels, doubtful;
} checked_walk;

static double rest_at(const checked_walk *c, const int64_t origin[3], int side, int voxel, bool *touches) {
  const int64_t at[3] = {origin[0] + voxel % side, origin[1] + voxel / side % side,
                         origin[2] + voxel / side / side};
  double sum = 0;
  *touches = false;
  for (size_t t = 0; t < c->s->chain.rest_count; t++)
    sum += share_of(c->s, c->s->chain.rest[t], at, touches);
  return sum;
}

static bool want_all(const vxm_winding_walk *walk, const int64_t origin[3], int level) {
  (void)walk, (void)level;
  return origin[0] < SIDE && origin[1] < SIDE && origin[2] < SIDE;
}

static void check_cell(const vxm_winding_walk *walk, const int64_t origin[3], int level, int number) {
  const checked_walk *c = (const checked_walk *)(const void *)walk;
  int side = 4 << level;
  for (int n = 0; n < 8; n++) {
    bool touches;
    double w = rest_at(c, origin, side, (int)vxm_rng_below(&rng, (uint64_t)(side * side * side)), &touches);
    if (!touches && fabs(w - number) > 0.5)
      fail_msg("a cell has %d, a voxel in it %.7f", number, w);
  }
}

static void check_brick(const vxm_winding_walk *walk, const int64_t origin[3],
                        const vxm_winding_brick *brick) {
  checked_walk *c = (checked_walk *)(uintptr_t)(const void *)walk;
  for (int v = 0; v < VXM_BRICK; v++) {
    bool touches;
    double w = rest_at(c, origin, VXM_BRICK_SIDE, v, &touches), off = fabs(w - (double)brick->value[v]);
    c->voxels++;
    c->doubtful += brick->doubtful >> v & 1;
    if (!(brick->doubtful >> v & 1) && (touches || off > (double)walk->doubt))
      fail_msg("voxel %d of a brick has %.7f, not %.7f", v, (double)brick->value[v], w);
  }
}

/** The numbers of a walk through the cube. */
static void check_walk(const vxm_soup *soup, bool strict, size_t *voxels, size_t *doubtful) {
  subject s;
  begin(&s, soup, &cube);
  assert_int_equal(vxm_winding_mesh_place(&s.mesh, &s.chain, &s.placed, 0, false, NULL), VXM_OK);
  checked_walk c = {.walk = {.tree = &s.mesh.tree,
                             .levels = vxm_winding_levels(),
                             .doubt = strict ? 3e-4F : 0.008F,
                             .strict = strict,
                             .wants = want_all,
                             .settle_cell = check_cell,
                             .settle_brick = check_brick},
                    .s = &s};
  vxm_winding_scratch scratch = {.context = context, .error = VXM_ERROR_INIT};
  for (size_t r = 0; r < s.mesh.tree.root_count; r++)
    vxm_winding_scratch_add(&scratch, s.mesh.tree.roots[r]);
  static const int64_t origin[3] = {0, 0, 0};
  static const float nothing[VXM_BRICK] = {0};
  vxm_winding_kernels_get()->descend(&c.walk, &scratch, origin, 3, nothing, 0, scratch.count);
  vxm_free(context, scratch.nodes);
  *voxels += c.voxels;
  *doubtful += c.doubtful;
  end(&s);
}

/** A fan about a corner a few lattice steps beside the centre of a voxel: of triangles of any shape, of
 * needles, of right angles along rows of voxel centres, or of slivers along them. */
static vxm_soup *random_fan(int kind, double length) {
  vxm_soup *soup = shape_empty(context);
  double middle[3], p[3];
  for (int i = 0; i < 3; i++)
    middle[i] = SIDE / 2 + 0.5 + ((double)vxm_rng_below(&rng, 5) - 2) / 256;
  shape_vertex(soup, middle[0], middle[1], middle[2]);
  uint32_t count = 3 + (uint32_t)vxm_rng_below(&rng, 5);
  for (uint32_t v = 0; v < count; v++) {
    int axis = (int)vxm_rng_below(&rng, 3);
    for (int i = 0; i < 3; i++) {
      double u = 2 * vxm_rng_unit(&rng) - 1, along = 0.9 * length * (u > 0 ? 1 : -1),
             from = 0.55 * length * u;
      if (kind == 1 && v % 2 == 0)
        from = floor(4 * u) + ((double)vxm_rng_below(&rng, 3) - 1) / 256;
      if (kind == 2)
        from = i == axis ? along : vxm_rng_below(&rng, 2) ? 0 : 0.3 * length * u;
      if (kind == 3)
        from = i == axis ? along : ((double)vxm_rng_below(&rng, 5) - 2) / 256;
      p[i] = middle[i] + from;
    }
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (uint32_t v = 0; v + 1 < count; v++)
    shape_triangle(soup, 0, v + 1, v + 2);
  return soup;
}

/** Beside long edges, corners and slivers, where floats alone tell little, what is not told to be in doubt is
 * right, in every build. */
static void test_numbers_beside_long_edges(void **state) {
  (void)state;
  const vxm_kernels *builds[3];
  size_t build_count = vxm_kernels_all(builds), voxels = 0, doubtful = 0, set = 0, ties = 0;
  static const double lengths[] = {30, 80, 150, 500, 2000, 4000, 10000};
  for (int round = 0; round < ROUNDS(700); round++) {
    vxm_soup *soup = random_fan(round % 4, lengths[round % 7]);
    vxm_kernels_force(builds[(size_t)round % build_count]);
    check_walk(soup, round % 5 == 4, &voxels, &doubtful);
    if (round % 16 == 3)
      check_signs(soup, &cube, round, 1e-5, &set, &ties);
    vxm_kernels_force(NULL);
    vxm_soup_destroy(soup);
  }
  assert_true(voxels > 100000 && doubtful < voxels / 5);
}

/** Adds up the solid angles of a node's triangles from a point, by 4 pi, and their areas. */
static void sum_below(const vxm_winding_tree *tree, uint32_t node, const double from[3], double *sum,
                      double *size) {
  const vxm_winding_node *n = &tree->nodes[node];
  if (!n->is_leaf) {
    sum_below(tree, n->next, from, sum, size);
    sum_below(tree, n->next + 1, from, sum, size);
    return;
  }
  const vxm_winding_triangle *t = &tree->triangles[n->next];
  long double v[3][3], length[3], dot[3], volume = 0, area = 0;
  for (int k = 0; k < 3; k++) {
    for (int a = 0; a < 3; a++)
      v[k][a] = (long double)t->corner[k][a] - (long double)from[a];
    length[k] = sqrtl(v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2]);
  }
  for (int k = 0; k < 3; k++) {
    const long double *next = v[(k + 1) % 3];
    dot[k] = v[k][0] * next[0] + v[k][1] * next[1] + v[k][2] * next[2];
  }
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    long double normal =
        (v[1][b] - v[0][b]) * (v[2][c] - v[0][c]) - (v[1][c] - v[0][c]) * (v[2][b] - v[0][b]);
    volume += normal * v[0][a];
    area += normal * normal;
  }
  long double sides =
      length[0] * length[1] * length[2] + dot[0] * length[2] + dot[1] * length[0] + dot[2] * length[1];
  *sum += (double)(atan2l(volume, sides) / (2 * 3.14159265358979323846L));
  *size += (double)sqrtl(area) / 2;
}

/** What voxel/winding/winding_tree.h says of a node's moments, seen from where its centre is at d. */
static double expand(const vxm_winding_moments *m, const double d[3]) {
  static const int first[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  static const int second[10][3] = {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0, 0, 2},
                                    {0, 1, 2}, {1, 1, 2}, {0, 2, 2}, {1, 2, 2}, {2, 2, 2}};
  double x[3], square = 0, n = 0, f = 0, s = 0;
  for (int a = 0; a < 3; a++) {
    x[a] = d[a] * (double)m->scale;
    square += x[a] * x[a];
  }
  for (int a = 0; a < 3; a++)
    n += (double)m->area[a] * x[a];
  for (int t = 0; t < 6; t++)
    f += (double)m->first[t] * x[first[t][0]] * x[first[t][1]];
  for (int t = 0; t < 10; t++)
    s += (double)m->second[t] * x[second[t][0]] * x[second[t][1]] * x[second[t][2]];
  return (n + f / square + s / (square * square)) / (square * sqrt(square));
}

/** From afar a node looks as its triangles do: what its expansion leaves out falls with the third power of
 * its radius over the distance. */
static void test_nodes_from_afar(void **state) {
  (void)state;
  const double times = 100;
  size_t nodes = 0;
  for (int round = 0; round < ROUNDS(40); round++) {
    vxm_soup *soup = random_soup(round, 12);
    subject s;
    begin(&s, soup, &cube);
    assert_int_equal(vxm_winding_mesh_place(&s.mesh, &s.chain, &s.placed, 0, false, NULL), VXM_OK);
    const vxm_winding_tree *tree = &s.mesh.tree;
    for (uint32_t i = 0; i < tree->node_count; i++, nodes++) {
      double d[3], from[3], sum = 0, size = 0, length = 0, far = times * (double)tree->nodes[i].radius;
      for (int a = 0; a < 3; a++) {
        d[a] = 2 * vxm_rng_unit(&rng) - 1;
        length += d[a] * d[a];
      }
      for (int a = 0; a < 3; a++) {
        d[a] *= far / sqrt(length);
        from[a] = tree->nodes[i].centre[a] - d[a];
      }
      sum_below(tree, i, from, &sum, &size);
      double off = fabs(expand(&tree->moments[i], d) - sum) * 4 * 3.14159265358979324 * far * far;
      if (off > size / (times * times * times))
        fail_msg("node %u of radius %g is off by %g of its area %g", (unsigned)i,
                 (double)tree->nodes[i].radius, off, size);
    }
    end(&s);
    vxm_soup_destroy(soup);
  }
  assert_true(nodes > 500);
}

static void compare(const uint64_t *a, const uint64_t *b, const vxm_space *space, vxm_layout layout,
                    const char *what) {
  int64_t at[3];
  for (at[2] = 0; at[2] < space->dims[2]; at[2]++)
    for (at[1] = 0; at[1] < space->dims[1]; at[1]++)
      for (at[0] = 0; at[0] < space->dims[0]; at[0]++)
        if (bit_at(a, space, (vxm_layout)VXM_LAYOUT_GRID, at) != bit_at(b, space, layout, at))
          fail_msg("%s: voxel %d %d %d differs", what, (int)at[0], (int)at[1], (int)at[2]);
}

/** The bytes of confidence at some voxels: 255 min(1, |2 w - 1|), but for the errors of floats. */
static void check_confidence(const subject *s, const uint8_t *confidence) {
  const int64_t *dims = s->placed.lattice.space.dims;
  for (int n = 0; n < ROUNDS(50); n++) {
    int64_t at[3];
    bool touches;
    for (int a = 0; a < 3; a++)
      at[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)dims[a]);
    double right = 255 * fmin(fabs(2 * oracle(s, at, &touches) - 1), 1);
    int made = confidence[(at[2] * dims[1] + at[1]) * dims[0] + at[0]];
    if (!touches && fabs(made + 0.5 - right) > 3)
      fail_msg("voxel %d %d %d: confidence %d, not %.2f", (int)at[0], (int)at[1], (int)at[2], made, right);
  }
}

/** A few voxels in the middle of a large box that has no top: the numbers of nodes far larger than the grid.
 */
static void test_a_small_window_in_a_large_mesh(void **state) {
  (void)state;
  for (double half = 1e3; half < 1e9; half *= 1e2) {
    vxm_soup *soup = shape_empty(context);
    enum { CUTS = 6 };
    for (int side = 0; side < 5; side++)
      for (int i = 0; i < CUTS; i++)
        for (int j = 0; j < CUTS; j++) {
          uint32_t corner[4];
          for (int c = 0; c < 4; c++) {
            int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
            double p[3];
            p[axis] = side % 2 ? half : -half;
            p[u] = half * (2.0 * (i + (c == 1 || c == 2)) / CUTS - 1);
            p[v] = half * (2.0 * (j + (c >= 2)) / CUTS - 1);
            corner[side % 2 ? c : 3 - c] = shape_vertex(soup, p[0] + 4, p[1] + 4, p[2] + 4);
          }
          shape_face(soup, corner, 4);
        }
    static const vxm_space space = {{8, 8, 8}, {0, 0, 0}, {1, 1, 1}};
    subject s;
    begin(&s, soup, &space);
    uint8_t confidence[8 * 8 * 8];
    uint64_t *words = fill(&s, (vxm_layout)VXM_LAYOUT_GRID, 8, NULL, confidence);
    for (int v = 0; v < 8 * 8 * 8; v++) { /* five sixths of all directions end on a side */
      assert_true(words[v / 8] >> (v % 8) & 1);
      assert_in_range(confidence[v], 166, 174);
    }
    free(words);
    end(&s);
    vxm_soup_destroy(soup);
  }
}

/** Windows, layouts, builds and threads change no bit, and what is asked about is what is set. */
static void test_bits_are_the_same_in_all_ways(void **state) {
  (void)state;
  static const vxm_layout layouts[] = {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {0, 2, 1}};
  const vxm_kernels *builds[3];
  size_t build_count = vxm_kernels_all(builds);
  const vxm_space space = {{70, 21, 37}, {0, 0, 0}, {0.5, 0.5, 0.5}};
  vxm_context *usual = context;
  for (int round = 0; round < ROUNDS(24); round++) {
    vxm_soup *soup = random_soup(round, 12);
    subject s;
    begin(&s, soup, &space);
    uint64_t *words = fill(&s, layouts[0], 37, NULL, NULL);
    for (int l = 0; l < 4; l++) {
      uint64_t *other = fill(&s, layouts[l], 1 + (int64_t)vxm_rng_below(&rng, 9), NULL, NULL);
      compare(words, other, &space, layouts[l], "window");
      free(other);
    }
    for (size_t b = 0; b < build_count; b++) {
      vxm_kernels_force(builds[b]);
      uint64_t *other = fill(&s, layouts[0], 37, NULL, NULL);
      compare(words, other, &space, layouts[0], vxm_cpu_level_name(builds[b]->level));
      free(other);
    }
    vxm_kernels_force(NULL);
    vxm_window all = vxm_window_of(&space, layouts[0], 0, 37);
    size_t count = all.slice_words * 37;
    uint64_t *asked = calloc(count, sizeof *asked), *some = NULL;
    for (size_t w = 0; w < count; w++)
      asked[w] = (vxm_rng_next(&rng) & vxm_rng_next(&rng) & vxm_rng_next(&rng)) &
                 (w % all.row_words == all.row_words - 1 ? vxm_window_tail_mask(&all) : ~UINT64_C(0));
    some = fill(&s, layouts[0], 10, asked, NULL);
    for (size_t w = 0; w < count; w++)
      assert_true(some[w] == (words[w] & asked[w]));
    uint8_t *confidence = calloc(70 * 21 * 37, 1);
    uint64_t *sure = fill(&s, layouts[0], 37, NULL, confidence);
    compare(words, sure, &space, layouts[0], "confidence");
    check_confidence(&s, confidence);
    end(&s);
    vxm_context_options with = VXM_CONTEXT_OPTIONS_INIT;
    with.threads = 5;
    assert_int_equal(vxm_context_create(&context, &with, NULL), VXM_OK);
    begin(&s, soup, &space);
    uint64_t *threads = fill(&s, layouts[0], 37, NULL, NULL);
    compare(words, threads, &space, layouts[0], "threads");
    end(&s);
    vxm_context_destroy(context);
    context = usual;
    free(threads);
    free(sure);
    free(confidence);
    free(some);
    free(asked);
    free(words);
    vxm_soup_destroy(soup);
  }
}

/** The chain is closed, and with the rest it is the soup: as sums of oriented edges. */
static void test_the_chain_is_closed(void **state) {
  (void)state;
  for (int round = 0; round < ROUNDS(200); round++) {
    vxm_soup *soup = random_soup(round, SIDE);
    subject s;
    begin(&s, soup, &cube);
    size_t n = s.triangles.first_apex;
    int *net[2] = {calloc(n * n, sizeof(int)), calloc(n * n, sizeof(int))};
    for (int kind = 0; kind < 2; kind++) {
      const uint32_t(*corners)[3] = (const uint32_t(*)[3])(kind ? s.chain.rest : s.chain.closed);
      for (size_t t = 0; t < (kind ? s.chain.rest_count : s.chain.closed_count); t++)
        for (int k = 0; k < 3; k++) {
          uint32_t p = corners[t][k], q = corners[t][(k + 1) % 3];
          net[kind][p * n + q]++;
          net[kind][q * n + p]--;
        }
    }
    for (size_t t = 0; t < s.triangles.triangle_count; t++)
      if (vxm_role_of(&s.triangles, t) == VXM_ROLE_FACE)
        for (int k = 0; k < 3; k++) {
          uint32_t p = s.triangles.corners[t][k], q = s.triangles.corners[t][(k + 1) % 3];
          net[1][p * n + q]--;
          net[1][q * n + p]++;
        }
    for (size_t i = 0; i < n * n; i++) {
      assert_int_equal(net[0][i], 0);
      assert_int_equal(net[1][i], 0);
    }
    free(net[0]);
    free(net[1]);
    end(&s);
    vxm_soup_destroy(soup);
  }
}

/* ---- Real meshes ---- */

static size_t wrong, tested, near_ties;

static void check_voxel(const subject *s, const uint64_t *words, const int64_t at[3], const char *name) {
  bool touches, bit = bit_at(words, &s->placed.lattice.space, (vxm_layout)VXM_LAYOUT_GRID, at);
  double w = oracle(s, at, &touches);
  tested++;
  if (touches || fabs(w - 0.5) < 2e-6)
    near_ties++;
  else if (bit != (w > 0.5)) {
    wrong++;
    print_message("%s: voxel %d %d %d, w %.7f, bit %d\n", name, (int)at[0], (int)at[1], (int)at[2], w, bit);
  }
}

static void check_file(const char *path, const char *name, void *payload) {
  const bool *all = payload;
  vxm_soup *soup;
  if (vxm_mesh_read(&soup, context, path, NULL) != VXM_OK)
    return;
  vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
  vxm_space space;
  for (int64_t resolution = 64; resolution <= (*all ? 256 : 64); resolution *= 4) {
    fit.resolution[0] = resolution;
    if (soup->face_count == 0 || (!*all && soup->face_count > 5000) ||
        vxm_space_fit(&space, soup, &fit, NULL) != VXM_OK)
      break;
    subject s;
    begin(&s, soup, &space);
    uint64_t *words = fill(&s, (vxm_layout)VXM_LAYOUT_GRID, 100, NULL, NULL);
    int64_t at[3], work = 0, most = *all ? INT64_C(100000000) : 1000000;
    bool every = *all && resolution == 64 && s.triangles.triangle_count < 2000;
    for (at[2] = 0; every && at[2] < space.dims[2]; at[2]++)
      for (at[1] = 0; at[1] < space.dims[1]; at[1]++)
        for (at[0] = 0; at[0] < space.dims[0]; at[0]++)
          check_voxel(&s, words, at, name);
    for (int try = 0; !every && try < 400000 && work < most; try++) {
      bool edge = false, bit;
      for (int a = 0; a < 3; a++)
        at[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)space.dims[a]);
      bit = bit_at(words, &space, (vxm_layout)VXM_LAYOUT_GRID, at);
      for (int a = 0; a < 3; a++) {
        int64_t next[3] = {at[0], at[1], at[2]};
        next[a] = vxm_min(next[a] + 1, space.dims[a] - 1);
        edge |= bit != bit_at(words, &space, (vxm_layout)VXM_LAYOUT_GRID, next);
      }
      if (!edge && try % 256 != 0) /* mostly where it changes */
        continue;
      check_voxel(&s, words, at, name);
      work += (int64_t)s.triangles.triangle_count;
    }
    free(words);
    end(&s);
  }
  vxm_soup_destroy(soup);
}

static void test_real_meshes(void **state) {
  (void)state;
  bool all = getenv("VOXMEND_TEST_WINDING") != NULL;
  if (each_mesh_file(5, check_file, &all) == 0)
    skip();
  print_message("%zu voxels, %zu on a triangle or at one half, %zu wrong\n", tested, near_ties, wrong);
  assert_true(tested > 1000);
  assert_int_equal(wrong, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_the_chain_is_closed),
      cmocka_unit_test(test_nodes_from_afar),
      cmocka_unit_test(test_signs_are_those_of_the_sum),
      cmocka_unit_test(test_signs_amid_far_corners),
      cmocka_unit_test(test_numbers_beside_long_edges),
      cmocka_unit_test(test_a_small_window_in_a_large_mesh),
      cmocka_unit_test(test_bits_are_the_same_in_all_ways),
      cmocka_unit_test(test_real_meshes),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
