/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_build.h"
#include "base/threads.h"

#include <string.h>

/* ---- Memory ---- */

static void note_failure(vxm_octree_builder *builder, vxm_status status) {
  atomic_store_explicit(&builder->failed, (int)status, memory_order_relaxed);
}

/** Room in an arena; NULL if memory ran out. */
static void *room(vxm_octree_builder *builder, vxm_block_arena *arena, size_t bytes) {
  vxm_status failed = VXM_OK;
  void *data = vxm_block_arena_room(arena, builder->context, bytes, &failed);
  if (!data)
    note_failure(builder, failed);
  return data;
}

/** Puts what was added in the place of a strip. */
static void end_strip(vxm_octree_builder *builder, vxm_strip_arena *arena, vxm_strip *strip) {
  size_t bytes = arena->item_count * sizeof *arena->items;
  void *items = bytes > 0 ? room(builder, &arena->strips[builder->turn], bytes) : NULL;
  if (items) {
    memcpy(items, arena->items, bytes);
    vxm_block_arena_keep(&arena->strips[builder->turn], bytes);
  }
  *strip = (vxm_strip){items, items ? arena->item_count : 0};
  arena->item_count = 0;
}

vxm_status vxm_octree_builder_create(vxm_octree_builder *out, vxm_context *context, const vxm_space *space,
                                     vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = (vxm_octree_builder){.context = context, .space = *space};
  out->across = (size_t)((space->dims[1] + VXM_STRIP_VOXELS - 1) / VXM_STRIP_VOXELS);
  out->deep = (size_t)((space->dims[2] + VXM_STRIP_VOXELS - 1) / VXM_STRIP_VOXELS);
  out->workers = (size_t)vxm_context_threads(context);
  atomic_init(&out->failed, VXM_OK);
  out->strips = vxm_try_calloc(context, out->across * out->deep, sizeof *out->strips, &status, error);
  out->arenas =
      out->strips ? vxm_try_calloc(context, out->workers, sizeof *out->arenas, &status, error) : NULL;
  return status;
}

void vxm_octree_builder_destroy(vxm_octree_builder *builder) {
  for (size_t w = 0; builder->arenas && w < builder->workers; w++) {
    vxm_strip_arena *arena = &builder->arenas[w];
    vxm_block_arena_clear(&arena->bricks, builder->context);
    vxm_block_arena_clear(&arena->seeds, builder->context);
    vxm_block_arena_clear(&arena->strips[0], builder->context);
    vxm_block_arena_clear(&arena->strips[1], builder->context);
    vxm_free(builder->context, arena->items);
  }
  vxm_free(builder->context, builder->arenas);
  vxm_free(builder->context, builder->strips);
  *builder = (vxm_octree_builder){.context = builder->context};
}

vxm_status vxm_octree_builder_check(const vxm_octree_builder *builder, vxm_error *error) {
  vxm_status status = (vxm_status)atomic_load_explicit(&builder->failed, memory_order_relaxed);
  if (status == VXM_OK)
    return VXM_OK;
  return vxm_fail(error, status,
                  "the memory for the octree ran out; raise the limit (--memlimit) or lower the resolution "
                  "(-r)");
}

/* ---- Strips ---- */

/** Makes bits whose index has bit a set but not bit b change places with those that have b but not a; `mask`
 * has the former. */
static inline uint64_t swap_places(uint64_t word, unsigned shift, uint64_t mask) {
  uint64_t change = (word >> shift ^ word) & mask;
  return word ^ change ^ change << shift;
}

/** From the order of vxm_strip_add_node, whose index is y0 z0 y1 z1 x0 x1 from its lowest bit on, to Morton
 * order, x0 y0 z0 x1 y1 z1. */
static inline uint64_t morton_mask(uint64_t word) {
  word = swap_places(word, 1, UINT64_C(0x2222222222222222));  /* bits 0 and 1 of the index */
  word = swap_places(word, 3, UINT64_C(0x0a0a0a0a0a0a0a0a));  /* 0 and 2 */
  word = swap_places(word, 15, UINT64_C(0x0000aaaa0000aaaa)); /* 0 and 4 */
  return swap_places(word, 24, UINT64_C(0x00000000ff00ff00)); /* 3 and 5 */
}

