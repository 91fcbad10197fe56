/* SPDX-License-Identifier: BSD-3-Clause */
/** Bytes inside a page: packed in the format of zlib, as base64, in a script element of their own. */
#ifndef VXM_GRIDIO_PAGE_PACK_H
#define VXM_GRIDIO_PAGE_PACK_H

#include "base/output.h"

typedef struct vxm_pack vxm_pack;

/** Begins a block. @param id of its element: letters. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_pack_begin(vxm_pack **out, vxm_context *context, vxm_output *output, const char *id,
                          vxm_error *error);
/** Adds bytes; a failure is told by vxm_pack_end. */
void vxm_pack_put(vxm_pack *pack, const void *data, size_t size);
/** Ends the block and frees the pack, also after a failure. NULL is allowed. */
vxm_status vxm_pack_end(vxm_pack *pack, vxm_error *error);

#endif
