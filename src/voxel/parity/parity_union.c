/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/parity_union.h"
#include "base/threads.h"
#include "mesh/sort.h"

#include <string.h>

enum {
  FEW = 64,                /**< records of a part in a slab that are sorted rather than folded */
  STRAIGHT_WORDS = 1 << 16 /**< of a window that is flipped as it is, as it stays in cache */
};

typedef enum direction { ALONG_ROWS, ACROSS_ROWS, ACROSS_SLICES } direction;

typedef struct unite_state {
  vxm_workspace *workspace;
  const vxm_window *window;
  const vxm_parity_union_job *job;
  const vxm_kernels *kernels;
  vxm_columns columns;
  vxm_slabs slabs;
  direction along;
  bool in_place;  /**< there is but one part: its flips go straight to the window's words */
  bool streaming; /**< in place, but by way of the work words and past the cache */
  bool straight;  /**< in place, and triangles flip the window's words themselves: no bins */
  bool clear;     /**< the slabs are still to be cleared */
  size_t row_bits;
  uint64_t by_row_words; /**< 2^40 / words of a row, rounded up; 0 where that is not good enough to divide */
  size_t flipped_words;  /**< of slab.flipped */
  vxm_task_progress progress;
} unite_state;

/** A slab while it is folded. */
typedef struct slab {
  const unite_state *state;
  int64_t begin, end; /**< layers of the window: slices, or rows if columns run across slices */
  uint64_t *out;      /**< its words in the window, if layers are slices */
  uint64_t *work;     /**< slabs.words, zero between parts */
  uint64_t *flipped;  /**< a bit for each row of these, if columns run along rows; zero between parts */
} slab;

/* ---- A few records: sorted, they pair up to the ends of spans ---- */

