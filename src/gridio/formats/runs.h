/* SPDX-License-Identifier: BSD-3-Clause */
/** Runs of equal bits, found a word at a time. */
#ifndef VXM_GRIDIO_FORMATS_RUNS_H
#define VXM_GRIDIO_FORMATS_RUNS_H

#include "base/bits.h"

/** The run that is not finished yet. A new sequence starts as {false, 0}. */
typedef struct vxm_bit_run {
  bool value;
  uint64_t length;
} vxm_bit_run;

/** Takes a finished run. The first of a sequence may have length 0. */
typedef void (*vxm_run_fn)(bool value, uint64_t length, void *payload);

/** Goes over `count` bits of a row. `finish` is inlined where it is known. */
static inline __attribute__((always_inline)) void
vxm_run_scan(vxm_bit_run *state, const uint64_t *row, size_t count, vxm_run_fn finish, void *payload) {
  vxm_bit_run run = *state;
  while (count > 0) {
    if (count >= 64 * VXM_LINE_WORDS && vxm_line_is(row, run.value ? ~UINT64_C(0) : 0)) {
      run.length += 64 * VXM_LINE_WORDS;
      count -= 64 * VXM_LINE_WORDS;
      row += VXM_LINE_WORDS;
      continue;
    }
    for (size_t i = 0; i < VXM_LINE_WORDS && count > 0; i++, row++) {
      unsigned bits = count < 64 ? (unsigned)count : 64, from = 0;
      count -= bits;
      uint64_t valid = vxm_low_bits(bits);
      uint64_t changed = (run.value ? ~*row : *row) & valid; /* bits unlike the run's value */
      while (changed) {
        unsigned at = (unsigned)__builtin_ctzll(changed);
        finish(run.value, run.length + at - from, payload);
        run = (vxm_bit_run){!run.value, 0};
        from = at;
        changed = ~changed & valid & ~UINT64_C(0) << at;
      }
      run.length += bits - from;
    }
  }
  *state = run;
}

/** Appends `count` bits that are 0. */
static inline __attribute__((always_inline)) void vxm_run_skip(vxm_bit_run *run, uint64_t count,
                                                               vxm_run_fn finish, void *payload) {
  if (run->value && count > 0) {
    finish(true, run->length, payload);
    *run = (vxm_bit_run){false, 0};
  }
  run->length += count;
}

#endif
