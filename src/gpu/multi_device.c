/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/multi_device.h"
#include "base/clock.h"
#include "base/threads.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* ---- Who does what ---- */

typedef struct span {
  int64_t begin, end;
} span;

/** A run of all members; the mutex is of all but what does not change. */
typedef struct shared_run {
  vxm_multi_device *group;
  const vxm_multi_device_work *work;
  pthread_mutex_t mutex;
  pthread_cond_t change;
  span left[VXM_MULTI_DEVICE_MOST + 1]; /**< what nobody has begun, and what members failed to do */
  int left_count;
  bool has_begun[VXM_MULTI_DEVICE_MOST];
  int64_t done;
  int busy;         /**< threads that have not ended */
  atomic_bool stop; /**< what is under way is not needed any more */
  vxm_status status;
  vxm_error error;
} shared_run;

typedef struct seat {
  shared_run *run;
  int who;
} seat;

static double rates_of(const vxm_multi_device *group) {
  double sum = 0;
  for (int m = 0; m < group->count; m++)
    if (!group->members[m].is_lost && group->members[m].rate <= 0)
      return 0;
  for (int m = 0; m < group->count; m++)
    if (!group->members[m].is_lost)
      sum += group->members[m].rate;
  return sum;
}

static int count_members(const vxm_multi_device *group) {
  int count = 0;
  for (int m = 0; m < group->count; m++)
    count += !group->members[m].is_lost;
  return count;
}

/**
 * Takes a piece of what is left: first most of what is the member's by the speeds of all, where these are
 * known, else a half of that; then a half of its part of the rest, so that in the end all are done at about
 * the same time. False if nothing is left.
 */
static bool take(shared_run *run, int who, span *out) {
  const vxm_multi_device *group = run->group;
  if (run->left_count == 0 || atomic_load(&run->stop))
    return false;
  span *from = &run->left[run->left_count - 1];
  double rates = rates_of(group),
         part = rates > 0 ? group->members[who].rate / rates : 1.0 / count_members(group);
  double left = (double)(from->end - from->begin), all = (double)(run->work->end - run->work->begin);
  int64_t pieces =
      (int64_t)ceil(run->has_begun[who] ? 0.5 * part * left : (rates > 0 ? 0.85 : 0.5) * part * all);
  run->has_begun[who] = true;
  pieces = vxm_min(vxm_max(pieces, run->work->least), from->end - from->begin);
  *out = (span){from->begin, from->begin + pieces};
  from->begin += pieces;
  if (from->begin == from->end)
    run->left_count--;
  return true;
}

static void note_speed(vxm_multi_device_member *member, const span *piece, double ms) {
  double rate = (double)(piece->end - piece->begin) / (ms > 1e-3 ? ms : 1e-3);
  member->rate = member->rate > 0 ? (member->rate + rate) / 2 : rate;
}

static void lose(vxm_multi_device *group, int who, const vxm_error *error) {
  vxm_engine_info *info = &group->base.info;
  const vxm_engine *engine = group->members[who].engine;
  group->members[who].is_lost = true;
  info->devices--;
  info->lost_devices++;
  snprintf(info->note, sizeof info->note, "%.40s failed, so the others went on: %.150s", engine->info.name,
           error->text);
}

/** Work that was too much for some may be followed by less. */
static void give_back_the_small(vxm_multi_device *group) {
  vxm_engine_info *info = &group->base.info;
  for (int m = 0; m < group->count; m++)
    if (group->members[m].is_too_small) {
      group->members[m].is_lost = group->members[m].is_too_small = false;
      info->devices++;
      info->lost_devices--;
    }
  if (info->lost_devices == 0)
    info->note[0] = '\0';
}

/** Whether others may do what failed. */
static bool is_of_device(vxm_status status) {
  return status == VXM_ERROR_UNAVAILABLE || status == VXM_ERROR_MEMORY || status == VXM_ERROR_RANGE;
}

