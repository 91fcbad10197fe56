/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/thin_sparse.h"
#include "grid/octree_pieces.h"
#include "mesh/sort.h"

enum { AXIS_BITS = VXM_VIEW_AXIS_BITS };

/** Voxels of a brick. */
typedef struct brick {
  int64_t at[3];
  uint64_t bits;
} brick;

/* A key is a voxel's brick, which are sorted by z, y and x, above its bit in that. */
enum { BRICK_SHIFT = 6, BRICK_BITS = AXIS_BITS - 2 };

static uint64_t key_of(uint64_t voxel) {
  uint64_t key = 0, at[3];
  for (int a = 0; a < 3; a++) {
    at[a] = voxel >> (AXIS_BITS * a) & ((UINT64_C(1) << AXIS_BITS) - 1);
    key |= (at[a] >> 2) << (BRICK_BITS * a + BRICK_SHIFT);
  }
  return key | vxm_octree_bit((int64_t)at[0], (int64_t)at[1], (int64_t)at[2]);
}

/** The brick of key k; returns the first key of the next one. */
static size_t take_brick(brick *out, const uint64_t *keys, size_t count, size_t k) {
  const uint64_t number = keys[k] >> BRICK_SHIFT;
  for (int a = 0; a < 3; a++)
    out->at[a] = (int64_t)(number >> BRICK_BITS * a & ((UINT64_C(1) << BRICK_BITS) - 1)) << 2;
  for (out->bits = 0; k < count && keys[k] >> BRICK_SHIFT == number; k++)
    out->bits |= UINT64_C(1) << (keys[k] & 63);
  return k;
}

/** Whether a brick may be changed where it stands: it is mixed, and stays so. */
static bool stays_mixed(const vxm_sparse *octree, const brick *b) {
  uint64_t before = vxm_octree_brick(octree, b->at[0], b->at[1], b->at[2]);
  return before && ~(before | b->bits);
}

/** Puts the bricks that have no place, or are to lose it, to an octree. */
static vxm_status unite_others(vxm_sparse **octree, const uint64_t *keys, size_t count, vxm_error *error) {
  vxm_octree_pieces others = {.context = (*octree)->context, .space = (*octree)->space, .error = error};
  vxm_sparse *added = NULL, *both = NULL;
  brick b;
  for (size_t k = 0; k < count;) {
    k = take_brick(&b, keys, count, k);
    if (!stays_mixed(*octree, &b))
      vxm_octree_pieces_brick(&others, b.at, b.bits);
  }
  if (others.status == VXM_OK && others.count == 0)
    return VXM_OK;
  vxm_status status = vxm_octree_pieces_end(&added, &others);
  if (status == VXM_OK)
    status = vxm_octree_combine(&both, *octree, added, VXM_SET_UNION, error);
  vxm_sparse_destroy(added);
  if (status != VXM_OK)
    return status;
  vxm_sparse_destroy(*octree);
  *octree = both;
  return VXM_OK;
}

/** Puts voxels to an octree. Most lie in bricks that have a place there: so few are united with it, and these
 * first, for which memory may not suffice. */
static vxm_status add_voxels(vxm_sparse **octree, const vxm_voxel_set *set, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint64_t *keys = vxm_try_alloc(set->context, 2 * set->count, sizeof *keys, &status, error);
  if (!keys)
    return status;
  size_t count = 0;
  for (size_t s = 0; s < set->size; s++)
    if (set->slots[s])
      keys[count++] = key_of(set->slots[s] - 1);
  vxm_sort_keys(keys, keys + count, count);
  status = unite_others(octree, keys, count, error);
  brick b;
  for (size_t k = 0; k < count && status == VXM_OK;) {
    k = take_brick(&b, keys, count, k);
    vxm_octree_set_bits(*octree, b.at[0], b.at[1], b.at[2], b.bits);
  }
  vxm_free(set->context, keys);
  return status;
}

/** Puts the voxels of slices begin..end-1 along z into the set. */
static vxm_status put_slices(vxm_voxel_set *set, const vxm_voxel_set *found, int64_t begin, int64_t end,
                             vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t s = 0; s < found->size && status == VXM_OK; s++) {
    uint64_t bit = found->slots[s] - 1;
    int64_t slice = (int64_t)(bit >> 2 * AXIS_BITS);
    if (found->slots[s] && slice >= begin && slice < end)
      status = vxm_voxel_set_add(set, bit, error);
  }
  return status;
}

/** Some slices after others, as many as can be looked at at once. */
static vxm_status find_by_slices(vxm_thin_adder *thin, vxm_voxel_set *set, const vxm_sparse *octree,
                                 const vxm_triangle_set *triangles, const vxm_snapped_points *placed,
                                 int separating, vxm_error *error) {
  const int64_t most = INT64_C(1) << 18; /* so that numbers of cells fit */
  int64_t all = octree->space.dims[2], slices = vxm_min(all, most);
  vxm_status status = VXM_OK;
  for (int64_t begin = 0; begin < all && status == VXM_OK;) {
    int64_t end = vxm_min(begin + slices, all);
    bool too_many = false;
    vxm_voxel_set found = {.context = thin->context};
    status = vxm_thin_find(thin, &found, octree, begin, end, triangles, placed, separating,
                           end - begin > 1 ? &too_many : NULL, error);
    if (status == VXM_OK && too_many)
      slices = (end - begin + 1) / 2;
    else if (status == VXM_OK) {
      status = put_slices(set, &found, begin, end, error);
      begin = end;
      slices = thin->is_slack ? vxm_min(2 * slices, vxm_min(all, most)) : slices;
    }
    vxm_voxel_set_destroy(&found);
  }
  return status;
}

/** From so many bytes on an octree matters more than room that is kept for the next call. */
static const uint64_t large_octree = UINT64_C(1) << 27;

static void release_room(vxm_thin_adder *thin) {
  int64_t added = thin->added, area = thin->area;
  vxm_thin_destroy(thin);
  thin->added = added;
  thin->area = area;
}

vxm_status vxm_thin_add_sparse(vxm_thin_adder *thin, vxm_sparse **octree, const vxm_triangle_set *triangles,
                               const vxm_snapped_points *placed, int separating, vxm_error *error) {
  vxm_voxel_set set = {.context = thin->context};
  vxm_status status = find_by_slices(thin, &set, *octree, triangles, placed, separating, error);
  if (vxm_octree_bytes(*octree) >= large_octree)
    release_room(thin);
  if (status == VXM_OK && set.count > 0)
    status = add_voxels(octree, &set, error);
  vxm_voxel_set_destroy(&set);
  return status;
}
