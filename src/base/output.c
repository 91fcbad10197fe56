/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/output.h"
#include "base/file_transaction.h"
#include "base/folders.h"
#include "base/size_text.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

enum { BUFFER = 1 << 16, ROOM_MAX = 4096, TMPFS_MAGIC = 0x01021994 };

/** From here on room is taken before it is written to. */
static const uint64_t LARGE_FILE = UINT64_C(1) << 20;

struct vxm_output {
  vxm_context *context;
  vxm_atomic_file file; /**< if `is_file` */
  bool is_file, is_stdout;
  int descriptor; /**< what is written to */
  int failure;    /**< errno of the first failed write */
  int target; /**< where the content goes when it is committed, if it waits in a file without a name; else -1
               */
  size_t used;
  char *path; /**< as given, for messages */
  char buffer[BUFFER + ROOM_MAX];
};

static const char *shown(const vxm_output *output) {
  return output->is_stdout ? "<stdout>" : output->path;
}

/* ---- Opening ---- */

static void output_free(vxm_output *output) {
  vxm_context *context = output->context;
  free(output->path);
  vxm_free(context, output);
}

/** A device or pipe (/dev/null) cannot be replaced by a rename, and is written straight to. */
static vxm_status open_path(vxm_output *output, const char *path, vxm_error *error) {
  vxm_output_path destination;
  output->path = strdup(path);
  if (!output->path)
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory");
  if (!vxm_output_path_find(&destination, path))
    return vxm_fail_errno(
        error, path,
        destination.is_strangers
            ? "cannot write through another user's link in a folder that everybody may write to"
            : "cannot write");
  if (destination.device >= 0) {
    output->descriptor = destination.device;
    destination.device = -1;
    vxm_output_path_close(&destination);
    return VXM_OK;
  }
  if (!vxm_atomic_file_open(&output->file, &destination)) {
    vxm_fail_errno(error, path, "cannot write");
    vxm_output_path_close(&destination);
    return VXM_ERROR_IO;
  }
  output->is_file = true;
  output->descriptor = output->file.descriptor;
  return VXM_OK;
}

vxm_status vxm_output_open(vxm_output **out, vxm_context *context, const char *path, vxm_error *error) {
  *out = NULL;
  vxm_status status = VXM_OK;
  vxm_output *output = vxm_try_alloc(context, 1, sizeof *output, &status, error);
  if (!output)
    return status;
  output->context = context;
  output->failure = 0;
  output->used = 0;
  output->target = -1;
  output->path = NULL;
  output->is_file = false;
  output->is_stdout = strcmp(path, "-") == 0;
  output->descriptor = STDOUT_FILENO;
  status = output->is_stdout ? VXM_OK : open_path(output, path, error);
  if (status != VXM_OK) {
    output_free(output);
    return status;
  }
  *out = output;
  return VXM_OK;
}