/** Where the child of a Morton number stands in the order of vxm_strip_add_node. */
static inline unsigned plain_place(unsigned m) {
  return (m & 1) << 4 | (m >> 3 & 1) << 5 | (m >> 1 & 3) | (m >> 2 & 12);
}

static bool add_item(vxm_octree_builder *builder, size_t worker, vxm_strip_item item) {
  vxm_strip_arena *arena = &builder->arenas[worker];
  if (arena->item_count == arena->item_capacity) {
    vxm_status status = vxm_grow(builder->context, (void **)&arena->items, &arena->item_capacity,
                                 arena->item_count + 1, sizeof *arena->items, NULL);
    if (status != VXM_OK) {
      note_failure(builder, status);
      return false;
    }
  }
  arena->items[arena->item_count++] = item;
  return true;
}

void vxm_strip_add_full(vxm_octree_builder *builder, size_t worker, size_t begin, size_t end) {
  vxm_strip_arena *arena = &builder->arenas[worker];
  vxm_strip_item *last = arena->item_count > 0 ? &arena->items[arena->item_count - 1] : NULL;
  if (last && last->end == begin && last->seed.full == ~UINT64_C(0))
    last->end = (uint32_t)end;
  else
    add_item(builder, worker, (vxm_strip_item){(uint32_t)begin, (uint32_t)end, {0, ~UINT64_C(0), NULL}});
}

void vxm_strip_add_node(vxm_octree_builder *builder, size_t worker, size_t x,
                        const uint64_t bricks[VXM_STRIP_BRICKS]) {
  uint64_t set = 0, full = 0;
  for (int b = VXM_STRIP_BRICKS - 1; b >= 0; b--) {
    set = set << 1 | (bricks[b] != 0);
    full = full << 1 | (bricks[b] == ~UINT64_C(0));
  }
  vxm_strip_add_known(builder, worker, x, bricks, set, full);
}

void vxm_strip_add_known(vxm_octree_builder *builder, size_t worker, size_t x,
                         const uint64_t bricks[VXM_STRIP_BRICKS], uint64_t set, uint64_t full) {
  if (set == 0)
    return;
  if (full == ~UINT64_C(0)) {
    vxm_strip_add_full(builder, worker, x, x + 1);
    return;
  }
  vxm_block_arena *arena = &builder->arenas[worker].bricks;
  uint64_t *to = room(builder, arena, VXM_STRIP_BRICKS * sizeof *to);
  if (!to)
    return;
  vxm_seed seed = {morton_mask(set & ~full), morton_mask(full), to};
  size_t count = 0;
  for (uint64_t left = seed.mixed; left; left &= left - 1)
    to[count++] = bricks[plain_place((unsigned)__builtin_ctzll(left))];
  vxm_block_arena_keep(arena, count * sizeof *to);
  add_item(builder, worker, (vxm_strip_item){(uint32_t)x, (uint32_t)x + 1, seed});
}

void vxm_strip_end(vxm_octree_builder *builder, size_t worker, size_t y, size_t z) {
  end_strip(builder, &builder->arenas[worker], &builder->strips[z * builder->across + y]);
}

void vxm_strip_expand(const vxm_strip_item *item, uint64_t bricks[VXM_STRIP_BRICKS]) {
  const uint64_t *from = item->seed.children;
  for (unsigned m = 0; m < VXM_STRIP_BRICKS; m++) {
    bool mixed = item->seed.mixed >> m & 1;
    uint64_t bits = item->seed.full >> m & 1 ? ~UINT64_C(0) : 0;
    bricks[plain_place(m)] = mixed ? *from++ : bits;
  }
}

/* ---- From one level to the next ---- */

/** What is merged: strips of a level into those of the next. */
typedef struct merge_job {
  vxm_octree_builder *builder;
  const vxm_strip *below;
  size_t below_across, below_deep;
  vxm_strip *above;
  size_t across;
} merge_job;

typedef struct cursor {
  const vxm_strip_item *at, *end;
} cursor;

