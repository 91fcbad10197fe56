/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/sparse_coverage.h"
#include "base/threads.h"
#include "grid/cut.h"
#include "grid/octree_count.h"
#include "gridio/formats/octree_file.h"

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
  uint64_t *counts; /**< for each worker those of a task */
} job;

/* ---- Values ---- */

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
  box.counts = j->counts + (size_t)worker * (size_t)j->layers * j->layer_cubes;
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
  return vxm_parallel_asked(j->field->context, tasks, count_layers, j, error);
}

/* ---- Sources ---- */

static vxm_status count_sparse(job *j, vxm_error *error) {
  return count_all(j, j->box.begin[0], j->box.end[0], error);
}

/** Cubes that are not smaller than tiles are counted by the index alone, others by a layer of tiles after the
 * other. */
static vxm_status count_file(job *j, vxm_error *error) {
  const vxm_sparse_file *file = j->file;
  int64_t tile = vxm_octree_side(file->tile_level + 1), side = j->box.side;
  if (side >= tile)
    return count_all(j, j->box.begin[0], j->box.end[0], error);
  vxm_status status = VXM_OK;
  for (int64_t first = j->box.begin[0], last; first < j->box.end[0] && status == VXM_OK; first = last) {
    int64_t begin[3], end[3];
    last = vxm_min((first / (tile / side) + 1) * (tile / side), j->box.end[0]);
    for (int a = 0; a < 3; a++) {
      begin[a] = (a == 0 ? first : j->box.begin[a]) * side;
      end[a] = vxm_min((a == 0 ? last : j->box.end[a]) * side, file->space.dims[a]);
    }
    vxm_sparse *part;
    status = vxm_octree_file_load(&part, file, begin, end, error);
    j->sparse = part;
    if (status == VXM_OK)
      status = count_all(j, first, last, error);
    vxm_sparse_destroy(part);
    j->sparse = NULL;
    if (status == VXM_OK)
      status =
          vxm_progress(file->context, "counting",
                       (double)(last - j->box.begin[0]) / (double)(j->box.end[0] - j->box.begin[0]), error);
  }
  return status;
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
  vxm_error local = VXM_ERROR_INIT;
  size_t workers = (size_t)vxm_context_threads(context);
  j->counts = vxm_alloc(context, workers * (size_t)j->layers, j->layer_cubes * sizeof *j->counts, &local);
  if (!j->counts)
    vxm_error_pass(error, &local);
  return local.code;
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
