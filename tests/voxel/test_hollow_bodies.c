/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Hollow boxes that overlap, lie in each other and in each other's walls: solid is what lies in the wall of
 * one of them, whichever others have a void there. No two of their faces lie in one plane, so which cells are
 * solid is known from whole numbers alone.
 */
#include "../base/rounds.h"
#include "../mesh/soups.h"

#include "mesh/geometry.h"
#include "repair/repair.h"
#include "voxmend.h"

#include <math.h>

enum { BODIES_MAX = 5, PLANES_MAX = 4 * BODIES_MAX, CELLS_MAX = PLANES_MAX * PLANES_MAX * PLANES_MAX };

/** Per axis the planes of the skin and of the void: from, void from, void to, to. */
typedef struct hollow_box {
  int planes[3][4];
} hollow_box;

typedef struct assembly {
  hollow_box boxes[BODIES_MAX];
  size_t count;
} assembly;

static void shuffle(int *numbers, size_t count, vxm_rng *rng) {
  for (size_t i = count; i-- > 1;) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    int kept = numbers[i];
    numbers[i] = numbers[j];
    numbers[j] = kept;
  }
}

static void sort_four(int *p) {
  for (int i = 1; i < 4; i++)
    for (int j = i; j > 0 && p[j - 1] > p[j]; j--) {
      int kept = p[j];
      p[j] = p[j - 1];
      p[j - 1] = kept;
    }
}

/** Boxes of any planes, most of which cut through each other. */
static assembly random_boxes(size_t count, vxm_rng *rng) {
  assembly a = {.count = count};
  for (int axis = 0; axis < 3; axis++) {
    int planes[PLANES_MAX];
    for (size_t i = 0; i < 4 * count; i++)
      planes[i] = (int)i;
    shuffle(planes, 4 * count, rng);
    for (size_t i = 0; i < count; i++) {
      for (int k = 0; k < 4; k++)
        a.boxes[i].planes[axis][k] = planes[4 * i + (size_t)k];
      sort_four(a.boxes[i].planes[axis]);
    }
  }
  return a;
}

/** Boxes that lie in each other, skins and voids in any order in which a void lies in its box: none cuts
 * through another. */
static assembly nested_boxes(size_t count, vxm_rng *rng) {
  assembly a = {.count = count};
  int owner[2 * BODIES_MAX], seen[BODIES_MAX] = {0};
  for (size_t i = 0; i < 2 * count; i++)
    owner[i] = (int)(i / 2);
  shuffle(owner, 2 * count, rng);
  for (int i = 0; i < (int)(2 * count); i++) {
    hollow_box *box = &a.boxes[owner[i]];
    bool is_void = seen[owner[i]]++ > 0;
    for (int axis = 0; axis < 3; axis++) {
      box->planes[axis][is_void ? 1 : 0] = i;
      box->planes[axis][is_void ? 2 : 3] = (int)(4 * count) - 1 - i;
    }
  }
  return a;
}

static void add_skin(vxm_soup *soup, const hollow_box *box, bool is_void, bool inward) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++) {
    double p[3];
    for (int axis = 0; axis < 3; axis++)
      p[axis] = box->planes[axis][v >> axis & 1 ? (is_void ? 2 : 3) : (is_void ? 1 : 0)];
    add_vertex(soup, p[0], p[1], p[2]);
  }
  for (int f = 0; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][inward ? 3 - i : i];
    add_face(soup, corners, 4);
  }
}

/** All skins and voids, in any order. @param inside_out all faces are turned over */
static vxm_soup *faces_of(vxm_context *context, const assembly *a, bool inside_out, vxm_rng *rng) {
  vxm_soup *soup = new_soup(context);
  int order[2 * BODIES_MAX];
  for (size_t i = 0; i < 2 * a->count; i++)
    order[i] = (int)i;
  shuffle(order, 2 * a->count, rng);
  for (size_t i = 0; i < 2 * a->count; i++) {
    bool is_void = order[i] % 2 == 1;
    add_skin(soup, &a->boxes[order[i] / 2], is_void, is_void != inside_out);
  }
  return soup;
}

