/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Numbers of a coverage stored one after the other, a line of the cache at a time: past the cache where there
 * are so many that they would not stay in it. Most come in runs of the same number.
 */
#ifndef VXM_VOXEL_FIELDS_COVERAGE_WRITER_H
#define VXM_VOXEL_FIELDS_COVERAGE_WRITER_H

#include "base/unroll.h"
#include "voxel/fields/coverage_values.h"

#include <stddef.h>
#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

enum { VXM_WRITER_LINE = 64 };

typedef struct vxm_coverage_writer {
  const vxm_coverage_values *values;
  vxm_coverage_tally *tally;
  size_t number;      /**< bytes of one */
  unsigned char *to;  /**< where the line at hand goes */
  size_t used, begin; /**< bytes of that line which are there, from `begin` on */
  bool streaming;
  _Alignas(64) unsigned char line[2 * VXM_WRITER_LINE]; /**< at hand, and room for what is written over it */
} vxm_coverage_writer;

typedef float vxm_writer_four __attribute__((vector_size(16), aligned(1), may_alias));

/** From number `at` of the values on, which nobody else stores at the same time. */
static inline void vxm_coverage_writer_begin(vxm_coverage_writer *w, const vxm_coverage_values *values,
                                             size_t at, vxm_coverage_tally *tally) {
  w->values = values;
  w->tally = tally;
  w->number = vxm_scalar_bytes(values->scalar);
  w->streaming = values->streaming;
  unsigned char *first = values->out + at * w->number;
  w->begin = w->used = (uintptr_t)first % VXM_WRITER_LINE;
  w->to = first - w->begin;
}

static inline void vxm_writer_store(const vxm_coverage_writer *w, const vxm_writer_four four[4]) {
  vxm_writer_four *to = (vxm_writer_four *)(void *)w->to;
#if defined(__SSE2__)
  if (w->streaming) {
    VXM_UNROLL(4)
    for (int i = 0; i < 4; i++)
      _mm_stream_ps((float *)(to + i), (__m128)four[i]);
    return;
  }
#endif
  VXM_UNROLL(4)
  for (int i = 0; i < 4; i++)
    to[i] = four[i];
}

/** The line at hand is full. */
static inline void vxm_writer_flush(vxm_coverage_writer *w) {
  if (w->begin == 0)
    vxm_writer_store(w, (const vxm_writer_four *)(const void *)w->line);
  else
    memcpy(w->to + w->begin, w->line + w->begin, VXM_WRITER_LINE - w->begin);
  w->begin = 0;
  w->to += VXM_WRITER_LINE;
}

/** The same number `some` times, of `count` sub-voxels each. */
static inline void vxm_coverage_put(vxm_coverage_writer *w, size_t some, unsigned count) {
  unsigned n = (unsigned)w->values->n, most = n * n * n;
  w->tally->subvoxels += (int64_t)(some * count);
  w->tally->full += count == most ? (int64_t)some : 0;
  w->tally->partial += count > 0 && count < most ? (int64_t)some : 0;
  vxm_writer_four all[4];
  if (w->number == 1)
    memset(all, w->values->bytes[count], sizeof all);
  else {
    float f = w->values->fractions[count];
    all[0] = all[1] = all[2] = all[3] = (vxm_writer_four){f, f, f, f};
  }
  memcpy(w->line + w->used, all, sizeof all);
  size_t end = w->used + some * w->number;
  if (end < VXM_WRITER_LINE) {
    w->used = end;
    return;
  }
  vxm_writer_flush(w);
  for (end -= VXM_WRITER_LINE; end >= VXM_WRITER_LINE; end -= VXM_WRITER_LINE, w->to += VXM_WRITER_LINE)
    vxm_writer_store(w, all);
  memcpy(w->line, all, sizeof all);
  w->used = end;
}

/** What is left of the last line, so that all numbers are where they belong, for other threads too. */
static inline void vxm_coverage_writer_end(vxm_coverage_writer *w) {
  memcpy(w->to + w->begin, w->line + w->begin, w->used - w->begin);
#if defined(__SSE2__)
  if (w->streaming)
    _mm_sfence();
#endif
}

#endif
