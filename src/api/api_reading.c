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

vxm_status vxm_reading_find(vxm_reading_info *out, vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "reading: an argument is NULL");
  vxm_reading_info found = {.assimp = vxm_module_exists("assimp"),
                            .occt = vxm_module_exists("occt"),
                            .assimp_formats = VXM_ASSIMP_FORMATS,
                            .occt_formats = VXM_OCCT_FORMATS,
                            .filter = HAS_FILTER,
                            .landlock = vxm_landlock_version()};
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}
