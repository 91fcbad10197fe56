/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octree/octree_file.h"
#include "base/endian.h"
#include "gridio/common/format.h"
#include "gridio/formats/octree/octree_tile.h"
#include "gridio/formats/octree/octree_values.h"

#include <inttypes.h>
#include <string.h>

static const char magic[8] = {'V', 'X', 'M', 'O', 'C', 'T', '1', '\n'};

bool vxm_octree_sniff(const vxm_input *input) {
  return input->size >= sizeof magic && memcmp(input->data, magic, sizeof magic) == 0;
}

/* ---- Header and index ---- */

static vxm_status read_header(vxm_sparse_file *file, vxm_error *error) {
  const vxm_input *input = &file->input;
  const unsigned char *data = input->data;
  if (!vxm_octree_sniff(input))
    return vxm_fail_byte(error, input, 0, "not an octree: it does not begin with \"VXMOCT1\"");
  if (input->size < VXM_OCTREE_HEADER)
    return vxm_fail_byte(error, input, input->size, "the file ends within its header of %d bytes",
                         VXM_OCTREE_HEADER);
  for (int a = 0; a < 3; a++) {
    file->space.dims[a] = (int64_t)vxm_load_le64(data + 8 + 8 * a);
    file->space.origin[a] = vxm_load_double(data + 32 + 8 * a);
    file->space.voxel_size[a] = vxm_load_double(data + 56 + 8 * a);
  }
  vxm_status status = vxm_space_check_file(&file->space, input, 8, error);
  if (status != VXM_OK)
    return status;
  file->voxels = vxm_load_le64(data + 80);
  file->tile_count = (size_t)vxm_load_le64(data + 88);
  file->index = vxm_load_le64(data + 96);
  file->values = vxm_load_le64(data + 104);
  file->levels = vxm_octree_levels(&file->space);
  file->tile_level = vxm_octree_tile_level(file->levels);
  if (file->index < VXM_OCTREE_HEADER || file->index > input->size)
    return vxm_fail_byte(error, input, 96, "the index begins beyond the file, which is damaged or cut short");
  if (file->values != 0 && (file->values < file->index || file->values > input->size))
    return vxm_fail_byte(error, input, 104,
                         "the values begin where none can: the file is damaged or cut short");
  return VXM_OK;
}

/** Where the index ends. */
static uint64_t index_end(const vxm_sparse_file *file) {
  return file->values != 0 ? file->values : file->input.size;
}

/** Reads `count` nodes of a level above tiles. */
static vxm_status read_nodes(vxm_sparse_file *file, int level, size_t count, uint64_t *at, size_t *children,
                             vxm_error *error) {
  const vxm_input *input = &file->input;
  if (count > (index_end(file) - *at) / VXM_OCTREE_NODE)
    return vxm_fail_byte(error, input, *at, "the file ends before its index does: it is cut short");
  vxm_error local = VXM_ERROR_INIT;
  vxm_octree_node *nodes = vxm_alloc(file->context, count, sizeof *nodes, &local);
  if (local.code != VXM_OK) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  file->nodes[level] = nodes;
  file->node_count[level] = count;
  *children = 0;
  for (size_t n = 0; n < count; n++, *at += VXM_OCTREE_NODE) {
    uint64_t mixed = vxm_load_le64(input->data + *at), full = vxm_load_le64(input->data + *at + 8);
    if (mixed & full)
      return vxm_fail_byte(error, input, *at, "a node of level %d is none: the file is damaged", level);
    nodes[n] = (vxm_octree_node){mixed, full, mixed ? *children : 0};
    *children += (size_t)vxm_popcount(mixed);
  }
  return VXM_OK;
}

/** Tiles begin behind the header, one behind the other. */
static vxm_status check_entries(const vxm_sparse_file *file, vxm_error *error) {
  uint64_t last = 0, side = (uint64_t)vxm_octree_side(file->tile_level + 1);
  for (size_t t = 0; t < file->tile_count; t++) {
    const unsigned char *entry = file->entries + VXM_OCTREE_ENTRY * t;
    uint64_t offset = vxm_load_le64(entry);
    bool follows = t == 0 ? offset == VXM_OCTREE_HEADER : offset > last;
    if (!follows || offset % sizeof(uint64_t) != 0 || offset >= file->index)
      return vxm_fail_byte(error, &file->input, entry - file->input.data,
                           "tile %zu begins at byte %" PRIu64 ", where none can: the file is damaged", t,
                           offset);
    if (vxm_octree_file_tile_voxels(file, t) > side * side * side)
      return vxm_fail_byte(error, &file->input, entry + 8 - file->input.data,
                           "tile %zu has more voxels than it can: the file is damaged", t);
    last = offset;
  }
  return VXM_OK;
}

/** What the index says is within the grid, and as much as the header says. */
static vxm_status check_sum(const vxm_sparse_file *file, vxm_error *error) {
  uint64_t voxels;
  if (!vxm_octree_file_count_voxels(&voxels, file))
    return vxm_fail_byte(error, &file->input, file->index,
                         "the index has voxels beyond the grid: the file is damaged");
  if (voxels != file->voxels)
    return vxm_fail_byte(error, &file->input, 80,
                         "the index has %" PRIu64 " voxels and the header %" PRIu64 ": the file is damaged",
                         voxels, file->voxels);
  return VXM_OK;
}