/** Whether a cell, of which no plane cuts through the middle, lies in the wall of a box. */
static bool is_solid(const assembly *a, const int64_t cell[3]) {
  for (size_t i = 0; i < a->count; i++) {
    bool in = true, in_void = true;
    for (int axis = 0; axis < 3; axis++) {
      const int *p = a->boxes[i].planes[axis];
      in = in && cell[axis] >= p[0] && cell[axis] < p[3];
      in_void = in_void && cell[axis] >= p[1] && cell[axis] < p[2];
    }
    if (in && !in_void)
      return true;
  }
  return false;
}

static double wall_volume(const assembly *a) {
  double sum = 0;
  for (size_t i = 0; i < a->count; i++) {
    double skin = 1, in = 1;
    for (int axis = 0; axis < 3; axis++) {
      skin *= a->boxes[i].planes[axis][3] - a->boxes[i].planes[axis][0];
      in *= a->boxes[i].planes[axis][2] - a->boxes[i].planes[axis][1];
    }
    sum += skin - in;
  }
  return sum;
}

static double volume_of(const vxm_soup *soup) {
  double volume = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    const double *p = vxm_position(soup, corner[0]);
    volume +=
        vxm_polygon_cone((vxm_vec3){p[0], p[1], p[2]}, vxm_polygon_area(soup->positions, corner, count, 1));
  }
  return volume;
}

static void assert_cells(const vxm_soup *soup, const assembly *a, uint64_t seed, const char *what) {
  vxm_space space = {.dims = {1, 1, 1}, .voxel_size = {1, 1, 1}};
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  for (int axis = 0; axis < 3; axis++)
    space.dims[axis] = 4 * (int64_t)a->count;
  place.like = &space;
  options.thin = VXM_THIN_DROP;
  if (vxm_voxelize(&grid, NULL, soup, &place, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  int wrong = 0;
  int64_t at[3];
  for (at[2] = 0; at[2] < space.dims[2]; at[2]++)
    for (at[1] = 0; at[1] < space.dims[1]; at[1]++)
      for (at[0] = 0; at[0] < space.dims[0]; at[0]++)
        wrong += vxm_grid_get(grid, at[0], at[1], at[2]) != is_solid(a, at);
  vxm_grid_destroy(grid);
  if (wrong > 0)
    fail_msg("seed %llu, %zu boxes, %s: %d voxels are wrong", (unsigned long long)seed, a->count, what,
             wrong);
}

/** As the faces are, before they are voxelized, and after repairs that leave bodies as they are. */
static void assert_solid(vxm_context *context, const assembly *a, bool inside_out, uint64_t seed,
                         vxm_rng *rng) {
  static const vxm_level levels[] = {VXM_LEVEL_CLEAN, VXM_LEVEL_CLOSED};
  vxm_soup *soup = faces_of(context, a, inside_out, rng), *prepared;
  assert_cells(soup, a, seed, "as it is");
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  assert_cells(prepared, a, seed, "prepared");
  vxm_soup_destroy(prepared);
  for (size_t l = 0; l < sizeof levels / sizeof *levels; l++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = levels[l];
    assert_int_equal(vxm_repair_run(&prepared, NULL, soup, &options, NULL), VXM_OK);
    if (fabs(volume_of(prepared) - wall_volume(a)) > 1e-6)
      fail_msg("seed %llu: the volume is %g instead of %g", (unsigned long long)seed, volume_of(prepared),
               wall_volume(a));
    assert_cells(prepared, a, seed, "repaired");
    vxm_soup_destroy(prepared);
  }
  vxm_soup_destroy(soup);
}

static void a_liner_in_a_vessel(void **state) {
  vxm_rng rng = {1};
  assembly a = {.count = 2};
  static const int planes[2][4] = {{0, 2, 5, 7}, {1, 3, 4, 6}};
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      for (int k = 0; k < 4; k++)
        a.boxes[i].planes[axis][k] = planes[i][k];
  for (int round = 0; round < 24; round++)
    assert_solid(*state, &a, round % 2 == 1, (uint64_t)round, &rng);
}

static void nested(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(200); seed++) {
    vxm_rng rng = {seed};
    assembly a = nested_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

static void overlapping(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(400); seed++) {
    vxm_rng rng = {seed};
    assembly a = random_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_liner_in_a_vessel), cmocka_unit_test(nested),
                                     cmocka_unit_test(overlapping)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
