/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <CGAL/version.h>

#include "base/module.h"
#include "modules/cgal/functions.h"

#include "config.h"

namespace {

const vxm_cgal functions = {vxm::self_intersections, vxm::fill, vxm::unite, vxm::orient, vxm::wrap};

} // namespace

extern "C" __attribute__((visibility("default"))) const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "CGAL " CGAL_VERSION_STR, "GPL-3.0-or-later", &functions};
