/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_overlaps.h"
#include "base/threads.h"

enum {
  BATCH_WORDS = 1 << 18, /**< of a batch of small pieces: 2 MiB */
  SMALL_WORDS = 1 << 12,
  SMALL_FACES = 1 << 11
};

/* ---- Batches of pieces ---- */

static vxm_window box_window(const vxm_label_overlaps *c, const vxm_label_component *piece) {
  vxm_space space = vxm_label_component_space(piece, &c->lattice.space);
  return vxm_window_of(&space, c->set.layout, 0, space.dims[c->set.layout.slow]);
}

static size_t box_words(const vxm_label_overlaps *c, const vxm_label_component *piece) {
  vxm_window window = box_window(c, piece);
  return window.slice_words * (size_t)window.slow_dim;
}

static void list_piece(vxm_label_overlaps *c, const vxm_label_component *piece, uint64_t *words) {
  const vxm_layout *layout = &c->set.layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  vxm_label_overlap *claim = &c->claim[c->batch++];
  claim->piece = piece;
  claim->window = box_window(c, piece);
  claim->window.words = words;
  for (int a = 0; a < 3; a++)
    claim->first[a] = piece->begin[axis[a]];
  atomic_store_explicit(&claim->is_contested, false, memory_order_relaxed);
  atomic_store_explicit(&claim->has_voxels, false, memory_order_relaxed);
  for (int a = 0; a < 2; a++) {
    c->tiles.begin[a] = vxm_min(c->tiles.begin[a], piece->begin[axis[a + 1]]);
    c->tiles.end[a] = vxm_max(c->tiles.end[a], piece->end[axis[a + 1]]);
  }
}

/** Lists small pieces from `first` on, or one that is not small; returns the first that is not listed. */
static size_t list_batch(vxm_label_overlaps *c, size_t first) {
  size_t used = 0, p = first;
  c->batch = 0;
  c->tiles = (vxm_row_tile){{INT64_MAX, INT64_MAX}, {0, 0}};
  for (; p < c->pieces.count && c->batch < VXM_CLAIMS_BATCH; p++) {
    const vxm_label_component *piece = &c->pieces.pieces[p];
    size_t words = box_words(c, piece);
    if (words == 0)
      continue;
    bool is_small = words <= SMALL_WORDS && piece->face_end - piece->first_face <= SMALL_FACES;
    if (c->batch > 0 && (!is_small || used + words > BATCH_WORDS))
      break;
    list_piece(c, piece, c->words + used);
    used += words;
    if (!is_small)
      return p + 1;
  }
  return p;
}

/** Words of the largest batch. */
static size_t words_needed(const vxm_label_overlaps *c) {
  size_t most = 0, small = 0;
  for (size_t p = 0; p < c->pieces.count; p++) {
    size_t words = box_words(c, &c->pieces.pieces[p]);
    most = words > most ? words : most;
    small += words <= SMALL_WORDS ? words : 0;
  }
  small = small < BATCH_WORDS ? small : BATCH_WORDS;
  return most > small ? most : small;
}

/* ---- Solids ---- */

static void make_solid(size_t task, int worker, void *payload) {
  vxm_label_overlaps *c = payload;
  const vxm_label_overlap *claim = &c->claim[task];
  if (atomic_load_explicit(&c->has_failed, memory_order_relaxed))
    return;
  vxm_status status =
      vxm_label_component_fill(&c->scratches[worker], &claim->window, &c->pieces, claim->piece, c->options,
                               &c->lattice, c->batch > 1, &c->errors[worker]);
  if (status != VXM_OK)
    atomic_store_explicit(&c->has_failed, true, memory_order_relaxed);
}

/** One piece is made by all threads; of many each by one, as the loops inside are too short for several. */
static vxm_status make_solids(vxm_label_overlaps *c, vxm_error *error) {
  if (c->batch == 1)
    make_solid(0, 0, c);
  else
    vxm_parallel(c->context, c->batch, make_solid, c);
  if (!atomic_load_explicit(&c->has_failed, memory_order_relaxed))
    return VXM_OK;
  int worker = 0;
  while (c->errors[worker].code == VXM_OK)
    worker++;
  vxm_error_pass(error, &c->errors[worker]);
  return c->errors[worker].code;
}

