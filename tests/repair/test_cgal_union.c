/* SPDX-License-Identifier: BSD-3-Clause */
/** Unions of parts. */
#include "solids.h"

#include "repair_test.h"
#include "voxmend/voxelize.h"

static vxm_soup *unite(const vxm_soup *soup, uint64_t **origin, vxm_union_report *report) {
  vxm_soup *out;
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->unite(&out, origin, report, soup, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return out;
}

/** Unites, checks all that must hold, and gives the volume. */
static double check_union(vxm_soup *soup, int64_t parts, int64_t united, vxm_soup **result) {
  vxm_union_report report;
  uint64_t *origin;
  vxm_soup *out = unite(soup, &origin, &report);
  assert_united(out);
  assert_int_equal(report.parts, parts);
  assert_int_equal(report.united, united);
  assert_int_equal(report.failed, 0);
  assert_null(report.failed_faces);
  for (size_t f = 0; f < out->face_count; f++)
    assert_true(origin[f] < soup->face_count && (f == 0 || origin[f - 1] <= origin[f]));
  vxm_free(context, origin);
  double volume = volume_of(out);
  if (result != NULL)
    *result = out;
  else
    vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  return volume;
}

/* ---- Boxes on a lattice: all is exact ---- */

enum { CELLS = 10 };

typedef struct cell_box {
  int low[3], high[3];
} cell_box;

static vxm_soup *lattice_boxes(vxm_rng *rng, cell_box *boxes, int count) {
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < count; i++) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      boxes[i].low[a] = (int)vxm_rng_below(rng, CELLS - 3);
      boxes[i].high[a] = boxes[i].low[a] + 1 + (int)vxm_rng_below(rng, 3);
      low[a] = boxes[i].low[a];
      high[a] = boxes[i].high[a];
    }
    add_box(soup, low, high, &upright, i % 2 == 0, false);
  }
  return soup;
}

static bool in_boxes(const cell_box *boxes, int count, const int cell[3]) {
  for (int i = 0; i < count; i++) {
    bool inside = true;
    for (int a = 0; a < 3; a++)
      inside = inside && cell[a] >= boxes[i].low[a] && cell[a] < boxes[i].high[a];
    if (inside)
      return true;
  }
  return false;
}

static double area_of(const vxm_soup *soup) {
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
  return census.area;
}

/** Every face lies in the plane of the one that it came from and faces the same way. */
static void check_origins(const vxm_soup *out, const uint64_t *origin, const vxm_soup *soup) {
  for (size_t f = 0; f < out->face_count; f++) {
    const vxm_soup *both[2] = {out, soup};
    double n[2][3], at[2];
    for (int s = 0; s < 2; s++) {
      size_t count;
      const uint32_t *corner = vxm_face(both[s], s ? origin[f] : f, &count);
      const double *a = vxm_position(both[s], corner[0]), *b = vxm_position(both[s], corner[1]),
                   *c = vxm_position(both[s], corner[2]);
      double length = 0;
      for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        n[s][i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
        length += fabs(n[s][i]);
      }
      at[s] = 0;
      for (int i = 0; i < 3; i++) {
        n[s][i] /= length;
        at[s] += n[s][i] * a[i];
      }
    }
    for (int i = 0; i < 3; i++)
      assert_true(n[0][i] == n[1][i]); /* of either sign where they are zero */
    assert_true(at[0] == at[1]);
  }
}

