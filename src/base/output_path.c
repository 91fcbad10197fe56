/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/output_path.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/vfs.h>
#include <unistd.h>

enum { LINKS_MAX = 40 /**< as the kernel follows */, PROC_MAGIC = 0x9fa0 };

/** A path on the way; its folder's descriptor is the destination's. */
typedef struct walk {
  vxm_output_path *destination;
  char rest[PATH_MAX]; /**< what is still to be followed, without leading slashes */
  int links;
} walk;

static bool fail(int reason) {
  errno = reason;
  return false;
}

static bool set_folder(vxm_output_path *destination, int folder) {
  if (folder < 0)
    return false;
  if (destination->folder >= 0)
    close(destination->folder);
  destination->folder = folder;
  return true;
}

/** Takes what is to be followed next; where it starts, if it is an absolute path. */
static bool set_rest(walk *w, const char *path) {
  size_t length = strlen(path);
  if (length == 0)
    return fail(ENOENT);
  if (length >= sizeof w->rest)
    return fail(ENAMETOOLONG);
  if (*path == '/' && !set_folder(w->destination, open("/", O_PATH | O_DIRECTORY | O_CLOEXEC)))
    return false;
  path += strspn(path, "/");
  memmove(w->rest, path, strlen(path) + 1);
  return true;
}

/** Whether somebody else may have laid a link where everybody can. */
static bool is_strangers(int folder, const struct stat *link) {
  const mode_t open_to_all = S_ISVTX | S_IWOTH;
  struct stat info;
  if (fstat(folder, &info) != 0)
    return true;
  return (info.st_mode & open_to_all) == open_to_all && link->st_uid != geteuid() &&
         link->st_uid != info.st_uid;
}

/** /proc/self/fd/1 and its like name what is open, which may have no path: a pipe, a terminal. */
static bool is_open_device(int folder, const char *name, int link) {
  struct statfs system;
  struct stat target;
  return fstatfs(link, &system) == 0 && system.f_type == PROC_MAGIC &&
         fstatat(folder, name, &target, 0) == 0 && !S_ISREG(target.st_mode) && !S_ISDIR(target.st_mode);
}

static bool open_device(vxm_output_path *destination, int flags) {
  destination->device =
      openat(destination->folder, destination->name, O_WRONLY | O_CLOEXEC | O_NOCTTY | flags);
  return destination->device >= 0;
}

/** Puts a link's target in front of the rest. */
static bool follow(walk *w, int link, const char *after) {
  char path[PATH_MAX];
  ssize_t length = readlinkat(link, "", path, sizeof path);
  if (length < 0)
    return false;
  if (++w->links > LINKS_MAX)
    return fail(ELOOP);
  size_t used = (size_t)length, behind = strlen(after);
  if (used + behind + 2 > sizeof path)
    return fail(ENAMETOOLONG);
  if (*after)
    path[used++] = '/';
  memcpy(path + used, after, behind + 1);
  return set_rest(w, path);
}

typedef enum step { STEP_ON, STEP_THERE, STEP_FAILED } step;

/** The last part of the path, or a link on the way; `item` is what the destination's name stands for. */
static step take_item(walk *w, int item, const char *after) {
  vxm_output_path *destination = w->destination;
  struct stat info;
  bool is_last = !*after;
  if (fstat(item, &info) != 0)
    return STEP_FAILED;
  if (S_ISLNK(info.st_mode)) {
    destination->is_strangers = is_strangers(destination->folder, &info);
    if (destination->is_strangers)
      return fail(EACCES) ? STEP_THERE : STEP_FAILED;
    if (is_last && is_open_device(destination->folder, destination->name, item))
      return open_device(destination, 0) ? STEP_THERE : STEP_FAILED;
    return follow(w, item, after) ? STEP_ON : STEP_FAILED;
  }
  if (!is_last)
    return fail(ENOTDIR) ? STEP_THERE : STEP_FAILED;
  if (S_ISREG(info.st_mode))
    return STEP_THERE;
  return open_device(destination, O_NOFOLLOW) ? STEP_THERE : STEP_FAILED;
}

static step take_part(walk *w) {
  vxm_output_path *destination = w->destination;
  size_t length = strcspn(w->rest, "/");
  if (length == 0 || length > NAME_MAX)
    return fail(length == 0 ? EISDIR : ENAMETOOLONG) ? STEP_THERE : STEP_FAILED;
  memcpy(destination->name, w->rest, length);
  destination->name[length] = '\0';
  char after[PATH_MAX];
  snprintf(after, sizeof after, "%s", w->rest + length);
  const char *next = after + strspn(after, "/");
  bool is_last = !*after; /* "a/" is a folder, and so its end is refused when nothing is left */
  int folder = openat(destination->folder, destination->name, O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder >= 0) {
    if (is_last) {
      close(folder);
      return fail(EISDIR) ? STEP_THERE : STEP_FAILED;
    }
    memmove(w->rest, next, strlen(next) + 1);
    return set_folder(destination, folder) ? STEP_ON : STEP_FAILED;
  }
  if (errno == ENOENT && is_last)
    return STEP_THERE;
  if (errno != ENOTDIR && errno != ELOOP)
    return STEP_FAILED;
  int item = openat(destination->folder, destination->name, O_PATH | O_NOFOLLOW | O_CLOEXEC);
  if (item < 0)
    return STEP_FAILED;
  step result = take_item(w, item, is_last ? "" : *next ? next : ".");
  int reason = errno;
  close(item);
  errno = reason;
  return result;
}

bool vxm_output_path_find(vxm_output_path *out, const char *path) {
  *out = (vxm_output_path){.folder = -1, .device = -1};
  walk w = {.destination = out};
  bool good = set_rest(&w, path) &&
              (out->folder >= 0 || set_folder(out, open(".", O_PATH | O_DIRECTORY | O_CLOEXEC)));
  step result = good ? STEP_ON : STEP_FAILED;
  while (result == STEP_ON)
    result = take_part(&w);
  if (result == STEP_THERE)
    return true;
  int reason = errno;
  vxm_output_path_close(out);
  return fail(reason);
}

void vxm_temporary_name(char out[VXM_TEMPORARY_NAME], const char *name, int attempt) {
  uint32_t hash = 2166136261U; /* FNV-1a */
  for (const char *c = name; *c; c++)
    hash = (hash ^ (unsigned char)*c) * 16777619U;
  snprintf(out, VXM_TEMPORARY_NAME, "voxmend-%08x-%d.tmp", (unsigned)hash, attempt);
}

void vxm_output_path_close(vxm_output_path *destination) {
  if (destination->folder >= 0)
    close(destination->folder);
  if (destination->device >= 0)
    close(destination->device);
  destination->folder = destination->device = -1;
}
