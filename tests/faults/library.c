/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The library where memory fails. "library once" goes through all of it, and prints the first error as one
 * line; fail_allocations.so makes it fail. Without an argument it goes through all of it under ever larger
 * memory limits, until one is large enough: each smaller one gives one error, and leaves nothing. FAULTS=all
 * tries more of them.
 */
#include "voxmend.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** What a run has made so far. */
typedef struct made {
  vxm_context *context;
  vxm_mesh *mesh, *read, *repaired, *surface;
  vxm_defects *defects;
  vxm_grid *grid, *other;
  vxm_model *model;
  vxm_sparse *sparse, *whole;
  vxm_sampler *sampler;
  vxm_error error;
} made;

enum { SIDE = 6, VOXELS = SIDE * SIDE * SIDE };

static const vxm_space space = {{SIDE, SIDE, SIDE}, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};

static void require(bool holds, const char *what) {
  if (holds)
    return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

static void drop(made *m) {
  vxm_sampler_destroy(m->sampler);
  vxm_sparse_destroy(m->whole);
  vxm_sparse_destroy(m->sparse);
  vxm_model_destroy(m->model);
  vxm_grid_destroy(m->other);
  vxm_grid_destroy(m->grid);
  vxm_defects_destroy(m->defects);
  vxm_mesh_destroy(m->surface);
  vxm_mesh_destroy(m->repaired);
  vxm_mesh_destroy(m->read);
  vxm_mesh_destroy(m->mesh);
  vxm_context_destroy(m->context);
}

/* ---- A run through everything ---- */

static vxm_status use_meshes(made *m) {
  /* a box, half of another in it, and a sheet that shares an edge */
  static const double corners[] = {0, 0, 0, 2, 0, 0, 2, 2, 0,   0,   2,   0,   0,   0, 2,   2,   0,   2,
                                   2, 2, 2, 0, 2, 2, 1, 1, 0.5, 1.5, 1.5, 1.5, 0.5, 1, 1.5, 1.5, 0.5, 1.5};
  static const int64_t offsets[] = {0, 4, 8, 12, 16, 20, 24, 27, 30, 33};
  static const int64_t indices[] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1,  5, 4,  1, 2, 6, 5, 2,
                                    3, 7, 6, 3, 0, 4, 7, 8, 9, 10, 8, 11, 9, 0, 1, 11};
  static const char text[] =
      "g a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\ng b\nf 2 3 4\nf 3 1 4\nf 9 9 9\n";
  vxm_mesh_arrays arrays = {.size = sizeof arrays,
                            .index_scalar = VXM_INT64,
                            .vertices = corners,
                            .vertex_count = 12,
                            .offsets = offsets,
                            .indices = indices,
                            .index_count = sizeof indices / sizeof *indices,
                            .face_count = 9};
  vxm_census census = VXM_CENSUS_INIT;
  vxm_status status = vxm_mesh_create(&m->mesh, m->context, &arrays, &m->error);
  if (status == VXM_OK)
    status = vxm_mesh_read_memory(&m->read, m->context, text, strlen(text), "a.obj", &m->error);
  if (status == VXM_OK)
    status = vxm_mesh_census(&census, m->mesh, &m->error);
  if (status == VXM_OK)
    status = vxm_mesh_defects(&m->defects, m->mesh, 0, false, &m->error);
  return status;
}

static vxm_status use_repair(made *m) {
  static const char *const formats[] = {"off", "obj", "stl", "ply"};
  vxm_status status = VXM_OK;
  for (int level = VXM_LEVEL_CLEAN; status == VXM_OK && level <= VXM_LEVEL_CLOSED; level++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    vxm_verification verification = VXM_VERIFICATION_INIT;
    options.level = (vxm_level)level;
    options.part_changes = true;
    vxm_mesh_destroy(m->repaired);
    status = vxm_mesh_repair(&m->repaired, &report, m->mesh, &options, &m->error);
    require((status == VXM_OK) == (m->repaired != NULL), "a mesh comes with success alone");
    if (status == VXM_OK)
      status = vxm_mesh_verify(&verification, m->repaired, &options, &m->error);
  }
  for (int f = 0; status == VXM_OK && f < 4; f++) {
    vxm_mesh_write_options options = {sizeof(vxm_mesh_write_options), formats[f], f % 2 == 0, f % 4 == 1};
    status = vxm_mesh_write(m->repaired, "/dev/null", &options, &m->error);
  }
  return status;
}

