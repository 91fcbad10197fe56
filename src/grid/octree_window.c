/* SPDX-License-Identifier: BSD-3-Clause */
/** Octrees from and to windows. */
#include "base/threads.h"
#include "grid/octree_build.h"

#include <string.h>

/* ---- To a window ---- */

enum { FILL_SLICES = 16 };

/** Makes pairs of bits of the index of a brick's voxels change places: axes p and q of x, y and z. */
static inline uint64_t swap_axes(uint64_t bits, int p, int q) {
  static const struct {
    unsigned shift;
    uint64_t mask;
  } swaps[3][2] = {{{3, UINT64_C(0x0a0a0a0a0a0a0a0a)}, {6, UINT64_C(0x00cc00cc00cc00cc)}},    /* x, y */
                   {{15, UINT64_C(0x0000aaaa0000aaaa)}, {30, UINT64_C(0x00000000cccccccc)}},  /* x, z */
                   {{12, UINT64_C(0x0000f0f00000f0f0)}, {24, UINT64_C(0x00000000ff00ff00)}}}; /* y, z */
  int pair = p + q - 1;
  for (int i = 0; i < 2; i++) {
    uint64_t change = (bits >> swaps[pair][i].shift ^ bits) & swaps[pair][i].mask;
    bits ^= change ^ change << swaps[pair][i].shift;
  }
  return bits;
}

typedef struct fill_job {
  const vxm_sparse *sparse;
  const vxm_window *window;
  int64_t first; /**< slice of the first task, a multiple of FILL_SLICES or before the window */
  int swap[2];   /**< the axis that first x, then y changes places with */
} fill_job;

/** The slices of a window that one task fills. */
typedef struct fill_range {
  const fill_job *job;
  int64_t begin, end;
} fill_range;

static void fill_cube(const fill_range *range, const vxm_sparse_piece *piece) {
  const vxm_window *window = range->job->window;
  const vxm_layout *layout = &window->layout;
  int64_t fast = piece->position[layout->fast], middle = piece->position[layout->middle];
  int64_t slow = vxm_max(piece->position[layout->slow], range->begin);
  int64_t end = vxm_min(piece->position[layout->slow] + piece->side, range->end);
  for (; slow < end; slow++)
    for (int64_t m = middle; m < middle + piece->side; m++)
      vxm_row_set_span(vxm_window_row(window, m, slow), fast, fast + piece->side);
}

static void fill_piece(const vxm_sparse_piece *piece, void *payload) {
  const fill_range *range = payload;
  const fill_job *job = range->job;
  if (piece->bits == ~UINT64_C(0)) {
    fill_cube(range, piece);
    return;
  }
  const vxm_layout *layout = &job->window->layout;
  uint64_t bits = piece->bits;
  for (int p = 0; p < 2; p++)
    if (job->swap[p] != p)
      bits = swap_axes(bits, p, job->swap[p]);
  size_t word = (size_t)piece->position[layout->fast] / 64;
  unsigned shift = (unsigned)piece->position[layout->fast] % 64;
  for (int i = 0; i < 16; i++) {
    uint64_t nibble = bits >> 4 * i & 15;
    int64_t slow = piece->position[layout->slow] + i / 4;
    if (nibble && slow >= range->begin && slow < range->end)
      vxm_window_row(job->window, piece->position[layout->middle] + i % 4, slow)[word] |= nibble << shift;
  }
}

static void fill_slices(size_t task, int worker, void *payload) {
  (void)worker;
  const fill_job *job = payload;
  const vxm_window *window = job->window;
  fill_range range = {job, job->first + (int64_t)task * FILL_SLICES, 0};
  range.end = vxm_min(range.begin + FILL_SLICES, window->end);
  range.begin = vxm_max(range.begin, window->begin);
  vxm_window_clear(window, range.begin, range.end);
  vxm_octree_walk_layers(job->sparse, window->layout.slow, range.begin, range.end, fill_piece, &range);
}

void vxm_octree_fill(const vxm_sparse *sparse, const vxm_window *window) {
  fill_job job = {.sparse = sparse, .window = window};
  job.first = window->begin / FILL_SLICES * FILL_SLICES;
  const int want[2] = {window->layout.fast, window->layout.middle};
  int axes[3] = {0, 1, 2};
  for (int p = 0; p < 2; p++) {
    int q = p;
    while (axes[q] != want[p])
      q++;
    job.swap[p] = q;
    axes[q] = axes[p];
    axes[p] = want[p];
  }
  size_t tasks = (size_t)((window->end - job.first + FILL_SLICES - 1) / FILL_SLICES);
  vxm_parallel(sparse->context, tasks, fill_slices, &job);
}

vxm_status vxm_octree_each_window(const vxm_sparse *sparse, vxm_layout layout, int64_t slices,
                                  vxm_octree_window_fn function, void *payload, vxm_error *error) {
  vxm_window window = vxm_window_of(&sparse->space, layout, 0, 0);
  int64_t step = vxm_min(slices, window.slow_dim);
  vxm_error local = VXM_ERROR_INIT;
  window.words = vxm_alloc(sparse->context, window.slice_words * (size_t)step, sizeof *window.words, &local);
  vxm_status status = local.code;
  if (!window.words)
    vxm_error_pass(error, &local);
  for (int64_t begin = 0; begin < window.slow_dim && status == VXM_OK; begin += step) {
    window.begin = begin;
    window.end = vxm_min(begin + step, window.slow_dim);
    vxm_octree_fill(sparse, &window);
    status = function(&window, payload, error);
  }
  vxm_free(sparse->context, window.words);
  return status;
}

