/* SPDX-License-Identifier: BSD-3-Clause */
/** Programs and kernels: compiled when they are needed, kept in the user's cache folder. */
#include "gpu/opencl/cl_cache.h"
#include "gpu/opencl/opencl.h"

#include <stdio.h>
#include <string.h>

#include "shaders/kernels.inc"

enum { FILES_MAX = 7, LOG_MAX = 400 };

static const char *const sources[VXM_CL_PROGRAMS][FILES_MAX] = {
    [VXM_CL_SOLID] = {"rules.h", "lattice.cl", "flips.cl", "flip_area.cl", "columns.cl", "fold.cl",
                      "vote.cl"},
    [VXM_CL_SURFACE] = {"rules.h", "touching.cl", "surface.cl"},
    [VXM_CL_SORT] = {"sort.cl"},
    [VXM_CL_TILES_PROGRAM] = {"rules.h", "lattice.cl", "tiles.cl"},
    [VXM_CL_TREE] = {"rules.h", "touching.cl", "cells.cl", "nodes.cl", "prune.cl"},
    [VXM_CL_BRICK_FLIPS] = {"rules.h", "lattice.cl", "brick_flips.cl", "flip_area.cl", "bricks.cl"},
    [VXM_CL_SURFACE_BRICKS] = {"rules.h", "touching.cl", "surface_bricks.cl"},
    [VXM_CL_COVERAGE] = {"coverage.cl"},
    [VXM_CL_MOVE] = {"move.cl"},
    [VXM_CL_PUBLISHED] = {"published.cl"},
    [VXM_CL_DEVICE_VOXELS] = {"device_voxels.cl"},
};

static const struct {
  const char *name;
  vxm_cl_program_id program;
} kernels[VXM_CL_KERNELS] = {
    [VXM_CL_FLIP_COLUMNS] = {"flip_columns", VXM_CL_SOLID},
    [VXM_CL_FLIP_LARGE] = {"flip_large", VXM_CL_SOLID},
    [VXM_CL_FLIP_BITS] = {"flip_bits", VXM_CL_SOLID},
    [VXM_CL_FOLD_ROWS] = {"fold_rows", VXM_CL_SOLID},
    [VXM_CL_FOLD_ACROSS] = {"fold_across", VXM_CL_SOLID},
    [VXM_CL_TOUCH] = {"touch", VXM_CL_SOLID},
    [VXM_CL_VOTE] = {"vote", VXM_CL_SOLID},
    [VXM_CL_SET_SURFACE] = {"set_surface", VXM_CL_SURFACE},
    [VXM_CL_SET_LARGE] = {"set_large", VXM_CL_SURFACE},
    [VXM_CL_SCAN_BLOCKS] = {"scan_blocks", VXM_CL_SORT},
    [VXM_CL_SCAN_ADD] = {"scan_add", VXM_CL_SORT},
    [VXM_CL_SORT_COUNT] = {"sort_count", VXM_CL_SORT},
    [VXM_CL_SORT_SCATTER] = {"sort_scatter", VXM_CL_SORT},
    [VXM_CL_COUNT_TILES] = {"count_tiles", VXM_CL_TILES_PROGRAM},
    [VXM_CL_LIST_TILES] = {"list_tiles", VXM_CL_TILES_PROGRAM},
    [VXM_CL_FIND_TILES] = {"find_tiles", VXM_CL_TILES_PROGRAM},
    [VXM_CL_FILL_TILES] = {"fill_tiles", VXM_CL_TILES_PROGRAM},
    [VXM_CL_MARK_CELLS] = {"mark_cells", VXM_CL_TREE},
    [VXM_CL_MARK_LARGE] = {"mark_large", VXM_CL_TREE},
    [VXM_CL_MARK_BOX] = {"mark_box", VXM_CL_TREE},
    [VXM_CL_COUNT_CELLS] = {"count_cells", VXM_CL_TREE},
    [VXM_CL_LIST_CELLS] = {"list_cells", VXM_CL_TREE},
    [VXM_CL_COUNT_NODES] = {"count_nodes", VXM_CL_TREE},
    [VXM_CL_FLAG_PARENTS] = {"flag_parents", VXM_CL_TREE},
    [VXM_CL_MAKE_PARENTS] = {"make_parents", VXM_CL_TREE},
    [VXM_CL_LINK_NODES] = {"link_nodes", VXM_CL_TREE},
    [VXM_CL_FOLD_NODES] = {"fold_nodes", VXM_CL_TREE},
    [VXM_CL_PUSH_NODES] = {"push_nodes", VXM_CL_TREE},
    [VXM_CL_UNITE_NODES] = {"unite_nodes", VXM_CL_TREE},
    [VXM_CL_PRUNE_BRICKS] = {"prune_bricks", VXM_CL_TREE},
    [VXM_CL_PRUNE_NODES] = {"prune_nodes", VXM_CL_TREE},
    [VXM_CL_COUNT_KEPT] = {"count_kept", VXM_CL_TREE},
    [VXM_CL_TAKE_NODES] = {"take_nodes", VXM_CL_TREE},
    [VXM_CL_TAKE_BRICKS] = {"take_bricks", VXM_CL_TREE},
    [VXM_CL_FLIP_BRICKS] = {"flip_bricks", VXM_CL_BRICK_FLIPS},
    [VXM_CL_FLIP_BRICKS_LARGE] = {"flip_bricks_large", VXM_CL_BRICK_FLIPS},
    [VXM_CL_FOLD_BRICKS] = {"fold_bricks", VXM_CL_BRICK_FLIPS},
    [VXM_CL_PUSH_BRICKS] = {"push_bricks", VXM_CL_BRICK_FLIPS},
    [VXM_CL_SET_BRICKS] = {"set_bricks", VXM_CL_SURFACE_BRICKS},
    [VXM_CL_SET_BRICKS_LARGE] = {"set_bricks_large", VXM_CL_SURFACE_BRICKS},
    [VXM_CL_MOVE_POINTS] = {"move_points", VXM_CL_MOVE},
    [VXM_CL_COUNT_GROUPS] = {"count_groups", VXM_CL_COVERAGE},
    [VXM_CL_PUBLISHED_FACETS] = {"published_facets", VXM_CL_PUBLISHED},
    [VXM_CL_PUBLISHED_VOXELS] = {"published_voxels", VXM_CL_PUBLISHED},
    [VXM_CL_DEVICE_VOXELS_BYTES] = {"voxels_to_bytes", VXM_CL_DEVICE_VOXELS},
    [VXM_CL_DEVICE_VOXELS_FLOATS] = {"voxels_to_floats", VXM_CL_DEVICE_VOXELS},
};

