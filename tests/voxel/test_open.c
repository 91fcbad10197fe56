/* SPDX-License-Identifier: BSD-3-Clause */
/* Open, turned and nested parts: caps, patches turned outward, winding numbers, cavities, confidence. */
#include "shapes.h"

#include "grid/bitgrid.h"
#include "voxel/parity/parity_union.h"
#include "voxel/winding/orient_patches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const vxm_space cube64 = {{64, 64, 64}, {-1.6, -1.6, -1.6}, {0.05, 0.05, 0.05}};

static vxm_grid *voxelize(const vxm_soup *soup, vxm_voxelize_options options, vxm_voxelize_report *report) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.like = &cube64;
  vxm_grid *grid;
  if (vxm_voxelize(&grid, report, soup, &space, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

static double iou(const vxm_grid *a, const vxm_grid *b) {
  vxm_comparison comparison = VXM_COMPARISON_INIT;
  assert_int_equal(vxm_grid_compare(&comparison, a, b, NULL), VXM_OK);
  return comparison.iou;
}

/** Drops or turns faces of a soup at random. */
static void damage(vxm_soup *soup, vxm_rng *rng, double removed, double turned) {
  for (size_t f = 0; f < soup->face_count; f++) {
    uint32_t *corner = soup->indices + soup->offsets[f];
    size_t n = soup->offsets[f + 1] - soup->offsets[f];
    if (vxm_rng_unit(rng) < removed)
      for (size_t c = 1; c < n; c++)
        corner[c] = corner[0];
    else if (vxm_rng_unit(rng) < turned)
      for (size_t c = 0; c < n / 2; c++) {
        uint32_t swap = corner[c];
        corner[c] = corner[n - 1 - c];
        corner[n - 1 - c] = swap;
      }
  }
}

static vxm_soup *torus(void) {
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 64, 32, 1, 0.45, (double[]){0.013, 0.021, 0.007});
  return soup;
}

/* ---- Caps ---- */

static void test_triangles_and_caps_are_closed(void **state) {
  (void)state;
  vxm_rng rng = {1};
  for (int round = 0; round < 1000; round++) {
    vxm_soup *soup = shape_empty(context);
    uint32_t vertices = 4 + (uint32_t)vxm_rng_below(&rng, 8);
    for (uint32_t v = 0; v < vertices; v++) {
      double x = shape_quarter(&rng, 0, 28), y = shape_quarter(&rng, 0, 28);
      shape_vertex(soup, x, y, shape_quarter(&rng, 0, 28));
    }
    for (int f = 0; f < 8; f++) {
      uint32_t corner[5];
      size_t n = 3 + vxm_rng_below(&rng, 3);
      for (size_t c = 0; c < n; c++)
        corner[c] = (uint32_t)vxm_rng_below(&rng, vertices);
      shape_face(soup, corner, n);
    }
    vxm_space space = {{7, 7, 7}, {0, 0, 0}, {1, 1, 1}};
    vxm_lattice lattice = vxm_lattice_of(&space);
    vxm_triangle_set triangles;
    vxm_split_rule rule = {VXM_SPLIT_MODE_GROUP, VXM_CAVITIES_FILL, true};
    vxm_snapped_points placed = {.context = context};
    vxm_workspace workspace = vxm_workspace_of(context);
    assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
    assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, true, NULL), VXM_OK);
    for (int closing = VXM_ROLE_CAP; closing <= VXM_ROLE_CONE; closing *= 2) {
      vxm_grid *grids[3];
      for (int axis = 0; axis < 3; axis++) {
        assert_int_equal(vxm_grid_create(&grids[axis], context, &space, NULL), VXM_OK);
        vxm_parity_union_job job = {.triangles = &triangles,
                                    .placed = &placed,
                                    .axis = axis,
                                    .part_end = triangles.split.part_count,
                                    .roles = VXM_ROLE_FACE | (unsigned)closing,
                                    .phase = "testing"};
        vxm_window window = vxm_window_of_grid(grids[axis]);
        assert_int_equal(vxm_parity_union(&workspace, &window, &job, NULL), VXM_OK);
      }
      size_t bytes = grids[0]->word_count * sizeof *grids[0]->words;
      assert_memory_equal(grids[0]->words, grids[1]->words, bytes);
      assert_memory_equal(grids[0]->words, grids[2]->words, bytes);
      for (int axis = 0; axis < 3; axis++)
        vxm_grid_destroy(grids[axis]);
    }
    vxm_workspace_destroy(&workspace);
    vxm_snapped_points_destroy(&placed);
    vxm_triangle_set_destroy(&triangles);
    vxm_soup_destroy(soup);
  }
}

