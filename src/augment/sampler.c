/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/sampler.h"
#include "augment/unpack_bits.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "voxel/engine/engine.h"
#include "voxel/model/model_device_voxels.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- Making and freeing ---- */

static vxm_status copy_rotations(vxm_sampler *sampler, vxm_error *error) {
  vxm_sampler_options *options = &sampler->rules.options;
  if (options->rotation != VXM_ROTATION_LIST)
    return VXM_OK;
  vxm_status status = VXM_OK;
  size_t count = 9 * (size_t)options->rotation_count;
  sampler->rotations = vxm_try_alloc(sampler->context, count, sizeof *sampler->rotations, &status, error);
  if (!sampler->rotations)
    return status;
  memcpy(sampler->rotations, options->rotations, count * sizeof *sampler->rotations);
  options->rotations = sampler->rotations;
  return VXM_OK;
}

static void set_axis(vxm_pose_rules *rules) {
  const double *given = rules->options.axis;
  double longest = fmax(fabs(given[0]), fmax(fabs(given[1]), fabs(given[2]))), squared = 0;
  for (int a = 0; a < 3; a++) { /* squares of what is at most 1 neither overflow nor all vanish */
    rules->axis[a] = longest > 0 ? given[a] / longest : a == 2;
    squared += rules->axis[a] * rules->axis[a];
  }
  for (int a = 0; a < 3; a++)
    rules->axis[a] /= sqrt(squared);
}

vxm_status vxm_sampler_make(vxm_sampler **out, vxm_context *context, const vxm_sampler_options *options,
                            vxm_error *error) {
  vxm_context *own = NULL;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_context_acquire(&own, context, error);
  if (status != VXM_OK)
    return status;
  vxm_sampler *sampler = vxm_calloc(own, 1, sizeof *sampler, &local);
  if (!sampler) {
    vxm_context_release(own);
    vxm_error_pass(error, &local);
    return local.code;
  }
  sampler->context = own;
  sampler->rules.options = *options;
  sampler->rules.options.voxelize = NULL; /* it is the caller's */
  sampler->rules.voxelize = *options->voxelize;
  sampler->rules.reach = vxm_noise_reach(options->displacement, options->displace);
  set_axis(&sampler->rules);
  sampler->workers = vxm_calloc(own, (size_t)vxm_context_threads(own) + 1, sizeof *sampler->workers, &local);
  status = local.code;
  if (status == VXM_OK)
    status = copy_rotations(sampler, &local);
  if (status == VXM_OK)
    status = vxm_noise_create(&sampler->noise, own, options->seed, options->displacement, options->displace,
                              options->noise, &local);
  if (status == VXM_OK) {
    *out = sampler;
    return VXM_OK;
  }
  vxm_sampler_destroy(sampler);
  vxm_error_pass(error, &local);
  return status;
}

void vxm_sampler_destroy(vxm_sampler *sampler) {
  if (!sampler)
    return;
  vxm_context *context = sampler->context;
  for (int d = 0; sampler->workers && d <= vxm_context_threads(context); d++)
    vxm_worker_destroy(&sampler->workers[d]);
  for (int s = 0; s < VXM_MULTI_DEVICE_MOST; s++)
    vxm_worker_destroy(&sampler->seats[s]);
  for (size_t s = 0; s < sampler->subject_count; s++)
    vxm_sampler_model_destroy(&sampler->subjects[s]);
  vxm_noise_destroy(&sampler->noise, context);
  vxm_free(context, sampler->rotations);
  vxm_free(context, sampler->subjects);
  vxm_free(context, sampler->workers);
  vxm_free(context, sampler);
  vxm_context_release(context);
}

/* ---- Models ---- */