/** Takes note of what became of a piece. False where the member has to end. */
static bool account(shared_run *run, int who, const span *piece, double ms, vxm_status status,
                    const vxm_error *error) {
  if (status == VXM_OK) {
    note_speed(&run->group->members[who], piece, ms);
    run->done += piece->end - piece->begin;
    return true;
  }
  if (is_of_device(status)) {
    lose(run->group, who, error);
    run->group->members[who].is_too_small = status == VXM_ERROR_RANGE;
    run->left[run->left_count++] = *piece;
  }
  if (!is_of_device(status) || count_members(run->group) == 0) {
    if (run->status == VXM_OK) {
      run->status = status;
      run->error = *error;
    }
    atomic_store(&run->stop, true);
  }
  return false;
}

static void *work_along(void *argument) {
  seat *s = argument;
  shared_run *run = s->run;
  vxm_multi_device_member *member = &run->group->members[s->who];
  bool goes_on = true;
  span piece;
  vxm_worker_begin(&run->stop);
  pthread_mutex_lock(&run->mutex);
  while (goes_on && take(run, s->who, &piece)) {
    vxm_error error = VXM_ERROR_INIT;
    pthread_mutex_unlock(&run->mutex);
    double start = vxm_clock_ms();
    vxm_status status =
        run->work->function(member->engine, s->who, piece.begin, piece.end, run->work->payload, &error);
    double ms = vxm_clock_ms() - start;
    pthread_mutex_lock(&run->mutex);
    goes_on = account(run, s->who, &piece, ms, status, &error);
    pthread_cond_signal(&run->change);
  }
  run->busy--;
  pthread_cond_signal(&run->change);
  pthread_mutex_unlock(&run->mutex);
  return NULL;
}

/** The caller reports, and stops the others if it is told to. */
static void watch(shared_run *run) {
  enum { LOOK_MS = 20 };
  const vxm_multi_device_work *work = run->work;
  double all = (double)(work->end - work->begin);
  while (run->busy > 0) {
    struct timespec until;
    vxm_error local = VXM_ERROR_INIT;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += LOOK_MS * 1000000L;
    until.tv_sec += until.tv_nsec / 1000000000L;
    until.tv_nsec %= 1000000000L;
    pthread_cond_timedwait(&run->change, &run->mutex, &until);
    double done = (double)run->done / all;
    pthread_mutex_unlock(&run->mutex);
    vxm_status status = vxm_progress(run->group->base.context, work->phase, done, &local);
    pthread_mutex_lock(&run->mutex);
    if (status != VXM_OK && run->status == VXM_OK) {
      run->status = status;
      run->error = local;
      atomic_store(&run->stop, true);
    }
  }
}

/** One thread for each member that is left, until all have ended. */
static void run_once(shared_run *run) {
  pthread_t threads[VXM_MULTI_DEVICE_MOST];
  seat seats[VXM_MULTI_DEVICE_MOST];
  int started = 0;
  pthread_mutex_lock(&run->mutex);
  for (int m = 0; m < run->group->count; m++) {
    if (run->group->members[m].is_lost)
      continue;
    seats[started] = (seat){run, m};
    if (pthread_create(&threads[started], NULL, work_along, &seats[started]) != 0)
      break;
    run->busy++;
    started++;
  }
  if (started == 0) {
    run->status = vxm_fail(&run->error, VXM_ERROR_MEMORY, "no thread can be started for the devices");
    atomic_store(&run->stop, true);
  }
  watch(run);
  pthread_mutex_unlock(&run->mutex);
  for (int t = 0; t < started; t++)
    pthread_join(threads[t], NULL);
}

vxm_status vxm_multi_device_run(vxm_multi_device *group, const vxm_multi_device_work *work,
                                vxm_error *error) {
  shared_run run = {.group = group,
                    .work = work,
                    .left = {{work->begin, work->end}},
                    .left_count = 1,
                    .error = VXM_ERROR_INIT};
  if (work->begin >= work->end)
    return VXM_OK;
  if (count_members(group) == 0)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "no device is left: %.200s", group->base.info.note);
  pthread_mutex_init(&run.mutex, NULL);
  pthread_cond_init(&run.change, NULL);
  /* What a member fails to do may come back when the others have ended. */
  while (run.left_count > 0 && run.status == VXM_OK)
    run_once(&run);
  pthread_cond_destroy(&run.change);
  pthread_mutex_destroy(&run.mutex);
  give_back_the_small(group);
  if (run.status != VXM_OK)
    vxm_error_pass(error, &run.error);
  return run.status;
}

/* ---- Windows ---- */

