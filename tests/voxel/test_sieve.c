/* SPDX-License-Identifier: BSD-3-Clause */
/** The sieve of thin parts: what it puts aside meets nothing without a voxel, in every build. */
#include "thin_meshes.h"
#include "thin_rule.h"

#include "voxel/parity/kernels.h"
#include "voxel/thin/sieve_kernels.h"
#include "voxel/thin/slice_order.h"

/** The border of a solid. */
typedef struct border {
  double at[3], normal[3];
  bool is_noise; /**< there is none: a third of the voxels is set */
} border;

static border random_border(vxm_rng *rng, const vxm_space *space) {
  border b = {.is_noise = false};
  double squared = 0;
  for (int a = 0; a < 3; a++) {
    b.at[a] = (double)space->dims[a] * (0.3 + 0.4 * vxm_rng_unit(rng));
    b.normal[a] = 0.01 + vxm_rng_unit(rng) - 0.5;
    squared += b.normal[a] * b.normal[a];
  }
  for (int a = 0; a < 3; a++)
    b.normal[a] /= sqrt(squared);
  return b;
}

static double beyond(const border *b, const double p[3]) {
  return b->normal[0] * (p[0] - b->at[0]) + b->normal[1] * (p[1] - b->at[1]) +
         b->normal[2] * (p[2] - b->at[2]);
}

/** Triangles of up to 7 voxels, some longer along x, most of them at the border. Corners of some lie on
 * centres. */
static vxm_soup *random_triangles(vxm_rng *rng, const vxm_space *space, const border *b, int count,
                                  double longest) {
  static const double sizes[6] = {0.2, 1, 2, 3, 5, 7};
  vxm_soup *soup = shape_empty(context);
  for (int i = 0; i < count; i++) {
    uint32_t corner[3];
    double centre[3], size = sizes[vxm_rng_below(rng, 6)];
    for (int a = 0; a < 3; a++)
      centre[a] = (double)space->dims[a] * (0.2 + 0.6 * vxm_rng_unit(rng));
    for (int k = 0; k < 3; k++) {
      double at[3], off;
      for (int a = 0; a < 3; a++)
        at[a] = centre[a] + (i % 9 == 0 && a == 0 ? longest : size) * (vxm_rng_unit(rng) - 0.5);
      off = i % 5 ? 0.2 * vxm_rng_unit(rng) - beyond(b, at) : 0;
      for (int a = 0; a < 3; a++) {
        at[a] += off * b->normal[a];
        if (i % 7 == 0)
          at[a] = floor(4 * at[a]) / 4;
        if (i % 14 == 0 && a == i / 14 % 3)
          at[a] = floor(centre[a]) + 0.5;
      }
      corner[k] = shape_vertex(soup, at[0], at[1], at[2]);
    }
    shape_triangle(soup, corner[0], corner[1], corner[2]);
  }
  return soup;
}

/** Voxels beyond the border, or a sheet of them; a few are turned. */
static void random_solid(vxm_rng *rng, vxm_window *window, const border *b) {
  double thickness = vxm_rng_below(rng, 4) ? 100 : 2;
  uint64_t turned = vxm_rng_below(rng, 2) ? 1000 : 30;
  const int axis[3] = {window->layout.fast, window->layout.middle, window->layout.slow};
  for (int64_t s = window->begin; s < window->end; s++)
    for (int64_t m = 0; m < window->middle_dim; m++)
      for (int64_t f = 0; f < window->fast_dim; f++) {
        double p[3];
        p[axis[0]] = (double)f + 0.5;
        p[axis[1]] = (double)m + 0.5;
        p[axis[2]] = (double)s + 0.5;
        double depth = beyond(b, p);
        bool set = (depth > 0 && depth < thickness) != (vxm_rng_below(rng, turned) == 0);
        set = b->is_noise ? vxm_rng_below(rng, 3) == 0 : set;
        vxm_window_row(window, m, s)[f / 64] |= (uint64_t)set << (f % 64);
      }
}

