/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_pieces.h"
#include "grid/octree_growth.h"

#include <stdlib.h>

/* ---- The list ---- */

static void add(vxm_octree_pieces *p, vxm_octree_piece piece) {
  if (p->status == VXM_OK)
    p->status =
        vxm_grow(p->context, (void **)&p->list, &p->capacity, p->count + 1, sizeof *p->list, p->error);
  if (p->status == VXM_OK)
    p->list[p->count++] = piece;
}

/** Of the brick with the voxel `at`. */
static uint64_t key_of(const int64_t at[3]) {
  return vxm_octree_morton(at[0] / 4, at[1] / 4, at[2] / 4);
}

void vxm_octree_pieces_brick(vxm_octree_pieces *p, const int64_t at[3], uint64_t bits) {
  for (int a = 0; a < 3; a++)
    if (at[a] < 0 || at[a] >= p->space.dims[a])
      return;
  bits &= vxm_octree_box(p->space.dims, at);
  if (bits)
    add(p, (vxm_octree_piece){key_of(at), bits, 1});
}

uint64_t vxm_octree_bits_within(const int64_t at[3], const int64_t begin[3], const int64_t end[3]) {
  uint64_t bits = 0;
  for (int b = 0; b < 64; b++) {
    const int64_t voxel[3] = {at[0] + b % 4, at[1] + b / 4 % 4, at[2] + b / 16};
    bool inside = true;
    for (int a = 0; a < 3; a++)
      inside &= voxel[a] >= begin[a] && voxel[a] < end[a];
    bits |= (uint64_t)inside << b;
  }
  return bits;
}

/** Adds what a box, which lies within the grid, has of a cube of voxels. */
static void add_box(vxm_octree_pieces *p, const int64_t at[3], int64_t side, const int64_t begin[3],
                    const int64_t end[3]) {
  bool whole = true;
  for (int a = 0; a < 3; a++) {
    if (at[a] >= end[a] || at[a] + side <= begin[a])
      return;
    whole &= at[a] >= begin[a] && at[a] + side <= end[a];
  }
  uint64_t bricks = (uint64_t)(side / 4);
  if (whole)
    add(p, (vxm_octree_piece){key_of(at), ~UINT64_C(0), bricks * bricks * bricks});
  else if (side == 4)
    add(p, (vxm_octree_piece){key_of(at), vxm_octree_bits_within(at, begin, end), 1});
  else
    for (unsigned child = 0; child < 64 && p->status == VXM_OK; child++) {
      int64_t place[3];
      vxm_octree_child_at(place, at, child, side / 4);
      add_box(p, place, side / 4, begin, end);
    }
}

void vxm_octree_pieces_box(vxm_octree_pieces *p, const int64_t begin[3], const int64_t end[3]) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = vxm_max(begin[a], 0);
    high[a] = vxm_min(end[a], p->space.dims[a]);
    if (low[a] >= high[a])
      return;
  }
  int64_t side = 4;
  while (side < high[0] || side < high[1] || side < high[2])
    side *= 4;
  add_box(p, (int64_t[3]){0, 0, 0}, side, low, high);
}

/** The words of a window's rows `y` to y + 15 of 16 slices from z on; those that it has not are 0.
 * @return the voxels that all of them have */
static uint64_t take_words(uint64_t words[256], const vxm_window *window, int64_t y, int64_t z, size_t word) {
  uint64_t all = ~UINT64_C(0);
  for (int64_t r = 0; r < 256; r++) {
    int64_t middle = y + r % 16, slow = z + r / 16;
    bool is_there = middle >= 0 && middle < window->middle_dim && slow >= window->begin && slow < window->end;
    words[r] = is_there ? vxm_window_row(window, middle, slow)[word] : 0;
    all &= words[r];
  }
  return all;
}

/** The bricks of 16 x 16 rows of words; from `at` on. */
static void add_words(vxm_octree_pieces *p, const uint64_t words[256], const int64_t at[3]) {
  for (int64_t b = 0; b < 16; b++) {
    const uint64_t *rows = words + 64 * (b / 4) + 4 * (b % 4);
    uint64_t any = 0;
    for (int r = 0; r < 16; r++)
      any |= rows[16 * (r / 4) + r % 4];
    for (int64_t x = 0; any; x++, any >>= 4) {
      uint64_t bits = 0;
      for (int r = 0; r < 16 && (any & 15); r++)
        bits |= (rows[16 * (r / 4) + r % 4] >> 4 * x & 15) << 4 * r;
      if (bits)
        vxm_octree_pieces_brick(p, (int64_t[3]){at[0] + 4 * x, at[1] + b % 4 * 4, at[2] + b / 4 * 4}, bits);
    }
  }
}

