/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/poll.h"
#include "base/threads.h"

#include <string.h>

enum { VOTERS = 4 };

typedef struct poll_state {
  vxm_workspace *workspace;
  const vxm_window *window;
  const vxm_poll_job *job;
  const vxm_kernels *kernels;
  vxm_columns columns[VOTERS];
  size_t voters;
  vxm_slabs slabs;
  size_t stripes;
  size_t words_each; /**< scratch of a worker: a slab for each voter, and a slice */
  bool past;         /**< the window is larger than caches */
  uint64_t *carries; /**< a slice for each stripe, and one for the end */
  atomic_int_fast64_t contested;
  atomic_bool added;
  vxm_watch watch;
} poll_state;

static size_t stripe_begin(const poll_state *state, size_t stripe) {
  return vxm_slice_begin(state->slabs.count, state->stripes, stripe);
}

static void flip_piece(uint64_t *words, const vxm_bin_piece *piece) {
  if (piece->is_bitmap)
    for (size_t w = 0; w < piece->count; w++)
      words[w] ^= piece->data[w];
  else
    for (size_t i = 0; i < piece->count; i++)
      words[piece->data[i] / 64] ^= UINT64_C(1) << (piece->data[i] % 64);
}

/** Flips what all threads put into the bins of a slab. */
static void flip_slab(const poll_state *state, size_t voter, size_t slab, uint64_t *words) {
  vxm_bins *bins = &state->workspace->bins;
  vxm_bin_piece piece;
  for (size_t w = 0; w < bins->workers; w++) {
    vxm_bin_reader reader = vxm_bin_read(vxm_bins_at(bins, w, voter, slab), true);
    while (reader.part != VXM_BIN_NONE)
      while (vxm_bin_next(&reader, &piece))
        flip_piece(words, &piece);
  }
}

/** What is open along slices at the begin of a stripe but for the flips before the window: all flips of the
 * slabs of the stripe before it, put into one slice. */
static void sum_stripe(size_t stripe, int worker, void *payload) {
  poll_state *state = payload;
  const vxm_window *window = state->window;
  uint64_t *carry = state->carries + (stripe + 1) * window->slice_words;
  uint64_t *words = state->workspace->scratch + (size_t)worker * state->words_each;
  memset(carry, 0, window->slice_words * sizeof *carry);
  if (stripe + 1 == state->stripes || vxm_watch_stopped(&state->watch, worker))
    return;
  for (size_t slab = stripe_begin(state, stripe); slab < stripe_begin(state, stripe + 1); slab++) {
    flip_slab(state, (size_t)window->layout.slow, slab, words);
    for (size_t k = 0; k < state->slabs.words; k += window->slice_words)
      for (size_t w = 0; w < window->slice_words; w++) {
        carry[w] ^= words[k + w];
        words[k + w] = 0;
      }
  }
}

/** Folds a voter in its slab. Before the words of the voter along slices lies a slice with what is open. */
static void fold_voter(const poll_state *state, size_t voter, uint64_t *words, size_t slices) {
  const vxm_window *window = state->window;
  const vxm_kernels *kernels = state->kernels;
  int axis = state->columns[voter].w;
  if (axis == window->layout.fast)
    kernels->fold_rows(words, window->row_words, slices * (size_t)window->middle_dim,
                       vxm_window_tail_mask(window));
  else if (axis == window->layout.middle)
    for (size_t k = 0; k < slices; k++)
      kernels->fold_across(words + k * window->slice_words, window->row_words, window->slice_words);
  else
    kernels->fold_across(words - window->slice_words, window->slice_words,
                         (slices + 1) * window->slice_words);
}

static void do_stripe(size_t stripe, int worker, void *payload) {
  poll_state *state = payload;
  const vxm_window *window = state->window;
  size_t slice = window->slice_words, slow = (size_t)window->layout.slow;
  uint64_t *carry = state->carries + stripe * slice, added = 0;
  uint64_t *scratch = state->workspace->scratch + (size_t)worker * state->words_each;
  uint64_t *words[VOTERS] = {NULL};
  int64_t contested = 0;
  for (size_t v = 0; v < state->voters; v++)
    words[v] = scratch + v * state->slabs.words + (v >= slow ? slice : 0);
  for (size_t slab = stripe_begin(state, stripe); slab < stripe_begin(state, stripe + 1); slab++) {
    if (vxm_watch_stopped(&state->watch, worker))
      break;
    int64_t first = (int64_t)slab << state->slabs.shift;
    size_t slices = (size_t)vxm_min(INT64_C(1) << state->slabs.shift, state->slabs.layers - first);
    size_t count = slices * slice, at = (size_t)first * slice;
    memcpy(words[slow] - slice, carry, slice * sizeof *carry);
    for (size_t v = 0; v < state->voters; v++) {
      flip_slab(state, v, slab, words[v]);
      fold_voter(state, v, words[v], slices);
    }
    memcpy(carry, words[slow] + count - slice, slice * sizeof *carry);
    contested += state->kernels->vote(window->words + at, (const uint64_t *const *)words,
                                      state->job->mask ? state->job->mask + at : NULL, count,
                                      state->job->rule, state->job->fresh, state->past, &added);
    memset(scratch, 0, state->words_each * sizeof *scratch);
    vxm_watch_step(&state->watch);
  }
  atomic_fetch_add_explicit(&state->contested, contested, memory_order_relaxed);
  if (added)
    atomic_store_explicit(&state->added, true, memory_order_relaxed);
}

