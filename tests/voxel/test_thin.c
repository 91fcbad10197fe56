/* SPDX-License-Identifier: BSD-3-Clause */
/** Thin parts against a brute-force oracle: what they are held together by, and how little of that. */
#include "thin_meshes.h"
#include "thin_rule.h"

static vxm_space small_space(vxm_rng *rng) {
  vxm_space space = engine_space(1, 1, 1);
  for (int a = 0; a < 3; a++)
    space.dims[a] = 6 + (int64_t)vxm_rng_below(rng, 6);
  return space;
}

static void assert_same_bytes(const uint8_t *kept, const uint8_t *wanted, const vxm_space *space) {
  for (size_t i = 0; i < thin_size(space); i++)
    if (kept[i] != wanted[i])
      fail_msg("voxel %zu %zu %zu is %d", i % (size_t)space->dims[0],
               i / (size_t)space->dims[0] % (size_t)space->dims[1],
               i / (size_t)(space->dims[0] * space->dims[1]), kept[i]);
}

/** Contract and rule. @param pieces how many there are at most; 0 if the grid may cut them */
static void check_soup(const vxm_soup *soup, const vxm_space *space, vxm_thin_parts thin, int pieces) {
  int directions = thin == VXM_THIN_KEEP26 ? 13 : 3;
  thin_mesh mesh = thin_mesh_of(soup, space);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *centres = thin_grid(soup, space, VXM_THIN_DROP, NULL),
           *grid = thin_grid(soup, space, thin, &report);
  uint8_t *solid = thin_bytes(centres), *kept = thin_bytes(grid);
  thin_assert_contract(&mesh, solid, kept, directions);
  size_t solids = thin_count(solid, thin_size(space)), all = thin_count(kept, thin_size(space));
  assert_int_equal(report.voxels, all);
  assert_int_equal(report.thin_voxels, all - solids);
  thin_apply_rule(&mesh, solid, directions);
  assert_same_bytes(kept, solid, space);
  if (pieces > 0 && (thin_pieces(kept, space) > pieces || thin_pieces(kept, space) == 0))
    fail_msg("%d pieces of %d", thin_pieces(kept, space), pieces);
  free(solid);
  free(kept);
  vxm_grid_destroy(centres);
  vxm_grid_destroy(grid);
  thin_mesh_free(&mesh);
}

/** One body, or one sheet, is one piece. */
static void test_connected_meshes(void **state) {
  (void)state;
  vxm_rng rng = {501};
  for (int round = 0; round < ROUNDS(22 * THIN_KINDS); round++) {
    vxm_space space = small_space(&rng);
    vxm_soup *soup = thin_soup(context, &rng, round % THIN_KINDS, &space);
    check_soup(soup, &space, round / THIN_KINDS % 5 ? VXM_THIN_KEEP : VXM_THIN_KEEP26, 1);
    vxm_soup_destroy(soup);
  }
}

/** Bodies and sheets that may lie across each other: no more pieces than there are of them. */
static void test_several_meshes(void **state) {
  (void)state;
  vxm_rng rng = {502};
  for (int round = 0; round < ROUNDS(50); round++) {
    vxm_space space = small_space(&rng);
    vxm_soup *soup = shape_empty(context);
    int parts = 2 + (int)vxm_rng_below(&rng, 3);
    for (int p = 0; p < parts; p++)
      thin_add_soup(soup, &rng, (int)vxm_rng_below(&rng, THIN_KINDS), &space);
    check_soup(soup, &space, round % 4 ? VXM_THIN_KEEP : VXM_THIN_KEEP26, parts);
    vxm_soup_destroy(soup);
  }
}

