/* SPDX-License-Identifier: BSD-3-Clause */
/** Octree files with values, combined node by node: what is one value in all of them is one in the result. */
#include "gridio/formats/octree/octree_reader.h"
#include "gridio/values_combine.h"

/** What a worker has of its own. */
typedef struct scratch {
  unsigned char *stored, *other; /**< a node of a file, as it is and as a result has it */
  int64_t *voxels;               /**< of each label; NULL = there are none */
} scratch;

typedef struct job {
  vxm_context *context;
  const vxm_sparse_file *const *files;
  size_t count;
  const vxm_set_operation *operations;
  vxm_octree_reader **nodes;
  uint16_t **numbers; /**< of the labels of each file, but for the first */
  vxm_values_type type;
  scratch *scratches;
  vxm_about about;
} job;

static vxm_values_type type_of(const vxm_sparse_file *file) {
  return (vxm_values_type){file->kind, file->scalar};
}

/* ---- A node ---- */

/** Gives all voxels of a node the first one's value. */
static void spread(unsigned char *values, size_t size) {
  for (size_t v = 1; v < VXM_NODE_VOXELS; v++)
    memcpy(values + v * size, values, size);
}

/** The values of a file's node as those of the result; whether they are one. */
static bool take(const job *j, size_t file, const int64_t at[3], unsigned char *stored,
                 unsigned char *values) {
  bool is_one = vxm_octree_reader_take(j->nodes[file], at, stored);
  vxm_values_convert(values, stored, is_one ? 1 : VXM_NODE_VOXELS, type_of(j->files[file]), j->numbers[file]);
  return is_one;
}

static void count_labels(const scratch *d, const vxm_space *space, const int64_t at[3],
                         const uint16_t *values, bool is_one) {
  if (is_one) {
    d->voxels[values[0]] +=
        (int64_t)vxm_node_count(space, at, 0) * vxm_node_count(space, at, 1) * vxm_node_count(space, at, 2);
    return;
  }
  for (int z = 0; z < vxm_node_count(space, at, 2); z++)
    for (int y = 0; y < vxm_node_count(space, at, 1); y++)
      for (int x = 0; x < vxm_node_count(space, at, 0); x++)
        d->voxels[values[(VXM_NODE_SIDE * z + y) * VXM_NODE_SIDE + x]]++;
}

static bool make_node(void *payload, int worker, const int64_t at[3], void *values) {
  job *j = payload;
  scratch *d = &j->scratches[worker];
  size_t size = vxm_values_bytes(j->type);
  bool is_one = take(j, 0, at, d->stored, values);
  for (size_t f = 1; f < j->count; f++) {
    bool is_other_one = take(j, f, at, d->stored, d->other);
    if (is_one && !is_other_one)
      spread(values, size);
    if (is_other_one && !is_one)
      spread(d->other, size);
    is_one &= is_other_one;
    vxm_values_combine(values, d->other, is_one ? 1 : VXM_NODE_VOXELS, j->type, j->operations[f - 1]);
  }
  if (d->voxels)
    count_labels(d, &j->files[0]->space, at, values, is_one);
  return is_one;
}

/* ---- All of it ---- */

