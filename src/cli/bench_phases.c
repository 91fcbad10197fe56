/* SPDX-License-Identifier: BSD-3-Clause */
/** The phases that `voxmend bench` measures. Another one is an entry in the table at the end. */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- The stage ---- */

vxm_status bench_stage_open(bench_stage *stage, const bench_plan *plan) {
  vxm_error *error = &stage->cli->error;
  vxm_status status = VXM_OK;
  for (int e = 0; e < plan->engine_count && status == VXM_OK; e++) {
    char name[sizeof plan->engines[0]]; /* what stands before a method */
    snprintf(name, sizeof name, "%.*s", (int)strcspn(plan->engines[e], "/"), plan->engines[e]);
    status =
        vxm_engine_create(&stage->engines[e], stage->cli->context, name, &plan->engine_options[e], error);
  }
  if (status != VXM_OK)
    return status;
  status = vxm_mesh_read_with(&stage->raw, stage->cli->context, stage->path, &stage->cli->read, error);
  return status == VXM_OK ? vxm_mesh_prepare(&stage->mesh, NULL, stage->raw, NULL, error) : status;
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
  vxm_sparse_destroy(stage->made_sparse);
  stage->made_mesh = NULL;
  stage->made_model = NULL;
  stage->made_sparse = NULL;
}

void bench_stage_end_phase(bench_stage *stage) {
  vxm_model_destroy(stage->model);
  bench_fill_destroy(stage->fill);
  bench_augment_end(stage);
  vxm_published_destroy(stage->published);
  free(stage->values);
  stage->published = NULL;
  stage->values = NULL;
  stage->model = NULL;
  stage->fill = NULL;
}

void bench_stage_close(bench_stage *stage) {
  bench_stage_drop(stage);
  bench_stage_end_phase(stage);
  vxm_grid_destroy(stage->grid);
  for (int e = 0; e < BENCH_ENGINES_MAX; e++)
    vxm_engine_destroy(stage->engines[e]);
  vxm_mesh_destroy(stage->mesh);
  vxm_mesh_destroy(stage->raw);
  *stage = (bench_stage){0};
}

static uint64_t grid_bytes(const bench_stage *stage) {
  const int64_t *dims = stage->space.dims;
  return (uint64_t)((dims[0] + 63) / 64) * (uint64_t)dims[1] * (uint64_t)dims[2] * sizeof(uint64_t);
}

/* ---- Memory and meshes ---- */

static vxm_status begin_memset(bench_stage *stage) {
  return bench_fill_create(&stage->fill, stage->cli, grid_bytes(stage), stage->threads);
}

static vxm_status run_memset(bench_stage *stage) {
  bench_fill_run(stage->fill);
  return VXM_OK;
}

static void tell_memset(bench_output *out, const bench_stage *stage) {
  out->bytes = grid_bytes(stage);
}

static vxm_status run_load(bench_stage *stage) {
  return vxm_mesh_read_with(&stage->made_mesh, stage->cli->context, stage->path, &stage->cli->read,
                            &stage->cli->error);
}

static void tell_load(bench_output *out, const bench_stage *stage) {
  struct stat info;
  if (stat(stage->path, &info) == 0)
    out->bytes = (uint64_t)info.st_size;
}

static vxm_status run_repair(bench_stage *stage) {
  return vxm_mesh_repair(&stage->made_mesh, NULL, stage->raw, NULL, &stage->cli->error);
}

static vxm_status run_prepare(bench_stage *stage) {
  return vxm_model_create(&stage->made_model, stage->mesh, NULL, &stage->cli->error);
}

/* ---- Solids and surfaces ---- */

/** The model and the grid that the runs of a solid phase need. */
static vxm_status begin_model(bench_stage *stage, const vxm_voxelize_options *options) {
  vxm_error *error = &stage->cli->error;
  vxm_status status = VXM_OK;
  if (!stage->grid)
    status = vxm_grid_create(&stage->grid, stage->cli->context, &stage->space, error);
  vxm_voxelize_options chosen = *options;
  chosen.engine = stage->engines[stage->engine];
  return status == VXM_OK ? vxm_model_create(&stage->model, stage->mesh, &chosen, error) : status;
}

static vxm_status begin_x(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = VXM_METHOD_X;
  return begin_model(stage, &options);
}

static vxm_status begin_default(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  return begin_model(stage, &options);
}

static vxm_status begin_centres(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  return begin_model(stage, &options);
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

static vxm_status begin_surface(bench_stage *stage, vxm_surface_kind kind) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  options.surface = kind;
  return begin_model(stage, &options);
}

static vxm_status begin_conservative(bench_stage *stage) {
  return begin_surface(stage, VXM_SURFACE_CONSERVATIVE);
}

static vxm_status begin_thin(bench_stage *stage) {
  return begin_surface(stage, VXM_SURFACE_THIN);
}

