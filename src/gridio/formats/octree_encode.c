/* SPDX-License-Identifier: BSD-3-Clause */
/** Values of an octree in the making: nodes of level 0 are encoded while their slices are there, and put
 * together in Morton order in the end. */
#include "base/endian.h"
#include "base/threads.h"
#include "grid/octree_build.h"
#include "gridio/formats/octree_values.h"

#include <inttypes.h>
#include <stdlib.h>

enum { SIDE = VXM_STRIP_VOXELS, WORKER_SHIFT = 48 };

/** Bytes that grow. */
typedef struct bytes {
  unsigned char *data;
  size_t size, capacity;
} bytes;

/** Where the values of a node of level 0 are. */
typedef struct entry {
  uint64_t key; /**< Morton number of the node */
  uint64_t at;  /**< the worker, above WORKER_SHIFT bits, and where its bytes begin */
} entry;

typedef struct worker_room {
  bytes values;
  entry *entries;
  size_t count, capacity;
} worker_room;

struct vxm_octree_encoder {
  vxm_context *context;
  vxm_space space;
  vxm_values_spec spec;
  size_t value_bytes;
  unsigned char background[VXM_OCTREE_VALUE_BYTES];
  vxm_octree_builder builder;
  worker_room *rooms;
  size_t workers;
  atomic_int failed;           /**< a vxm_status */
  const unsigned char *slices; /**< at hand, begin..end-1 */
  int64_t begin, end;
  const entry *next;      /**< in the end */
  const vxm_sparse *tree; /**< in the end */
  bytes out;              /**< in the end, of a block */
};

static void note(vxm_octree_encoder *e, vxm_status status) {
  if (status != VXM_OK)
    atomic_store_explicit(&e->failed, (int)status, memory_order_relaxed);
}

static vxm_status check(const vxm_octree_encoder *e, vxm_error *error) {
  vxm_status status = (vxm_status)atomic_load_explicit(&e->failed, memory_order_relaxed);
  if (status != VXM_OK)
    return vxm_fail(error, status,
                    "the memory for the octree's values ran out; raise the limit (--memlimit)");
  return vxm_octree_builder_check(&e->builder, error);
}

/** Adds bytes, or room for them; false if memory ran out. */
static bool add(vxm_octree_encoder *e, bytes *to, const void *data, size_t size) {
  vxm_status status = vxm_grow(e->context, (void **)&to->data, &to->capacity, to->size + size, 1, NULL);
  if (status != VXM_OK) {
    note(e, status);
    return false;
  }
  memcpy(to->data + to->size, data, size);
  to->size += size;
  return true;
}

static bool add_value(vxm_octree_encoder *e, bytes *to, const unsigned char *value) {
  unsigned char stored[VXM_OCTREE_VALUE_BYTES];
  vxm_octree_copy_value(stored, value, e->value_bytes, e->spec.channels);
  return add(e, to, stored, e->value_bytes);
}

/**
 * Replaces what was added from `from` on, a 0 and the encoded children, by 1 and their value if that is one.
 *
 * @param alike all children have one value, and that of the first stands behind the first two bytes
 */
static void unite(const vxm_octree_encoder *e, bytes *to, size_t from, bool alike) {
  if (!alike)
    return;
  memmove(to->data + from, to->data + from + 1, 1 + e->value_bytes);
  to->size = from + 1 + e->value_bytes;
}

/** Whether what was added from `from` on is one value, equal to the first that was added from `first` on. */
static bool is_like(const vxm_octree_encoder *e, const bytes *b, size_t first, size_t from) {
  return b->data[first] == 1 && b->data[from] == 1 &&
         memcmp(b->data + first + 1, b->data + from + 1, e->value_bytes) == 0;
}

/* ---- A node of level 0 ---- */

/** What a node has, in the order of slices: rows of values, and their number along each axis. */
typedef struct node {
  const unsigned char *first;
  size_t row, slice; /**< bytes */
  int64_t count[3];
} node;

static bool is_empty(const vxm_octree_encoder *e, const node *n, const unsigned char *clear) {
  for (int64_t z = 0; z < n->count[2]; z++)
    for (int64_t y = 0; y < n->count[1]; y++)
      if (memcmp(n->first + (size_t)z * n->slice + (size_t)y * n->row, clear,
                 (size_t)n->count[0] * e->value_bytes) != 0)
        return false;
  return true;
}

static inline const unsigned char *value_at(const node *n, int64_t x, int64_t y, int64_t z, size_t size) {
  return n->first + (size_t)z * n->slice + (size_t)y * n->row + (size_t)x * size;
}

/** Voxels of a brick that are not the background; `size` is that of a value, a constant where this is
 * inlined. */
