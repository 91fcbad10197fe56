/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/unite.h"
#include "base/threads.h"

#include <string.h>

enum { FEW = 64 /**< records of a part in a slab that are sorted rather than folded */ };

typedef enum direction { ALONG_ROWS, ACROSS_ROWS, ACROSS_SLICES } direction;

typedef struct unite_state {
  vxm_workspace *workspace;
  const vxm_window *window;
  const vxm_unite_job *job;
  const vxm_kernels *kernels;
  vxm_columns columns;
  vxm_slabs slabs;
  direction along;
  bool in_place; /**< there is but one part: its flips go straight to the window's words */
  bool clear;    /**< the slabs are still to be cleared */
  size_t row_bits;
  vxm_watch watch;
} unite_state;

/** A slab while it is folded. */
typedef struct slab {
  const unite_state *state;
  int64_t begin, end; /**< layers of the window: slices, or rows if columns run across slices */
  uint64_t *out;      /**< its words in the window, if layers are slices */
  uint64_t *work;     /**< slabs.words, zero between parts */
} slab;

/* ---- A few records: sorted, they pair up to the ends of spans ---- */

static void sort_few(uint64_t *keys, size_t count) {
  for (size_t i = 1; i < count; i++) {
    uint64_t key = keys[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] > key; j--)
      keys[j] = keys[j - 1];
    keys[j] = key;
  }
}

static bool spans_along_rows(const slab *s, uint64_t *records, size_t count) {
  size_t row_bits = s->state->row_bits;
  int64_t length = s->state->window->fast_dim;
  bool any = false;
  sort_few(records, count);
  for (size_t i = 0; i < count;) {
    size_t row = records[i] / row_bits;
    int64_t begin = (int64_t)(records[i] - row * row_bits), end = length;
    bool pair = i + 1 < count && records[i + 1] < (row + 1) * row_bits;
    if (pair)
      end = (int64_t)(records[i + 1] - row * row_bits);
    any |= begin < end;
    vxm_row_set_span(s->out + row * s->state->window->row_words, begin, end);
    i += pair ? 2 : 1;
  }
  return any;
}

/** Columns of `length` voxels that lie across words: `key` is the column times the length plus the place in
 * it. */
static bool spans_across(const slab *s, uint64_t *records, size_t count) {
  const unite_state *state = s->state;
  const vxm_window *window = state->window;
  size_t row_bits = state->row_bits;
  bool slices = state->along == ACROSS_SLICES;
  /* A record is (outer * inner_count + inner) * row_bits + bit; columns run along inner, or along outer. */
  size_t inner_count = slices ? (size_t)1 << state->slabs.shift : (size_t)window->middle_dim;
  size_t length = slices ? (size_t)(window->end - window->begin) : (size_t)window->middle_dim;
  for (size_t i = 0; i < count; i++) {
    size_t row = records[i] / row_bits, bit = records[i] - row * row_bits;
    size_t outer = row / inner_count, inner = row - outer * inner_count;
    size_t fixed = slices ? inner : outer, place = slices ? outer : inner;
    records[i] = (fixed * row_bits + bit) * length + place;
  }
  sort_few(records, count);
  bool any = false;
  for (size_t i = 0; i < count;) {
    size_t column = records[i] / length, begin = records[i] - column * length, end = length;
    bool pair = i + 1 < count && records[i + 1] < (column + 1) * length;
    if (pair)
      end = records[i + 1] - column * length;
    size_t fixed = column / row_bits, bit = column - fixed * row_bits;
    uint64_t *word = slices ? window->words + ((size_t)s->begin + fixed) * window->row_words
                            : s->out + fixed * window->slice_words;
    size_t step = slices ? window->slice_words : window->row_words;
    for (size_t place = begin; place < end; place++)
      word[place * step + bit / 64] |= UINT64_C(1) << (bit % 64);
    any |= begin < end;
    i += pair ? 2 : 1;
  }
  return any;
}

/* ---- Many records: flipped in the work words, then folded ---- */

/** Which words have been flipped. */
typedef struct extent {
  size_t first, last;
} extent;

static void flip(uint64_t *words, const uint64_t *records, size_t count, extent *flipped) {
  for (size_t i = 0; i < count; i++) {
    size_t w = records[i] / 64;
    words[w] ^= UINT64_C(1) << (records[i] % 64);
    flipped->first = w < flipped->first ? w : flipped->first;
    flipped->last = w > flipped->last ? w : flipped->last;
  }
}

static void flip_piece(uint64_t *words, const vxm_bin_piece *piece, extent *flipped) {
  if (!piece->is_bitmap) {
    flip(words, piece->data, piece->count, flipped);
    return;
  }
  /* A bitmap is as large as a full slab: behind the layers of the last one it is zero, and no word is there.
   */
  for (size_t w = 0; w < piece->count; w++)
    if (piece->data[w]) {
      words[w] ^= piece->data[w];
      flipped->first = w < flipped->first ? w : flipped->first;
      flipped->last = w > flipped->last ? w : flipped->last;
    }
}

