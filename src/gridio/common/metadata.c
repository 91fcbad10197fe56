/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/metadata.h"

#include <string.h>

const char *vxm_metadata_value(const char *key) {
  return key + strlen(key) + 1;
}

const char *vxm_metadata_next(const vxm_metadata *pairs, const char *key) {
  const char *next = pairs->text;
  if (key) {
    const char *value = vxm_metadata_value(key);
    next = value + strlen(value) + 1;
  }
  return pairs->size > 0 && next < pairs->text + pairs->size ? next : NULL;
}

const char *vxm_metadata_find(const vxm_metadata *pairs, const char *key) {
  const char *at = NULL;
  while ((at = vxm_metadata_next(pairs, at)) != NULL)
    if (strcmp(at, key) == 0)
      return vxm_metadata_value(at);
  return NULL;
}

static char *put(char *to, const char *from, size_t size) {
  memcpy(to, from, size);
  to[size] = '\0';
  return to + size + 1;
}

bool vxm_metadata_add(vxm_metadata *pairs, vxm_context *context, const char *key, size_t key_size,
                      const char *value, size_t value_size) {
  size_t more = key_size + value_size + 2;
  if (pairs->count == VXM_PAIRS_COUNT_MOST || key_size == 0 || key_size > VXM_PAIRS_MOST ||
      value_size > VXM_PAIRS_MOST || more > VXM_PAIRS_MOST - pairs->size || memchr(key, '\0', key_size) ||
      memchr(value, '\0', value_size))
    return false;
  char *text = vxm_alloc(context, pairs->size + more, 1, NULL);
  if (!text) {
    pairs->starved = true;
    return false;
  }
  if (pairs->size > 0)
    memcpy(text, pairs->text, pairs->size);
  char *begin = text + pairs->size, *end = put(put(begin, key, key_size), value, value_size);
  if (pairs->size > 0 && vxm_metadata_find(pairs, begin)) {
    vxm_free(context, text);
    return true;
  }
  size_t count = pairs->count + 1;
  bool starved = pairs->starved;
  vxm_metadata_destroy(pairs);
  *pairs = (vxm_metadata){context, count, text, (size_t)(end - text), starved};
  return true;
}

void vxm_metadata_destroy(vxm_metadata *pairs) {
  vxm_free(pairs->context, pairs->text);
  pairs->text = NULL;
  pairs->size = 0;
}