static inline uint64_t bits_sized(const vxm_octree_encoder *e, const node *n, const int64_t brick[3],
                                  size_t size) {
  uint64_t bits = 0;
  int64_t end[3];
  for (int a = 0; a < 3; a++)
    end[a] = vxm_min(4 * brick[a] + 4, n->count[a]);
  for (int64_t z = 4 * brick[2]; z < end[2]; z++)
    for (int64_t y = 4 * brick[1]; y < end[1]; y++)
      for (int64_t x = 4 * brick[0]; x < end[0]; x++)
        bits |= (uint64_t)(memcmp(value_at(n, x, y, z, size), e->background, size) != 0)
                << vxm_octree_bit(x, y, z);
  return bits;
}

static uint64_t bits_of(const vxm_octree_encoder *e, const node *n, const int64_t brick[3]) {
  switch (e->value_bytes) {
  case 1:
    return bits_sized(e, n, brick, 1);
  case 2:
    return bits_sized(e, n, brick, 2);
  case 4:
    return bits_sized(e, n, brick, 4);
  default:
    return bits_sized(e, n, brick, 8);
  }
}

/** The value of a bit of a brick. */
static const unsigned char *value_of(const vxm_octree_encoder *e, const node *n, const int64_t brick[3],
                                     int bit) {
  return value_at(n, 4 * brick[0] + bit % 4, 4 * brick[1] + bit / 4 % 4, 4 * brick[2] + bit / 16,
                  e->value_bytes);
}

static void encode_brick(vxm_octree_encoder *e, bytes *to, const node *n, const int64_t brick[3],
                         uint64_t bits) {
  static const unsigned char varied = 0, uniform = 1;
  const unsigned char *first = NULL;
  bool alike = true;
  for (uint64_t left = bits; left && alike; left &= left - 1) {
    const unsigned char *value = value_of(e, n, brick, __builtin_ctzll(left));
    first = first ? first : value;
    alike = memcmp(first, value, e->value_bytes) == 0;
  }
  if (!add(e, to, alike ? &uniform : &varied, 1))
    return;
  for (uint64_t left = alike ? bits & -bits : bits; left; left &= left - 1)
    if (!add_value(e, to, value_of(e, n, brick, __builtin_ctzll(left))))
      return;
}

static uint64_t morton(uint64_t x, uint64_t y, uint64_t z) {
  uint64_t key = 0;
  for (int b = 0; b < 16; b++)
    key |= (x >> b & 1) << 3 * b | (y >> b & 1) << (3 * b + 1) | (z >> b & 1) << (3 * b + 2);
  return key;
}

/** Encodes a node, whose bricks go to `bricks` in the order of vxm_strip_add_node. */
static void encode_node(vxm_octree_encoder *e, worker_room *room, const node *n, uint64_t key,
                        uint64_t worker, uint64_t bricks[VXM_STRIP_BRICKS]) {
  static const unsigned char varied = 0;
  bytes *to = &room->values;
  size_t from = to->size, count = 0;
  bool alike = add(e, to, &varied, 1);
  for (unsigned child = 0; child < 64; child++) {
    int64_t brick[3];
    vxm_octree_place(child, brick);
    uint64_t bits = bits_of(e, n, brick);
    size_t row = (size_t)((brick[1] & 1) | (brick[2] & 1) << 1 | (brick[1] & 2) << 1 | (brick[2] & 2) << 2);
    bricks[16 * (size_t)brick[0] + row] = bits;
    if (bits == 0)
      continue;
    size_t begin = to->size;
    encode_brick(e, to, n, brick, bits);
    if (atomic_load_explicit(&e->failed, memory_order_relaxed) != VXM_OK)
      return;
    alike &= is_like(e, to, from + 1, begin);
    count++;
  }
  unite(e, to, from, alike && count > 0);
  note(e, vxm_grow(e->context, (void **)&room->entries, &room->capacity, room->count + 1,
                   sizeof *room->entries, NULL));
  if (room->count < room->capacity)
    room->entries[room->count++] = (entry){key, worker << WORKER_SHIFT | from};
}