static bool spans_along_rows(const slab *s, uint64_t *records, size_t count) {
  size_t row_bits = s->state->row_bits;
  int64_t length = s->state->window->fast_dim;
  bool any = false;
  vxm_sort_few_keys(records, count);
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

/** Columns of `length` voxels that lie across words: records become the column times the length plus the
 * place in it, and are sorted by that. */
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
  vxm_sort_few_keys(records, count);
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

/** The box of words that have been flipped: of rows, of slices of rows, and of words in a row. */
typedef struct extent {
  size_t first, last;         /**< words of the slab */
  size_t row_first, row_last; /**< in a slice */
  size_t slice_first, slice_last;
  size_t word_first, word_last; /**< in a row */
} extent;

static const extent nothing = {SIZE_MAX, 0, SIZE_MAX, 0, SIZE_MAX, 0, SIZE_MAX, 0};

static inline void widen(size_t *first, size_t *last, size_t value) {
  *first = value < *first ? value : *first;
  *last = value > *last ? value : *last;
}

/** Rows of a slice of the slab. */
static size_t slab_rows(const unite_state *state) {
  return state->along == ACROSS_SLICES ? (size_t)1 << state->slabs.shift : (size_t)state->window->middle_dim;
}

/** Notes a flipped word; along rows its place in the slab is enough. */
static inline void note_word(const slab *s, extent *flipped, size_t w) {
  const unite_state *state = s->state;
  widen(&flipped->first, &flipped->last, w);
  if (state->in_place)
    return;
  if (state->along == ALONG_ROWS) {
    size_t row = state->by_row_words ? w * state->by_row_words >> 40 : w / state->window->row_words;
    s->flipped[row / 64] |= UINT64_C(1) << (row % 64);
    return;
  }
  size_t row = w / state->window->row_words, slice = row / slab_rows(state);
  widen(&flipped->word_first, &flipped->word_last, w - row * state->window->row_words);
  widen(&flipped->row_first, &flipped->row_last, row - slice * slab_rows(state));
  widen(&flipped->slice_first, &flipped->slice_last, slice);
}

static void flip(const slab *s, uint64_t *words, const uint64_t *records, size_t count, extent *flipped) {
  for (size_t i = 0; i < count; i++) {
    size_t w = records[i] / 64;
    words[w] ^= UINT64_C(1) << (records[i] % 64);
    note_word(s, flipped, w);
  }
}

static void flip_piece(const slab *s, uint64_t *words, const vxm_crossing_bin_piece *piece, extent *flipped) {
  if (!piece->is_bitmap) {
    flip(s, words, piece->data, piece->count, flipped);
    return;
  }
  /* A bitmap is as large as a full slab: behind the layers of the last one it is zero, and no word is there.
   */
  for (size_t w = 0; w < piece->count; w++)
    if (piece->data[w]) {
      words[w] ^= piece->data[w];
      note_word(s, flipped, w);
    }
}

/** Folds the rows from the first to the last flipped one, in place. */
static bool fold_rows(const slab *s, uint64_t *words, extent flipped) {
  size_t row_words = s->state->window->row_words;
  size_t first = flipped.first / row_words, end = flipped.last / row_words + 1;
  return s->state->kernels->fold_rows(words + first * row_words, row_words, end - first,
                                      vxm_window_tail_mask(s->state->window)) != 0;
}

/** Folds whole slices from the first to the last flipped one, in place; whether a voxel is set. */
static bool fold_across_rows(const slab *s, uint64_t *words, extent flipped) {
  const vxm_window *window = s->state->window;
  uint64_t any = 0;
  size_t first = flipped.first / window->slice_words, last = flipped.last / window->slice_words;
  for (size_t k = first; k <= last; k++)
    s->state->kernels->fold_across(words + k * window->slice_words, window->row_words, window->slice_words);
  for (size_t w = first * window->slice_words; w < (last + 1) * window->slice_words && !any; w++)
    any |= words[w];
  return any != 0;
}

/**
 * Folds a line of `count` pieces of `width` words, `step` words apart in the work words and `to_step` in the
 * window, from piece `first` on. Behind the last flipped piece it ends as soon as nothing is open.
 */
static bool fold_line(uint64_t *work, size_t step, uint64_t *to, size_t to_step, size_t width, size_t first,
                      size_t last, size_t count) {
  uint64_t any = 0, open = 1;
  const uint64_t *before = NULL;
  size_t i = first;
  for (; i < count && (i <= last || open); i++) {
    uint64_t *words = work + i * step, *out = to + i * to_step;
    open = 0;
    for (size_t w = 0; w < width; w++) {
      words[w] ^= before ? before[w] : 0;
      open |= words[w];
      out[w] |= words[w];
    }
    any |= open;
    before = words;
  }
  for (size_t k = first; k < i; k++)
    memset(work + k * step, 0, width * sizeof *work);
  return any != 0;
}

/** Folds runs of rows in which something was flipped. */
static bool fold_flipped_rows(const slab *s, extent flipped) {
  const unite_state *state = s->state;
  size_t row_words = state->window->row_words, row = flipped.first / row_words,
         last = flipped.last / row_words;
  uint64_t any = 0;
  for (size_t end; row <= last; row = end) {
    uint64_t here = s->flipped[row / 64] >> (row % 64);
    if (!here) {
      end = (row / 64 + 1) * 64;
      continue;
    }
    row += (size_t)__builtin_ctzll(here);
    for (end = row + 1; end <= last && (s->flipped[end / 64] >> (end % 64) & 1); end++)
      ;
    size_t at = row * row_words, count = (end - row) * row_words;
    state->kernels->fold_rows(s->work + at, row_words, end - row, vxm_window_tail_mask(state->window));
    any |= state->kernels->move_or(s->out + at, s->work + at, count);
  }
  memset(s->flipped + flipped.first / row_words / 64, 0,
         (last / 64 + 1 - flipped.first / row_words / 64) * sizeof *s->flipped);
  return any != 0;
}

/** Folds what was flipped in the work words into the window and clears them. */
static bool fold_work(const slab *s, extent flipped) {
  const unite_state *state = s->state;
  const vxm_window *window = state->window;
  size_t row_words = window->row_words, width = flipped.word_last - flipped.word_first + 1;
  bool any = false;
  if (state->along == ALONG_ROWS)
    return fold_flipped_rows(s, flipped);
  if (state->along == ACROSS_ROWS)
    for (size_t k = flipped.slice_first; k <= flipped.slice_last; k++) {
      size_t at = k * window->slice_words + flipped.word_first;
      any |= fold_line(s->work + at, row_words, s->out + at, row_words, width, flipped.row_first,
                       flipped.row_last, (size_t)window->middle_dim);
    }
  else
    for (size_t r = flipped.row_first; r <= flipped.row_last; r++)
      any |= fold_line(s->work + r * row_words + flipped.word_first, row_words << state->slabs.shift,
                       window->words + ((size_t)s->begin + r) * row_words + flipped.word_first,
                       window->slice_words, width, flipped.slice_first, flipped.slice_last,
                       (size_t)(window->end - window->begin));
  return any;
}

/* ---- Parts of a slab ---- */

static void touch(const unite_state *state, uint32_t part) {
  if (state->job->has_voxels)
    atomic_store_explicit(&state->job->has_voxels[part], 1, memory_order_relaxed);
}

/** The only part: the window's own words are flipped and folded, or written past the cache from work words.
 */
static void do_in_place(const slab *s, vxm_crossing_bin_reader *reader, uint32_t part) {
  const unite_state *state = s->state;
  extent flipped = nothing;
  vxm_crossing_bin_piece piece;
  uint64_t *words = state->streaming ? s->work : s->out;
  for (size_t w = 0; w < state->workspace->bins.workers; w++)
    while (reader[w].part == part && vxm_crossing_bin_next(&reader[w], &piece))
      flip_piece(s, words, &piece, &flipped);
  if (state->streaming) {
    size_t rows = (size_t)(s->end - s->begin) * (size_t)state->window->middle_dim;
    if (state->kernels->fold_rows_streaming(s->out, s->work, state->window->row_words, rows,
                                            vxm_window_tail_mask(state->window)))
      touch(state, part);
    return;
  }
  if (flipped.first > flipped.last)
    return;
  bool any;
  if (state->along == ALONG_ROWS)
    any = fold_rows(s, s->out, flipped);
  else
    any = fold_across_rows(s, s->out, flipped);
  if (any)
    touch(state, part);
}

static void do_part(const slab *s, vxm_crossing_bin_reader *reader, uint32_t part) {
  uint64_t few[FEW];
  size_t count = 0;
  bool many = false;
  extent flipped = nothing;
  vxm_crossing_bin_piece piece;
  for (size_t w = 0; w < s->state->workspace->bins.workers; w++)
    while (reader[w].part == part && vxm_crossing_bin_next(&reader[w], &piece)) {
      if (!many && !piece.is_bitmap && count + piece.count <= FEW) {
        memcpy(few + count, piece.data, piece.count * sizeof *few);
        count += piece.count;
        continue;
      }
      many = true;
      flip_piece(s, s->work, &piece, &flipped);
    }
  bool any = false;
  if (many) {
    flip(s, s->work, few, count, &flipped);
    any = fold_work(s, flipped);
  } else if (count > 0)
    any = s->state->along == ALONG_ROWS ? spans_along_rows(s, few, count) : spans_across(s, few, count);
  if (any)
    touch(s->state, part);
}

static void do_slab(size_t task, int worker, void *payload) {
  unite_state *state = payload;
  const vxm_window *window = state->window;
  vxm_crossing_bins *bins = &state->workspace->bins;
  enum { WORKERS_MAX = 256 };
  vxm_crossing_bin_reader reader[WORKERS_MAX];
  if (vxm_task_progress_stopped(&state->progress, worker))
    return;
  slab s = {.state = state, .begin = (int64_t)task << state->slabs.shift};
  s.end = vxm_min(s.begin + (INT64_C(1) << state->slabs.shift), state->slabs.layers);
  if (!state->in_place || state->streaming)
    s.work = state->workspace->scratch + (size_t)worker * (state->slabs.words + state->flipped_words);
  s.flipped = s.work ? s.work + state->slabs.words : NULL;
  if (state->along != ACROSS_SLICES) {
    s.out = window->words + (size_t)s.begin * window->slice_words;
    if (state->clear && !state->streaming)
      memset(s.out, 0, (size_t)(s.end - s.begin) * window->slice_words * sizeof *s.out);
  }
  for (size_t w = 0; w < bins->workers; w++)
    reader[w] = vxm_crossing_bin_read(vxm_crossing_bins_at(bins, w, 0, task), state->in_place);
  if (state->in_place)
    do_in_place(&s, reader, (uint32_t)state->job->part_begin);
  for (;;) {
    uint32_t part = VXM_BIN_NONE;
    for (size_t w = 0; w < bins->workers; w++)
      part = reader[w].part < part ? reader[w].part : part;
    if (part == VXM_BIN_NONE)
      break;
    do_part(&s, reader, part);
  }
  vxm_task_progress_step(&state->progress);
}

/* ---- All of it ---- */

static void clear_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const vxm_window *window = payload;
  memset(window->words + slice * window->slice_words, 0, window->slice_words * sizeof *window->words);
}

