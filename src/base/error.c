/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/error.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *vxm_version(void) {
#define VXM_TEXT2(x) #x
#define VXM_TEXT(x) VXM_TEXT2(x)
  return VXM_TEXT(VXM_VERSION_MAJOR) "." VXM_TEXT(VXM_VERSION_MINOR) "." VXM_TEXT(VXM_VERSION_PATCH);
}

const char *vxm_status_name(vxm_status status) {
  switch (status) {
  case VXM_OK:
    return "ok";
  case VXM_ERROR_ARGUMENT:
    return "argument";
  case VXM_ERROR_IO:
    return "io";
  case VXM_ERROR_FORMAT:
    return "format";
  case VXM_ERROR_EMPTY:
    return "empty";
  case VXM_ERROR_MEMORY:
    return "memory";
  case VXM_ERROR_MEMORY_LIMIT:
    return "memory-limit";
  case VXM_ERROR_RANGE:
    return "range";
  case VXM_ERROR_UNAVAILABLE:
    return "unavailable";
  case VXM_ERROR_CANCELLED:
    return "cancelled";
  case VXM_ERROR_UNREACHED:
    return "unreached";
  case VXM_ERROR_NUMBERS:
    return "numbers";
  }
  return "unknown";
}

/** A message is one line of printable text, whatever a damaged file put into it. */
void vxm_make_printable(char *text) {
  for (; *text; text++)
    if ((unsigned char)*text < 0x20 || *text == 0x7f)
      *text = '?';
}

static void fill(vxm_error *out, vxm_status code, vxm_place place, int system, const char *format,
                 va_list arguments) {
  if (!out)
    return;
  vxm_error whole = {
      .code = code, .line = place.line, .offset = place.offset, .element = place.element, .system = system};
  vxm_error *error = &whole;
  size_t used = 0;
  if (place.file && *place.file) {
    size_t length = strlen(place.file);
    size_t skip = length < sizeof error->file ? 0 : length - sizeof error->file + 1;
    memcpy(error->file, place.file + skip, length - skip + 1);
    int written;
    if (place.line > 0)
      written = snprintf(error->text, sizeof error->text, "%s:%" PRId64 ": ", error->file, place.line);
    else if (place.offset >= 0)
      written =
          snprintf(error->text, sizeof error->text, "%s: byte %" PRId64 ": ", error->file, place.offset);
    else
      written = snprintf(error->text, sizeof error->text, "%s: ", error->file);
    used = written > 0 ? (size_t)written : 0;
  }
  if (used < sizeof error->text)
    vsnprintf(error->text + used, sizeof error->text - used, format, arguments);
  vxm_make_printable(error->text);
  VXM_RESULT_WRITE(out, error);
}

vxm_status vxm_fail(vxm_error *error, vxm_status code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fill(error, code, (vxm_place){NULL, 0, -1, -1}, 0, format, arguments);
  va_end(arguments);
  return code;
}

vxm_status vxm_fail_at(vxm_error *error, vxm_status code, vxm_place place, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fill(error, code, place, 0, format, arguments);
  va_end(arguments);
  return code;
}

static void VXM_PRINTF(4, 5)
    fail_system(vxm_error *error, const char *file, int number, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fill(error, VXM_ERROR_IO, (vxm_place){file, 0, -1, -1}, number, format, arguments);
  va_end(arguments);
}

vxm_status vxm_fail_errno(vxm_error *error, const char *file, const char *what) {
  int saved = errno;
  char reason[128] = "";
#ifdef __GLIBC__ /* whose own may return a static text instead of filling the buffer */
  const char *text = strerror_r(saved, reason, sizeof reason);
#else
  const char *text = strerror_r(saved, reason, sizeof reason) == 0 ? reason : "unknown error";
#endif
  fail_system(error, file, saved, "%s: %s", what, text);
  errno = saved;
  return VXM_ERROR_IO;
}
