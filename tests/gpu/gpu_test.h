/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of engines share. Each is compiled once for every context or device: ENGINE is its name,
 * CL_METHOD how OpenCL makes solids. */
#ifndef TEST_GPU_TEST_H
#define TEST_GPU_TEST_H

#include "../voxel/engine.h"

#include "voxel/engine/engine.h"

#include <stdio.h>

static vxm_engine *engine;

#ifdef DRIVER_LEAKS
/** PoCL keeps what it makes once, and LeakSanitizer stumbles over its threads: it is told to stay away. */
__attribute__((visibility("default"))) int __lsan_is_turned_off(void);
int __lsan_is_turned_off(void) {
  return 1;
}
#endif

/** Exit status 77 where there is no such context: the test counts as skipped, and says why. */
static inline int gpu_test_start(const vxm_engine_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_engine_options chosen = VXM_ENGINE_OPTIONS_INIT;
  if (options)
    chosen = *options;
#ifdef CL_METHOD
  chosen.cl_method = CL_METHOD;
#endif
  vxm_status status = vxm_engine_create(&engine, NULL, ENGINE, &chosen, &error);
  if (status == VXM_OK)
    return 0;
  fprintf(stderr, "%s: %s\n", status == VXM_ERROR_UNAVAILABLE ? "skipped" : "failed", error.text);
  return status == VXM_ERROR_UNAVAILABLE ? 77 : 1;
}

/** A box within 16 voxels along each axis. Two of its faces lie at the same part of a voxel, 0.5 being the
 * centres; others are moved by `offset`. */
static inline vxm_soup *box_with_ties(double offset, double part) {
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[3]){2 + offset, 3 + part, 4 + offset}, (double[3]){12 + part, 11 + offset, 13.5});
  return soup;
}

#endif
