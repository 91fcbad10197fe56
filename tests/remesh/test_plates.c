/* SPDX-License-Identifier: BSD-3-Clause */
/** What remeshing promises of plates and rods thinner than a voxel, wherever they lie on the grid. */
#include "../repair/solids.h"

#include "remesh/remesh.h"

typedef struct plate {
  double half[3]; /**< the sides, halved, in voxels; the third is the thickness */
  frame3 frame;
} plate;

static vxm_soup *plate_soup(const plate *p) {
  vxm_soup *soup;
  const double low[3] = {-p->half[0], -p->half[1], -p->half[2]};
  assert_int_equal(vxm_soup_create(&soup, context, "plate", NULL), VXM_OK);
  add_box(soup, low, p->half, &p->frame, true, false);
  return soup;
}

/** In voxels of side 1 whose centres are at whole numbers. */
static vxm_soup *remeshed(const plate *p) {
  vxm_space space = {.voxel_size = {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_voxelize_report report = {0};
  vxm_soup *soup = plate_soup(p), *out;
  for (int a = 0; a < 3; a++) {
    double reach = 0;
    for (int b = 0; b < 3; b++)
      reach += fabs(p->frame.m[a][b]) * p->half[b];
    space.origin[a] = floor(p->frame.move[a] - reach) - 1.5;
    space.dims[a] = (int64_t)(2 * reach) + 5;
  }
  assert_int_equal(vxm_remesh(&out, &report, soup, &space, &options, NULL), VXM_OK);
  vxm_soup_destroy(soup);
  return out;
}

/** Where a line from a point on the middle of the plate, along its normal, meets a surface. */
typedef struct meeting {
  int count;
  double low, high;
} meeting;

static meeting meet(const vxm_soup *soup, const double from[3], const double along[3]) {
  meeting out = {0, INFINITY, -INFINITY};
  for (size_t f = 0; f < soup->face_count; f++) {
    const double *p[3];
    double u[3], v[3], n[3], w[3], m[3];
    for (size_t c = 0; c < 3; c++)
      p[c] = vxm_position(soup, soup->indices[soup->offsets[f] + c]);
    for (int a = 0; a < 3; a++) {
      u[a] = p[1][a] - p[0][a];
      v[a] = p[2][a] - p[0][a];
      w[a] = from[a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      n[a] = along[b] * v[c] - along[c] * v[b];
      m[a] = w[b] * u[c] - w[c] * u[b];
    }
    double det = n[0] * u[0] + n[1] * u[1] + n[2] * u[2];
    double s = (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]) / det;
    double t = (m[0] * along[0] + m[1] * along[1] + m[2] * along[2]) / det;
    double at = (m[0] * v[0] + m[1] * v[1] + m[2] * v[2]) / det;
    if (fabs(det) < 1e-12 || s < 0 || t < 0 || s + t > 1)
      continue;
    out.count++;
    out.low = fmin(out.low, at);
    out.high = fmax(out.high, at);
  }
  return out;
}

/** A plate at random, or at an offset that puts a face or its middle on centres. */
static plate random_plate(vxm_rng *rng, int trial) {
  static const double thicknesses[] = {1e-3, 0.1, 0.3, 0.5, 2.0 / 3, 0.75, 0.9, 1, 1.25, 1.5};
  plate p = {{5 + vxm_rng_unit(rng), 5 + vxm_rng_unit(rng), thicknesses[vxm_rng_below(rng, 10)] / 2},
             upright};
  bool slanted = trial % 2;
  if (slanted)
    p.frame = random_frame(rng);
  for (int a = 0; a < 3; a++)
    p.frame.move[a] = vxm_rng_unit(rng);
  if (!slanted && trial % 4 == 0)
    p.frame.move[2] = (double)vxm_rng_below(rng, 3) - 1 + ((double)vxm_rng_below(rng, 3) - 1) * p.half[2];
  if (!slanted) { /* which axis is across */
    int turn = (int)vxm_rng_below(rng, 3);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        p.frame.m[a][b] = (a - b - turn + 6) % 3 == 0;
    double across = p.frame.move[2];
    p.frame.move[2] = p.frame.move[(2 + turn) % 3];
    p.frame.move[(2 + turn) % 3] = across;
  }
  return p;
}

/** Away from the rim it is one sheet thick enough, with its middle where that of the plate is. */
static void test_plates(void **state) {
  (void)state;
  vxm_rng rng = {77};
  double worst[3] = {INFINITY, INFINITY, 0};
  for (int trial = 0; trial < 400; trial++) {
    plate p = random_plate(&rng, trial);
    vxm_soup *soup = remeshed(&p);
    assert_closed_manifold(soup);
    for (int n = 0; n < 10; n++) {
      const double x = (p.half[0] - 2.5) * (2 * vxm_rng_unit(&rng) - 1),
                   y = (p.half[1] - 2.5) * (2 * vxm_rng_unit(&rng) - 1);
      double from[3], along[3];
      for (int a = 0; a < 3; a++) {
        from[a] = p.frame.m[a][0] * x + p.frame.m[a][1] * y + p.frame.move[a];
        along[a] = p.frame.m[a][2];
      }
      meeting m = meet(soup, from, along);
      assert_int_equal(m.count, 2);
      worst[0] = fmin(worst[0], m.high - m.low);
      worst[1] = fmin(worst[1], m.high - m.low - 2 * p.half[2]);
      worst[2] = fmax(worst[2], fabs(m.high + m.low) / 2);
    }
    vxm_soup_destroy(soup);
  }
  assert_true(worst[0] >= 2.0 / 3);
  assert_true(worst[1] > -0.05); /* nor is one thinner than it is */
  assert_true(worst[2] < 0.5);
}

/** Rods along the axes, with or without a centre in them: square, two thirds of a voxel or more. */
static void test_rods(void **state) {
  (void)state;
  vxm_rng rng = {78};
  for (int trial = 0; trial < 200; trial++) {
    const double half = 0.45 * vxm_rng_unit(&rng) + 1e-3;
    plate p = {{6, half, half}, upright};
    for (int a = 0; a < 3; a++)
      p.frame.move[a] = vxm_rng_below(&rng, 4) ? vxm_rng_unit(&rng) : half;
    vxm_soup *soup = remeshed(&p);
    assert_closed_manifold(soup);
    assert_true(volume_of(soup) > (2 * p.half[0] - 3) * 4.0 / 9);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_plates), cmocka_unit_test(test_rods)};
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
