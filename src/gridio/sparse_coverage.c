/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/sparse_coverage.h"
#include "base/threads.h"
#include "grid/crop.h"
#include "grid/octree_count.h"
#include "gridio/formats/octree/octree_file.h"

#include <pthread.h>

/** Layers of cubes that a task counts at once have about so many voxels across, so that bricks are visited
 * once, unless the counts would be more than this. */
enum { TASK_VOXELS = 16, TASK_BYTES = 1 << 24 };

typedef struct job {
  vxm_field *field;
  vxm_octree_counts box; /**< all cubes of the field */
  const vxm_sparse *sparse;
  const vxm_sparse_file *file; /**< its index, where there is no octree */
  int64_t first, last;         /**< layers of cubes */
  int64_t layers;              /**< of a task */
  size_t layer_cubes;
  size_t task_cubes;
  uint64_t *counts; /**< for each worker those of a task */
} job;

/* ---- Values ---- */

/** Stores some cubes, in the order of the field from a place on. */
static void store(const job *j, size_t from, const uint64_t *counts, size_t count) {
  uint64_t side = (uint64_t)j->box.side, most = side * side * side;
  unsigned char *out = j->field->values + from * vxm_scalar_bytes(j->field->scalar);
  switch (j->field->scalar) {
  case VXM_UINT8:
    for (size_t i = 0; i < count; i++)
      out[i] = (unsigned char)((510 * (unsigned __int128)counts[i] + most) / 2 / most);
    break;
  case VXM_FLOAT32:
    for (size_t i = 0; i < count; i++)
      ((float *)(void *)out)[i] = (float)counts[i] / (float)most;
    break;
  case VXM_FLOAT64:
    for (size_t i = 0; i < count; i++)
      ((double *)(void *)out)[i] = (double)counts[i] / (double)most;
    break;
  default:
    memcpy(out, counts, count * sizeof *counts);
  }
}

static void count_layers(size_t task, int worker, void *payload) {
  const job *j = payload;
  vxm_octree_counts box = j->box;
  box.begin[0] = j->first + (int64_t)task * j->layers;
  box.end[0] = vxm_min(box.begin[0] + j->layers, j->last);
  size_t cubes = (size_t)(box.end[0] - box.begin[0]) * j->layer_cubes;
  box.counts = j->counts + (size_t)worker * j->task_cubes;
  memset(box.counts, 0, cubes * sizeof *box.counts);
  if (j->sparse)
    vxm_octree_count(&box, j->sparse);
  else
    vxm_octree_file_count(&box, j->file);
  store(j, (size_t)(box.begin[0] - j->box.begin[0]) * j->layer_cubes, box.counts, cubes);
}

static vxm_status count_all(job *j, int64_t first, int64_t last, vxm_error *error) {
  j->first = first;
  j->last = last;
  size_t tasks = (size_t)((last - first + j->layers - 1) / j->layers);
  return vxm_parallel_cancellable(j->field->context, tasks, count_layers, j, error);
}

/* ---- Sources ---- */

static vxm_status count_sparse(job *j, vxm_error *error) {
  return count_all(j, j->box.begin[0], j->box.end[0], error);
}

/** Rows of tiles along z, one task each. */
typedef struct tile_rows {
  const job *job;
  int64_t cubes;         /**< along a tile */
  int64_t first[2];      /**< tiles along x and y */
  size_t across;         /**< rows along y */
  pthread_mutex_t mutex; /**< of what follows */
  size_t failed;         /**< the first row that did, or SIZE_MAX */
  vxm_error error;       /**< of that */
} tile_rows;

/** The cubes of a row that the field has. */
static vxm_octree_counts row_box(const tile_rows *rows, size_t task) {
  vxm_octree_counts box = rows->job->box;
  const size_t at[2] = {task / rows->across, task % rows->across};
  for (int a = 0; a < 2; a++) {
    int64_t begin = (rows->first[a] + (int64_t)at[a]) * rows->cubes;
    box.begin[a] = vxm_max(begin, box.begin[a]);
    box.end[a] = vxm_min(begin + rows->cubes, box.end[a]);
  }
  return box;
}

/** Counts a row, some layers along x after others. */
static void count_row(const tile_rows *rows, const vxm_octree_counts *row, const vxm_sparse *part,
                      uint64_t *counts) {
  const job *j = rows->job;
  size_t deep = (size_t)(row->end[2] - row->begin[2]), line = (size_t)(row->end[1] - row->begin[1]) * deep;
  int64_t layers = vxm_max(1, (int64_t)(j->task_cubes / line));
  for (int64_t x = row->begin[0]; x < row->end[0]; x += layers) {
    vxm_octree_counts box = *row;
    box.begin[0] = x;
    box.end[0] = vxm_min(x + layers, row->end[0]);
    box.counts = counts;
    memset(counts, 0, (size_t)(box.end[0] - x) * line * sizeof *counts);
    vxm_octree_count(&box, part);
    for (int64_t l = x; l < box.end[0]; l++, box.counts += line)
      store(j,
            (size_t)(l - j->box.begin[0]) * j->layer_cubes + (size_t)(row->begin[1] - j->box.begin[1]) * deep,
            box.counts, line);
  }
}

