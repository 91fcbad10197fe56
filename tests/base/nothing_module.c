/* SPDX-License-Identifier: BSD-3-Clause */
/** A module that does nothing. */
#include "config.h"

#include "base/module.h"

VXM_API extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "nothing", "BSD-3-Clause", NULL};
