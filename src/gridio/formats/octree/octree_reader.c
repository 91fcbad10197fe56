/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octree/octree_reader.h"

/** Where the values of a node stand, or the one of a higher node. */
typedef struct entry {
  uint64_t key; /**< Morton number of its first node of level 0 */
  const unsigned char *data;
  int level;
} entry;

struct vxm_octree_reader {
  const vxm_sparse_file *file;
  vxm_sparse *tree;
  size_t bytes; /**< of a value */
  entry *entries;
  size_t count, capacity;
  vxm_status status; /**< while entries are listed */
};

static uint64_t key_of(const int64_t at[3]) {
  return vxm_octree_morton(at[0] / VXM_NODE_SIDE, at[1] / VXM_NODE_SIDE, at[2] / VXM_NODE_SIDE);
}

static void list_entry(int level, const int64_t at[3], const unsigned char *data, void *payload) {
  vxm_octree_reader *n = payload;
  if (n->status == VXM_OK)
    n->status = vxm_grow(n->file->context, (void **)&n->entries, &n->capacity, n->count + 1,
                         sizeof *n->entries, NULL);
  if (n->status == VXM_OK)
    n->entries[n->count++] = (entry){key_of(at), data, level};
}

vxm_status vxm_octree_reader_create(vxm_octree_reader **out, const vxm_sparse_file *file, vxm_error *error) {
  static const int64_t origin[3] = {0, 0, 0};
  vxm_error local = VXM_ERROR_INIT;
  vxm_octree_reader *n = vxm_calloc(file->context, 1, sizeof *n, &local);
  vxm_status status = local.code;
  if (n) {
    n->file = file;
    n->bytes = vxm_scalar_bytes(file->scalar) * (size_t)file->channels;
    status = vxm_octree_file_load(&n->tree, file, origin, file->space.dims, &local);
  }
  if (status == VXM_OK)
    status = vxm_octree_values_visit(file, n->tree, list_entry, n, &local);
  if (status == VXM_OK && n->status != VXM_OK)
    status = vxm_fail(&local, n->status, "the memory for the octree's values ran out; raise the limit");
  if (status != VXM_OK) {
    vxm_octree_reader_destroy(n);
    vxm_error_pass(error, &local);
    n = NULL;
  }
  *out = n;
  return status;
}

void vxm_octree_reader_destroy(vxm_octree_reader *n) {
  if (!n)
    return;
  vxm_sparse_destroy(n->tree);
  vxm_free(n->file->context, n->entries);
  vxm_free(n->file->context, n);
}

/** The entry with a node; NULL = it is empty. */
static const entry *find(const vxm_octree_reader *n, uint64_t key) {
  size_t low = 0, high = n->count; /* the last one that does not begin behind it */
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (n->entries[middle].key <= key)
      low = middle + 1;
    else
      high = middle;
  }
  const entry *e = low > 0 ? &n->entries[low - 1] : NULL;
  return e && (key - e->key) >> 6 * e->level == 0 ? e : NULL;
}

static void put(const vxm_octree_reader *n, unsigned char *values, size_t voxel, const unsigned char *value) {
  vxm_octree_copy_value(values + voxel * n->bytes, value, n->bytes, n->file->channels);
}

/** Gives the voxels of a node one value. */
static void fill(const vxm_octree_reader *n, const int64_t at[3], unsigned char *values,
                 const unsigned char *value) {
  uint64_t rows[VXM_NODE_SIDE * VXM_NODE_SIDE];
  vxm_node_bits(rows, n->tree, at);
  for (size_t r = 0; r < VXM_NODE_SIDE * VXM_NODE_SIDE; r++)
    for (uint64_t bits = rows[r]; bits; bits &= bits - 1)
      put(n, values, VXM_NODE_SIDE * r + (size_t)__builtin_ctzll(bits), value);
}

/** Bricks, each of one value or of several. */
static void decode(const vxm_octree_reader *n, const int64_t at[3], unsigned char *values,
                   const unsigned char *data) {
  const vxm_sparse *tree = n->tree;
  vxm_octree_part node = vxm_octree_part_at(tree, 0, at);
  for (uint64_t left = vxm_octree_children(tree, 0, node); left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    vxm_octree_part brick = vxm_octree_child_part(tree, 0, node, child);
    int64_t place[3];
    bool is_one = *data++ == 1;
    vxm_octree_place(child, place);
    size_t first = (size_t)(4 * ((place[2] * VXM_NODE_SIDE + place[1]) * VXM_NODE_SIDE + place[0]));
    for (uint64_t bits = brick.kind == VXM_OCTREE_MIXED ? tree->bricks[brick.index] : ~UINT64_C(0); bits;
         bits &= bits - 1) {
      size_t bit = (size_t)__builtin_ctzll(bits);
      put(n, values, first + (bit / 16 * VXM_NODE_SIDE + bit / 4 % 4) * VXM_NODE_SIDE + bit % 4, data);
      data += is_one ? 0 : n->bytes;
    }
    data += is_one ? n->bytes : 0;
  }
}

bool vxm_octree_reader_take(const vxm_octree_reader *n, const int64_t at[3], void *values) {
  const entry *e = find(n, key_of(at));
  unsigned char *to = values;
  memcpy(to, n->file->background, n->bytes);
  if (!e)
    return true;
  bool is_one = *e->data == 1;
  if (is_one && vxm_octree_low_node(n->tree, at[0], at[1], at[2])->full == ~UINT64_C(0)) {
    put(n, to, 0, e->data + 1);
    return true;
  }
  for (size_t v = 1; v < VXM_NODE_VOXELS; v++)
    memcpy(to + v * n->bytes, n->file->background, n->bytes);
  if (is_one)
    fill(n, at, to, e->data + 1);
  else
    decode(n, at, to, e->data + 1);
  return false;
}
