/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/odd_lines.h"
#include "base/threads.h"
#include "voxel/parity/edge_passages.h"
#include "voxel/parity/kernels.h"

#include <string.h>

/** The lines along an axis: bits along u, a row for each slice begin..end-1 across w. */
typedef struct plane {
  uint64_t *words, *of_part; /**< of_part: rows of one of many parts, zeros; NULL if there is one */
  int u, w;
  int64_t count, begin, end;
  size_t row_words;
} plane;

typedef struct finder {
  plane planes[3];
  const vxm_snapped_points *placed;
  const vxm_triangle_set *triangles;
  size_t part_begin, part_end;
} finder;

static plane plane_of(const vxm_window *window, int along) {
  const int64_t dims[3] = {window->fast_dim, window->middle_dim, window->slow_dim};
  const int axes[3] = {window->layout.fast, window->layout.middle, window->layout.slow};
  int u = along == 0, w = along == 2 ? 1 : 2;
  plane p = {.u = axes[u], .w = axes[w], .count = dims[u], .end = dims[w]};
  if (w == 2) {
    p.begin = window->begin;
    p.end = window->end;
  }
  p.row_words = ((size_t)p.count + 63) / 64;
  return p;
}

static size_t words_of(const plane *p) {
  return p->row_words * (size_t)(p->end - p->begin);
}

/** Flips where the odd edges of a part pass; `rows` becomes those that have some. */
static void flip_part(const finder *f, const plane *p, size_t part, uint64_t *words, size_t rows[2]) {
  const vxm_part *of = &f->triangles->parts[part];
  vxm_edge_passages e;
  for (size_t t = of->cones; t < of->end; t++) {
    if (!vxm_edge_passages_of(&e, f->placed, f->triangles->corners[t], p->w, p->begin, p->end))
      continue;
    vxm_edge_place u = vxm_edge_place_of(&f->placed->lattice, &e, p->u, p->w);
    size_t first = (size_t)(e.first - p->begin), end = (size_t)(e.last - p->begin);
    rows[0] = first < rows[0] ? first : rows[0];
    rows[1] = end > rows[1] ? end : rows[1];
    for (size_t row = first; row < end; row++, vxm_edge_place_step(&u))
      if (u.voxel < p->count) {
        uint64_t at = (uint64_t)vxm_max(u.voxel, 0);
        words[row * p->row_words + at / 64] ^= UINT64_C(1) << (at % 64);
      }
  }
}

static void find_plane(size_t along, int worker, void *payload) {
  (void)worker;
  const finder *f = payload;
  const plane *p = &f->planes[along];
  const vxm_kernels *kernels = vxm_kernels_get();
  const uint64_t tail = p->count % 64 ? vxm_low_bits((unsigned)(p->count % 64)) : ~UINT64_C(0);
  for (size_t part = f->part_begin; part < f->part_end; part++) {
    uint64_t *words = p->of_part ? p->of_part : p->words;
    size_t rows[2] = {SIZE_MAX, 0};
    flip_part(f, p, part, words, rows);
    if (rows[0] >= rows[1])
      continue;
    size_t first = rows[0] * p->row_words, count = (rows[1] - rows[0]) * p->row_words;
    kernels->fold_rows(words + first, p->row_words, rows[1] - rows[0], tail);
    if (p->of_part)
      kernels->move_or(p->words + first, words + first, count);
  }
}

vxm_status vxm_odd_lines_find(vxm_odd_lines *out, vxm_context *context, const vxm_window *window,
                              const vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                              size_t part_begin, size_t part_end, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  finder f = {.placed = placed, .triangles = triangles, .part_begin = part_begin, .part_end = part_end};
  *out = (vxm_odd_lines){.context = context, .window = *window};
  for (int a = 0; a < 3; a++) {
    plane *p = &f.planes[a];
    *p = plane_of(window, a);
    p->words = out->along[a] =
        local.code == VXM_OK ? vxm_calloc(context, words_of(p), sizeof *p->words, &local) : NULL;
    if (part_end - part_begin > 1 && local.code == VXM_OK)
      p->of_part = vxm_calloc(context, words_of(p), sizeof *p->of_part, &local);
  }
  vxm_status status = local.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  else
    status = vxm_parallel_cancellable(context, 3, find_plane, &f, error);
  for (int a = 0; a < 3; a++)
    vxm_free(context, f.planes[a].of_part);
  if (status == VXM_OK)
    out->has_slow = !vxm_words_are_zero(out->along[2], words_of(&f.planes[2]));
  else
    vxm_odd_lines_destroy(out);
  return status;
}

