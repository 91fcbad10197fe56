/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_nodes.h"
#include "voxel/labels/label_sets.h"
#include "voxel/labels/nearest_label.h"
#include "voxel/labels/open_labels.h"
#include "voxel/sparse/sparse.h"

#include <string.h>

enum { SIDE = VXM_NODE_SIDE, ROWS = SIDE * SIDE };

/** What a worker has counted. */
typedef struct tally {
  int64_t *voxels; /**< of each label */
  int64_t contested, unassigned;
} tally;

struct vxm_label_nodes {
  vxm_context *context;
  vxm_model *model;
  const vxm_space *space;
  vxm_face_labels *labelling;
  int64_t set; /**< voxels */
  vxm_sparse *voxels;
  vxm_label_sets labels;
  vxm_node_boxes boxes; /**< of these */
  vxm_label_bvh *bvh;   /**< NULL if there is one label */
  uint8_t *open;        /**< as vxm_label_overlaps has it */
  tally *tallies;
  int workers;
};

/* ---- A node ---- */

/** The one label of a node that is set as a whole; 0 = it cannot be told without its voxels. */
static uint32_t one_label(const vxm_label_nodes *n, int worker, const int64_t at[3]) {
  size_t next = 0, label, found = SIZE_MAX;
  while ((label = vxm_node_boxes_next(&n->boxes, worker, at[0], &next)) != SIZE_MAX) {
    const vxm_octree_node *node = vxm_octree_low_node(n->labels.sets[label], at[0], at[1], at[2]);
    if (node->mixed == 0 && node->full == 0)
      continue;
    if (node->full != ~UINT64_C(0) || found != SIZE_MAX)
      return 0;
    found = label;
  }
  if (found == SIZE_MAX ||
      (n->open && n->open[found] && vxm_nearest_label_may_reach(n->bvh, n->space, at, SIDE)))
    return 0;
  return (uint32_t)found + 1;
}

/** Weighs a label, or with 0 all of them or the open ones, against what the voxels asked about have. */
static void weigh(const vxm_label_nodes *n, const int64_t at[3], uint16_t *values, uint64_t asked[ROWS],
                  uint32_t label, const uint8_t *open) {
  const vxm_window window = {.layout = VXM_LAYOUT_GRID,
                             .fast_dim = SIDE,
                             .middle_dim = SIDE,
                             .slow_dim = SIDE,
                             .end = SIDE,
                             .row_words = 1,
                             .slice_words = SIDE,
                             .words = asked};
  const vxm_nearest_label nearest = {n->bvh, n->space, &window, at, values, SIDE, ROWS, label, open};
  const int64_t begin[3] = {0, 0, 0};
  int64_t end[3];
  for (int a = 0; a < 3; a++)
    end[a] = vxm_node_count(n->space, at, a);
  vxm_nearest_label_voxels(&nearest, begin, end);
}

/** A label takes the voxels of its solid that have none; notes those that have another, and returns whether
 * there are such. */
static bool claim(uint16_t *values, uint64_t left[ROWS], const uint64_t set[ROWS], uint16_t label) {
  uint64_t any = 0;
  for (size_t r = 0; r < ROWS; r++) {
    uint64_t others = 0;
    for (uint64_t bits = left[r] & set[r]; bits; bits &= bits - 1) {
      uint16_t *value = &values[SIDE * r + (size_t)__builtin_ctzll(bits)];
      *value = *value ? *value : label;
      others |= *value != label ? bits & -bits : 0;
    }
    left[r] = others;
    any |= others;
  }
  return any != 0;
}

/** Voxels without a label get the nearest. */
static void settle_rest(const vxm_label_nodes *n, const int64_t at[3], uint16_t *values,
                        const uint64_t set[ROWS], tally *t) {
  uint64_t left[ROWS];
  int64_t count = 0;
  for (size_t r = 0; r < ROWS; r++) {
    left[r] = 0;
    for (uint64_t bits = set[r]; bits; bits &= bits - 1)
      left[r] |= values[SIDE * r + (size_t)__builtin_ctzll(bits)] == 0 ? bits & -bits : 0;
    count += vxm_popcount(left[r]);
    for (uint64_t bits = n->bvh ? 0 : left[r]; bits; bits &= bits - 1)
      values[SIDE * r + (size_t)__builtin_ctzll(bits)] = 1;
  }
  t->unassigned += count;
  if (count > 0 && n->bvh)
    weigh(n, at, values, left, 0, NULL);
}

