/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_walk.h"
#include "base/cpu.h"

#include <pthread.h>

extern const vxm_winding_kernels vxm_winding_kernels_plain, vxm_winding_kernels_avx2,
    vxm_winding_kernels_avx512;

const vxm_winding_kernels *vxm_winding_kernels_get(void) {
  static const vxm_winding_kernels *const builds[] = VXM_CPU_BUILDS(vxm_winding_kernels);
  return builds[vxm_kernels_get()->level];
}

/* ---- Tables ---- */

static vxm_winding_level levels[VXM_WINDING_LEVELS];

/** The places of samples: voxel centres in a brick, else the roots of Chebyshev's fourth polynomial. */
static double place_of(int level, int sample) {
  static const double chebyshev[4] = {-0.92387953251128674, -0.38268343236508977, 0.38268343236508977,
                                      0.92387953251128674};
  double reach = ((double)(INT64_C(4) << level) - 1) / 2;
  return level == 0 ? sample - 1.5 : chebyshev[sample] * reach;
}

/** What sample i of a level counts at a place. */
static double lagrange(int level, int i, double place) {
  double product = 1;
  for (int j = 0; j < 4; j++)
    if (j != i)
      product *= (place - place_of(level, j)) / (place_of(level, i) - place_of(level, j));
  return product;
}

static void set_weight(vxm_winding_weights *out, int sample, int place, double weight) {
  out->one[sample][place] = (float)weight;
  for (int i = 0; i < 4; i++)
    out->in_rows[sample][4 * i + place] = out->of_rows[sample][4 * place + i] = (float)weight;
}

/** Between the outermost voxel centres of a cell, by the values at its ends and thirds. */
static void make_bound(int level) {
  static const double by_value[4][4] = {
      {1, 0, 0, 0}, {-5.0 / 6, 3, -1.5, 1.0 / 3}, {1.0 / 3, -1.5, 3, -5.0 / 6}, {0, 0, 0, 1}};
  double reach = ((double)(INT64_C(4) << level) - 1) / 2;
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 4; c++) {
      double sum = 0;
      for (int v = 0; v < 4; v++)
        sum += by_value[c][v] * lagrange(level, i, reach * (2 * v / 3.0 - 1));
      set_weight(&levels[level].bound, i, c, sum);
    }
}

static void make_levels(void) {
  for (int l = 0; l < VXM_WINDING_LEVELS; l++) {
    levels[l].reach = (float)(((double)(INT64_C(4) << l) - 1) / 2);
    make_bound(l);
    for (int i = 0; i < 16; i++) {
      levels[l].x[i] = (float)place_of(l, i % 4);
      levels[l].y[i] = levels[l].z[i / 4] = (float)place_of(l, i / 4);
    }
    double quarter = (double)(INT64_C(1) << l);
    for (int half = 0; half < 2 && l > 0; half++)
      for (int to = 0; to < 4; to++)
        for (int i = 0; i < 4; i++)
          set_weight(&levels[l].to_child[half], i, to,
                     lagrange(l, i, place_of(l - 1, to) + (half ? quarter : -quarter)));
  }
}

const vxm_winding_level *vxm_winding_levels(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, make_levels);
  return levels;
}

/* ---- Lists ---- */

bool vxm_winding_scratch_grow(vxm_winding_scratch *scratch) {
  if (scratch->status == VXM_OK)
    scratch->status = vxm_grow(scratch->context, (void **)&scratch->nodes, &scratch->capacity,
                               scratch->count + 1, sizeof *scratch->nodes, &scratch->error);
  return scratch->status == VXM_OK;
}
