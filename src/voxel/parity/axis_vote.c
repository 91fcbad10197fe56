/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/axis_vote.h"
#include "base/threads.h"
#include "voxel/parity/odd_lines.h"
#include "voxel/parity/parity_difference.h"

#include <string.h>

/** What is put into bins: the crossings of triangles along the fast axis, those of cones, and where the
 * parities along the middle and the slow axis differ from that along the fast one. */
enum { BASE, CONES, MIDDLE, SLOW, SETS };

enum { EDGES_PER_TASK = 1024 };

typedef struct vote_state {
  vxm_workspace *workspace;
  const vxm_window *window;
  const vxm_axis_vote_job *job;
  const vxm_kernels *kernels;
  vxm_columns columns[SETS];
  size_t edge_begin, edge_end; /**< the cones of the odd edges */
  vxm_slabs slabs;
  size_t stripes;
  size_t words_each; /**< scratch of a worker: a slab for each set, and a slice */
  bool streaming;    /**< the window is larger than caches */
  vxm_odd_lines odd; /**< for VXM_VOTE_AUTO */
  uint64_t *carries; /**< a slice for each stripe, and one for the end */
  atomic_int_fast64_t contested;
  atomic_bool added;
  vxm_task_progress progress;
} vote_state;

static size_t stripe_begin(const vote_state *state, size_t stripe) {
  return vxm_slice_begin(state->slabs.count, state->stripes, stripe);
}

static void flip_piece(uint64_t *words, const vxm_crossing_bin_piece *piece) {
  if (piece->is_bitmap)
    for (size_t w = 0; w < piece->count; w++)
      words[w] ^= piece->data[w];
  else
    for (size_t i = 0; i < piece->count; i++)
      words[piece->data[i] / 64] ^= UINT64_C(1) << (piece->data[i] % 64);
}

/** Flips what all threads put into the bins of a slab; false if that was nothing. */
static bool flip_slab(const vote_state *state, size_t set, size_t slab, uint64_t *words) {
  vxm_crossing_bins *bins = &state->workspace->bins;
  vxm_crossing_bin_piece piece;
  bool any = false;
  for (size_t w = 0; w < bins->workers; w++) {
    vxm_crossing_bin_reader reader = vxm_crossing_bin_read(vxm_crossing_bins_at(bins, w, set, slab), true);
    any |= reader.part != VXM_BIN_NONE;
    while (reader.part != VXM_BIN_NONE)
      while (vxm_crossing_bin_next(&reader, &piece))
        flip_piece(words, &piece);
  }
  return any;
}

/** What is open along slices at the beginning of the next stripe, but for flips before this one: all flips of
 * the slabs of this stripe, added up in one slice. */
static void sum_stripe(size_t stripe, int worker, void *payload) {
  vote_state *state = payload;
  const vxm_window *window = state->window;
  uint64_t *carry = state->carries + (stripe + 1) * window->slice_words;
  uint64_t *words = state->workspace->scratch + (size_t)worker * state->words_each;
  memset(carry, 0, window->slice_words * sizeof *carry);
  if (stripe + 1 == state->stripes || vxm_task_progress_stopped(&state->progress, worker))
    return;
  for (size_t slab = stripe_begin(state, stripe); slab < stripe_begin(state, stripe + 1); slab++) {
    if (!flip_slab(state, SLOW, slab, words))
      continue;
    for (size_t k = 0; k < state->slabs.words; k += window->slice_words)
      for (size_t w = 0; w < window->slice_words; w++) {
        carry[w] ^= words[k + w];
        words[k + w] = 0;
      }
  }
}

/** A slab while it is folded. */
typedef struct slab {
  uint64_t *words[SETS];       /**< zeros, but for sets in use */
  bool used[SETS];             /**< whether anything was flipped */
  size_t index, slices, count; /**< number, slices and words */
} slab;

static void fold_fast(const vote_state *state, const slab *s, int set) {
  state->kernels->fold_rows(s->words[set], state->window->row_words,
                            s->slices * (size_t)state->window->middle_dim,
                            vxm_window_tail_mask(state->window));
}

/** The voter of another axis: the fast axis' words with what a set flips, or these words themselves where it
 * flips nothing. */
static const uint64_t *voter_of(const vote_state *state, const slab *s, int set) {
  if (!s->used[set])
    return s->words[BASE];
  fold_fast(state, s, set);
  for (size_t w = 0; w < s->count; w++)
    s->words[set][w] ^= s->words[BASE][w];
  return s->words[set];
}

/** The flips along the middle axis, folded along it. */
static void fold_middle(const vote_state *state, slab *s) {
  const vxm_window *window = state->window;
  uint64_t *words = s->words[MIDDLE];
  s->used[MIDDLE] = flip_slab(state, MIDDLE, s->index, words);
  for (size_t k = 0; s->used[MIDDLE] && k < s->slices; k++)
    state->kernels->fold_across(words + k * window->slice_words, window->row_words, window->slice_words);
}