static vxm_status read_index(vxm_sparse_file *file, vxm_error *error) {
  const vxm_input *input = &file->input;
  uint64_t at = file->index;
  size_t count = 1;
  vxm_status status = VXM_OK;
  for (int l = file->levels - 1; l > file->tile_level && status == VXM_OK; l--)
    status = read_nodes(file, l, count, &at, &count, error);
  if (status != VXM_OK)
    return status;
  file->entries = input->data + at;
  if (count != file->tile_count || (index_end(file) - at) / VXM_OCTREE_ENTRY != count ||
      (index_end(file) - at) % VXM_OCTREE_ENTRY != 0)
    return vxm_fail_byte(error, input, at,
                         "the index is not that of the file's %zu tiles: it is damaged or cut short", count);
  status = check_entries(file, error);
  return status == VXM_OK ? check_sum(file, error) : status;
}

vxm_status vxm_octree_file_open(vxm_sparse_file **out, vxm_input *input, vxm_error *error) {
  vxm_context *owner;
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = vxm_context_acquire(&owner, input->context, error);
  vxm_sparse_file *file = status == VXM_OK ? vxm_calloc(owner, 1, sizeof *file, &local) : NULL;
  if (!file) {
    if (status == VXM_OK)
      vxm_context_release(owner);
    vxm_input_close(input);
    if (local.code != VXM_OK)
      vxm_error_pass(error, &local);
    return status == VXM_OK ? local.code : status;
  }
  file->context = owner;
  file->input = *input;
  size_t length = strlen(input->name) + 1;
  file->name = vxm_alloc(owner, length, 1, &local);
  status = file->name ? VXM_OK : local.code;
  if (status == VXM_OK) { /* the caller's text does not live as long as the file */
    memcpy(file->name, input->name, length);
    file->input.name = file->name;
    status = read_header(file, &local);
  }
  if (status == VXM_OK)
    status = read_index(file, &local);
  if (status == VXM_OK && file->values != 0)
    status = vxm_octree_values_open(file, &local);
  if (status != VXM_OK) {
    vxm_sparse_file_close(file);
    vxm_error_pass(error, &local);
    return status;
  }
  *out = file;
  return VXM_OK;
}

void vxm_sparse_file_close(vxm_sparse_file *file) {
  if (!file)
    return;
  vxm_context *context = file->context;
  for (int l = 0; l < VXM_OCTREE_LEVELS; l++)
    vxm_free(context, file->nodes[l]);
  vxm_input_close(&file->input);
  vxm_free(context, file->name);
  vxm_free(context, file);
  vxm_context_release(context);
}

/* ---- The voxels ---- */

typedef struct load {
  vxm_octree_growth growth;
  const vxm_sparse_file *file;
  const int64_t *begin, *end;
} load;

static vxm_octree_state load_node(load *l, int level, size_t index, const int64_t at[3]);

/** A mixed child of a node above tiles, at a level. */
static vxm_octree_state load_child(load *l, int level, size_t index, const int64_t at[3]) {
  if (level > l->file->tile_level)
    return load_node(l, level, index, at);
  vxm_octree_add_tile(&l->growth, l->file, index, at);
  return VXM_OCTREE_MIXED;
}

/** A node above tiles, as far as the box has it. */
static vxm_octree_state load_node(load *l, int level, size_t index, const int64_t at[3]) {
  const vxm_octree_node *node = &l->file->nodes[level][index];
  int64_t side = vxm_octree_side(level);
  uint64_t mixed = 0, full = 0;
  size_t first = vxm_octree_growth_next(&l->growth, level);
  for (uint64_t left = node->mixed | node->full; left && l->growth.status == VXM_OK; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    vxm_octree_state cell = VXM_OCTREE_FULL;
    int64_t place[3];
    vxm_octree_child_at(place, at, child, side);
    if (!vxm_cube_meets(place, side, l->begin, l->end))
      continue;
    if (node->mixed >> child & 1)
      cell = load_child(l, level - 1, vxm_octree_index(node, child), place);
    mixed |= (uint64_t)(cell == VXM_OCTREE_MIXED) << child;
    full |= (uint64_t)(cell == VXM_OCTREE_FULL) << child;
  }
  return vxm_octree_growth_node(&l->growth, level, mixed, full, first);
}

vxm_status vxm_octree_file_load(vxm_sparse **out, const vxm_sparse_file *file, const int64_t begin[3],
                                const int64_t end[3], vxm_error *error) {
  load l = {.file = file, .begin = begin, .end = end};
  vxm_octree_growth_begin(&l.growth, file->context, &file->space, error);
  if (l.growth.status == VXM_OK)
    load_child(&l, file->levels - 1, 0, (int64_t[3]){0, 0, 0});
  return vxm_octree_growth_end(out, &l.growth);
}
