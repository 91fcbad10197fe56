/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/folders.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

const char *vxm_folder_variable(const char *name) {
  const char *value = secure_getenv(name);
  return value != NULL && value[0] == '/' ? value : NULL;
}

bool vxm_folder_is_safe(const char *path) {
  struct stat info;
  if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode))
    return false;
  bool is_ours = info.st_uid == geteuid() || info.st_uid == 0;
  return is_ours && ((info.st_mode & (S_IWGRP | S_IWOTH)) == 0 || (info.st_mode & S_ISVTX) != 0);
}

const char *vxm_folder_temporary(void) {
  const char *value = secure_getenv("TMPDIR");
  if (value == NULL || *value == '\0')
    return "/tmp";
  errno = EINVAL;
  if (value[0] != '/')
    return NULL;
  if (vxm_folder_is_safe(value))
    return value;
  errno = access(value, F_OK) == 0 ? EPERM : ENOENT;
  return NULL;
}