/** The flips along the slow axis, folded along it. `carry` is what is open along slices at the beginning of
 * the slab, then at its end. */
static void fold_slow(const vote_state *state, slab *s, uint64_t *carry) {
  size_t slice = state->window->slice_words;
  uint64_t *words = s->words[SLOW];
  s->used[SLOW] = flip_slab(state, SLOW, s->index, words) || !vxm_words_are_zero(carry, slice);
  if (!s->used[SLOW])
    return;
  memcpy(words - slice, carry, slice * sizeof *carry);
  state->kernels->fold_across(words - slice, slice, slice + s->count);
  memcpy(carry, words + s->count - slice, slice * sizeof *carry);
}

/** The voters in a slab: three axes, the fast one first, and the tetrahedra, whose parity is that of
 * triangles and cones along any axis. Where the tetrahedra are not asked they vote as the fast axis does. */
static void fold_voters(const vote_state *state, slab *s, uint64_t *carry, const uint64_t *voters[4]) {
  s->used[BASE] = flip_slab(state, BASE, s->index, s->words[BASE]);
  s->used[CONES] = flip_slab(state, CONES, s->index, s->words[CONES]);
  fold_middle(state, s);
  fold_slow(state, s, carry);
  if (s->used[BASE])
    fold_fast(state, s, BASE);
  voters[0] = s->words[BASE];
  voters[1] = voter_of(state, s, MIDDLE);
  voters[2] = voter_of(state, s, SLOW);
  voters[3] = voter_of(state, s, CONES);
}

/** Counts the votes on some words of a slab, `at` words behind its first one; returns the contested voxels.
 */
static int64_t count_votes(const vote_state *state, const slab *s, const uint64_t *const voters[4], size_t at,
                           size_t count, const uint64_t *const odd[3], uint64_t *added) {
  const vxm_axis_vote_job *job = state->job;
  const size_t in_window = (s->index << state->slabs.shift) * state->window->slice_words + at;
  const uint64_t *const some[4] = {voters[0] + at, voters[1] + at, voters[2] + at, voters[3] + at};
  return state->kernels->vote(state->window->words + in_window, some, odd,
                              job->mask ? job->mask + in_window : NULL, count, job->rule, job->fresh,
                              state->streaming && !odd, added);
}

/** The same on all of a slab, slice by slice where axes abstain. */
static int64_t vote_on_slab(const vote_state *state, const slab *s, const uint64_t *const voters[4],
                            uint64_t *added) {
  const size_t first = s->index << state->slabs.shift, slice = state->window->slice_words;
  int64_t contested = 0;
  if (state->job->rule != VXM_VOTE_AUTO)
    return count_votes(state, s, voters, 0, s->count, NULL, added);
  for (size_t k = 0; k < s->slices; k++) {
    size_t done = 0; /* words of the slice */
    if (vxm_odd_lines_in(&state->odd, first + k)) {
      vxm_odd_words words = vxm_odd_words_of(&state->odd, first + k);
      for (; vxm_odd_words_next(&words); done = words.at + words.count)
        contested += count_votes(state, s, voters, k * slice + words.at, words.count, words.odd, added);
    }
    if (done < slice)
      contested += count_votes(state, s, voters, k * slice + done, slice - done, NULL, added);
  }
  return contested;
}

/** Makes the words of a slab zeros again; those of SLOW have a slice before them. */
static void clear(slab *s, size_t slice) {
  for (int set = 0; set < SETS; set++) {
    size_t before = set == SLOW ? slice : 0;
    if (s->used[set])
      memset(s->words[set] - before, 0, (before + s->count) * sizeof *s->words[set]);
  }
}

static void do_stripe(size_t stripe, int worker, void *payload) {
  vote_state *state = payload;
  const vxm_window *window = state->window;
  size_t slice = window->slice_words;
  uint64_t *carry = state->carries + stripe * slice, added = 0;
  uint64_t *scratch = state->workspace->scratch + (size_t)worker * state->words_each;
  slab s = {.words = {NULL}};
  int64_t contested = 0;
  for (size_t set = 0; set < SETS; set++)
    s.words[set] = scratch + set * state->slabs.words + (set == SLOW ? slice : 0);
  for (s.index = stripe_begin(state, stripe); s.index < stripe_begin(state, stripe + 1); s.index++) {
    if (vxm_task_progress_stopped(&state->progress, worker))
      break;
    const uint64_t *voters[4];
    int64_t first = (int64_t)s.index << state->slabs.shift;
    s.slices = (size_t)vxm_min(INT64_C(1) << state->slabs.shift, state->slabs.layers - first);
    s.count = s.slices * slice;
    fold_voters(state, &s, carry, voters);
    contested += vote_on_slab(state, &s, voters, &added);
    clear(&s, slice);
    vxm_task_progress_step(&state->progress);
  }
  atomic_fetch_add_explicit(&state->contested, contested, memory_order_relaxed);
  if (added)
    atomic_store_explicit(&state->added, true, memory_order_relaxed);
}

/** Columns across slices of the `w` axis, along which the middle or the slow axis is compared with the fast
 * one. */
