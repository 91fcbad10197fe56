/* SPDX-License-Identifier: BSD-3-Clause */
/** The phases that `voxmend bench` measures. Another one is an entry in the table at the end. */
#include "cli/bench.h"

#include <math.h>

/* ---- The stage ---- */

vxm_status bench_stage_open(bench_stage *stage) {
  vxm_error *error = &stage->cli->error;
  vxm_status status =
      vxm_mesh_read_with(&stage->raw, stage->cli->context, stage->path, &stage->cli->read, error);
  return status == VXM_OK ? vxm_mesh_repair(&stage->mesh, NULL, stage->raw, NULL, error) : status;
}

vxm_status bench_stage_resize(bench_stage *stage, int64_t resolution) {
  vxm_grid_destroy(stage->grid);
  stage->grid = NULL;
  vxm_space_options options = VXM_SPACE_OPTIONS_INIT;
  options.resolution[0] = resolution;
  return vxm_space_fit(&stage->space, stage->mesh, &options, &stage->cli->error);
}

void bench_stage_drop(bench_stage *stage) {
  vxm_mesh_destroy(stage->made_mesh);
  vxm_model_destroy(stage->made_model);
  stage->made_mesh = NULL;
  stage->made_model = NULL;
}

void bench_stage_end_phase(bench_stage *stage) {
  vxm_model_destroy(stage->model);
  bench_team_destroy(stage->team);
  stage->model = NULL;
  stage->team = NULL;
}

void bench_stage_close(bench_stage *stage) {
  bench_stage_drop(stage);
  bench_stage_end_phase(stage);
  vxm_grid_destroy(stage->grid);
  vxm_mesh_destroy(stage->mesh);
  vxm_mesh_destroy(stage->raw);
  *stage = (bench_stage){0};
}

uint64_t bench_grid_bytes(const bench_stage *stage) {
  const int64_t *dims = stage->space.dims;
  return (uint64_t)((dims[0] + 63) / 64) * (uint64_t)dims[1] * (uint64_t)dims[2] * sizeof(uint64_t);
}

/* ---- Memory and meshes ---- */

static vxm_status begin_memset(bench_stage *stage) {
  return bench_team_create(&stage->team, stage->cli, bench_grid_bytes(stage), stage->threads);
}

static vxm_status run_memset(bench_stage *stage) {
  bench_team_fill(stage->team);
  return VXM_OK;
}

static vxm_status run_load(bench_stage *stage) {
  return vxm_mesh_read_with(&stage->made_mesh, stage->cli->context, stage->path, &stage->cli->read,
                            &stage->cli->error);
}

static vxm_status run_repair(bench_stage *stage) {
  return vxm_mesh_repair(&stage->made_mesh, NULL, stage->raw, NULL, &stage->cli->error);
}

static vxm_status run_prepare(bench_stage *stage) {
  return vxm_model_create(&stage->made_model, stage->mesh, NULL, &stage->cli->error);
}

/* ---- Solids ---- */

/** The model and the grid that the runs of a solid phase need. */
static vxm_status begin_model(bench_stage *stage, const vxm_voxelize_options *options) {
  vxm_error *error = &stage->cli->error;
  vxm_status status = VXM_OK;
  if (!stage->grid)
    status = vxm_grid_create(&stage->grid, stage->cli->context, &stage->space, error);
  return status == VXM_OK ? vxm_model_create(&stage->model, stage->mesh, options, error) : status;
}

static vxm_status begin_x(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = VXM_METHOD_X;
  return begin_model(stage, &options);
}

static vxm_status begin_default(bench_stage *stage) {
  return begin_model(stage, NULL);
}

static vxm_status begin_majority(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.vote = VXM_VOTE_MAJORITY;
  options.vote_always = true;
  return begin_model(stage, &options);
}

static vxm_status begin_winding(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = VXM_METHOD_WINDING;
  return begin_model(stage, &options);
}

static vxm_status run_solid(bench_stage *stage) {
  return vxm_model_voxelize(stage->grid, NULL, stage->model, NULL, &stage->cli->error);
}

/** A turn about the middle of the grid and the axis (1, 1, 1), by another angle each time. */
static vxm_status run_transform(bench_stage *stage) {
  enum { ANGLES = 16 };
  double angle = (double)(stage->run % ANGLES + 1) * 0.01, c = cos(angle), s = sin(angle) / sqrt(3);
  double turn[3] = {(1 + 2 * c) / 3, (1 - c) / 3 - s, (1 - c) / 3 + s}; /* a row; the next is one further */
  double matrix[12];
  for (int row = 0; row < 3; row++) {
    double middle[3], moved = 0;
    for (int axis = 0; axis < 3; axis++) {
      const vxm_space *space = &stage->space;
      middle[axis] = space->origin[axis] + (double)space->dims[axis] * space->voxel_size[axis] / 2;
      matrix[4 * row + axis] = turn[(axis + 3 - row) % 3];
      moved += matrix[4 * row + axis] * middle[axis];
    }
    matrix[4 * row + 3] = middle[row] - moved;
  }
  return vxm_model_voxelize(stage->grid, NULL, stage->model, matrix, &stage->cli->error);
}

/* ---- The table ---- */

const bench_phase bench_phases[] = {
    {"memset", "fill memory of the grid's size: the least that writing it can take", true, 0, begin_memset,
     run_memset},
    {"load", "read the file", false, 0, NULL, run_load},
    {"repair", "repair the mesh", false, 0, NULL, run_repair},
    {"prepare", "make the model: find parts, cap holes", false, 0, NULL, run_prepare},
    {"solid_x", "solid by parity along x", true, 0, begin_x, run_solid},
    {"solid_vote", "the solid as 'voxmend voxelize' makes it", true, 0, begin_default, run_solid},
    {"solid_majority", "solid by a majority of x, y and z", true, 0, begin_majority, run_solid},
    {"transform", "solid_vote of the model turned by a small angle", true, 0, begin_default, run_transform},
    {"winding", "solid by the winding number of every voxel", true, 2000, begin_winding, run_solid},
    {NULL, NULL, false, 0, NULL, NULL}};

const char *const bench_engines[] = {"cpu", NULL};