/** Whether an exact record of a triangle is one of a cell without a voxel. */
static bool meets_something(const thin_mesh *mesh, const vxm_view *view, const thin_triangle *t) {
  thin_records records = {.space = &mesh->lattice.space};
  bool meets = false;
  thin_note_links(&records, mesh, t, 3);
  thin_note_squares(&records, mesh, t);
  thin_note_cube(&records, mesh, t);
  for (size_t r = 0; r < records.count && !meets; r++) {
    int64_t ends[8][3];
    bool held;
    int count = vxm_dual_ends(ends, records.list[r].kind, records.list[r].lowest);
    meets = !vxm_view_any_set(view, (const int64_t(*)[3])ends, count, &held) && held;
  }
  free(records.list);
  return meets;
}

typedef struct counts {
  size_t all, meeting, kept;
} counts;

static void check_builds(const vxm_thin_job *job, const bool *meets, counts *sum) {
  const vxm_kernels *builds[3];
  size_t count = vxm_kernels_all(builds), all = job->triangles->triangle_count,
         looked_at = job->order ? job->order_count : all;
  vxm_sieve sieve;
  assert_true(vxm_sieve_of(&sieve, job));
  uint32_t *kept = malloc((VXM_SIEVE_BATCH + 16) * sizeof *kept);
  bool *is_kept = malloc(all);
  assert_true(kept && is_kept);
  for (size_t b = 0; b < count; b++) {
    memset(is_kept, 0, all);
    for (size_t begin = 0, end; begin < looked_at; begin = end) {
      end = begin + 50 < looked_at ? begin + 50 : looked_at;
      size_t next = begin, found = vxm_sieve_kernels_of(builds[b])->sift(&sieve, kept, &next, end);
      assert_int_equal(next, end);
      for (size_t k = 0; k < found; k++) {
        assert_in_range(kept[k], job->order ? 0 : begin, (job->order ? all : end) - 1);
        assert_false(is_kept[kept[k]]);
        is_kept[kept[k]] = true;
      }
    }
    for (size_t t = 0; t < all; t++) {
      if (meets[t] && !is_kept[t])
        fail_msg("%s puts triangle %zu aside", vxm_cpu_level_name(builds[b]->level), t);
      bool is_face = vxm_role_of(job->triangles, t) == VXM_ROLE_FACE;
      sum->all += is_face;
      sum->meeting += meets[t];
      sum->kept += is_face && is_kept[t];
    }
  }
  free(kept);
  free(is_kept);
}

/** That many triangles at once, which the kernels take in pieces, are kept as one after the other. */
static void check_pieces(const vxm_thin_job *job) {
  const vxm_kernels *builds[3];
  size_t count = vxm_kernels_all(builds), all = job->triangles->triangle_count;
  vxm_sieve sieve;
  assert_true(vxm_sieve_of(&sieve, job));
  uint32_t kept[VXM_SIEVE_BATCH + 16];
  bool *is_kept = malloc(all);
  assert_non_null(is_kept);
  for (size_t b = 0; b < count; b++) {
    const vxm_sieve_kernels *build = vxm_sieve_kernels_of(builds[b]);
    memset(is_kept, 0, all);
    for (size_t next = 0; next < all;) {
      size_t begin = next, found = build->sift(&sieve, kept, &next, all);
      assert_true(next > begin && found <= VXM_SIEVE_BATCH);
      for (size_t k = 0; k < found; k++)
        is_kept[kept[k]] = true;
    }
    for (size_t t = 0; t < all; t++) {
      size_t next = t;
      assert_int_equal(build->sift(&sieve, kept, &next, t + 1), is_kept[t]);
    }
  }
  free(is_kept);
}

/** The same in the order of slices, in which no triangle comes twice. */
static void check_order(const vxm_thin_job *job, const bool *meets, counts *sum) {
  vxm_slice_order order = {.context = context};
  vxm_thin_job ordered = *job;
  assert_int_equal(vxm_slice_order_make(&order, job, NULL), VXM_OK);
  ordered.order = order.triangles;
  ordered.order_count = order.count;
  check_builds(&ordered, meets, sum);
  vxm_slice_order_destroy(&order);
}