/* ---- From a window ---- */

enum { BLOCK_WORDS = 64 }; /**< of the rows, looked at together */

typedef struct add_job {
  vxm_octree_builder *builder;
  const vxm_window *window;
} add_job;

static inline const uint64_t *row_of(const vxm_strip_rows *rows, int y, int z) {
  return rows->words + (size_t)z * rows->slice_words + (size_t)y * rows->row_words;
}

/** One node of the strip: bits 16 n on of a word of each row. */
static void add_node(vxm_octree_builder *builder, const vxm_strip_rows *rows, size_t worker, size_t word,
                     unsigned n) {
  uint64_t bricks[VXM_STRIP_BRICKS] = {0};
  for (int z = 0; z < rows->z_count; z++)
    for (int y = 0; y < rows->y_count; y++) {
      uint64_t bits = row_of(rows, y, z)[word] >> 16 * n & 0xffff;
      unsigned in_y = (unsigned)y, in_z = (unsigned)z;
      unsigned r = (in_y >> 2 & 1) | (in_z >> 1 & 2) | (in_y >> 1 & 4) | (in_z & 8);
      unsigned shift = 16 * (in_z & 3) + 4 * (in_y & 3);
      for (unsigned b = 0; bits; b++, bits >>= 4)
        bricks[16 * b + r] |= (bits & 15) << shift;
    }
  vxm_strip_add_node(builder, worker, 4 * word + n, bricks);
}

static void add_block(vxm_octree_builder *builder, const vxm_strip_rows *rows, size_t worker, size_t first,
                      size_t count) {
  uint64_t any[BLOCK_WORDS] = {0}, all[BLOCK_WORDS];
  bool whole = rows->y_count == VXM_STRIP_VOXELS && rows->z_count == VXM_STRIP_VOXELS;
  memset(all, whole ? 255 : 0, sizeof all);
  for (int z = 0; z < rows->z_count; z++)
    for (int y = 0; y < rows->y_count; y++) {
      const uint64_t *row = row_of(rows, y, z) + first;
      for (size_t w = 0; w < count; w++) {
        any[w] |= row[w];
        all[w] &= row[w];
      }
    }
  for (size_t w = 0; w < count; w++)
    for (unsigned n = 0; n < 4 && any[w] >> 16 * n; n++) {
      if ((all[w] >> 16 * n & 0xffff) == 0xffff)
        vxm_strip_add_full(builder, worker, 4 * (first + w) + n, 4 * (first + w) + n + 1);
      else if (any[w] >> 16 * n & 0xffff)
        add_node(builder, rows, worker, first + w, n);
    }
}

void vxm_strip_add_words(vxm_octree_builder *builder, size_t worker, const vxm_strip_rows *rows, size_t begin,
                         size_t end) {
  for (size_t w = begin; w < end; w += BLOCK_WORDS)
    add_block(builder, rows, worker, w, end - w < BLOCK_WORDS ? end - w : BLOCK_WORDS);
}

static void add_strip(size_t task, int worker, void *payload) {
  const add_job *job = payload;
  const vxm_window *window = job->window;
  size_t across = job->builder->across, y = task % across;
  size_t z = (size_t)window->begin / VXM_STRIP_VOXELS + task / across;
  int64_t y_begin = (int64_t)y * VXM_STRIP_VOXELS, z_begin = (int64_t)z * VXM_STRIP_VOXELS;
  vxm_strip_rows rows = {.words = vxm_window_row(window, y_begin, z_begin),
                         .row_words = window->row_words,
                         .slice_words = window->slice_words};
  rows.y_count = (int)vxm_min(VXM_STRIP_VOXELS, window->middle_dim - y_begin);
  rows.z_count = (int)vxm_min(VXM_STRIP_VOXELS, window->end - z_begin);
  vxm_strip_add_words(job->builder, (size_t)worker, &rows, 0, window->row_words);
  vxm_strip_end(job->builder, (size_t)worker, y, z);
}

void vxm_octree_builder_add(vxm_octree_builder *builder, const vxm_window *window) {
  add_job job = {builder, window};
  size_t deep = (size_t)((window->end - window->begin + VXM_STRIP_VOXELS - 1) / VXM_STRIP_VOXELS);
  vxm_parallel(builder->context, deep * builder->across, add_strip, &job);
}

vxm_status vxm_octree_from_grid(vxm_sparse **out, const vxm_grid *grid, vxm_error *error) {
  vxm_octree_builder builder;
  *out = NULL;
  vxm_status status = vxm_octree_builder_create(&builder, grid->context, &grid->space, error);
  if (status == VXM_OK) {
    vxm_window window = vxm_window_of_grid(grid);
    vxm_octree_builder_add(&builder, &window);
    status = vxm_octree_builder_end(out, &builder, error);
  }
  vxm_octree_builder_destroy(&builder);
  return status;
}