/** The node at x of the level above. */
static void merge_node(vxm_octree_builder *builder, size_t worker, cursor rows[16], uint32_t x) {
  vxm_seed seeds[64];
  uint64_t mixed = 0, full = 0;
  for (unsigned r = 0; r < 16; r++) {
    const vxm_strip_item *item = rows[r].at;
    for (; item < rows[r].end && item->begin < 4 * x + 4; item++) {
      uint32_t begin = item->begin > 4 * x ? item->begin - 4 * x : 0;
      uint32_t end = item->end < 4 * x + 4 ? item->end - 4 * x : 4;
      bool is_full = item->seed.full == ~UINT64_C(0);
      for (unsigned b = begin; b < end; b++) {
        full |= (uint64_t)is_full << (16 * b + r);
        mixed |= (uint64_t)!is_full << (16 * b + r);
        seeds[16 * b + r] = item->seed;
      }
      if (item->end > 4 * x + 4)
        break;
    }
    rows[r].at = item;
  }
  if (full == ~UINT64_C(0)) {
    vxm_strip_add_full(builder, worker, x, x + 1);
    return;
  }
  vxm_block_arena *arena = &builder->arenas[worker].seeds;
  vxm_seed *to = room(builder, arena, VXM_STRIP_BRICKS * sizeof *to);
  if (!to)
    return;
  vxm_seed seed = {morton_mask(mixed), morton_mask(full), to};
  size_t count = 0;
  for (uint64_t left = seed.mixed; left; left &= left - 1)
    to[count++] = seeds[plain_place((unsigned)__builtin_ctzll(left))];
  vxm_block_arena_keep(arena, count * sizeof *to);
  add_item(builder, worker, (vxm_strip_item){x, x + 1, seed});
}

/** The next node that is not empty, or the end of a run of full ones from it on. */
static bool next_nodes(const cursor rows[16], uint32_t from, uint32_t *begin, uint32_t *full_end) {
  uint32_t first = UINT32_MAX, end = UINT32_MAX;
  for (unsigned r = 0; r < 16; r++) {
    if (rows[r].at == rows[r].end)
      continue;
    uint32_t at = rows[r].at->begin > 4 * from ? rows[r].at->begin : 4 * from;
    first = at < first ? at : first;
  }
  if (first == UINT32_MAX)
    return false;
  *begin = first / 4;
  for (unsigned r = 0; r < 16; r++) {
    const vxm_strip_item *item = rows[r].at;
    bool covers = item < rows[r].end && item->seed.full == ~UINT64_C(0) && item->begin <= 4 * *begin;
    end = !covers ? 0 : item->end < end ? item->end : end;
  }
  *full_end = end / 4;
  return true;
}

static void merge_strip(size_t task, int worker, void *payload) {
  const merge_job *job = payload;
  size_t y = task % job->across, z = task / job->across, w = (size_t)worker;
  cursor rows[16] = {{NULL, NULL}};
  bool any = false;
  for (unsigned r = 0; r < 16; r++) {
    size_t by = 4 * y + (r & 1) + (r >> 1 & 2), bz = 4 * z + (r >> 1 & 1) + (r >> 2 & 2);
    if (by >= job->below_across || bz >= job->below_deep)
      continue;
    const vxm_strip *strip = &job->below[bz * job->below_across + by];
    rows[r] = (cursor){strip->items, strip->items ? strip->items + strip->count : NULL};
    any |= strip->items != NULL;
  }
  uint32_t begin, full_end;
  for (uint32_t from = 0; any && next_nodes(rows, from, &begin, &full_end);) {
    if (full_end <= begin) {
      merge_node(job->builder, w, rows, begin);
      from = begin + 1;
      continue;
    }
    vxm_strip_add_full(job->builder, w, begin, full_end);
    for (unsigned r = 0; r < 16; r++)
      rows[r].at += rows[r].at->end <= 4 * full_end;
    from = full_end;
  }
  end_strip(job->builder, &job->builder->arenas[w], &job->above[task]);
}

/** Drops the strips that were made last, or before those. */
static void drop_strips(vxm_octree_builder *builder, unsigned turn) {
  for (size_t w = 0; w < builder->workers; w++)
    vxm_block_arena_clear(&builder->arenas[w].strips[turn], builder->context);
}