/* ---- Claims ---- */

/** The part of a tile that a box has, as rows and slices of the box; false if there is none. */
static bool part_of(vxm_row_tile *out, const vxm_row_tile *tile, const vxm_label_overlap *claim) {
  const int64_t dims[2] = {claim->window.middle_dim, claim->window.slow_dim};
  for (int a = 0; a < 2; a++) {
    out->begin[a] = vxm_max(tile->begin[a] - claim->first[a + 1], 0);
    out->end[a] = vxm_min(tile->end[a] - claim->first[a + 1], dims[a]);
    if (out->begin[a] >= out->end[a])
      return false;
  }
  return true;
}

/** A label takes the set voxels of a row of its solid that have none; what is left of the solid are those
 * that have another. Returns whether there are such, and notes whether the solid has voxels. */
static bool claim_row(const vxm_label_overlaps *c, const vxm_label_overlap *claim, int64_t middle,
                      int64_t slow, uint64_t *solids) {
  uint16_t label = (uint16_t)claim->piece->label;
  uint16_t *values =
      vxm_label_overlaps_row(c, middle + claim->first[1], slow + claim->first[2]) + claim->first[0];
  uint64_t *solid = vxm_window_row(&claim->window, middle, slow), any = 0;
  const uint64_t *row = vxm_window_row(&c->set, middle + claim->first[1], slow + claim->first[2]);
  size_t place = (size_t)(row - c->set.words) + (size_t)claim->first[0] / 64;
  for (size_t w = 0; w < claim->window.row_words; w++) {
    uint64_t left = 0;
    *solids |= solid[w];
    for (uint64_t bits = solid[w] & c->set.words[place + w]; bits; bits &= bits - 1) {
      uint16_t *value = &values[64 * w + (size_t)__builtin_ctzll(bits)];
      *value = *value ? *value : label;
      left |= *value != label ? bits & -bits : 0;
    }
    solid[w] = left;
    c->several[place + w] |= left;
    any |= left;
  }
  return any != 0;
}

static void claim_tile(size_t task, int worker, void *payload) {
  (void)worker;
  vxm_label_overlaps *c = payload;
  vxm_row_tile tile = vxm_row_tiles_at(&c->tiles, task), part;
  for (size_t i = 0; i < c->batch; i++) {
    vxm_label_overlap *claim = &c->claim[i];
    bool is_contested = false;
    uint64_t solids = 0;
    if (!part_of(&part, &tile, claim))
      continue;
    for (int64_t slow = part.begin[1]; slow < part.end[1]; slow++)
      for (int64_t middle = part.begin[0]; middle < part.end[0]; middle++)
        is_contested |= claim_row(c, claim, middle, slow, &solids);
    if (solids)
      atomic_store_explicit(&claim->has_voxels, true, memory_order_relaxed);
    if (is_contested)
      atomic_store_explicit(&claim->is_contested, true, memory_order_relaxed);
  }
}

/** Contested voxels go to the nearer of two labels, solid after solid. */
static void settle_tile(size_t task, int worker, void *payload) {
  vxm_label_overlaps *c = payload;
  vxm_row_tile tile = vxm_row_tiles_at(&c->tiles, task), part;
  if (vxm_task_progress_stopped(&c->progress, worker))
    return;
  for (size_t i = 0; i < c->batch; i++) {
    const vxm_label_overlap *claim = &c->claim[i];
    if (!atomic_load_explicit(&claim->is_contested, memory_order_relaxed) || !part_of(&part, &tile, claim))
      continue;
    const size_t row = (size_t)c->set.fast_dim, plane = row * (size_t)c->set.middle_dim;
    uint16_t *values = vxm_label_overlaps_row(c, claim->first[1], claim->first[2]) + claim->first[0];
    vxm_nearest_label nearest = {
        c->bvh, &c->lattice.space, &claim->window, claim->first, values, row, plane, claim->piece->label,
        NULL};
    const int64_t begin[3] = {0, part.begin[0], part.begin[1]},
                  end[3] = {claim->window.fast_dim, part.end[0], part.end[1]};
    vxm_nearest_label_voxels(&nearest, begin, end);
  }
  vxm_task_progress_step(&c->progress);
}

