/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/minecraft/nbt_read.h"
#include "gridio/common/deflate.h"
#include "gridio/common/format.h"

#include <inttypes.h>
#include <string.h>

/** As deep as the game itself reads. */
enum { DEPTH_MOST = 512 };

uint64_t vxm_nbt_load_number(const unsigned char *bytes, int count) {
  uint64_t value = 0;
  for (int b = 0; b < count; b++)
    value = value << 8 | bytes[b];
  return value;
}

/* ---- Sizes ---- */

/** Bytes of an element of a type, or of what stands before its content; -1 for no type. */
static int head_bytes(unsigned type) {
  static const signed char bytes[] = {0, 1, 2, 4, 8, 4, 8, 4, 2, 5, 0, 4, 4};
  return type < sizeof bytes ? bytes[type] : -1;
}

static const unsigned char *skip(unsigned type, const unsigned char *at, const unsigned char *end, int depth);

/** Elements of `size` bytes whose 32-bit count lies at `at`. */
static const unsigned char *skip_array(const unsigned char *at, const unsigned char *end, size_t size) {
  uint64_t count = vxm_nbt_load_number(at, 4);
  at += 4;
  return count <= INT32_MAX && count <= (size_t)(end - at) / size ? at + (size_t)count * size : NULL;
}

static const unsigned char *skip_list(const unsigned char *at, const unsigned char *end, int depth) {
  unsigned type = at[0];
  uint64_t count = vxm_nbt_load_number(at + 1, 4);
  at += 5;
  if (count > INT32_MAX) /* the game takes negative counts for none */
    return at;
  /* elements of no bytes could be any number */
  if (type == VXM_NBT_END)
    return count == 0 ? at : NULL;
  for (uint64_t i = 0; at && i < count; i++)
    at = skip(type, at, end, depth + 1);
  return at;
}

static const unsigned char *skip_compound(const unsigned char *at, const unsigned char *end, int depth) {
  while (at && at < end) {
    unsigned type = *at++;
    if (type == VXM_NBT_END)
      return at;
    at = head_bytes(type) >= 0 ? skip(VXM_NBT_STRING, at, end, depth) : NULL;
    at = at ? skip(type, at, end, depth + 1) : NULL;
  }
  return NULL;
}

/** Behind the content of a tag; NULL if it goes beyond the end, or is none. */
static const unsigned char *skip(unsigned type, const unsigned char *at, const unsigned char *end,
                                 int depth) {
  int head = head_bytes(type);
  if (head < 0 || end - at < head || depth > DEPTH_MOST)
    return NULL;
  switch (type) {
  case VXM_NBT_BYTES:
    return skip_array(at, end, 1);
  case VXM_NBT_INTS:
    return skip_array(at, end, 4);
  case VXM_NBT_LONGS:
    return skip_array(at, end, 8);
  case VXM_NBT_STRING: {
    size_t size = (size_t)vxm_nbt_load_number(at, 2);
    return (size_t)(end - at) - 2 >= size ? at + 2 + size : NULL;
  }
  case VXM_NBT_LIST:
    return skip_list(at, end, depth);
  case VXM_NBT_COMPOUND:
    return skip_compound(at, end, depth);
  default:
    return at + head;
  }
}

/* ---- Unpacking ---- */

static vxm_status unpack_all(vxm_nbt *tree, size_t *size, vxm_inflater *inflater, const vxm_input *input,
                             vxm_error *error) {
  size_t capacity = 0, more = 1;
  vxm_status status = VXM_OK;
  *size = 0;
  while (status == VXM_OK && more > 0) {
    /* doubles, beginning with what most of such files take */
    status = vxm_grow(tree->context, (void **)&tree->bytes, &capacity,
                      capacity > 0 ? capacity + 1 : 8 * input->size + 4096, 1, error);
    if (status == VXM_OK)
      status = vxm_inflater_some(inflater, tree->bytes + *size, capacity - *size, &more, error);
    *size += status == VXM_OK ? more : 0;
    if (status == VXM_OK && *size < capacity)
      break;
    if (status == VXM_OK)
      status = vxm_check_cancelled(tree->context, error);
  }
  return status;
}

