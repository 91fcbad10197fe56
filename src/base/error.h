/* SPDX-License-Identifier: BSD-3-Clause */
/** Filling a caller's vxm_error. A NULL error is allowed everywhere. */
#ifndef VXM_BASE_ERROR_H
#define VXM_BASE_ERROR_H

#include "base/sized.h"
#include "voxmend/base.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VXM_PRINTF(text, first) __attribute__((format(printf, text, first)))

/** Writes the message and returns `code`, so that callers can `return vxm_fail(...)`. */
vxm_status vxm_fail(vxm_error *error, vxm_status code, const char *format, ...) VXM_PRINTF(3, 4);

/** Where a failure lies; the parts that do not apply are 0, -1, -1. */
typedef struct vxm_place {
  const char *file;
  int64_t line;
  int64_t offset;
  int64_t element;
} vxm_place;

/** As vxm_fail, with "file:line: " or "file: byte offset: " in front of the message. */
vxm_status vxm_fail_at(vxm_error *error, vxm_status code, vxm_place place, const char *format, ...)
    VXM_PRINTF(4, 5);

/** As vxm_fail_at with VXM_ERROR_IO, followed by what errno says. */
vxm_status vxm_fail_errno(vxm_error *error, const char *file, const char *what);

/** Hands an error that was kept aside, by a worker or until it was known that it counts, to the caller. */
static inline void vxm_error_pass(vxm_error *error, const vxm_error *kept) {
  VXM_RESULT_WRITE(error, kept);
}

/** Whether memory was lacking, whatever else may be done without. */
static inline bool vxm_is_memory(vxm_status status) {
  return status == VXM_ERROR_MEMORY || status == VXM_ERROR_MEMORY_LIMIT;
}

/** Makes text fit for a line that is shown: a control code becomes a question mark. */
void vxm_make_printable(char *text);

#ifdef __cplusplus
}
#endif
#endif
