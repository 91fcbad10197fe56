/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb_tree.h"
#include "base/bits.h"
#include "base/endian.h"
#include "gridio/common/format.h"
#include "gridio/formats/vdb_values.h"

#include <inttypes.h>

/** Nodes of two levels over leaves, by voxels along them and children along them. */
enum { LEAF = 8, LOWER = 128, UPPER = 4096, LEAF_WORDS = LEAF * LEAF * LEAF / 64 };

typedef struct level {
  int64_t side;       /**< of a node */
  unsigned log2_dim;  /**< of its children along an axis */
  int64_t child_side; /**< of a child or tile */
} level;

static const level levels[] = {{LOWER, 4, LEAF}, {UPPER, 5, LOWER}};

/** One way through a tree. */
typedef struct walk {
  vxm_vdb_values values;
  size_t at;              /**< in the nodes */
  vxm_vdb_extent *extent; /**< to be measured; NULL = values are read */
  const vxm_vdb_visitor *visitor;
  size_t leaf_at; /**< in the values of leaves */
  uint64_t leaves, all_leaves;
  struct room {
    float lower[16 * 16 * 16], upper[32 * 32 * 32], leaf[512];
    struct vxm_vdb_room unpacking;
  } * room;
} walk;

static const unsigned char *take(walk *w, size_t *at, size_t size) {
  const vxm_input *input = w->values.input;
  const unsigned char *bytes = input->data + *at;
  if (input->size - *at < size) {
    vxm_fail_byte(w->values.error, input, input->size, "the file is cut short");
    return NULL;
  }
  *at += size;
  return bytes;
}

static vxm_status fail(const walk *w, size_t at, const char *what) {
  return vxm_fail_byte(w->values.error, w->values.input, at, "%s", what);
}

static bool take_mask(walk *w, size_t *at, uint64_t *mask, size_t words) {
  const unsigned char *bytes = take(w, at, 8 * words);
  for (size_t i = 0; bytes && i < words; i++)
    mask[i] = vxm_load_le64(bytes + 8 * i);
  return bytes != NULL;
}

/* ---- What is set ---- */

static bool is_float(const walk *w) {
  return w->values.grid->type == VXM_VDB_TYPE_FLOAT;
}

static void include(vxm_vdb_extent *e, const int64_t low[3], const int64_t high[3]) {
  for (int a = 0; a < 3; a++) {
    e->low[a] = e->is_empty ? low[a] : vxm_min(e->low[a], low[a]);
    e->high[a] = e->is_empty ? high[a] : vxm_max(e->high[a], high[a]);
  }
  e->is_empty = false;
}

static void tile(walk *w, const int64_t at[3], int64_t side, float value, bool is_active) {
  if (w->extent && is_active)
    include(w->extent, at, (int64_t[3]){at[0] + side - 1, at[1] + side - 1, at[2] + side - 1});
  if (w->extent)
    return;
  if (is_float(w)) {
    if (value != w->values.background)
      w->visitor->number(at, side, value, w->visitor->payload);
  } else if (is_active && (w->values.grid->type == VXM_VDB_TYPE_MASK || value != 0))
    w->visitor->cube(at, side, w->visitor->payload);
}

/* ---- Leaves ---- */

static void measure_leaf(walk *w, const int64_t at[3], const uint64_t mask[LEAF_WORDS]) {
  uint64_t any = 0;
  int64_t low[3] = {LEAF, 0, 0}, high[3] = {0, 0, 0};
  for (int64_t x = 0; x < LEAF; x++)
    if (mask[x]) {
      any |= mask[x];
      low[0] = vxm_min(low[0], x);
      high[0] = x;
    }
  if (any == 0)
    return;
  /* Bits 8 y + z of all x: bytes tell y, the sum of all bytes z. */
  uint64_t z = any | any >> 32;
  z |= z >> 16;
  z = (z | z >> 8) & 0xff;
  low[1] = __builtin_ctzll(any) / 8;
  high[1] = (63 - __builtin_clzll(any)) / 8;
  low[2] = __builtin_ctzll(z);
  high[2] = 63 - __builtin_clzll(z);
  for (int a = 0; a < 3; a++) {
    low[a] += at[a];
    high[a] += at[a];
  }
  include(w->extent, low, high);
}