static void boxes_on_a_lattice(void **state) {
  (void)state;
  vxm_rng rng = {1};
  for (int round = 0; round < 30; round++) {
    cell_box boxes[24];
    int count = 2 + (int)vxm_rng_below(&rng, 23);
    vxm_soup *soup = lattice_boxes(&rng, boxes, count);
    uint64_t *origin;
    vxm_union_report report;
    vxm_soup *out = unite(soup, &origin, &report);
    assert_united(out);
    assert_int_equal(report.parts, count);
    assert_int_equal(report.failed, 0);
    double volume = 0, area = 0;
    for (int c = 0; c < CELLS * CELLS * CELLS; c++) {
      int cell[3] = {c % CELLS, c / CELLS % CELLS, c / CELLS / CELLS};
      if (!in_boxes(boxes, count, cell))
        continue;
      volume += 1;
      for (int side = 0; side < 6; side++) {
        int next[3] = {cell[0], cell[1], cell[2]};
        next[side / 2] += side % 2 ? 1 : -1;
        area += !in_boxes(boxes, count, next);
      }
    }
    assert_true(fabs(volume_of(out) - volume) < 1e-9 * volume);
    assert_true(fabs(area_of(out) - area) < 1e-9 * area);
    check_origins(out, origin, soup);
    vxm_free(context, origin);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void two_cubes(void **state) {
  (void)state;
  /* the second one's corner, the volume, and how many of the two were united */
  static const struct {
    double at[3], volume;
    int64_t united;
  } cases[] = {
      {{0.5, 0.5, 0.5}, 1.875, 2}, {{0.5, 0, 0}, 1.5, 2},       {{1, 0, 0}, 2, 2},
      {{1, 0.25, 0.5}, 2, 2},      {{1, 1, 0}, 2, 0},           {{1, 1, 0.5}, 2, 0},
      {{1, 1, 1}, 2, 0},           {{0, 0, 0}, 1, 2},           {{2, 0, 0}, 2, 0},
      {{0x1p-40, 0, 0}, 1, 2},     {{1 + 0x1p-40, 0, 0}, 2, 0},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    vxm_soup *soup = new_soup(context);
    const double *at = cases[i].at;
    add_cuboid(soup, 0, 0, 0, 1, 1, 1);
    add_cuboid(soup, at[0], at[1], at[2], at[0] + 1, at[1] + 1, at[2] + 1);
    double volume = check_union(soup, 2, cases[i].united, NULL);
    assert_true(fabs(volume - cases[i].volume) < 1e-11);
  }
}

static void through_a_corner(void **state) {
  (void)state;
  /* the tip of a tetrahedron on the middle of a face of a cube, and one whose edge lies on it */
  for (int i = 0; i < 2; i++) {
    vxm_soup *soup = new_soup(context);
    add_cuboid(soup, 0, 0, 0, 1, 1, 1);
    uint32_t v = (uint32_t)soup->vertex_count;
    add_vertex(soup, 0.5, 0.5, 1);
    add_vertex(soup, 0.75, i ? 0.5 : 0.75, i ? 1 : 2);
    add_vertex(soup, 0.5, 0.75, 2);
    add_vertex(soup, 0.25, 0.25, 2);
    add_triangle(soup, v, v + 1, v + 2);
    add_triangle(soup, v, v + 2, v + 3);
    add_triangle(soup, v, v + 3, v + 1);
    add_triangle(soup, v + 1, v + 3, v + 2);
    if (volume_of(soup) < 1)
      turn_faces(soup, 12);
    double volume = volume_of(soup);
    assert_true(fabs(check_union(soup, 2, 0, NULL) - volume) < 1e-12);
  }
}

static void many_copies(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  const double centre[3] = {0.1, 0.2, 0.3};
  for (int i = 0; i < 5; i++)
    add_ball(soup, centre, 1, 6, &upright, false);
  vxm_soup *ball = new_soup(context);
  add_ball(ball, centre, 1, 6, &upright, false);
  vxm_soup *out;
  check_union(soup, 5, 5, &out);
  assert_int_equal(out->face_count, ball->face_count);
  assert_true(volume_of(out) == volume_of(ball));
  vxm_soup_destroy(out);
  vxm_soup_destroy(ball);
}

static void a_block_of_cubes(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  for (int c = 0; c < 512; c++)
    add_cuboid(soup, c % 8, c / 8 % 8, c / 64, c % 8 + 1, c / 8 % 8 + 1, c / 64 + 1);
  vxm_soup *out;
  assert_true(check_union(soup, 512, 512, &out) == 512);
  assert_true(area_of(out) == 6 * 64);
  vxm_soup_destroy(out);
}

/* ---- Nothing to unite ---- */

static void apart(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  for (int c = 0; c < 1000; c++) {
    double x = 2 * (c % 10), y = 2 * (c / 10 % 10), z = 2 * (c / 100);
    add_box(soup, (double[]){x, y, z}, (double[]){x + 1, y + 1, z + 1}, &upright, c % 2 == 0, false);
  }
  tag_faces(soup);
  uint64_t *origin;
  vxm_union_report report;
  vxm_soup *out = unite(soup, &origin, &report);
  assert_same_soup(out, soup);
  for (size_t f = 0; f < out->face_count; f++)
    assert_int_equal(origin[f], f);
  assert_int_equal(report.parts, 1000);
  assert_int_equal(report.united + report.failed + report.cut, 0);
  vxm_free(context, origin);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void what_is_not_closed(void **state) {
  (void)state;
  vxm_soup *soup = grid_sheet(context, 4);
  size_t sheet = soup->face_count;
  add_cuboid(soup, 0.5, 0.5, -1, 1.5, 1.5, 1);
  add_cuboid(soup, 1, 1, -1, 2, 2, 1);
  /* both sides of a square: closed, but without a volume */
  uint32_t v = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 4; i++)
    add_vertex(soup, 10 + i / 2, i % 3 != 0, 0);
  add_face(soup, (const uint32_t[]){v, v + 1, v + 2, v + 3}, 4);
  add_face(soup, (const uint32_t[]){v + 3, v + 2, v + 1, v}, 4);
  uint64_t *origin;
  vxm_union_report report;
  vxm_soup *out = unite(soup, &origin, &report);
  assert_int_equal(report.parts, 3);
  assert_int_equal(report.united, 2);
  assert_int_equal(report.failed, 0);
  for (size_t f = 0; f < sheet; f++) {
    size_t count;
    const uint32_t *p = vxm_face(soup, f, &count), *q = vxm_face(out, f, &count);
    assert_int_equal(origin[f], f);
    for (size_t c = 0; c < count; c++)
      assert_memory_equal(vxm_position(soup, p[c]), vxm_position(out, q[c]), 3 * sizeof(double));
  }
  assert_int_equal(origin[out->face_count - 1], soup->face_count - 1);
  assert_int_equal(origin[out->face_count - 2], soup->face_count - 2);
  assert_true(fabs(volume_of(out) - 2 * 1.75) < 1e-12);
  vxm_free(context, origin);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/* ---- One inside the other ---- */

static void nested(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context), *out;
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_cuboid(soup, 4, 4, 4, 6, 6, 6);
  add_cuboid(soup, 7, 7, 7, 8, 8, 8);
  assert_true(check_union(soup, 3, 2, &out) == 1000);
  assert_int_equal(out->face_count, 12);
  vxm_soup_destroy(out);
}

static void cavities(void **state) {
  (void)state;
  /* a cavity, with a solid in it */
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_hollow(soup, 2, 2, 2, 8, 8, 8);
  add_cuboid(soup, 4, 4, 4, 6, 6, 6);
  assert_true(check_union(soup, 3, 0, NULL) == 1000 - 216 + 8);
  /* a rod through both walls fills a part of the cavity; the order does not matter */
  for (int i = 0; i < 2; i++) {
    soup = new_soup(context);
    if (i)
      add_cuboid(soup, -1, 4, 4, 11, 6, 6);
    add_hollow(soup, 2, 2, 2, 8, 8, 8);
    add_cuboid(soup, 0, 0, 0, 10, 10, 10);
    if (!i)
      add_cuboid(soup, -1, 4, 4, 11, 6, 6);
    assert_true(fabs(check_union(soup, 3, 3, NULL) - (1000 - 216 + 2 * 4 + 6 * 4)) < 1e-9);
  }
  /* a post that touches the cavity alone */
  soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_hollow(soup, 2, 2, 2, 8, 8, 8);
  add_cuboid(soup, 4, 4, 1, 6, 6, 9);
  assert_true(fabs(check_union(soup, 3, 2, NULL) - (1000 - 216 + 4 * 6)) < 1e-9);
  /* two cavities that overlap */
  soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_hollow(soup, 2, 2, 2, 6, 6, 6);
  add_hollow(soup, 4, 4, 4, 8, 8, 8);
  assert_true(fabs(check_union(soup, 3, 2, NULL) - (1000 - 64 - 64 + 8)) < 1e-9);
  /* a cavity of a ball that lies in another solid is filled by that */
  soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_cuboid(soup, 3, 3, 3, 7, 7, 7);
  add_hollow(soup, 4, 4, 4, 6, 6, 6);
  assert_true(check_union(soup, 3, 2, NULL) == 1000);
  /* shells in shells */
  soup = new_soup(context);
  double expected = 0;
  for (int i = 0; i < 8; i++) {
    double size = 16 - 2 * i;
    (i % 2 ? add_hollow : add_cuboid)(soup, i, i, i, i + size, i + size, i + size);
    expected += (i % 2 ? -1 : 1) * size * size * size;
  }
  assert_true(check_union(soup, 8, 0, NULL) == expected);
}

/** Cavities of which one face lies in the skin, and what stands in them or lies free. */
static void pockets(void **state) {
  (void)state;
  vxm_rng rng = {11};
  for (int round = 0; round < 12; round++) {
    frame3 frame = round ? random_frame(&rng) : upright;
    for (int i = 0; i < 3 && round % 2; i++)
      frame.move[i] = 200 * vxm_rng_unit(&rng);
    static const struct {
      double low[3], high[3], adds;
    } in_pocket[] = {
        {{2, 2, 2}, {4, 4, 4}, 8},  /* free */
        {{5, 3, 5}, {6, 5, 6}, 2},  /* the same */
        {{5, 1, 1}, {6, 2, 3}, 2},  /* at a wall */
        {{2, 4, 5}, {3, 6, 6}, 2},  /* on the ground */
        {{2, 0, 5}, {3, 1, 6}, 1},  /* flush with the opening */
        {{1, -1, 3}, {2, 2, 4}, 3}, /* out of it */
    };
    for (unsigned some = 0; some < 64; some += round % 3 ? 9 : 1) {
      vxm_soup *soup = new_soup(context);
      double volume = 512 - 6 * 6 * 6;
      add_box(soup, (double[]){0, 0, 0}, (double[]){8, 8, 8}, &frame, true, false);
      for (int i = 0; i < 6; i++)
        if (some >> i & 1) {
          volume += in_pocket[i].adds;
          add_box(soup, in_pocket[i].low, in_pocket[i].high, &frame, true, false);
        }
      add_box(soup, (double[]){1, 0, 1}, (double[]){7, 6, 7}, &frame, true, true);
      vxm_union_report report;
      vxm_soup *out = unite(soup, NULL, &report);
      assert_int_equal(report.failed, 0);
      assert_int_equal(count_meetings(out), 0);
      if (fabs(volume_of(out) - volume) > 1e-6 * volume)
        fail_msg("round %d, %u: %g instead of %g", round, some, volume_of(out), volume);
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
  }
}

/** Cavities of several solids together, of none, and of one that is nearly as large. */
static void pockets_of_several(void **state) {
  (void)state;
  for (int order = 0; order < 2; order++)
    for (int inside = 0; inside < 3; inside++) {
      /* two halves of a block, and a cavity across */
      vxm_soup *soup = new_soup(context);
      if (order)
        add_hollow(soup, 2, 0, 2, 6, 6, 6);
      add_cuboid(soup, 0, 0, 0, 4, 8, 8);
      add_cuboid(soup, 4, 0, 0, 8, 8, 8);
      if (inside == 1)
        add_cuboid(soup, 2.5, 1, 3, 3.5, 2, 4);
      if (inside == 2)
        add_cuboid(soup, 3, 4, 3, 5, 6, 4);
      if (!order)
        add_hollow(soup, 2, 0, 2, 6, 6, 6);
      vxm_union_report report;
      vxm_soup *out = unite(soup, NULL, &report);
      assert_united(out);
      assert_int_equal(report.failed, 0);
      double adds[] = {0, 1, 4};
      assert_true(fabs(volume_of(out) - (512 - 96 + adds[inside])) < 1e-9);
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
  /* what the pocket of one has in it belongs to another one */
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 8, 8, 8);
  add_hollow(soup, 1, 0, 1, 7, 6, 7);
  add_cuboid(soup, 3, -4, 3, 5, 4, 5);
  assert_true(fabs(check_union(soup, 3, 2, NULL) - (512 - 216 + 32)) < 1e-9);
  /* a cutter that reaches out takes from all that it cuts through, and nothing of what lies in it */
  soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 8, 8, 8);
  add_hollow(soup, 1, -1, 1, 7, 6, 7);
  add_cuboid(soup, 2, 4, 2, 4, 6, 4);
  add_cuboid(soup, 2, 1, 2, 3, 2, 3);
  add_cuboid(soup, 2, -1, 5, 3, 1, 6);
  vxm_union_report report;
  vxm_soup *out = unite(soup, NULL, &report);
  assert_united(out);
  assert_true(fabs(volume_of(out) - (512 - 216 + 8 + 1 + 2)) < 1e-9);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void drilled(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 10, 10, 10);
  add_hollow(soup, 4, 4, -1, 6, 6, 11);
  assert_true(fabs(check_union(soup, 2, 2, NULL) - (1000 - 40)) < 1e-9);
}

static void a_lone_cavity(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  add_hollow(soup, 3, 0, 0, 4, 1, 1);
  vxm_union_report report;
  vxm_soup *out = unite(soup, NULL, &report);
  assert_same_soup(out, soup);
  assert_int_equal(report.failed, 1);
  assert_int_equal(report.failed_faces[0], 12);
  vxm_free(context, report.failed_faces);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/* ---- Any position ---- */

/** The union as the voxels have it: of the parts, and of the result by parity alone. */
static void check_voxels(const vxm_soup *soup, const vxm_soup *out, double voxels_off) {
  vxm_grid *grids[2];
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 64;
  vxm_space space;
  assert_int_equal(vxm_space_fit(&space, soup, &space_options, NULL), VXM_OK);
  space_options.like = &space;
  assert_int_equal(vxm_voxelize(&grids[0], NULL, soup, &space_options, &options, NULL), VXM_OK);
  options.split_mode = VXM_SPLIT_MODE_WHOLE;
  options.method = VXM_METHOD_Y;
  assert_int_equal(vxm_voxelize(&grids[1], NULL, out, &space_options, &options, NULL), VXM_OK);
  vxm_comparison comparison = VXM_COMPARISON_INIT;
  assert_int_equal(vxm_grid_compare(&comparison, grids[0], grids[1], NULL), VXM_OK);
  double off = (double)(comparison.only_a + comparison.only_b);
  if (off > voxels_off * (double)comparison.both)
    fail_msg("%g of %g voxels differ", off, (double)comparison.both);
  double volume = volume_of(out) / pow(space.voxel_size[0], 3);
  assert_true(fabs(volume - (double)comparison.voxels_b) < 0.02 * volume + 30);
  vxm_grid_destroy(grids[0]);
  vxm_grid_destroy(grids[1]);
}

static void check_against_voxels(vxm_soup *soup, int64_t parts, double voxels_off) {
  vxm_union_report report;
  vxm_soup *out = unite(soup, NULL, &report);
  assert_united(out);
  assert_int_equal(report.parts, parts);
  assert_int_equal(report.failed, 0);
  check_voxels(soup, out, voxels_off);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void boxes_in_any_direction(void **state) {
  (void)state;
  vxm_rng rng = {3};
  for (int round = 0; round < 4; round++) {
    vxm_soup *soup = new_soup(context);
    for (int i = 0; i < 16; i++) {
      frame3 frame = random_frame(&rng);
      double low[3], high[3];
      for (int a = 0; a < 3; a++) {
        frame.move[a] = 6 * vxm_rng_unit(&rng);
        high[a] = 0.5 + 2 * vxm_rng_unit(&rng);
        low[a] = -high[a];
      }
      add_box(soup, low, high, &frame, i % 2 == 0, false);
    }
    check_against_voxels(soup, 16, 1e-3);
  }
}

static void balls(void **state) {
  (void)state;
  vxm_rng rng = {4};
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < 14; i++) {
    frame3 frame = random_frame(&rng);
    double centre[3] = {5 * vxm_rng_unit(&rng), 5 * vxm_rng_unit(&rng), 5 * vxm_rng_unit(&rng)};
    add_ball(soup, centre, 0.8 + vxm_rng_unit(&rng), 9, &frame, false);
  }
  check_against_voxels(soup, 14, 1e-3);
}

static void two_balls(void **state) {
  (void)state;
  /* the volume of the lens of two balls of radius 1 at a distance of 1 is 5 pi / 12 */
  vxm_soup *soup = new_soup(context);
  add_ball(soup, (double[]){0, 0, 0}, 1, 40, &upright, false);
  add_ball(soup, (double[]){1, 0, 0}, 1, 40, &upright, false);
  double volume = check_union(soup, 2, 2, NULL);
  assert_true(fabs(volume - (8.0 / 3 - 5.0 / 12) * M_PI) < 0.01 * volume);
}

/** Walls that should be in one plane and are not, by the last bits. */
static void nearly_coplanar(void **state) {
  (void)state;
  vxm_rng rng = {5};
  for (int round = 0; round < 3; round++) {
    frame3 frame = random_frame(&rng);
    cell_box boxes[14];
    vxm_soup *soup = lattice_boxes(&rng, boxes, 14);
    for (size_t v = 0; v < soup->vertex_count; v++) {
      double *p = soup->positions + 3 * v, q[3];
      for (int i = 0; i < 3; i++)
        q[i] = frame.m[i][0] * p[0] + frame.m[i][1] * p[1] + frame.m[i][2] * p[2];
      memcpy(p, q, sizeof q);
    }
    double volume = 0;
    for (int c = 0; c < CELLS * CELLS * CELLS; c++)
      volume += in_boxes(boxes, 14, (int[]){c % CELLS, c / CELLS % CELLS, c / CELLS / CELLS});
    vxm_union_report report;
    vxm_soup *out = unite(soup, NULL, &report);
    assert_closed_manifold(out);
    assert_int_equal(report.failed, 0);
    assert_int_equal(count_meetings(out), 0);
    assert_true(fabs(volume_of(out) - volume) < 1e-5 * volume);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/* ---- Parts that cut through themselves ---- */

/** An octahedron with its corners anywhere, which may cut through itself, with most of its volume outward. */
static vxm_soup *any_octahedron(vxm_rng *rng) {
  vxm_soup *soup = new_soup(context);
  for (int k = 0; k < 6; k++)
    add_vertex(soup, vxm_rng_unit(rng), vxm_rng_unit(rng), vxm_rng_unit(rng));
  for (uint32_t k = 0; k < 4; k++) {
    add_triangle(soup, 4, k, (k + 1) % 4);
    add_triangle(soup, 5, (k + 1) % 4, k);
  }
  if (volume_of(soup) < 0)
    turn_faces(soup, 0);
  return soup;
}

static void add_soup(vxm_soup *soup, const vxm_soup *part) {
  uint32_t v = (uint32_t)soup->vertex_count;
  for (size_t i = 0; i < part->vertex_count; i++)
    add_vertex(soup, part->positions[3 * i], part->positions[3 * i + 1], part->positions[3 * i + 2]);
  for (size_t f = 0; f < part->face_count; f++)
    add_triangle(soup, v + part->indices[3 * f], v + part->indices[3 * f + 1], v + part->indices[3 * f + 2]);
}

/** The union is where one of them winds around a place, either way; returns how often it is the other way. */
static int check_points(const vxm_soup *out, vxm_soup *const *parts, int64_t count, vxm_rng *rng) {
  int other_way = 0;
  for (int i = 0; i < 200; i++) {
    double at[3] = {vxm_rng_unit(rng), vxm_rng_unit(rng), vxm_rng_unit(rng)};
    bool inside = false, outward = false;
    for (int64_t p = 0; p < count; p++) {
      double winding = winding_at(parts[p], at);
      inside = inside || fabs(winding) > 0.5;
      outward = outward || winding > 0.5;
    }
    assert_true(fabs(winding_at(out, at) - inside) < 1e-6);
    other_way += inside && !outward;
  }
  return other_way;
}

static void crossing_parts(void **state) {
  (void)state;
  vxm_rng rng = {6};
  int other_way = 0;
  for (int round = 0; round < 20; round++) {
    vxm_soup *soup = new_soup(context), *single[3];
    int64_t parts = 1 + round % 3;
    for (int64_t i = 0; i < parts; i++) {
      single[i] = any_octahedron(&rng);
      add_soup(soup, single[i]);
    }
    vxm_union_report report;
    vxm_soup *out = unite(soup, NULL, &report);
    assert_united(out);
    assert_int_equal(report.failed, 0);
    other_way += check_points(out, single, parts, &rng);
    for (int64_t i = 0; i < parts; i++)
      vxm_soup_destroy(single[i]);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  assert_true(other_way > 20);
}

/** What lies in the half of a bow that is wound the other way is in it all the same, and a cavity is one. */
static void in_a_bow(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context), *out;
  add_bow(soup);
  add_cuboid(soup, 0.2, 0.9, 0.2, 0.4, 1.1, 0.4);
  add_hollow(soup, 0.2, 0.9, 0.6, 0.4, 1.1, 0.8);
  vxm_union_report report;
  out = unite(soup, NULL, &report);
  assert_united(out);
  assert_int_equal(report.failed, 0);
  assert_int_equal(report.united, 1);
  assert_true(fabs(volume_of(out) - (20.0 / 3 - 0.008)) < 1e-9);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** A cavity around which nothing is stays, but for a crumb that rounding has left of another union. */
static void crumbs(void **state) {
  (void)state;
  for (int round = 0; round < 4; round++) {
    vxm_soup *soup = new_soup(context);
    add_cuboid(soup, 0, 0, 0, 1, 1, 1);
    const int i = round % 2;
    const double size = i ? 0x1p-20 : 0x1p-24, width = round < 2 ? size : 0.5;
    add_hollow(soup, 2 - size, 0, 0, 2, width, width);
    vxm_union_report report;
    vxm_soup *out = unite(soup, NULL, &report);
    assert_int_equal(report.failed, i);
    assert_int_equal(out->face_count, i ? 24 : 12);
    vxm_free(context, report.failed_faces);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** What is left of a beam is left out where it is a crumb, beside which the rest is much; but a part that
 * came in as thin stays. */
static void crumbs_of_a_cut(void **state) {
  (void)state;
  for (int round = 0; round < 3; round++) {
    vxm_soup *soup = new_soup(context);
    const bool thick = round == 1, alone = round == 2;
    const double end = 4 - (thick ? 0x1p-18 : 0x1p-23);
    if (alone)
      add_cuboid(soup, end, 0, 0, 4, 1, 1);
    add_cuboid(soup, 0, 0, 0, alone ? 2 : 4, 1, 1);
    add_hollow(soup, 1, -1, -1, alone ? 3 : end, 2, 2);
    vxm_union_report report;
    vxm_soup *out = unite(soup, NULL, &report);
    assert_int_equal(report.failed, 0);
    bool left = false;
    for (size_t v = 0; v < out->vertex_count; v++)
      left = left || vxm_position(out, v)[0] == 4;
    assert_int_equal(left, thick || alone);
    assert_true(fabs(volume_of(out) - 1) < 1e-5);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** A bent prism that runs through itself: its volume is counted once. */
static void a_loop(void **state) {
  (void)state;
  static const double path[5][2] = {{0, 0}, {10, 0}, {10, 5}, {5, 5}, {5, -5}};
  vxm_soup *soup = new_soup(context), *out;
  for (int i = 0; i < 5; i++)
    for (int c = 0; c < 4; c++) {
      /* mitres at the bends keep the walls parallel to the axes */
      static const double offset[5][4][2] = {{{0, -1}, {0, 1}, {0, 1}, {0, -1}},
                                             {{1, -1}, {-1, 1}, {-1, 1}, {1, -1}},
                                             {{1, 1}, {-1, -1}, {-1, -1}, {1, 1}},
                                             {{-1, 1}, {1, -1}, {1, -1}, {-1, 1}},
                                             {{-1, 0}, {1, 0}, {1, 0}, {-1, 0}}};
      add_vertex(soup, path[i][0] + offset[i][c][0], path[i][1] + offset[i][c][1], c < 2 ? -1 : 1);
    }
  for (uint32_t i = 0; i < 4; i++)
    for (uint32_t c = 0; c < 4; c++) {
      uint32_t a = 4 * i + c, b = 4 * i + (c + 1) % 4;
      add_triangle(soup, a, b, b + 4);
      add_triangle(soup, a, b + 4, a + 4);
    }
  add_face(soup, (const uint32_t[]){3, 2, 1, 0}, 4);
  add_face(soup, (const uint32_t[]){16, 17, 18, 19}, 4);
  if (volume_of(soup) < 0)
    turn_faces(soup, 0);
  double whole = volume_of(soup);
  vxm_union_report report;
  out = unite(soup, NULL, &report);
  assert_united(out);
  assert_int_equal(report.cut, 1);
  assert_int_equal(report.united, 0);
  assert_true(fabs(volume_of(out) - (whole - 8)) < 1e-9);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/* ---- Promises ---- */

static vxm_soup *overlapping_balls(vxm_context *owner) {
  vxm_soup *soup = new_soup(owner);
  vxm_rng rng = {9};
  for (int i = 0; i < 6; i++) {
    frame3 frame = random_frame(&rng);
    double centre[3] = {2 * vxm_rng_unit(&rng), 2 * vxm_rng_unit(&rng), 2 * vxm_rng_unit(&rng)};
    add_ball(soup, centre, 1, 8, &frame, false);
  }
  return soup;
}

static void the_same_each_time(void **state) {
  (void)state;
  vxm_soup *out[2];
  for (int i = 0; i < 2; i++) {
    vxm_context *owner = context_of_threads(i ? 4 : 1);
    vxm_soup *soup = overlapping_balls(owner);
    out[i] = unite(soup, NULL, NULL);
    vxm_soup_destroy(soup);
    vxm_context_destroy(owner);
  }
  assert_same_soup(out[0], out[1]);
  vxm_soup_destroy(out[0]);
  vxm_soup_destroy(out[1]);
}

static void tags_are_kept(void **state) {
  (void)state;
  vxm_soup *soup = overlapping_balls(context);
  tag_faces(soup);
  uint64_t *origin;
  vxm_soup *out = unite(soup, &origin, NULL);
  for (size_t f = 0; f < out->face_count; f++)
    assert_int_equal(out->face_tags[f], soup->face_tags[origin[f]]);
  vxm_free(context, origin);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static int calls_left;

static int stop_after(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)payload;
  assert_true(fraction >= 0 && fraction <= 1);
  return calls_left-- <= 0;
}

static void cancelled(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = stop_after;
  vxm_context *owner;
  assert_int_equal(vxm_context_create(&owner, &options, NULL), VXM_OK);
  vxm_soup *soup = overlapping_balls(owner);
  bool done = false;
  for (int calls = 0; !done && calls < 1000; calls++) {
    calls_left = calls;
    vxm_soup *out;
    uint64_t *origin;
    vxm_union_report report;
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = cgal->unite(&out, &origin, &report, soup, false, &error);
    done = status == VXM_OK;
    if (done) {
      vxm_soup_destroy(out);
      vxm_free(owner, origin);
      continue;
    }
    assert_int_equal(status, VXM_ERROR_CANCELLED);
    assert_true(out == NULL && origin == NULL && report.failed_faces == NULL);
    assert_non_null(strstr(error.text, "cancelled"));
  }
  assert_true(done);
  vxm_soup_destroy(soup);
  vxm_context_destroy(owner);
}

static void too_little_memory(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  vxm_soup *large = overlapping_balls(context);
  bool done = false;
  for (options.memory_limit = 1 << 18; !done; options.memory_limit *= 2) {
    assert_true(options.memory_limit < UINT64_C(1) << 32);
    vxm_context *owner;
    assert_int_equal(vxm_context_create(&owner, &options, NULL), VXM_OK);
    vxm_soup *soup = new_soup(owner), *out = NULL;
    assert_int_equal(
        vxm_soup_reserve(soup, large->vertex_count, large->face_count, large->corner_count, NULL), VXM_OK);
    for (size_t v = 0; v < large->vertex_count; v++)
      add_vertex(soup, large->positions[3 * v], large->positions[3 * v + 1], large->positions[3 * v + 2]);
    for (size_t f = 0; f < large->face_count; f++)
      add_face(soup, large->indices + 3 * f, 3);
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = cgal->unite(&out, NULL, NULL, soup, false, &error);
    done = status == VXM_OK;
    if (!done) {
      assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      assert_null(out);
    }
    assert_true(vxm_context_peak_bytes(owner) <= options.memory_limit);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(owner);
  }
  assert_true(options.memory_limit > 1 << 20);
  vxm_soup_destroy(large);
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_on_a_lattice),
      cmocka_unit_test(two_cubes),
      cmocka_unit_test(through_a_corner),
      cmocka_unit_test(many_copies),
      cmocka_unit_test(a_block_of_cubes),
      cmocka_unit_test(apart),
      cmocka_unit_test(what_is_not_closed),
      cmocka_unit_test(nested),
      cmocka_unit_test(cavities),
      cmocka_unit_test(pockets),
      cmocka_unit_test(pockets_of_several),
      cmocka_unit_test(drilled),
      cmocka_unit_test(a_lone_cavity),
      cmocka_unit_test(boxes_in_any_direction),
      cmocka_unit_test(balls),
      cmocka_unit_test(two_balls),
      cmocka_unit_test(nearly_coplanar),
      cmocka_unit_test(crossing_parts),
      cmocka_unit_test(in_a_bow),
      cmocka_unit_test(crumbs),
      cmocka_unit_test(crumbs_of_a_cut),
      cmocka_unit_test(a_loop),
      cmocka_unit_test(the_same_each_time),
      cmocka_unit_test(tags_are_kept),
      cmocka_unit_test(cancelled),
      cmocka_unit_test(too_little_memory),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