/** @param sum NULL = pieces alone are looked at */
static void check_window(vxm_rng *rng, const vxm_triangle_set *triangles, const vxm_snapped_points *placed,
                         vxm_window *window, const border *b, counts *sum) {
  thin_mesh mesh = {.lattice = placed->lattice};
  size_t words = window->slice_words * (size_t)(window->end - window->begin), all = triangles->triangle_count;
  window->words = calloc(words, sizeof *window->words);
  uint64_t *maps = calloc(vxm_all_middle_words(words), sizeof *maps);
  uint32_t *cells = calloc(triangles->point_count, sizeof *cells);
  bool *meets = calloc(all, sizeof *meets);
  assert_true(window->words && maps && cells && meets);
  random_solid(rng, window, b);
  vxm_thin_job job = {.triangles = triangles,
                      .corners = (const uint32_t(*)[3])triangles->corners,
                      .placed = placed,
                      .view = vxm_view_of(window),
                      .slow = window->layout.slow,
                      .directions = 3};
  for (size_t t = 0; sum && t < all; t++) {
    thin_triangle one;
    if (vxm_role_of(triangles, t) != VXM_ROLE_FACE) /* cones over what is open do not count */
      continue;
    for (int k = 0; k < 3; k++)
      one.at[k] = vxm_snapped_points_at(placed, triangles->corners[t][k]);
    meets[t] = meets_something(&mesh, &job.view, &one);
  }
  if (sum) {
    check_builds(&job, meets, sum);
    check_order(&job, meets, sum);
  } else
    check_pieces(&job);
  if (!vxm_cells_fit_short(window)) {
    free(meets);
    free(maps);
    free(cells);
    free(window->words);
    return;
  }
  assert_true(vxm_middles_fit(window));
  vxm_sieve_kernels_of(NULL)->shorten(cells, placed->cells, triangles->point_count, job.view.axis);
  job.short_cells = cells;
  if (sum) {
    check_builds(&job, meets, sum);
    check_order(&job, meets, sum);
  } else
    check_pieces(&job);
  vxm_middles_fill(maps, window);
  job.middles = maps;
  if (sum)
    check_builds(&job, meets, sum);
  else
    check_pieces(&job);
  free(meets);
  free(maps);
  free(cells);
  free(window->words);
}

/** Triangles of up to two voxels on the walls, edges and corners of a space, and beyond. */
static vxm_soup *triangles_at_walls(vxm_rng *rng, const vxm_space *space, int count) {
  vxm_soup *soup = shape_empty(context);
  for (int i = 0; i < count; i++) {
    uint32_t corner[3];
    double centre[3], size = 0.3 + 1.7 * vxm_rng_unit(rng);
    for (int a = 0; a < 3; a++) {
      uint64_t where = vxm_rng_below(rng, 3);
      double to = where == 0 ? 0 : where == 1 ? 1 : vxm_rng_unit(rng);
      centre[a] = to * (double)space->dims[a] + 1.5 * (vxm_rng_unit(rng) - 0.5);
    }
    for (int k = 0; k < 3; k++) {
      double at[3];
      for (int a = 0; a < 3; a++)
        at[a] = centre[a] + size * (vxm_rng_unit(rng) - 0.5);
      corner[k] = shape_vertex(soup, at[0], at[1], at[2]);
    }
    shape_triangle(soup, corner[0], corner[1], corner[2]);
  }
  return soup;
}