/** Leaves of bool and mask repeat where they are. */
static vxm_status check_origin(walk *w, const int64_t at[3]) {
  size_t begin = w->leaf_at;
  const unsigned char *origin = take(w, &w->leaf_at, 12);
  if (!origin)
    return VXM_ERROR_FORMAT;
  for (int a = 0; a < 3; a++)
    if ((int32_t)vxm_load_le32(origin + 4 * a) != at[a])
      return fail(w, begin, "the place of a leaf is damaged");
  return VXM_OK;
}

static vxm_status read_numbers(walk *w, const int64_t at[3], const uint64_t mask[LEAF_WORDS]) {
  vxm_status status = vxm_vdb_values_read(&w->values, &w->leaf_at, mask, 512, w->room->leaf);
  if (status == VXM_OK)
    w->visitor->numbers(at, w->room->leaf, w->visitor->payload);
  return status;
}

static vxm_status read_leaf(walk *w, const int64_t at[3]) {
  uint64_t mask[LEAF_WORDS], bits[LEAF_WORDS] = {0};
  if (!take_mask(w, &w->leaf_at, mask, LEAF_WORDS))
    return VXM_ERROR_FORMAT;
  if (is_float(w))
    return read_numbers(w, at, mask);
  vxm_status status = check_origin(w, at);
  bool is_mask = w->values.grid->type == VXM_VDB_TYPE_MASK;
  if (status == VXM_OK && !is_mask && !take_mask(w, &w->leaf_at, bits, LEAF_WORDS))
    status = VXM_ERROR_FORMAT;
  for (int x = 0; x < LEAF_WORDS; x++)
    bits[x] = is_mask ? mask[x] : bits[x] & mask[x];
  if (status == VXM_OK)
    w->visitor->block(at, bits, w->visitor->payload);
  return status;
}

static vxm_status leaf(walk *w, const int64_t at[3]) {
  enum { LEAVES_PER_REPORT = 1 << 14 };
  uint64_t mask[LEAF_WORDS];
  if (!take_mask(w, &w->at, mask, LEAF_WORDS))
    return VXM_ERROR_FORMAT;
  w->leaves++;
  if (w->extent) {
    measure_leaf(w, at, mask);
    return VXM_OK;
  }
  vxm_status status = read_leaf(w, at);
  if (status == VXM_OK && w->leaves % LEAVES_PER_REPORT == 0)
    status = vxm_progress(w->values.input->context, "reading", (double)w->leaves / (double)w->all_leaves,
                          w->values.error);
  return status;
}

/* ---- Nodes ---- */

static void place_of(int64_t out[3], const int64_t at[3], const level *l, size_t index) {
  size_t low = ((size_t)1 << l->log2_dim) - 1;
  out[0] = at[0] + (int64_t)(index >> 2 * l->log2_dim) * l->child_side;
  out[1] = at[1] + (int64_t)(index >> l->log2_dim & low) * l->child_side;
  out[2] = at[2] + (int64_t)(index & low) * l->child_side;
}

static vxm_status node(walk *w, const int64_t at[3], int depth) {
  const level *l = &levels[depth];
  size_t count = (size_t)1 << 3 * l->log2_dim, begin = w->at;
  uint64_t children[VXM_VDB_NODE_MAX / 64], active[VXM_VDB_NODE_MAX / 64];
  float *values = w->extent ? NULL : depth == 0 ? w->room->lower : w->room->upper;
  int64_t place[3];
  if (!take_mask(w, &w->at, children, count / 64) || !take_mask(w, &w->at, active, count / 64))
    return VXM_ERROR_FORMAT;
  for (size_t word = 0; word < count / 64; word++)
    if (children[word] & active[word])
      return fail(w, begin, "the masks of a node are damaged");
  vxm_status status = vxm_vdb_values_read(&w->values, &w->at, active, count, values);
  for (size_t i = 0; i < count && status == VXM_OK; i++) {
    bool is_active = active[i / 64] >> (i % 64) & 1;
    if (children[i / 64] >> (i % 64) & 1 || !(is_active || values))
      continue;
    place_of(place, at, l, i);
    tile(w, place, l->child_side, values ? values[i] : 0, is_active);
  }
  for (size_t word = 0; word < count / 64; word++)
    for (uint64_t left = children[word]; left && status == VXM_OK; left &= left - 1) {
      place_of(place, at, l, 64 * word + (size_t)__builtin_ctzll(left));
      status = depth == 0 ? leaf(w, place) : node(w, place, depth - 1);
    }
  return status;
}