/** Folds the rows from the first to the last flipped one, in place. */
static bool fold_rows(const slab *s, uint64_t *words, extent flipped) {
  size_t row_words = s->state->window->row_words;
  size_t first = flipped.first / row_words, end = flipped.last / row_words + 1;
  return s->state->kernels->fold_rows(words + first * row_words, row_words, end - first,
                                      vxm_window_tail_mask(s->state->window)) != 0;
}

static void fold_across_rows(const slab *s, uint64_t *words, extent flipped) {
  const vxm_window *window = s->state->window;
  for (size_t k = flipped.first / window->slice_words; k <= flipped.last / window->slice_words; k++)
    s->state->kernels->fold_across(words + k * window->slice_words, window->row_words, window->slice_words);
}

/** Whether a voxel is set from the first flipped word on to the end of the slice of the last one. */
static bool any_set(const slab *s, const uint64_t *words, extent flipped) {
  size_t slice = s->state->window->slice_words, end = (flipped.last / slice + 1) * slice;
  for (size_t w = flipped.first; w < end; w++)
    if (words[w])
      return true;
  return false;
}

/** Folds what was flipped in the work words into the window and clears them. */
static bool fold_work(const slab *s, extent flipped) {
  const unite_state *state = s->state;
  const vxm_window *window = state->window;
  const vxm_kernels *kernels = state->kernels;
  size_t row_words = window->row_words, begin, end;
  if (state->along == ALONG_ROWS) {
    fold_rows(s, s->work, flipped);
    begin = flipped.first / row_words * row_words;
    end = (flipped.last / row_words + 1) * row_words;
    return kernels->move_or(s->out + begin, s->work + begin, end - begin) != 0;
  }
  if (state->along == ACROSS_ROWS) {
    fold_across_rows(s, s->work, flipped);
    begin = flipped.first / window->slice_words * window->slice_words;
    end = (flipped.last / window->slice_words + 1) * window->slice_words;
    return kernels->move_or(s->out + begin, s->work + begin, end - begin) != 0;
  }
  /* Slices of the slab follow each other in the work words, and lie apart in the window. */
  size_t step = row_words << state->slabs.shift, used = (size_t)(s->end - s->begin) * row_words;
  size_t first = flipped.first / step, count = (size_t)(window->end - window->begin);
  kernels->fold_across(s->work + first * step, step, (count - first) * step);
  uint64_t any = 0;
  for (size_t k = first; k < count; k++)
    any |= kernels->move_or(window->words + k * window->slice_words + (size_t)s->begin * row_words,
                            s->work + k * step, used);
  return any != 0;
}

/* ---- Parts of a slab ---- */

static void touch(const unite_state *state, uint32_t part) {
  if (state->job->touched)
    atomic_store_explicit(&state->job->touched[part], 1, memory_order_relaxed);
}

/** The only part: the window's own words are flipped and folded. */
static void do_in_place(const slab *s, vxm_bin_reader *reader, uint32_t part) {
  const unite_state *state = s->state;
  extent flipped = {SIZE_MAX, 0};
  vxm_bin_piece piece;
  for (size_t w = 0; w < state->workspace->bins.workers; w++)
    while (reader[w].part == part && vxm_bin_next(&reader[w], &piece))
      flip_piece(s->out, &piece, &flipped);
  if (flipped.first > flipped.last)
    return;
  bool any;
  if (state->along == ALONG_ROWS)
    any = fold_rows(s, s->out, flipped);
  else {
    fold_across_rows(s, s->out, flipped);
    any = any_set(s, s->out, flipped);
  }
  if (any)
    touch(state, part);
}

static void do_part(const slab *s, vxm_bin_reader *reader, uint32_t part) {
  uint64_t few[FEW];
  size_t count = 0;
  bool many = false;
  extent flipped = {SIZE_MAX, 0};
  vxm_bin_piece piece;
  for (size_t w = 0; w < s->state->workspace->bins.workers; w++)
    while (reader[w].part == part && vxm_bin_next(&reader[w], &piece)) {
      if (!many && !piece.is_bitmap && count + piece.count <= FEW) {
        memcpy(few + count, piece.data, piece.count * sizeof *few);
        count += piece.count;
        continue;
      }
      many = true;
      flip_piece(s->work, &piece, &flipped);
    }
  bool any = false;
  if (many) {
    flip(s->work, few, count, &flipped);
    any = fold_work(s, flipped);
  } else if (count > 0)
    any = s->state->along == ALONG_ROWS ? spans_along_rows(s, few, count) : spans_across(s, few, count);
  if (any)
    touch(s->state, part);
}

