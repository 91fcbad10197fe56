/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/thin_sparse.h"
#include "mesh/sort.h"

/* Voxels are sorted by strip, node, and brick of the octree's builder: z and y in sixteens, then x. */
enum { AXIS_BITS = VXM_VIEW_AXIS_BITS, NODE_SHIFT = 4 };

static void place_of(uint64_t bit, uint64_t at[3]) {
  for (int a = 0; a < 3; a++)
    at[a] = bit >> (AXIS_BITS * a) & ((UINT64_C(1) << AXIS_BITS) - 1);
}

/** Its place among the bits of a node: the number of its brick, and the bit there. */
static uint64_t in_node(uint64_t bit) {
  uint64_t at[3];
  place_of(bit, at);
  unsigned brick[3];
  for (int a = 0; a < 3; a++)
    brick[a] = (unsigned)(at[a] >> 2) & 3;
  uint64_t row = (brick[1] & 1) | (brick[2] & 1) << 1 | (brick[1] >> 1) << 2 | (brick[2] >> 1) << 3;
  return (16 * brick[0] + row) << 6 | (at[2] & 3) << 4 | (at[1] & 3) << 2 | (at[0] & 3);
}

/** Voxels with the same strip are one run of `nodes`, the same node a run in that. */
static void add_strip(vxm_octree_builder *builder, const uint64_t *nodes, const uint64_t *voxels,
                      size_t count) {
  const uint64_t mask = (UINT64_C(1) << AXIS_BITS) - 1;
  for (size_t v = 0; v < count;) {
    uint64_t bricks[VXM_STRIP_BRICKS] = {0}, node = nodes[v];
    for (; v < count && nodes[v] == node; v++) {
      uint64_t at = in_node(voxels[v]);
      bricks[at >> 6] |= UINT64_C(1) << (at & 63);
    }
    vxm_strip_add_node(builder, 0, (size_t)(node & mask), bricks);
  }
  vxm_strip_end(builder, 0, (size_t)(nodes[0] >> AXIS_BITS & mask), (size_t)(nodes[0] >> 2 * AXIS_BITS));
}

/** A voxel of a node from its number: node and place put together sort by node, and hold both. */
static uint64_t voxel_of(uint64_t node, uint64_t place) {
  const uint64_t mask = (UINT64_C(1) << AXIS_BITS) - 1;
  uint64_t at[3], in[3] = {place & 15, place >> 4 & 15, place >> 8 & 15}, bit = 0;
  for (int a = 0; a < 3; a++) {
    at[a] = (node >> (AXIS_BITS * a) & mask) << NODE_SHIFT | in[a];
    bit |= at[a] << (AXIS_BITS * a);
  }
  return bit;
}

/** Sorts voxels by node. */
static void sort_by_node(uint64_t *voxels, uint64_t *nodes, uint64_t *scratch, size_t count) {
  enum { NODE_BITS = 17 }; /* of a coordinate: 2^20 voxels are 2^16 nodes */
  const uint64_t mask = (UINT64_C(1) << NODE_BITS) - 1;
  for (size_t v = 0; v < count; v++) {
    uint64_t at[3];
    place_of(voxels[v], at);
    uint64_t place = (at[0] & 15) | (at[1] & 15) << 4 | (at[2] & 15) << 8;
    voxels[v] = (at[2] >> NODE_SHIFT) << (2 * NODE_BITS + 12) | (at[1] >> NODE_SHIFT) << (NODE_BITS + 12) |
                (at[0] >> NODE_SHIFT) << 12 | place;
  }
  vxm_sort_keys(voxels, scratch, count);
  for (size_t v = 0; v < count; v++) {
    uint64_t key = voxels[v];
    nodes[v] = (key >> (2 * NODE_BITS + 12)) << 2 * AXIS_BITS |
               (key >> (NODE_BITS + 12) & mask) << AXIS_BITS | (key >> 12 & mask);
    voxels[v] = voxel_of(nodes[v], key & 0xfff);
  }
}

/** The octree of a set of voxels. */
static vxm_status make_octree(vxm_sparse **out, const vxm_voxel_set *set, vxm_context *context,
                              const vxm_space *space, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  uint64_t *voxels = vxm_alloc(context, 3 * set->count, sizeof *voxels, &local), *nodes = voxels + set->count;
  if (!voxels) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  size_t count = 0;
  for (size_t s = 0; s < set->size; s++)
    if (set->slots[s])
      voxels[count++] = set->slots[s] - 1;
  sort_by_node(voxels, nodes, nodes + count, count);
  vxm_octree_builder builder;
  vxm_status status = vxm_octree_builder_create(&builder, context, space, error);
  for (size_t v = 0, next; v < count && status == VXM_OK; v = next) {
    uint64_t strip = nodes[v] >> AXIS_BITS;
    for (next = v; next < count && nodes[next] >> AXIS_BITS == strip; next++)
      ;
    add_strip(&builder, nodes + v, voxels + v, next - v);
    status = vxm_octree_builder_check(&builder, error);
  }
  if (status == VXM_OK)
    status = vxm_octree_builder_end(out, &builder, error);
  vxm_octree_builder_destroy(&builder);
  vxm_free(context, voxels);
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
  vxm_sparse *added = NULL, *both = NULL;
  vxm_status status = find_by_slices(thin, &set, *octree, triangles, placed, separating, error);
  if (status == VXM_OK && set.count > 0)
    status = make_octree(&added, &set, thin->context, &(*octree)->space, error);
  vxm_voxel_set_destroy(&set);
  if (vxm_octree_bytes(*octree) >= large_octree)
    release_room(thin);
  if (status == VXM_OK && added)
    status = vxm_octree_combine(&both, *octree, added, VXM_SET_UNION, error);
  if (both) {
    vxm_sparse_destroy(*octree);
    *octree = both;
  }
  vxm_sparse_destroy(added);
  return status;
}
