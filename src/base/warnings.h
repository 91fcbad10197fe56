/* SPDX-License-Identifier: BSD-3-Clause */
/** A short list of warnings that belongs to an object. */
#ifndef VXM_BASE_WARNINGS_H
#define VXM_BASE_WARNINGS_H

#include "base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VXM_WARNINGS_MAX = 16, VXM_WARNING_LENGTH = 320 };

/**
 * Readers gather each kind of damage into one line ("line 7: ...; 12 such lines in all"), so a fixed number
 * is enough; what comes after the last place is left out.
 */
typedef struct vxm_warnings {
  int count;
  char text[VXM_WARNINGS_MAX][VXM_WARNING_LENGTH];
} vxm_warnings;

void vxm_warn(vxm_warnings *warnings, const char *format, ...) VXM_PRINTF(2, 3);

#ifdef __cplusplus
}
#endif
#endif
