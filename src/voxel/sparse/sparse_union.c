/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/threads.h"
#include "voxel/sparse/flipped_nodes.h"
#include "voxel/sparse/sparse.h"
#include "voxel/sparse/strip_flips.h"
#include "voxel/winding/chain_flips.h"

#include <math.h>
#include <string.h>

enum {
  SLAB_SHIFT = 4,     /**< slabs are as thick as strips */
  CROSSINGS = 1 << 22 /**< of a window, at most */
};

/** What a thread works with. */
typedef struct scratch {
  vxm_flipped_nodes flipped; /**< of a slab, or of one strip; without flips between these */
  /* Of a slab that is sorted, strip after strip: */
  uint32_t *flips, *parts;
  size_t capacity;
  uint32_t *ends; /**< of each strip; in the end behind its flips */
  /* Of a strip, node after node; clear between strips. */
  uint64_t *united; /**< per brick in the order of vxm_strip_add_node */
  /* A bit per node: whether something is united in it, whether all of it is full. */
  uint64_t *is_united, *is_full;
  vxm_chain_flips wound; /**< of the chain, as of a part behind all others */
} scratch;

typedef struct sparse_state {
  vxm_octree_builder *builder;
  vxm_crossing_bins *bins;
  const vxm_sparse_job *job;
  vxm_chain_winding *chain; /**< NULL = none */
  bool with_chain;          /**< in this round */
  const vxm_kernels *kernels;
  vxm_columns columns;
  int row_shift;    /**< a row of records has 2^row_shift of them */
  size_t nodes;     /**< of a strip */
  size_t first;     /**< slab of the window */
  bool many;        /**< parts, or a part and the chain, are united, or rounds */
  bool sorted;      /**< by strip and part, before nodes are flipped: else those of a slab are at once */
  bool again;       /**< there may be something in the strips already */
  uint64_t last[4]; /**< per x: the voxels of a brick of the last node that the space has */
  scratch *scratches;
  vxm_task_progress watch;
} sparse_state;

/* ---- Out of the bins ---- */

static bool reserve(sparse_state *state, scratch *d, size_t count) {
  if (count <= d->capacity)
    return true;
  vxm_context *context = state->builder->context;
  vxm_error local = VXM_ERROR_INIT;
  if (count > UINT32_MAX) { /* places are counted in 32 bits: 16 GiB of flips in one slab */
    atomic_store_explicit(&state->builder->failed, VXM_ERROR_MEMORY, memory_order_relaxed);
    return false;
  }
  vxm_free(context, d->flips);
  vxm_free(context, d->parts);
  d->parts = NULL;
  d->capacity = 0;
  size_t wanted = count + count / 4;
  d->flips = vxm_alloc(context, wanted, sizeof *d->flips, &local);
  d->parts = vxm_alloc(context, wanted, sizeof *d->parts, &local);
  if (local.code == VXM_OK)
    d->capacity = wanted;
  else
    atomic_store_explicit(&state->builder->failed, (int)local.code, memory_order_relaxed);
  return local.code == VXM_OK;
}

/** The flips of the chain in a slab, as a piece. */
static vxm_crossing_bin_piece piece_of_chain(const scratch *d) {
  return (vxm_crossing_bin_piece){d->wound.places, d->wound.count, false};
}

/** Counts the flips of each strip; returns how many there are. */
static size_t count_flips(const sparse_state *state, scratch *d, size_t slab) {
  vxm_crossing_bin_piece piece = piece_of_chain(d);
  memset(d->ends, 0, state->builder->across * sizeof *d->ends);
  size_t total = vxm_strip_flips_count(d->ends, &piece, state->row_shift);
  for (size_t w = 0; w < state->bins->workers; w++) {
    vxm_crossing_bin_reader reader =
        vxm_crossing_bin_read(vxm_crossing_bins_at(state->bins, w, 0, slab), !state->many);
    while (reader.part != VXM_BIN_NONE)
      while (vxm_crossing_bin_next(&reader, &piece))
        total += vxm_strip_flips_count(d->ends, &piece, state->row_shift);
  }
  return total;
}

static void put_piece(const sparse_state *state, scratch *d, const vxm_crossing_bin_piece *piece,
                      size_t part) {
  vxm_strip_flips_put(d->flips, d->parts, d->ends, piece, state->row_shift, (uint32_t)part);
}

