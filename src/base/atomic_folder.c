/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/atomic_folder.h"
#include "base/system_calls.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

enum { ATTEMPTS = 1000, DEPTH_MAX = 8 };

static const int folder_flags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

/* ---- What is in a folder ---- */

/** The next entry but "." and ".."; NULL behind the last. */
static const struct dirent *next_entry(DIR *folder) {
  const struct dirent *entry;
  do
    entry = readdir(folder);
  while (entry && (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0));
  return entry;
}

static DIR *open_entries(int parent, const char *name) {
  int descriptor = openat(parent, name, folder_flags);
  DIR *folder = descriptor >= 0 ? fdopendir(descriptor) : NULL;
  if (!folder && descriptor >= 0)
    close(descriptor);
  return folder;
}

static bool is_folder(int parent, const char *name) {
  struct stat info;
  return fstatat(parent, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISDIR(info.st_mode);
}

/** Whether a name is still that of an opened folder. */
static bool is_named(int descriptor, int parent, const char *name) {
  struct stat opened, named;
  return descriptor >= 0 && fstat(descriptor, &opened) == 0 &&
         fstatat(parent, name, &named, AT_SYMLINK_NOFOLLOW) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

/** Looks for what is no part; its name is left in `other`. */
static bool has_other(int parent, const char *name, vxm_folder_part_fn is_part, int depth,
                      char other[NAME_MAX + 1]) {
  DIR *folder = depth < DEPTH_MAX ? open_entries(parent, name) : NULL;
  const struct dirent *entry;
  bool found = !folder;
  snprintf(other, NAME_MAX + 1, "%s", name);
  while (!found && (entry = next_entry(folder)) != NULL) {
    bool inner = is_folder(dirfd(folder), entry->d_name);
    snprintf(other, NAME_MAX + 1, "%s", entry->d_name);
    found = !is_part(entry->d_name, inner, depth) ||
            (inner && has_other(dirfd(folder), entry->d_name, is_part, depth + 1, other));
  }
  if (folder)
    closedir(folder);
  return found;
}

static bool is_empty(int parent, const char *name) {
  DIR *folder = open_entries(parent, name);
  bool empty = folder && !next_entry(folder);
  if (folder)
    closedir(folder);
  return empty;
}

/** Removes the parts in a folder; what is none stays. */
static void remove_parts(int descriptor, vxm_folder_part_fn is_part, int depth) {
  DIR *folder = depth < DEPTH_MAX ? open_entries(descriptor, ".") : NULL;
  const struct dirent *entry;
  while (folder && (entry = next_entry(folder)) != NULL) {
    bool inner = is_folder(descriptor, entry->d_name);
    if (!is_part(entry->d_name, inner, depth))
      continue;
    int below = inner ? openat(descriptor, entry->d_name, folder_flags) : -1;
    if (below >= 0) {
      remove_parts(below, is_part, depth + 1);
      close(below);
    }
    unlinkat(descriptor, entry->d_name, inner ? AT_REMOVEDIR : 0);
  }
  if (folder)
    closedir(folder);
}

/** Removes an opened folder and the parts in it, if the name is still its own: meanwhile another program may
 * have taken the name. The mark goes first: who reads the folder sees by it that files begin to lack. */
static void remove_folder(const vxm_atomic_folder *folder, const char *name, int descriptor) {
  if (!is_named(descriptor, folder->destination.folder, name))
    return;
  unlinkat(descriptor, folder->mark, 0);
  remove_parts(descriptor, folder->is_part, 0);
  if (is_named(descriptor, folder->destination.folder, name))
    unlinkat(folder->destination.folder, name, AT_REMOVEDIR);
}

/* ---- Opening ---- */

/** Splits a path into what leads to the folder, with its slash, and its name. */
static bool split(char lead[PATH_MAX], char name[NAME_MAX + 1], const char *path) {
  size_t end = strlen(path);
  while (end > 0 && path[end - 1] == '/')
    end--;
  size_t begin = end;
  while (begin > 0 && path[begin - 1] != '/')
    begin--;
  bool is_name = end > begin && !(end - begin <= 2 && strncmp(path + begin, "..", end - begin) == 0);
  errno = is_name ? ENAMETOOLONG : EISDIR;
  if (!is_name || end - begin > NAME_MAX || begin >= PATH_MAX)
    return false;
  memcpy(lead, path, begin);
  lead[begin] = '\0';
  memcpy(name, path + begin, end - begin);
  name[end - begin] = '\0';
  return true;
}

/** Where it is to be: links on the way are followed as those to files are, by a name that is not there yet.
 */
static bool find_spot(vxm_atomic_folder *folder, const char *path) {
  char lead[PATH_MAX], name[NAME_MAX + 1], probe[PATH_MAX];
  if (!split(lead, name, path))
    return false;
  vxm_temporary_name(folder->temporary, name, ATTEMPTS);
  int length = snprintf(probe, sizeof probe, "%s%s", lead, folder->temporary);
  folder->temporary[0] = '\0';
  errno = ENAMETOOLONG;
  if (length >= (int)sizeof probe || !vxm_output_path_find(&folder->destination, probe))
    return false;
  memcpy(folder->destination.name, name, sizeof name);
  return true;
}

static bool lock(int descriptor) {
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    if (errno != EINTR)
      return false;
  return true;
}

/** Removes what a killed program left under such a name: whoever still needs it holds its lock. */
static void remove_abandoned(const vxm_atomic_folder *folder, const char *name) {
  struct stat info;
  int descriptor = openat(folder->destination.folder, name, folder_flags);
  if (descriptor >= 0 && fstat(descriptor, &info) == 0 && info.st_uid == geteuid() && lock(descriptor))
    remove_folder(folder, name, descriptor);
  if (descriptor >= 0)
    close(descriptor);
}

static void name_moved(char out[VXM_TEMPORARY_NAME], const vxm_atomic_folder *folder) {
  memcpy(out, folder->temporary, VXM_TEMPORARY_NAME);
  memcpy(strrchr(out, '.'), ".old", sizeof ".old"); /* for ".tmp" */
}

/** Opens and locks the folder that was just made. False if another program took it for an abandoned one, with
 * errno 0, or with the reason. */
static bool take(vxm_atomic_folder *folder) {
  const int parent = folder->destination.folder;
  int descriptor = openat(parent, folder->temporary, folder_flags);
  if (descriptor < 0) {
    int reason = errno == ENOENT ? 0 : errno;
    unlinkat(parent, folder->temporary, AT_REMOVEDIR);
    errno = reason;
    return false;
  }
  /* Where folders cannot be locked at all nobody removes them either. */
  if ((lock(descriptor) || errno != EWOULDBLOCK) && is_named(descriptor, parent, folder->temporary)) {
    folder->descriptor = descriptor;
    return true;
  }
  close(descriptor);
  errno = 0;
  return false;
}

static bool make(vxm_atomic_folder *folder) {
  const int parent = folder->destination.folder;
  struct stat old;
  const bool has_old = fstatat(parent, folder->destination.name, &old, AT_SYMLINK_NOFOLLOW) == 0;
  /* What others may not read is not shown to them until it is complete either. */
  const mode_t mode = has_old && old.st_uid == geteuid() ? (old.st_mode & 0777) | S_IRWXU : 0777;
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    char moved[VXM_TEMPORARY_NAME];
    vxm_temporary_name(folder->temporary, folder->destination.name, attempt);
    remove_abandoned(folder, folder->temporary);
    name_moved(moved, folder);
    if (has_old) /* else it may be all that is left of it */
      remove_abandoned(folder, moved);
    if (faccessat(parent, moved, F_OK, AT_SYMLINK_NOFOLLOW) == 0)
      continue;
    bool is_made = mkdirat(parent, folder->temporary, mode) == 0;
    if (is_made && take(folder))
      return true;
    if (errno != (is_made ? 0 : EEXIST))
      break;
  }
  errno = errno == 0 ? EEXIST : errno;
  folder->temporary[0] = '\0';
  return false;
}

/** Refuses to replace anything but what such a folder is. */
static vxm_status check_old(const vxm_atomic_folder *folder, const char *path, vxm_error *error) {
  const vxm_place place = {path, 0, -1, -1};
  const int parent = folder->destination.folder;
  const char *name = folder->destination.name, *what = folder->what;
  char other[NAME_MAX + 1], inner[PATH_MAX];
  struct stat info;
  if (fstatat(parent, name, &info, AT_SYMLINK_NOFOLLOW) != 0)
    return VXM_OK;
  if (!S_ISDIR(info.st_mode))
    return vxm_fail_at(error, VXM_ERROR_ARGUMENT, place,
                       "%s becomes a folder, and a %s of this name is there; give another name", what,
                       S_ISLNK(info.st_mode) ? "link" : "file");
  if (is_empty(parent, name))
    return VXM_OK;
  snprintf(inner, sizeof inner, "%s/%s", name, folder->mark);
  if (fstatat(parent, inner, &info, AT_SYMLINK_NOFOLLOW) != 0)
    return vxm_fail_at(error, VXM_ERROR_ARGUMENT, place,
                       "this folder is not %s, and is not replaced; give another name", what);
  if (has_other(parent, name, folder->is_part, 0, other))
    return vxm_fail_at(
        error, VXM_ERROR_ARGUMENT, place,
        "this folder has \"%s\", which is no part of %s, and is not replaced; give another name", other,
        what);
  return VXM_OK;
}

vxm_status vxm_atomic_folder_open(vxm_atomic_folder *out, const char *path, const char *mark,
                                  vxm_folder_part_fn is_part, const char *what, vxm_error *error) {
  *out = (vxm_atomic_folder){.destination = {.folder = -1, .device = -1},
                             .descriptor = -1,
                             .old = -1,
                             .mark = mark,
                             .what = what,
                             .is_part = is_part};
  if (!find_spot(out, path))
    return vxm_fail_errno(
        error, path,
        out->destination.is_strangers
            ? "cannot write through another user's link in a folder that everybody may write to"
            : "cannot write");
  vxm_status status = check_old(out, path, error);
  if (status == VXM_OK && !make(out))
    status = vxm_fail_errno(error, path, "cannot write");
  if (status != VXM_OK)
    vxm_atomic_folder_close(out);
  return status;
}

/* ---- Files ---- */

static bool write_all(int descriptor, const char *data, size_t size) {
  while (size > 0) {
    ssize_t done = write(descriptor, data, size < (1u << 30) ? size : (1u << 30));
    if (done < 0 && errno == EINTR)
      continue;
    if (done < 0)
      return false;
    data += done;
    size -= (size_t)done;
  }
  return true;
}

bool vxm_atomic_folder_put(const vxm_atomic_folder *folder, const char *name, const void *data, size_t size) {
  int descriptor =
      openat(folder->descriptor, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0)
    return false;
  bool good = write_all(descriptor, data, size);
  int reason = errno;
  bool is_closed = close(descriptor) == 0; /* network file systems tell some failures only here */
  if (!good)
    errno = reason;
  return good && is_closed;
}

/* ---- Completing ---- */

/** Moves the old one away where names cannot be exchanged. */
static bool move_old(vxm_atomic_folder *folder) {
  const int parent = folder->destination.folder;
  char old[VXM_TEMPORARY_NAME];
  name_moved(old, folder);
  if (renameat(parent, folder->destination.name, parent, old) != 0)
    return false;
  if (renameat(parent, folder->temporary, parent, folder->destination.name) == 0) {
    memcpy(folder->temporary, old, sizeof old);
    return true;
  }
  int reason = errno;
  renameat(parent, old, parent, folder->destination.name);
  errno = reason;
  return false;
}

/** Puts it in the place of the old one, which stays open and locked: under a temporary name nobody is to take
 * it for an abandoned one. */
static bool replace(vxm_atomic_folder *folder) {
  const int parent = folder->destination.folder;
  struct stat info;
  (void)!lock(folder->old); /* another program that has just published it may hold it still */
  if (fstat(folder->old, &info) == 0 && info.st_uid == geteuid())
    (void)!fchmod(folder->descriptor, info.st_mode & 0777);
  return renameat2(parent, folder->temporary, parent, folder->destination.name, RENAME_EXCHANGE) == 0 ||
         move_old(folder);
}

vxm_status vxm_atomic_folder_publish(vxm_atomic_folder *folder, const char *path, vxm_error *error) {
  const int parent = folder->destination.folder;
  vxm_status status = check_old(folder, path, error); /* since it was opened much may have come there */
  if (status != VXM_OK)
    return status;
  folder->old = openat(parent, folder->destination.name, folder_flags);
  if (folder->old >= 0)
    folder->is_published = folder->has_replaced = replace(folder);
  else if (errno == ENOENT)
    folder->is_published = renameat(parent, folder->temporary, parent, folder->destination.name) == 0;
  if (!folder->is_published)
    return vxm_fail_errno(error, path, "cannot write");
  if (!folder->has_replaced)
    folder->temporary[0] = '\0';
  return VXM_OK;
}

void vxm_atomic_folder_revert(vxm_atomic_folder *folder) {
  const int parent = folder->destination.folder;
  if (!folder->is_published || !is_named(folder->descriptor, parent, folder->destination.name))
    return; /* another program has replaced it already */
  folder->is_published = false;
  if (!folder->has_replaced) {
    remove_folder(folder, folder->destination.name, folder->descriptor);
    return;
  }
  if (renameat2(parent, folder->temporary, parent, folder->destination.name, RENAME_EXCHANGE) == 0)
    return; /* the new one has the temporary name, and goes with it */
  remove_folder(folder, folder->destination.name, folder->descriptor);
  if (renameat(parent, folder->temporary, parent, folder->destination.name) == 0)
    folder->temporary[0] = '\0';
}

void vxm_atomic_folder_close(vxm_atomic_folder *folder) {
  if (folder->temporary[0])
    remove_folder(folder, folder->temporary, folder->is_published ? folder->old : folder->descriptor);
  if (folder->descriptor >= 0)
    close(folder->descriptor);
  if (folder->old >= 0)
    close(folder->old);
  vxm_output_path_close(&folder->destination);
  folder->descriptor = folder->old = -1;
  folder->temporary[0] = '\0';
}
