/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- Input ---- */

static vxm_status read_stream(vxm_input *input, int descriptor, vxm_error *error) {
  void *block = NULL;
  size_t capacity = 0, size = 0;
  for (;;) {
    vxm_status status = vxm_grow(input->context, &block, &capacity, size + 65536, 1, error);
    if (status != VXM_OK) {
      vxm_free(input->context, block);
      return status;
    }
    ssize_t got = read(descriptor, (char *)block + size, capacity - size);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0) {
      vxm_fail_errno(error, input->name, "cannot read");
      vxm_free(input->context, block);
      return VXM_ERROR_IO;
    }
    if (got == 0)
      break;
    size += (size_t)got;
  }
  input->block = block;
  input->data = block;
  input->size = size;
  return VXM_OK;
}

/** Maps a file, or reads what cannot be mapped. */
static vxm_status take_in(vxm_input *out, int descriptor, vxm_error *error) {
  const char *path = out->name;
  struct stat info;
  vxm_status status = VXM_OK;
  if (fstat(descriptor, &info) != 0)
    status = vxm_fail_errno(error, path, "cannot open");
  else if (S_ISDIR(info.st_mode)) {
    errno = EISDIR;
    status = vxm_fail_errno(error, path, "cannot read");
  } else if (S_ISREG(info.st_mode) && info.st_size > 0) {
    out->size = (size_t)info.st_size;
    /* MAP_POPULATE maps the pages in one call rather than by one fault each. */
    void *mapping = mmap(NULL, out->size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
    if (mapping == MAP_FAILED)
      status = lseek(descriptor, 0, SEEK_SET) < 0 ? vxm_fail_errno(error, path, "cannot read")
                                                  : read_stream(out, descriptor, error);
    else {
      out->mapping = mapping;
      out->data = mapping;
      posix_madvise(mapping, out->size, POSIX_MADV_SEQUENTIAL);
    }
  } else
    status = read_stream(out, descriptor, error);
  return status;
}

vxm_status vxm_input_open(vxm_input *out, vxm_context *context, const char *path, vxm_error *error) {
  *out = (vxm_input){.name = path, .context = context};
  if (strcmp(path, "-") == 0) {
    out->name = "<stdin>";
    return read_stream(out, STDIN_FILENO, error);
  }
  int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    return vxm_fail_errno(error, path, "cannot open");
  vxm_status status = take_in(out, descriptor, error);
  close(descriptor);
  return status;
}

void vxm_input_close(vxm_input *input) {
  if (input->mapping)
    munmap(input->mapping, input->size);
  vxm_free(input->context, input->block);
  input->mapping = NULL;
  input->block = NULL;
}

/* ---- Output ---- */

enum { BUFFER = 1 << 16, ROOM_MAX = 4096 };

struct vxm_output {
  vxm_context *context;
  int descriptor;
  int failure; /**< errno of the first failed write */
  int target;  /**< where the content goes when it is committed, if it waits in a file without a name; else -1
                */
  bool is_stdout;
  size_t used;
  char *path;
  char *temporary;
  char buffer[BUFFER + ROOM_MAX];
};

static void output_free(vxm_output *output) {
  vxm_context *context = output->context;
  free(output->path);
  free(output->temporary);
  vxm_free(context, output);
}

/** Creates a file of a short new name in the output's folder, with the rights of the file that it is to
 * replace. */
static int open_temporary(vxm_output *output, size_t size, mode_t mode) {
  const char *slash = strrchr(output->path, '/');
  int folder = slash ? (int)(slash - output->path + 1) : 0;
  for (int attempt = 0; attempt < 1000; attempt++) {
    snprintf(output->temporary, size, "%.*svoxmend-%ld-%d.tmp", folder, output->path, (long)getpid(),
             attempt);
    int descriptor = open(output->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 && mode != 0 && fchmod(descriptor, mode) != 0) {
      close(descriptor);
      unlink(output->temporary);
      return -1;
    }
    if (descriptor >= 0 || errno != EEXIST)
      return descriptor;
  }
  return -1;
}

/** Opens what `path` names: a link to a file is followed, so that it stays a link and its file is replaced.
 */
static int open_output(vxm_output *output, const char *path) {
  struct stat info = {.st_mode = 0};
  bool exists = stat(path, &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) {
    errno = EISDIR;
    return -1;
  }
  output->path = exists ? realpath(path, NULL) : strdup(path);
  /* A device or pipe (/dev/null) cannot be replaced by a rename: write straight to it. */
  if (exists && !S_ISREG(info.st_mode))
    return open(path, O_WRONLY | O_CLOEXEC);
  if (!output->path)
    return -1;
  size_t size = strlen(output->path) + 48;
  output->temporary = calloc(1, size);
  if (!output->temporary)
    return -1;
  return open_temporary(output, size, info.st_mode & 07777);
}

vxm_status vxm_output_open(vxm_output **out, vxm_context *context, const char *path, vxm_error *error) {
  *out = NULL;
  vxm_error local = VXM_ERROR_INIT;
  vxm_output *output = vxm_alloc(context, 1, sizeof *output, &local);
  if (!output) {
    if (error)
      *error = local;
    return local.code;
  }
  output->context = context;
  output->failure = 0;
  output->used = 0;
  output->target = -1;
  output->path = NULL;
  output->temporary = NULL;
  output->is_stdout = strcmp(path, "-") == 0;
  output->descriptor = output->is_stdout ? STDOUT_FILENO : open_output(output, path);
  if (output->descriptor < 0) {
    vxm_fail_errno(error, path, "cannot write");
    output_free(output);
    return VXM_ERROR_IO;
  }
  *out = output;
  return VXM_OK;
}

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

/** Opens a new file in the folder for temporary ones, without leaving it a name; -1 with errno set. */
static int open_nameless(void) {
  char path[PATH_MAX];
  const char *folder = getenv("TMPDIR");
  int length = snprintf(path, sizeof path, "%s/voxmend-XXXXXX", folder && *folder ? folder : "/tmp");
  if (length < 0 || (size_t)length >= sizeof path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  int descriptor = mkostemp(path, O_CLOEXEC);
  if (descriptor >= 0)
    unlink(path);
  return descriptor;
}

vxm_status vxm_output_open_readable(vxm_output **out, vxm_context *context, const char *path,
                                    vxm_error *error) {
  vxm_status status = vxm_output_open(out, context, path, error);
  if (status != VXM_OK || (*out)->temporary)
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

vxm_status vxm_output_read_back(vxm_input *out, vxm_output *output, vxm_error *error) {
  *out = (vxm_input){.name = output->is_stdout ? "<stdout>" : output->path, .context = output->context};
  flush(output);
  if (output->failure) {
    errno = output->failure;
    return vxm_fail_errno(error, out->name, "cannot write");
  }
  return take_in(out, output->descriptor, error);
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
  return output->temporary != NULL;
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

void vxm_output_abort(vxm_output *output) {
  if (!output)
    return;
  if (output->target >= 0) {
    close(output->descriptor);
    output->descriptor = output->target;
  }
  if (!output->is_stdout) {
    close(output->descriptor);
    if (output->temporary)
      unlink(output->temporary);
  }
  output_free(output);
}

vxm_status vxm_output_commit(vxm_output *output, vxm_error *error) {
  flush(output);
  if (output->target >= 0)
    send_on(output);
  if (!output->failure && !output->is_stdout) {
    if (close(output->descriptor) != 0)
      output->failure = errno;
    output->descriptor = -1;
    if (!output->failure && output->temporary && rename(output->temporary, output->path) != 0)
      output->failure = errno;
  }
  if (output->failure) {
    errno = output->failure;
    vxm_fail_errno(error, output->is_stdout ? "<stdout>" : output->path, "cannot write");
    if (output->temporary)
      unlink(output->temporary);
    if (!output->is_stdout && output->descriptor >= 0)
      close(output->descriptor);
    output_free(output);
    return VXM_ERROR_IO;
  }
  output_free(output);
  return VXM_OK;
}

/* ---- Names ---- */

const char *vxm_path_extension(const char *path) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  const char *dot = strrchr(name, '.');
  return dot ? dot + 1 : "";
}

bool vxm_text_equal_nocase(const char *a, const char *b) {
  for (; *a && *b; a++, b++) {
    unsigned char x = (unsigned char)*a, y = (unsigned char)*b;
    if (x >= 'A' && x <= 'Z')
      x = (unsigned char)(x + 32);
    if (y >= 'A' && y <= 'Z')
      y = (unsigned char)(y + 32);
    if (x != y)
      return false;
  }
  return *a == *b;
}
