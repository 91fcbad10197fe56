/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/cl.h"

#include <dlfcn.h>
#include <pthread.h>
#include <string.h>

typedef struct entry {
  const char *name;
  size_t offset;
} entry;

static const entry entries[] = {
#define VXM_CL_ENTRY(name) {"cl" #name, offsetof(vxm_cl, name)},
    VXM_CL_FUNCTIONS(VXM_CL_ENTRY)
#undef VXM_CL_ENTRY
};

static struct {
  vxm_cl functions;
  bool is_found, is_whole;
  const char *missing;
} loader;

/** It stays loaded: drivers leave threads behind. */
static void load(void) {
  static const char *const names[] = {"libOpenCL.so.1", "libOpenCL.so"};
  void *library = NULL;
  for (size_t i = 0; i < sizeof names / sizeof names[0] && !library; i++)
    library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
  loader.is_found = library != NULL;
  for (size_t i = 0; i < sizeof entries / sizeof entries[0] && library; i++) {
    void *symbol = dlsym(library, entries[i].name);
    if (!symbol) {
      loader.missing = entries[i].name;
      return;
    }
    memcpy((char *)&loader.functions + entries[i].offset, &symbol, sizeof symbol);
  }
  loader.is_whole = library != NULL;
}

const vxm_cl *vxm_cl_load(vxm_error *error) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, load);
  if (loader.is_whole)
    return &loader.functions;
  if (loader.is_found)
    vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the OpenCL loader has no %s: OpenCL 1.2 is needed",
             loader.missing);
  else
    vxm_fail(error, VXM_ERROR_UNAVAILABLE,
             "no OpenCL loader here: install ocl-icd-libopencl1, and a driver (pocl-opencl-icd runs on any "
             "CPU)");
  return NULL;
}

vxm_status vxm_cl_check(cl_int code, const char *doing, vxm_error *error) {
  switch (code) {
  case CL_SUCCESS:
    return VXM_OK;
  case CL_OUT_OF_HOST_MEMORY:
  case CL_MEM_OBJECT_ALLOCATION_FAILURE:
  case CL_OUT_OF_RESOURCES:
    return vxm_fail(error, VXM_ERROR_MEMORY,
                    "opencl: %s: the device is out of memory; lower the resolution or use --engine cpu",
                    doing);
  case CL_DEVICE_NOT_AVAILABLE:
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "opencl: %s: the device is not available any more; use --engine cpu", doing);
  default:
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "opencl: %s: the driver reports error %d; use --engine cpu",
                    doing, (int)code);
  }
}