/** The first subject whose number is not below `model`. */
static size_t place_of(const vxm_sampler *sampler, uint32_t model) {
  size_t low = 0, high = sampler->subject_count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (sampler->subjects[middle].number < model)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bool is_there(const vxm_sampler *sampler, size_t place, uint32_t model) {
  return place < sampler->subject_count && sampler->subjects[place].number == model;
}

/** Desks must not go on with a model that is gone, or with another at the same address. */
static void detach(vxm_sampler *sampler) {
  for (int d = 0; d <= vxm_context_threads(sampler->context); d++)
    sampler->workers[d].instance.of = NULL;
  for (int s = 0; s < VXM_MULTI_DEVICE_MOST; s++)
    sampler->seats[s].instance.of = NULL;
}

static void take_out(vxm_sampler *sampler, size_t place) {
  detach(sampler);
  vxm_sampler_model_destroy(&sampler->subjects[place]);
  sampler->subject_count--;
  memmove(sampler->subjects + place, sampler->subjects + place + 1,
          (sampler->subject_count - place) * sizeof *sampler->subjects);
}

vxm_status vxm_sampler_set(vxm_sampler *sampler, uint32_t model, const vxm_soup *soup, vxm_error *error) {
  size_t place = place_of(sampler, model);
  if (is_there(sampler, place, model))
    take_out(sampler, place);
  if (!soup)
    return VXM_OK;
  vxm_sampler_model made;
  vxm_status status = vxm_grow(sampler->context, (void **)&sampler->subjects, &sampler->subject_capacity,
                               sampler->subject_count + 1, sizeof *sampler->subjects, error);
  if (status == VXM_OK)
    status = vxm_sampler_model_create(&made, model, soup, &sampler->rules.voxelize, &sampler->noise, error);
  if (status != VXM_OK)
    return status;
  memmove(sampler->subjects + place + 1, sampler->subjects + place,
          (sampler->subject_count - place) * sizeof *sampler->subjects);
  sampler->subjects[place] = made;
  sampler->subject_count++;
  return VXM_OK;
}

const vxm_sampler_model *vxm_sampler_find(const vxm_sampler *sampler, uint32_t model, vxm_error *error) {
  size_t place = place_of(sampler, model);
  if (is_there(sampler, place, model))
    return &sampler->subjects[place];
  vxm_fail(error, VXM_ERROR_ARGUMENT,
           "sampler: there is no model %" PRIu32 "; give it with vxm_sampler_put first", model);
  return NULL;
}

/* ---- One variant, by all threads ---- */

static vxm_status need_worker(vxm_sampler *sampler, int worker, bool alone, vxm_error *error) {
  vxm_worker *at = &sampler->workers[worker];
  return at->context ? VXM_OK : vxm_worker_create(at, sampler->context, alone, error);
}

/** The worker that all threads work for together. */
static vxm_status need_shared(vxm_worker **out, vxm_sampler *sampler, vxm_error *error) {
  int last = vxm_context_threads(sampler->context);
  *out = &sampler->workers[last];
  return need_worker(sampler, last, false, error);
}

vxm_status vxm_sampler_fill(vxm_sampler *sampler, vxm_grid *grid, const vxm_variant *variant,
                            vxm_error *error) {
  vxm_worker *worker;
  const vxm_sampler_model *subject = vxm_sampler_find(sampler, variant->model, error);
  if (!subject)
    return VXM_ERROR_ARGUMENT;
  vxm_status status = need_shared(&worker, sampler, error);
  if (status != VXM_OK)
    return status;
  vxm_placement placement;
  vxm_pose_draw(&placement, &sampler->rules, &subject->extent, variant);
  vxm_window window = vxm_window_of_grid(grid);
  return vxm_worker_fill(worker, &window, subject, &placement, &sampler->noise, error);
}

/* ---- Many variants ---- */

/** Grids up to this resolution are made by one thread each: they fit its cache, and need no waiting. */
enum { ALONE_MOST = 256 };

typedef struct batch_job {
  vxm_sampler *sampler;
  const vxm_variant *variants;
  /* into memory */
  unsigned char *out;
  size_t step;    /**< bytes of a variant */
  bool streaming; /**< all of them together do not stay in the cache */
  vxm_voxel_format voxels;
  /* or into files, if there are paths */
  const char *const *paths;
  const char *format;
  bool *written;
  vxm_task_progress progress;
  atomic_flag lock; /**< of what follows */
  atomic_size_t
      failed_at;   /**< the first in order that failed, whichever thread came first; SIZE_MAX = none */
  vxm_error error; /**< of that one */
} batch_job;

static vxm_status make_one(const batch_job *job, size_t v, vxm_worker *worker, vxm_error *error) {
  const vxm_sampler *sampler = job->sampler;
  const vxm_sampler_model *subject = vxm_sampler_find(sampler, job->variants[v].model, error);
  if (!subject)
    return VXM_ERROR_ARGUMENT;
  vxm_placement placement;
  vxm_pose_draw(&placement, &sampler->rules, &subject->extent, &job->variants[v]);
  int64_t resolution = sampler->rules.options.resolution;
  worker->streaming = job->streaming;
  if (!job->paths)
    return vxm_worker_write(worker, job->out + v * job->step, job->voxels, resolution,
                            sampler->rules.options.coverage, subject, &placement, &sampler->noise, error);
  vxm_status status = vxm_worker_save(worker, job->paths[v], job->format, resolution, subject, &placement,
                                      &sampler->noise, error);
  if (job->written)
    job->written[v] = status == VXM_OK;
  return status;
}

/** Those before it in order have all begun, and may still fail. */
static void note_failure(batch_job *job, size_t v, const vxm_error *error) {
  while (atomic_flag_test_and_set_explicit(&job->lock, memory_order_acquire))
    ;
  if (v < atomic_load(&job->failed_at)) {
    atomic_store(&job->failed_at, v);
    job->error = *error;
  }
  atomic_flag_clear_explicit(&job->lock, memory_order_release);
  atomic_store_explicit(&job->progress.stop, true, memory_order_release);
}

static void make_task(size_t v, int worker, void *payload) {
  batch_job *job = payload;
  if (vxm_task_progress_stopped(&job->progress, worker)) {
    atomic_thread_fence(memory_order_acquire);
    size_t failed_at = atomic_load(&job->failed_at);
    if (failed_at == SIZE_MAX || v > failed_at)
      return; /* one before the failure is made all the same, as it may fail too */
  }
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = make_one(job, v, &job->sampler->workers[worker], &error);
  if (status != VXM_OK)
    note_failure(job, v, &error);
  vxm_task_progress_step(&job->progress);
}

/** One variant for each thread at a time. */
static vxm_status make_alone(batch_job *job, size_t count, vxm_error *error) {
  vxm_sampler *sampler = job->sampler;
  for (int d = 0; d < vxm_context_threads(sampler->context); d++) {
    vxm_status status = need_worker(sampler, d, true, error);
    if (status != VXM_OK)
      return status;
  }
  vxm_task_progress_start(&job->progress, sampler->context, "making variants", count, error);
  vxm_parallel(sampler->context, count, make_task, job);
  if (atomic_load(&job->failed_at) == SIZE_MAX)
    return vxm_task_progress_end(&job->progress);
  vxm_error_pass(error, &job->error);
  return job->error.code;
}

/** Variants by one of several devices that work at once. That a file cannot be written is no fault of the
 * device, for which the group would take it: it ends the work. */
static vxm_status make_there(vxm_engine *engine, int who, int64_t begin, int64_t end, void *payload,
                             vxm_error *error) {
  batch_job *job = payload;
  vxm_worker *seat = &job->sampler->seats[who];
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = seat->context ? VXM_OK : vxm_worker_create(seat, job->sampler->context, true, &local);
  seat->engine = engine;
  seat->write_failed = false;
  for (int64_t v = begin; v < end && status == VXM_OK; v++) {
    status = make_one(job, (size_t)v, seat, &local);
    if (status != VXM_OK && seat->write_failed) {
      note_failure(job, (size_t)v, &local);
      return VXM_ERROR_CANCELLED;
    }
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status make_by_group(batch_job *job, vxm_multi_device *group, size_t count, vxm_error *error) {
  vxm_multi_device_work work = {
      .end = (int64_t)count, .least = 1, .phase = "making variants", .function = make_there, .payload = job};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_multi_device_run(group, &work, &local);
  if (status == VXM_OK)
    return VXM_OK;
  const vxm_error *told = atomic_load(&job->failed_at) == SIZE_MAX ? &local : &job->error;
  vxm_error_pass(error, told);
  return told->code;
}

/** Whether variants are made by something that does one thing at a time. */
static bool has_engine(const vxm_sampler *sampler) {
  const vxm_engine *engine = sampler->rules.voxelize.engine;
  return engine && engine->ops;
}

static vxm_status make_all(batch_job *job, size_t count, vxm_error *error) {
  vxm_sampler *sampler = job->sampler;
  job->error = (vxm_error)VXM_ERROR_INIT;
  atomic_init(&job->failed_at, SIZE_MAX);
  atomic_flag_clear(&job->lock);
  const vxm_sampler_options *options = &sampler->rules.options;
  int64_t dim = options->resolution * (options->coverage > 0 ? options->coverage : 1);
  if (count > 1 && dim <= ALONE_MOST && !has_engine(sampler))
    return make_alone(job, count, error);
  vxm_multi_device *group = vxm_multi_device_of(sampler->rules.voxelize.engine);
  if (group && count > 1)
    return make_by_group(job, group, count, error);
  vxm_worker *worker;
  vxm_status status = need_shared(&worker, sampler, error);
  for (size_t v = 0; v < count && status == VXM_OK; v++)
    status = make_one(job, v, worker, error);
  return status;
}

vxm_status vxm_sampler_write(vxm_sampler *sampler, void *out, const vxm_variant *variants, size_t count,
                             vxm_voxel_format voxels, vxm_error *error) {
  const size_t large = 1 << 25; /* bytes */
  size_t n = (size_t)sampler->rules.options.resolution;
  size_t step = vxm_unpack_row_bytes(voxels, (int64_t)n) * n * n;
  batch_job job = {.sampler = sampler,
                   .variants = variants,
                   .out = out,
                   .step = step,
                   .streaming = count > large / step,
                   .voxels = voxels};
  return make_all(&job, count, error);
}

static vxm_status keep_one(vxm_device_voxels *voxels, vxm_sampler *sampler, vxm_worker *worker, size_t index,
                           const vxm_variant *variant, vxm_error *error) {
  const vxm_sampler_model *subject = vxm_sampler_find(sampler, variant->model, error);
  if (!subject)
    return VXM_ERROR_ARGUMENT;
  vxm_placement placement;
  vxm_pose_draw(&placement, &sampler->rules, &subject->extent, variant);
  return vxm_worker_keep(worker, voxels, (int64_t)index, subject, &placement, &sampler->noise, error);
}

vxm_status vxm_sampler_keep(vxm_device_voxels **out, vxm_sampler *sampler, const vxm_variant *variants,
                            size_t count, vxm_voxel_format format, vxm_error *error) {
  vxm_device_voxels *voxels = NULL;
  vxm_worker *worker;
  if (sampler->rules.options.coverage > 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "voxels on a device: this sampler makes densities, which vxm_sampler_batch alone gives");
  vxm_space space = vxm_worker_space(sampler->rules.options.resolution);
  vxm_status status = need_shared(&worker, sampler, error);
  if (status == VXM_OK)
    status = vxm_device_voxels_create(&voxels, sampler->rules.voxelize.engine, &space, (int64_t)count, format,
                                      error);
  if (status != VXM_OK)
    return status;
  voxels->is_batch = true;
  for (size_t v = 0; v < count && status == VXM_OK; v++)
    status = keep_one(voxels, sampler, worker, v, &variants[v], error);
  if (status == VXM_OK)
    *out = voxels;
  else
    vxm_device_voxels_drop(voxels);
  return status;
}

vxm_status vxm_sampler_save(vxm_sampler *sampler, const char *const *paths, const vxm_variant *variants,
                            size_t count, const char *format, bool *written, vxm_error *error) {
  batch_job job = {
      .sampler = sampler, .variants = variants, .paths = paths, .format = format, .written = written};
  return make_all(&job, count, error);
}
