/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/gltf_floats.h"

#include <string.h>

#include "base/context.h"
#include "base/endian.h"
#include "modules/assimp/gltf.h"

/** What is made of a file. */
typedef struct converter {
  json_t *root;
  vxm_gltf_buffers *buffers;
  unsigned char *floats;
  size_t size, capacity;
  size_t taken; /**< the bytes of all elements so far */
} converter;

/* ---- What is to be converted ---- */

static bool is_position(const char *attribute) {
  return strcmp(attribute, "POSITION") == 0;
}

/** Attributes that are looked at later, and have to be floats for Assimp. Colours of whole numbers it knows.
 */
static bool is_needed(const char *attribute) {
  return is_position(attribute) || strncmp(attribute, "TEXCOORD_", strlen("TEXCOORD_")) == 0;
}

static json_t *accessor_of(const json_t *root, const json_t *index) {
  json_int_t number = json_is_integer(index) ? json_integer_value(index) : -1;
  return number < 0 ? NULL : json_array_get(json_object_get(root, "accessors"), (size_t)number);
}

static bool is_whole(const json_t *accessor) {
  return accessor && json_integer_value(json_object_get(accessor, "componentType")) != VXM_GLTF_FLOAT;
}

/** Whether a mesh has positions that are whole numbers. */
static bool is_quantized(const json_t *root, const json_t *mesh) {
  const json_t *primitive;
  size_t p;
  json_array_foreach(json_object_get(mesh, "primitives"), p, primitive) {
    const json_t *attributes = json_object_get(primitive, "attributes");
    if (is_whole(accessor_of(root, json_object_get(attributes, "POSITION"))))
      return true;
  }
  return false;
}

/** The mesh of a node that has bones, -1 if there is none. */
static json_int_t mesh_with_bones(const json_t *node) {
  const json_t *index = json_object_get(node, "mesh");
  return json_object_get(node, "skin") && json_is_integer(index) ? json_integer_value(index) : -1;
}

/** The true size of such a mesh may stand in its bones, which are not applied. */
static vxm_status warn_bones(const converter *c, vxm_warnings *warnings, vxm_error *error) {
  const json_t *node, *mesh, *meshes = json_object_get(c->root, "meshes");
  size_t n, m, count = json_array_size(meshes);
  vxm_status status = VXM_OK;
  bool *has_bones = vxm_try_calloc(c->buffers->context, count, sizeof *has_bones, &status, error),
       found = false;
  if (!has_bones)
    return status;
  json_array_foreach(json_object_get(c->root, "nodes"), n, node) {
    json_int_t index = mesh_with_bones(node);
    if (index >= 0 && (size_t)index < count)
      has_bones[index] = true;
  }
  json_array_foreach(meshes, m, mesh) {
    found = found || (has_bones[m] && is_quantized(c->root, mesh));
  }
  vxm_free(c->buffers->context, has_bones);
  if (found)
    vxm_warn(warnings, "meshes with bones have positions in whole numbers: their size and place are those "
                       "without the bones, which are not applied");
  return VXM_OK;
}

/* ---- Conversion ---- */

static vxm_status out_of_memory(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_MEMORY, "not enough memory to read the file");
}

static vxm_status append(converter *c, const vxm_gltf_elements *elements, vxm_error *error) {
  const bool swap = vxm_must_swap(false);
  if (elements->count > (SIZE_MAX / 2 - c->size) / (4 * sizeof(float)))
    return out_of_memory(error);
  vxm_status status = vxm_grow(c->buffers->context, (void **)&c->floats, &c->capacity,
                               c->size + elements->count * elements->components * sizeof(float), 1, error);
  if (status != VXM_OK)
    return status;
  unsigned char *out = c->floats + c->size;
  for (size_t e = 0; e < elements->count; e++)
    for (unsigned n = 0; n < elements->components; n++, out += sizeof(float))
      vxm_store_f32(out, vxm_gltf_number(elements, e, n), swap);
  c->size = (size_t)(out - c->floats);
  return VXM_OK;
}

