/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_settle.h"
#include "voxel/winding/winding_exact.h"

#include <math.h>

/** Winding numbers this close to a half are taken for it. */
static const double tie = 1e-6;

static const vxm_winding_asking *asking_of(const vxm_winding_walk *walk) {
  return (const vxm_winding_asking *)(const void *)walk;
}

bool vxm_winding_wants(const vxm_winding_walk *walk, const int64_t origin[3], int level) {
  const vxm_winding_asking *job = asking_of(walk);
  int64_t side = INT64_C(4) << level;
  for (int a = 0; a < 3; a++)
    if (origin[a] >= job->end[a] || origin[a] + side <= job->begin[a])
      return false;
  const uint8_t *doubted = walk->strict ? vxm_brick_mask_at(&job->mesh->doubted, origin, level) : NULL;
  if (walk->strict && !(doubted && *doubted))
    return false;
  const uint8_t *asked = job->is_asked ? vxm_brick_mask_at(&job->mesh->asked, origin, level) : NULL;
  return !job->is_asked || (asked && *asked);
}

/** Turns bits of a word over. */
static void flip(const vxm_winding_asking *job, uint64_t *word, uint64_t change) {
  if (!change)
    return;
  if (job->is_alone)
    *word ^= change;
  else /* other threads may change other bits */
    __atomic_fetch_xor(word, change, __ATOMIC_RELAXED);
}

/** Bits of a word become those of `bits`. */
static void store_word(const vxm_winding_asking *job, uint64_t *word, uint64_t bits, uint64_t mask) {
  flip(job, word, (__atomic_load_n(word, __ATOMIC_RELAXED) ^ bits) & mask);
}

/** Bits first..first+count-1 of a row become `bits`. */
static void store_bits(const vxm_winding_asking *job, uint64_t *row, int64_t first, int64_t count,
                       uint64_t bits) {
  for (int64_t done = 0; done < count;) {
    int64_t at = first + done, n = vxm_min(count - done, 64 - at % 64);
    store_word(job, row + at / 64, bits >> done << (at % 64), vxm_low_bits((unsigned)n) << (at % 64));
    done += n;
  }
}

/** The number of the closed chain at up to 64 voxels of a row, plus `number`: whether it is at least 1. */
static uint64_t at_least_one(const vxm_winding_asking *job, size_t row, int64_t first, int64_t count,
                             int number) {
  const vxm_chain_winding *closed = &job->mesh->closed;
  uint64_t bits = 0;
  if (!closed->counted[row])
    return number > 0 ? ~UINT64_C(0) : 0; /* it is 0 or 1, and number is not 0 */
  for (int64_t i = 0; i < count; i++)
    bits |= (uint64_t)(vxm_chain_winding_at(closed, row, first + i) + number >= 1) << i;
  return bits;
}

/** Where the voxels of a cell lie in the window: its first ones along the fast, middle and slow axis, and how
 * many. */
static void clip(const vxm_winding_asking *job, const int64_t origin[3], int64_t side, int64_t first[3],
                 int64_t count[3]) {
  const int axis[3] = {job->window->layout.fast, job->window->layout.middle, job->window->layout.slow};
  for (int i = 0; i < 3; i++) {
    int a = axis[i];
    first[i] = vxm_max(origin[a], job->begin[a]);
    count[i] = vxm_min(origin[a] + side, job->end[a]) - first[i];
  }
}

static size_t row_of(const vxm_winding_asking *job, int64_t middle, int64_t slow) {
  return (size_t)(slow - job->window->begin) * (size_t)job->window->middle_dim + (size_t)middle;
}

void vxm_winding_settle_cell(const vxm_winding_walk *walk, const int64_t origin[3], int level, int number) {
  const vxm_winding_asking *job = asking_of(walk);
  const vxm_window *out = vxm_winding_decided(job);
  int64_t first[3], count[3];
  if (number == 0)
    return; /* as the closed chain says */
  clip(job, origin, INT64_C(4) << level, first, count);
  for (int64_t s = first[2]; s < first[2] + count[2]; s++)
    for (int64_t m = first[1]; m < first[1] + count[1]; m++) {
      size_t row = row_of(job, m, s);
      for (int64_t f = 0; f < count[0]; f += 64) {
        int64_t n = vxm_min(64, count[0] - f);
        store_bits(job, out->words + row * out->row_words, first[0] + f, n,
                   at_least_one(job, row, first[0] + f, n, number));
      }
    }
}