static void shape(unite_state *state) {
  const vxm_window *window = state->window;
  const vxm_parity_union_job *job = state->job;
  const vxm_layout *layout = &window->layout;
  state->along = job->axis == layout->fast     ? ALONG_ROWS
                 : job->axis == layout->middle ? ACROSS_ROWS
                                               : ACROSS_SLICES;
  bool slices = state->along == ACROSS_SLICES;
  int64_t depth = window->end - window->begin;
  state->row_bits = 64 * window->row_words;
  /* A slab has at most 2^20 rows, so words below row_words << 20: the error is below their square >> 20. */
  if (window->row_words <= 1 << 10)
    state->by_row_words = ((UINT64_C(1) << 40) + window->row_words - 1) / window->row_words;
  state->slabs = vxm_slabs_of(slices ? window->middle_dim : depth,
                              slices ? window->row_words * (size_t)depth : window->slice_words,
                              vxm_context_threads(state->workspace->context));
  state->flipped_words = state->along == ALONG_ROWS ? state->slabs.words / window->row_words / 64 + 1 : 0;
  vxm_columns *columns = &state->columns;
  *columns = vxm_columns_of(window, job->axis);
  columns->slab_shift = state->slabs.shift;
  /* Closed parts have neither caps nor cones. */
  bool closed = job->part_end <= job->triangles->split.kind_end[VXM_PART_CLOSED];
  columns->roles = job->roles | (closed ? VXM_ROLES_ALL : 0);
  columns->triangle_begin = job->triangles->parts[job->part_begin].begin;
  columns->triangle_end = vxm_roles_end(job->triangles, job->part_end - 1, job->roles);
  if (slices)
    columns->step[layout->slow] = state->row_bits << state->slabs.shift;
  state->in_place = !slices && job->fresh && job->part_end - job->part_begin == 1;
  state->streaming = state->in_place && state->along == ALONG_ROWS && vxm_window_is_large(window);
  state->straight = state->in_place && vxm_context_threads(state->workspace->context) == 1 &&
                    (size_t)depth * window->slice_words <= STRAIGHT_WORDS;
  if (state->straight)
    columns->slab_shift = 62; /* all is one slab */
}

