/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/slabs.h"
#include "base/threads.h"

enum {
  SCRATCH_WORDS = 1 << 15, /* 256 KiB: half of a usual second-level cache */
  SLABS_PER_THREAD = 4     /* so that threads end at about the same time */
};

/** Facets by slab: slab s takes list[begin[s]] to list[begin[s + 1] - 1], in the order of their parts. */
typedef struct bins {
  size_t *begin;
  size_t *list;
} bins;

typedef struct unite_state {
  const vxm_unite_job *job;
  vxm_grid *grid;
  vxm_facet_fn draw;
  vxm_fold_fn fold;
  int64_t thickness, rows;
  size_t slab_count;
  bins bins;
  uint64_t *scratch; /**< scratch_words for each worker, zero between parts */
  size_t scratch_words;
  atomic_size_t done;
  atomic_bool stop;
  vxm_status status;
  vxm_error *error;
} unite_state;

static int64_t clamp(int64_t value, int64_t low, int64_t high) {
  return value < low ? low : value > high ? high : value;
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

/** Shapes the scratch for a box; words is left to the caller. */
static vxm_scratch scratch_for(const vxm_unite_job *job, const vxm_box *box) {
  vxm_scratch s = {.raster = {.lattice = job->lattice, .axes = job->axes, .box = *box}};
  bool along_w = job->axes.w == 0;
  int64_t x_begin = along_w ? box->w_begin : box->u_begin, x_end = along_w ? box->w_end : box->u_end;
  s.raster.x_first = x_begin / 64 * 64;
  s.row_words = (size_t)((x_end - s.raster.x_first + 63) / 64);
  s.u_rows = along_w ? (size_t)(box->u_end - box->u_begin) : 1;
  s.w_rows = along_w ? 1 : (size_t)(box->w_end - box->w_begin);
  s.v_rows = (size_t)(box->v_end - box->v_begin);
  s.raster.u_stride = s.raster.w_stride = s.row_words;
  s.raster.v_stride = s.row_words * s.u_rows * s.w_rows;
  return s;
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
    int64_t at = points[corner].at[v];
    low = at < low ? at : low;
    high = at > high ? at : high;
  }
  int64_t begin = vxm_lattice_first(job->lattice, low), end = vxm_lattice_last(job->lattice, high) + 1;
  begin = begin < 0 ? 0 : begin;
  end = end > state->rows ? state->rows : end;
  if (begin >= end)
    return false;
  *first = (size_t)(begin / state->thickness);
  *last = (size_t)((end - 1) / state->thickness);
  return true;
}

/** Counts (list NULL) or lists the facets of each slab; after listing, begin[s] has moved to the end of slab
 * s. */
static void sort_facets(unite_state *state, size_t *counter, size_t *list) {
  const vxm_facets *facets = state->job->facets;
  size_t begin = facets->parts[state->job->part_begin].begin,
         end = facets->parts[state->job->part_end - 1].end;
  for (size_t f = begin; f < end; f++) {
    size_t first, last;
    if (!(vxm_facet_role_of(facets, &facets->facets[f]) & state->job->roles))
      continue;
    if (!facet_slabs(state, &facets->facets[f], &first, &last))
      continue;
    for (size_t s = first; s <= last; s++)
      if (list)
        list[counter[s]++] = f;
      else
        counter[s]++;
  }
}

