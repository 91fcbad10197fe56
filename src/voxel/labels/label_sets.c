/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_sets.h"
#include "base/task_progress.h"
#include "base/threads.h"

/** Boxes and pieces up to that are made whole, by one thread. */
enum { SMALL_WORDS = 1 << 12, SMALL_FACES = 1 << 11 };

typedef struct job {
  vxm_label_sets *out;
  const vxm_voxelize_options *options;
  const vxm_lattice *lattice;
  vxm_label_components pieces;
  size_t *first;                          /**< piece of each label, and the end of the last */
  size_t *small;                          /**< labels of small pieces alone */
  vxm_label_component_scratch *scratches; /**< of each thread */
  vxm_error *errors;                      /**< of each thread */
  vxm_task_progress progress;
} job;

static bool is_small(const vxm_label_component *piece) {
  uint64_t words = (uint64_t)(piece->end[0] - piece->begin[0] + 63) / 64;
  words *= (uint64_t)(piece->end[1] - piece->begin[1]) * (uint64_t)(piece->end[2] - piece->begin[2]);
  return words <= SMALL_WORDS && piece->face_end - piece->first_face <= SMALL_FACES;
}

/** Whether a thread makes a label alone. */
static bool is_light(const job *j, size_t label) {
  bool yes = true;
  for (size_t p = j->first[label]; p < j->first[label + 1]; p++)
    yes &= is_small(&j->pieces.pieces[p]);
  return yes;
}

static vxm_status make_set(job *j, size_t label, int worker, vxm_error *error) {
  vxm_octree_pieces list = {.context = j->out->context, .space = j->lattice->space, .error = error};
  vxm_status status = VXM_OK;
  for (size_t p = j->first[label]; p < j->first[label + 1] && status == VXM_OK; p++) {
    const vxm_label_component *piece = &j->pieces.pieces[p];
    if (piece->begin[0] < piece->end[0])
      status = vxm_label_component_add(&list, &j->scratches[worker], &j->pieces, piece, j->options,
                                       j->lattice, is_small(piece), error);
  }
  list.status = status;
  if (status == VXM_OK && list.count == 0)
    return VXM_OK;
  return vxm_octree_pieces_end(&j->out->sets[label], &list);
}

static void make_light(size_t task, int worker, void *payload) {
  job *j = payload;
  vxm_error *error = &j->errors[worker];
  if (vxm_task_progress_stopped(&j->progress, worker) || error->code != VXM_OK)
    return;
  make_set(j, j->small[task], worker, error);
  vxm_task_progress_step(&j->progress);
}

/** Labels of small pieces by a thread each, then the others, each by all. */
static vxm_status make_sets(job *j, vxm_error *error) {
  size_t light = 0, labels = j->out->count;
  vxm_status status = VXM_OK;
  for (size_t label = 0; label < labels; label++)
    if (is_light(j, label))
      j->small[light++] = label;
  vxm_task_progress_start(&j->progress, j->out->context, "labelling", labels, error);
  vxm_parallel(j->out->context, light, make_light, j);
  for (int w = 0; w < vxm_context_threads(j->out->context) && status == VXM_OK; w++)
    if (j->errors[w].code != VXM_OK) {
      status = j->errors[w].code;
      vxm_error_pass(error, &j->errors[w]);
    }
  size_t next = 0;
  for (size_t label = 0; label < labels && status == VXM_OK; label++) {
    if (next < light && j->small[next] == label) {
      next++;
      continue;
    }
    if (vxm_task_progress_stopped(&j->progress, 0))
      break;
    status = make_set(j, label, 0, error);
    vxm_task_progress_step(&j->progress);
  }
  return status == VXM_OK ? vxm_task_progress_end(&j->progress) : status;
}

static vxm_status allocate(job *j, vxm_error *error) {
  vxm_context *context = j->out->context;
  size_t threads = (size_t)vxm_context_threads(context), labels = j->out->count;
  vxm_error local = VXM_ERROR_INIT;
  j->out->sets = vxm_calloc(context, labels, sizeof *j->out->sets, &local);
  j->first = vxm_calloc(context, labels + 1, sizeof *j->first, &local);
  j->small = vxm_alloc(context, labels, sizeof *j->small, &local);
  j->errors = vxm_calloc(context, threads, sizeof *j->errors, &local);
  j->scratches = vxm_calloc(context, threads, sizeof *j->scratches, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** Where the pieces of each label begin, which are in its order. */
static void find_pieces(job *j) {
  for (size_t p = 0; p < j->pieces.count; p++)
    j->first[j->pieces.pieces[p].label]++;
  for (size_t label = 0; label < j->out->count; label++)
    j->first[label + 1] += j->first[label];
}

vxm_status vxm_label_sets_create(vxm_label_sets *out, const vxm_face_labels *labelling,
                                 const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                 vxm_error *error) {
  vxm_context *context = labelling->soup->context;
  *out = (vxm_label_sets){.context = context, .count = labelling->table.count};
  job j = {.out = out, .options = options, .lattice = lattice};
  vxm_status status = vxm_label_components_create(&j.pieces, labelling, options, lattice, 0, error);
  if (status == VXM_OK)
    status = allocate(&j, error);
  if (status == VXM_OK) {
    find_pieces(&j);
    status = make_sets(&j, error);
  }
  for (int w = 0; j.scratches && w < vxm_context_threads(context); w++)
    vxm_label_component_scratch_destroy(&j.scratches[w], context);
  vxm_free(context, j.scratches);
  vxm_free(context, j.errors);
  vxm_free(context, j.small);
  vxm_free(context, j.first);
  vxm_label_components_destroy(&j.pieces);
  return status;
}

void vxm_label_sets_destroy(vxm_label_sets *sets) {
  for (size_t label = 0; sets->sets && label < sets->count; label++)
    vxm_sparse_destroy(sets->sets[label]);
  vxm_free(sets->context, sets->sets);
  *sets = (vxm_label_sets){.context = sets->context};
}
