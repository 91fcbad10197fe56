/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/batch.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

const char *const batch_status_names[BATCH_STATUSES + 1] = {
    "pending", "ok",  "degraded", "duplicate",   "unreadable", "failed",
    "timeout", "oom", "crash",    "quarantined", NULL};

batch_status batch_status_of(const char *name) {
  for (int s = 0; name && s < BATCH_STATUSES; s++)
    if (strcmp(name, batch_status_names[s]) == 0)
      return (batch_status)s;
  return BATCH_STATUSES;
}

bool batch_fail(batch_error *error, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  return false;
}

bool batch_fail_errno(batch_error *error, const char *format, ...) {
  int reason = errno;
  va_list arguments;
  va_start(arguments, format);
  int used = vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  if (used >= 0 && (size_t)used < sizeof error->text)
    snprintf(error->text + used, sizeof error->text - (size_t)used, ": %s", strerror(reason));
  errno = reason; /* still what it was */
  return false;
}

double batch_clock_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

bool batch_write_all(int descriptor, const char *text, size_t size) {
  while (size > 0) {
    ssize_t done = write(descriptor, text, size);
    if (done < 0 && errno == EINTR)
      continue;
    if (done <= 0)
      return false;
    text += done;
    size -= (size_t)done;
  }
  return true;
}

const char *batch_json_text(const json_t *object, const char *key) {
  return json_string_value(json_object_get(object, key));
}

json_t *batch_json_string(const char *text) {
  json_t *value = json_string(text);
  char *copy = value ? NULL : strdup(text);
  if (!copy)
    return value;
  for (char *c = copy; *c; c++)
    if ((unsigned char)*c >= 0x80)
      *c = '?';
  value = json_string(copy);
  free(copy);
  return value;
}