static vxm_status claim_batch(vxm_label_overlaps *c, vxm_error *error) {
  bool is_contested = false;
  size_t tiles = vxm_row_tiles_count(&c->tiles);
  vxm_parallel(c->context, tiles, claim_tile, c);
  for (size_t i = 0; i < c->batch; i++) {
    is_contested |= atomic_load_explicit(&c->claim[i].is_contested, memory_order_relaxed);
    if (c->held && atomic_load_explicit(&c->claim[i].has_voxels, memory_order_relaxed))
      c->held[c->claim[i].piece->label - 1] = true;
  }
  if (!is_contested)
    return VXM_OK;
  vxm_status status = vxm_label_overlaps_need_bvh(c, error);
  if (status != VXM_OK)
    return status;
  vxm_task_progress_start(&c->progress, c->context, "labelling", tiles, error);
  vxm_parallel(c->context, tiles, settle_tile, c);
  return vxm_task_progress_end(&c->progress);
}

/* ---- All of it ---- */

vxm_status vxm_label_overlaps_need_bvh(vxm_label_overlaps *claims, vxm_error *error) {
  return claims->bvh ? VXM_OK
                     : vxm_label_bvh_create(&claims->bvh, claims->labelling, &claims->lattice.space, error);
}

vxm_status vxm_label_overlaps_begin(vxm_label_overlaps *claims, vxm_error *error) {
  vxm_status status = vxm_open_labels_create(&claims->open, claims->labelling, error);
  if (status != VXM_OK)
    return status;
  return vxm_label_components_create(&claims->pieces, claims->labelling, claims->options, &claims->lattice,
                                     claims->set.layout.fast, error);
}

uint64_t vxm_label_overlaps_bytes(const vxm_label_overlaps *claims) {
  uint64_t most = 0;
  for (size_t p = 0; p < claims->pieces.count; p++) {
    uint64_t bytes = vxm_label_component_bytes(&claims->pieces, &claims->pieces.pieces[p]);
    most = bytes > most ? bytes : most;
  }
  return words_needed(claims) * sizeof(uint64_t) + 2 * claims->labelling->table.count + most +
         vxm_label_bvh_bytes(claims->labelling);
}

static vxm_status allocate(vxm_label_overlaps *c, vxm_error *error) {
  size_t threads = (size_t)vxm_context_threads(c->context);
  vxm_error local = VXM_ERROR_INIT;
  c->words = vxm_alloc(c->context, words_needed(c), sizeof *c->words, &local);
  c->held = c->open ? vxm_calloc(c->context, c->labelling->table.count, sizeof *c->held, &local) : NULL;
  c->errors = vxm_calloc(c->context, threads, sizeof *c->errors, &local);
  c->scratches = vxm_calloc(c->context, threads, sizeof *c->scratches, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_label_overlaps_run(vxm_label_overlaps *claims, vxm_error *error) {
  vxm_status status = allocate(claims, error);
  for (size_t p = 0; p < claims->pieces.count && status == VXM_OK;) {
    p = list_batch(claims, p);
    if (claims->batch == 0)
      break;
    status = make_solids(claims, error);
    if (status == VXM_OK)
      status = claim_batch(claims, error);
    if (status == VXM_OK)
      status = vxm_progress(claims->context, "labelling", (double)p / (double)claims->pieces.count, error);
  }
  for (size_t label = 0; claims->open && label < claims->labelling->table.count && status == VXM_OK; label++)
    claims->open[label] |= !claims->held[label];
  return status;
}

void vxm_label_overlaps_end(vxm_label_overlaps *claims) {
  for (int w = 0; claims->scratches && w < vxm_context_threads(claims->context); w++)
    vxm_label_component_scratch_destroy(&claims->scratches[w], claims->context);
  vxm_free(claims->context, claims->scratches);
  vxm_free(claims->context, claims->errors);
  vxm_free(claims->context, claims->words);
  vxm_free(claims->context, claims->held);
  vxm_free(claims->context, claims->open);
  vxm_label_bvh_destroy(claims->bvh);
  vxm_label_components_destroy(&claims->pieces);
}
