/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Boxes that stand flush against each other, each of which lacks a side or a triangle: whatever vertices and
 * edges they share, each is closed by itself. Which cells are inside is known from whole numbers.
 */
#include "cells.h"

enum { BOXES_MAX = 4, FINE = 2 * SIDE };

typedef struct open_box {
  int low[3], high[3];
  int lacking; /**< the first of its 12 triangles that it lacks */
  bool side;   /**< it lacks the next one too, which is the whole side */
} open_box;

typedef struct scene {
  open_box boxes[BOXES_MAX];
  int count;
} scene;

/* Bit a of a corner tells at which end it lies along axis a. */
static const uint32_t triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

static void find_corner(const open_box *box, uint32_t corner, int p[3]) {
  for (int a = 0; a < 3; a++)
    p[a] = corner >> a & 1 ? box->high[a] : box->low[a];
}

/* ---- Scenes ---- */

static open_box random_box(vxm_rng *rng, bool side) {
  open_box box = {.lacking = (int)vxm_rng_below(rng, 12), .side = side};
  for (int a = 0; a < 3; a++) {
    box.low[a] = (int)vxm_rng_below(rng, SIDE);
    box.high[a] = box.low[a] + 1 + (int)vxm_rng_below(rng, (uint64_t)(SIDE - box.low[a]));
  }
  box.lacking -= side ? box.lacking % 2 : 0;
  return box;
}

/** How far boxes reach into each other along the axis where it is least: 0 = they touch. */
static int overlap_of(const open_box *p, const open_box *q) {
  int least = SIDE;
  for (int a = 0; a < 3; a++) {
    int low = p->low[a] > q->low[a] ? p->low[a] : q->low[a];
    int high = p->high[a] < q->high[a] ? p->high[a] : q->high[a];
    least = high - low < least ? high - low : least;
  }
  return least;
}

/** The three or four corners of the rim, around it. */
static int find_rim(const open_box *box, int rim[4][3]) {
  const uint32_t *one = triangles[box->lacking], *other = triangles[box->lacking + box->side];
  for (int i = 0; i < 3; i++)
    find_corner(box, one[i], rim[i]);
  if (!box->side)
    return 3;
  /* the corner that only the other triangle has goes across from the one that only the first one has */
  uint32_t all = one[0] ^ one[1] ^ one[2] ^ other[0] ^ other[1] ^ other[2];
  for (int i = 0; i < 3; i++) {
    bool shared = one[i] == other[0] || one[i] == other[1] || one[i] == other[2];
    if (shared)
      continue;
    find_corner(box, one[i], rim[0]);
    find_corner(box, one[(i + 1) % 3], rim[1]);
    find_corner(box, all ^ one[i], rim[2]);
    find_corner(box, one[(i + 2) % 3], rim[3]);
  }
  return 4;
}

/** Whether two segments have more than a point in common. */
static bool run_along(int p[2][3], int q[2][3]) {
  int u[3], v[3], w[3], dot = 0, from = 0, to = 0;
  for (int a = 0; a < 3; a++) {
    u[a] = p[1][a] - p[0][a];
    v[a] = q[0][a] - p[0][a];
    w[a] = q[1][a] - p[0][a];
    dot += u[a] * u[a];
    from += u[a] * v[a];
    to += u[a] * w[a];
  }
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3;
    if (u[a] * v[b] != u[b] * v[a] || u[a] * w[b] != u[b] * w[a])
      return false;
  }
  return from < to ? from < dot && to > 0 : to < dot && from > 0;
}

/** Where rims have an edge in common one surface goes on from box to box, and nothing tells them apart. */
static bool rims_share_an_edge(const open_box *p, const open_box *q) {
  int rims[2][4][3], counts[2] = {find_rim(p, rims[0]), find_rim(q, rims[1])};
  for (int i = 0; i < counts[0]; i++)
    for (int j = 0; j < counts[1]; j++) {
      int one[2][3], other[2][3];
      memcpy(one[0], rims[0][i], sizeof one[0]);
      memcpy(one[1], rims[0][(i + 1) % counts[0]], sizeof one[1]);
      memcpy(other[0], rims[1][j], sizeof other[0]);
      memcpy(other[1], rims[1][(j + 1) % counts[1]], sizeof other[1]);
      if (run_along(one, other))
        return true;
    }
  return false;
}

/** Boxes that have a whole side in common are one with a wall within, which is no matter of rims. */
static bool share_a_side(const open_box *p, const open_box *q) {
  int same = 0;
  for (int a = 0; a < 3; a++)
    same += p->low[a] == q->low[a] && p->high[a] == q->high[a];
  return same == 2;
}

static bool fits(const scene *s, const open_box *box) {
  bool touches = s->count == 0;
  for (int i = 0; i < s->count; i++) {
    int overlap = overlap_of(&s->boxes[i], box);
    if (overlap > 0 || rims_share_an_edge(&s->boxes[i], box) || share_a_side(&s->boxes[i], box))
      return false;
    touches = touches || overlap == 0;
  }
  return touches;
}

