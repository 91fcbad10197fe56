/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids tile by tile (Schwarz & Seidel 2010, section 4.2): count, scan, fill, sort by tile, a work-group
 * for each tile. See shaders/tiles.cl. */
#include "base/clock.h"
#include "gpu/opencl/cl_solid.h"
#include "gpu/opencl/cl_sort.h"
#include "gpu/opencl/cl_tree.h"

enum {
  TILE_LOCAL_BYTES = 1 << 14, /**< for flips: half of what the least device has, the rest is for triangles */
  ROLE_SHIFT = 29             /**< as in the shader */
};

/** A job on a slab of the window, and the tiles of columns in that. */
typedef struct tiling {
  vxm_opencl *engine;
  const vxm_slab *slab;
  vxm_slab_columns columns;
  cl_uint roles; /**< bit r: triangles of role 1 << r count */
  cl_uint across, count;
} tiling;

/** Parts of triangles, and their roles, on the device. */
vxm_status vxm_cl_place_parts(vxm_opencl *engine, const vxm_triangle_set *triangles, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  if (engine->parts_serial == triangles->serial)
    return VXM_OK;
  engine->parts_serial = 0;
  uint32_t *parts = vxm_alloc(engine->base.context, triangles->triangle_count, sizeof *parts, &local);
  for (size_t f = 0; parts && f < triangles->triangle_count; f++) {
    vxm_triangle_role role = vxm_role_of(triangles, f);
    uint32_t number = role == VXM_ROLE_FACE ? 0 : role == VXM_ROLE_CAP ? 1 : 2;
    parts[f] = triangles->part[f] | number << ROLE_SHIFT;
  }
  vxm_status status =
      parts ? vxm_cl_upload(engine, VXM_CL_PARTS, parts, triangles->triangle_count * sizeof *parts, &local)
            : local.code;
  vxm_free(engine->base.context, parts);
  if (status == VXM_OK)
    engine->parts_serial = triangles->serial;
  else
    vxm_error_pass(error, &local);
  return status;
}

static tiling tiling_of(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job) {
  tiling t = {
      .engine = engine, .slab = slab, .columns = vxm_slab_columns_of(slab, job), .roles = job->roles & 7};
  const vxm_triangle_set *triangles = job->triangles;
  size_t first = triangles->parts[job->part_begin].begin, end = triangles->parts[job->part_end - 1].end;
  cl_uint tile_u = engine->group >= 32 ? 8 : 4, tile_v = (cl_uint)engine->group / tile_u;
  cl_uint width = (cl_uint)(t.columns.last[0] - t.columns.first[0]);
  cl_uint height = (cl_uint)(t.columns.last[1] - t.columns.first[1]);
  t.columns.triangle_first = (uint32_t)first;
  t.columns.triangle_count = (uint32_t)(end - first);
  t.across = (width + tile_u - 1) / tile_u;
  t.count = t.across * ((height + tile_v - 1) / tile_v);
  return t;
}

/** Lists the triangles of each tile of columns. `pairs`: how many there are in all lists. */
static vxm_status list_triangles(tiling *t, cl_uint *pairs, vxm_error *error) {
  vxm_opencl *engine = t->engine;
  size_t triangles = t->columns.triangle_count;
  double since = vxm_clock_ms();
  int bits = 0;
  while (bits < 32 && t->count > UINT64_C(1) << bits)
    bits++;
  cl_uint total[2] = {0, 0};
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_COUNTS, (triangles + 1) * sizeof(cl_uint), error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_TALLY, sizeof total, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_COUNT_TILES, triangles,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                                    VXM_CL_MEM(engine, VXM_CL_PARTS), VXM_CL_MEM(engine, VXM_CL_COUNTS),
                                    VXM_CL_MEM(engine, VXM_CL_TALLY), VXM_CL_VALUE(t->columns),
                                    VXM_CL_VALUE(t->roles)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_download(engine, VXM_CL_TALLY, 0, total, sizeof total, error);
  if (status == VXM_OK && total[1] > 0)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "opencl: the triangles meet more than 2^32 tiles of columns; use --cl-method triangles");
  *pairs = total[0];
  if (status == VXM_OK)
    status = vxm_cl_scan(engine, VXM_CL_COUNTS, triangles, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_TILE_KEYS, (size_t)*pairs * sizeof(uint64_t), error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_TILE_TRIANGLES, (size_t)*pairs * sizeof(cl_uint), error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_LIST_TILES, triangles,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                                    VXM_CL_MEM(engine, VXM_CL_PARTS), VXM_CL_MEM(engine, VXM_CL_COUNTS),
                                    VXM_CL_MEM(engine, VXM_CL_TILE_KEYS),
                                    VXM_CL_MEM(engine, VXM_CL_TILE_TRIANGLES), VXM_CL_VALUE(t->columns),
                                    VXM_CL_VALUE(t->roles), VXM_CL_VALUE(t->across)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_stage_end(engine, VXM_CL_STAGE(pairs), &since, error);
  if (status == VXM_OK)
    status = vxm_cl_sort(engine, VXM_CL_TILE_KEYS, VXM_CL_TILE_TRIANGLES, *pairs, bits, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_LISTS, t->count * sizeof(cl_uint2), error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_FIND_TILES, *pairs,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_TILE_KEYS), VXM_CL_MEM(engine, VXM_CL_LISTS),
                                    VXM_CL_VALUE(*pairs)),
                        error);
  return status == VXM_OK ? vxm_cl_stage_end(engine, VXM_CL_STAGE(sort), &since, error) : status;
}

