/* SPDX-License-Identifier: BSD-3-Clause */
/** Pairs of texts that a file carries beside its values: units, names, whatever other programs put there. */
#ifndef VXM_GRIDIO_COMMON_METADATA_H
#define VXM_GRIDIO_COMMON_METADATA_H

#include "base/context.h"

typedef struct vxm_metadata {
  vxm_context *context;
  size_t count;
  char *text;   /**< key and value of each in turn, with their zero bytes */
  size_t size;  /**< of the text */
  bool starved; /**< one found no memory */
} vxm_metadata;

/** All of a file together; what goes beyond is left out. */
enum { VXM_PAIRS_MOST = 1 << 20, VXM_PAIRS_COUNT_MOST = 1024 };

/** Adds a pair; a key that is there already is left as it is. False if there was no room: it is left out. */
bool vxm_metadata_add(vxm_metadata *pairs, vxm_context *context, const char *key, size_t key_size,
                      const char *value, size_t value_size);
void vxm_metadata_destroy(vxm_metadata *pairs);

/** The next pair; the first after NULL. NULL behind the last. */
const char *vxm_metadata_next(const vxm_metadata *pairs, const char *key);
const char *vxm_metadata_value(const char *key);
/** The value of a key, or NULL. */
const char *vxm_metadata_find(const vxm_metadata *pairs, const char *key);

#endif
