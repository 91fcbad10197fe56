/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * For LD_PRELOAD: memory that fails. Never installed; allocations.py drives it.
 *
 *   ALLOCATION_AT=N        the Nth allocation fails, counted from 1
 *   ALLOCATION_ON=1        and so do all after it
 *   ALLOCATION_IN=NAME     in the program of this name; others are left alone
 *   ALLOCATION_FROM=A:B    only those that a library with one of these words in its path asks for
 *   ALLOCATION_COUNT=FILE  where the number of allocations is written in the end
 *
 * Left alone is what others crash by, which no caller can help: what the dynamic loader and the beginnings of
 * libraries allocate while one is opened, what libraries do when the program ends after an error, blosc (for
 * OpenVDB), and jansson while it reads.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

/* What lies below the functions of the standard: dlsym itself allocates. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static atomic_long calls;
static long fails_at;
static bool fails_on, is_on;
static atomic_bool is_ending;
static _Thread_local int opening;
static const char *from, *count_path;

__attribute__((constructor)) static void begin(void) {
  const char *at = getenv("ALLOCATION_AT"), *in = getenv("ALLOCATION_IN");
  fails_at = at ? strtol(at, NULL, 10) : 0;
  fails_on = getenv("ALLOCATION_ON") != NULL;
  from = getenv("ALLOCATION_FROM");
  count_path = getenv("ALLOCATION_COUNT");
  is_on = !in || strcmp(in, program_invocation_short_name) == 0;
}

__attribute__((destructor)) static void tell(void) {
  char text[32];
  int file = is_on && count_path
                 ? (int)syscall(SYS_openat, AT_FDCWD, count_path, O_WRONLY | O_CREAT | O_APPEND, 0600)
                 : -1;
  if (file < 0)
    return;
  int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&calls));
  syscall(SYS_write, file, text, length);
  syscall(SYS_close, file);
}

void *dlopen(const char *path, int flags) {
  opening++;
  void *library = ((__typeof__(&dlopen))dlsym(RTLD_NEXT, "dlopen"))(path, flags);
  opening--;
  return library;
}

/** Of jansson. */
void *json_loadb(const char *text, size_t size, size_t flags, void *error) {
  opening++;
  void *root = ((__typeof__(&json_loadb))dlsym(RTLD_NEXT, "json_loadb"))(text, size, flags, error);
  opening--;
  return root;
}

static void stop(void) {
  is_ending = true;
}

/** Comes before what libraries do in the end that are open already. */
static void stop_at_exit(void) {
  static atomic_flag is_done = ATOMIC_FLAG_INIT;
  opening++;
  if (!atomic_flag_test_and_set(&is_done))
    atexit(stop);
  opening--;
}

/** Whether the library that an address lies in is one of those asked for. */
static bool is_from(const void *address) {
  Dl_info info;
  if (!dladdr(address, &info) || !info.dli_fname || strstr(info.dli_fname, "/ld-linux") ||
      strstr(info.dli_fname, "/libblosc"))
    return false;
  for (const char *word = from ? from : "/"; *word; word += strcspn(word, ":"), word += *word == ':') {
    size_t length = strcspn(word, ":");
    if (memmem(info.dli_fname, strlen(info.dli_fname), word, length))
      return true;
  }
  return false;
}

/** Whether this allocation is one to fail. */
static bool fails(const void *caller) {
  if (!is_on || is_ending || opening > 0 || !is_from(caller))
    return false;
  long call = atomic_fetch_add(&calls, 1) + 1;
  if (fails_at == 0 || call < fails_at || (call > fails_at && !fails_on))
    return false;
  stop_at_exit();
  errno = ENOMEM;
  return true;
}

#define FAILS() fails(__builtin_return_address(0))

void *malloc(size_t size) {
  return FAILS() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
  return FAILS() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
  return FAILS() ? NULL : __libc_realloc(block, size);
}

void *reallocarray(void *block, size_t count, size_t size) {
  size_t bytes;
  if (FAILS())
    return NULL;
  if (!__builtin_mul_overflow(count, size, &bytes))
    return __libc_realloc(block, bytes);
  errno = ENOMEM;
  return NULL;
}

void *memalign(size_t alignment, size_t size) {
  return FAILS() ? NULL : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  return FAILS() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size) {
  if (FAILS())
    return ENOMEM;
  void *made = __libc_memalign(alignment, size);
  if (!made)
    return ENOMEM;
  *block = made;
  return 0;
}

void *mmap(void *address, size_t size, int protection, int flags, int file, off_t offset) {
  if (FAILS())
    return MAP_FAILED;
  return (void *)syscall(SYS_mmap, address, size, protection, flags, file, offset);
}

void *mremap(void *address, size_t size, size_t new_size, int flags, ...) {
  if (FAILS())
    return MAP_FAILED;
  return (void *)syscall(SYS_mremap, address, size, new_size, flags, NULL);
}
