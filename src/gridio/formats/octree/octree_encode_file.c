/* SPDX-License-Identifier: BSD-3-Clause */
/** Nodes that have been encoded are put together in Morton order, and written. */
#include "gridio/formats/octree/octree_encoder.h"

#include <stdlib.h>

static int compare(const void *a, const void *b) {
  const vxm_node_entry *p = a, *q = b;
  return p->key < q->key ? -1 : p->key > q->key;
}

/** All entries in Morton order. */
static vxm_status gather(vxm_node_entry **out, vxm_octree_encoder *e, vxm_error *error) {
  size_t count = 0, at = 0;
  vxm_error local = VXM_ERROR_INIT;
  for (size_t w = 0; w < e->workers; w++)
    count += e->rooms[w].count;
  vxm_node_entry *all = vxm_alloc(e->context, count, sizeof *all, &local);
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
    uint64_t bits = brick.kind == VXM_OCTREE_MIXED ? e->tree->bricks[brick.index] : ~UINT64_C(0);
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
        e->rooms[at >> VXM_WORKER_SHIFT].values.data + (at & ((UINT64_C(1) << VXM_WORKER_SHIFT) - 1));
    vxm_octree_encoder_add(e, &e->out, data, node_bytes(e, part, data));
    return;
  }
  size_t from = e->out.size;
  bool alike = vxm_octree_encoder_add(e, &e->out, &varied, 1);
  for (uint64_t left = vxm_octree_children(e->tree, level, part); left; left &= left - 1) {
    size_t begin = e->out.size;
    encode_part(e, level - 1, vxm_octree_child_part(e->tree, level, part, (unsigned)__builtin_ctzll(left)));
    if (vxm_octree_encoder_failed(e))
      return;
    alike &= vxm_octree_encoder_is_like(e, &e->out, from + 1, begin);
  }
  vxm_octree_encoder_unite(e, &e->out, from, alike);
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
  if (vxm_octree_encoder_failed(e))
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

static vxm_status put_all(vxm_octree_encoder *e, vxm_output *output, const vxm_node_entry *entries,
                          uint64_t begin, vxm_error *error) {
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
    if (vxm_octree_encoder_check(e, &local) != VXM_OK || p.output)
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
  vxm_node_entry *entries = NULL;
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
