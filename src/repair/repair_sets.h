/* SPDX-License-Identifier: BSD-3-Clause */
/** Repair of a soup whose faces are in sets (mesh/face_sets.h). */
#ifndef VXM_REPAIR_REPAIR_SETS_H
#define VXM_REPAIR_REPAIR_SETS_H

#include "mesh/soup.h"

/**
 * As vxm_repair_prepare, of each set as if it were alone. The result has the same sets; its faces are in the
 * order in which their tags first occur in `in`, so that labels keep their numbers. A set that was wound
 * inward is again: it may be a cavity of another one.
 *
 * @return as vxm_repair_run; VXM_ERROR_ARGUMENT for an account of parts
 */
vxm_status vxm_repair_prepare_sets(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                                   const vxm_repair_options *options, vxm_error *error);

#endif
