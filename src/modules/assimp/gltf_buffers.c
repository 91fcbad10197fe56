/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/assimp/gltf_buffers.h"

#include <string.h>

#include "base/context.h"
#include "base/endian.h"
#include "modules/assimp/uri.h"

/* ---- Buffers ---- */

/** A file beside this one, or data within a text. */
static void take_uri(vxm_gltf_buffer *buffer, const vxm_gltf_buffers *from, const char *uri, size_t length) {
  vxm_reader_file file;
  if (vxm_uri_is_data(uri, length)) {
    if (vxm_uri_data(&buffer->owned, &buffer->size, from->context, uri, length))
      buffer->data = buffer->owned;
    return;
  }
  char *name = vxm_alloc(from->context, length + 1, 1, NULL);
  if (!name)
    return;
  memcpy(name, uri, length + 1);
  vxm_uri_decode(name);
  if (from->request->fetch && from->request->fetch(from->request->payload, from->context, name, &file)) {
    buffer->data = buffer->owned = file.data;
    buffer->size = file.size;
  }
  vxm_free(from->context, name);
}

/** NULL if there is no such buffer, or it is not to be had. */
static const vxm_gltf_buffer *take_buffer(vxm_gltf_buffers *buffers, size_t index) {
  const json_t *all = json_object_get(buffers->root, "buffers");
  if (!buffers->list) {
    buffers->list = vxm_calloc(buffers->context, json_array_size(all), sizeof *buffers->list, NULL);
    buffers->count = buffers->list ? json_array_size(all) : 0;
  }
  if (index >= buffers->count)
    return NULL;
  vxm_gltf_buffer *buffer = &buffers->list[index];
  const json_t *uri = json_object_get(json_array_get(all, index), "uri");
  if (!buffer->asked && json_is_string(uri))
    take_uri(buffer, buffers, json_string_value(uri), json_string_length(uri));
  else if (!buffer->asked && index == 0) {
    buffer->data = buffers->binary;
    buffer->size = buffers->binary_size;
  }
  buffers->size += buffer->asked ? 0 : buffer->size;
  buffer->asked = true;
  return buffer->data ? buffer : NULL;
}

void vxm_gltf_buffers_destroy(vxm_gltf_buffers *buffers) {
  for (size_t b = 0; b < buffers->count; b++)
    vxm_free(buffers->context, buffers->list[b].owned);
  vxm_free(buffers->context, buffers->list);
}

/* ---- Accessors ---- */

/** A whole number of an object, 0 where there is none; false if it is negative or no number. */
static bool take_size(size_t *out, const json_t *object, const char *key) {
  const json_t *value = json_object_get(object, key);
  *out = value && json_is_integer(value) && json_integer_value(value) > 0 ? (size_t)json_integer_value(value)
                                                                          : 0;
  return !value || (json_is_integer(value) && json_integer_value(value) >= 0);
}

static unsigned components_of(const char *type) {
  static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  for (unsigned t = 0; t < 4 && type; t++)
    if (strcmp(type, types[t]) == 0)
      return t + 1;
  return 0;
}

/** The bytes of a view; NULL if it reaches beyond its buffer, or there is none. */
static const unsigned char *find_view(vxm_gltf_buffers *buffers, const json_t *view, size_t *size) {
  size_t index, offset;
  if (!json_is_object(view) || !take_size(&index, view, "buffer") ||
      !take_size(&offset, view, "byteOffset") || !take_size(size, view, "byteLength"))
    return NULL;
  const vxm_gltf_buffer *buffer = take_buffer(buffers, index);
  return buffer && offset <= buffer->size && *size <= buffer->size - offset ? buffer->data + offset : NULL;
}

const char *vxm_gltf_find_elements(vxm_gltf_elements *out, vxm_gltf_buffers *buffers,
                                   const json_t *accessor) {
  enum { BYTES_16 = 5122, BYTES_16_UNSIGNED = 5123 };
  json_int_t kind = json_integer_value(json_object_get(accessor, "componentType"));
  size_t view_index, offset, size;
  *out =
      (vxm_gltf_elements){.components = components_of(json_string_value(json_object_get(accessor, "type"))),
                          .bytes = kind == BYTES_16 || kind == BYTES_16_UNSIGNED ? 2 : 1,
                          .is_signed = kind == VXM_GLTF_BYTE || kind == BYTES_16,
                          .is_normalized = json_is_true(json_object_get(accessor, "normalized"))};
  if (kind < VXM_GLTF_BYTE || kind > BYTES_16_UNSIGNED)
    return "its numbers have neither 8 nor 16 bits";
  if (json_object_get(accessor, "sparse"))
    return "it is sparse";
  if (out->components == 0 || !json_object_get(accessor, "bufferView") ||
      !take_size(&view_index, accessor, "bufferView") || !take_size(&offset, accessor, "byteOffset") ||
      !take_size(&out->count, accessor, "count"))
    return "it is damaged";
  const json_t *view = json_array_get(json_object_get(buffers->root, "bufferViews"), view_index);
  out->data = find_view(buffers, view, &size);
  size_t element = (size_t)out->components * out->bytes;
  if (!out->data || !take_size(&out->stride, view, "byteStride"))
    return "its buffer is not there, or cut off";
  if (out->stride == 0)
    out->stride = element;
  bool fits = offset <= size &&
              (out->count == 0 ||
               (element <= size - offset && (out->count - 1) <= (size - offset - element) / out->stride));
  out->data += fits ? offset : 0;
  return fits ? NULL : "it reaches beyond its buffer";
}

float vxm_gltf_number(const vxm_gltf_elements *elements, size_t element, unsigned component) {
  const unsigned char *at = elements->data + element * elements->stride + (size_t)component * elements->bytes;
  int most = elements->bytes == 1 ? UINT8_MAX : UINT16_MAX;
  int value = elements->bytes == 1 ? *at : vxm_load_u16(at, vxm_must_swap(false));
  if (elements->is_signed) {
    value -= value > most / 2 ? most + 1 : 0;
    most /= 2;
  }
  if (!elements->is_normalized)
    return (float)value;
  return value < -most ? -1.0f : (float)((double)value / most);
}