/** Makes the accessor tell of the floats from `offset` on. */
static bool point_to_floats(converter *c, json_t *accessor, size_t offset) {
  json_t *views = json_object_get(c->root, "bufferViews");
  size_t index = json_array_size(views), buffer = json_array_size(json_object_get(c->root, "buffers"));
  json_t *view = json_pack("{s:I, s:I, s:I}", "buffer", (json_int_t)buffer, "byteOffset", (json_int_t)offset,
                           "byteLength", (json_int_t)(c->size - offset));
  static const char *const past[] = {"normalized", "byteOffset", "min", "max"};
  for (size_t k = 0; k < sizeof past / sizeof *past; k++)
    json_object_del(accessor, past[k]);
  return json_array_append_new(views, view) == 0 &&
         json_object_set_new(accessor, "bufferView", json_integer((json_int_t)index)) == 0 &&
         json_object_set_new(accessor, "componentType", json_integer(VXM_GLTF_FLOAT)) == 0;
}

/** Finds the elements of an accessor, as vxm_gltf_find_elements. Accessors may share bytes, but not so often
 * that a small file takes all memory there is. */
static const char *find_elements(converter *c, vxm_gltf_elements *out, const json_t *accessor) {
  enum { SHARED_MAX = 8 };
  const char *failure = vxm_gltf_find_elements(out, c->buffers, accessor);
  if (failure)
    return failure;
  c->taken += out->count * out->components * out->bytes;
  return c->taken / SHARED_MAX > c->buffers->size ? "too many others lie over the same bytes" : NULL;
}

/** Converts one accessor of an attribute; what is no position may stay as it is where it cannot be. */
static vxm_status convert(converter *c, json_t *accessor, const char *attribute, vxm_error *error) {
  vxm_gltf_elements elements;
  const char *name = c->buffers->request->name;
  const char *failure = find_elements(c, &elements, accessor);
  if (failure && is_position(attribute))
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, (vxm_place){name, 0, -1, -1},
        "an accessor of positions in whole numbers (KHR_mesh_quantization) cannot be read: %s; "
        "'gltf-transform dequantize IN OUT.glb' may help",
        failure);
  if (failure)
    return VXM_OK;
  size_t offset = c->size;
  vxm_status status = append(c, &elements, error);
  return status == VXM_OK && !point_to_floats(c, accessor, offset) ? out_of_memory(error) : status;
}

static vxm_status convert_primitive(converter *c, const json_t *primitive, vxm_error *error) {
  json_t *attributes = json_object_get(primitive, "attributes");
  vxm_status status = VXM_OK;
  for (void *at = json_object_iter(attributes); at && status == VXM_OK;
       at = json_object_iter_next(attributes, at)) {
    json_t *accessor = accessor_of(c->root, json_object_iter_value(at));
    if (is_needed(json_object_iter_key(at)) && is_whole(accessor))
      status = convert(c, accessor, json_object_iter_key(at), error);
  }
  return status;
}

vxm_status vxm_gltf_make_floats(unsigned char **floats, size_t *size, json_t *root, vxm_gltf_buffers *buffers,
                                vxm_warnings *warnings, vxm_error *error) {
  converter c = {.root = root, .buffers = buffers};
  const json_t *mesh, *primitive;
  size_t m, p;
  *floats = NULL;
  vxm_status status = warn_bones(&c, warnings, error);
  json_array_foreach(json_object_get(root, "meshes"), m, mesh) {
    json_array_foreach(json_object_get(mesh, "primitives"), p, primitive) {
      if (status == VXM_OK)
        status = convert_primitive(&c, primitive, error);
    }
  }
  if (status == VXM_OK && c.size > 0 &&
      json_array_append_new(
          json_object_get(root, "buffers"),
          json_pack("{s:I, s:s}", "byteLength", (json_int_t)c.size, "uri", VXM_GLTF_FLOATS)) != 0)
    status = out_of_memory(error);
  if (status != VXM_OK) {
    vxm_free(buffers->context, c.floats);
    return status;
  }
  *floats = c.floats;
  *size = c.size;
  return VXM_OK;
}
