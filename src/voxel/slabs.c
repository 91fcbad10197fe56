/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/slabs.h"
#include "base/threads.h"

enum {
  SCRATCH_WORDS = 1 << 15, /**< 256 KiB: half of a usual second-level cache */
  SLABS_PER_THREAD = 4,    /**< so that threads end at about the same time */
  POLL_FACETS = 256,       /**< facets between two looks at the progress callback */
  LISTED_MIN = 1 << 20     /**< facets listed at once, at least */
};

/** Facets by slab: slab first + s takes list[begin[s]] to list[begin[s + 1] - 1], in the order of their
 * parts. */
typedef struct batch {
  size_t first, count;
  size_t *begin;
  uint32_t *list;
} batch;

typedef struct unite_state {
  const vxm_unite_job *job;
  vxm_context *context;
  vxm_grid *grid;
  vxm_facet_fn draw;
  vxm_fold_fn fold;
  int64_t thickness, rows;
  size_t slab_count, workers;
  batch batch;
  uint64_t *words; /**< words_each for each worker, zero between parts */
  size_t words_each;
  vxm_span *spans; /**< `thickness` for each worker, empty between parts */
  atomic_size_t done;
  atomic_bool stop;
  vxm_status status;
  vxm_error *error;
} unite_state;

static int64_t clamp(int64_t value, int64_t low, int64_t high) {
  return vxm_min(vxm_max(value, low), high);
}

/** Voxels of a part along one axis, cut to [0, n); empty where begin = end. */
static void part_range(const vxm_lattice *lattice, const vxm_part *part, int axis, int64_t extra,
                       int64_t *begin, int64_t *end) {
  int64_t n = lattice->space.dims[axis];
  *begin = clamp(vxm_lattice_first(lattice, part->low.at[axis]), 0, n);
  *end = clamp(vxm_lattice_last(lattice, part->high.at[axis]) + 1 + extra, *begin, n);
}

/** The box in which a part flips bits: along w one more voxel, the first behind the part. */
static bool part_box(const vxm_unite_job *job, const vxm_part *part, vxm_box *box) {
  part_range(job->lattice, part, job->axes.u, 0, &box->u_begin, &box->u_end);
  part_range(job->lattice, part, job->axes.v, 0, &box->v_begin, &box->v_end);
  part_range(job->lattice, part, job->axes.w, 1, &box->w_begin, &box->w_end);
  /* A part that lies wholly before the grid still flips the first voxel of its columns. */
  if (box->w_begin == 0 && box->w_end == 0)
    box->w_end = 1;
  return box->u_begin < box->u_end && box->v_begin < box->v_end && box->w_begin < box->w_end;
}

/** The raster of a box, without its memory. */
static vxm_raster raster_of(const vxm_unite_job *job, const vxm_box *box) {
  bool along_w = job->axes.w == 0;
  int64_t x_begin = along_w ? box->w_begin : box->u_begin, x_end = along_w ? box->w_end : box->u_end;
  vxm_raster raster = {.lattice = job->lattice, .axes = job->axes, .box = *box, .x_first = x_begin / 64 * 64};
  raster.row_words = (size_t)((x_end - raster.x_first + 63) / 64);
  raster.v_stride =
      raster.row_words * (size_t)(along_w ? box->u_end - box->u_begin : box->w_end - box->w_begin);
  return raster;
}

/* ---- Sorting facets into slabs ---- */

/** First and last slab that a facet may touch; false if it covers no row of voxel centres. */
static bool facet_slabs(const unite_state *state, const vxm_facet *facet, size_t *first, size_t *last) {
  const vxm_unite_job *job = state->job;
  const vxm_point *points = job->facets->points;
  int v = job->axes.v;
  int64_t low = INT64_MAX, high = INT64_MIN;
  for (int k = 0; k < (job->to_apex ? 4 : 3); k++) {
    uint32_t corner = k < 3 ? facet->corner[k] : job->facets->parts[facet->part].apex;
    low = vxm_min(low, points[corner].at[v]);
    high = vxm_max(high, points[corner].at[v]);
  }
  int64_t begin = vxm_max(vxm_lattice_first(job->lattice, low), 0);
  int64_t end = vxm_min(vxm_lattice_last(job->lattice, high) + 1, state->rows);
  if (begin >= end)
    return false;
  *first = (size_t)(begin / state->thickness);
  *last = (size_t)((end - 1) / state->thickness);
  return true;
}

