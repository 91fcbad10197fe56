/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/engine.h"

#include <stdio.h>

bool vxm_engine_gives_way(vxm_engine *engine, const vxm_error *error) {
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