/** Opens a new file in the folder for temporary ones, without leaving it a name; -1 with errno set. */
static int open_nameless(void) {
  char path[PATH_MAX];
  const char *folder = vxm_folder_temporary();
  if (folder == NULL)
    return -1;
  int length = snprintf(path, sizeof path, "%s/voxmend-XXXXXX", folder);
  if (length < 0 || (size_t)length >= sizeof path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  path[length - (int)strlen("/voxmend-XXXXXX")] = '\0';
  int nameless = open(path, O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600);
  if (nameless >= 0)
    return nameless;
  path[strlen(path)] = '/';
  int descriptor = mkostemp(path, O_CLOEXEC);
  if (descriptor >= 0)
    unlink(path);
  return descriptor;
}

vxm_status vxm_output_open_readable(vxm_output **out, vxm_context *context, const char *path,
                                    vxm_error *error) {
  vxm_status status = vxm_output_open(out, context, path, error);
  if (status != VXM_OK || (*out)->is_file)
    return status;
  int waiting = open_nameless();
  if (waiting >= 0 && waiting <= STDERR_FILENO) { /* where standard output is closed its number is free */
    int higher = fcntl(waiting, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    close(waiting);
    waiting = higher;
  }
  if (waiting < 0) {
    vxm_fail_errno(error, path, "cannot write a temporary file for it; set TMPDIR");
    vxm_output_abort(*out);
    *out = NULL;
    return VXM_ERROR_IO;
  }
  (*out)->target = (*out)->descriptor;
  (*out)->descriptor = waiting;
  return VXM_OK;
}

/* ---- Room ---- */

/** @param reason errno that writing would end with */
static vxm_status fail_room(const vxm_output *output, uint64_t bytes, uint64_t room, int reason,
                            const char *where, vxm_error *error) {
  vxm_status status = vxm_fail_at(error, VXM_ERROR_IO, (vxm_place){shown(output), 0, -1, -1},
                                  "cannot write: at least %s are needed, and %s %s",
                                  vxm_size_text_of(bytes).text, vxm_size_text_of(room).text, where);
  if (error)
    error->system = reason;
  return status;
}

/** Takes the room, which also asks whether the user may have so much; where that is not free of cost, as in
 * memory, or unknown, it is left. */
static bool take_room(int descriptor, uint64_t bytes) {
  struct statfs system;
  if (bytes < LARGE_FILE || fstatfs(descriptor, &system) != 0 || system.f_type == TMPFS_MAGIC)
    return true;
  return fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) == 0 ||
         (errno != ENOSPC && errno != EDQUOT && errno != EFBIG);
}

vxm_status vxm_output_expect(vxm_output *output, uint64_t bytes, vxm_error *error) {
  const char *where =
      output->target >= 0 ? "are free for temporary files; set TMPDIR" : "are free on its disk";
  struct stat info;
  struct statvfs disk;
  struct rlimit limit;
  if (fstat(output->descriptor, &info) != 0 || !S_ISREG(info.st_mode))
    return VXM_OK;
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && bytes > limit.rlim_cur)
    return fail_room(output, bytes, limit.rlim_cur, EFBIG, "are what a file may have (ulimit -f)", error);
  /* Some file systems do not know. */
  if (fstatvfs(output->descriptor, &disk) != 0 || disk.f_blocks == 0)
    return VXM_OK;
  uint64_t block = disk.f_frsize ? disk.f_frsize : disk.f_bsize;
  uint64_t blocks = geteuid() == 0 ? disk.f_bfree : disk.f_bavail;
  uint64_t room = blocks > UINT64_MAX / block ? UINT64_MAX : blocks * block;
  if (bytes > room)
    return fail_room(output, bytes, room, ENOSPC, where, error);
  if (bytes > INT64_MAX || take_room(output->descriptor, bytes))
    return VXM_OK;
  return vxm_fail_errno(error, shown(output), "cannot write: there is no room for it");
}

/* ---- Writing ---- */

static void write_all(vxm_output *output, const char *data, size_t size) {
  while (size > 0 && !output->failure) {
    size_t piece = size < (1u << 30) ? size : (1u << 30);
    ssize_t done = write(output->descriptor, data, piece);
    if (done < 0 && errno == EINTR)
      continue;
    if (done < 0) {
      output->failure = errno;
      return;
    }
    data += done;
    size -= (size_t)done;
  }
}

static void flush(vxm_output *output) {
  write_all(output, output->buffer, output->used);
  output->used = 0;
}

vxm_status vxm_output_read_back(vxm_input *out, vxm_output *output, vxm_error *error) {
  flush(output);
  if (output->failure) {
    errno = output->failure;
    return vxm_fail_errno(error, shown(output), "cannot write");
  }
  return vxm_input_take(out, output->context, shown(output), output->descriptor, error);
}

/** Sends what has waited in a file without a name on to where it was meant to go. */
static void send_on(vxm_output *output) {
  int waiting = output->descriptor;
  off_t at = 0;
  output->descriptor = output->target;
  output->target = -1;
  while (!output->failure) {
    ssize_t got = pread(waiting, output->buffer, BUFFER, at);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      output->failure = errno;
    if (got <= 0)
      break;
    write_all(output, output->buffer, (size_t)got);
    at += got;
  }
  close(waiting);
}

void vxm_output_write(vxm_output *output, const void *data, size_t size) {
  if (size > BUFFER - output->used) {
    flush(output);
    if (size >= BUFFER) {
      write_all(output, data, size);
      return;
    }
  }
  memcpy(output->buffer + output->used, data, size);
  output->used += size;
}

char *vxm_output_reserve(vxm_output *output, size_t room) {
  if (room > BUFFER + ROOM_MAX - output->used)
    flush(output);
  return output->buffer + output->used;
}

void vxm_output_advance(vxm_output *output, size_t used) {
  output->used += used;
  if (output->used >= BUFFER)
    flush(output);
}