static vxm_status load(vxm_nbt *tree, size_t *size, const vxm_input *input, vxm_error *error) {
  vxm_inflater *inflater;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_inflater_create(&inflater, input, 0, &local);
  if (status == VXM_OK)
    status = unpack_all(tree, size, inflater, input, &local);
  vxm_inflater_destroy(inflater);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

bool vxm_nbt_sniff(const vxm_input *input) {
  unsigned char first[3];
  size_t size = 0;
  vxm_inflater *inflater;
  if (input->size < 18 || input->data[0] != 0x1f || input->data[1] != 0x8b ||
      vxm_inflater_create(&inflater, input, 0, NULL) != VXM_OK)
    return false;
  bool is_tree =
      vxm_inflater_some(inflater, first, sizeof first, &size, NULL) == VXM_OK && size == sizeof first;
  vxm_inflater_destroy(inflater);
  /* a compound with a name of less than 256 bytes */
  return is_tree && first[0] == VXM_NBT_COMPOUND && first[1] == 0;
}

/** Some programs leave their trees unpacked. */
static vxm_status copy(vxm_nbt *tree, size_t *size, const vxm_input *input, vxm_error *error) {
  vxm_status status = VXM_OK;
  tree->bytes = vxm_try_alloc(tree->context, input->size, 1, &status, error);
  if (tree->bytes)
    memcpy(tree->bytes, input->data, input->size);
  *size = input->size;
  return status;
}

vxm_status vxm_nbt_load(vxm_nbt *out, const vxm_input *input, vxm_error *error) {
  size_t size = 0;
  *out = (vxm_nbt){.context = input->context};
  bool is_plain = input->size > 0 && input->data[0] == VXM_NBT_COMPOUND;
  vxm_status status = (is_plain ? copy : load)(out, &size, input, error);
  if (status == VXM_OK) {
    const unsigned char *bytes = out->bytes, *end = bytes + size, *at = NULL;
    if (size > 3 && bytes[0] == VXM_NBT_COMPOUND)
      at = skip(VXM_NBT_STRING, bytes + 1, end, 0);
    const unsigned char *behind = at ? skip(VXM_NBT_COMPOUND, at, end, 0) : NULL;
    out->root = (vxm_nbt_value){VXM_NBT_COMPOUND, at, behind};
    if (!behind)
      status = vxm_fail_byte(error, input, 0, "not a tree of named binary tags, or one that is cut short");
  }
  if (status != VXM_OK)
    vxm_nbt_destroy(out);
  return status;
}

void vxm_nbt_destroy(vxm_nbt *tree) {
  vxm_free(tree->context, tree->bytes);
  tree->bytes = NULL;
}

/* ---- Walking ---- */

bool vxm_nbt_next(const unsigned char **at, const vxm_nbt_value *compound, const char **name,
                  size_t *name_size, vxm_nbt_value *value) {
  const unsigned char *p = *at;
  unsigned type = *p++;
  if (type == VXM_NBT_END)
    return false;
  *name_size = (size_t)vxm_nbt_load_number(p, 2);
  *name = (const char *)p + 2;
  p += 2 + *name_size;
  *at = skip(type, p, compound->end, 0);
  *value = (vxm_nbt_value){(vxm_nbt_type)type, p, *at};
  return true;
}

/** A child of any type. */
static bool find(vxm_nbt_value *out, const vxm_nbt_value *compound, const char *name) {
  const unsigned char *at = compound->at;
  size_t size = strlen(name), other_size;
  const char *other;
  while (vxm_nbt_next(&at, compound, &other, &other_size, out))
    if (other_size == size && memcmp(name, other, size) == 0)
      return true;
  return false;
}

bool vxm_nbt_find(vxm_nbt_value *out, const vxm_nbt_value *compound, const char *name, vxm_nbt_type type) {
  return find(out, compound, name) && out->type == type;
}

int64_t vxm_nbt_integer_of(const vxm_nbt_value *value) {
  switch (value->type) {
  case VXM_NBT_BYTE:
    return (int8_t)value->at[0];
  case VXM_NBT_SHORT:
    return (int16_t)vxm_nbt_load_number(value->at, 2);
  case VXM_NBT_INT:
    return (int32_t)vxm_nbt_load_number(value->at, 4);
  case VXM_NBT_LONG:
    return (int64_t)vxm_nbt_load_number(value->at, 8);
  default:
    return 0;
  }
}

bool vxm_nbt_find_integer(int64_t *out, const vxm_nbt_value *compound, const char *name) {
  vxm_nbt_value value;
  if (!find(&value, compound, name) || value.type < VXM_NBT_BYTE || value.type > VXM_NBT_LONG)
    return false;
  *out = vxm_nbt_integer_of(&value);
  return true;
}

bool vxm_nbt_find_triple(double out[3], const vxm_nbt_value *compound, const char *name) {
  vxm_nbt_value list, item;
  const unsigned char *at = NULL;
  if (!vxm_nbt_find(&list, compound, name, VXM_NBT_LIST) || list.at[0] != VXM_NBT_DOUBLE ||
      vxm_nbt_count(&list) != 3)
    return false;
  while (vxm_nbt_next_item(&at, &list, &item)) {
    uint64_t bits = vxm_nbt_load_number(item.at, 8);
    memcpy(out++, &bits, sizeof bits);
  }
  return true;
}

size_t vxm_nbt_count(const vxm_nbt_value *list) {
  uint64_t count = vxm_nbt_load_number(list->at + (list->type == VXM_NBT_LIST), 4);
  return count > INT32_MAX ? 0 : (size_t)count;
}

bool vxm_nbt_next_item(const unsigned char **at, const vxm_nbt_value *list, vxm_nbt_value *value) {
  unsigned type = list->at[0];
  const unsigned char *p = *at ? *at : list->at + 5;
  if (p == list->end)
    return false;
  *at = skip(type, p, list->end, 0);
  *value = (vxm_nbt_value){(vxm_nbt_type)type, p, *at};
  return true;
}

const char *vxm_nbt_string_of(const vxm_nbt_value *value, size_t *size) {
  *size = (size_t)vxm_nbt_load_number(value->at, 2);
  return (const char *)value->at + 2;
}
