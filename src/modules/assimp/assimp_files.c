/* SPDX-License-Identifier: BSD-3-Clause */
/** Files for Assimp: the one that is in memory already, and those that are fetched for it, read only. */
#include <string.h>

#include "base/context.h"
#include "modules/assimp/assimp.h"
#include "modules/assimp/uri.h"

/** An open file. */
typedef struct open_file {
  struct aiFile file; /* first, so that Assimp's pointer is ours */
  const unsigned char *data;
  size_t size, at;
  unsigned char *fetched; /**< what to free; NULL for the mesh itself */
} open_file;

static open_file *opened(struct aiFile *file) {
  return (open_file *)(void *)file;
}

/* ---- One file ---- */

/** As fread, whole elements only. */
static size_t read_file(struct aiFile *file, char *out, size_t size, size_t count) {
  open_file *f = opened(file);
  size_t left = f->size - f->at;
  if (size == 0 || count == 0)
    return 0;
  if (count > left / size)
    count = left / size;
  if (count > 0)
    memcpy(out, f->data + f->at, size * count);
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
  return opened(file)->size;
}

static enum aiReturn seek_file(struct aiFile *file, size_t offset, enum aiOrigin origin) {
  open_file *f = opened(file);
  /* Offsets back from the end or from here come as negative numbers in disguise. */
  size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->size;
  size_t to = from + offset;
  if (to > f->size)
    return aiReturn_FAILURE;
  f->at = to;
  return aiReturn_SUCCESS;
}

static void flush_file(struct aiFile *file) {
  (void)file;
}

/* ---- The files ---- */

/** What is in memory: the file, or what stands for it, and the buffer that was made of it. */
static bool find_here(open_file *f, const vxm_assimp_files *files, const char *path) {
  const vxm_gltf *gltf = files->gltf;
  if (strcmp(path, files->path) == 0) {
    f->data = gltf && gltf->data ? gltf->data : files->request->data;
    f->size = gltf && gltf->data ? gltf->size : files->request->size;
    return true;
  }
  const char *slash = strrchr(path, '/');
  if (!gltf || !gltf->floats || strcmp(slash ? slash + 1 : path, VXM_GLTF_FLOATS) != 0)
    return false;
  f->data = gltf->floats;
  f->size = gltf->floats_size;
  return true;
}

/** The name of another file, in its own block: in glTF it is a URI, which Assimp hands on as it stands. */
static char *name_of(const vxm_assimp_files *files, const char *path) {
  size_t size = strlen(path) + 1;
  char *name = vxm_alloc(files->context, size, 1, NULL);
  if (name) {
    memcpy(name, path, size);
    if (files->gltf)
      vxm_uri_decode(name);
  }
  return name;
}

static bool fetch(open_file *f, const vxm_assimp_files *files, const char *path) {
  const vxm_reader_request *request = files->request;
  vxm_reader_file file;
  char *name = name_of(files, path);
  bool is_there = name && request->fetch && request->fetch(request->payload, files->context, name, &file);
  vxm_free(files->context, name);
  if (!is_there)
    return false;
  f->data = f->fetched = file.data;
  f->size = file.size;
  return true;
}

static struct aiFile *open_any(struct aiFileIO *io, const char *path, const char *mode) {
  vxm_assimp_files *files = (vxm_assimp_files *)(void *)io->UserData;
  if (strpbrk(mode, "wa+"))
    return NULL;
  open_file *f = vxm_calloc(files->context, 1, sizeof *f, NULL);
  if (!f)
    return NULL;
  f->file = (struct aiFile){read_file, write_file, tell_file, size_file, seek_file, flush_file, NULL};
  if (!find_here(f, files, path) && !fetch(f, files, path)) {
    vxm_free(files->context, f);
    return NULL;
  }
  return &f->file;
}

static void close_any(struct aiFileIO *io, struct aiFile *file) {
  vxm_assimp_files *files = (vxm_assimp_files *)(void *)io->UserData;
  open_file *f = opened(file);
  vxm_free(files->context, f->fetched);
  vxm_free(files->context, f);
}

void vxm_assimp_files_init(vxm_assimp_files *files, const vxm_reader_request *request, vxm_context *context,
                           const char *path, const vxm_gltf *gltf) {
  *files = (vxm_assimp_files){.io = {open_any, close_any, (char *)files},
                              .request = request,
                              .context = context,
                              .path = path,
                              .gltf = gltf};
}