/** The flips of the chain in a slab, if it is there in this round. */
static bool take_chain(sparse_state *state, scratch *d, size_t slab) {
  size_t rows = state->builder->across * VXM_STRIP_VOXELS * VXM_STRIP_VOXELS;
  d->wound.count = 0;
  if (!state->with_chain)
    return true;
  vxm_status status = vxm_chain_flips_take(&d->wound, state->chain, slab, rows, state->row_shift);
  if (status != VXM_OK)
    atomic_store_explicit(&state->builder->failed, (int)status, memory_order_relaxed);
  return status == VXM_OK;
}

/** Sorts the flips of a slab by strip, and by part within; false if memory ran out. */
static bool sort_flips(sparse_state *state, scratch *d, size_t slab) {
  enum { WORKERS_MAX = 256 };
  vxm_crossing_bin_reader reader[WORKERS_MAX];
  size_t workers = state->bins->workers;
  if (!take_chain(state, d, slab) || !reserve(state, d, count_flips(state, d, slab)))
    return false;
  uint32_t sum = 0;
  for (size_t s = 0; s < state->builder->across; s++) {
    uint32_t count = d->ends[s];
    d->ends[s] = sum;
    sum += count;
  }
  for (size_t w = 0; w < workers; w++)
    reader[w] = vxm_crossing_bin_read(vxm_crossing_bins_at(state->bins, w, 0, slab), !state->many);
  for (;;) {
    uint32_t part = VXM_BIN_NONE;
    vxm_crossing_bin_piece piece;
    for (size_t w = 0; w < workers; w++)
      part = reader[w].part < part ? reader[w].part : part;
    if (part == VXM_BIN_NONE)
      break;
    for (size_t w = 0; w < workers; w++)
      while (reader[w].part == part && vxm_crossing_bin_next(&reader[w], &piece))
        put_piece(state, d, &piece, part);
  }
  vxm_crossing_bin_piece chain = piece_of_chain(d);
  put_piece(state, d, &chain, state->job->part_end);
  return true;
}

static void note_failure(sparse_state *state, vxm_status status) {
  if (status != VXM_OK)
    atomic_store_explicit(&state->builder->failed, (int)status, memory_order_relaxed);
}

/** Flips the nodes of a slab, which has one part; false if memory ran out. */
static bool flip_slab(sparse_state *state, scratch *d, size_t slab) {
  vxm_status status = VXM_OK;
  for (size_t w = 0; w < state->bins->workers && status == VXM_OK; w++) {
    vxm_crossing_bin_reader reader =
        vxm_crossing_bin_read(vxm_crossing_bins_at(state->bins, w, 0, slab), true);
    vxm_crossing_bin_piece piece;
    while (reader.part != VXM_BIN_NONE)
      while (status == VXM_OK && vxm_crossing_bin_next(&reader, &piece))
        status = piece.is_bitmap ? vxm_flipped_nodes_flip_bitmap(&d->flipped, piece.data, piece.count)
                                 : vxm_flipped_nodes_flip(&d->flipped, piece.data, piece.count);
  }
  note_failure(state, status);
  return status == VXM_OK;
}

/* ---- A part of a strip ---- */

static void add_bits(uint64_t *words, size_t begin, size_t end) {
  vxm_row_set_span(words, (int64_t)begin, (int64_t)end);
}

/** A node that a part reaches. */
static void put_node(sparse_state *state, scratch *d, size_t worker, size_t x, uint64_t *bricks) {
  if (x == state->nodes - 1)
    for (int b = 0; b < VXM_STRIP_BRICKS; b++)
      bricks[b] &= state->last[b / 16];
  if (!state->many) {
    vxm_strip_add_node(state->builder, worker, x, bricks);
    return;
  }
  uint64_t *united = d->united + x * VXM_STRIP_BRICKS;
  for (int b = 0; b < VXM_STRIP_BRICKS; b++)
    united[b] |= bricks[b];
  add_bits(d->is_united, x, x + 1);
}

/** Nodes begin..end-1 without flips: `inside` says for each row of bricks what is inside all along. */
static void put_gap(sparse_state *state, scratch *d, size_t worker, size_t begin, size_t end,
                    const uint64_t inside[16]) {
  uint64_t any = 0, all = ~UINT64_C(0), bricks[VXM_STRIP_BRICKS];
  for (int r = 0; r < 16; r++) {
    any |= inside[r];
    all &= inside[r];
  }
  if (any == 0 || begin >= end)
    return;
  if (all == ~UINT64_C(0)) {
    size_t whole = (size_t)state->builder->space.dims[0] / VXM_STRIP_VOXELS;
    whole = whole < end ? whole : end;
    if (whole > begin && state->many)
      add_bits(d->is_full, begin, whole);
    else if (whole > begin)
      vxm_strip_add_full(state->builder, worker, begin, whole);
    begin = whole > begin ? whole : begin;
  }
  for (; begin < end; begin++) {
    for (int b = 0; b < VXM_STRIP_BRICKS; b++)
      bricks[b] = inside[b % 16];
    put_node(state, d, worker, begin, bricks);
  }
}