/** Merges level after level until one strip of one node is left. */
static vxm_status merge_levels(vxm_octree_builder *builder, int levels, vxm_seed *root, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t across = builder->across, deep = builder->deep;
  for (int l = 1; l < levels && local.code == VXM_OK; l++) {
    merge_job job = {builder, builder->strips, across, deep, NULL, (across + 3) / 4};
    size_t count = job.across * ((deep + 3) / 4);
    job.above = vxm_alloc(builder->context, count, sizeof *job.above, &local);
    if (!job.above)
      break;
    builder->turn ^= 1;
    vxm_parallel(builder->context, count, merge_strip, &job);
    drop_strips(builder, builder->turn ^ 1);
    vxm_free(builder->context, builder->strips);
    builder->strips = job.above;
    across = job.across;
    deep = (deep + 3) / 4;
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  vxm_status status = local.code == VXM_OK ? vxm_octree_builder_check(builder, error) : local.code;
  *root = (vxm_seed){0, 0, NULL};
  if (status == VXM_OK && builder->strips->count > 0)
    *root = builder->strips->items->seed;
  drop_strips(builder, builder->turn);
  return status;
}

/* ---- All nodes in their places ---- */

enum { SHARES = 64 };

typedef struct spread_job {
  const vxm_seed *seeds; /**< of a level */
  vxm_octree_node *nodes;
  size_t count;
  void *below; /**< seeds of the level below, or bricks */
  size_t child_bytes;
  size_t first[SHARES + 1];
} spread_job;

static void count_children(size_t task, int worker, void *payload) {
  (void)worker;
  spread_job *job = payload;
  size_t children = 0, end = vxm_slice_begin(job->count, SHARES, task + 1);
  for (size_t n = vxm_slice_begin(job->count, SHARES, task); n < end; n++)
    children += (size_t)vxm_popcount(job->seeds[n].mixed);
  job->first[task + 1] = children;
}

static void spread_children(size_t task, int worker, void *payload) {
  (void)worker;
  spread_job *job = payload;
  size_t first = job->first[task], end = vxm_slice_begin(job->count, SHARES, task + 1);
  for (size_t n = vxm_slice_begin(job->count, SHARES, task); n < end; n++) {
    const vxm_seed *seed = &job->seeds[n];
    size_t children = (size_t)vxm_popcount(seed->mixed);
    job->nodes[n] = (vxm_octree_node){seed->mixed, seed->full, children > 0 ? first : 0};
    if (children > 0)
      memcpy((char *)job->below + first * job->child_bytes, seed->children, children * job->child_bytes);
    first += children;
  }
}

/** Makes the nodes of a level of its seeds, and gathers the level below. */
static vxm_status spread(vxm_sparse *sparse, int level, vxm_seed **seeds, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  spread_job job = {.seeds = *seeds, .count = sparse->node_count[level]};
  job.child_bytes = level > 0 ? sizeof(vxm_seed) : sizeof *sparse->bricks;
  sparse->nodes[level] = vxm_alloc(sparse->context, job.count, sizeof *job.nodes, &local);
  job.nodes = sparse->nodes[level];
  size_t children = 0;
  if (local.code == VXM_OK) {
    vxm_parallel(sparse->context, SHARES, count_children, &job);
    job.first[0] = 0;
    for (size_t s = 0; s < SHARES; s++)
      job.first[s + 1] += job.first[s];
    children = job.first[SHARES];
    job.below = vxm_alloc(sparse->context, children, job.child_bytes, &local);
  }
  if (local.code == VXM_OK)
    vxm_parallel(sparse->context, SHARES, spread_children, &job);
  else
    vxm_error_pass(error, &local);
  vxm_free(sparse->context, *seeds);
  *seeds = NULL;
  if (level > 0) {
    *seeds = job.below;
    sparse->node_count[level - 1] = children;
  } else {
    sparse->bricks = job.below;
    sparse->brick_count = children;
  }
  return local.code;
}

vxm_status vxm_octree_builder_end(vxm_sparse **out, vxm_octree_builder *builder, vxm_error *error) {
  vxm_sparse *sparse;
  vxm_status status = vxm_octree_new(&sparse, builder->context, &builder->space, error);
  *out = NULL;
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  vxm_seed *seeds = vxm_alloc(builder->context, 1, sizeof *seeds, &local);
  if (seeds)
    status = merge_levels(builder, sparse->levels, seeds, &local);
  sparse->node_count[sparse->levels - 1] = 1;
  for (int l = sparse->levels - 1; l >= 0 && local.code == VXM_OK; l--) {
    for (size_t w = 0; w < builder->workers && l == 0; w++) /* all are gathered */
      vxm_block_arena_clear(&builder->arenas[w].seeds, builder->context);
    status = spread(sparse, l, &seeds, &local);
  }
  vxm_free(builder->context, seeds);
  if (local.code != VXM_OK) {
    vxm_sparse_destroy(sparse);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = sparse;
  return status;
}
