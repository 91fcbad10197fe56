/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/gltf.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/context.h"
#include "base/endian.h"
#include "modules/assimp/gltf_floats.h"
#include "modules/assimp/gltf_required.h"

void vxm_gltf_start(void) {
  json_object_seed(0); /* which opens a file */
}

/* ---- The parts of a file ---- */

/** A file as it lies in memory: JSON, and what follows it in a .glb. */
typedef struct layout {
  const unsigned char *json, *binary;
  size_t json_size, binary_size;
  bool is_glb;
} layout;

enum { HEADER = 12, CHUNK = 8, VERSION = 2 };

static bool is_glb(const vxm_reader_request *request) {
  return request->size >= 4 && memcmp(request->data, "glTF", 4) == 0;
}

/** Fails for a file that is shorter than the parts it announces, of `size` bytes, or than its header says. */
static vxm_status fail_cut(const vxm_reader_request *request, uint64_t size, vxm_error *error) {
  if (request->size >= HEADER && vxm_load_le32(request->data + 8) > size)
    size = vxm_load_le32(request->data + 8);
  return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){request->name, 0, -1, -1},
                     "the file is cut off: %zu of %" PRIu64 " bytes are there", request->size, size);
}

/** Finds the parts; a version that we do not know has none, and is Assimp's alone. */
static vxm_status find_parts(layout *out, const vxm_reader_request *request, vxm_error *error) {
  const unsigned char *data = request->data;
  *out = (layout){.json = data, .json_size = request->size};
  if (!is_glb(request))
    return VXM_OK;
  *out = (layout){.is_glb = true};
  if (request->size < HEADER + CHUNK)
    return fail_cut(request, HEADER + CHUNK, error);
  if (vxm_load_le32(data + 4) != VERSION)
    return VXM_OK;
  size_t left = request->size - HEADER - CHUNK, size = vxm_load_le32(data + HEADER);
  if (size > left)
    return fail_cut(request, HEADER + CHUNK + (uint64_t)size, error);
  out->json = data + HEADER + CHUNK;
  out->json_size = size;
  left -= size;
  if (left < CHUNK)
    return VXM_OK;
  const unsigned char *chunk = out->json + size;
  if (vxm_load_le32(chunk) > left - CHUNK)
    return fail_cut(request, request->size - left + CHUNK + vxm_load_le32(chunk), error);
  out->binary = chunk + CHUNK;
  out->binary_size = vxm_load_le32(chunk);
  return VXM_OK;
}

/* ---- JSON in and out ---- */

static vxm_status out_of_memory(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_MEMORY, "not enough memory to read the file");
}

/** Whether the text has a word of what is looked at here and not by Assimp. */
static bool needs_look(const layout *parts) {
  static const char *const words[] = {"extensionsRequired", "KHR_mesh_quant", "EXT_mesh_gpu_instancing"};
  for (size_t w = 0; w < sizeof words / sizeof *words; w++)
    if (memmem(parts->json, parts->json_size, words[w], strlen(words[w])))
      return true;
  return false;
}

/** Takes the JSON; NULL where there is none of glTF 2. What is not JSON to the letter is Assimp's matter,
 * unless it may have what Assimp does not look at. */
static vxm_status load(json_t **out, const layout *parts, const char *name, vxm_error *error) {
  json_error_t what;
  errno = 0; /* jansson takes a lack of memory for damage in places */
  *out = parts->json ? json_loadb((const char *)parts->json, parts->json_size, JSON_ALLOW_NUL, &what) : NULL;
  const char *version = json_string_value(json_object_get(json_object_get(*out, "asset"), "version"));
  if (*out && (!version || strncmp(version, "2.", 2) != 0)) {
    json_decref(*out);
    *out = NULL;
  } else if (parts->json && !*out && errno == ENOMEM)
    return out_of_memory(error);
  else if (parts->json && !*out && needs_look(parts))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1},
                       "its JSON is damaged: line %d: %.150s", what.line, what.text);
  return VXM_OK;
}

/** Puts the file together again, around another JSON. */
static vxm_status rebuild(vxm_gltf *out, const json_t *root, const layout *parts,
                          const vxm_reader_request *request, vxm_context *context, vxm_error *error) {
  enum { ALIGN = 4 };
  char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17));
  size_t length = json ? strlen(json) : 0,
         padded = parts->is_glb ? (length + ALIGN - 1) / ALIGN * ALIGN : length;
  const unsigned char *behind = parts->json + parts->json_size;
  size_t rest = request->size - (size_t)(behind - request->data);
  size_t before = parts->is_glb ? HEADER + CHUNK : 0;
  if (!json)
    return out_of_memory(error);
  out->size = before + padded + rest;
  vxm_status status = VXM_OK;
  out->data = vxm_try_alloc(context, out->size, 1, &status, error);
  if (!out->data) {
    free(json);
    return status;
  }
  memcpy(out->data, request->data, before);
  memcpy(out->data + before, json, length);
  memset(out->data + before + length, ' ', padded - length);
  memcpy(out->data + before + padded, behind, rest);
  if (parts->is_glb) {
    vxm_store_le32(out->data + 8, (uint32_t)out->size);
    vxm_store_le32(out->data + HEADER, (uint32_t)padded);
  }
  free(json);
  return VXM_OK;
}

static vxm_status prepare_root(vxm_gltf *out, json_t *root, const layout *parts,
                               const vxm_reader_request *request, vxm_context *context,
                               vxm_warnings *warnings, vxm_error *error) {
  vxm_gltf_buffers buffers = {.root = root,
                              .request = request,
                              .context = context,
                              .binary = parts->binary,
                              .binary_size = parts->binary_size};
  vxm_status status = vxm_gltf_check_required(root, request->name, error);
  if (status == VXM_OK)
    status = vxm_gltf_make_floats(&out->floats, &out->floats_size, root, &buffers, warnings, error);
  vxm_gltf_buffers_destroy(&buffers);
  return status == VXM_OK && out->floats ? rebuild(out, root, parts, request, context, error) : status;
}

vxm_status vxm_gltf_prepare(vxm_gltf *out, const vxm_reader_request *request, vxm_context *context,
                            vxm_warnings *warnings, vxm_error *error) {
  layout parts;
  json_t *root = NULL;
  *out = (vxm_gltf){0};
  vxm_status status = find_parts(&parts, request, error);
  if (status == VXM_OK)
    status = load(&root, &parts, request->name, error);
  if (status == VXM_OK && root)
    status = prepare_root(out, root, &parts, request, context, warnings, error);
  json_decref(root);
  if (status != VXM_OK)
    vxm_gltf_destroy(out, context);
  return status;
}

void vxm_gltf_destroy(vxm_gltf *gltf, vxm_context *context) {
  vxm_free(context, gltf->data);
  vxm_free(context, gltf->floats);
  *gltf = (vxm_gltf){0};
}