/** The flips of one part in a strip, the number of which is that among the flipped nodes: the prefix XOR
 * along x, node after node. Returns the OR of what is inside. */
static uint64_t fold_flips(sparse_state *state, scratch *d, size_t worker, size_t strip) {
  uint64_t inside[16] = {0}, any = 0;
  size_t done = 0;
  for (size_t x = 0; vxm_flipped_nodes_next(&d->flipped, strip, &x); x++) {
    put_gap(state, d, worker, done, x, inside);
    uint64_t bricks[VXM_STRIP_BRICKS], masks[2];
    any |= state->kernels->fold_node(bricks, vxm_flipped_nodes_take(&d->flipped, strip, x), inside, masks);
    if (state->many || x == state->nodes - 1)
      put_node(state, d, worker, x, bricks);
    else
      vxm_strip_add_known(state->builder, worker, x, bricks, masks[0], masks[1]);
    done = x + 1;
  }
  put_gap(state, d, worker, done, state->nodes, inside);
  return any;
}

/* ---- Strips ---- */

/** Takes what rounds before have left in a strip. */
static void take_strip(scratch *d, const vxm_strip *strip) {
  for (size_t i = 0; strip->items && i < strip->count; i++) {
    const vxm_strip_item *item = &strip->items[i];
    if (item->seed.full == ~UINT64_C(0)) {
      add_bits(d->is_full, item->begin, item->end);
      continue;
    }
    vxm_strip_expand(item, d->united + (size_t)item->begin * VXM_STRIP_BRICKS);
    add_bits(d->is_united, item->begin, item->end);
  }
}

/** Adds what was united, and clears it. */
static void put_united(sparse_state *state, scratch *d, size_t worker) {
  for (size_t w = 0; w < (state->nodes + 63) / 64; w++) {
    for (uint64_t left = d->is_united[w] | d->is_full[w]; left; left &= left - 1) {
      unsigned b = (unsigned)__builtin_ctzll(left);
      size_t x = 64 * w + b;
      uint64_t *united = d->united + x * VXM_STRIP_BRICKS;
      if (d->is_full[w] >> b & 1)
        vxm_strip_add_full(state->builder, worker, x, x + 1);
      else
        vxm_strip_add_node(state->builder, worker, x, united);
      if (d->is_united[w] >> b & 1)
        memset(united, 0, VXM_STRIP_BRICKS * sizeof *united);
    }
    d->is_united[w] = d->is_full[w] = 0;
  }
}

/** Notes that a part has voxels. Whether the chain adds some is not told. */
static void touch(const sparse_state *state, uint32_t part) {
  if (part == state->job->part_end)
    return;
  atomic_store_explicit(&state->job->has_voxels[part], 1, memory_order_relaxed);
}

static void do_flipped_strip(sparse_state *state, scratch *d, size_t worker, size_t y, size_t z) {
  if (fold_flips(state, d, worker, y))
    touch(state, 0);
  vxm_strip_end(state->builder, worker, y, z);
}

/** A strip, whose sorted flips are begin..end-1. */
static void do_sorted_strip(sparse_state *state, scratch *d, size_t worker, size_t y, size_t z, size_t begin,
                            size_t end) {
  if (state->again)
    take_strip(d, &state->builder->strips[z * state->builder->across + y]);
  for (size_t first = begin, behind; first < end; first = behind) {
    for (behind = first + 1; behind < end && d->parts[behind] == d->parts[first];)
      behind++;
    note_failure(state, vxm_flipped_nodes_flip_strip(&d->flipped, d->flips + first, behind - first));
    if (fold_flips(state, d, worker, 0))
      touch(state, d->parts[first]);
    vxm_flipped_nodes_end(&d->flipped);
  }
  if (state->many)
    put_united(state, d, worker);
  vxm_strip_end(state->builder, worker, y, z);
}