static void tell_grid(bench_output *out, const bench_stage *stage) {
  *out = (bench_output){grid_bytes(stage), vxm_grid_count(stage->grid), NULL};
}

/* ---- Octrees and numbers ---- */

static vxm_status begin_sparse(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.engine = stage->engines[stage->engine];
  return vxm_model_create(&stage->model, stage->mesh, &options, &stage->cli->error);
}

static vxm_status begin_octree_centres(bench_stage *stage) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.engine = stage->engines[stage->engine];
  options.thin = VXM_THIN_DROP;
  return vxm_model_create(&stage->model, stage->mesh, &options, &stage->cli->error);
}

static vxm_status run_sparse(bench_stage *stage) {
  return vxm_model_sparse(&stage->made_sparse, NULL, stage->model, &stage->space, NULL, &stage->cli->error);
}

static void tell_sparse(bench_output *out, const bench_stage *stage) {
  *out = (bench_output){vxm_sparse_bytes(stage->made_sparse), vxm_sparse_count(stage->made_sparse), NULL};
}

/** Voxels of the space: below 2^60, as no axis has more than 2^20. */
static size_t count_values(const bench_stage *stage) {
  return (size_t)stage->space.dims[0] * (size_t)stage->space.dims[1] * (size_t)stage->space.dims[2];
}

static vxm_status begin_values(bench_stage *stage) {
  vxm_error *error = &stage->cli->error;
  size_t bytes = count_values(stage) * sizeof(float);
  uint64_t limit = stage->cli->limits.memory_limit;
  stage->values = limit > 0 && bytes > limit ? NULL : malloc(bytes);
  if (stage->values) {
    memset(stage->values, 0, bytes); /* the system hands the memory out now, not within the first run */
    return begin_sparse(stage);
  }
  error->code = VXM_ERROR_MEMORY;
  snprintf(error->text, sizeof error->text, "no memory for %zu bytes of values", bytes);
  return error->code;
}

static vxm_status run_coverage(bench_stage *stage) {
  return vxm_model_coverage(stage->values, NULL, stage->model, &stage->space, NULL, &stage->cli->error);
}

static void tell_coverage(bench_output *out, const bench_stage *stage) {
  const float *value = stage->values;
  out->bytes = count_values(stage) * sizeof *value;
  for (size_t i = 0; i < count_values(stage); i++)
    out->voxels += value[i] > 0;
}

static vxm_status run_distance(bench_stage *stage) {
  return vxm_model_distance(stage->values, NULL, stage->model, &stage->space, NULL, &stage->cli->error);
}

static void tell_distance(bench_output *out, const bench_stage *stage) {
  const float *value = stage->values;
  out->bytes = count_values(stage) * sizeof *value;
  for (size_t i = 0; i < count_values(stage); i++)
    out->voxels += value[i] < 0;
}

/* ---- The table ---- */

enum { SLOW_MS = 2000 };

