/* SPDX-License-Identifier: BSD-3-Clause */
/** Names of the parts of a scene, which are told apart where several have the same one. */
#ifndef VXM_MESHIO_COMMON_PART_NAMES_H
#define VXM_MESHIO_COMMON_PART_NAMES_H

#include "meshio/common/tags.h"

#ifdef __cplusplus
extern "C" {
#endif

/** numbers[i] becomes 0 if names[i] occurs once or is empty, otherwise 1, 2, ... in the order of occurrence.
 */
vxm_status vxm_part_names_number(uint32_t *numbers, vxm_context *context, const char *const *names,
                                 size_t count, vxm_error *error);

/** Takes the part as the tagger's group: "name", or "name#2" if it has a number. */
void vxm_part_names_tag(vxm_tagger *tagger, const char *name, uint32_t number);

#ifdef __cplusplus
}
#endif
#endif
