/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/engine/engine.h"

#include <stdio.h>

vxm_parity_union_job vxm_voter(const vxm_vote_job *job, const vxm_window *window, int voter) {
  static const char *const phase[VXM_VOTERS] = {"voxelizing along x", "voxelizing along y",
                                                "voxelizing along z", "voxelizing tetrahedra"};
  bool tetra = voter == 3;
  return (vxm_parity_union_job){.triangles = job->triangles,
                                .placed = job->placed,
                                .axis = tetra ? window->layout.fast : voter,
                                .part_begin = job->part_begin,
                                .part_end = job->part_end,
                                .roles = tetra ? VXM_ROLE_FACE | VXM_ROLE_CONE : VXM_ROLE_FACE,
                                .has_voxels = job->has_voxels,
                                .phase = phase[voter]};
}

bool vxm_engine_falls_back(vxm_engine *engine, const vxm_error *error) {
  if (!engine->falls_back || error->code == VXM_ERROR_CANCELLED || error->code == VXM_ERROR_MEMORY_LIMIT)
    return false;
  snprintf(engine->info.note, sizeof engine->info.note, "%s failed, so the CPU went on: %.150s",
           engine->info.name, error->text);
  engine->info.available = false;
  engine->ops->destroy(engine);
  engine->ops = NULL;
  snprintf(engine->info.name, sizeof engine->info.name, "cpu");
  return true;
}

vxm_status vxm_fail_to_keep(vxm_engine *engine, vxm_error *error) {
  engine->needs_host = true;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s cannot make these voxels without the CPU",
                  engine->info.name);
}
