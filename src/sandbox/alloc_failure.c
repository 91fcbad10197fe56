/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/alloc_failure.h"

#include <errno.h>
#include <malloc.h>
#include <stdlib.h>

#include "sandbox/confine.h"

static void (*end_program)(void);

void vxm_alloc_failure_ends(void (*end)(void)) {
  end_program = end;
}

#if defined(__GLIBC__) && !VXM_IS_SANITIZED && !defined(__SANITIZE_THREAD__)

/* What glibc's own functions of these names are made of. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

/** A block that was asked for; NULL may also stand for an empty one, or for a wrong alignment. */
static void *checked(void *block, size_t size) {
  void (*end)(void) = end_program;
  if (block == NULL && size > 0 && errno == ENOMEM && end != NULL) {
    end_program = NULL; /* what it allocates in turn may fail */
    end();
  }
  return block;
}

/* The program's own symbols come before those of the C library, also for the libraries that it opens. */
#define SEEN __attribute__((visibility("default")))

SEEN void *malloc(size_t size) {
  return checked(__libc_malloc(size), size);
}

SEEN void *calloc(size_t count, size_t size) {
  return checked(__libc_calloc(count, size), count > 0 ? size : 0);
}

SEEN void *realloc(void *block, size_t size) {
  return checked(__libc_realloc(block, size), size);
}

SEEN void *memalign(size_t alignment, size_t size) {
  return checked(__libc_memalign(alignment, size), size);
}

SEEN void *aligned_alloc(size_t alignment, size_t size) {
  return checked(__libc_memalign(alignment, size), size);
}

SEEN int posix_memalign(void **out, size_t alignment, size_t size) {
  if (alignment < sizeof(void *) || (alignment & (alignment - 1)) != 0)
    return EINVAL;
  void *block = checked(__libc_memalign(alignment, size), size);
  if (block == NULL)
    return ENOMEM;
  *out = block;
  return 0;
}

#endif