const bench_phase bench_phases[] = {
    {"memset", "fill memory of the grid's size: the least that writing it can take", true, false, BENCH_USUAL,
     0, begin_memset, run_memset, tell_memset},
    {"load", "read the file", false, false, BENCH_USUAL, 0, NULL, run_load, tell_load},
    {"repair", "repair the mesh", false, false, BENCH_USUAL, 0, NULL, run_repair, NULL},
    {"prepare", "make the model: find parts, cap holes", false, false, BENCH_USUAL, 0, NULL, run_prepare,
     NULL},
    {"solid_x", "solid by parity along x", true, true, BENCH_USUAL, 0, begin_x, run_solid, tell_grid},
    {"solid_vote", "the solid as 'voxmend voxelize' makes it", true, true, BENCH_USUAL, 0, begin_default,
     run_solid, tell_grid},
    {"solid_centres", "the solid by voxel centres alone (--thin drop)", true, true, BENCH_USUAL, 0,
     begin_centres, run_solid, tell_grid},
    {"solid_majority", "solid by a majority of x, y and z", true, true, BENCH_USUAL, 0, begin_majority,
     run_solid, tell_grid},
    {"transform", "solid_vote of the model turned by a small angle", true, true, BENCH_USUAL, 0,
     begin_default, run_transform, tell_grid},
    {"surface_conservative", "every voxel that the surface touches", true, true, BENCH_USUAL, 0,
     begin_conservative, run_solid, tell_grid},
    {"surface_thin", "the 6-separating surface", true, true, BENCH_USUAL, 0, begin_thin, run_solid,
     tell_grid},
    {"sparse", "solid_vote as an octree", true, true, BENCH_USUAL, 0, begin_sparse, run_sparse, tell_sparse},
    {"coverage", "share of each voxel that is filled, by 4 x 4 x 4 sub-voxels", true, true, BENCH_USUAL,
     SLOW_MS, begin_values, run_coverage, tell_coverage},
    {"distance", "signed distance, within 3 voxels of the surface", true, false, BENCH_USUAL, SLOW_MS,
     begin_values, run_distance, tell_distance},
    {"winding", "solid by the winding number of every voxel", true, false, BENCH_USUAL, SLOW_MS,
     begin_winding, run_solid, tell_grid},
    {"augment_standard", "a variant by a process of its own, which reads the mesh; its file read back", true,
     false, BENCH_AUGMENT, 0, bench_begin_standard, bench_run_standard, bench_tell_augment},
    {"augment_batch", "a variant by a process that has the mesh; its file read back", true, true,
     BENCH_AUGMENT, 0, bench_begin_batch, bench_run_batch, bench_tell_augment},
    {"augment_direct", "a variant, as numbers in memory", true, true, BENCH_AUGMENT, 0, bench_begin_direct,
     bench_run_direct, bench_tell_augment},
    {"published_facets", "surface by a published OpenCL program, a work-item for each facet", true, true,
     BENCH_OPENCL, 0, bench_begin_published_facets, bench_run_published, bench_tell_published},
    {"published_voxels", "the same, a work-item for each voxel over all triangles", true, true, BENCH_OPENCL,
     SLOW_MS, bench_begin_published_voxels, bench_run_published, bench_tell_published},
    {"transfer_read", "a byte for each voxel from the OpenCL device, by clEnqueueReadBuffer", true, true,
     BENCH_OPENCL, 0, bench_begin_transfer, bench_run_transfer_read, bench_tell_published},
    {"transfer_map", "the same by clEnqueueMapBuffer", true, true, BENCH_OPENCL, 0, bench_begin_transfer,
     bench_run_transfer_map, bench_tell_published},
    {"octree_centres", "the octree of solid_centres, as papers have it", true, true, BENCH_BASELINE, 0,
     begin_octree_centres, run_sparse, tell_sparse},
    {"baseline_fang_chen", "solid by slices of the whole mesh along three axes", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_fang_chen, bench_run_baseline, bench_tell_baseline},
    {"baseline_chen_tu", "the same for each group of vertices, which setup_ms finds", true, false,
     BENCH_BASELINE, SLOW_MS, bench_begin_chen_tu, bench_run_baseline, bench_tell_baseline},
    {"baseline_tetra_listed", "XOR of tetrahedra, of those that a slice meets", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_tetra_listed, bench_run_baseline, bench_tell_baseline},
    {"baseline_tetra_full", "XOR of tetrahedra, all asked in each slice", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_tetra_full, bench_run_baseline, bench_tell_baseline},
    {"baseline_tetra_anew", "the same with the tetrahedra made in each slice", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_tetra_anew, bench_run_baseline, bench_tell_baseline},
    {"baseline_tetra_layers", "XOR of tetrahedra, each into all of its slices", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_tetra_layers, bench_run_baseline, bench_tell_baseline},
    {"baseline_eisemann", "solid by flips of all voxels behind a triangle", true, false, BENCH_BASELINE,
     SLOW_MS, bench_begin_eisemann, bench_run_baseline, bench_tell_baseline},
    {"baseline_density", "a density about the surface", true, false, BENCH_BASELINE, SLOW_MS,
     bench_begin_density, bench_run_baseline, bench_tell_baseline},
    {"baseline_simple", "conservative surface, all voxels of a triangle's box asked", true, false,
     BENCH_BASELINE, SLOW_MS, bench_begin_simple, bench_run_baseline, bench_tell_baseline},
    {"baseline_specialized", "the same by the dimensions of the box and the axis of the normal", true, false,
     BENCH_BASELINE, SLOW_MS, bench_begin_specialized, bench_run_baseline, bench_tell_baseline},
    {"baseline_sorted", "the same with the triangles sorted by these", true, false, BENCH_BASELINE, SLOW_MS,
     bench_begin_sorted, bench_run_baseline, bench_tell_baseline},
    {"baseline_thin_simple", "6-separating surface, as baseline_simple", true, false, BENCH_BASELINE, SLOW_MS,
     bench_begin_simple_thin, bench_run_baseline, bench_tell_baseline},
    {"baseline_thin_specialized", "6-separating surface, as baseline_specialized", true, false,
     BENCH_BASELINE, SLOW_MS, bench_begin_specialized_thin, bench_run_baseline, bench_tell_baseline},
    {"baseline_thin_sorted", "6-separating surface, as baseline_sorted", true, false, BENCH_BASELINE, SLOW_MS,
     bench_begin_sorted_thin, bench_run_baseline, bench_tell_baseline},
    {"baseline_zhang", "surface by conservative rasterization and ranges of depth", true, false,
     BENCH_BASELINE, SLOW_MS, bench_begin_zhang, bench_run_baseline, bench_tell_baseline},
    {NULL, NULL, false, false, BENCH_USUAL, 0, NULL, NULL, NULL}};