static void put_strip(size_t task, int worker, void *payload) {
  vxm_octree_encoder *e = payload;
  const int64_t *dims = e->space.dims;
  unsigned char clear[SIDE * VXM_OCTREE_VALUE_BYTES];
  size_t y = task % e->builder.across, z = (size_t)e->begin / SIDE + task / e->builder.across;
  node n = {.row = (size_t)dims[0] * e->value_bytes};
  n.slice = n.row * (size_t)dims[1];
  n.count[1] = vxm_min(SIDE, dims[1] - (int64_t)y * SIDE);
  n.count[2] = vxm_min(SIDE, e->end - (int64_t)z * SIDE);
  for (size_t v = 0; v < SIDE; v++)
    memcpy(clear + v * e->value_bytes, e->background, e->value_bytes);
  for (size_t x = 0; (int64_t)x * SIDE < dims[0]; x++) {
    uint64_t bricks[VXM_STRIP_BRICKS];
    n.count[0] = vxm_min(SIDE, dims[0] - (int64_t)x * SIDE);
    n.first =
        e->slices + (z * SIDE - (size_t)e->begin) * n.slice + y * SIDE * n.row + x * SIDE * e->value_bytes;
    if (is_empty(e, &n, clear))
      continue;
    encode_node(e, &e->rooms[worker], &n, morton(x, y, z), (uint64_t)worker, bricks);
    if (atomic_load_explicit(&e->failed, memory_order_relaxed) != VXM_OK)
      return;
    vxm_strip_add_node(&e->builder, (size_t)worker, x, bricks);
  }
  vxm_strip_end(&e->builder, (size_t)worker, y, z);
}

vxm_status vxm_octree_encoder_put(vxm_octree_encoder *e, const unsigned char *values, int64_t begin,
                                  int64_t end, vxm_error *error) {
  vxm_field_kind kind = e->spec.about->kind;
  if (begin == 0 && (kind == VXM_FIELD_DISTANCE || kind == VXM_FIELD_NUMBERS)) /* of others it is 0 */
    memcpy(e->background, values, e->value_bytes);
  e->slices = values;
  e->begin = begin;
  e->end = end;
  size_t deep = (size_t)((end - begin + SIDE - 1) / SIDE);
  vxm_parallel(e->context, deep * e->builder.across, put_strip, e);
  return check(e, error);
}

/* ---- All of it ---- */

