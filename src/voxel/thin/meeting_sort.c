/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meeting_sort.h"
#include "base/bits.h"

#include <string.h>

enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

/** How numbers of cells are taken apart: of the voxel's bits the high ones that all have alike are left out.
 */
typedef struct digits {
  int voxel_bits; /**< below the kind */
  int bits, count;
} digits;

static digits digits_of(const vxm_meeting *meetings, size_t count) {
  enum { KIND_BITS = 64 - VXM_DUAL_VOXEL_BITS };
  uint64_t differ = 0;
  for (size_t m = 1; m < count; m++)
    differ |= meetings[m].element ^ meetings[0].element;
  differ &= vxm_low_bits(VXM_DUAL_VOXEL_BITS);
  digits d = {.voxel_bits = 0};
  while (differ >> d.voxel_bits != 0)
    d.voxel_bits++;
  d.count = (d.voxel_bits + KIND_BITS + DIGIT_BITS - 1) / DIGIT_BITS;
  d.bits = (d.voxel_bits + KIND_BITS + d.count - 1) / d.count;
  return d;
}

static inline size_t digit_of(const digits *d, uint64_t cell, int place) {
  uint64_t number = (cell & vxm_low_bits((unsigned)d->voxel_bits)) | cell >> VXM_DUAL_VOXEL_BITS
                                                                                 << d->voxel_bits;
  return (size_t)(number >> place * d->bits & vxm_low_bits((unsigned)d->bits));
}

/** A pass of a stable sort. */
static void sort_by_digit(vxm_meeting *to, const vxm_meeting *from, size_t count, const digits *d,
                          int place) {
  size_t next[DIGITS], total = 0;
  memset(next, 0, sizeof *next << d->bits);
  for (size_t m = 0; m < count; m++)
    next[digit_of(d, from[m].element, place)]++;
  for (int i = 0; i < 1 << d->bits; i++) {
    size_t here = next[i];
    next[i] = total;
    total += here;
  }
  for (size_t m = 0; m < count; m++)
    to[next[digit_of(d, from[m].element, place)]++] = from[m];
}

/** Sorts a few. */
static void sort_few(vxm_meeting *meetings, size_t count) {
  for (size_t m = 1; m < count; m++) {
    vxm_meeting one = meetings[m];
    size_t to = m;
    for (; to > 0 && meetings[to - 1].element > one.element; to--)
      meetings[to] = meetings[to - 1];
    meetings[to] = one;
  }
}

/** The same of any number; returns which of the two lists has them. */
static vxm_meeting *sort_by_digits(vxm_meeting *from, vxm_meeting *to, size_t count) {
  const size_t few = 32; /* less than digits */
  if (count <= few) {
    sort_few(from, count);
    return from;
  }
  const digits d = digits_of(from, count);
  for (int place = 0; place < d.count; place++) {
    sort_by_digit(to, from, count, &d, place);
    vxm_meeting *sorted = to;
    to = from;
    from = sorted;
  }
  return from;
}

/* ---- Links that are met once ---- */

/** Cells that some meetings have, by hash, and those that several have. */
typedef struct seen_cells {
  uint64_t *once, *twice;
  unsigned shift; /**< of a hash, to a bit */
} seen_cells;

static inline size_t hash_of(const seen_cells *seen, uint64_t cell) {
  return (size_t)(cell * UINT64_C(0x9E3779B97F4A7C15) >> seen->shift);
}

/** The cells of the first stage. @param room for `count` meetings: two maps of 8 to 16 bits for each fit */
static seen_cells see_cells(vxm_meeting *room, const vxm_meeting *meetings, size_t count) {
  unsigned bits = 6;
  while (UINT64_C(1) << bits < 8 * count)
    bits++;
  const size_t words = (size_t)1 << (bits - 6);
  uint64_t *once = (uint64_t *)(void *)room;
  seen_cells seen = {once, once + words, 64 - bits};
  memset(once, 0, 2 * words * sizeof *once);
  for (size_t m = 0; m < count; m++)
    if (vxm_dual_stage(meetings[m].element) == VXM_THIN_DOMINANT_LINKS) {
      const size_t bit = hash_of(&seen, meetings[m].element);
      const uint64_t mask = UINT64_C(1) << (bit % 64);
      seen.twice[bit / 64] |= seen.once[bit / 64] & mask;
      seen.once[bit / 64] |= mask;
    }
  return seen;
}

/** Moves links of the first stage that are met once to the front; returns how many. Of an open sheet
 * nearly all are. */
static size_t set_apart(vxm_meeting *meetings, vxm_meeting *room, size_t count) {
  const seen_cells seen = see_cells(room, meetings, count);
  size_t alone = 0;
  for (size_t m = 0; m < count; m++) {
    const size_t bit = hash_of(&seen, meetings[m].element);
    if (vxm_dual_stage(meetings[m].element) != VXM_THIN_DOMINANT_LINKS ||
        seen.twice[bit / 64] >> (bit % 64) & 1)
      continue;
    const vxm_meeting one = meetings[m];
    meetings[m] = meetings[alone];
    meetings[alone++] = one;
  }
  return alone;
}

vxm_meeting *vxm_meetings_sort(vxm_meeting *from, vxm_meeting *to, size_t count) {
  const size_t many = 1 << 10; /* so that it is worth to set some apart */
  if (count < many)
    return sort_by_digits(from, to, count);
  const size_t alone = set_apart(from, to, count), rest = count - alone;
  if (sort_by_digits(from + alone, to, rest) == to)
    memcpy(from + alone, to, rest * sizeof *to);
  return from;
}
