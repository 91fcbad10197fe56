/* SPDX-License-Identifier: BSD-3-Clause */
/** Pairs of texts that a file carries beside its values: units, names, whatever other programs put there. */
#ifndef VXM_GRIDIO_PAIRS_H
#define VXM_GRIDIO_PAIRS_H

#include "base/context.h"

typedef struct vxm_pairs {
  vxm_context *context;
  size_t count;
  char *text;   /**< key and value of each in turn, with their zero bytes */
  size_t size;  /**< of the text */
  bool starved; /**< one found no memory */
} vxm_pairs;

/** All of a file together; what goes beyond is left out. */
enum { VXM_PAIRS_MOST = 1 << 20, VXM_PAIRS_COUNT_MOST = 1024 };

/** Adds a pair; a key that is there already is left as it is. False if there was no room: it is left out. */
bool vxm_pairs_add(vxm_pairs *pairs, vxm_context *context, const char *key, size_t key_size,
                   const char *value, size_t value_size);
void vxm_pairs_destroy(vxm_pairs *pairs);

/** The next pair; the first after NULL. NULL behind the last. */
const char *vxm_pairs_next(const vxm_pairs *pairs, const char *key);
const char *vxm_pairs_value(const char *key);
/** The value of a key, or NULL. */
const char *vxm_pairs_find(const vxm_pairs *pairs, const char *key);

#endif