/** The whole of a row's winding number: that of the closed chain at a voxel and `value`. */
static double whole_number(const vxm_winding_asking *job, size_t row, int64_t fast, double value) {
  const vxm_chain_winding *closed = &job->mesh->closed;
  if (closed->counted[row])
    return (double)vxm_chain_winding_at(closed, row, fast) + value;
  const uint64_t *word = closed->window.words + row * closed->window.row_words + fast / 64;
  return (double)(__atomic_load_n(word, __ATOMIC_RELAXED) >> (fast % 64) & 1) + value;
}

/** The bits of a row of a brick, the first of them at voxel `from` of it, `step` apart. */
static uint64_t row_bits(uint64_t mask, int64_t from, int64_t step, int64_t count) {
  if (step == 1)
    return mask >> from & vxm_low_bits((unsigned)count);
  uint64_t bits = 0;
  for (int64_t i = 0; i < count; i++)
    bits |= (mask >> (from + i * step) & 1) << i;
  return bits;
}

/** What is still in doubt gets its number by doubles. */
static void resolve(const vxm_winding_asking *job, const int64_t origin[3], uint64_t doubtful,
                    vxm_winding_brick *brick) {
  double number[VXM_BRICK];
  uint64_t close = 0;
  for (uint64_t left = doubtful; left && !job->confidence; left &= left - 1) {
    double half = (double)brick->value[__builtin_ctzll(left)] - 0.5;
    close |= fabs(half - rint(half)) < (double)VXM_WINDING_STRICT_DOUBT ? left & -left : 0;
  }
  vxm_winding_exact(number, job->kernels, &job->mesh->tree, origin, brick->doubtful, doubtful, close);
  for (uint64_t left = doubtful; left; left &= left - 1) {
    int v = __builtin_ctzll(left);
    double w = number[v];
    uint64_t bit = left & -left;
    brick->value[v] = (float)w;
    brick->above[0] = (brick->above[0] & ~bit) | (w > tie - 0.5 ? bit : 0);
    brick->above[1] = (brick->above[1] & ~bit) | (w > tie + 0.5 ? bit : 0);
  }
}

/** Voxels of a brick are this far from each other in its masks, along x, y and z. */
static const int64_t place[3] = {1, 4, 16};

/** A row of a brick, as far as it lies in the window. */
typedef struct brick_row {
  size_t row;     /**< of the window */
  int64_t start;  /**< the voxel of the brick that is its first one */
  uint64_t asked; /**< which of its voxels are asked about */
} brick_row;

/** The rows of a brick in which something is asked about. */
typedef struct brick_rows {
  brick_row row[VXM_BRICK_SIDE * VXM_BRICK_SIDE];
  int count;
  int64_t first;  /**< voxel of all of them */
  int64_t step;   /**< of their voxels in masks of the brick */
  uint64_t asked; /**< about which voxels of the brick */
} brick_rows;

/** The bits of a row, as far from each other as in a mask of a brick. */
static inline uint64_t apart(uint64_t bits, int64_t step) {
  if (step == 1)
    return bits;
  uint64_t out = 0;
  for (int64_t i = 0; i < VXM_BRICK_SIDE; i++)
    out |= (bits >> i & 1) << (i * step);
  return out;
}

static void list_rows(brick_rows *out, const vxm_winding_asking *job, const int64_t origin[3]) {
  const vxm_window *window = job->window;
  const vxm_layout *layout = &window->layout;
  int64_t first[3], count[3];
  clip(job, origin, VXM_BRICK_SIDE, first, count);
  const int64_t step = place[layout->fast];
  const uint64_t all = vxm_low_bits((unsigned)count[0]);
  out->count = 0;
  out->asked = 0;
  out->first = first[0];
  out->step = step;
  for (int64_t s = first[2]; s < first[2] + count[2]; s++) {
    size_t word = (size_t)(s - window->begin) * window->slice_words + (size_t)first[1] * window->row_words +
                  (size_t)first[0] / 64;
    size_t row = row_of(job, first[1], s);
    int64_t start = (s - origin[layout->slow]) * place[layout->slow] +
                    (first[1] - origin[layout->middle]) * place[layout->middle] +
                    (first[0] - origin[layout->fast]) * step;
    for (int64_t m = 0; m < count[1]; m++, word += window->row_words, start += place[layout->middle]) {
      uint64_t asked = job->asked ? job->asked[word] >> (first[0] % 64) & all : all;
      if (!asked)
        continue;
      out->asked |= apart(asked, step) << start;
      out->row[out->count++] = (brick_row){row + (size_t)m, start, asked};
    }
  }
}