static vxm_status make_bins(unite_state *state, vxm_error *error) {
  vxm_context *context = state->grid->context;
  vxm_error local = VXM_ERROR_INIT;
  bins *b = &state->bins;
  b->begin = vxm_calloc(context, state->slab_count + 2, sizeof *b->begin, &local);
  if (b->begin) {
    /* Counted two places further on, the sums become the begins, and listing moves them to the next begins.
     */
    sort_facets(state, b->begin + 2, NULL);
    for (size_t s = 2; s < state->slab_count + 2; s++)
      b->begin[s] += b->begin[s - 1];
    b->list = vxm_alloc(context, b->begin[state->slab_count + 1], sizeof *b->list, &local);
  }
  if (!b->begin || !b->list) {
    if (error)
      *error = local;
    return local.code;
  }
  sort_facets(state, b->begin + 1, b->list);
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
    vxm_scratch s = scratch_for(job, &box);
    per_row = s.raster.v_stride > per_row ? s.raster.v_stride : per_row;
  }
  state->rows = job->lattice->space.dims[job->axes.v];
  int threads = vxm_context_threads(state->grid->context);
  int64_t shares = threads > 1 ? (int64_t)threads * SLABS_PER_THREAD : 1;
  int64_t even = (state->rows + shares - 1) / shares, cached = (int64_t)(SCRATCH_WORDS / per_row);
  state->thickness = clamp(cached < even ? cached : even, 1, state->rows);
  state->slab_count = (size_t)((state->rows + state->thickness - 1) / state->thickness);
  state->scratch_words = per_row * (size_t)state->thickness;
}

/* ---- Doing a slab ---- */

static void do_part(unite_state *state, uint64_t *words, size_t slab, const size_t *list, size_t count) {
  const vxm_unite_job *job = state->job;
  const vxm_facet *facets = job->facets->facets;
  uint32_t part = facets[list[0]].part;
  vxm_box box;
  if (!part_box(job, &job->facets->parts[part], &box))
    return;
  int64_t begin = (int64_t)slab * state->thickness, end = begin + state->thickness;
  box.v_begin = box.v_begin > begin ? box.v_begin : begin;
  box.v_end = box.v_end < end ? box.v_end : end;
  if (box.v_begin >= box.v_end)
    return;
  vxm_scratch scratch = scratch_for(job, &box);
  scratch.raster.words = words;
  for (size_t i = 0; i < count; i++)
    state->draw(job, &facets[list[i]], &scratch);
  bool any = state->fold(state->grid, &scratch);
  if (any && job->touched)
    atomic_store_explicit(&job->touched[part], 1, memory_order_relaxed);
}

static void do_slab(size_t slab, int worker, void *payload) {
  unite_state *state = payload;
  if (atomic_load_explicit(&state->stop, memory_order_relaxed))
    return;
  uint64_t *words = state->scratch + (size_t)worker * state->scratch_words;
  const vxm_facet *facets = state->job->facets->facets;
  const size_t *list = state->bins.list;
  size_t i = state->bins.begin[slab], end = state->bins.begin[slab + 1];
  while (i < end) {
    size_t next = i + 1;
    while (next < end && facets[list[next]].part == facets[list[i]].part)
      next++;
    do_part(state, words, slab, list + i, next - i);
    i = next;
  }
  size_t done = atomic_fetch_add_explicit(&state->done, 1, memory_order_relaxed) + 1;
  if (worker != 0)
    return; /* worker 0 is the calling thread, the only one that may report progress */
  double fraction = (double)done / (double)state->slab_count;
  vxm_status status = vxm_progress(state->grid->context, state->job->phase, fraction, state->error);
  if (status != VXM_OK) {
    state->status = status;
    atomic_store_explicit(&state->stop, true, memory_order_relaxed);
  }
}

vxm_status vxm_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_facet_fn draw, vxm_fold_fn fold,
                     vxm_error *error) {
  if (job->part_begin >= job->part_end)
    return VXM_OK;
  vxm_context *context = grid->context;
  unite_state state = {.job = job, .grid = grid, .draw = draw, .fold = fold, .error = error};
  atomic_init(&state.done, 0);
  atomic_init(&state.stop, false);
  choose_slabs(&state);
  vxm_status status = make_bins(&state, error);
  if (status == VXM_OK) {
    vxm_error local = VXM_ERROR_INIT;
    size_t workers = (size_t)vxm_context_threads(context);
    state.scratch = vxm_calloc(context, state.scratch_words * workers, sizeof *state.scratch, &local);
    if (state.scratch) {
      vxm_parallel(context, state.slab_count, do_slab, &state);
      status = state.status;
    } else {
      status = local.code;
      if (error)
        *error = local;
    }
  }
  vxm_free(context, state.scratch);
  vxm_free(context, state.bins.list);
  vxm_free(context, state.bins.begin);
  return status;
}
