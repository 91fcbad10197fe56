/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/error.h"
#include "base/module.h"
#include "base/sized.h"
#include "config.h"
#include "meshio/external/external_formats.h"
#include "sandbox/landlock.h"

#if defined(HAVE_SECCOMP) && !defined(__SANITIZE_ADDRESS__)
enum { HAS_FILTER = 1 };
#else
enum { HAS_FILTER = 0 };
#endif

static bool has_module(const char *name) {
  char path[VXM_MODULE_PATH_MAX];
  vxm_module_need need = {name, "", ""};
  return vxm_module_find(path, &need, NULL) == VXM_OK;
}

vxm_status vxm_reading_find(vxm_reading_info *out, vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "reading: an argument is NULL");
  vxm_reading_info found = {.assimp = has_module("assimp"),
                            .occt = has_module("occt"),
                            .assimp_formats = VXM_ASSIMP_FORMATS,
                            .occt_formats = VXM_OCCT_FORMATS,
                            .filter = HAS_FILTER,
                            .landlock = vxm_landlock_version()};
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}