void vxm_odd_lines_destroy(vxm_odd_lines *lines) {
  for (int a = 0; a < 3; a++) {
    vxm_free(lines->context, lines->along[a]);
    lines->along[a] = NULL;
  }
}

uint64_t vxm_odd_lines_bytes(const vxm_window *window, size_t parts) {
  uint64_t words = 0;
  for (int a = 0; a < 3; a++) {
    plane p = plane_of(window, a);
    words += words_of(&p);
  }
  return (parts > 1 ? 2 : 1) * words * sizeof(uint64_t);
}

/** Those along the middle axis that pass through a slice. */
static const uint64_t *middle_row(const vxm_odd_lines *lines, size_t slice) {
  return lines->along[1] + slice * lines->window.row_words;
}

/** Those along the fast axis. */
static const uint64_t *fast_row(const vxm_odd_lines *lines, size_t slice) {
  return lines->along[0] + slice * (((size_t)lines->window.middle_dim + 63) / 64);
}

bool vxm_odd_lines_in(const vxm_odd_lines *lines, size_t slice) {
  const vxm_window *w = &lines->window;
  return lines->has_slow || !vxm_words_are_zero(middle_row(lines, slice), w->row_words) ||
         !vxm_words_are_zero(fast_row(lines, slice), ((size_t)w->middle_dim + 63) / 64);
}

vxm_odd_words vxm_odd_words_of(const vxm_odd_lines *lines, size_t slice) {
  return (vxm_odd_words){.lines = lines, .slice = slice};
}

/** Writes, for some words of a row, whether the row is odd and which lines across it are. That an axis
 * abstains behind the end of a row makes no difference there, as no other does. */
static void spread_row(vxm_odd_words *words, size_t row, size_t word, size_t count, size_t to) {
  const vxm_odd_lines *lines = words->lines;
  const uint64_t is_odd = -(fast_row(lines, words->slice)[row / 64] >> (row % 64) & 1);
  const uint64_t *middle = middle_row(lines, words->slice) + word;
  for (size_t i = 0; i < count; i++) {
    words->along_fast[to + i] = is_odd;
    words->along_middle[to + i] = middle[i];
  }
}

bool vxm_odd_words_next(vxm_odd_words *words) {
  const size_t row_words = words->lines->window.row_words, all = (size_t)words->lines->window.middle_dim;
  words->at += words->count;
  const size_t row = words->at / row_words, word = words->at - row * row_words;
  if (row >= all)
    return false;
  /* Some whole rows, or a part of one. */
  size_t rows = row_words < VXM_ODD_WORDS ? VXM_ODD_WORDS / row_words : 1;
  size_t count = row_words - word < VXM_ODD_WORDS ? row_words - word : VXM_ODD_WORDS;
  rows = all - row < rows ? all - row : rows;
  for (size_t r = 0; r < rows; r++)
    spread_row(words, row + r, word, count, r * count);
  words->count = rows * count;
  words->odd[0] = words->along_fast;
  words->odd[1] = words->along_middle;
  words->odd[2] = words->lines->along[2] + words->at;
  return true;
}

void vxm_odd_lines_abstain(const vxm_odd_lines *lines, size_t slice, uint64_t *const voters[3]) {
  const vxm_kernels *kernels = vxm_kernels_get();
  vxm_odd_words words = vxm_odd_words_of(lines, slice);
  while (vxm_odd_words_next(&words)) {
    uint64_t *const some[3] = {voters[0] + words.at, voters[1] + words.at, voters[2] + words.at};
    kernels->abstain(some, words.odd, words.count);
  }
}
