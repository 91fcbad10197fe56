/* SPDX-License-Identifier: BSD-3-Clause */
/** Files for Assimp: the one that is in memory already, and regular ones beside it, read only. */
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "meshio/assimp.h"

/** An open file. */
typedef struct open_file {
  struct aiFile file; /* first, so that Assimp's pointer is ours */
  vxm_input input;
  char *path; /**< which the input keeps, or NULL for the file in memory */
  size_t at;
} open_file;

static open_file *opened(struct aiFile *file) {
  return (open_file *)(void *)file;
}

/* ---- One file ---- */

/** As fread, whole elements only. */
static size_t read_file(struct aiFile *file, char *out, size_t size, size_t count) {
  open_file *f = opened(file);
  size_t left = f->input.size - f->at;
  if (size == 0 || count == 0)
    return 0;
  if (count > left / size)
    count = left / size;
  if (count > 0)
    memcpy(out, f->input.data + f->at, size * count);
  f->at += size * count;
  return count;
}

static size_t write_file(struct aiFile *file, const char *data, size_t size, size_t count) {
  (void)file;
  (void)data;
  (void)size;
  (void)count;
  return 0;
}

static size_t tell_file(struct aiFile *file) {
  return opened(file)->at;
}

static size_t size_file(struct aiFile *file) {
  return opened(file)->input.size;
}

static enum aiReturn seek_file(struct aiFile *file, size_t offset, enum aiOrigin origin) {
  open_file *f = opened(file);
  /* Offsets back from the end or from here come as negative numbers in disguise. */
  size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->input.size;
  size_t to = from + offset;
  if (to > f->input.size)
    return aiReturn_FAILURE;
  f->at = to;
  return aiReturn_SUCCESS;
}

static void flush_file(struct aiFile *file) {
  (void)file;
}

/* ---- The files ---- */

/** Opens a regular file; others might keep a reader waiting for ever. */
static bool open_beside(open_file *f, vxm_context *context, const char *path) {
  struct stat info;
  if (stat(path, &info) != 0 || !S_ISREG(info.st_mode))
    return false;
  size_t length = strlen(path) + 1;
  f->path = vxm_alloc(context, length, 1, NULL);
  if (!f->path)
    return false;
  memcpy(f->path, path, length);
  if (vxm_input_open(&f->input, context, f->path, NULL) == VXM_OK)
    return true;
  vxm_free(context, f->path);
  return false;
}

static struct aiFile *open_any(struct aiFileIO *io, const char *path, const char *mode) {
  vxm_assimp_files *files = (vxm_assimp_files *)(void *)io->UserData;
  bool is_main = strcmp(path, files->path) == 0;
  if (strpbrk(mode, "wa+") || (!is_main && !files->request->is_beside))
    return NULL;
  open_file *f = vxm_calloc(files->context, 1, sizeof *f, NULL);
  if (!f)
    return NULL;
  f->file = (struct aiFile){read_file, write_file, tell_file, size_file, seek_file, flush_file, NULL};
  f->input =
      (vxm_input){.data = files->request->data, .size = files->request->size, .context = files->context};
  if (!is_main && !open_beside(f, files->context, path)) {
    vxm_free(files->context, f);
    return NULL;
  }
  return &f->file;
}

static void close_any(struct aiFileIO *io, struct aiFile *file) {
  vxm_assimp_files *files = (vxm_assimp_files *)(void *)io->UserData;
  open_file *f = opened(file);
  vxm_input_close(&f->input); /* of the file in memory there is nothing to close */
  vxm_free(files->context, f->path);
  vxm_free(files->context, f);
}

void vxm_assimp_files_init(vxm_assimp_files *files, const vxm_reader_request *request, vxm_context *context,
                           const char *path) {
  *files = (vxm_assimp_files){
      .io = {open_any, close_any, (char *)files}, .request = request, .context = context, .path = path};
}
