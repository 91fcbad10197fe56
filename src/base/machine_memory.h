/* SPDX-License-Identifier: BSD-3-Clause */
/** How much memory there is. */
#ifndef VXM_BASE_MACHINE_MEMORY_H
#define VXM_BASE_MACHINE_MEMORY_H

#include <stdint.h>

/** Bytes that the machine has, or the container that this runs in; found out once. */
uint64_t vxm_machine_memory(void);

#endif
