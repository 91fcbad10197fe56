/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/open_beneath.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

int vxm_folder_open(const char *path) {
  char folder[PATH_MAX];
  const char *slash = strrchr(path, '/');
  size_t length = slash ? (size_t)(slash - path) + 1 : 0;
  if (length >= sizeof folder) {
    errno = ENAMETOOLONG;
    return -1;
  }
  memcpy(folder, path, length);
  memcpy(folder + length, ".", 2);
  return open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
}

/** One step: neither a link nor the way up. `name` is one component. */
static int step(int folder, const char *name, int flags) {
  if (strcmp(name, "..") == 0) {
    errno = EXDEV;
    return -1;
  }
  int descriptor = openat(folder, name, flags | O_NOFOLLOW | O_CLOEXEC);
  struct stat info;
  if (descriptor < 0 || (flags & O_PATH) == 0 || fstat(descriptor, &info) != 0 || !S_ISLNK(info.st_mode))
    return descriptor;
  close(descriptor); /* with O_PATH a link opens as itself */
  errno = ELOOP;
  return -1;
}

static int walk(int folder, const char *name, int flags) {
  int at = folder;
  for (;;) {
    char component[NAME_MAX + 1];
    size_t length = strcspn(name, "/"), slashes = strspn(name + length, "/");
    bool is_last = name[length] == '\0';
    int next = -1;
    errno = length == 0 ? ENOTDIR : ENAMETOOLONG;
    if (length > 0 && length <= NAME_MAX) {
      memcpy(component, name, length);
      component[length] = '\0';
      next = step(at, component, is_last ? flags : O_PATH | O_DIRECTORY);
    }
    if (at != folder) {
      int reason = errno;
      close(at);
      errno = reason;
    }
    if (is_last || next < 0)
      return next;
    at = next;
    name += length + slashes;
  }
}

/** The kernel's own look-up, which renames at the same time cannot lead astray: then it wants to be asked
 * again. */
static int ask_kernel(int folder, const char *name, int flags) {
  enum { TRIES = 16, OPENAT2 = 437 /* on every architecture; older C libraries have no name for it */ };
  struct open_how how = {.flags = (unsigned)(flags | O_CLOEXEC),
                         .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
  for (int t = 0;; t++) {
    int descriptor = (int)syscall(OPENAT2, folder, name, &how, sizeof how);
    if (descriptor >= 0 || (errno != EAGAIN && errno != EINTR) || t == TRIES)
      return descriptor;
  }
}

static int look_up(int folder, const char *name, int flags, vxm_beneath how) {
  if (how == VXM_BENEATH_NOT)
    return openat(folder, name, flags | O_CLOEXEC);
  if (*name == '/') {
    errno = EXDEV;
    return -1;
  }
  if (how == VXM_BENEATH) {
    int descriptor = ask_kernel(folder, name, flags);
    /* Before Linux 5.6, and under filters that do not know the call. The steps are the stricter way. */
    if (descriptor >= 0 || (errno != ENOSYS && errno != EPERM))
      return descriptor;
  }
  return walk(folder, name, flags);
}

static bool is_regular(int descriptor) {
  struct stat info;
  if (fstat(descriptor, &info) != 0)
    return false;
  errno = ENOTSUP;
  return S_ISREG(info.st_mode);
}

static int refuse(int descriptor) {
  int reason = errno;
  close(descriptor);
  errno = reason;
  return -1;
}

int vxm_regular_open(int folder, const char *name, vxm_beneath how) {
  if (*name == '\0') {
    errno = ENOENT;
    return -1;
  }
  /* To open a device may set it in motion: look before. */
  int descriptor = look_up(folder, name, O_PATH, how);
  if (descriptor < 0)
    return -1;
  if (!is_regular(descriptor))
    return refuse(descriptor);
  close(descriptor);
  descriptor = look_up(folder, name, O_RDONLY | O_NONBLOCK | O_NOCTTY, how);
  if (descriptor < 0)
    return -1;
  if (!is_regular(descriptor))
    return refuse(descriptor);
  return descriptor;
}