/** All at once, without bins. */
static void unite_straight(unite_state *state) {
  const vxm_window *window = state->window;
  size_t count = (size_t)(window->end - window->begin) * window->slice_words;
  memset(window->words, 0, count * sizeof *window->words);
  vxm_raster_schedule_flip(&state->workspace->crossings, window->words, &state->progress);
  slab s = {.state = state};
  extent all = {.first = 0, .last = count - 1};
  if (state->along == ALONG_ROWS ? fold_rows(&s, window->words, all)
                                 : fold_across_rows(&s, window->words, all))
    touch(state, (uint32_t)state->job->part_begin);
}

vxm_status vxm_parity_union(vxm_workspace *workspace, const vxm_window *window,
                            const vxm_parity_union_job *job, vxm_error *error) {
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
  vxm_raster_schedule *schedule = &workspace->crossings;
  vxm_status status =
      vxm_raster_schedule_plan(schedule, job->triangles, job->placed, &state.columns, 1, error);
  if (status == VXM_OK && (!state.in_place || state.streaming))
    status = vxm_workspace_scratch(workspace, workers * (state.slabs.words + state.flipped_words), error);
  vxm_task_progress_start(&state.progress, context, job->phase,
                          schedule->range_count + schedule->round_count * state.slabs.count, error);
  if (status == VXM_OK && state.straight) {
    unite_straight(&state);
    return vxm_task_progress_end(&state.progress);
  }
  for (size_t round = 0; round < schedule->round_count && status == VXM_OK; round++) {
    status =
        vxm_crossing_bins_reset(&workspace->bins, workers, 1, state.slabs.count, state.slabs.words, error);
    if (status != VXM_OK)
      break;
    vxm_raster_schedule_run(schedule, round, &workspace->bins, &state.progress);
    status = vxm_crossing_bins_check(&workspace->bins, error);
    if (status != VXM_OK || state.progress.status != VXM_OK)
      break;
    vxm_parallel(context, state.slabs.count, do_slab, &state);
    state.clear = false;
  }
  return status == VXM_OK ? vxm_task_progress_end(&state.progress) : status;
}
