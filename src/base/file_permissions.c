/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/file_permissions.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/xattr.h>
#include <unistd.h>

/* An access control list (ACL) as the kernel hands it out (linux/posix_acl_xattr.h): a version, then a tag,
 * the permissions and an id for each entry, little-endian. */
enum {
  ACL_VERSION = 2,
  ACL_HEADER = 4,
  ACL_ENTRY = 8,
  ACL_USER = 0x01,
  ACL_GROUP = 0x04,
  ACL_MASK = 0x10,
  ACL_OTHER = 0x20
};

static unsigned get16(const unsigned char *bytes) {
  return bytes[0] | (unsigned)bytes[1] << 8;
}

/** What a folder's default ACL leaves of rw-rw-rw-; false if it has none. */
static bool from_default_acl(mode_t *out, int folder) {
  unsigned char list[4096];
  char path[32];
  snprintf(path, sizeof path, "/proc/self/fd/%d", folder);
  ssize_t size = getxattr(path, "system.posix_acl_default", list, sizeof list);
  if (size < 0 && errno == ERANGE) {
    *out = 0600;
    return true;
  }
  if (size < ACL_HEADER || get16(list) != ACL_VERSION)
    return false;
  unsigned user = 0, group = 0, mask = 7, other = 0;
  for (ssize_t at = ACL_HEADER; at + ACL_ENTRY <= size; at += ACL_ENTRY) {
    unsigned tag = get16(list + at), bits = get16(list + at + 2);
    user = tag == ACL_USER ? bits : user;
    group = tag == ACL_GROUP ? bits : group;
    mask = tag == ACL_MASK ? bits | 8 : mask;
    other = tag == ACL_OTHER ? bits : other;
  }
  group = mask & 8 ? mask & 7 : group; /* the group's bits of the mode are the mask, where there is one */
  *out = (mode_t)(user << 6 | group << 3 | other) & 0666;
  return true;
}

/** The umask without changing it, which other threads would notice; where /proc is missing for an instant. */
static mode_t read_umask(void) {
  char text[1024];
  int descriptor = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  ssize_t size = descriptor >= 0 ? read(descriptor, text, sizeof text - 1) : -1;
  if (descriptor >= 0)
    close(descriptor);
  text[size > 0 ? size : 0] = '\0';
  const char *found = strstr(text, "\nUmask:");
  if (found)
    return (mode_t)strtoul(found + strlen("\nUmask:"), NULL, 8) & 0777;
  mode_t mask = umask(077);
  umask(mask);
  return mask;
}

/** Without the old group its permissions must not go to another one. */
static mode_t keep_group(mode_t mode, const struct stat *old, const struct stat *file, int descriptor) {
  if (old->st_gid == file->st_gid || fchown(descriptor, (uid_t)-1, old->st_gid) == 0)
    return mode;
  return (mode & ~(mode_t)S_IRWXG) | (mode & (mode & S_IRWXO) << 3);
}

/** The ACL of the old file, whose mask stands in the group's bits; false if it cannot be kept. */
static bool keep_acl(int folder, const char *name, int descriptor) {
  static const char acl_name[] = "system.posix_acl_access";
  unsigned char list[4096];
  char path[NAME_MAX + 40];
  snprintf(path, sizeof path, "/proc/self/fd/%d/%s", folder, name);
  ssize_t size = lgetxattr(path, acl_name, list, sizeof list);
  if (size < 0)
    return errno != ERANGE;
  return fsetxattr(descriptor, acl_name, list, (size_t)size, 0) == 0;
}

mode_t vxm_file_permissions(int folder, const char *name, int descriptor) {
  struct stat old, file;
  mode_t mode;
  if (fstatat(folder, name, &old, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(old.st_mode) &&
      fstat(descriptor, &file) == 0 && old.st_uid == file.st_uid) {
    mode = keep_group(old.st_mode & 0777, &old, &file, descriptor);
    return keep_acl(folder, name, descriptor) ? mode : mode & ~(mode_t)S_IRWXG;
  }
  return from_default_acl(&mode, folder) ? mode : 0666 & ~read_umask();
}
