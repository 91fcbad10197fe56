/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces between voxel centres: closed and manifold, with each set centre inside, whatever the bits. */
#include "../repair/solids.h"

#include "remesh/cube_cycles.h"
#include "remesh/dual_surface.h"
#include "repair/repair.h"

/** Each crossed link is in one cycle of three or more, and a cycle goes from link to link in a face. */
static void test_cycles(void **state) {
  (void)state;
  vxm_cube_cycles cycles[VXM_CUBE_CONFIGURATIONS];
  vxm_cube_cycles_find(cycles);
  for (unsigned set = 0; set < VXM_CUBE_CONFIGURATIONS; set++) {
    int length[4] = {0};
    for (int link = 0; link < VXM_CUBE_LINKS; link++) {
      int p = vxm_cube_link_begin(link), q = p | 1 << link / 4;
      assert_int_not_equal(p, q);
      bool crossed = (set >> p & 1) != (set >> q & 1);
      assert_int_equal(crossed, cycles[set].cycle[link] != VXM_NO_CYCLE);
      if (crossed) {
        assert_true(cycles[set].cycle[link] < cycles[set].count);
        length[cycles[set].cycle[link]]++;
      }
    }
    assert_true(cycles[set].count <= 4);
    for (int c = 0; c < cycles[set].count; c++)
      assert_true(length[c] >= 3);
  }
  assert_int_equal(cycles[0].count, 0);
  assert_int_equal(cycles[1].count, 1);
  assert_int_equal(cycles[1 | 1 << 3].count, 2);           /* over an edge: apart */
  assert_int_equal(cycles[0xff & ~(1 | 1 << 7)].count, 2); /* two empty corners */
  assert_int_equal(cycles[1 | 1 << 3 | 1 << 5 | 1 << 6].count, 4);
}

typedef struct sample {
  vxm_space space;
  uint64_t *bits;
  float (*shares)[3]; /**< of the links that begin at each centre */
} sample;

/** Random bits, and crossings anywhere on the links. */
static sample random_sample(vxm_rng *rng, unsigned filled) {
  sample s = {.space = {.origin = {-1, 2, 3}, .voxel_size = {0.5, 0.5, 0.5}}};
  for (int a = 0; a < 3; a++)
    s.space.dims[a] = 3 + (int64_t)vxm_rng_below(rng, a == 0 ? 70 : 5);
  size_t words = (size_t)(s.space.dims[0] + 63) / 64, rows = (size_t)(s.space.dims[1] * s.space.dims[2]);
  s.bits = calloc(words * rows, sizeof *s.bits);
  s.shares = calloc(rows * (size_t)s.space.dims[0], sizeof *s.shares);
  assert_true(s.bits && s.shares);
  for (size_t r = 0; r < rows; r++)
    for (size_t i = 0; i < (size_t)s.space.dims[0]; i++) {
      bool set = vxm_rng_below(rng, 8) < filled;
      s.bits[r * words + i / 64] |= (uint64_t)set << (i % 64);
      for (int a = 0; a < 3; a++)
        s.shares[r * (size_t)s.space.dims[0] + i][a] = (float)(3 * vxm_rng_unit(rng) - 1);
    }
  return s;
}

static bool is_inside(const sample *s, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = s->space.dims, at[3] = {i, j, k};
  for (int a = 0; a < 3; a++)
    if (at[a] == 0 || at[a] == dims[a] - 1)
      return false; /* the outermost count as empty */
  return s->bits[(k * dims[1] + j) * ((dims[0] + 63) / 64) + i / 64] >> (i % 64) & 1;
}

static vxm_soup *surface_of(const sample *s, bool *meets_itself) {
  vxm_dual_surface *surface;
  const int64_t *dims = s->space.dims;
  assert_int_equal(vxm_dual_surface_create(&surface, context, &s->space, NULL), VXM_OK);
  for (int64_t k = 0; k < dims[2]; k++)
    assert_int_equal(vxm_dual_surface_put(surface, s->bits + k * dims[1] * ((dims[0] + 63) / 64),
                                          (const float(*)[3])s->shares + k * dims[1] * dims[0], NULL),
                     VXM_OK);
  vxm_soup *soup = vxm_dual_surface_take(surface, meets_itself);
  vxm_dual_surface_destroy(surface);
  return soup;
}

static void check_centres(const sample *s, const vxm_soup *soup, vxm_rng *rng) {
  for (int n = 0; n < 60; n++) {
    int64_t at[3];
    double p[3];
    for (int a = 0; a < 3; a++) {
      at[a] = (int64_t)vxm_rng_below(rng, (uint64_t)s->space.dims[a]);
      p[a] = s->space.origin[a] + ((double)at[a] + 0.5) * s->space.voxel_size[a];
    }
    assert_true(fabs(winding_at(soup, p) - is_inside(s, at[0], at[1], at[2])) < 1e-6);
  }
}

static void test_random(void **state) {
  (void)state;
  vxm_rng rng = {20};
  int plain = 0;
  for (int trial = 0; trial < 300; trial++) {
    sample s = random_sample(&rng, 1 + (unsigned)(trial % 7));
    bool meets_itself;
    vxm_soup *soup = surface_of(&s, &meets_itself);
    brute_report report = look_brute(soup);
    assert_int_equal(report.boundary_edges, 0);
    assert_int_equal(report.unpaired, 0);
    if (!meets_itself)
      assert_true(report.manifold);
    plain += !meets_itself && soup->face_count > 0;
    if (soup->face_count > 0)
      check_centres(&s, soup, &rng);
    vxm_soup_destroy(soup);
    free(s.bits);
    free(s.shares);
  }
  assert_true(plain > 20);
}

/** Of a ball's crossings: its volume and its radius, to the second order. */
static void test_ball(void **state) {
  (void)state;
  enum { N = 40 };
  const double radius = 15.3;
  sample s = {.space = {.dims = {N, N, N}, .origin = {0, 0, 0}, .voxel_size = {1, 1, 1}}};
  s.bits = calloc(N * N, sizeof *s.bits);
  s.shares = calloc((size_t)N * N * N, sizeof *s.shares);
  assert_true(s.bits && s.shares);
  for (size_t v = 0; v < (size_t)N * N * N; v++) {
    const double x[3] = {(double)(v % N) + 0.5 - 20.1, (double)(v / N % N) + 0.5 - 19.8,
                         (double)(v / N / N) + 0.5 - 20.3};
    double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - radius * radius;
    s.bits[v / N] |= (uint64_t)(square < 0) << (v % N);
    for (int a = 0; a < 3; a++) { /* the nearer of both places on the line through the link */
      double half = sqrt(fmax(x[a] * x[a] - square, 0));
      s.shares[v][a] = (float)((x[a] + 0.5 < 0 ? -half : half) - x[a]);
    }
  }
  bool meets_itself;
  vxm_soup *soup = surface_of(&s, &meets_itself);
  assert_false(meets_itself);
  assert_closed_manifold(soup);
  assert_true(fabs(volume_of(soup) / (4.0 / 3 * M_PI * radius * radius * radius) - 1) < 0.01);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    const double *p = vxm_position(soup, v);
    double r =
        sqrt((p[0] - 20.1) * (p[0] - 20.1) + (p[1] - 19.8) * (p[1] - 19.8) + (p[2] - 20.3) * (p[2] - 20.3));
    assert_true(fabs(r - radius) < 0.03);
  }
  vxm_soup_destroy(soup);
  free(s.bits);
  free(s.shares);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_cycles), cmocka_unit_test(test_random),
                                     cmocka_unit_test(test_ball)};
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