static const char *source_text(const char *name) {
  for (size_t i = 0; i < sizeof shader_table / sizeof shader_table[0]; i++)
    if (strcmp(shader_table[i].name, name) == 0)
      return shader_table[i].text;
  return "";
}

static void release_program(vxm_opencl *engine, vxm_cl_program_id id) {
  for (int k = 0; k < VXM_CL_KERNELS; k++)
    if (kernels[k].program == id && engine->kernels[k]) {
      engine->cl->ReleaseKernel(engine->kernels[k]);
      engine->kernels[k] = NULL;
    }
  if (engine->programs[id])
    engine->cl->ReleaseProgram(engine->programs[id]);
  engine->programs[id] = NULL;
}

void vxm_cl_programs_release(vxm_opencl *engine) {
  for (int p = 0; p < VXM_CL_PROGRAMS; p++)
    release_program(engine, (vxm_cl_program_id)p);
}

/* ---- Compiling ---- */

static vxm_cl_key key_of(const vxm_opencl *engine, const char *const text[FILES_MAX], const char *options) {
  const vxm_engine_info *info = &engine->base.info;
  vxm_cl_key key = {{1, 2}};
  vxm_cl_key_add(&key, info->platform);
  vxm_cl_key_add(&key, info->renderer);
  vxm_cl_key_add(&key, info->version);
  vxm_cl_key_add(&key, info->driver);
  vxm_cl_key_add(&key, options);
  for (int f = 0; f < FILES_MAX && text[f]; f++)
    vxm_cl_key_add(&key, text[f]);
  return key;
}

/** A program from the cache; NULL if it is not there, or the driver does not take it. */
static cl_program load_program(const vxm_opencl *engine, const vxm_cl_key *key, const char *options) {
  const vxm_cl *cl = engine->cl;
  size_t size;
  cl_int code = CL_SUCCESS, taken = CL_SUCCESS;
  unsigned char *binary = vxm_cl_cache_load(key, engine->base.context, &size);
  if (!binary)
    return NULL;
  const unsigned char *at = binary;
  cl_program program =
      cl->CreateProgramWithBinary(engine->context, 1, &engine->device.id, &size, &at, &taken, &code);
  vxm_free(engine->base.context, binary);
  if (code != CL_SUCCESS)
    return NULL;
  if (taken == CL_SUCCESS &&
      cl->BuildProgram(program, 1, &engine->device.id, options, NULL, NULL) == CL_SUCCESS)
    return program;
  cl->ReleaseProgram(program);
  return NULL;
}

static void store_program(const vxm_opencl *engine, cl_program program, const vxm_cl_key *key) {
  size_t size = 0;
  if (engine->cl->GetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, NULL) != CL_SUCCESS ||
      size == 0)
    return;
  unsigned char *binary = vxm_alloc(engine->base.context, size, 1, NULL);
  if (binary &&
      engine->cl->GetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof binary, &binary, NULL) == CL_SUCCESS)
    vxm_cl_cache_store(key, engine->base.context, binary, size);
  vxm_free(engine->base.context, binary);
}

/** The compiler's words in one line. */
static vxm_status fail_build(const vxm_opencl *engine, cl_program program, const char *name,
                             vxm_error *error) {
  char shown[LOG_MAX] = "it gives no reason";
  size_t size = 0;
  engine->cl->GetProgramBuildInfo(program, engine->device.id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size);
  char *log = vxm_calloc(engine->base.context, size + 1, 1, NULL);
  if (log &&
      engine->cl->GetProgramBuildInfo(program, engine->device.id, CL_PROGRAM_BUILD_LOG, size, log, NULL) ==
          CL_SUCCESS &&
      *log)
    snprintf(shown, sizeof shown, "%s", log);
  vxm_free(engine->base.context, log);
  for (char *c = shown; *c; c++)
    if ((unsigned char)*c < ' ')
      *c = ' ';
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the OpenCL driver of %s refuses the kernels of %s: %s",
                  engine->base.info.renderer, name, shown);
}