static void read_row(size_t task, int worker, void *payload) {
  tile_rows *rows = payload;
  const job *j = rows->job;
  vxm_octree_counts row = row_box(rows, task);
  int64_t begin[3], end[3];
  for (int a = 0; a < 3; a++) {
    begin[a] = row.begin[a] * row.side;
    end[a] = vxm_min(row.end[a] * row.side, j->file->space.dims[a]);
  }
  vxm_sparse *part;
  vxm_error local = VXM_ERROR_INIT;
  if (vxm_octree_file_load(&part, j->file, begin, end, &local) == VXM_OK)
    count_row(rows, &row, part, j->counts + (size_t)worker * j->task_cubes);
  vxm_sparse_destroy(part);
  pthread_mutex_lock(&rows->mutex);
  if (local.code != VXM_OK && task < rows->failed) { /* the same one for any number of threads */
    rows->failed = task;
    rows->error = local;
  }
  pthread_mutex_unlock(&rows->mutex);
}

/** Cubes that are not smaller than tiles are counted by the index alone; of others each thread has a row of
 * tiles at a time. */
static vxm_status count_file(job *j, vxm_error *error) {
  int64_t tile = vxm_octree_side(j->file->tile_level + 1), side = j->box.side;
  if (side >= tile)
    return count_all(j, j->box.begin[0], j->box.end[0], error);
  tile_rows rows = {.job = j, .cubes = tile / side, .failed = SIZE_MAX, .error = VXM_ERROR_INIT};
  size_t count[2];
  for (int a = 0; a < 2; a++) {
    rows.first[a] = j->box.begin[a] / rows.cubes;
    count[a] = (size_t)((j->box.end[a] - 1) / rows.cubes - rows.first[a]) + 1;
  }
  rows.across = count[1];
  pthread_mutex_init(&rows.mutex, NULL);
  vxm_status status =
      vxm_parallel_cancellable(j->field->context, count[0] * count[1], read_row, &rows, error);
  pthread_mutex_destroy(&rows.mutex);
  if (status != VXM_OK || rows.failed == SIZE_MAX)
    return status;
  vxm_error_pass(error, &rows.error);
  return rows.error.code;
}

/* ---- Fields ---- */

static vxm_status check_options(const vxm_coverage_options *options, vxm_error *error) {
  int side = options->subdivision;
  if (side < 1 || side > VXM_DIM_MAX || (side & (side - 1)) != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "coverage: cubes of %d voxels along a side are none of 1, 2, 4, ... 1048576", side);
  switch (options->scalar) {
  case VXM_FLOAT32:
  case VXM_FLOAT64:
  case VXM_UINT8:
  case VXM_UINT64:
    return VXM_OK;
  default:
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "coverage: the type of its numbers is none of float32, float64, uint8 and uint64");
  }
}

static vxm_space coarser_space(const vxm_space *space, int64_t side) {
  vxm_space coarser = *space;
  for (int a = 0; a < 3; a++) {
    coarser.dims[a] = (space->dims[a] + side - 1) / side;
    coarser.voxel_size[a] *= (double)side;
  }
  return coarser;
}

static vxm_status begin_job(job *j, vxm_context *context, const vxm_space *space,
                            const vxm_coverage_options *options, const int64_t begin[3], const int64_t end[3],
                            vxm_error *error) {
  vxm_status status = check_options(options, error);
  if (status != VXM_OK)
    return status;
  j->box.side = options->subdivision;
  vxm_space all = coarser_space(space, j->box.side);
  status = vxm_space_check(&all, error);
  for (int a = 0; a < 3; a++) {
    j->box.begin[a] = begin ? begin[a] : 0;
    j->box.end[a] = end ? end[a] : all.dims[a];
  }
  if (status == VXM_OK)
    status = vxm_space_check_box(&all, j->box.begin, j->box.end, error);
  if (status != VXM_OK)
    return status;
  vxm_space part = vxm_space_of_box(&all, j->box.begin, j->box.end);
  bool is_share = options->scalar != VXM_UINT64;
  status = vxm_field_make(&j->field, context, &part, is_share ? VXM_FIELD_COVERAGE : VXM_FIELD_NUMBERS,
                          options->scalar, error);
  if (status != VXM_OK)
    return status;
  j->field->about.is_declared = is_share;
  j->layer_cubes = (size_t)part.dims[1] * (size_t)part.dims[2];
  j->layers = vxm_min(vxm_max(TASK_VOXELS / j->box.side, 1), part.dims[0]);
  if ((size_t)j->layers * j->layer_cubes > TASK_BYTES / sizeof *j->counts)
    j->layers = 1;
  j->task_cubes = (size_t)j->layers * j->layer_cubes;
  size_t workers = (size_t)vxm_context_threads(context);
  j->counts = vxm_try_alloc(context, workers, j->task_cubes * sizeof *j->counts, &status, error);
  return status;
}

static vxm_status make(vxm_field **out, job *j, vxm_context *context, const vxm_space *space,
                       const vxm_coverage_options *options, const int64_t begin[3], const int64_t end[3],
                       vxm_error *error) {
  vxm_status status = begin_job(j, context, space, options, begin, end, error);
  if (status == VXM_OK)
    status = j->sparse ? count_sparse(j, error) : count_file(j, error);
  vxm_free(context, j->counts);
  return vxm_field_hand_over(out, j->field, status, error);
}

vxm_status vxm_gridio_coverage(vxm_field **out, const vxm_sparse *sparse, const vxm_coverage_options *options,
                               const int64_t begin[3], const int64_t end[3], vxm_error *error) {
  job j = {.sparse = sparse};
  return make(out, &j, sparse->context, &sparse->space, options, begin, end, error);
}

vxm_status vxm_gridio_coverage_file(vxm_field **out, const vxm_sparse_file *file,
                                    const vxm_coverage_options *options, const int64_t begin[3],
                                    const int64_t end[3], vxm_error *error) {
  job j = {.file = file};
  return make(out, &j, file->context, &file->space, options, begin, end, error);
}