/**
 * Counts the facets of slabs first..end-1 (list NULL), or lists them; counter[s] belongs to slab first + s,
 * and after listing it has moved to the end of its slab.
 */
static void sort_facets(const unite_state *state, size_t first, size_t end, size_t *counter, uint32_t *list) {
  const vxm_facets *facets = state->job->facets;
  size_t f_end = facets->parts[state->job->part_end - 1].end;
  for (size_t f = facets->parts[state->job->part_begin].begin; f < f_end; f++) {
    size_t low, high;
    if (!(facets->facets[f].role & state->job->roles) || !facet_slabs(state, &facets->facets[f], &low, &high))
      continue;
    for (size_t s = low < first ? first : low; s <= high && s < end; s++)
      if (list)
        list[counter[s - first]++] = (uint32_t)f;
      else
        counter[s - first]++;
  }
}

/**
 * Takes as many slabs from b->first on as keep the list short, though at least one: a facet as tall as the
 * grid is listed in every slab, and the list must not outgrow the facets. counts[s] is the number of facets
 * of slab s.
 */
static vxm_status list_batch(unite_state *state, const size_t *counts, vxm_error *error) {
  batch *b = &state->batch;
  size_t listed_max = 4 * state->job->facets->facet_count + LISTED_MIN, total = 0;
  b->begin[0] = b->begin[1] = 0;
  for (b->count = 0; b->first + b->count < state->slab_count; b->count++) {
    size_t next = total + counts[b->first + b->count];
    if (b->count > 0 && next > listed_max)
      break;
    b->begin[b->count + 1] = total; /* listing moves this begin to the next one */
    total = next;
  }
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(state->context, b->list);
  b->list = vxm_alloc(state->context, total, sizeof *b->list, &local);
  if (!b->list) {
    if (error)
      *error = local;
    return local.code;
  }
  sort_facets(state, b->first, b->first + b->count, b->begin + 1, b->list);
  return VXM_OK;
}

/* ---- Shape of the slabs ---- */

/** Rows per slab such that the largest scratch fits the cache and every thread has work. */
static void choose_slabs(unite_state *state) {
  const vxm_unite_job *job = state->job;
  size_t per_row = 1;
  for (size_t p = job->part_begin; p < job->part_end; p++) {
    vxm_box box;
    if (!part_box(job, &job->facets->parts[p], &box))
      continue;
    size_t words = raster_of(job, &box).v_stride;
    per_row = words > per_row ? words : per_row;
  }
  state->rows = job->lattice->space.dims[job->axes.v];
  int threads = vxm_context_threads(state->context);
  int64_t shares = threads > 1 ? (int64_t)threads * SLABS_PER_THREAD : 1;
  int64_t even = (state->rows + shares - 1) / shares, cached = (int64_t)(SCRATCH_WORDS / per_row);
  state->thickness = clamp(vxm_min(cached, even), 1, state->rows);
  state->slab_count = (size_t)((state->rows + state->thickness - 1) / state->thickness);
  state->workers = (size_t)threads < state->slab_count ? (size_t)threads : state->slab_count;
  state->words_each = per_row * (size_t)state->thickness;
}

/* ---- Doing a slab ---- */

/** Worker 0 is the calling thread, the only one that may report progress; the others only look whether to
 * stop. */
static bool is_stopped(unite_state *state, int worker) {
  if (worker == 0 && state->status == VXM_OK) {
    size_t done = atomic_load_explicit(&state->done, memory_order_relaxed);
    double fraction = (double)done / (double)state->slab_count;
    state->status = vxm_progress(state->context, state->job->phase, fraction, state->error);
    if (state->status != VXM_OK)
      atomic_store_explicit(&state->stop, true, memory_order_relaxed);
  }
  return atomic_load_explicit(&state->stop, memory_order_relaxed);
}