static vxm_status compile(vxm_opencl *engine, vxm_cl_program_id id, vxm_error *error) {
  const vxm_cl *cl = engine->cl;
  const char *text[FILES_MAX] = {NULL};
  char options[64];
  cl_uint count = 0;
  cl_int code;
  while (count < FILES_MAX && sources[id][count]) {
    text[count] = source_text(sources[id][count]);
    count++;
  }
  snprintf(options, sizeof options, "-cl-std=CL1.2 -DGROUP=%zu", engine->group);
  vxm_cl_key key = key_of(engine, text, options);
  engine->programs[id] = load_program(engine, &key, options);
  if (engine->programs[id])
    return VXM_OK;
  cl_program program = cl->CreateProgramWithSource(engine->context, count, text, NULL, &code);
  if (code != CL_SUCCESS)
    return vxm_cl_check(code, "making a program", error);
  code = cl->BuildProgram(program, 1, &engine->device.id, options, NULL, NULL);
  if (code != CL_SUCCESS) {
    vxm_status status = fail_build(engine, program, sources[id][count - 1], error);
    cl->ReleaseProgram(program);
    return status;
  }
  store_program(engine, program, &key);
  engine->programs[id] = program;
  return VXM_OK;
}

/** The largest group that all kernels of a program can have. */
static vxm_status make_kernels(vxm_opencl *engine, vxm_cl_program_id id, size_t *most, vxm_error *error) {
  const vxm_cl *cl = engine->cl;
  *most = SIZE_MAX;
  for (int k = 0; k < VXM_CL_KERNELS; k++) {
    size_t size = 0;
    cl_int code;
    if (kernels[k].program != id)
      continue;
    engine->kernels[k] = cl->CreateKernel(engine->programs[id], kernels[k].name, &code);
    if (code == CL_SUCCESS)
      code = cl->GetKernelWorkGroupInfo(engine->kernels[k], engine->device.id, CL_KERNEL_WORK_GROUP_SIZE,
                                        sizeof size, &size, NULL);
    if (code != CL_SUCCESS)
      return vxm_cl_check(code, kernels[k].name, error);
    *most = size < *most ? size : *most;
  }
  return VXM_OK;
}

vxm_status vxm_cl_ready(vxm_opencl *engine, vxm_cl_program_id id, vxm_error *error) {
  while (!engine->programs[id]) {
    size_t most;
    vxm_status status = compile(engine, id, error);
    if (status == VXM_OK)
      status = make_kernels(engine, id, &most, error);
    if (status != VXM_OK) {
      release_program(engine, id);
      return status;
    }
    if (most >= engine->group)
      return VXM_OK;
    vxm_cl_programs_release(engine);
    while (engine->group > most)
      engine->group /= 2;
    if (engine->group < VXM_CL_GROUP_LEAST)
      return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s runs groups of %zu work-items only; %d are needed",
                      engine->base.info.renderer, most, VXM_CL_GROUP_LEAST);
  }
  return VXM_OK;
}

/* ---- Running ---- */

vxm_status vxm_cl_run_groups(vxm_opencl *engine, vxm_cl_kernel_id id, uint64_t groups, const vxm_cl_arg *args,
                             size_t count, vxm_error *error) {
  const vxm_cl *cl = engine->cl;
  if (groups == 0)
    return VXM_OK;
  vxm_status status = vxm_cl_ready(engine, kernels[id].program, error);
  if (status != VXM_OK)
    return status;
  cl_kernel kernel = engine->kernels[id];
  cl_int code = CL_SUCCESS;
  for (size_t a = 0; a < count && code == CL_SUCCESS; a++)
    code = cl->SetKernelArg(kernel, (cl_uint)a, args[a].size, args[a].value);
  size_t local = engine->group, global = (size_t)groups * local;
  if (code == CL_SUCCESS)
    code = cl->EnqueueNDRangeKernel(engine->queue, kernel, 1, NULL, &global, &local, 0, NULL, NULL);
  return vxm_cl_check(code, kernels[id].name, error);
}

vxm_status vxm_cl_run(vxm_opencl *engine, vxm_cl_kernel_id id, uint64_t items, const vxm_cl_arg *args,
                      size_t count, vxm_error *error) {
  vxm_status status = vxm_cl_ready(engine, kernels[id].program, error);
  if (status != VXM_OK)
    return status;
  return vxm_cl_run_groups(engine, id, (items + engine->group - 1) / engine->group, args, count, error);
}

uint64_t vxm_cl_busy_groups(const vxm_opencl *engine) {
  enum { GROUPS_PER_UNIT = 16 };
  return (uint64_t)GROUPS_PER_UNIT *
         (uint64_t)(engine->base.info.compute_units > 0 ? engine->base.info.compute_units : 1);
}