static void do_slab(size_t task, int worker, void *payload) {
  unite_state *state = payload;
  const vxm_window *window = state->window;
  vxm_bins *bins = &state->workspace->bins;
  enum { WORKERS_MAX = 256 };
  vxm_bin_reader reader[WORKERS_MAX];
  if (vxm_watch_stopped(&state->watch, worker))
    return;
  slab s = {.state = state, .begin = (int64_t)task << state->slabs.shift};
  s.end = vxm_min(s.begin + (INT64_C(1) << state->slabs.shift), state->slabs.layers);
  if (!state->in_place)
    s.work = state->workspace->scratch + (size_t)worker * state->slabs.words;
  if (state->along != ACROSS_SLICES) {
    s.out = window->words + (size_t)s.begin * window->slice_words;
    if (state->clear)
      memset(s.out, 0, (size_t)(s.end - s.begin) * window->slice_words * sizeof *s.out);
  }
  for (size_t w = 0; w < bins->workers; w++)
    reader[w] = vxm_bin_read(vxm_bins_at(bins, w, 0, task));
  for (;;) {
    uint32_t part = VXM_BIN_NONE;
    for (size_t w = 0; w < bins->workers; w++)
      part = reader[w].part < part ? reader[w].part : part;
    if (part == VXM_BIN_NONE)
      break;
    if (state->in_place)
      do_in_place(&s, reader, part);
    else
      do_part(&s, reader, part);
  }
  vxm_watch_step(&state->watch);
}

/* ---- All of it ---- */

static void clear_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const vxm_window *window = payload;
  memset(window->words + slice * window->slice_words, 0, window->slice_words * sizeof *window->words);
}

static void shape(unite_state *state) {
  const vxm_window *window = state->window;
  const vxm_unite_job *job = state->job;
  const vxm_layout *layout = &window->layout;
  state->along = job->axis == layout->fast     ? ALONG_ROWS
                 : job->axis == layout->middle ? ACROSS_ROWS
                                               : ACROSS_SLICES;
  bool slices = state->along == ACROSS_SLICES;
  int64_t depth = window->end - window->begin;
  state->row_bits = 64 * window->row_words;
  state->slabs = vxm_slabs_of(slices ? window->middle_dim : depth,
                              slices ? window->row_words * (size_t)depth : window->slice_words,
                              vxm_context_threads(state->workspace->context));
  vxm_columns *columns = &state->columns;
  *columns = vxm_columns_of(window, job->axis);
  columns->slab_shift = state->slabs.shift;
  /* Closed parts have neither caps nor cones. */
  bool closed = job->part_end <= job->facets->split.kind_end[VXM_PART_CLOSED];
  columns->roles = job->roles | (closed ? VXM_FACETS_ALL : 0);
  columns->facet_begin = job->facets->parts[job->part_begin].begin;
  columns->facet_end = job->facets->parts[job->part_end - 1].end;
  if (slices)
    columns->step[layout->slow] = state->row_bits << state->slabs.shift;
  state->in_place = !slices && job->fresh && job->part_end - job->part_begin == 1;
}

vxm_status vxm_unite(vxm_workspace *workspace, const vxm_window *window, const vxm_unite_job *job,
                     vxm_error *error) {
  vxm_context *context = workspace->context;
  unite_state state = {.workspace = workspace,
                       .window = window,
                       .job = job,
                       .kernels = vxm_kernels_get(),
                       .clear = job->fresh};
  size_t depth = (size_t)(window->end - window->begin);
  bool none = job->part_begin >= job->part_end;
  if (!none)
    shape(&state);
  if (job->fresh && (none || state.along == ACROSS_SLICES)) {
    vxm_window target = *window;
    vxm_parallel(context, depth, clear_slice, &target);
    state.clear = false;
  }
  if (none || depth == 0)
    return VXM_OK;
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_crossings *crossings = &workspace->crossings;
  vxm_status status = vxm_crossings_plan(crossings, job->facets, job->placed, &state.columns, 1, error);
  if (status == VXM_OK && !state.in_place)
    status = vxm_workspace_scratch(workspace, workers * state.slabs.words, error);
  vxm_watch_start(&state.watch, context, job->phase,
                  crossings->range_count + crossings->round_count * state.slabs.count, error);
  for (size_t round = 0; round < crossings->round_count && status == VXM_OK; round++) {
    status = vxm_bins_reset(&workspace->bins, workers, 1, state.slabs.count, state.slabs.words, error);
    if (status != VXM_OK)
      break;
    vxm_crossings_run(crossings, round, &workspace->bins, &state.watch);
    status = vxm_bins_check(&workspace->bins, error);
    if (status != VXM_OK || state.watch.status != VXM_OK)
      break;
    vxm_parallel(context, state.slabs.count, do_slab, &state);
    state.clear = false;
  }
  return status == VXM_OK ? vxm_watch_end(&state.watch) : status;
}