/** `place` is where the scratch of the calling task lies. */
static void do_part(unite_state *state, int worker, size_t place, size_t slab, const uint32_t *list,
                    size_t count) {
  const vxm_unite_job *job = state->job;
  const vxm_facet *facets = job->facets->facets;
  uint32_t part = facets[list[0]].part;
  vxm_box box;
  if (!part_box(job, &job->facets->parts[part], &box))
    return;
  int64_t begin = (int64_t)slab * state->thickness;
  box.v_begin = vxm_max(box.v_begin, begin);
  box.v_end = vxm_min(box.v_end, begin + state->thickness);
  if (box.v_begin >= box.v_end)
    return;
  vxm_raster raster = raster_of(job, &box);
  raster.words = state->words + place * state->words_each;
  raster.spans = state->spans + place * (size_t)state->thickness;
  for (size_t i = 0; i < count; i++) {
    state->draw(job, &facets[list[i]], &raster);
    if (i % POLL_FACETS == POLL_FACETS - 1 && is_stopped(state, worker))
      return; /* what was drawn stays in the scratch, which nobody uses any more */
  }
  bool any = state->fold(state->grid, &raster);
  if (any && job->touched)
    atomic_store_explicit(&job->touched[part], 1, memory_order_relaxed);
}

static void do_slab(size_t task, int worker, void *payload) {
  unite_state *state = payload;
  const batch *b = &state->batch;
  const vxm_facet *facets = state->job->facets->facets;
  /* With no more slabs than threads each slab has a scratch of its own. */
  size_t place = state->slab_count == state->workers ? task : (size_t)worker;
  if (is_stopped(state, worker))
    return;
  size_t i = b->begin[task], end = b->begin[task + 1];
  while (i < end) {
    size_t next = i + 1;
    while (next < end && facets[b->list[next]].part == facets[b->list[i]].part)
      next++;
    do_part(state, worker, place, b->first + task, b->list + i, next - i);
    i = next;
  }
  atomic_fetch_add_explicit(&state->done, 1, memory_order_relaxed);
}

static vxm_status do_batches(unite_state *state, const size_t *counts, vxm_error *error) {
  vxm_status status = VXM_OK;
  while (state->batch.first < state->slab_count && status == VXM_OK) {
    status = list_batch(state, counts, error);
    if (status != VXM_OK)
      break;
    vxm_parallel(state->context, state->batch.count, do_slab, state);
    status = state->status;
    state->batch.first += state->batch.count;
  }
  /* Other threads may have taken all slabs: ask once more, so that no wish to stop is missed. */
  return status == VXM_OK ? vxm_progress(state->context, state->job->phase, 1.0, error) : status;
}

vxm_status vxm_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_facet_fn draw, vxm_fold_fn fold,
                     vxm_error *error) {
  if (job->part_begin >= job->part_end)
    return VXM_OK;
  vxm_context *context = grid->context;
  unite_state state = {
      .job = job, .context = context, .grid = grid, .draw = draw, .fold = fold, .error = error};
  atomic_init(&state.done, 0);
  atomic_init(&state.stop, false);
  choose_slabs(&state);
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_OK;
  size_t *counts = vxm_calloc(context, state.slab_count, sizeof *counts, &local);
  state.batch.begin = vxm_calloc(context, state.slab_count + 2, sizeof *state.batch.begin, &local);
  state.words = vxm_calloc(context, state.words_each * state.workers, sizeof *state.words, &local);
  state.spans = vxm_calloc(context, (size_t)state.thickness * state.workers, sizeof *state.spans, &local);
  if (counts && state.batch.begin && state.words && state.spans) {
    sort_facets(&state, 0, state.slab_count, counts, NULL);
    status = do_batches(&state, counts, error);
  } else {
    status = local.code;
    if (error)
      *error = local;
  }
  vxm_free(context, state.spans);
  vxm_free(context, state.words);
  vxm_free(context, state.batch.list);
  vxm_free(context, state.batch.begin);
  vxm_free(context, counts);
  return status;
}
