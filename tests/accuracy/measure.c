/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <math.h>
#include <string.h>
#include <time.h>

const char *const method_keys[METHOD_COUNT] = {"auto", "majority", "x", "winding"};
const char *const method_names[METHOD_COUNT] = {"auto", "majority, parts", "x parity", "winding number"};

/* A run is repeated until it has been made three times or this many milliseconds have gone by. */
static const double patience = 250;
enum { RUNS = 3 };

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

static vxm_voxelize_options options_of(method by) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP; /* the truth is one of voxel centres */
  if (by == METHOD_X)
    options.method = VXM_METHOD_X;
  if (by == METHOD_WINDING)
    options.method = VXM_METHOD_WINDING;
  if (by == METHOD_MAJORITY) {
    options.vote = VXM_VOTE_MAJORITY;
    options.split_mode = VXM_SPLIT_MODE_GROUP;
  }
  return options;
}

static vxm_grid *voxelize(const vxm_mesh *mesh, const vxm_grid *truth, method by) {
  vxm_voxelize_options options = options_of(by);
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.like = vxm_grid_space(truth);
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_voxelize(&grid, NULL, mesh, &space, &options, &error), &error);
  return grid;
}

static double iou_of(const vxm_grid *grid, const vxm_grid *truth) {
  vxm_comparison compared = VXM_COMPARISON_INIT;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_grid_compare(&compared, grid, truth, &error), &error);
  return compared.iou;
}

double measure_iou(const vxm_mesh *mesh, const vxm_grid *truth, method by) {
  vxm_grid *grid = voxelize(mesh, truth, by);
  double iou = iou_of(grid, truth);
  vxm_grid_destroy(grid);
  return iou;
}

static vxm_mesh *repair(const vxm_mesh *mesh) {
  vxm_mesh *repaired;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_mesh_repair(&repaired, NULL, mesh, NULL, &error), &error);
  return repaired;
}

static vxm_mesh *timed_repair(figure *time, const vxm_mesh *mesh, bool timed) {
  vxm_mesh *repaired = NULL;
  double least = INFINITY, begun = now();
  for (int run = 0; run < (timed ? RUNS : 1) && (run == 0 || now() - begun < patience); run++) {
    vxm_mesh_destroy(repaired);
    double start = now();
    repaired = repair(mesh);
    least = fmin(least, now() - start);
  }
  *time = (figure){true, least};
  return repaired;
}

static void measure_method(answer *out, const vxm_mesh *mesh, const vxm_grid *truth, method by, bool timed) {
  double least = INFINITY, begun = now();
  for (int run = 0; run < (timed ? RUNS : 1) && (run == 0 || now() - begun < patience); run++) {
    double start = now();
    vxm_grid *grid = voxelize(mesh, truth, by);
    least = fmin(least, now() - start);
    out->iou[by] = (figure){true, iou_of(grid, truth)};
    vxm_grid_destroy(grid);
  }
  out->time[by] = (figure){true, least};
}

void measure(answer *out, const question *q, const bool wanted[METHOD_COUNT], bool timed) {
  memset(out, 0, sizeof *out);
  vxm_mesh *repaired = timed_repair(&out->repair_time, q->mesh, timed);
  for (int by = 0; by < METHOD_COUNT; by++)
    if (wanted[by])
      measure_method(out, repaired, q->truth, (method)by, timed);
  vxm_mesh_destroy(repaired);
  if (!wanted[METHOD_WINDING])
    return;
  vxm_mesh *oriented = repair(q->oriented);
  out->reference = (figure){true, measure_iou(oriented, q->truth, METHOD_WINDING)};
  vxm_mesh_destroy(oriented);
}