/** Near the surface open labels take voxels of each other. */
static void settle_open(const vxm_label_nodes *n, const int64_t at[3], uint16_t *values,
                        const uint64_t set[ROWS]) {
  uint64_t asked[ROWS], any = 0;
  for (size_t r = 0; r < ROWS; r++) {
    asked[r] = 0;
    for (uint64_t bits = set[r]; bits; bits &= bits - 1)
      asked[r] |= n->open[values[SIDE * r + (size_t)__builtin_ctzll(bits)] - 1] ? bits & -bits : 0;
    any |= asked[r];
  }
  if (any)
    weigh(n, at, values, asked, 0, n->open);
}

static void count(const uint16_t *values, const uint64_t set[ROWS], tally *t) {
  for (size_t r = 0; r < ROWS; r++)
    for (uint64_t bits = set[r]; bits; bits &= bits - 1)
      t->voxels[values[SIDE * r + (size_t)__builtin_ctzll(bits)] - 1]++;
}

static bool make_node(void *payload, int worker, const int64_t at[3], void *to) {
  vxm_label_nodes *n = payload;
  uint16_t *values = to;
  tally *t = &n->tallies[worker];
  uint64_t set[ROWS], several[ROWS] = {0}, solid[ROWS];
  size_t next = 0, label;
  bool is_alike = vxm_node_bits(set, n->voxels, at);
  if (is_alike && set[0] == 0) {
    values[0] = 0;
    return true;
  }
  uint32_t one = is_alike ? one_label(n, worker, at) : 0;
  if (one) {
    values[0] = (uint16_t)one;
    t->voxels[one - 1] += VXM_NODE_VOXELS;
    return true;
  }
  memset(values, 0, VXM_NODE_VOXELS * sizeof *values);
  while ((label = vxm_node_boxes_next(&n->boxes, worker, at[0], &next)) != SIZE_MAX) {
    if (vxm_node_bits(solid, n->labels.sets[label], at) && solid[0] == 0)
      continue;
    if (!claim(values, solid, set, (uint16_t)(label + 1)))
      continue;
    for (size_t r = 0; r < ROWS; r++)
      several[r] |= solid[r];
    weigh(n, at, values, solid, (uint32_t)label + 1, NULL);
  }
  for (size_t r = 0; r < ROWS; r++)
    t->contested += vxm_popcount(several[r]);
  settle_rest(n, at, values, set, t);
  if (n->open)
    settle_open(n, at, values, set);
  count(values, set, t);
  return false;
}

vxm_node_maker vxm_label_nodes_maker(vxm_label_nodes *nodes) {
  return (vxm_node_maker){&nodes->boxes, make_node, nodes, "labelling"};
}

const vxm_sparse *vxm_label_nodes_voxels(const vxm_label_nodes *nodes) {
  return nodes->voxels;
}

/* ---- Before and after ---- */

static void add_to_box(const vxm_sparse_piece *piece, void *payload) {
  int32_t(*box)[2] = payload;
  for (int a = 0; a < 3; a++) {
    box[a][0] = (int32_t)vxm_min(box[a][0], piece->position[a]);
    box[a][1] = (int32_t)vxm_max(box[a][1], piece->position[a] + piece->side);
  }
}

static vxm_status list_boxes(vxm_label_nodes *n, vxm_error *error) {
  vxm_status status = vxm_node_boxes_create(&n->boxes, n->context, n->labels.count, error);
  for (size_t label = 0; label < n->labels.count && status == VXM_OK; label++)
    for (int a = 0; a < 3; a++) {
      n->boxes.box[label][a][0] = n->labels.sets[label] ? INT32_MAX : 0;
      n->boxes.box[label][a][1] = 0;
    }
  for (size_t label = 0; label < n->labels.count && status == VXM_OK; label++)
    if (n->labels.sets[label])
      vxm_octree_walk_layers(n->labels.sets[label], 2, 0, n->space->dims[2], add_to_box, n->boxes.box[label]);
  return status;
}