static scene random_scene(vxm_rng *rng, bool sides) {
  scene s = {.count = 0};
  int count = 2 + (int)vxm_rng_below(rng, BOXES_MAX - 1);
  for (int tries = 0; s.count < count && tries < 1000; tries++) {
    open_box box = random_box(rng, sides);
    if (fits(&s, &box))
      s.boxes[s.count++] = box;
  }
  return s;
}

static vxm_soup *boxes_of(vxm_context *context, const scene *s) {
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < s->count; i++) {
    const open_box *box = &s->boxes[i];
    uint32_t first = (uint32_t)soup->vertex_count;
    for (uint32_t c = 0; c < 8; c++) {
      int p[3];
      find_corner(box, c, p);
      add_vertex(soup, p[0], p[1], p[2]);
    }
    for (int t = 0; t < 12; t++)
      if (t != box->lacking && !(box->side && t == box->lacking + 1))
        add_triangle(soup, first + triangles[t][0], first + triangles[t][1], first + triangles[t][2]);
  }
  return soup;
}

/* ---- What must hold ---- */

static bool is_inside(const scene *s, const int64_t at[3]) {
  for (int i = 0; i < s->count; i++) {
    bool inside = true;
    for (int a = 0; a < 3; a++)
      inside = inside && at[a] / 2 >= s->boxes[i].low[a] && at[a] / 2 < s->boxes[i].high[a];
    if (inside)
      return true;
  }
  return false;
}

/** Voxels that differ from the boxes, two along each edge of a cell. */
static int wrong_voxels(const vxm_soup *soup, const scene *s) {
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {.dims = {FINE, FINE, FINE}, .voxel_size = {0.5, 0.5, 0.5}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  int wrong = 0;
  place.like = &space;
  options.thin = VXM_THIN_DROP;
  if (vxm_voxelize(&grid, NULL, soup, &place, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (int64_t z = 0; z < FINE; z++)
    for (int64_t y = 0; y < FINE; y++)
      for (int64_t x = 0; x < FINE; x++)
        wrong += vxm_grid_get(grid, x, y, z) != is_inside(s, (int64_t[]){x, y, z});
  vxm_grid_destroy(grid);
  return wrong;
}

static double volume_of(const scene *s) {
  int volume = 0;
  for (int i = 0; i < s->count; i++) {
    const open_box *b = &s->boxes[i];
    volume += (b->high[0] - b->low[0]) * (b->high[1] - b->low[1]) * (b->high[2] - b->low[2]);
  }
  return volume;
}

static double closed_volume(const vxm_soup *soup) {
  vxm_census after = VXM_CENSUS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_soup *closed;
  report.after = &after;
  options.level = VXM_LEVEL_CLOSED;
  assert_int_equal(vxm_repair_run(&closed, &report, soup, &options, NULL), VXM_OK);
  vxm_soup_destroy(closed);
  return after.volume;
}

static void describe(const scene *s, uint64_t seed, const char *what) {
  fprintf(stderr, "seed %llu, %s:", (unsigned long long)seed, what);
  for (int i = 0; i < s->count; i++) {
    const open_box *b = &s->boxes[i];
    fprintf(stderr, " (%d %d %d)-(%d %d %d)/%d", b->low[0], b->low[1], b->low[2], b->high[0], b->high[1],
            b->high[2], b->lacking);
  }
  fputc('\n', stderr);
}

/** Counts scenes of which the grid or the closed mesh is not that of the boxes. */
static void check_scenes(vxm_context *context, bool sides, uint64_t scenes) {
  int wrong_grids = 0, wrong_volumes = 0;
  for (uint64_t seed = 1; seed <= scenes; seed++) {
    vxm_rng rng = {seed};
    scene s = random_scene(&rng, sides);
    vxm_soup *soup = boxes_of(context, &s), *prepared;
    assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
    bool grid = wrong_voxels(prepared, &s) > 0;
    bool volume = !(fabs(closed_volume(soup) - volume_of(&s)) < 1e-3);
    wrong_grids += grid;
    wrong_volumes += volume;
    if (grid || volume)
      describe(&s, seed, grid && volume ? "both" : grid ? "grid" : "volume");
    vxm_soup_destroy(prepared);
    vxm_soup_destroy(soup);
  }
  print_message("%d grids and %d volumes of %llu are wrong\n", wrong_grids, wrong_volumes,
                (unsigned long long)scenes);
  assert_int_equal(wrong_grids + wrong_volumes, 0);
}

static void boxes_without_a_side(void **state) {
  check_scenes(*state, true, rounds_of(400));
}

static void boxes_without_a_triangle(void **state) {
  check_scenes(*state, false, rounds_of(400));
}

static int setup(void **state) {
  *state = context_of_threads(1);
  return 0;
}

static int teardown(void **state) {
  vxm_context_destroy(*state);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_without_a_side),
      cmocka_unit_test(boxes_without_a_triangle),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