void vxm_octree_pieces_window(vxm_octree_pieces *p, const vxm_window *window, const int64_t first[3]) {
  uint64_t words[256];
  int64_t at[3];
  for (at[2] = (first[2] + window->begin) & -16; at[2] < first[2] + window->end; at[2] += 16)
    for (at[1] = first[1] & -16; at[1] < first[1] + window->middle_dim; at[1] += 16)
      for (size_t w = 0; w < window->row_words && p->status == VXM_OK; w++) {
        uint64_t all = take_words(words, window, at[1] - first[1], at[2] - first[2], w), full = 0;
        at[0] = first[0] + 64 * (int64_t)w;
        for (int64_t x = 0; x < 64; x += 16)
          if ((all >> x & 0xffff) == 0xffff) {
            full |= UINT64_C(0xffff) << x;
            vxm_octree_pieces_box(p, (int64_t[3]){at[0] + x, at[1], at[2]},
                                  (int64_t[3]){at[0] + x + 16, at[1] + 16, at[2] + 16});
          }
        for (int r = 0; r < 256; r++)
          words[r] &= ~full;
        add_words(p, words, at);
      }
}

/* ---- The octree ---- */

/** Larger ones first among those that begin at the same brick. */
static int compare(const void *a, const void *b) {
  const vxm_octree_piece *p = a, *q = b;
  if (p->key != q->key)
    return p->key < q->key ? -1 : 1;
  return p->bricks == q->bricks ? 0 : p->bricks > q->bricks ? -1 : 1;
}

typedef struct build {
  vxm_octree_growth growth;
  const vxm_octree_piece *at, *end; /**< still to be used */
} build;

/** Passes over the pieces within `bricks` bricks from a key on. */
static void skip(build *b, uint64_t key, uint64_t bricks) {
  while (b->at < b->end && b->at->key - key < bricks)
    b->at++;
}

static vxm_octree_state build_brick(build *b, uint64_t key) {
  uint64_t bits = 0;
  for (; b->at < b->end && b->at->key == key; b->at++)
    bits |= b->at->bits;
  return vxm_octree_growth_brick(&b->growth, bits);
}

/** The node of a level over the pieces from a key on. */
static vxm_octree_state build_node(build *b, int level, uint64_t key) {
  uint64_t mixed = 0, full = 0, bricks = UINT64_C(1) << 6 * level; /* of a child */
  size_t first = vxm_octree_growth_next(&b->growth, level);
  while (b->at < b->end && b->at->key - key < 64 * bricks) {
    uint64_t child = (b->at->key - key) / bricks, from = key + child * bricks;
    uint64_t whole = b->at->key == from && b->at->bits == ~UINT64_C(0) ? b->at->bricks : 0;
    vxm_octree_state cell = VXM_OCTREE_FULL;
    if (whole > bricks) { /* the root */
      skip(b, key, 64 * bricks);
      full = ~UINT64_C(0);
      break;
    }
    if (whole == bricks)
      skip(b, from, bricks);
    else
      cell = level > 0 ? build_node(b, level - 1, from) : build_brick(b, from);
    mixed |= (uint64_t)(cell == VXM_OCTREE_MIXED) << child;
    full |= (uint64_t)(cell == VXM_OCTREE_FULL) << child;
  }
  return vxm_octree_growth_node(&b->growth, level, mixed, full, first);
}

vxm_status vxm_octree_pieces_end(vxm_sparse **out, vxm_octree_pieces *p) {
  build b = {.growth.status = p->status};
  *out = NULL;
  if (p->status == VXM_OK) {
    if (p->count > 1)
      qsort(p->list, p->count, sizeof *p->list, compare);
    b.at = p->list;
    b.end = p->list + p->count;
    vxm_octree_growth_begin(&b.growth, p->context, &p->space, p->error);
    if (b.growth.status == VXM_OK)
      build_node(&b, b.growth.sparse->levels - 1, 0);
    vxm_octree_growth_end(out, &b.growth);
  }
  vxm_free(p->context, p->list);
  p->list = NULL;
  return b.growth.status;
}
