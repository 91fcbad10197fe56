/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
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
static vxm_status take_in(vxm_input *out, int descriptor, bool in_parts, vxm_error *error) {
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
    void *mapping =
        mmap(NULL, out->size, PROT_READ, MAP_PRIVATE | (in_parts ? 0 : MAP_POPULATE), descriptor, 0);
    if (mapping == MAP_FAILED)
      status = lseek(descriptor, 0, SEEK_SET) < 0 ? vxm_fail_errno(error, path, "cannot read")
                                                  : read_stream(out, descriptor, error);
    else {
      out->mapping = mapping;
      out->data = mapping;
      posix_madvise(mapping, out->size, in_parts ? POSIX_MADV_RANDOM : POSIX_MADV_SEQUENTIAL);
    }
  } else
    status = read_stream(out, descriptor, error);
  return status;
}

vxm_status vxm_input_take(vxm_input *out, vxm_context *context, const char *name, int descriptor,
                          vxm_error *error) {
  *out = (vxm_input){.name = name, .context = context};
  return take_in(out, descriptor, false, error);
}

static vxm_status open_input(vxm_input *out, vxm_context *context, const char *path, bool in_parts,
                             vxm_error *error) {
  *out = (vxm_input){.name = path, .context = context};
  if (strcmp(path, "-") == 0) {
    out->name = "<stdin>";
    return read_stream(out, STDIN_FILENO, error);
  }
  int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    return vxm_fail_errno(error, path, "cannot open");
  vxm_status status = take_in(out, descriptor, in_parts, error);
  close(descriptor);
  return status;
}

vxm_status vxm_input_open(vxm_input *out, vxm_context *context, const char *path, vxm_error *error) {
  return open_input(out, context, path, false, error);
}

vxm_status vxm_input_open_in_parts(vxm_input *out, vxm_context *context, const char *path, vxm_error *error) {
  return open_input(out, context, path, true, error);
}

void vxm_input_close(vxm_input *input) {
  if (input->mapping)
    munmap(input->mapping, input->size);
  vxm_free(input->context, input->block);
  input->mapping = NULL;
  input->block = NULL;
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
