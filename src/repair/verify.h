/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether a mesh is at a level, and writing one so that its file is. */
#ifndef VXM_REPAIR_VERIFY_H
#define VXM_REPAIR_VERIFY_H

#include "mesh/soup.h"

/** vxm_mesh_verify. */
vxm_status vxm_verify(vxm_verification *out, const vxm_soup *soup, const vxm_repair_options *options,
                      vxm_error *error);

/** vxm_mesh_write_verified, with all options given. */
vxm_status vxm_write_verified(vxm_verification *out, const vxm_soup *soup, const char *path,
                              const vxm_mesh_write_options *write, const vxm_repair_options *repair,
                              bool best_effort, vxm_error *error);

#endif