static vxm_columns compared(const vote_state *state, int v, int w) {
  vxm_columns columns = vxm_columns_of(state->window, state->window->layout.fast);
  columns.u = state->window->layout.fast;
  columns.v = v;
  columns.w = w;
  columns.slab_axis = state->window->layout.slow;
  columns.slab_shift = state->slabs.shift;
  if (v == state->window->layout.slow)
    columns.keep_before = state->window->begin == 0; /* else the window before has carried it on */
  return columns;
}

static void shape(vote_state *state) {
  const vxm_window *window = state->window;
  const vxm_axis_vote_job *job = state->job;
  const vxm_part *part = &job->triangles->parts[job->part];
  int threads = vxm_context_threads(state->workspace->context);
  state->edge_begin = part->cones;
  state->edge_end = part->end;
  state->slabs = vxm_slabs_of(window->end - window->begin, window->slice_words, threads);
  state->stripes = (size_t)threads < state->slabs.count ? (size_t)threads : state->slabs.count;
  state->words_each = SETS * state->slabs.words + window->slice_words;
  state->streaming = job->fresh && vxm_window_is_large(window);
  for (size_t set = BASE; set <= CONES; set++) {
    vxm_columns *columns = &state->columns[set];
    *columns = vxm_columns_of(window, window->layout.fast);
    columns->roles = set == BASE ? VXM_ROLE_FACE : VXM_ROLE_CONE;
    columns->triangle_begin = set == BASE ? part->begin : part->cones;
    columns->triangle_end = vxm_roles_end(job->triangles, job->part, columns->roles);
    columns->slab_shift = state->slabs.shift;
  }
  state->columns[MIDDLE] = compared(state, window->layout.middle, window->layout.slow);
  state->columns[SLOW] = compared(state, window->layout.slow, window->layout.middle);
}

static void put_edges(size_t task, int worker, void *payload) {
  vote_state *state = payload;
  if (vxm_task_progress_stopped(&state->progress, worker))
    return;
  size_t begin = state->edge_begin + task * EDGES_PER_TASK;
  size_t end = state->edge_end - begin < EDGES_PER_TASK ? state->edge_end : begin + EDGES_PER_TASK;
  for (size_t set = MIDDLE; set <= SLOW; set++)
    vxm_parity_difference_put(state->job->placed, state->job->triangles, begin, end, &state->columns[set],
                              &state->workspace->bins, (size_t)worker, set);
  vxm_task_progress_step(&state->progress);
}

static void run_stripes(vote_state *state) {
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

vxm_status vxm_axis_vote(vxm_workspace *workspace, const vxm_window *window, const vxm_axis_vote_job *job,
                         vxm_vote_tally *tally, vxm_error *error) {
  vxm_context *context = workspace->context;
  if (window->begin >= window->end)
    return VXM_OK;
  vote_state state = {.workspace = workspace,
                      .window = window,
                      .job = job,
                      .kernels = vxm_kernels_get(),
                      .odd = {.context = context}};
  shape(&state);
  atomic_init(&state.contested, 0);
  atomic_init(&state.added, false);
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_raster_schedule *schedule = &workspace->crossings;
  vxm_status status = vxm_raster_schedule_plan(schedule, job->triangles, job->placed, state.columns,
                                               job->tetra ? CONES + 1 : BASE + 1, error);
  if (status == VXM_OK)
    status = vxm_workspace_scratch(workspace, workers * state.words_each, error);
  if (status == VXM_OK)
    status =
        vxm_crossing_bins_reset(&workspace->bins, workers, SETS, state.slabs.count, state.slabs.words, error);
  if (status == VXM_OK && job->rule == VXM_VOTE_AUTO)
    status = vxm_odd_lines_find(&state.odd, context, window, job->placed, job->triangles, job->part,
                                job->part + 1, error);
  if (status != VXM_OK)
    return status;
  state.carries = vxm_try_alloc(context, (state.stripes + 1) * window->slice_words, sizeof *state.carries,
                                &status, error);
  if (!state.carries) {
    vxm_odd_lines_destroy(&state.odd);
    return status;
  }
  size_t edge_tasks = (state.edge_end - state.edge_begin + EDGES_PER_TASK - 1) / EDGES_PER_TASK;
  vxm_task_progress_start(&state.progress, context, "voxelizing along x, y, z",
                          schedule->range_count + edge_tasks + state.slabs.count, error);
  vxm_raster_schedule_run(schedule, 0, &workspace->bins, &state.progress); /* one part is one round */
  vxm_parallel(context, edge_tasks, put_edges, &state);
  status = vxm_crossing_bins_check(&workspace->bins, error);
  if (status == VXM_OK && state.progress.status == VXM_OK)
    run_stripes(&state);
  vxm_free(context, state.carries);
  vxm_odd_lines_destroy(&state.odd);
  tally->contested += atomic_load(&state.contested);
  tally->added |= atomic_load(&state.added);
  return status == VXM_OK ? vxm_task_progress_end(&state.progress) : status;
}