static void test_holes_are_capped(void **state) {
  (void)state;
  static const double part[] = {0.01, 0.05, 0.2}, least[] = {0.9999, 0.999, 0.98};
  vxm_soup *clean = torus();
  vxm_grid *truth = voxelize(clean, (vxm_voxelize_options)VXM_VOXELIZE_OPTIONS_INIT, NULL);
  for (int p = 0; p < 3; p++) {
    vxm_rng rng = {(uint64_t)p};
    vxm_soup *soup = torus();
    damage(soup, &rng, part[p], 0.3);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *grid = voxelize(soup, (vxm_voxelize_options)VXM_VOXELIZE_OPTIONS_INIT, &report);
    assert_true(iou(grid, truth) >= least[p]);
    assert_int_equal(report.capped_parts, 1);
    assert_true(report.caps > 0);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
  vxm_grid_destroy(truth);
  vxm_soup_destroy(clean);
}

/** A square of quads in the plane w = at, with its own vertices. */
static void add_panel(vxm_soup *soup, int w, double at, double half, uint32_t cuts) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t j = 0; j <= cuts; j++)
    for (uint32_t i = 0; i <= cuts; i++) {
      double p[3];
      p[w] = at;
      p[(w + 1) % 3] = half * (2.0 * i / cuts - 1);
      p[(w + 2) % 3] = half * (2.0 * j / cuts - 1);
      shape_vertex(soup, p[0], p[1], p[2]);
    }
  for (uint32_t j = 0; j < cuts; j++)
    for (uint32_t i = 0; i < cuts; i++) {
      uint32_t c = first + j * (cuts + 1) + i;
      shape_face(soup, (uint32_t[]){c, c + 1, c + cuts + 2, c + cuts + 1}, 4);
    }
}

