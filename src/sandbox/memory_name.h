/* SPDX-License-Identifier: BSD-3-Clause */
/** A file in memory for libraries that open their input by its name. */
#ifndef VXM_SANDBOX_MEMORY_NAME_H
#define VXM_SANDBOX_MEMORY_NAME_H

#include <stddef.h>

/** No path, so that nothing on a disk can be meant. */
#define VXM_MEMORY_NAME "<mesh in memory>"

/** From now on fopen of VXM_MEMORY_NAME in this program reads these bytes; they stay the caller's. */
void vxm_memory_name(const unsigned char *data, size_t size);

#endif
