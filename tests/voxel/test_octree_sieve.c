/* SPDX-License-Identifier: BSD-3-Clause */
/** The sieve of octrees: links that it does not tell have a voxel, in every build. */
#include "thin_meshes.h"
#include "thin_oracle.h"

#include "voxel/parity/kernels.h"
#include "voxel/thin/sieve_kernels.h"

/** A solid below a plane through `at`, or a plate, with some voxels turned. */
static vxm_sparse *random_solid(vxm_rng *rng, const vxm_space *space, const double at[3],
                                const double normal[3]) {
  double thickness = vxm_rng_below(rng, 4) ? 100 : 1.5;
  uint64_t turned = vxm_rng_below(rng, 2) ? 20000 : 50;
  vxm_grid *grid;
  vxm_sparse *octree;
  assert_int_equal(vxm_grid_create(&grid, context, space, NULL), VXM_OK);
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < space->dims[0]; i++) {
        double p[3] = {(double)i + 0.5, (double)j + 0.5, (double)k + 0.5}, above = 0;
        for (int a = 0; a < 3; a++)
          above += normal[a] * (p[a] - at[a]);
        bool set = (above < 0 && above > -thickness) != (vxm_rng_below(rng, turned) == 0);
        vxm_grid_set(grid, i, j, k, set);
      }
  assert_int_equal(vxm_sparse_from_grid(&octree, grid, NULL), VXM_OK);
  vxm_grid_destroy(grid);
  return octree;
}

/** A triangle in the plane, or nearly; corners of some lie on centres, some are along axes. */
static void random_triangle(vxm_rng *rng, const vxm_lattice *lattice, const double at[3],
                            const double normal[3], int round, vxm_point corner[3]) {
  double size = 3 + 25 * vxm_rng_unit(rng);
  for (int k = 0; k < 3; k++) {
    double p[3], above = 0, square = 0;
    for (int a = 0; a < 3; a++) {
      p[a] = at[a] + size * (vxm_rng_unit(rng) - 0.5);
      above += normal[a] * (p[a] - at[a]);
      square += normal[a] * normal[a];
    }
    above = above / square + (round % 4 ? 0 : 0.3 * (vxm_rng_unit(rng) - 0.5));
    for (int a = 0; a < 3; a++) {
      p[a] -= above * normal[a];
      if (round % 5 == 0)
        p[a] = floor(p[a]) + 0.5;
      corner[k].at[a] = llround(p[a] * (double)lattice->unit);
    }
  }
}

typedef struct counts {
  size_t looked_at, cleared, torn;
} counts;

/** Compares what a build says with every link near a triangle. */
static void check_triangle(const vxm_octree_sieve *sieve, const vxm_view *view, const thin_mesh *mesh,
                           const vxm_point corner[3], counts *sum) {
  const vxm_kernels *builds[3];
  size_t count = vxm_kernels_all(builds);
  thin_triangle t;
  memcpy(t.at, corner, sizeof t.at);
  for (size_t b = 0; b < 2 * count; b++) {
    const vxm_sieve_kernels *build = vxm_sieve_kernels_of(builds[b / 2]);
    vxm_unsure_links unsure = vxm_unsure_links_none();
    int inner = b % 2 ? 1 : -1;
    bool any = build->search_bricks(sieve, inner, &unsure);
    assert_int_equal(build->search_bricks(sieve, inner, NULL), any);
    sum->looked_at++;
    sum->cleared += !any;
    int64_t v[3];
    for (v[2] = sieve->begin[2] - 1; v[2] <= sieve->end[2]; v[2]++)
      for (v[1] = sieve->begin[1] - 1; v[1] <= sieve->end[1]; v[1]++)
        for (v[0] = sieve->begin[0] - 1; v[0] <= sieve->end[0]; v[0]++)
          for (int d = 0; d < 3; d++) {
            double along;
            int64_t upper[3] = {v[0] + (d == 0), v[1] + (d == 1), v[2] + (d == 2)};
            if (vxm_view_set(view, v) || vxm_view_set(view, upper) ||
                !thin_crosses_link(mesh, &t, v, thin_steps[d], &along))
              continue;
            sum->torn++;
            for (int a = 0; a < 3; a++)
              if (a != d && (v[a] < unsure.begin[d][a] || v[a] >= unsure.end[d][a]))
                fail_msg("%s forgets a link along %d", vxm_cpu_level_name(builds[b / 2]->level), d);
          }
  }
}

static void test_links_that_are_not_told_have_a_voxel(void **state) {
  (void)state;
  vxm_rng rng = {514};
  counts sum = {0};
  for (int round = 0; round < ROUNDS(60); round++) {
    vxm_space space = engine_space(1, 1, 1);
    double at[3], normal[3];
    for (int a = 0; a < 3; a++) {
      space.dims[a] = 36 + (int64_t)vxm_rng_below(&rng, 10);
      at[a] = (double)space.dims[a] / 2 + vxm_rng_unit(&rng);
      normal[a] = round % 6 == 5 ? a == round / 6 % 3 : vxm_rng_unit(&rng) - 0.5;
    }
    vxm_sparse *octree = random_solid(&rng, &space, at, normal);
    vxm_view view = vxm_view_of_octree(octree);
    thin_mesh mesh = {.lattice = vxm_lattice_of(&space)};
    for (int i = 0; i < 6; i++) {
      vxm_point corner[3];
      vxm_octree_sieve sieve;
      random_triangle(&rng, &mesh.lattice, at, normal, 6 * round + i, corner);
      if (vxm_octree_sieve_of(&sieve, &view, &mesh.lattice, corner))
        check_triangle(&sieve, &view, &mesh, corner, &sum);
    }
    vxm_sparse_destroy(octree);
  }
  print_message("%zu of %zu are cleared, %zu links have no voxel\n", sum.cleared, sum.looked_at, sum.torn);
  assert_true(sum.looked_at > 0 && sum.cleared > sum.looked_at / 8 && sum.torn > 0);
}

/** One that reaches out of the view, or has no area, is not for the sieve. */
static void test_what_the_sieve_is_not_for(void **state) {
  (void)state;
  vxm_space space = engine_space(20, 20, 20);
  const double at[3] = {10, 10, 10}, normal[3] = {0, 0, 1};
  vxm_rng rng = {515};
  vxm_sparse *octree = random_solid(&rng, &space, at, normal);
  vxm_view view = vxm_view_of_octree(octree);
  vxm_lattice lattice = vxm_lattice_of(&space);
  const int64_t unit = lattice.unit;
  vxm_point in[3] = {{{5 * unit, 5 * unit, 10 * unit}},
                     {{9 * unit, 5 * unit, 10 * unit}},
                     {{5 * unit, 9 * unit, 10 * unit}}};
  vxm_octree_sieve sieve;
  assert_true(vxm_octree_sieve_of(&sieve, &view, &lattice, in));
  view.begin[2] = 8;
  assert_false(vxm_octree_sieve_of(&sieve, &view, &lattice, in));
  view.begin[2] = 0;
  in[2] = in[1];
  assert_false(vxm_octree_sieve_of(&sieve, &view, &lattice, in));
  in[2].at[1] = 19 * unit;
  assert_false(vxm_octree_sieve_of(&sieve, &view, &lattice, in));
  vxm_sparse_destroy(octree);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_links_that_are_not_told_have_a_voxel),
                                     cmocka_unit_test(test_what_the_sieve_is_not_for)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
