/* SPDX-License-Identifier: BSD-3-Clause */
/** The published OpenCL program in `voxmend bench`, and voxels on their way from an OpenCL device. */
#include "cli/bench.h"

#include <stdlib.h>
#include <string.h>

static bool is_opencl(const char *engine) {
  return strncmp(engine, "opencl", 6) == 0;
}

bool bench_names_opencl(const bench_plan *plan) {
  for (int e = 0; e < plan->engine_count; e++)
    if (is_opencl(plan->engines[e]))
      return true;
  return false;
}

bool bench_takes_part(const bench_plan *plan, const bench_phase *phase, int engine) {
  if (phase->kind == BENCH_OPENCL && bench_names_opencl(plan))
    return is_opencl(plan->engines[engine]);
  return engine == 0 || phase->by_engine;
}

/** The triangles on the device, with voxels as large as those of the other phases; a byte each on the host.
 */
static vxm_status begin(bench_stage *stage, bool by_voxel) {
  vxm_error *error = &stage->cli->error;
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  vxm_space space;
  options.voxel_size = stage->space.voxel_size[0];
  options.by_voxel = by_voxel;
  vxm_status status = vxm_published_create(&stage->published, &space, stage->engines[stage->engine],
                                           stage->mesh, &options, error);
  if (status != VXM_OK)
    return status;
  stage->value_count = (size_t)space.dims[0] * (size_t)space.dims[1] * (size_t)space.dims[2];
  uint64_t limit = stage->cli->limits.memory_limit;
  stage->values = limit > 0 && stage->value_count > limit ? NULL : malloc(stage->value_count);
  if (stage->values) {
    memset(stage->values, 0, stage->value_count);
    return VXM_OK;
  }
  error->code = VXM_ERROR_MEMORY;
  snprintf(error->text, sizeof error->text, "no memory for %zu voxels of a byte each", stage->value_count);
  return error->code;
}

vxm_status bench_begin_published_facets(bench_stage *stage) {
  return begin(stage, false);
}

vxm_status bench_begin_published_voxels(bench_stage *stage) {
  return begin(stage, true);
}

vxm_status bench_begin_transfer(bench_stage *stage) {
  vxm_status status = begin(stage, false);
  return status == VXM_OK ? vxm_published_voxelize(NULL, stage->published, &stage->cli->error) : status;
}

vxm_status bench_run_published(bench_stage *stage) {
  vxm_status status = vxm_published_voxelize(NULL, stage->published, &stage->cli->error);
  return status == VXM_OK ? bench_run_transfer_map(stage) : status;
}

vxm_status bench_run_transfer_map(bench_stage *stage) {
  return vxm_published_read(NULL, NULL, stage->published, VXM_TRANSFER_MAP, &stage->cli->error);
}

vxm_status bench_run_transfer_read(bench_stage *stage) {
  return vxm_published_read(stage->values, NULL, stage->published, VXM_TRANSFER_READ, &stage->cli->error);
}

void bench_tell_published(bench_output *out, const bench_stage *stage) {
  const uint8_t *voxel = stage->values;
  out->bytes = stage->value_count;
  if (vxm_published_read(stage->values, NULL, stage->published, VXM_TRANSFER_READ, NULL) != VXM_OK)
    return;
  for (size_t i = 0; i < stage->value_count; i++)
    out->voxels += voxel[i] != 0;
}

/* ---- Stages ---- */

static json_t *tiles_json(const vxm_engine_stages *stages) {
  return json_pack("{sf sf sf sI sI}", "pairs_ms", stages->pairs_ms, "sort_ms", stages->sort_ms, "tiles_ms",
                   stages->tiles_ms, "pairs", (json_int_t)stages->pairs, "tiles", (json_int_t)stages->tiles);
}

static json_t *octree_json(const vxm_engine_stages *stages) {
  return json_pack("{sf sf sf sf sf sI sI}", "active_ms", stages->active_ms, "construct_ms",
                   stages->construct_ms, "voxelize_ms", stages->voxelize_ms, "propagate_ms",
                   stages->propagate_ms, "prune_ms", stages->prune_ms, "active", (json_int_t)stages->active,
                   "nodes", (json_int_t)stages->nodes);
}

json_t *bench_stages(bench_stage *stage, const bench_phase *phase) {
  vxm_engine *engine = stage->engines[stage->engine];
  vxm_engine_stages stages = VXM_ENGINE_STAGES_INIT;
  bool has_stages = phase->kind == BENCH_USUAL || phase->kind == BENCH_BASELINE;
  if (!has_stages || !phase->by_engine || vxm_engine_measure(NULL, engine, true, NULL) != VXM_OK)
    return NULL;
  vxm_status status = phase->run(stage);
  bench_stage_drop(stage);
  if (vxm_engine_measure(&stages, engine, false, NULL) != VXM_OK || status != VXM_OK)
    return NULL;
  return stages.pairs > 0 ? tiles_json(&stages) : stages.nodes > 0 ? octree_json(&stages) : NULL;
}