/** Coordinates of what the root holds: ascending, so that nothing comes twice. */
static vxm_status take_place(walk *w, int64_t place[3], bool is_first) {
  const int64_t farthest = INT64_C(1) << 30;
  size_t begin = w->at;
  int64_t before[3] = {place[0], place[1], place[2]};
  const unsigned char *bytes = take(w, &w->at, 12);
  if (!bytes)
    return VXM_ERROR_FORMAT;
  bool is_sound = true;
  for (int a = 0; a < 3; a++) {
    place[a] = (int32_t)vxm_load_le32(bytes + 4 * a);
    is_sound = is_sound && place[a] % UPPER == 0 && place[a] >= -farthest && place[a] <= farthest;
  }
  int a = 0;
  while (a < 2 && place[a] == before[a])
    a++;
  if (!is_sound || !(is_first || place[a] > before[a]))
    return fail(w, begin, "the place of a node is damaged, or beyond 2^30 voxels");
  return VXM_OK;
}

static vxm_status root_tile(walk *w, int64_t place[3], bool is_first) {
  vxm_status status = take_place(w, place, is_first);
  size_t size = vxm_vdb_value_bytes(w->values.grid), begin = w->at;
  const unsigned char *bytes = status == VXM_OK ? take(w, &w->at, size + 1) : NULL;
  if (!bytes)
    return VXM_ERROR_FORMAT;
  if (bytes[size] > 1)
    return fail(w, begin + size, "a tile is damaged");
  tile(w, place, UPPER, vxm_vdb_value_at(w->values.grid, bytes), bytes[size] == 1);
  return VXM_OK;
}

static vxm_status root(walk *w) {
  size_t size = vxm_vdb_value_bytes(w->values.grid), begin = w->at;
  const unsigned char *head = take(w, &w->at, 4 + size + 8);
  if (!head)
    return VXM_ERROR_FORMAT;
  if (vxm_load_le32(head) != 1)
    return fail(w, begin, "the number of buffers of the tree is not 1");
  w->values.background = vxm_vdb_value_at(w->values.grid, head + 4);
  uint32_t tiles = vxm_load_le32(head + 4 + size), children = vxm_load_le32(head + 4 + size + 4);
  int64_t place[3] = {0, 0, 0};
  vxm_status status = VXM_OK;
  for (uint32_t t = 0; t < tiles && status == VXM_OK; t++)
    status = root_tile(w, place, t == 0);
  for (uint32_t c = 0; c < children && status == VXM_OK; c++) {
    status = take_place(w, place, c == 0);
    if (status == VXM_OK)
      status = node(w, place, 1);
  }
  return status;
}

/* ---- The two ways ---- */

static walk walk_of(const vxm_vdb_grid *grid, const vxm_input *input, vxm_error *error) {
  return (walk){.values = {.input = input, .grid = grid, .error = error}, .at = grid->tree};
}

vxm_status vxm_vdb_tree_measure(vxm_vdb_extent *out, const vxm_vdb_grid *grid, const vxm_input *input,
                                vxm_error *error) {
  *out = (vxm_vdb_extent){.is_empty = true};
  walk w = walk_of(grid, input, error);
  w.extent = out;
  vxm_status status = root(&w);
  out->leaves = w.leaves;
  out->background = w.values.background;
  out->values = w.at;
  return status;
}

vxm_status vxm_vdb_tree_visit(const vxm_vdb_visitor *visitor, const vxm_vdb_grid *grid,
                              const vxm_vdb_extent *extent, const vxm_input *input, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  walk w = walk_of(grid, input, &local);
  w.visitor = visitor;
  w.leaf_at = extent->values;
  w.all_leaves = extent->leaves;
  w.room = vxm_alloc(input->context, 1, sizeof *w.room, &local);
  vxm_status status = local.code;
  if (status == VXM_OK) {
    w.values.room = &w.room->unpacking;
    status = root(&w);
  }
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, &local);
  vxm_free(input->context, w.room);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