/** The word of a row in which the voxels of a brick are. */
static uint64_t *word_of(const vxm_winding_asking *job, const brick_rows *rows, const brick_row *row) {
  return vxm_winding_decided(job)->words + row->row * vxm_winding_decided(job)->row_words + rows->first / 64;
}

/** A row by numbers: where that of the closed chain must be counted, or confidence is asked. */
static void settle_row(const vxm_winding_asking *job, const vxm_winding_brick *brick, const brick_rows *rows,
                       const brick_row *row) {
  const vxm_window *out = vxm_winding_decided(job);
  uint64_t bits = 0;
  for (int64_t i = 0; i < VXM_BRICK_SIDE && rows->first + i < out->fast_dim; i++) {
    int64_t fast = rows->first + i;
    double w = whole_number(job, row->row, fast, (double)brick->value[row->start + i * rows->step]);
    bits |= (uint64_t)(w > 0.5 + tie) << i;
    if (job->confidence && row->asked >> i & 1) {
      double sure = fabs(2 * w - 1);
      job->confidence[(size_t)out->fast_dim * (row->row + (size_t)(out->begin * out->middle_dim)) +
                      (size_t)fast] = (uint8_t)(sure < 1 ? 255 * sure : 255);
    }
  }
  store_word(job, word_of(job, rows, row), bits << (rows->first % 64), row->asked << (rows->first % 64));
}

/** Rows of which the closed chain has a number of 0 or 1 all over, which their bits tell. */
static void settle_rows(const vxm_winding_asking *job, const vxm_winding_brick *brick,
                        const brick_rows *rows) {
  const int shift = (int)(rows->first % 64);
  uint64_t chain = 0;
  for (int r = 0; r < rows->count; r++) {
    uint64_t word = __atomic_load_n(word_of(job, rows, &rows->row[r]), __ATOMIC_RELAXED);
    chain |= apart(word >> shift & 15, rows->step) << rows->row[r].start;
  }
  uint64_t change = ((chain & ~brick->above[0]) | (~chain & brick->above[1])) & rows->asked;
  for (int r = 0; r < rows->count && change; r++) {
    uint64_t bits = row_bits(change, rows->row[r].start, rows->step, VXM_BRICK_SIDE) & rows->row[r].asked;
    flip(job, word_of(job, rows, &rows->row[r]), bits << shift);
  }
}

static bool has_counted(const vxm_winding_asking *job, const brick_rows *rows) {
  uint32_t any = 0;
  for (int r = 0; r < rows->count; r++)
    any |= job->mesh->closed.counted[rows->row[r].row];
  return any != 0;
}

void vxm_winding_settle_brick(const vxm_winding_walk *walk, const int64_t origin[3],
                              const vxm_winding_brick *brick) {
  const vxm_winding_asking *job = asking_of(walk);
  brick_rows rows;
  if (!brick->doubtful && !~brick->above[0] && !brick->above[1] && !job->confidence)
    return; /* as the closed chain says */
  list_rows(&rows, job, origin);
  uint64_t doubtful = brick->doubtful;
  if (!job->confidence)
    doubtful &= rows.asked;
  vxm_winding_brick resolved;
  if (doubtful && !walk->strict) {
    *vxm_brick_mask_at(&job->mesh->doubted, origin, 0) = 1; /* the bits stay those of the closed chain */
    return;
  }
  if (doubtful) {
    resolved = *brick;
    resolve(job, origin, doubtful, &resolved);
    brick = &resolved;
  }
  if (!job->confidence && !has_counted(job, &rows)) {
    settle_rows(job, brick, &rows);
    return;
  }
  for (int r = 0; r < rows.count; r++)
    settle_row(job, brick, &rows, &rows.row[r]);
}
