/* SPDX-License-Identifier: BSD-3-Clause */
/** Values of an octree in the making: nodes of level 0 are encoded while their values are there. */
#include "base/endian.h"
#include "base/threads.h"
#include "gridio/formats/octree/octree_encoder.h"

enum { SIDE = VXM_STRIP_VOXELS };

static void note(vxm_octree_encoder *e, vxm_status status) {
  if (status != VXM_OK)
    atomic_store_explicit(&e->failed, (int)status, memory_order_relaxed);
}

vxm_status vxm_octree_encoder_check(const vxm_octree_encoder *e, vxm_error *error) {
  vxm_status status = (vxm_status)atomic_load_explicit(&e->failed, memory_order_relaxed);
  if (status != VXM_OK)
    return vxm_fail(error, status,
                    "the memory for the octree's values ran out; raise the limit (--memlimit)");
  return vxm_octree_builder_check(&e->builder, error);
}

bool vxm_octree_encoder_add(vxm_octree_encoder *e, vxm_value_bytes *to, const void *data, size_t size) {
  vxm_status status = vxm_grow(e->context, (void **)&to->data, &to->capacity, to->size + size, 1, NULL);
  if (status != VXM_OK) {
    note(e, status);
    return false;
  }
  memcpy(to->data + to->size, data, size);
  to->size += size;
  return true;
}

static bool add_value(vxm_octree_encoder *e, vxm_value_bytes *to, const unsigned char *value) {
  unsigned char stored[VXM_OCTREE_VALUE_BYTES];
  vxm_octree_copy_value(stored, value, e->value_bytes, e->spec.channels);
  return vxm_octree_encoder_add(e, to, stored, e->value_bytes);
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

static void encode_brick(vxm_octree_encoder *e, vxm_value_bytes *to, const node *n, const int64_t brick[3],
                         uint64_t bits) {
  static const unsigned char varied = 0, uniform = 1;
  const unsigned char *first = NULL;
  bool alike = true;
  for (uint64_t left = bits; left && alike; left &= left - 1) {
    const unsigned char *value = value_of(e, n, brick, __builtin_ctzll(left));
    first = first ? first : value;
    alike = memcmp(first, value, e->value_bytes) == 0;
  }
  if (!vxm_octree_encoder_add(e, to, alike ? &uniform : &varied, 1))
    return;
  for (uint64_t left = alike ? bits & -bits : bits; left; left &= left - 1)
    if (!add_value(e, to, value_of(e, n, brick, __builtin_ctzll(left))))
      return;
}

/** Of the node at `at`, counted in nodes. */
static uint64_t key_of(const size_t at[3]) {
  return vxm_octree_morton((int64_t)at[0], (int64_t)at[1], (int64_t)at[2]);
}

static void add_entry(vxm_octree_encoder *e, vxm_node_room *room, uint64_t key, uint64_t at) {
  note(e, vxm_grow(e->context, (void **)&room->entries, &room->capacity, room->count + 1,
                   sizeof *room->entries, NULL));
  if (room->count < room->capacity)
    room->entries[room->count++] = (vxm_node_entry){key, at};
}

/** Encodes a node, whose bricks go to `bricks` in the order of vxm_strip_add_node. */
static void encode_node(vxm_octree_encoder *e, vxm_node_room *room, const node *n, uint64_t key,
                        uint64_t worker, uint64_t bricks[VXM_STRIP_BRICKS]) {
  static const unsigned char varied = 0;
  vxm_value_bytes *to = &room->values;
  size_t from = to->size, count = 0;
  bool alike = vxm_octree_encoder_add(e, to, &varied, 1);
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
    if (vxm_octree_encoder_failed(e))
      return;
    alike &= vxm_octree_encoder_is_like(e, to, from + 1, begin);
    count++;
  }
  vxm_octree_encoder_unite(e, to, from, alike && count > 0);
  add_entry(e, room, key, worker << VXM_WORKER_SHIFT | from);
}

