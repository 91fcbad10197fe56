/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/warnings.h"

#include <stdarg.h>
#include <stdio.h>

void vxm_warn(vxm_warnings *warnings, const char *format, ...) {
  if (warnings->count == VXM_NOTES_MAX)
    return;
  char *text = warnings->text[warnings->count++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, VXM_NOTE_LENGTH, format, arguments);
  va_end(arguments);
  for (; *text; text++)
    if ((unsigned char)*text < 0x20 || *text == 0x7f)
      *text = '?';
}