static void do_slab(size_t task, int worker, void *payload) {
  sparse_state *state = payload;
  scratch *d = &state->scratches[worker];
  if (vxm_task_progress_stopped(&state->watch, worker) ||
      !(state->sorted ? sort_flips(state, d, task) : flip_slab(state, d, task)))
    return;
  size_t begin = 0;
  for (size_t y = 0; y < state->builder->across; y++) {
    size_t end = state->sorted ? d->ends[y] : 0;
    if (end > begin)
      do_sorted_strip(state, d, (size_t)worker, y, state->first + task, begin, end);
    begin = end;
    if (!state->sorted && vxm_flipped_nodes_touch_end(&d->flipped, y))
      do_flipped_strip(state, d, (size_t)worker, y, state->first + task);
  }
  vxm_flipped_nodes_end(&d->flipped);
  vxm_task_progress_step(&state->watch);
}

/* ---- All of it ---- */

static void shape(sparse_state *state) {
  const vxm_sparse_job *job = state->job;
  const int64_t *n = state->builder->space.dims;
  state->nodes = (size_t)((n[0] + VXM_STRIP_VOXELS - 1) / VXM_STRIP_VOXELS);
  while (INT64_C(1) << state->row_shift < n[0])
    state->row_shift++;
  state->row_shift = state->row_shift < 6 ? 6 : state->row_shift;
  uint64_t row = UINT64_C(1) << state->row_shift;
  bool closed = job->part_end <= job->triangles->split.kind_end[VXM_PART_CLOSED];
  state->columns = (vxm_columns){.u = 1,
                                 .v = 2,
                                 .w = 0,
                                 .end = {n[0], n[1], n[2]},
                                 .keep_before = true,
                                 .step = {1, row << SLAB_SHIFT, row},
                                 .slab_axis = 2,
                                 .slab_shift = SLAB_SHIFT,
                                 .roles = job->roles | (closed ? VXM_ROLES_ALL : 0)};
  int64_t left = n[0] - ((int64_t)state->nodes - 1) * VXM_STRIP_VOXELS;
  for (int b = 0; b < 4; b++)
    state->last[b] =
        UINT64_C(0x1111111111111111) * vxm_low_bits((unsigned)vxm_min(vxm_max(left - 4 * b, 0), 4));
  /* Slots of all nodes of a slab are few bytes each, but of the largest spaces very many. */
  const uint64_t most = UINT64_C(1) << 23, left_here = vxm_memory_left(state->builder->context) / 8;
  uint64_t bytes = vxm_flipped_nodes_bytes(state->builder->across, state->row_shift);
  state->sorted = state->many || bytes > most || bytes * state->builder->workers > left_here;
}

