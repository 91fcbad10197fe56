/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of the OpenGL engine share. Each is compiled once for every context: ENGINE is its name. */
#ifndef TEST_GPU_TEST_H
#define TEST_GPU_TEST_H

#include "../voxel/engine.h"

#include "voxel/engine.h"

#include <stdio.h>

static vxm_engine *engine;

/** Exit status 77 where there is no such context: the test counts as skipped, and says why. */
static inline int gpu_test_start(const vxm_engine_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_engine_create(&engine, NULL, ENGINE, options, &error);
  if (status == VXM_OK)
    return 0;
  fprintf(stderr, "%s: %s\n", status == VXM_ERROR_UNAVAILABLE ? "skipped" : "failed", error.text);
  return status == VXM_ERROR_UNAVAILABLE ? 77 : 1;
}

#endif