void vxm_output_printf(vxm_output *output, const char *format, ...) {
  char *room = vxm_output_reserve(output, ROOM_MAX);
  va_list arguments;
  va_start(arguments, format);
  int written = vsnprintf(room, ROOM_MAX, format, arguments);
  va_end(arguments);
  if (written > 0)
    vxm_output_advance(output, (size_t)written < ROOM_MAX ? (size_t)written : ROOM_MAX - 1);
}

bool vxm_output_can_patch(const vxm_output *output) {
  return output->is_file;
}

void vxm_output_patch(vxm_output *output, uint64_t offset, const void *data, size_t size) {
  flush(output);
  const char *from = data;
  while (size > 0 && !output->failure) {
    ssize_t done = pwrite(output->descriptor, from, size, (off_t)offset);
    if (done < 0 && errno == EINTR)
      continue;
    if (done < 0) {
      output->failure = errno;
      return;
    }
    from += done;
    offset += (uint64_t)done;
    size -= (size_t)done;
  }
}

bool vxm_output_failed(const vxm_output *output) {
  return output->failure != 0;
}

/* ---- Ending ---- */

static void close_all(vxm_output *output) {
  if (output->target >= 0) {
    close(output->descriptor);
    output->descriptor = output->target;
  }
  if (output->is_file)
    vxm_atomic_file_close(&output->file);
  else if (!output->is_stdout && output->descriptor >= 0)
    close(output->descriptor);
}

void vxm_output_abort(vxm_output *output) {
  if (!output)
    return;
  close_all(output);
  output_free(output);
}

/** Completes what is written: a file has all but its name. */
static void complete(vxm_output *output) {
  flush(output);
  if (output->target >= 0)
    send_on(output);
  if (output->failure || output->is_stdout)
    return;
  if (output->is_file) {
    if (!vxm_atomic_file_prepare(&output->file))
      output->failure = errno;
    return;
  }
  if (close(output->descriptor) != 0)
    output->failure = errno;
  output->descriptor = -1;
}

/** Completes and frees an output; *held is the file, which is still to be named, or NULL if it is none. */
static vxm_status end_output(vxm_file_transaction_file **held, vxm_output *output, vxm_error *error) {
  *held = NULL;
  complete(output);
  if (!output->failure && output->is_file) {
    *held = vxm_file_transaction_file_create(&output->file, output->path);
    output->failure = *held ? 0 : ENOMEM;
  }
  if (output->failure) {
    errno = output->failure;
    vxm_fail_errno(error, shown(output), "cannot write");
    vxm_output_abort(output);
    return VXM_ERROR_IO;
  }
  output_free(output);
  return VXM_OK;
}

vxm_status vxm_output_commit_both(vxm_output *first, vxm_output *second, vxm_error *error) {
  vxm_file_transaction_file *held, *other = NULL;
  vxm_context *context = first->context;
  vxm_status status = end_output(&held, first, error);
  if (status != VXM_OK) {
    vxm_output_abort(second);
    return status;
  }
  if (second)
    status = end_output(&other, second, error);
  if (status != VXM_OK) {
    vxm_file_transaction_drop(held);
    return status;
  }
  if (held)
    held->next = other;
  else
    held = other;
  return held ? vxm_file_transaction_take(context, held, error) : VXM_OK;
}

vxm_status vxm_output_keep(vxm_output *output, vxm_file_transaction_file **list, vxm_error *error) {
  vxm_file_transaction_file *held;
  vxm_status status = end_output(&held, output, error);
  if (held) {
    held->next = *list;
    *list = held;
  }
  return status;
}

vxm_status vxm_output_commit(vxm_output *output, vxm_error *error) {
  return vxm_output_commit_both(output, NULL, error);
}

vxm_status vxm_output_commit_now(vxm_output *output, vxm_error *error) {
  vxm_file_transaction_file *held;
  vxm_status status = end_output(&held, output, error);
  return status == VXM_OK && held ? vxm_file_transaction_publish(held, error) : status;
}

vxm_status vxm_file_write(vxm_context *context, const char *path, const void *data, size_t size,
                          vxm_error *error) {
  if (!path || (!data && size > 0))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "file: an argument is NULL");
  vxm_context *owner;
  vxm_output *output;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_output_open(&output, owner, path, error);
  if (status == VXM_OK) {
    vxm_output_write(output, data, size);
    status = vxm_output_commit(output, error);
  }
  vxm_context_release(owner);
  return status;
}
