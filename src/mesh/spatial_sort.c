/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/spatial_sort.h"
#include "base/rng.h"
#include "base/threads.h"

#include <stdatomic.h>
#include <string.h>

enum {
  RANGES = 64,     /**< that are sorted at the same time, at most */
  SHARE_MIN = 4096 /**< points in a range that is worth a thread of its own */
};

typedef struct range {
  size_t begin, end;
} range;

typedef struct sorter {
  vxm_spatial_point *points;
  range ranges[RANGES];
  size_t count;
  vxm_context *context;
  atomic_bool stop;
} sorter;

/* ---- Cutting in two ---- */

typedef float four __attribute__((vector_size(16)));
typedef int32_t four_int __attribute__((vector_size(16)));

static int widest_axis(const vxm_spatial_point *points, range r) {
  /* An vxm_spatial_point as a vector; its number takes part, and is not looked at. */
  four low, high;
  memcpy(&low, &points[r.begin], sizeof low);
  high = low;
  for (size_t i = r.begin + 1; i < r.end; i++) {
    four x;
    memcpy(&x, &points[i], sizeof x);
    four_int is_below = x<low, is_above = x> high;
    low = (four)((is_below & (four_int)x) | (~is_below & (four_int)low));
    high = (four)((is_above & (four_int)x) | (~is_above & (four_int)high));
  }
  four size = high - low;
  int widest = 0;
  for (int a = 1; a < 3; a++)
    widest = size[a] > size[widest] ? a : widest;
  return widest;
}

/** Moves the points below a bound, or up to it, to the front; returns where the others begin. */
static size_t move_below(vxm_spatial_point *points, range r, int axis, float bound, bool with_bound) {
  size_t end = r.begin;
  for (size_t i = r.begin; i < r.end; i++) {
    vxm_spatial_point at = points[i];
    bool is_below = with_bound ? at.at[axis] <= bound : at.at[axis] < bound;
    points[i] = points[end];
    points[end] = at;
    end += is_below;
  }
  return end;
}

/**
 * A bound that as large a part of a range as `part` should lie below, from a sample; a little to the inside,
 * so that what is sought ends up on the smaller side. The sample is taken by chance, as any regular one could
 * be led astray by the order of a file.
 */
static float guess_bound(const vxm_spatial_point *points, range r, int axis, double part, vxm_rng *rng) {
  enum { MOST = 33 };
  float sample[MOST];
  int samples = r.end - r.begin > 1024 ? MOST : r.end - r.begin > 64 ? 9 : 3;
  for (int n = 0; n < samples; n++) {
    float x = points[r.begin + vxm_rng_below(rng, r.end - r.begin)].at[axis];
    int place = n;
    for (; place > 0 && sample[place - 1] > x; place--)
      sample[place] = sample[place - 1];
    sample[place] = x;
  }
  int inside = samples / 16, rank = (int)(part * (samples - 1) + 0.5);
  rank += part < 0.5 ? inside : -inside;
  return sample[rank];
}

/** Moves the lesser points before place `half`. */
static void halve(vxm_spatial_point *points, range r, size_t half, int axis, vxm_rng *rng) {
  while (r.begin < half && half < r.end) {
    float bound = guess_bound(points, r, axis, (double)(half - r.begin) / (double)(r.end - r.begin), rng);
    size_t end = move_below(points, r, axis, bound, false);
    if (end > half) {
      r.end = end;
      continue;
    }
    r.begin = end; /* what is left has points at the bound, which may be many */
    end = move_below(points, r, axis, bound, true);
    if (end >= half)
      return;
    r.begin = end;
  }
}

/* ---- Ranges ---- */

/** Cuts a range behind the greatest run that may be a node; returns what lies behind. */
static range split(vxm_spatial_point *points, range *r) {
  size_t run = VXM_SPATIAL_SORT_LEAF;
  while (2 * run < r->end - r->begin)
    run *= 2;
  vxm_rng rng = {r->begin};
  range rest = {r->begin + run, r->end};
  halve(points, *r, rest.begin, widest_axis(points, *r), &rng);
  r->end = rest.begin;
  return rest;
}

static bool goes_on(sorter *s) {
  if (s->context && vxm_check_cancelled(s->context, NULL) != VXM_OK)
    atomic_store_explicit(&s->stop, true, memory_order_relaxed);
  return !atomic_load_explicit(&s->stop, memory_order_relaxed);
}

static void sort_range(size_t task, int worker, void *payload) {
  (void)worker;
  sorter *s = payload;
  range stack[64] = {s->ranges[task]}; /* each at most half of the one below, but for the first */
  for (size_t depth = 1; depth > 0;) {
    range *top = &stack[depth - 1];
    if (top->end - top->begin > SHARE_MIN && !goes_on(s))
      return;
    if (top->end - top->begin > VXM_SPATIAL_SORT_LEAF)
      stack[depth++] = split(s->points, top);
    else
      depth--;
  }
}

static void split_range(size_t task, int worker, void *payload) {
  (void)worker;
  sorter *s = payload;
  range *r = &s->ranges[task];
  s->ranges[s->count + task] = r->end - r->begin > SHARE_MIN ? split(s->points, r) : (range){r->end, r->end};
}

vxm_status vxm_spatial_sort(vxm_spatial_point *points, size_t count, vxm_context *context, vxm_error *error) {
  sorter s = {.points = points, .ranges = {{0, count}}, .count = 1, .context = context};
  size_t wanted = context ? 4 * (size_t)vxm_context_threads(context) : 1;
  if (wanted <= 4) {
    sort_range(0, 0, &s);
    return atomic_load(&s.stop) ? vxm_fail_cancelled(error) : VXM_OK;
  }
  for (; 2 * s.count <= RANGES && s.count < wanted && goes_on(&s); s.count *= 2)
    vxm_parallel(context, s.count, split_range, &s);
  vxm_parallel(context, s.count, sort_range, &s);
  return atomic_load(&s.stop) ? vxm_fail_cancelled(error) : VXM_OK;
}