/** Words of the columns from `first` on, as many as local memory has room for. */
static vxm_status fill_words(tiling *t, cl_uint first, cl_uint words, vxm_cl_buffer_id into,
                             vxm_error *error) {
  vxm_opencl *engine = t->engine;
  vxm_slab_columns part = t->columns;
  int32_t end = part.first[2] + (int32_t)(first + words) * 32;
  part.first[2] += (int32_t)first * 32;
  part.keep_before |= first > 0;
  part.last[2] = end < part.last[2] ? end : part.last[2];
  cl_uint rest = (cl_uint)(part.last[2] - part.first[2]) % 32;
  const cl_uint2 shape = {{words, rest ? (UINT32_C(1) << rest) - 1 : UINT32_MAX}};
  const vxm_cl_arg args[] = {VXM_CL_MEM(engine, VXM_CL_POINTS),
                             VXM_CL_MEM(engine, VXM_CL_CORNERS),
                             VXM_CL_MEM(engine, VXM_CL_PARTS),
                             VXM_CL_MEM(engine, VXM_CL_TILE_TRIANGLES),
                             VXM_CL_MEM(engine, VXM_CL_LISTS),
                             VXM_CL_MEM(engine, into),
                             VXM_CL_MEM(engine, VXM_CL_TOUCHED),
                             VXM_CL_VALUE(part),
                             VXM_CL_VALUE(t->across),
                             VXM_CL_VALUE(first),
                             VXM_CL_VALUE(shape),
                             {words * engine->group * sizeof(cl_uint), NULL}};
  return vxm_cl_run_groups(engine, VXM_CL_FILL_TILES, t->count, args, sizeof args / sizeof args[0], error);
}

vxm_status vxm_cl_tiles(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                        vxm_cl_buffer_id into, vxm_error *error) {
  cl_uint pairs = 0;
  vxm_status status = vxm_cl_ready(engine, VXM_CL_TILES_PROGRAM, error);
  if (status == VXM_OK)
    status = vxm_cl_ready(engine, VXM_CL_SORT, error);
  if (status == VXM_OK)
    status = vxm_cl_ready(engine, VXM_CL_TILES_PROGRAM, error); /* the group may have shrunk */
  if (status == VXM_OK)
    status = vxm_cl_place_parts(engine, job->triangles, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, into, slab->words * sizeof(uint64_t), error);
  if (status == VXM_OK && !job->has_voxels) /* written all the same */
    status =
        vxm_cl_reserve(engine, VXM_CL_TOUCHED, job->triangles->split.part_count * sizeof(uint32_t), error);
  if (status != VXM_OK)
    return status;
  tiling t = tiling_of(engine, slab, job);
  status = list_triangles(&t, &pairs, error);
  cl_uint words = (cl_uint)(slab->window->fast_dim + 31) / 32;
  cl_uint most = (cl_uint)(TILE_LOCAL_BYTES / sizeof(cl_uint) / engine->group);
  double since = vxm_clock_ms();
  for (cl_uint w = 0; w < words && pairs > 0 && status == VXM_OK; w += most)
    status = fill_words(&t, w, words - w < most ? words - w : most, into, error);
  if (status == VXM_OK && engine->stages) {
    engine->stages->pair_count += pairs;
    engine->stages->tile_count += t.count;
    status = vxm_cl_stage_end(engine, VXM_CL_STAGE(tiles), &since, error);
  }
  return status == VXM_OK ? vxm_progress(engine->base.context, job->phase, 1.0, error) : status;
}

bool vxm_cl_can_tile(const vxm_opencl *engine, const vxm_window *window, const vxm_parity_union_job *job) {
  return job->axis == window->layout.fast && engine->device_cache.oversized.count == 0 &&
         job->triangles->split.part_count < (size_t)1 << ROLE_SHIFT;
}
