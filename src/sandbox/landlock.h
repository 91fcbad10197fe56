/* SPDX-License-Identifier: BSD-3-Clause */
/** Landlock, by which a process takes files, ports and signals to others away from itself, for good. */
#ifndef VXM_SANDBOX_LANDLOCK_H
#define VXM_SANDBOX_LANDLOCK_H

#include <stdbool.h>

/** Which version the kernel has; 0 = none. */
int vxm_landlock_version(void);

/** Denies all of it, as far as this version goes. Needs PR_SET_NO_NEW_PRIVS. True where there is none. */
bool vxm_landlock(void);

#endif