enum { PIECES_MOST = 16 /**< of a window: each costs a look at all triangles */ };

static vxm_window part_of(const vxm_window *window, int64_t begin, int64_t end) {
  vxm_window part = *window;
  part.begin = begin;
  part.end = end;
  if (window->words)
    part.words = window->words + (size_t)(begin - window->begin) * window->slice_words;
  return part;
}

static vxm_multi_device_work work_on(const vxm_window *window, const char *phase,
                                     vxm_multi_device_fn function, void *payload) {
  return (vxm_multi_device_work){.begin = window->begin,
                                 .end = window->end,
                                 .least = (window->end - window->begin + PIECES_MOST - 1) / PIECES_MOST,
                                 .phase = phase,
                                 .function = function,
                                 .payload = payload};
}

typedef struct unite_work {
  const vxm_window *window;
  const vxm_parity_union_job *job;
} unite_work;

static vxm_status unite_part(vxm_engine *engine, int who, int64_t begin, int64_t end, void *payload,
                             vxm_error *error) {
  const unite_work *work = payload;
  vxm_window part = part_of(work->window, begin, end);
  (void)who;
  return engine->ops->unite(engine, &part, work->job, error);
}

static vxm_status unite(vxm_engine *base, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  vxm_multi_device_work work = work_on(window, job->phase, unite_part, &(unite_work){window, job});
  return vxm_multi_device_run(vxm_multi_device_of(base), &work, error);
}

typedef struct vote_work {
  const vxm_window *window;
  const vxm_vote_job *job;
  vxm_context *context;
  atomic_llong contested;
  atomic_bool added;
} vote_work;

/** What a device adds before it fails is taken back: the others would find less contested. */
static vxm_status vote_restorable(vxm_engine *engine, const vxm_window *part, const vxm_vote_job *job,
                                  vxm_vote_tally *tally, vxm_context *context, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t words = part->slice_words * (size_t)(part->end - part->begin);
  uint64_t *before = vxm_alloc(context, words, sizeof *before, &local);
  if (!before) {
    if (local.code == VXM_ERROR_MEMORY)
      local.code = VXM_ERROR_MEMORY_LIMIT; /* it is not the device's */
    vxm_error_pass(error, &local);
    return local.code;
  }
  memcpy(before, part->words, words * sizeof *before);
  vxm_status status = engine->ops->vote(engine, part, job, tally, error);
  if (status != VXM_OK)
    memcpy(part->words, before, words * sizeof *before);
  vxm_free(context, before);
  return status;
}

static vxm_status vote_part(vxm_engine *engine, int who, int64_t begin, int64_t end, void *payload,
                            vxm_error *error) {
  vote_work *work = payload;
  vxm_window part = part_of(work->window, begin, end);
  vxm_vote_tally tally = {0, false};
  (void)who;
  vxm_status status = vote_restorable(engine, &part, work->job, &tally, work->context, error);
  if (status != VXM_OK)
    return status;
  atomic_fetch_add(&work->contested, tally.contested);
  if (tally.added)
    atomic_store(&work->added, true);
  return VXM_OK;
}

static vxm_status vote(vxm_engine *base, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error) {
  vote_work votes = {.window = window, .job = job, .context = base->context};
  vxm_multi_device_work work = work_on(window, "voting", vote_part, &votes);
  vxm_status status = vxm_multi_device_run(vxm_multi_device_of(base), &work, error);
  tally->contested += atomic_load(&votes.contested);
  tally->added |= atomic_load(&votes.added);
  return status;
}

typedef struct surface_work {
  const vxm_window *window;
  const vxm_surface *surface;
  vxm_surface_kind kind;
  bool is_fresh;
} surface_work;

static vxm_status surface_part(vxm_engine *engine, int who, int64_t begin, int64_t end, void *payload,
                               vxm_error *error) {
  const surface_work *work = payload;
  vxm_window part = part_of(work->window, begin, end);
  (void)who;
  return engine->ops->surface(engine, work->surface, &part, work->kind, work->is_fresh, error);
}

static vxm_status surface(vxm_engine *base, const vxm_surface *faces, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  vxm_multi_device_work work =
      work_on(window, "voxelizing the surface", surface_part, &(surface_work){window, faces, kind, is_fresh});
  return vxm_multi_device_run(vxm_multi_device_of(base), &work, error);
}