static void test_panels_make_a_body(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  for (uint32_t side = 0; side < 6; side++)
    add_panel(soup, (int)side / 2, side % 2 ? 1.01 : -1.01, 1.01, 2 + side);
  vxm_grid *grid = voxelize(soup, (vxm_voxelize_options)VXM_VOXELIZE_OPTIONS_INIT, NULL);
  assert_int_equal(vxm_grid_count(grid), 40 * 40 * 40);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** A sheet has no inside: it is one voxel thick where thin parts are kept, and leaves a body as it is. */
static void test_a_sheet(void **state) {
  (void)state;
  for (int i = 0; i < 4; i++) {
    bool inside = i % 2, kept = i / 2;
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = kept ? VXM_THIN_KEEP : VXM_THIN_DROP;
    vxm_soup *soup = shape_empty(context);
    add_panel(soup, 2, 0.03, 0.5, 3);
    if (inside)
      shape_box(soup, (double[]){-1.01, -1.01, -1.01}, (double[]){1.01, 1.01, 1.01});
    vxm_grid *grid = voxelize(soup, options, NULL);
    assert_int_equal(vxm_grid_count(grid), inside ? 40 * 40 * 40 : kept ? 20 * 20 : 0);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** Turns by degrees about x, y and z, one after the other. */
static void turn_soup(vxm_soup *soup, const double degrees[3]) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    for (int a = 0; a < 3; a++) {
      double *p = soup->positions + 3 * v, angle = degrees[a] * M_PI / 180;
      double y = p[(a + 1) % 3], z = p[(a + 2) % 3];
      p[(a + 1) % 3] = cos(angle) * y - sin(angle) * z;
      p[(a + 2) % 3] = sin(angle) * y + cos(angle) * z;
    }
}

/** A sheet bent to half a pipe, whose other half is open, encloses nothing, though lines along one axis do
 * say so: it lies along the axes, or nearly, or across two of them. */
static void test_half_a_pipe(void **state) {
  (void)state;
  enum { CUTS = 24 };
  const double turns[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},   {1, 2, 3},
                             {5, 5, 5}, {0, 5, 0}, {0, 0, 5}, {10, 20, 0}, {0, 45, 0}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
    vxm_soup *soup = shape_empty(context);
    for (uint32_t n = 0; n <= CUTS; n++)
      for (int end = -1; end <= 1; end += 2)
        shape_vertex(soup, end * 1.2, 0.8 * cos(M_PI * n / CUTS), 0.8 * sin(M_PI * n / CUTS));
    for (uint32_t n = 0; n < CUTS; n++)
      shape_face(soup, (uint32_t[]){2 * n, 2 * n + 1, 2 * n + 3, 2 * n + 2}, 4);
    turn_soup(soup, turns[i]);
    vxm_grid *grid = voxelize(soup, options, NULL);
    assert_int_equal(vxm_grid_count(grid), 0);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** A part of a sphere about the middle, up to an angle from its pole on -z, open there. */
static void add_bowl(vxm_soup *soup, double radius, double angle) {
  enum { RINGS = 12, SEGMENTS = 24 };
  uint32_t pole = shape_vertex(soup, 0, 0, -radius), last[SEGMENTS];
  for (int ring = 1; ring <= RINGS; ring++) {
    uint32_t next[SEGMENTS];
    double t = angle * ring / RINGS;
    for (int i = 0; i < SEGMENTS; i++) {
      double u = 2 * 3.141592653589793 * i / SEGMENTS;
      next[i] = shape_vertex(soup, radius * sin(t) * cos(u), radius * sin(t) * sin(u), -radius * cos(t));
    }
    for (int i = 0; i < SEGMENTS; i++) {
      int k = (i + 1) % SEGMENTS;
      if (ring == 1)
        shape_triangle(soup, pole, next[k], next[i]);
      else
        shape_face(soup, (uint32_t[]){last[i], last[k], next[k], next[i]}, 4);
    }
    memcpy(last, next, sizeof last);
  }
}

/** A bent sheet that stands alone is one, however far the votes take its bend for a body; with a lid, which
 * may be loose, it is one. */
static void test_a_bent_sheet(void **state) {
  (void)state;
  const double angle = 0.95, height = 1.2 * cos(angle), rim = 1.2 * sin(angle);
  for (int i = 0; i < 4; i++) {
    bool lid = i % 2, kept = i / 2;
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = kept ? VXM_THIN_KEEP : VXM_THIN_DROP;
    vxm_soup *soup = shape_empty(context);
    add_bowl(soup, 1.2, angle);
    if (lid)
      add_panel(soup, 2, -height + 0.001, rim, 3);
    vxm_grid *grid = voxelize(soup, options, NULL);
    for (int64_t v = 0; v < 64 * 64 * 64; v++) {
      double x = 0.05 * (double)(v / 4096) - 1.575, y = 0.05 * (double)(v / 64 % 64) - 1.575;
      double z = 0.05 * (double)(v % 64) - 1.575, from = sqrt(x * x + y * y + z * z);
      bool set = vxm_grid_get(grid, v / 4096, v / 64 % 64, v % 64);
      if (z < -height - 0.1 && from < 1.1)
        assert_int_equal(set, lid);
      if (z > -height + 0.1 || (z < -height - 0.1 && from > 1.25))
        assert_false(set);
    }
    assert_int_equal(vxm_grid_count(grid) > 0, lid || kept);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/* ---- Cavities ---- */

static void turn_faces(vxm_soup *soup, size_t first) {
  vxm_rng rng = {1};
  vxm_soup view = *soup;
  view.offsets += first;
  view.face_count -= first;
  damage(&view, &rng, 0, 2);
}

static void test_cavities(void **state) {
  (void)state;
  const int64_t solid = 40 * 40 * 40, inner = 20 * 20 * 20;
  for (int inward = 0; inward < 2; inward++) {
    vxm_soup *soup = shape_empty(context);
    shape_box(soup, (double[]){-1.01, -1.01, -1.01}, (double[]){1.01, 1.01, 1.01});
    shape_box(soup, (double[]){-0.51, -0.51, -0.51}, (double[]){0.51, 0.51, 0.51});
    if (inward)
      turn_faces(soup, 6);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    for (int rule = VXM_CAVITIES_AUTO; rule <= VXM_CAVITIES_FILL; rule++) {
      bool hollow = rule == VXM_CAVITIES_KEEP || (rule == VXM_CAVITIES_AUTO && inward);
      options.cavities = (vxm_cavities)rule;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = voxelize(soup, options, &report);
      assert_int_equal(report.cavities, hollow);
      assert_int_equal(vxm_grid_count(grid), hollow ? solid - inner : solid);
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
  }
}

/* ---- Winding numbers ---- */

static void test_winding_method_equals_parity_on_closed_meshes(void **state) {
  (void)state;
  vxm_soup *clean = torus(), *turned = torus();
  vxm_rng rng = {4};
  damage(turned, &rng, 0, 0.5);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  vxm_grid *truth = voxelize(clean, options, NULL);
  options.method = VXM_METHOD_WINDING;
  vxm_grid *grid = voxelize(turned, options, NULL);
  assert_true(iou(grid, truth) > 0.9999);
  vxm_grid_destroy(grid);
  vxm_grid_destroy(truth);
  vxm_soup_destroy(turned);
  vxm_soup_destroy(clean);
}

/** Triangles that share no vertices and are turned at random: every one is a patch of its own. */
static void test_patches_are_turned_outward(void **state) {
  (void)state;
  vxm_soup *clean = torus(), *soup = shape_empty(context);
  vxm_rng rng = {5};
  for (size_t f = 0; f < clean->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(clean, f, &n);
    uint32_t own[4];
    for (size_t c = 0; c < n; c++) {
      const double *p = vxm_position(clean, corner[c]);
      own[c] = shape_vertex(soup, p[0], p[1], p[2]);
    }
    shape_face(soup, own, n);
  }
  damage(soup, &rng, 0, 0.5);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *truth = voxelize(clean, options, NULL);
  vxm_lattice lattice = vxm_lattice_of(&cube64);
  vxm_triangle_set triangles;
  vxm_split_rule rule = {VXM_SPLIT_MODE_AUTO, VXM_CAVITIES_AUTO, true};
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  vxm_snapped_points placed = {.context = context};
  assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, false, NULL), VXM_OK);
  vxm_facings turns;
  const uint64_t *const voters[3] = {truth->words, truth->words, truth->words};
  assert_int_equal(
      vxm_orient_patches_find(&turns, &triangles, &placed, 0, triangles.split.part_count, voters, true, NULL),
      VXM_OK);
  assert_int_equal(turns.patch_count, soup->face_count);
  double volume = 0;
  for (size_t t = 0; t < turns.count; t++) {
    double c[3][3];
    for (int k = 0; k < 3; k++) {
      vxm_point p = vxm_snapped_points_at(
          &placed, triangles.corners[t][turns.facing[t] == VXM_FACING_IN ? (3 - k) % 3 : k]);
      for (int a = 0; a < 3; a++)
        c[k][a] = (double)p.at[a] / (double)lattice.unit;
    }
    for (int a = 0; a < 3; a++)
      volume += (c[0][a] - 32) * ((c[1][(a + 1) % 3] - 32) * (c[2][(a + 2) % 3] - 32) -
                                  (c[1][(a + 2) % 3] - 32) * (c[2][(a + 1) % 3] - 32));
  }
  double true_volume = 2 * M_PI * M_PI * 0.45 * 0.45 / pow(0.05, 3);
  assert_true(fabs(volume / 6 / true_volume - 1) < 0.02);
  vxm_facings_destroy(&turns);
  vxm_snapped_points_destroy(&placed);
  vxm_triangle_set_destroy(&triangles);
  vxm_grid *grid = voxelize(soup, options, NULL);
  assert_true(iou(grid, truth) > 0.999);
  vxm_grid_destroy(grid);
  vxm_grid_destroy(truth);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(clean);
}

static void test_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  uint64_t hash[3][2];
  for (int t = 0; t < 3; t++) {
    vxm_context_options with = VXM_CONTEXT_OPTIONS_INIT;
    with.threads = threads[t];
    vxm_context *shared = context;
    assert_int_equal(vxm_context_create(&context, &with, NULL), VXM_OK);
    vxm_soup *soup = torus();
    vxm_rng rng = {6};
    damage(soup, &rng, 0.1, 0.3);
    add_panel(soup, 1, 0.8, 0.9, 5);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.split_mode = VXM_SPLIT_MODE_WHOLE;
    for (int m = 0; m < 2; m++) {
      options.method = m ? VXM_METHOD_WINDING : VXM_METHOD_VOTE;
      vxm_grid *grid = voxelize(soup, options, NULL);
      hash[t][m] = vxm_grid_hash(grid);
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
    context = shared;
  }
  for (int t = 1; t < 3; t++)
    for (int m = 0; m < 2; m++)
      assert_true(hash[t][m] == hash[0][m]);
}

/* ---- However vertices and faces are numbered ---- */

static void permute(size_t *order, size_t count, vxm_rng *rng) {
  for (size_t i = 0; i < count; i++) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    order[i] = order[j];
    order[j] = i;
  }
}

/** The same mesh: vertices numbered otherwise, faces in another order, each from another corner on. */
static vxm_soup *shuffled(const vxm_soup *soup, vxm_rng *rng) {
  vxm_soup *out = shape_empty(context);
  size_t *vertex = calloc(soup->vertex_count + 1, sizeof *vertex),
         *face = calloc(soup->face_count + 1, sizeof *face);
  uint32_t *number = calloc(soup->vertex_count + 1, sizeof *number);
  assert_true(vertex && face && number);
  permute(vertex, soup->vertex_count, rng);
  permute(face, soup->face_count, rng);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    const double *p = vxm_position(soup, vertex[v]);
    shape_vertex(out, p[0], p[1], p[2]);
    number[vertex[v]] = (uint32_t)v;
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    uint32_t corners[8];
    const uint32_t *corner = vxm_face(soup, face[f], &n);
    assert_true(n <= 8);
    size_t first = (size_t)vxm_rng_below(rng, n);
    for (size_t c = 0; c < n; c++)
      corners[c] = number[corner[(first + c) % n]];
    shape_face(out, corners, n);
  }
  free(vertex);
  free(face);
  free(number);
  return out;
}

/** The surface of a box of n by n squares a side, without those that chance takes: most of its vertices have
 * more than one hole, and angles at them are equal; lengths are not, as rounding decides in the middle of
 * what is symmetric. */
static vxm_soup *sieve(int n, double removed, vxm_rng *rng) {
  vxm_soup *soup = shape_empty(context);
  uint32_t number[10][10][10];
  for (int x = 0; x <= n; x++)
    for (int y = 0; y <= n; y++)
      for (int z = 0; z <= n; z++) {
        number[x][y][z] = (uint32_t)soup->vertex_count;
        shape_vertex(soup, 1.9 * x / n - 1.1 + 0.011 * x * x / n, 1.7 * y / n - 0.9 + 0.017 * y * y / n,
                     2.1 * z / n - 1.13 + 0.007 * z * z / n);
      }
  for (int side = 0; side < 6; side++)
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        uint32_t corner[4];
        for (int c = 0; c < 4; c++) {
          int k = side % 2 ? c : 3 - c, at[3];
          at[side / 2] = side % 2 ? n : 0;
          at[(side / 2 + 1) % 3] = i + (k == 1 || k == 2);
          at[(side / 2 + 2) % 3] = j + (k >= 2);
          corner[c] = number[at[0]][at[1]][at[2]];
        }
        if (vxm_rng_unit(rng) >= removed)
          shape_face(soup, corner, 4);
      }
  return soup;
}

/** A box without a bottom, with a wall across, as the steps before a bath make it. Every edge at the wall has
 * three faces, and at its lower corners four rims meet at right angles. */
static vxm_soup *walled_box(double wall, double height) {
  static const uint8_t quads[9][4] = {{0, 1, 3, 2},   {4, 6, 7, 5}, {8, 10, 11, 9},
                                      {0, 4, 5, 1},   {4, 8, 9, 5}, {2, 3, 7, 6},
                                      {6, 7, 11, 10}, {1, 5, 7, 3}, {5, 9, 11, 7}};
  vxm_soup *soup = shape_empty(context);
  const double x[3] = {-1.1, wall, 1};
  for (int v = 0; v < 12; v++) /* the lowest bit is y, the next one z */
    shape_vertex(soup, x[v / 4], v & 1 ? height : -1.3, v & 2 ? 1.2 : -1.17);
  for (int q = 0; q < 9; q++)
    shape_face(soup, (uint32_t[]){quads[q][0], quads[q][1], quads[q][2], quads[q][3]}, 4);
  return soup;
}

static void expect_the_same_shuffled(const vxm_soup *soup, const vxm_grid *expected, vxm_rng *rng) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  for (int s = 0; s < 6; s++) {
    vxm_soup *other = shuffled(soup, rng);
    vxm_grid *grid = voxelize(other, options, NULL);
    assert_true(iou(expected, grid) == 1);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(other);
  }
}