static vxm_status allocate(job *j, vxm_error *error) {
  size_t workers = (size_t)vxm_context_threads(j->context), size = vxm_values_bytes(j->type);
  bool are_labels = j->type.kind == VXM_FIELD_LABELS;
  vxm_error local = VXM_ERROR_INIT;
  j->nodes = vxm_calloc(j->context, j->count, sizeof *j->nodes, &local);
  j->numbers = vxm_calloc(j->context, j->count, sizeof *j->numbers, &local);
  for (size_t f = 1; f < j->count && are_labels && local.code == VXM_OK; f++)
    j->numbers[f] = vxm_alloc(j->context, VXM_LABEL_NUMBERS, sizeof *j->numbers[f], &local);
  j->scratches = vxm_calloc(j->context, workers, sizeof *j->scratches, &local);
  for (size_t w = 0; w < workers && local.code == VXM_OK; w++) {
    scratch *d = &j->scratches[w];
    d->stored = vxm_alloc(j->context, VXM_NODE_VOXELS, size, &local);
    d->other = vxm_alloc(j->context, VXM_NODE_VOXELS, size, &local);
    if (are_labels)
      d->voxels = vxm_calloc(j->context, VXM_LABEL_NUMBERS, sizeof *d->voxels, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static void release(job *j) {
  for (size_t f = 0; f < j->count; f++) {
    if (j->nodes)
      vxm_octree_reader_destroy(j->nodes[f]);
    if (j->numbers)
      vxm_free(j->context, j->numbers[f]);
  }
  for (int w = 0; j->scratches && w < vxm_context_threads(j->context); w++) {
    vxm_free(j->context, j->scratches[w].stored);
    vxm_free(j->context, j->scratches[w].other);
    vxm_free(j->context, j->scratches[w].voxels);
  }
  vxm_free(j->context, j->nodes);
  vxm_free(j->context, j->numbers);
  vxm_free(j->context, j->scratches);
  vxm_about_destroy(&j->about);
}

/** Merges the names beside the files. */
static vxm_status merge_tables(job *j, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint16_t *unused = j->numbers[1]; /* of the first file they stay */
  for (size_t f = 0; f < j->count && status == VXM_OK; f++) {
    vxm_set_operation operation = f > 0 ? j->operations[f - 1] : VXM_SET_UNION;
    bool takes = operation == VXM_SET_UNION || operation == VXM_SET_SYMMETRIC_DIFFERENCE;
    vxm_about about = {.is_declared = true, .kind = VXM_FIELD_LABELS};
    if (takes)
      vxm_sidecar_take_labels(&about, j->files[f]->space.dims, &j->files[f]->input);
    status = about.starved ? vxm_fail(error, VXM_ERROR_MEMORY, "out of memory for the labels")
                           : vxm_label_table_merge(&j->about.table, f > 0 ? j->numbers[f] : unused,
                                                   &about.table, j->context, error);
    vxm_about_destroy(&about);
  }
  return status;
}

static vxm_status open_nodes(job *j, vxm_error *error) {
  vxm_status status = allocate(j, error);
  for (size_t f = 0; f < j->count && status == VXM_OK; f++)
    status = vxm_octree_reader_create(&j->nodes[f], j->files[f], error);
  if (status == VXM_OK && j->type.kind == VXM_FIELD_LABELS)
    status = merge_tables(j, error);
  return status;
}

static void sum_labels(job *j) {
  vxm_label_table *table = &j->about.table;
  for (size_t label = 1; label <= table->count; label++)
    for (int w = 0; w < vxm_context_threads(j->context); w++)
      table->voxels[label - 1] += j->scratches[w].voxels[label];
}

static vxm_status write(job *j, const char *path, vxm_error *error) {
  const vxm_sparse_file *first = j->files[0];
  const vxm_values_spec values = {
      .scalar = j->type.scalar, .channels = first->channels, .about = &j->about, .is_signed = true};
  const vxm_node_maker maker = {.make = make_node, .payload = j, .phase = "combining"};
  vxm_values_writer writer;
  vxm_status status =
      vxm_values_writer_open(&writer, &vxm_octree_values, j->context, &first->space, &values, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_octree_values_make(&writer, &maker, error);
  sum_labels(j);
  if (status == VXM_OK)
    return vxm_values_writer_commit(&writer, error);
  vxm_values_writer_abort(&writer);
  return status;
}

vxm_status vxm_gridio_combine_files(const char *path, const vxm_sparse_file *const *files, size_t count,
                                    const vxm_set_operation *operations, vxm_error *error) {
  job j = {.context = files[0]->context,
           .files = files,
           .count = count,
           .operations = operations,
           .type = vxm_values_result(type_of(files[0])),
           .about = {.is_declared = files[0]->kind != VXM_FIELD_NUMBERS,
                     .kind = files[0]->kind,
                     .table = {.context = files[0]->context}}};
  vxm_status status = VXM_OK;
  for (size_t f = 1; f < count && status == VXM_OK; f++)
    status = vxm_values_check(type_of(files[0]), type_of(files[f]), operations[f - 1], error);
  if (status == VXM_OK)
    status = open_nodes(&j, error);
  if (status == VXM_OK)
    status = write(&j, path, error);
  release(&j);
  return status;
}