static vxm_status use_grids(made *m) {
  static const char *const formats[] = {"binvox", "npy", "rle", "nrrd", "off"};
  vxm_status status = VXM_OK;
  for (int method = VXM_METHOD_VOTE; status == VXM_OK && method <= VXM_METHOD_WINDING; method++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
    space_options.resolution[0] = SIDE;
    options.method = (vxm_method)method;
    options.mode = (vxm_mode)(method % 3);
    options.surface = (vxm_surface_kind)(method % 5);
    options.confidence = options.mode == VXM_MODE_SOLID;
    vxm_grid_destroy(m->grid);
    status = vxm_voxelize(&m->grid, NULL, m->repaired, &space_options, &options, &m->error);
    require((status == VXM_OK) == (m->grid != NULL), "a grid comes with success alone");
  }
  for (size_t f = 0; status == VXM_OK && f < sizeof formats / sizeof *formats; f++) {
    vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
    options.format = formats[f];
    status = vxm_grid_write(m->grid, "/dev/null", &options, &m->error);
  }
  if (status == VXM_OK)
    status = vxm_grid_surface_mesh(&m->surface, m->grid, &m->error);
  if (status == VXM_OK)
    status = vxm_sparse_from_grid(&m->sparse, m->grid, &m->error);
  if (status == VXM_OK)
    status = vxm_sparse_combine(&m->whole, m->sparse, NULL, VXM_SET_COMPLEMENT, &m->error);
  if (status == VXM_OK)
    status = vxm_sparse_to_grid(&m->other, m->whole, &m->error);
  return status;
}

static vxm_status use_model(made *m) {
  static float values[VOXELS];
  vxm_color_options by_part = VXM_COLOR_OPTIONS_INIT;
  by_part.by = VXM_COLOR_PART;
  vxm_status status = vxm_model_create(&m->model, m->mesh, NULL, &m->error);
  if (status == VXM_OK)
    status = vxm_model_voxelize(m->grid, NULL, m->model, NULL, &m->error);
  if (status == VXM_OK)
    status = vxm_model_coverage(values, NULL, m->model, &space, NULL, &m->error);
  if (status == VXM_OK)
    status = vxm_model_distance(values, NULL, m->model, &space, NULL, &m->error);
  if (status == VXM_OK)
    status = vxm_model_labels((uint16_t *)values, NULL, m->model, &space, NULL, &m->error);
  if (status == VXM_OK)
    status = vxm_model_colors((uint8_t *)values, NULL, m->model, &space, &by_part, &m->error);
  vxm_sparse_destroy(m->sparse);
  m->sparse = NULL;
  if (status == VXM_OK)
    status = vxm_model_sparse(&m->sparse, NULL, m->model, &space, NULL, &m->error);
  return status;
}

static vxm_status use_sampler(made *m) {
  static uint8_t voxels[2 * 8 * 8 * 8];
  static const vxm_variant variants[] = {{0, 0, 0}, {0, 1, 1}};
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = 8;
  options.noise = 64;
  options.displace = 0.01;
  options.rotation = VXM_ROTATION_ANY;
  vxm_status status = vxm_sampler_create(&m->sampler, m->context, &options, &m->error);
  if (status == VXM_OK)
    status = vxm_sampler_put(m->sampler, 0, m->repaired, &m->error);
  if (status == VXM_OK)
    status = vxm_sampler_batch(voxels, m->sampler, variants, 2, VXM_VOXEL_FORMAT_UINT8, &m->error);
  return status;
}

static vxm_status use_all(made *m, uint64_t limit) {
  typedef vxm_status use(made *);
  static use *const uses[] = {use_meshes, use_repair, use_grids, use_model, use_sampler};
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 2;
  options.memory_limit = limit;
  *m = (made){.error = VXM_ERROR_INIT};
  vxm_status status = vxm_context_create(&m->context, &options, &m->error);
  for (int u = 0; status == VXM_OK && u < 5; u++)
    status = uses[u](m);
  require(status == VXM_OK || (m->error.code == status && m->error.text[0] && !strchr(m->error.text, '\n')),
          "a failure is one line");
  require(limit == 0 || vxm_context_peak_bytes(m->context) <= limit, "the limit holds");
  drop(m);
  return status;
}

int main(int argc, char **argv) {
  made m;
  if (argc > 1 && strcmp(argv[1], "once") == 0) {
    vxm_status status = use_all(&m, 0);
    if (status == VXM_OK)
      return 0;
    fprintf(stderr, "voxmend: %s\n", m.error.text);
    return 1;
  }
  const char *faults = getenv("FAULTS");
  uint64_t part = faults && strcmp(faults, "all") == 0 ? 1000 : 30, refused = 0;
  for (uint64_t limit = 1;; limit += 1 + limit / part) {
    vxm_status status = use_all(&m, limit);
    if (status == VXM_OK)
      break;
    require(status == VXM_ERROR_MEMORY_LIMIT, "what is missing is told");
    refused++;
  }
  printf("limits refused: %llu\n", (unsigned long long)refused);
  require(refused > 20, "most limits are too small");
  return 0;
}