/* ---- What one of them does for all ---- */

/** Goes through the members that are left and have an operation, until one does it. */
#define BY_ONE(group, operation, call, error)                                                      \
  do {                                                                                             \
    vxm_error local = VXM_ERROR_INIT;                                                              \
    vxm_fail(&local, VXM_ERROR_UNAVAILABLE, "no device is left: %.200s", (group)->base.info.note); \
    for (int m = 0; m < (group)->count; m++) {                                                     \
      vxm_engine *engine = (group)->members[m].engine;                                             \
      if ((group)->members[m].is_lost || !engine->ops->operation)                                  \
        continue;                                                                                  \
      local = (vxm_error)VXM_ERROR_INIT;                                                           \
      vxm_status status = call;                                                                    \
      if (status == VXM_OK)                                                                        \
        return VXM_OK;                                                                             \
      if (!is_of_device(status))                                                                   \
        break;                                                                                     \
      if (status != VXM_ERROR_RANGE)                                                               \
        lose(group, m, &local);                                                                    \
    }                                                                                              \
    vxm_error_pass(error, &local);                                                                 \
    return local.code;                                                                             \
  } while (0)

static vxm_status sparse(vxm_engine *base, vxm_sparse **out, const vxm_space *space,
                         const vxm_sparse_job *job, vxm_error *error) {
  vxm_multi_device *group = vxm_multi_device_of(base);
  BY_ONE(group, sparse, engine->ops->sparse(engine, out, space, job, &local), error);
}

static vxm_status color(vxm_engine *base, uint8_t *values, const vxm_color_job *job, vxm_error *error) {
  vxm_multi_device *group = vxm_multi_device_of(base);
  BY_ONE(group, color, engine->ops->color(engine, values, job, &local), error);
}

static vxm_status count(vxm_engine *base, uint16_t *counts, const vxm_window *window, int n,
                        vxm_error *error) {
  vxm_multi_device *group = vxm_multi_device_of(base);
  BY_ONE(group, count, engine->ops->count(engine, counts, window, n, &local), error);
}

/* ---- Making and freeing ---- */

static void destroy(vxm_engine *base) {
  vxm_multi_device *group = vxm_multi_device_of(base);
  for (int m = 0; m < group->count; m++)
    vxm_engine_destroy(group->members[m].engine);
  group->count = 0;
}

vxm_multi_device *vxm_multi_device_of(vxm_engine *engine) {
  return engine && engine->ops && engine->ops->destroy == destroy ? (vxm_multi_device *)engine : NULL;
}

/** Texts of all, one behind the other, as far as there is room. */
static void join(char *out, size_t size, const char *text, const char *between) {
  size_t used = strlen(out);
  snprintf(out + used, size - used, "%s%s", used > 0 ? between : "", text);
}

static void add(vxm_multi_device *group, vxm_engine *engine) {
  vxm_engine_info *info = &group->base.info;
  const vxm_engine_ops *ops = engine->ops;
  group->members[group->count++] = (vxm_multi_device_member){.engine = engine};
  join(info->name, sizeof info->name, engine->info.name, "+");
  join(info->renderer, sizeof info->renderer, engine->info.renderer, "; ");
  info->hardware |= engine->info.hardware;
  info->available = true;
  info->devices++;
  group->base.wants_apexes |= engine->wants_apexes;
  group->ops.sparse = ops->sparse ? sparse : group->ops.sparse;
  group->ops.color = ops->color ? color : group->ops.color;
  group->ops.count = ops->count ? count : group->ops.count;
}

vxm_status vxm_multi_device_create(vxm_engine **out, vxm_context *context, vxm_engine *const engines[],
                                   int number, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_multi_device *group = vxm_try_calloc(context, 1, sizeof *group, &status, error);
  if (!group) {
    for (int m = 0; m < number; m++)
      vxm_engine_destroy(engines[m]);
    return status;
  }
  group->ops = (vxm_engine_ops){.unite = unite, .vote = vote, .surface = surface, .destroy = destroy};
  group->base.ops = &group->ops;
  group->base.context = context;
  for (int m = 0; m < number; m++)
    add(group, engines[m]);
  *out = &group->base;
  return VXM_OK;
}
