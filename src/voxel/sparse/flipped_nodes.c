/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/sparse/flipped_nodes.h"
#include "base/bits.h"
#include "voxel/parity/kernels.h"

#include <string.h>

uint64_t vxm_flipped_nodes_bytes(size_t strips, int row_shift) {
  return strips * ((sizeof(uint32_t) << (row_shift - 4)) + 1);
}

vxm_status vxm_flipped_nodes_create(vxm_flipped_nodes *out, vxm_context *context, size_t strips,
                                    int row_shift, vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = (vxm_flipped_nodes){.context = context, .row_shift = row_shift};
  out->slots = vxm_try_calloc(context, strips << (row_shift - 4), sizeof *out->slots, &status, error);
  out->touched = out->slots ? vxm_try_calloc(context, strips, sizeof *out->touched, &status, error) : NULL;
  for (unsigned i = 0; i < 256; i++) {
    unsigned y = i >> 4, z = i & 15;
    out->places[i].row = (uint8_t)((y >> 2 & 1) | (z >> 1 & 2) | (y >> 1 & 4) | (z & 8));
    out->places[i].shift = (uint8_t)(16 * (z & 3) + 4 * (y & 3));
  }
  return status;
}

void vxm_flipped_nodes_destroy(vxm_flipped_nodes *nodes) {
  vxm_free(nodes->context, nodes->slots);
  vxm_free(nodes->context, nodes->touched);
  vxm_free(nodes->context, nodes->bricks);
  *nodes = (vxm_flipped_nodes){.context = nodes->context};
}

/** Finds a place for the bricks of a node. */
static __attribute__((noinline)) vxm_status add_node(vxm_flipped_nodes *nodes, size_t node) {
  if (nodes->count == nodes->capacity) {
    size_t before = nodes->capacity;
    if (nodes->count >= UINT32_MAX)
      return VXM_ERROR_MEMORY;
    vxm_status status = vxm_grow(nodes->context, (void **)&nodes->bricks, &nodes->capacity, before + 1,
                                 VXM_STRIP_BRICKS * sizeof *nodes->bricks, NULL);
    if (status != VXM_OK)
      return status;
    memset(nodes->bricks + VXM_STRIP_BRICKS * before, 0,
           VXM_STRIP_BRICKS * (nodes->capacity - before) * sizeof *nodes->bricks);
  }
  nodes->slots[node] = (uint32_t)++nodes->count;
  nodes->touched[node >> (nodes->row_shift - 4)] = 1;
  return VXM_OK;
}

/** What of a record is looked up while others are flipped. */
typedef struct flipping {
  vxm_flipped_nodes *nodes;
  int shift;
  uint64_t in_row;
  vxm_status status;
} flipping;

/** The node of a record, which has a place from now on unless memory runs out. */
static inline size_t find_node(flipping *f, uint64_t record) {
  size_t node = (size_t)((record >> (f->shift + 8)) << (f->shift - 4) | (record & f->in_row) >> 4);
  if (!f->nodes->slots[node] && f->status == VXM_OK)
    f->status = add_node(f->nodes, node);
  return node;
}

static inline void flip(flipping *f, uint64_t record) {
  vxm_flipped_nodes *nodes = f->nodes;
  uint64_t x = record & f->in_row;
  size_t node = find_node(f, record);
  if (f->status != VXM_OK)
    return;
  vxm_strip_place place = nodes->places[record >> f->shift & 255];
  uint64_t *bricks = nodes->bricks + (size_t)(nodes->slots[node] - 1) * VXM_STRIP_BRICKS;
  bricks[(x >> 2 & 3) * 16 + place.row] ^= (UINT64_C(15) << (x & 3) & 15) << place.shift;
}

static inline flipping begin(vxm_flipped_nodes *nodes) {
  return (flipping){nodes, nodes->row_shift, vxm_low_bits((unsigned)nodes->row_shift), VXM_OK};
}

vxm_status vxm_flipped_nodes_flip(vxm_flipped_nodes *nodes, const uint64_t *records, size_t count) {
  enum { SOME = 8 };
  const vxm_kernels *kernels = vxm_kernels_get();
  flipping f = begin(nodes);
  size_t i = 0;
  while (kernels->flip_nodes && count - i >= SOME && f.status == VXM_OK) {
    for (size_t k = i; k < i + SOME; k++)
      find_node(&f, records[k]);
    if (f.status == VXM_OK) /* as far as nodes have places */
      i += kernels->flip_nodes(nodes->bricks, nodes->slots, records + i, count - i, f.shift);
  }
  for (; i < count; i++)
    flip(&f, records[i]);
  return f.status;
}

vxm_status vxm_flipped_nodes_flip_bitmap(vxm_flipped_nodes *nodes, const uint64_t *words, size_t count) {
  flipping f = begin(nodes);
  for (size_t i = 0; i < count; i++)
    for (uint64_t left = words[i]; left; left &= left - 1)
      flip(&f, 64 * i + (unsigned)__builtin_ctzll(left));
  return f.status;
}

vxm_status vxm_flipped_nodes_flip_strip(vxm_flipped_nodes *nodes, const uint32_t *records, size_t count) {
  flipping f = begin(nodes);
  for (size_t i = 0; i < count; i++)
    flip(&f, records[i]);
  return f.status;
}
