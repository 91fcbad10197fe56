/* SPDX-License-Identifier: BSD-3-Clause */
/** Text in UTF-16, as some Windows programs save it. */
#ifndef VXM_MESHIO_COMMON_UTF16_H
#define VXM_MESHIO_COMMON_UTF16_H

#include "base/context.h"

/** Whether the data begin with a UTF-16 byte order mark that is followed by text. */
bool vxm_utf16_is(const unsigned char *data, size_t size);

/** Turns UTF-16 into UTF-8 without the mark; *out is a block of the context. */
vxm_status vxm_utf16_to_utf8(unsigned char **out, size_t *out_size, vxm_context *context,
                             const unsigned char *data, size_t size, vxm_error *error);

#endif