static void fill_clear(const vxm_octree_encoder *e, unsigned char clear[SIDE * VXM_OCTREE_VALUE_BYTES]) {
  for (size_t v = 0; v < SIDE; v++)
    memcpy(clear + v * e->value_bytes, e->background, e->value_bytes);
}

/** Encodes a node unless it is empty; false if memory ran out. */
static bool put_node(vxm_octree_encoder *e, size_t worker, const node *n, const size_t at[3],
                     const unsigned char *clear) {
  uint64_t bricks[VXM_STRIP_BRICKS];
  if (is_empty(e, n, clear))
    return true;
  encode_node(e, &e->rooms[worker], n, key_of(at), worker, bricks);
  if (vxm_octree_encoder_failed(e))
    return false;
  vxm_strip_add_node(&e->builder, worker, at[0], bricks);
  return true;
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
  fill_clear(e, clear);
  for (size_t x = 0; (int64_t)x * SIDE < dims[0]; x++) {
    n.count[0] = vxm_min(SIDE, dims[0] - (int64_t)x * SIDE);
    n.first =
        e->slices + (z * SIDE - (size_t)e->begin) * n.slice + y * SIDE * n.row + x * SIDE * e->value_bytes;
    if (!put_node(e, (size_t)worker, &n, (size_t[3]){x, y, z}, clear))
      return;
  }
  vxm_strip_end(&e->builder, (size_t)worker, y, z);
}

/** Of distances and numbers the first value is the background, of others 0. */
static void take_background(vxm_octree_encoder *e, const unsigned char *first) {
  vxm_field_kind kind = e->spec.about->kind;
  if (kind == VXM_FIELD_DISTANCE || kind == VXM_FIELD_NUMBERS)
    memcpy(e->background, first, e->value_bytes);
}

vxm_status vxm_octree_encoder_put(vxm_octree_encoder *e, const unsigned char *values, int64_t begin,
                                  int64_t end, vxm_error *error) {
  if (begin == 0)
    take_background(e, values);
  e->slices = values;
  e->begin = begin;
  e->end = end;
  size_t deep = (size_t)((end - begin + SIDE - 1) / SIDE);
  vxm_parallel(e->context, deep * e->builder.across, put_strip, e);
  return vxm_octree_encoder_check(e, error);
}

/* ---- Values that are made in nodes ---- */

/** Encodes a node whose voxels have one value; such nodes share their bytes. */
static void put_one(vxm_octree_encoder *e, size_t worker, const unsigned char *value, const size_t at[3]) {
  static const unsigned char uniform = 1;
  vxm_node_room *room = &e->rooms[worker];
  if (memcmp(value, e->background, e->value_bytes) == 0)
    return;
  if (!room->has_one || memcmp(value, room->one, e->value_bytes) != 0) {
    room->one_at = worker << VXM_WORKER_SHIFT | room->values.size;
    memcpy(room->one, value, e->value_bytes);
    room->has_one =
        vxm_octree_encoder_add(e, &room->values, &uniform, 1) && add_value(e, &room->values, value);
  }
  add_entry(e, room, key_of(at), room->one_at);
  const int64_t first[3] = {(int64_t)at[0] * SIDE, (int64_t)at[1] * SIDE, (int64_t)at[2] * SIDE};
  uint64_t bricks[VXM_STRIP_BRICKS];
  bool whole = true;
  for (int a = 0; a < 3; a++)
    whole &= first[a] + SIDE <= e->space.dims[a];
  if (whole) {
    vxm_strip_add_full(&e->builder, worker, at[0], at[0] + 1);
    return;
  }
  for (int64_t b = 0; b < VXM_STRIP_BRICKS; b++) { /* in the order of vxm_strip_add_node */
    const int64_t y = (b & 1) | (b >> 1 & 2), z = (b >> 1 & 1) | (b >> 2 & 2);
    bricks[b] = vxm_octree_box(e->space.dims,
                               (int64_t[3]){first[0] + b / 16 * 4, first[1] + 4 * y, first[2] + 4 * z});
  }
  vxm_strip_add_node(&e->builder, worker, at[0], bricks);
}

