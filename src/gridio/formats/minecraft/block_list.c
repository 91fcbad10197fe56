/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/hash.h"
#include "gridio/formats/minecraft/block_file.h"

#include <string.h>

enum { NAMES_MOST = UINT16_MAX };

static uint64_t hash_of(const char *name, size_t size) {
  uint64_t hash = size;
  for (size_t i = 0; i < size; i++)
    hash = vxm_mix(hash ^ (unsigned char)name[i]);
  return hash;
}

static bool is_air(const char *name, size_t size) {
  static const char *const kinds[] = {"minecraft:air", "minecraft:cave_air", "minecraft:void_air",
                                      "minecraft:structure_void"};
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    if (strlen(kinds[k]) == size && memcmp(kinds[k], name, size) == 0)
      return true;
  return false;
}

/** The slot of a name: where it is, or would be. */
static size_t find_slot(const vxm_block_list *list, const char *name, size_t size) {
  size_t slot = (size_t)hash_of(name, size) & (list->slots - 1);
  for (; list->table[slot] != 0; slot = (slot + 1) & (list->slots - 1)) {
    const char *other = list->text + list->begin[list->table[slot]];
    if (strlen(other) == size && memcmp(other, name, size) == 0)
      break;
  }
  return slot;
}

static vxm_status append(vxm_block_list *list, const char *name, size_t size, vxm_error *error) {
  vxm_status status =
      vxm_grow(list->context, (void **)&list->text, &list->capacity, list->size + size + 1, 1, error);
  if (status == VXM_OK)
    status = vxm_grow(list->context, (void **)&list->begin, &list->begin_capacity, list->count + 1,
                      sizeof *list->begin, error);
  if (status != VXM_OK)
    return status;
  list->begin[list->count++] = list->size;
  memcpy(list->text + list->size, name, size);
  list->text[list->size + size] = '\0';
  list->size += size + 1;
  return VXM_OK;
}

/** At least half of the slots stay free. */
static vxm_status grow_table(vxm_block_list *list, vxm_error *error) {
  size_t slots = list->slots > 0 ? 4 * list->slots : 256;
  vxm_status status = VXM_OK;
  uint32_t *table = vxm_try_calloc(list->context, slots, sizeof *table, &status, error);
  if (!table)
    return status;
  vxm_free(list->context, list->table);
  list->table = table;
  list->slots = slots;
  for (size_t n = 1; n < list->count; n++) {
    const char *name = list->text + list->begin[n];
    list->table[find_slot(list, name, strlen(name))] = (uint32_t)n;
  }
  return VXM_OK;
}

vxm_status vxm_block_list_add(uint32_t *number, vxm_block_list *list, const char *name, size_t size,
                              vxm_error *error) {
  vxm_status status =
      list->count == 0 ? append(list, "minecraft:air", strlen("minecraft:air"), error) : VXM_OK;
  *number = 0;
  if (status != VXM_OK || is_air(name, size))
    return status;
  size = memchr(name, '\0', size) ? strnlen(name, size) : size;
  if (2 * list->count >= list->slots)
    status = grow_table(list, error);
  if (status != VXM_OK)
    return status;
  size_t slot = find_slot(list, name, size);
  if (list->table[slot] == 0) {
    if (list->count > NAMES_MOST)
      return vxm_fail(error, VXM_ERROR_RANGE, "more than %d kinds of blocks", NAMES_MOST);
    status = append(list, name, size, error);
    if (status == VXM_OK)
      list->table[slot] = (uint32_t)(list->count - 1);
  }
  *number = list->table[slot];
  return status;
}

void vxm_block_list_destroy(vxm_block_list *list) {
  vxm_free(list->context, list->text);
  vxm_free(list->context, list->begin);
  vxm_free(list->context, list->table);
  *list = (vxm_block_list){.context = list->context};
}