static void check_space(vxm_rng *rng, int round, bool walls, counts *sum) {
  static const vxm_layout layouts[6] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  vxm_layout layout = layouts[round % 6];
  vxm_space space = engine_space(1, 1, 1);
  for (int a = 0; a < 3; a++)
    space.dims[a] = 14 + (int64_t)vxm_rng_below(rng, a == layout.fast ? 60 : 8);
  const bool is_long = !walls && round % 8 == 7; /* cells have no short numbers */
  if (is_long)
    space.dims[0] = 600 + (int64_t)vxm_rng_below(rng, 2000);
  border b = random_border(rng, &space);
  b.is_noise = walls;
  vxm_soup *soup = walls ? triangles_at_walls(rng, &space, sum ? 200 : 5000)
                         : random_triangles(rng, &space, &b, 37, is_long ? 1500 : 25);
  vxm_triangle_set triangles;
  vxm_split_rule rule = {.split_mode = VXM_SPLIT_MODE_WHOLE};
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_snapped_points placed = {.context = context};
  assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, false, NULL), VXM_OK);
  int64_t begin = (int64_t)vxm_rng_below(rng, 2),
          end = space.dims[layout.slow] - (int64_t)vxm_rng_below(rng, 3);
  vxm_window window = vxm_window_of(&space, layout, begin, end);
  check_window(rng, &triangles, &placed, &window, &b, sum);
  vxm_snapped_points_destroy(&placed);
  vxm_triangle_set_destroy(&triangles);
  vxm_soup_destroy(soup);
}

static void test_what_is_put_aside_meets_nothing(void **state) {
  (void)state;
  vxm_rng rng = {511};
  counts sum = {0};
  for (int round = 0; round < ROUNDS(48); round++)
    check_space(&rng, round, false, &sum);
  print_message("%zu of %zu meet something, %zu are kept\n", sum.meeting, sum.all, sum.kept);
  assert_true(sum.kept < sum.all - sum.all / 4);
}

/** The short numbers of cells and the maps, which only one build makes above. */
static void test_every_build_makes_the_same_maps(void **state) {
  (void)state;
  enum { MOST = 1200 };
  const vxm_kernels *builds[3];
  size_t builds_count = vxm_kernels_all(builds);
  vxm_rng rng = {512};
  uint64_t from[MOST], to[MOST];
  uint32_t cells[MOST];
  for (int round = 0; round < ROUNDS(40) * (int)builds_count; round++) {
    const vxm_sieve_kernels *build = vxm_sieve_kernels_of(builds[(size_t)round % builds_count]);
    size_t count = (size_t)vxm_rng_below(&rng, round % 8 ? 40 : MOST),
           step = 1 + (size_t)vxm_rng_below(&rng, round % 3 ? 9 : 200);
    const uint32_t most = (1U << (VXM_SHORT_BITS - 1)) - 1;
    for (size_t i = 0; i < count; i++)
      from[i] = vxm_rng_below(&rng, most) | vxm_rng_below(&rng, most) << VXM_CELL_BITS |
                vxm_rng_below(&rng, most) << 2 * VXM_CELL_BITS;
    const int first = (int)vxm_rng_below(&rng, 3), next = (first + 1 + (int)vxm_rng_below(&rng, 2)) % 3,
              axis[3] = {first, next, 3 - first - next};
    build->shorten(cells, from, count, axis);
    for (size_t i = 0; i < count; i++)
      for (int a = 0; a < 3; a++)
        assert_int_equal(cells[i] >> a * VXM_SHORT_BITS & most, from[i] >> axis[a] * VXM_CELL_BITS & most);
    for (size_t i = 0; i < count; i++)
      from[i] = vxm_rng_next(&rng) & vxm_rng_next(&rng);
    build->join(to, from, step, count);
    for (size_t i = 0; i < count; i++)
      assert_true(to[i] == (from[i] | (i < step ? 0 : from[i - step])));
  }
}

/** At the border of a window only one side of a cell has voxels. */
static void test_nor_does_what_is_at_walls(void **state) {
  (void)state;
  vxm_rng rng = {512};
  counts sum = {0};
  for (int round = 0; round < ROUNDS(12); round++)
    check_space(&rng, round, true, &sum);
  assert_true(sum.kept < sum.all);
}

static void test_pieces_do_not_matter(void **state) {
  (void)state;
  vxm_rng rng = {513};
  for (int round = 0; round < ROUNDS(12); round++)
    check_space(&rng, round, true, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_put_aside_meets_nothing),
                                     cmocka_unit_test(test_every_build_makes_the_same_maps),
                                     cmocka_unit_test(test_nor_does_what_is_at_walls),
                                     cmocka_unit_test(test_pieces_do_not_matter)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