static void make_row(size_t y, int worker, void *payload) {
  vxm_octree_encoder *e = payload;
  const vxm_node_maker *maker = e->maker;
  unsigned char clear[SIDE * VXM_OCTREE_VALUE_BYTES];
  int64_t at[3] = {0, (int64_t)y * SIDE, e->begin};
  node n = {.row = SIDE * e->value_bytes, .slice = (size_t)SIDE * SIDE * e->value_bytes};
  if (vxm_task_progress_stopped(&e->progress, worker))
    return;
  if (maker->boxes)
    vxm_node_boxes_begin_row(maker->boxes, worker, at[1]);
  fill_clear(e, clear);
  for (; at[0] < e->space.dims[0]; at[0] += SIDE) {
    const size_t place[3] = {(size_t)at[0] / SIDE, y, (size_t)at[2] / SIDE};
    bool is_first = at[0] + at[1] + at[2] == 0, is_one = e->is_first_one;
    n.first = is_first ? e->first : e->rooms[worker].node;
    if (!is_first)
      is_one = maker->make(maker->payload, worker, at, e->rooms[worker].node);
    for (int a = 0; a < 3; a++)
      n.count[a] = vxm_node_count(&e->space, at, a);
    if (is_one)
      put_one(e, (size_t)worker, n.first, place);
    else
      put_node(e, (size_t)worker, &n, place, clear);
    if (vxm_octree_encoder_failed(e))
      return;
  }
  vxm_strip_end(&e->builder, (size_t)worker, y, (size_t)e->begin / SIDE);
  vxm_task_progress_step(&e->progress);
}

static vxm_status make_room(vxm_octree_encoder *e, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  e->first = vxm_alloc(e->context, VXM_NODE_VOXELS, e->value_bytes, &local);
  for (size_t w = 0; w < e->workers && local.code == VXM_OK; w++)
    e->rooms[w].node = vxm_alloc(e->context, VXM_NODE_VOXELS, e->value_bytes, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** The first node, whose first value may be the background. */
static void make_first(vxm_octree_encoder *e) {
  static const int64_t origin[3] = {0, 0, 0};
  if (e->maker->boxes)
    vxm_node_boxes_begin_row(e->maker->boxes, 0, 0);
  e->is_first_one = e->maker->make(e->maker->payload, 0, origin, e->first);
  take_background(e, e->first);
}

vxm_status vxm_octree_encoder_make(vxm_octree_encoder *e, const vxm_node_maker *maker, vxm_error *error) {
  vxm_status status = make_room(e, error);
  e->maker = maker;
  if (status != VXM_OK)
    return status;
  vxm_task_progress_start(&e->progress, e->context, maker->phase, e->builder.across * e->builder.deep, error);
  for (e->begin = 0; e->begin < e->space.dims[2] && status == VXM_OK; e->begin = e->end) {
    e->end = vxm_min(e->begin + SIDE, e->space.dims[2]);
    if (maker->boxes)
      vxm_node_boxes_begin_layer(maker->boxes, e->begin);
    if (e->begin == 0)
      make_first(e);
    vxm_parallel(e->context, e->builder.across, make_row, e);
    status = e->progress.status == VXM_OK ? vxm_octree_encoder_check(e, error) : e->progress.status;
  }
  return status == VXM_OK ? vxm_task_progress_end(&e->progress) : status;
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
    vxm_free(e->context, e->rooms[w].node);
  }
  vxm_free(e->context, e->rooms);
  vxm_free(e->context, e->first);
  vxm_free(e->context, e->out.data);
  vxm_octree_builder_destroy(&e->builder);
  vxm_free(e->context, e);
}
