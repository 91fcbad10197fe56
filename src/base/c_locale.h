/* SPDX-License-Identifier: BSD-3-Clause */
/** The locale "C", by which files are read and written whatever the program's own one is. */
#ifndef VXM_BASE_C_LOCALE_H
#define VXM_BASE_C_LOCALE_H

#include <locale.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * One for the process, never freed. Not 0 where there is a context: none is created without it. For printf
 * and strtod it becomes the thread's by uselocale, which returns the one to go back to.
 */
locale_t vxm_c_locale(void);

#ifdef __cplusplus
}
#endif
#endif
