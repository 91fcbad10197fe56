/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/external/cgal.h"

#include "base/module.h"

vxm_status vxm_cgal_open(const vxm_cgal **out, const char *purpose, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_open(
      &module, &(vxm_module_need){.name = "cgal", .package = "libcgal-dev", .purpose = purpose}, error);
  *out = status == VXM_OK ? module->functions : NULL;
  return status;
}
