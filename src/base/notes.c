/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/notes.h"

#include <stdarg.h>
#include <stdio.h>

void vxm_note(vxm_notes *notes, const char *format, ...) {
  if (notes->count == VXM_NOTES_MAX)
    return;
  char *text = notes->text[notes->count++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, VXM_NOTE_LENGTH, format, arguments);
  va_end(arguments);
  for (; *text; text++)
    if ((unsigned char)*text < 0x20 || *text == 0x7f)
      *text = '?';
}
