/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * For LD_PRELOAD: a disk that fails. Never installed; writes.py drives it.
 *
 *   FAULT_AT=N        the Nth call that changes files fails, counted from 1 (a close closes all the same)
 *   FAULT_ERRNO=E     with this errno [EIO]
 *   FAULT_ROOM=BYTES  so many bytes can be written to files; then the disk is full
 *   FAULT_LACKS=WORDS what the file system cannot do: "tmpfile", "exchange"
 *   FAULT_COUNT=FILE  where the number of calls is written in the end
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_long calls;
static atomic_long written;

static long number(const char *name, long otherwise) {
  const char *text = getenv(name);
  return text ? strtol(text, NULL, 10) : otherwise;
}

/** Whether this call is the one to fail. */
static int is_to_fail(void) {
  if (atomic_fetch_add(&calls, 1) + 1 != number("FAULT_AT", 0))
    return 0;
  errno = (int)number("FAULT_ERRNO", EIO);
  return 1;
}

static int lacks(const char *what) {
  const char *list = getenv("FAULT_LACKS");
  return list && strstr(list, what);
}

static int is_file(int descriptor) {
  struct stat info;
  return fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
}

/** How much of `size` there is room for; -1 if there is none. */
static ssize_t take_room(int descriptor, size_t size) {
  long room = number("FAULT_ROOM", -1);
  if (room < 0 || size == 0 || !is_file(descriptor))
    return (ssize_t)size;
  long left = room - atomic_load(&written);
  if (left <= 0) {
    errno = ENOSPC;
    return -1;
  }
  if (size > (size_t)left)
    size = (size_t)left;
  atomic_fetch_add(&written, (long)size);
  return (ssize_t)size;
}

__attribute__((destructor)) static void tell(void) {
  char text[32];
  const char *path = getenv("FAULT_COUNT");
  int descriptor = path ? (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND, 0600) : -1;
  if (descriptor < 0)
    return;
  int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&calls));
  syscall(SYS_write, descriptor, text, length);
  syscall(SYS_close, descriptor);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int descriptor, const void *data, size_t size) {
  ssize_t taken = is_to_fail() ? -1 : take_room(descriptor, size);
  return taken < 0 ? -1 : NEXT(write)(descriptor, data, (size_t)taken);
}

ssize_t pwrite(int descriptor, const void *data, size_t size, off_t at) {
  return is_to_fail() ? -1 : NEXT(pwrite)(descriptor, data, size, at);
}

int close(int descriptor) {
  int fails = is_to_fail(), reason = errno;
  int result = NEXT(close)(descriptor);
  if (!fails)
    return result;
  errno = reason;
  return -1;
}

int rename(const char *from, const char *to) {
  return is_to_fail() ? -1 : NEXT(rename)(from, to);
}

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
  return is_to_fail() ? -1 : NEXT(renameat)(from_folder, from, to_folder, to);
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned flags) {
  if (flags && lacks("exchange")) {
    errno = EINVAL;
    return -1;
  }
  return is_to_fail() ? -1 : NEXT(renameat2)(from_folder, from, to_folder, to, flags);
}

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags) {
  return is_to_fail() ? -1 : NEXT(linkat)(from_folder, from, to_folder, to, flags);
}

int fsync(int descriptor) {
  return is_to_fail() ? -1 : NEXT(fsync)(descriptor);
}

int ftruncate(int descriptor, off_t size) {
  return is_to_fail() ? -1 : NEXT(ftruncate)(descriptor, size);
}

int fchmod(int descriptor, mode_t mode) {
  return is_to_fail() ? -1 : NEXT(fchmod)(descriptor, mode);
}

int fallocate(int descriptor, int mode, off_t at, off_t size) {
  long room = number("FAULT_ROOM", -1);
  if (is_to_fail())
    return -1;
  if (room >= 0 && size > room - atomic_load(&written)) {
    errno = ENOSPC;
    return -1;
  }
  return NEXT(fallocate)(descriptor, mode, at, size);
}

int mkdir(const char *path, mode_t mode) {
  return is_to_fail() ? -1 : NEXT(mkdir)(path, mode);
}

int openat(int folder, const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  mode_t mode = va_arg(arguments, mode_t);
  va_end(arguments);
  if ((flags & O_TMPFILE) == O_TMPFILE && lacks("tmpfile")) {
    errno = EOPNOTSUPP;
    return -1;
  }
  if (((flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE) && is_to_fail())
    return -1;
  return NEXT(openat)(folder, path, flags, mode);
}