static vxm_status make_tallies(vxm_label_nodes *n, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  n->tallies = vxm_calloc(n->context, (size_t)n->workers, sizeof *n->tallies, &local);
  for (int w = 0; w < n->workers && local.code == VXM_OK; w++)
    n->tallies[w].voxels = vxm_calloc(n->context, n->labels.count, sizeof *n->tallies[w].voxels, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status find_open(vxm_label_nodes *n, vxm_error *error) {
  vxm_status status = vxm_open_labels_create(&n->open, n->labelling, error);
  for (size_t label = 0; status == VXM_OK && n->open && label < n->labels.count; label++)
    n->open[label] |= n->labels.sets[label] == NULL;
  return status;
}

static vxm_status make(vxm_label_nodes *n, vxm_voxelize_report *voxelize, vxm_error *error) {
  const vxm_lattice lattice = vxm_lattice_of(n->space);
  vxm_status status = vxm_sparse_make(&n->voxels, voxelize, n->model, n->space, NULL, error);
  n->set = voxelize->voxels;
  if (status == VXM_OK)
    status = vxm_label_sets_create(&n->labels, n->labelling, &n->model->options, &lattice, error);
  if (status == VXM_OK)
    status = find_open(n, error);
  if (status == VXM_OK && n->labels.count > 1)
    status = vxm_label_bvh_create(&n->bvh, n->labelling, n->space, error);
  if (status == VXM_OK)
    status = list_boxes(n, error);
  return status == VXM_OK ? make_tallies(n, error) : status;
}

vxm_status vxm_label_nodes_create(vxm_label_nodes **out, vxm_voxelize_report *voxelize, vxm_model *model,
                                  const vxm_space *space, vxm_face_labels *labelling, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_label_nodes *n = vxm_calloc(model->context, 1, sizeof *n, &local);
  vxm_status status = local.code;
  if (n) {
    n->context = n->labels.context = n->boxes.context = model->context;
    n->model = model;
    n->space = space;
    n->labelling = labelling;
    n->workers = vxm_context_threads(model->context);
    status = make(n, voxelize, &local);
  }
  if (status != VXM_OK) {
    vxm_label_nodes_destroy(n);
    vxm_error_pass(error, &local);
    n = NULL;
  }
  *out = n;
  return status;
}

void vxm_label_nodes_destroy(vxm_label_nodes *n) {
  if (!n)
    return;
  for (int w = 0; n->tallies && w < n->workers; w++)
    vxm_free(n->context, n->tallies[w].voxels);
  vxm_free(n->context, n->tallies);
  vxm_node_boxes_destroy(&n->boxes);
  vxm_label_bvh_destroy(n->bvh);
  vxm_free(n->context, n->open);
  vxm_label_sets_destroy(&n->labels);
  vxm_sparse_destroy(n->voxels);
  vxm_free(n->context, n);
}

vxm_status vxm_label_nodes_report(vxm_label_report *report, vxm_label_nodes *n, vxm_error *error) {
  vxm_label_table *table = &n->labelling->table;
  vxm_model_result *mine;
  vxm_status status = vxm_model_results_mine(&mine, n->model->results, error);
  if (status != VXM_OK)
    return status;
  *report = (vxm_label_report){.voxelize = report->voxelize, .labels = (int64_t)table->count};
  for (size_t label = 0; label < table->count; label++) {
    table->voxels[label] = 0;
    for (int w = 0; w < n->workers; w++)
      table->voxels[label] += n->tallies[w].voxels[label];
  }
  for (int w = 0; w < n->workers; w++) {
    report->contested += n->tallies[w].contested;
    report->unassigned += n->tallies[w].unassigned;
  }
  vxm_labels_warn(n->labelling, n->set, &mine->warnings);
  vxm_label_table_destroy(&mine->labels);
  mine->labels = *table;
  *table = (vxm_label_table){.context = n->context};
  return VXM_OK;
}
