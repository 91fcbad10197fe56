/* SPDX-License-Identifier: BSD-3-Clause */
/** What encodes the values of an octree: nodes of level 0 first (octree_encode.c), then all
 * (octree_encode_file.c). */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_ENCODER_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_ENCODER_H

#include "base/task_progress.h"
#include "grid/octree_build.h"
#include "gridio/formats/octree/octree_values.h"

enum { VXM_WORKER_SHIFT = 48 };

/** Bytes that grow. */
typedef struct vxm_value_bytes {
  unsigned char *data;
  size_t size, capacity;
} vxm_value_bytes;

/** Where the values of a node of level 0 are. */
typedef struct vxm_node_entry {
  uint64_t key; /**< Morton number of the node */
  uint64_t at;  /**< the worker, above VXM_WORKER_SHIFT bits, and where its bytes begin */
} vxm_node_entry;

typedef struct vxm_node_room {
  vxm_value_bytes values;
  vxm_node_entry *entries;
  size_t count, capacity;
  unsigned char *node; /**< values of the node at hand, where they are made in nodes */
  bool has_one;        /**< nodes of the value `one` are encoded where `one_at` is */
  unsigned char one[VXM_OCTREE_VALUE_BYTES];
  uint64_t one_at;
} vxm_node_room;

struct vxm_octree_encoder {
  vxm_context *context;
  vxm_space space;
  vxm_values_spec spec;
  size_t value_bytes;
  unsigned char background[VXM_OCTREE_VALUE_BYTES];
  vxm_octree_builder builder;
  vxm_node_room *rooms;
  size_t workers;
  atomic_int failed;           /**< a vxm_status */
  const unsigned char *slices; /**< at hand, begin..end-1 */
  int64_t begin, end;
  const vxm_node_maker *maker; /**< of nodes, whose layer at hand is begin..end-1, too */
  unsigned char *first;        /**< values of the first node */
  bool is_first_one;           /**< they are one value */
  vxm_task_progress progress;
  const vxm_node_entry *next; /**< in the end */
  const vxm_sparse *tree;     /**< in the end */
  vxm_value_bytes out;        /**< in the end, of a block */
};

/** Says why memory ran out, or VXM_OK. */
vxm_status vxm_octree_encoder_check(const vxm_octree_encoder *encoder, vxm_error *error);
/** Adds bytes; false if memory ran out, which is noted. */
bool vxm_octree_encoder_add(vxm_octree_encoder *encoder, vxm_value_bytes *to, const void *data, size_t size);

static inline bool vxm_octree_encoder_failed(const vxm_octree_encoder *encoder) {
  return atomic_load_explicit(&encoder->failed, memory_order_relaxed) != VXM_OK;
}

/**
 * Replaces what was added from `from` on, a 0 and the encoded children, by 1 and their value if that is one.
 *
 * @param alike all children have one value, and that of the first stands behind the first two bytes
 */
static inline void vxm_octree_encoder_unite(const vxm_octree_encoder *e, vxm_value_bytes *to, size_t from,
                                            bool alike) {
  if (!alike)
    return;
  memmove(to->data + from, to->data + from + 1, 1 + e->value_bytes);
  to->size = from + 1 + e->value_bytes;
}

/** Whether what was added from `from` on is one value, equal to the first that was added from `first` on. */
static inline bool vxm_octree_encoder_is_like(const vxm_octree_encoder *e, const vxm_value_bytes *b,
                                              size_t first, size_t from) {
  return b->data[first] == 1 && b->data[from] == 1 &&
         memcmp(b->data + first + 1, b->data + from + 1, e->value_bytes) == 0;
}

#endif
