/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/warnings.h"

#include <stdarg.h>
#include <stdio.h>

void vxm_warn(vxm_warnings *warnings, const char *format, ...) {
  if (warnings->count == VXM_WARNINGS_MAX)
    return;
  char *text = warnings->text[warnings->count++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, VXM_WARNING_LENGTH, format, arguments);
  va_end(arguments);
  vxm_make_printable(text);
}