static void shape(poll_state *state) {
  const vxm_window *window = state->window;
  const vxm_poll_job *job = state->job;
  const vxm_part *part = &job->facets->parts[job->part];
  int threads = vxm_context_threads(state->workspace->context);
  state->voters = job->tetra ? VOTERS : 3;
  state->slabs = vxm_slabs_of(window->end - window->begin, window->slice_words, threads);
  state->stripes = (size_t)threads < state->slabs.count ? (size_t)threads : state->slabs.count;
  state->words_each = state->voters * state->slabs.words + window->slice_words;
  state->past = job->fresh && vxm_window_is_large(window);
  for (size_t v = 0; v < state->voters; v++) {
    int axis = v == 3 ? window->layout.fast : (int)v; /* with cones the part is closed: any axis tells */
    vxm_columns *columns = &state->columns[v];
    *columns = vxm_columns_of(window, axis);
    columns->roles = v == 3 ? VXM_FACET_TRIANGLE | VXM_FACET_CONE : VXM_FACET_TRIANGLE;
    columns->facet_begin = part->begin;
    columns->facet_end = vxm_roles_end(job->facets, job->part, columns->roles);
    columns->slab_shift = state->slabs.shift;
    if (axis == window->layout.slow) {
      columns->slab_axis = axis;
      columns->keep_before = window->begin == 0; /* else the window before has carried it on */
    }
  }
}

static void run_stripes(poll_state *state) {
  const vxm_window *window = state->window;
  vxm_context *context = state->workspace->context;
  size_t slice = window->slice_words;
  memcpy(state->carries, state->job->carry, slice * sizeof *state->carries);
  if (state->stripes > 1)
    vxm_parallel(context, state->stripes, sum_stripe, state);
  for (size_t s = 1; s < state->stripes; s++)
    for (size_t w = 0; w < slice; w++)
      state->carries[s * slice + w] ^= state->carries[(s - 1) * slice + w];
  vxm_parallel(context, state->stripes, do_stripe, state);
  memcpy(state->job->carry, state->carries + (state->stripes - 1) * slice, slice * sizeof *state->carries);
}

vxm_status vxm_poll(vxm_workspace *workspace, const vxm_window *window, const vxm_poll_job *job,
                    vxm_tally *tally, vxm_error *error) {
  vxm_context *context = workspace->context;
  if (window->begin >= window->end)
    return VXM_OK;
  poll_state state = {.workspace = workspace, .window = window, .job = job, .kernels = vxm_kernels_get()};
  shape(&state);
  atomic_init(&state.contested, 0);
  atomic_init(&state.added, false);
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_crossings *crossings = &workspace->crossings;
  vxm_status status =
      vxm_crossings_plan(crossings, job->facets, job->placed, state.columns, state.voters, error);
  if (status == VXM_OK)
    status = vxm_workspace_scratch(workspace, workers * state.words_each, error);
  if (status == VXM_OK)
    status =
        vxm_bins_reset(&workspace->bins, workers, state.voters, state.slabs.count, state.slabs.words, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  state.carries =
      vxm_alloc(context, (state.stripes + 1) * window->slice_words, sizeof *state.carries, &local);
  if (!state.carries) {
    if (error)
      *error = local;
    return local.code;
  }
  vxm_watch_start(&state.watch, context, "voxelizing along x, y, z",
                  crossings->range_count + state.slabs.count, error);
  vxm_crossings_run(crossings, 0, &workspace->bins, &state.watch); /* one part is one round */
  status = vxm_bins_check(&workspace->bins, error);
  if (status == VXM_OK && state.watch.status == VXM_OK)
    run_stripes(&state);
  vxm_free(context, state.carries);
  tally->contested += atomic_load(&state.contested);
  tally->added |= atomic_load(&state.added);
  return status == VXM_OK ? vxm_watch_end(&state.watch) : status;
}