/** A sheet of small triangles across an axis, at a height that changes a little. */
static void add_fine_sheet(vxm_soup *soup, vxm_rng *rng, const vxm_space *space, int axis, double height) {
  enum { CUTS = 12 };
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  uint32_t first = (uint32_t)soup->vertex_count;
  double slope = 0.1 * vxm_rng_unit(rng);
  for (uint32_t i = 0; i < (CUTS + 1) * (CUTS + 1); i++) {
    double p[3];
    p[u] = (0.1 + 0.8 * (i % (CUTS + 1)) / CUTS) * (double)space->dims[u];
    p[v] = (0.1 + 0.8 * (i / (CUTS + 1)) / CUTS) * (double)space->dims[v];
    p[axis] = height + slope * p[u] + 0.2 * vxm_rng_unit(rng);
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (uint32_t j = 0; j < CUTS; j++)
    for (uint32_t i = 0; i < CUTS; i++) {
      uint32_t p = first + j * (CUTS + 1) + i, q = p + CUTS + 1;
      shape_triangle(soup, p, p + 1, q + 1);
      shape_triangle(soup, p, q + 1, q);
    }
}

/** Sheets a little above or below a body: a voxel of it lies beside links that the sheet crosses. */
static void test_fine_sheets_beside_bodies(void **state) {
  (void)state;
  vxm_rng rng = {507};
  for (int round = 0; round < ROUNDS(30); round++) {
    vxm_space space = small_space(&rng);
    vxm_soup *soup = shape_empty(context);
    int axis = round % 3;
    double centre[3], half[3], straight[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int a = 0; a < 3; a++) {
      centre[a] = 0.5 * (double)space.dims[a];
      half[a] = (a == axis ? 0.15 : 0.4) * (double)space.dims[a];
    }
    thin_turned_box(soup, centre, straight, half);
    double away = half[axis] + 1.5 * vxm_rng_unit(&rng);
    add_fine_sheet(soup, &rng, &space, axis, centre[axis] + (round % 2 ? away : -away - 1));
    check_soup(soup, &space, VXM_THIN_KEEP, 2);
    vxm_soup_destroy(soup);
  }
}

/** A thin upright tube with a floor and no lid: a part with many caps and cones behind its faces. */
static void add_open_tube(vxm_soup *soup, vxm_rng *rng, const vxm_space *space) {
  enum { SIDES = 48 };
  const double turn = 6.283185307179586 / SIDES;
  double centre[2], radius = 0.2 + 0.2 * vxm_rng_unit(rng), low = 1 + vxm_rng_unit(rng);
  for (int a = 0; a < 2; a++)
    centre[a] = 1 + ((double)space->dims[a] - 2) * vxm_rng_unit(rng);
  uint32_t middle = (uint32_t)soup->vertex_count, first = middle + 1;
  shape_vertex(soup, centre[0], centre[1], low);
  for (int i = 0; i < 2 * SIDES; i++)
    shape_vertex(soup, centre[0] + radius * cos(turn * (i / 2)), centre[1] + radius * sin(turn * (i / 2)),
                 i % 2 ? (double)space->dims[2] - 1.5 : low);
  for (uint32_t i = 0; i < SIDES; i++) {
    uint32_t p = first + 2 * i, q = first + 2 * ((i + 1) % SIDES);
    shape_triangle(soup, middle, q, p);
    shape_triangle(soup, p, q, q + 1);
    shape_triangle(soup, p, q + 1, p + 1);
  }
}

/** What is not a face lies between parts, too, and is passed over there. */
static void test_several_open_tubes(void **state) {
  (void)state;
  vxm_rng rng = {512};
  for (int round = 0; round < ROUNDS(20); round++) {
    vxm_space space = small_space(&rng);
    vxm_soup *soup = shape_empty(context);
    for (int tube = 0; tube < 4; tube++)
      add_open_tube(soup, &rng, &space);
    check_soup(soup, &space, round % 4 ? VXM_THIN_KEEP : VXM_THIN_KEEP26, 4);
    vxm_soup_destroy(soup);
  }
}

/** Non-convex polygons: the triangles lie inside them. */
static void test_polygons(void **state) {
  (void)state;
  vxm_rng rng = {503};
  for (int round = 0; round < ROUNDS(60); round++) {
    vxm_space space = engine_space(10, 11, 12);
    vxm_soup *soup = shape_empty(context);
    double corner[3], size = 0.2 + 6 * vxm_rng_unit(&rng);
    for (int a = 0; a < 3; a++)
      corner[a] = round % 3 ? 2 + vxm_rng_unit(&rng) : shape_quarter(&rng, 8, 12);
    size = round % 3 ? size : ceil(4 * size) / 4;
    thin_letter(soup, &rng, round / 3 % 3, corner[round / 3 % 3] + 2, size, corner);
    check_soup(soup, &space, round % 4 ? VXM_THIN_KEEP : VXM_THIN_KEEP26, 1);
    vxm_soup_destroy(soup);
  }
}

/** Meshes that reach out of the grid: what there is of them in it holds together as far as it can be told. */
static void test_meshes_that_reach_out(void **state) {
  (void)state;
  vxm_rng rng = {504};
  for (int round = 0; round < ROUNDS(10 * THIN_KINDS); round++) {
    vxm_space space = small_space(&rng);
    vxm_soup *soup = thin_soup(context, &rng, round % THIN_KINDS, &space);
    for (int a = 0; a < 3; a++) {
      int64_t before = (int64_t)vxm_rng_below(&rng, 5), behind = (int64_t)vxm_rng_below(&rng, 3);
      space.dims[a] = vxm_max(space.dims[a] - before - behind, 1);
      space.origin[a] = (double)before;
    }
    check_soup(soup, &space, round / THIN_KINDS % 3 ? VXM_THIN_KEEP : VXM_THIN_KEEP26, 0);
    vxm_soup_destroy(soup);
  }
}

/* ---- How little is added ---- */

static void test_thick_bodies_stay(void **state) {
  (void)state;
  vxm_rng rng = {505};
  vxm_space space = engine_space(16, 16, 16);
  int64_t added = 0, voxels = 0;
  for (int round = 0; round < ROUNDS(30); round++) {
    vxm_soup *soup = shape_empty(context);
    double low[3], high[3], centre[3];
    for (int a = 0; a < 3; a++) {
      low[a] = 1 + 4 * vxm_rng_unit(&rng);
      high[a] = low[a] + 3 + 6 * vxm_rng_unit(&rng);
      centre[a] = 7 + 2 * vxm_rng_unit(&rng);
    }
    shape_box(soup, low, high);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid_destroy(thin_grid(soup, &space, VXM_THIN_KEEP, &report));
    assert_int_equal(report.thin_voxels, 0);
    assert_true(report.thin_share == 0);
    vxm_soup_destroy(soup);
    soup = shape_empty(context);
    thin_ball(soup, centre, 3 + 2.5 * vxm_rng_unit(&rng), 12);
    vxm_grid_destroy(thin_grid(soup, &space, VXM_THIN_KEEP, &report));
    assert_true(report.thin_voxels <= 6); /* where it reaches a little beyond a layer of centres */
    added += report.thin_voxels;
    voxels += report.voxels;
    vxm_soup_destroy(soup);
  }
  print_message("%d of %d voxels of balls were added\n", (int)added, (int)voxels);
  assert_true(100 * added < voxels);
}

/** How many voxels are set in each column along an axis: all of those that have any have `height`. Returns
 * how many those are. */
static int64_t columns_of(const vxm_grid *grid, int axis, int64_t height) {
  const int64_t *dims = grid->space.dims;
  int64_t v[3], columns = 0;
  int u = (axis + 1) % 3, w = (axis + 2) % 3;
  for (v[u] = 0; v[u] < dims[u]; v[u]++)
    for (v[w] = 0; v[w] < dims[w]; v[w]++) {
      int64_t set = 0;
      for (v[axis] = 0; v[axis] < dims[axis]; v[axis]++)
        set += vxm_grid_get(grid, v[0], v[1], v[2]);
      if (set != 0 && set != height)
        fail_msg("column %d %d along %d has %d voxels", (int)v[u], (int)v[w], axis, (int)set);
      columns += set != 0;
    }
  return columns;
}

/** A plate thinner than a voxel is one voxel thick, and as wide as it is. */
static void test_plates_are_one_voxel_thick(void **state) {
  (void)state;
  vxm_rng rng = {506};
  for (int round = 0; round < ROUNDS(75); round++) {
    int axis = round % 3;
    vxm_space space = engine_space(14, 14, 14);
    vxm_soup *soup = shape_empty(context);
    double low[3], high[3], thickness = round % 5 == 0 ? 0 : 0.99 * vxm_rng_unit(&rng);
    int64_t wide[3], columns = 1;
    for (int a = 0; a < 3; a++) {
      low[a] = 2 + 2 * vxm_rng_unit(&rng);
      high[a] = low[a] + (a == axis ? thickness : 2 + 6 * vxm_rng_unit(&rng));
      wide[a] = (int64_t)(floor(high[a] + 0.5) - floor(low[a] + 0.5)); /* centres */
      columns *= a == axis ? 1 : wide[a];
    }
    if (round % 10 == 0)
      low[axis] = high[axis] = floor(low[axis]) + 0.5; /* through centres */
    if (round % 2)
      triangle_box(soup, low, high, 0, false);
    else
      shape_box(soup, low, high);
    vxm_grid *grid = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    assert_int_equal(columns_of(grid, axis, 1), columns);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** A rod thinner than a voxel along two axes has one voxel in each layer of centres. It may step aside where
 * the middle of its squares does not tell, as diagonals cross each layer elsewhere. */
static void test_rods_are_one_voxel_thick(void **state) {
  (void)state;
  vxm_rng rng = {507};
  for (int round = 0; round < ROUNDS(75); round++) {
    int axis = round % 3;
    vxm_space space = engine_space(14, 14, 14);
    vxm_soup *soup = shape_empty(context);
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = 2 + 2 * vxm_rng_unit(&rng);
      high[a] = low[a] + (a == axis ? 2 + 7 * vxm_rng_unit(&rng) : 0.99 * vxm_rng_unit(&rng));
    }
    if (round % 2)
      triangle_box(soup, low, high, 0, false);
    else
      shape_box(soup, low, high);
    vxm_grid *grid = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    int64_t layers = (int64_t)(floor(high[axis] + 0.5) - floor(low[axis] + 0.5));
    assert_int_equal(vxm_grid_count(grid), layers);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_connected_meshes),
      cmocka_unit_test(test_several_meshes),
      cmocka_unit_test(test_several_open_tubes),
      cmocka_unit_test(test_fine_sheets_beside_bodies),
      cmocka_unit_test(test_polygons),
      cmocka_unit_test(test_meshes_that_reach_out),
      cmocka_unit_test(test_thick_bodies_stay),
      cmocka_unit_test(test_plates_are_one_voxel_thick),
      cmocka_unit_test(test_rods_are_one_voxel_thick),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
