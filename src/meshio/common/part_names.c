/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/part_names.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct occurrence {
  const char *name;
  size_t index;
} occurrence;

static int by_name(const void *a, const void *b) {
  const occurrence *x = a, *y = b;
  int order = strcmp(x->name, y->name);
  return order != 0 ? order : (x->index > y->index) - (x->index < y->index);
}

vxm_status vxm_part_names_number(uint32_t *numbers, vxm_context *context, const char *const *names,
                                 size_t count, vxm_error *error) {
  vxm_status status = VXM_OK;
  occurrence *all = vxm_try_alloc(context, count, sizeof *all, &status, error);
  if (!all)
    return status;
  for (size_t i = 0; i < count; i++)
    all[i] = (occurrence){names[i], i};
  qsort(all, count, sizeof *all, by_name);
  for (size_t i = 0, end; i < count; i = end) {
    for (end = i + 1; end < count && strcmp(all[end].name, all[i].name) == 0;)
      end++;
    bool alone = end == i + 1 || *all[i].name == '\0';
    for (size_t k = i; k < end; k++)
      numbers[all[k].index] = alone ? 0 : (uint32_t)(k - i + 1);
  }
  vxm_free(context, all);
  return VXM_OK;
}

void vxm_part_names_tag(vxm_tagger *tagger, const char *name, uint32_t number) {
  size_t length = strlen(name);
  if (number == 0) {
    vxm_tagger_group(tagger, (const unsigned char *)name, length);
    return;
  }
  /* A long name is cut before its number, between characters of UTF-8. */
  char text[VXM_TAG_PART_MAX + 1], suffix[16];
  size_t added = (size_t)snprintf(suffix, sizeof suffix, "#%" PRIu32, number);
  if (length > VXM_TAG_PART_MAX - added) {
    length = VXM_TAG_PART_MAX - added;
    while (length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80)
      length--;
  }
  memcpy(text, name, length);
  memcpy(text + length, suffix, added);
  vxm_tagger_group(tagger, (const unsigned char *)text, length + added);
}
