/* SPDX-License-Identifier: BSD-3-Clause */
/** What stands in glTF where another file is meant: names with %20 for a blank, and data itself. */
#ifndef VXM_MODULES_ASSIMP_URI_H
#define VXM_MODULES_ASSIMP_URI_H

#include "base/context.h"

/** Replaces %XX by the byte it stands for, once; what is no code stays, as does %00, with which a name would
 * end early. The name is then looked up as any other: ".." that was written as a code leads no farther.
 * `decode` in src/cli/file_conflicts.c does the same. */
void vxm_uri_decode(char *name);

/** Whether the URI holds the data itself, in base64: "data:...;base64,...". */
bool vxm_uri_is_data(const char *uri, size_t length);
/** Makes bytes of such a URI, as a block of the context. False if it is damaged, or the memory is not there.
 */
bool vxm_uri_data(unsigned char **out, size_t *size, vxm_context *context, const char *uri, size_t length);

#endif