static vxm_status make_scratches(sparse_state *state, size_t workers, vxm_error *error) {
  vxm_context *context = state->builder->context;
  vxm_error local = VXM_ERROR_INIT;
  size_t words = state->nodes * VXM_STRIP_BRICKS, marks = (state->nodes + 63) / 64;
  state->scratches = vxm_calloc(context, workers, sizeof *state->scratches, &local);
  for (size_t w = 0; w < workers && local.code == VXM_OK; w++) {
    scratch *d = &state->scratches[w];
    vxm_flipped_nodes_create(&d->flipped, context, state->sorted ? 1 : state->builder->across,
                             state->row_shift, &local);
    d->ends = state->sorted ? vxm_alloc(context, state->builder->across, sizeof *d->ends, &local) : NULL;
    d->united = state->many ? vxm_calloc(context, words, sizeof *d->united, &local) : NULL;
    d->is_united = vxm_calloc(context, 2 * marks, sizeof *d->is_united, &local);
    d->is_full = d->is_united ? d->is_united + marks : NULL;
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static void free_scratches(sparse_state *state, size_t workers) {
  vxm_context *context = state->builder->context;
  for (size_t w = 0; state->scratches && w < workers; w++) {
    scratch *d = &state->scratches[w];
    vxm_free(context, d->flips);
    vxm_free(context, d->parts);
    vxm_free(context, d->ends);
    vxm_flipped_nodes_destroy(&d->flipped);
    vxm_free(context, d->united);
    vxm_free(context, d->is_united);
    vxm_chain_flips_destroy(&d->wound, context);
  }
  vxm_free(context, state->scratches);
}

/** Slabs of a window: so few that its crossings are not too many, so many that all threads have work. */
static size_t window_slabs(const sparse_state *state) {
  vxm_context *context = state->builder->context;
  double of_chain = state->chain ? state->chain->estimate : 0;
  double bound = vxm_raster_schedule_placed_bound(state->job->placed, state->columns.roles) + of_chain;
  double most = vxm_raster_schedule_round(context), slabs = (double)state->builder->deep;
  most = most < CROSSINGS ? most : CROSSINGS;
  double wanted = slabs * most / (bound + 1);
  double least = 4 * (double)vxm_context_threads(context);
  /* Of the chain all crossings are kept, never as bitmaps. */
  least = fmin(least, fmax(1, slabs * vxm_raster_schedule_round(context) / (of_chain + 1)));
  return (size_t)fmin(fmax(wanted, least), slabs);
}

/** The triangles that may reach into the window. */
static void choose_triangles(sparse_state *state) {
  const vxm_sparse_job *job = state->job;
  vxm_columns *c = &state->columns;
  const vxm_part *first = job->triangles->parts;
  c->triangle_begin = first->begin;
  c->triangle_end = vxm_roles_end(job->triangles, job->part_end - 1, job->roles);
  if (job->order && job->order->corners && c->triangle_end == first->caps)
    vxm_triangle_order_slices(job->order, c->begin[2], c->end[2], &c->triangle_begin, &c->triangle_end);
}

/** Slabs first to end - 1. */
static vxm_status do_window(sparse_state *state, vxm_workspace *workspace, size_t first, size_t end,
                            vxm_error *error) {
  vxm_octree_builder *builder = state->builder;
  vxm_raster_schedule *crossings = &workspace->crossings;
  state->first = first;
  state->columns.begin[2] = (int64_t)first << SLAB_SHIFT;
  state->columns.end[2] = vxm_min((int64_t)end << SLAB_SHIFT, builder->space.dims[2]);
  choose_triangles(state);
  size_t of_chain = 0;
  vxm_status status = VXM_OK;
  if (state->chain)
    status = vxm_chain_winding_steps(&of_chain, state->chain, workspace, state->job->placed, &state->columns,
                                     error);
  if (status == VXM_OK)
    status = vxm_raster_schedule_plan(crossings, state->job->triangles, state->job->placed, &state->columns,
                                      1, error);
  /* Progress goes on where the window before ended, in steps of this one. */
  size_t rounds = crossings->round_count, steps = of_chain + crossings->range_count + rounds * (end - first);
  state->watch.total = (steps * builder->deep + end - first) / (end - first);
  atomic_store_explicit(&state->watch.done, steps * first / (end - first), memory_order_relaxed);
  size_t slab_words = builder->across << (state->row_shift + 8 - 6);
  for (size_t round = 0; round < rounds && status == VXM_OK; round++) {
    status = vxm_crossing_bins_reset(state->bins, builder->workers, 1, end - first, slab_words, error);
    if (status != VXM_OK)
      break;
    vxm_raster_schedule_run(crossings, round, state->bins, &state->watch);
    status = vxm_crossing_bins_check(state->bins, error);
    state->with_chain = state->chain && round + 1 == rounds;
    if (state->with_chain && status == VXM_OK && state->watch.status == VXM_OK)
      status = vxm_chain_winding_raster(state->chain, workspace, state->job->placed, &state->columns,
                                        end - first, &state->watch, error);
    if (status != VXM_OK || state->watch.status != VXM_OK)
      break;
    state->again = round > 0;
    vxm_parallel(builder->context, end - first, do_slab, state);
    status = vxm_octree_builder_check(builder, error);
  }
  return status;
}

vxm_status vxm_sparse_union(vxm_octree_builder *builder, vxm_workspace *workspace, const vxm_sparse_job *job,
                            vxm_chain_winding *chain, vxm_error *error) {
  if (job->part_end == 0)
    return VXM_OK;
  sparse_state state = {.builder = builder,
                        .bins = &workspace->bins,
                        .job = job,
                        .chain = chain,
                        .kernels = vxm_kernels_get(),
                        .many = job->part_end > 1 || chain};
  shape(&state);
  vxm_status status = make_scratches(&state, builder->workers, error);
  vxm_task_progress_start(&state.watch, builder->context, "voxelizing", 1, error);
  size_t step = window_slabs(&state);
  for (size_t first = 0; first < builder->deep && status == VXM_OK && state.watch.status == VXM_OK;
       first += step)
    status = do_window(&state, workspace, first, builder->deep - first < step ? builder->deep : first + step,
                       error);
  free_scratches(&state, builder->workers);
  return status == VXM_OK ? vxm_task_progress_end(&state.watch) : status;
}