/** The whole rim is closed, and the wall is none. */
static void test_a_wall_across_an_open_box(void **state) {
  (void)state;
  vxm_rng rng = {12};
  for (int round = 0; round < 12; round++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    double height = 0.1 + 0.2 * (round / 4), low[3] = {-1.1, -1.3, -1.17}, high[3] = {1, height, 1.2};
    vxm_soup *box = shape_empty(context), *walled = walled_box(-0.31 + 0.2 * (round % 4), height);
    shape_box(box, low, high);
    vxm_grid *expected = voxelize(box, options, NULL);
    expect_the_same_shuffled(walled, expected, &rng);
    vxm_grid_destroy(expected);
    vxm_soup_destroy(walled);
    vxm_soup_destroy(box);
  }
}

static void test_numbers_decide_nothing(void **state) {
  (void)state;
  vxm_rng rng = {11};
  for (int round = 0; round < 30; round++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_soup *soup = sieve(3 + round % 6, 0.1 + 0.1 * (round % 4), &rng);
    vxm_grid *expected = voxelize(soup, options, NULL);
    expect_the_same_shuffled(soup, expected, &rng);
    vxm_grid_destroy(expected);
    vxm_soup_destroy(soup);
  }
}

/* ---- Confidence ---- */

static void test_confidence(void **state) {
  (void)state;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_soup *soup = torus();
  vxm_grid *grid = voxelize(soup, options, NULL);
  assert_null(vxm_grid_confidence(grid));
  vxm_grid_destroy(grid);
  options.confidence = true;
  grid = voxelize(soup, options, NULL);
  const uint8_t *closed = vxm_grid_confidence(grid);
  for (int v = 0; v < 64 * 64 * 64; v++)
    assert_int_equal(closed[v], 255);
  vxm_grid_destroy(grid);
  vxm_rng rng = {7};
  damage(soup, &rng, 0.05, 0);
  for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_WINDING; method++) {
    options.method = (vxm_method)method;
    grid = voxelize(soup, options, NULL);
    const uint8_t *confidence = vxm_grid_confidence(grid);
    int sure = 0, unsure = 0;
    for (int v = 0; v < 64 * 64 * 64; v++) {
      sure += confidence[v] >= 250;
      unsure += confidence[v] < 200;
    }
    assert_true(sure > 64 * 64 * 64 / 2 && unsure > 0);
    vxm_grid_destroy(grid);
  }
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangles_and_caps_are_closed),
      cmocka_unit_test(test_holes_are_capped),
      cmocka_unit_test(test_panels_make_a_body),
      cmocka_unit_test(test_a_sheet),
      cmocka_unit_test(test_half_a_pipe),
      cmocka_unit_test(test_a_bent_sheet),
      cmocka_unit_test(test_cavities),
      cmocka_unit_test(test_winding_method_equals_parity_on_closed_meshes),
      cmocka_unit_test(test_patches_are_turned_outward),
      cmocka_unit_test(test_same_bits_for_any_number_of_threads),
      cmocka_unit_test(test_a_wall_across_an_open_box),
      cmocka_unit_test(test_numbers_decide_nothing),
      cmocka_unit_test(test_confidence),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
