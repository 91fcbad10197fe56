/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/memory_name.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const unsigned char *bytes;
static size_t byte_count;

void vxm_memory_name(const unsigned char *data, size_t size) {
  bytes = data;
  byte_count = size;
}

/** fmemopen takes a writable block for history's sake, and does not write to what is only read. */
static FILE *open_bytes(const char *mode) {
  if (byte_count > 0 && mode[0] == 'r' && strchr(mode, '+') == NULL)
    return fmemopen((void *)(uintptr_t)bytes, byte_count, "r");
  errno = EACCES;
  return NULL;
}

static FILE *open_file(const char *symbol, const char *path, const char *mode) {
  FILE *(*next)(const char *, const char *);
  if (strcmp(path, VXM_MEMORY_NAME) == 0)
    return open_bytes(mode);
  void *found = dlsym(RTLD_NEXT, symbol);
  memcpy(&next, &found, sizeof next);
  return next ? next(path, mode) : NULL;
}

/* The program's own symbols come before those of the C library, also for the libraries that it opens. */
#undef fopen
#undef fopen64
__attribute__((visibility("default"))) FILE *fopen(const char *path, const char *mode) {
  return open_file("fopen", path, mode);
}

__attribute__((visibility("default"))) FILE *fopen64(const char *path, const char *mode) {
  return open_file("fopen64", path, mode);
}