vxm_status vxm_octree_encoder_create(vxm_octree_encoder **out, vxm_context *context, const vxm_space *space,
                                     const vxm_values_spec *spec, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_octree_encoder *e = vxm_calloc(context, 1, sizeof *e, &local);
  *out = e;
  if (e) {
    e->context = e->builder.context = context;
    e->space = *space;
    e->spec = *spec;
    e->value_bytes = vxm_scalar_bytes(spec->scalar) * (size_t)spec->channels;
    e->workers = (size_t)vxm_context_threads(context);
    e->rooms = vxm_calloc(context, e->workers, sizeof *e->rooms, &local);
  }
  if (local.code == VXM_OK)
    vxm_octree_builder_create(&e->builder, context, space, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

void vxm_octree_encoder_destroy(vxm_octree_encoder *e) {
  if (!e)
    return;
  for (size_t w = 0; e->rooms && w < e->workers; w++) {
    vxm_free(e->context, e->rooms[w].values.data);
    vxm_free(e->context, e->rooms[w].entries);
  }
  vxm_free(e->context, e->rooms);
  vxm_free(e->context, e->out.data);
  vxm_octree_builder_destroy(&e->builder);
  vxm_free(e->context, e);
}

static int compare(const void *a, const void *b) {
  const entry *p = a, *q = b;
  return p->key < q->key ? -1 : p->key > q->key;
}

/** All entries in Morton order. */
static vxm_status gather(entry **out, vxm_octree_encoder *e, vxm_error *error) {
  size_t count = 0, at = 0;
  vxm_error local = VXM_ERROR_INIT;
  for (size_t w = 0; w < e->workers; w++)
    count += e->rooms[w].count;
  entry *all = vxm_alloc(e->context, count, sizeof *all, &local);
  *out = all;
  if (!all) {
    if (local.code != VXM_OK)
      vxm_error_pass(error, &local);
    return local.code;
  }
  for (size_t w = 0; w < e->workers; w++) {
    if (e->rooms[w].count > 0)
      memcpy(all + at, e->rooms[w].entries, e->rooms[w].count * sizeof *all);
    at += e->rooms[w].count;
    vxm_free(e->context, e->rooms[w].entries);
    e->rooms[w].entries = NULL;
  }
  if (count > 1)
    qsort(all, count, sizeof *all, compare);
  return VXM_OK;
}

/** How many bytes the encoded part of a tree takes at `data`, of a node of level 0. */
static size_t node_bytes(const vxm_octree_encoder *e, vxm_octree_part part, const unsigned char *data) {
  const unsigned char *at = data + 1;
  if (*data == 1)
    return 1 + e->value_bytes;
  for (uint64_t left = vxm_octree_children(e->tree, 0, part); left; left &= left - 1) {
    vxm_octree_part brick = vxm_octree_child_part(e->tree, 0, part, (unsigned)__builtin_ctzll(left));
    uint64_t bits = brick.kind == VXM_CELL_MIXED ? e->tree->bricks[brick.index] : ~UINT64_C(0);
    at += 1 + (*at == 1 ? 1 : (size_t)vxm_popcount(bits)) * e->value_bytes;
  }
  return (size_t)(at - data);
}

/** Puts a part together out of the nodes that are next. */
static void encode_part(vxm_octree_encoder *e, int level, vxm_octree_part part) {
  static const unsigned char varied = 0;
  if (level == 0) {
    uint64_t at = e->next++->at;
    const unsigned char *data =
        e->rooms[at >> WORKER_SHIFT].values.data + (at & ((UINT64_C(1) << WORKER_SHIFT) - 1));
    add(e, &e->out, data, node_bytes(e, part, data));
    return;
  }
  size_t from = e->out.size;
  bool alike = add(e, &e->out, &varied, 1);
  for (uint64_t left = vxm_octree_children(e->tree, level, part); left; left &= left - 1) {
    size_t begin = e->out.size;
    encode_part(e, level - 1, vxm_octree_child_part(e->tree, level, part, (unsigned)__builtin_ctzll(left)));
    if (atomic_load_explicit(&e->failed, memory_order_relaxed) != VXM_OK)
      return;
    alike &= is_like(e, &e->out, from + 1, begin);
  }
  unite(e, &e->out, from, alike);
}

/** Blocks are measured first, since where they begin stands before them, and then written. */
typedef struct pass {
  vxm_octree_encoder *e;
  vxm_output *output; /**< NULL = measure */
  uint64_t *ends;
  uint64_t end;
} pass;

static bool do_block(uint64_t number, const int64_t at[3], void *payload) {
  pass *p = payload;
  vxm_octree_encoder *e = p->e;
  int level = vxm_octree_tile_level(e->tree->levels);
  e->out.size = 0;
  encode_part(e, level, vxm_octree_part_at(e->tree, level, at));
  if (atomic_load_explicit(&e->failed, memory_order_relaxed) != VXM_OK)
    return false;
  p->end += e->out.size;
  if (p->output)
    vxm_output_write(p->output, e->out.data, e->out.size);
  else
    p->ends[number] = p->end;
  return true;
}

static bool skip(uint64_t number, const int64_t at[3], void *payload) {
  (void)number;
  (void)at;
  (void)payload;
  return true;
}

static void put_header(const vxm_octree_encoder *e, vxm_output *output, uint64_t blocks) {
  unsigned char text[40] = {0};
  const vxm_about *about = e->spec.about;
  const char *kind = about->is_declared ? vxm_field_kind_name(about->kind) : "";
  memcpy(text, kind, strlen(kind));
  memcpy(text + 16, vxm_scalar_name(e->spec.scalar), strlen(vxm_scalar_name(e->spec.scalar)));
  vxm_store_le64(text + 24, (uint64_t)e->spec.channels);
  vxm_octree_copy_value(text + VXM_OCTREE_BACKGROUND, e->background, e->value_bytes, e->spec.channels);
  vxm_output_write(output, text, sizeof text);
  vxm_octree_put_word(output, blocks);
  vxm_octree_put_word(output, 0);
}

static vxm_status put_all(vxm_octree_encoder *e, vxm_output *output, const entry *entries, uint64_t begin,
                          vxm_error *error) {
  const int64_t origin[3] = {0, 0, 0};
  vxm_error local = VXM_ERROR_INIT;
  uint64_t blocks = vxm_octree_each_block(e->tree->nodes, e->tree->levels, origin, origin, skip, NULL);
  pass p = {.e = e, .end = begin + VXM_OCTREE_VALUES_HEADER + 8 * (blocks + 1)};
  p.ends = vxm_alloc(e->context, (size_t)blocks + 1, sizeof *p.ends, &local);
  if (!p.ends) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  uint64_t first = p.end;
  for (int turn = 0; turn < 2; turn++) {
    e->next = entries;
    vxm_octree_each_block(e->tree->nodes, e->tree->levels, origin, e->space.dims, do_block, &p);
    if (check(e, &local) != VXM_OK || p.output)
      break;
    put_header(e, output, blocks);
    vxm_octree_put_word(output, first);
    for (uint64_t b = 0; b < blocks; b++)
      vxm_octree_put_word(output, p.ends[b]);
    p.output = output;
  }
  vxm_free(e->context, p.ends);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_octree_encoder_end(vxm_octree_encoder *e, vxm_output *output, vxm_error *error) {
  vxm_sparse *tree;
  entry *entries = NULL;
  uint64_t begin;
  vxm_status status = vxm_octree_builder_end(&tree, &e->builder, error);
  if (status != VXM_OK)
    return status;
  e->tree = tree;
  status = gather(&entries, e, error);
  if (status == VXM_OK)
    status = vxm_octree_file_put(output, tree, &begin, error);
  if (status == VXM_OK)
    status = put_all(e, output, entries, begin, error);
  vxm_free(e->context, entries);
  vxm_sparse_destroy(tree);
  e->tree = NULL;
  return status;
}
