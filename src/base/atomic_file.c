/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/atomic_file.h"
#include "base/file_permissions.h"
#include "base/system_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/* ---- Temporary names ---- */

enum { ATTEMPTS = 1000 };

static bool lock(int descriptor, int flags) {
  while (flock(descriptor, LOCK_EX | flags) != 0)
    if (errno != EINTR)
      return false;
  return true;
}

/** Whether a descriptor's file still has this name. */
static bool has_name(const vxm_atomic_file *file, int descriptor) {
  struct stat named, opened;
  return fstatat(file->destination.folder, file->temporary, &named, AT_SYMLINK_NOFOLLOW) == 0 &&
         fstat(descriptor, &opened) == 0 && named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

/** Removes what a killed program left under a temporary name: whoever still writes to it holds its lock. */
static bool remove_abandoned(const vxm_atomic_file *file) {
  struct stat info;
  const int flags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  int descriptor =
      openat(file->destination.folder, file->temporary, O_RDWR | flags); /* as locks of NFS need it */
  if (descriptor < 0)
    descriptor = openat(file->destination.folder, file->temporary, O_RDONLY | flags);
  if (descriptor < 0)
    return false;
  bool is_abandoned = fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) && info.st_uid == geteuid() &&
                      lock(descriptor, LOCK_NB) && has_name(file, descriptor) &&
                      unlinkat(file->destination.folder, file->temporary, 0) == 0;
  close(descriptor);
  return is_abandoned;
}

/** Tries names until `take` has one; it fails with EEXIST where the name is taken. */
static bool find_name(vxm_atomic_file *file, bool (*take)(vxm_atomic_file *file)) {
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    vxm_temporary_name(file->temporary, file->destination.name, attempt);
    if (take(file))
      return true;
    if (errno != EEXIST)
      break;
    if (remove_abandoned(file) && take(file))
      return true;
  }
  file->temporary[0] = '\0';
  return false;
}

/* ---- Opening ---- */

/** Whether a file without a name can get one later: that goes through /proc. */
static bool can_be_linked(int descriptor) {
  char path[32];
  struct stat info, seen;
  snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
  return fstat(descriptor, &info) == 0 && stat(path, &seen) == 0 && info.st_ino == seen.st_ino &&
         info.st_dev == seen.st_dev;
}

static bool open_nameless(vxm_atomic_file *file) {
  file->descriptor = openat(file->destination.folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file->descriptor >= 0 && !can_be_linked(file->descriptor)) {
    close(file->descriptor);
    file->descriptor = -1;
  }
  return file->descriptor >= 0;
}

static bool create_named(vxm_atomic_file *file) {
  const int flags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  file->descriptor = openat(file->destination.folder, file->temporary, flags, 0600);
  return file->descriptor >= 0;
}

/** Makes the file under a temporary name and locks it, which tells other processes that it is not abandoned.
 * One that came before the lock may have removed it: then another is made. */
static bool open_named(vxm_atomic_file *file) {
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    if (!find_name(file, create_named))
      return false;
    lock(file->descriptor, 0);
    if (has_name(file, file->descriptor))
      return true;
    close(file->descriptor);
  }
  errno = EEXIST;
  return false;
}

/** What the rename in the end would be refused for is refused before the work. */
static bool may_replace(const vxm_output_path *destination) {
  struct stat file, folder;
  uid_t user = geteuid();
  if (user == 0 || fstatat(destination->folder, destination->name, &file, AT_SYMLINK_NOFOLLOW) != 0 ||
      fstat(destination->folder, &folder) != 0 || !(folder.st_mode & S_ISVTX))
    return true;
  errno = EPERM;
  return file.st_uid == user || folder.st_uid == user;
}

bool vxm_atomic_file_open(vxm_atomic_file *out, const vxm_output_path *destination) {
  *out = (vxm_atomic_file){.destination = *destination, .descriptor = -1};
  if (!may_replace(destination))
    return false;
  if (open_nameless(out)) {
    lock(out->descriptor, LOCK_NB);
    return true;
  }
  return open_named(out);
}

/* ---- Completing ---- */

/** Where permissions must not be set they stay as narrow as they are: on FAT for one. */
static bool set_mode(int descriptor, mode_t mode) {
  return fchmod(descriptor, mode) == 0 || errno == EPERM || errno == EOPNOTSUPP || errno == ENOSYS;
}

bool vxm_atomic_file_prepare(vxm_atomic_file *file) {
  if (!set_mode(file->descriptor,
                vxm_file_permissions(file->destination.folder, file->destination.name, file->descriptor)))
    return false;
  /* Network file systems tell some failures only here; the lock needs the descriptor itself. */
  int copy = fcntl(file->descriptor, F_DUPFD_CLOEXEC, 0);
  return copy >= 0 && close(copy) == 0;
}

static bool link_as(const vxm_atomic_file *file, const char *name) {
  char path[32];
  snprintf(path, sizeof path, "/proc/self/fd/%d", file->descriptor);
  return linkat(AT_FDCWD, path, file->destination.folder, name, AT_SYMLINK_FOLLOW) == 0;
}

static bool link_temporary(vxm_atomic_file *file) {
  return link_as(file, file->temporary);
}

/** Exchanges the names, so that the old file stays for a while; false where nothing is there, or this cannot
 * be. */
static bool exchange(vxm_atomic_file *file) {
  int folder = file->destination.folder;
  file->has_replaced =
      renameat2(folder, file->temporary, folder, file->destination.name, RENAME_EXCHANGE) == 0;
  return file->has_replaced;
}

bool vxm_atomic_file_publish(vxm_atomic_file *file, bool keeps_old) {
  int folder = file->destination.folder;
  bool is_nameless = !file->temporary[0];
  if (is_nameless && link_as(file, file->destination.name))
    return file->is_published = true;
  /* A file that is there can only be replaced by one that has a name: it gets one for an instant. */
  if (is_nameless && (errno != EEXIST || !find_name(file, link_temporary)))
    return false;
  if (keeps_old && exchange(file))
    return file->is_published = true;
  if (renameat(folder, file->temporary, folder, file->destination.name) != 0)
    return false;
  file->temporary[0] = '\0';
  return file->is_published = true;
}

void vxm_atomic_file_revert(vxm_atomic_file *file) {
  int folder = file->destination.folder;
  if (!file->is_published)
    return;
  if (file->has_replaced && renameat(folder, file->temporary, folder, file->destination.name) == 0)
    file->temporary[0] = '\0';
  else if (!file->has_replaced)
    unlinkat(folder, file->destination.name, 0);
  file->is_published = false;
}

void vxm_atomic_file_close(vxm_atomic_file *file) {
  if (file->temporary[0])
    unlinkat(file->destination.folder, file->temporary, 0);
  if (file->descriptor >= 0)
    close(file->descriptor);
  vxm_output_path_close(&file->destination);
  file->descriptor = -1;
  file->temporary[0] = '\0';
}
