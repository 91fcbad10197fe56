/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/ear_clipping.h"
#include "mesh/orient2d.h"
#include "mesh/quad_diagonal.h"

#include <math.h>
#include <string.h>

enum { ALONE = 24 /**< corners of a polygon that needs no tree */ };

/** Stands for the place of a corner that is not in the heap. */
static const uint32_t nowhere = UINT32_MAX;

/* ---- Room ---- */

void vxm_triangulator_open(vxm_triangulator *tri, vxm_context *context) {
  *tri = (vxm_triangulator){.context = context, .looks_left = (size_t)1 << 25};
}

void vxm_triangulator_close(vxm_triangulator *tri) {
  vxm_free(tri->context, tri->plane);
  vxm_free(tri->context, tri->before);
  vxm_free(tri->context, tri->after);
  vxm_free(tri->context, tri->points);
  vxm_free(tri->context, tri->places);
  vxm_free(tri->context, tri->boxes);
  vxm_free(tri->context, tri->counts);
  vxm_free(tri->context, tri->heap);
  vxm_free(tri->context, tri->waits);
  vxm_free(tri->context, tri->cuts);
  vxm_free(tri->context, tri->triangles);
}

/** Each with room for a capacity that is a multiple of VXM_SPATIAL_SORT_LEAF: less than half as many nodes.
 */
static vxm_status reserve(vxm_triangulator *tri, size_t n, vxm_error *error) {
  if (n <= tri->capacity)
    return VXM_OK;
  const struct {
    void **block;
    size_t size;
  } blocks[] = {{(void **)&tri->plane, sizeof *tri->plane},
                {(void **)&tri->before, sizeof *tri->before},
                {(void **)&tri->after, sizeof *tri->after},
                {(void **)&tri->points, sizeof *tri->points},
                {(void **)&tri->places, sizeof *tri->places},
                {(void **)&tri->boxes, sizeof *tri->boxes},
                {(void **)&tri->counts, sizeof *tri->counts},
                {(void **)&tri->heap, sizeof *tri->heap},
                {(void **)&tri->waits, sizeof *tri->waits},
                {(void **)&tri->cuts, sizeof *tri->cuts},
                {(void **)&tri->triangles, 3 * sizeof *tri->triangles}};
  size_t capacity = 0;
  for (size_t b = 0; b < sizeof blocks / sizeof *blocks; b++) {
    capacity = tri->capacity;
    vxm_status status = vxm_grow(tri->context, blocks[b].block, &capacity, n, blocks[b].size, error);
    if (status != VXM_OK)
      return status;
  }
  tri->capacity = capacity;
  return VXM_OK;
}

/* ---- The plane ---- */

/** See vxm_scale_near_one. */
static double scale_of(const double *positions, const uint32_t *corners, size_t n) {
  double most = 0;
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 3; c++) {
      double x = fabs(positions[3 * (size_t)corners[i] + c]);
      if (!isfinite(x))
        return 0;
      most = x > most ? x : most;
    }
  return vxm_scale_near_one(most);
}

/** The axis on which the vector area (Newell's sum) is largest; where that is nothing but rounding, as in
 * paths there and back, the one on which the areas of its parts are. */
static size_t widest_axis(const double *positions, const uint32_t *corners, size_t n, double scale) {
  double area[3] = {0.0, 0.0, 0.0}, parts[3] = {0.0, 0.0, 0.0};
  const double *o = positions + 3 * (size_t)corners[0];
  for (size_t i = 1; i + 1 < n; i++) {
    const double *p = positions + 3 * (size_t)corners[i], *q = positions + 3 * (size_t)corners[i + 1];
    double a[3], b[3];
    for (size_t c = 0; c < 3; c++) {
      a[c] = p[c] * scale - o[c] * scale;
      b[c] = q[c] * scale - o[c] * scale;
    }
    for (size_t c = 0; c < 3; c++) {
      double part = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
      area[c] += part;
      parts[c] += fabs(part);
    }
  }
  size_t axis = 0, broad = 0;
  for (size_t c = 1; c < 3; c++) {
    axis = fabs(area[c]) > fabs(area[axis]) ? c : axis;
    broad = parts[c] > parts[broad] ? c : broad;
  }
  return fabs(area[axis]) > 1e-12 * parts[broad] ? axis : broad;
}

/** Whether the polygon turns right, by twice its area, which two doubles hold. */
static bool turns_right(const double (*plane)[2], size_t n) {
  double sum = 0, rest = 0;
  for (size_t i = 0; i < n; i++) {
    const double *a = plane[i], *b = plane[i + 1 < n ? i + 1 : 0];
    for (int part = 0; part < 2; part++) {
      double factor = part ? -a[1] : a[0], other = part ? b[0] : b[1], product = factor * other;
      double next = sum + product, added = next - sum;
      rest += (sum - (next - added)) + (product - added) + fma(factor, other, -product);
      sum = next;
    }
  }
  return sum + rest < 0;
}

/** Leaves one coordinate out, so that the polygon turns left. */
static void project(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n,
                    double scale) {
  size_t axis = widest_axis(positions, corners, n, scale), u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (size_t i = 0; i < n; i++) {
    const double *p = positions + 3 * (size_t)corners[i];
    tri->plane[i][0] = p[u] * scale;
    tri->plane[i][1] = p[v] * scale;
  }
  if (!turns_right((const double(*)[2])tri->plane, n))
    return;
  for (size_t i = 0; i < n; i++) {
    double kept = tri->plane[i][0];
    tri->plane[i][0] = tri->plane[i][1];
    tri->plane[i][1] = kept;
  }
}

static bool is_convex(const double (*plane)[2], size_t n) {
  /* Only left turns, and once round: x changes its direction just twice. */
  size_t changes = 0;
  for (size_t i = 0; i < n; i++) {
    size_t j = i + 1 < n ? i + 1 : 0, k = j + 1 < n ? j + 1 : 0;
    if (vxm_orient2d(plane[i], plane[j], plane[k]) <= 0)
      return false;
    changes += (plane[j][0] > plane[i][0]) != (plane[k][0] > plane[j][0]);
  }
  return changes <= 2;
}

/* ---- A heap of corners that wait ---- */

static void set_place(const vxm_ring *r, size_t place, uint32_t i) {
  r->tri->heap[place] = i;
  r->tri->waits[i] = (uint32_t)place;
}

static inline const double *position_of(const vxm_ring *r, uint32_t i) {
  return r->positions + 3 * (size_t)r->corners[i];
}

/** Whether a corner is tried before another one: where it takes a shorter cut; of equal ones it is told by
 * where they lie, so that equal polygons become the same triangles, whichever corner they begin with. */
static bool goes_first(const vxm_ring *r, uint32_t i, uint32_t j) {
  double cut = r->tri->cuts[i], other = r->tri->cuts[j];
  return cut != other ? cut < other : vxm_lies_before(position_of(r, i), position_of(r, j));
}

static void sift(const vxm_ring *r, size_t place) {
  const vxm_triangulator *tri = r->tri;
  uint32_t i = tri->heap[place];
  for (; place > 0 && goes_first(r, i, tri->heap[(place - 1) / 2]); place = (place - 1) / 2)
    set_place(r, place, tri->heap[(place - 1) / 2]);
  for (;;) {
    size_t child = 2 * place + 1;
    if (child >= r->waiting)
      break;
    child += child + 1 < r->waiting && goes_first(r, tri->heap[child + 1], tri->heap[child]);
    if (!goes_first(r, tri->heap[child], i))
      break;
    set_place(r, place, tri->heap[child]);
    place = child;
  }
  set_place(r, place, i);
}

static void take_out(vxm_ring *r, uint32_t i) {
  size_t place = r->tri->waits[i];
  if (place == nowhere)
    return;
  r->tri->waits[i] = nowhere;
  uint32_t last = r->tri->heap[--r->waiting];
  if (last == i)
    return;
  set_place(r, place, last);
  sift(r, place);
}

/** Has a corner tried, the shorter the cut the sooner: that keeps triangles small, and the looking round that
 * comes before each. Corners in line come last. */
static void enqueue(vxm_ring *r, uint32_t i) {
  const double *a = r->tri->plane[r->tri->before[i]], *b = r->tri->plane[i],
               *c = r->tri->plane[r->tri->after[i]];
  int turn = r->is_convex ? 1 : vxm_orient2d(a, b, c);
  take_out(r, i);
  if (turn < 0 || (turn == 0 && !r->may_touch))
    return;
  r->tri->cuts[i] = turn > 0 ? vxm_squared_length(position_of(r, r->tri->before[i]),
                                                  position_of(r, r->tri->after[i]), r->scale)
                             : (double)INFINITY;
  set_place(r, r->waiting++, i);
  sift(r, r->waiting - 1);
}

/* ---- Ears ---- */

static void put(vxm_ring *r, uint32_t a, uint32_t b, uint32_t c) {
  *r->triangle++ = r->corners[a];
  *r->triangle++ = r->corners[b];
  *r->triangle++ = r->corners[c];
}

/** Whether a ring turns back at a corner, or has another at the same place beside it. */
static bool is_spike(const vxm_ring *r, uint32_t i) {
  const double *a = r->tri->plane[r->tri->before[i]], *b = r->tri->plane[i],
               *c = r->tri->plane[r->tri->after[i]];
  for (int k = 0; k < 2; k++) /* in line, b lies between the others where it does so along both axes */
    if ((a[k] < b[k] && b[k] < c[k]) || (a[k] > b[k] && b[k] > c[k]))
      return false;
  return vxm_orient2d(a, b, c) == 0;
}

static void cut(vxm_ring *r, uint32_t i) {
  uint32_t a = r->tri->before[i], c = r->tri->after[i];
  put(r, a, i, c);
  r->tri->after[a] = c;
  r->tri->before[c] = a;
  r->tri->after[i] = VXM_RING_CLIPPED;
  take_out(r, i);
  vxm_ring_drop(r, i);
  r->remaining--;
}

/**
 * Cuts a corner off, and then all spikes that come of it, as where a ring turns back nothing tells its inside
 * from its outside. The neighbours left may have become ears.
 */
static void clip(vxm_ring *r, uint32_t i) {
  uint32_t a = r->tri->before[i], c = r->tri->after[i];
  cut(r, i);
  while (r->remaining > 3 && !r->is_convex) {
    if (is_spike(r, a)) {
      i = a;
      a = r->tri->before[a];
    } else if (is_spike(r, c)) {
      i = c;
      c = r->tri->after[c];
    } else
      break;
    cut(r, i);
  }
  enqueue(r, a);
  enqueue(r, c);
}

/**
 * Cuts off all ears. One that is not free does not become so by cutting off others: only when a neighbour has
 * been cut off is it tried again. So each corner is tried some three times.
 */
static void clip_ears(vxm_ring *r) {
  while (r->waiting > 0 && r->remaining > 3 && r->looks < r->looks_max) {
    uint32_t i = r->tri->heap[0];
    vxm_ear e = vxm_ear_at(r, i);
    take_out(r, i);
    if (r->is_convex || r->tri->cuts[i] == (double)INFINITY || vxm_ear_is_free(r, &e))
      clip(r, i);
  }
}

static void enqueue_all(vxm_ring *r, uint32_t start) {
  uint32_t i = start;
  r->looks += 8 * r->remaining;
  do
    enqueue(r, i);
  while ((i = r->tri->after[i]) != start);
}

/** The first corner from one on that is left. */
static uint32_t first_left(const vxm_ring *r, uint32_t i) {
  while (r->tri->after[i] == VXM_RING_CLIPPED)
    i++;
  return i;
}

/** The corner that turns left over the least area, where a polygon that crosses itself suffers least; if none
 * does, the one that turns right over the least. */
static uint32_t least_corner(vxm_ring *r, uint32_t start) {
  double least = INFINITY;
  uint32_t found = start, i = start;
  bool turns_left = false;
  do {
    vxm_ear e = vxm_ear_at(r, i);
    double area = (e.at[1][0] - e.at[0][0]) * (e.at[2][1] - e.at[1][1]) -
                  (e.at[1][1] - e.at[0][1]) * (e.at[2][0] - e.at[1][0]);
    bool left = area > 0;
    if (left > turns_left || (left == turns_left && fabs(area) < least)) {
      turns_left = left;
      least = fabs(area);
      found = i;
    }
    r->looks++;
  } while ((i = r->tri->after[i]) != start);
  return found;
}

/** Cuts a corner off where there is no ear, as happens only where a polygon crosses itself; from the first
 * one on, work is limited. */
static void clip_crossed(vxm_ring *r, uint32_t start) {
  if (r->looks_max == SIZE_MAX) {
    r->looks_crossed = r->looks;
    r->looks_max = r->looks + 64 * r->n + r->tri->looks_left;
  }
  clip(r, least_corner(r, start));
}

/** Covers what lies between corners first..last of a list and the line from the last to the first: a triangle
 * over the corner in the middle, and what its two sides leave. So most are as small as edges are short. */
static void halve(vxm_ring *r, const uint32_t *left, size_t first, size_t last) {
  size_t middle = first + (last - first) / 2;
  if (middle == first)
    return;
  halve(r, left, first, middle);
  put(r, left[first], left[middle], left[last]);
  halve(r, left, middle, last);
}

/** Triangles of all corners left. */
static void cover_rest(vxm_ring *r, uint32_t first) {
  uint32_t *left = r->tri->heap, i = first; /* nothing waits any more */
  size_t count = 0;
  do
    left[count++] = i;
  while ((i = r->tri->after[i]) != first);
  halve(r, left, 0, count - 1);
}

/** Spikes; ears that nothing touches; then others, and corners in line; then, if a polygon that crosses
 * itself has no more, what does the least harm, and so on; and whatever covers the rest. */
static void clip_all(vxm_ring *r) {
  for (size_t i = 0; i < r->n && r->remaining > 3 && !r->is_convex; i++)
    if (r->tri->after[i] != VXM_RING_CLIPPED && is_spike(r, (uint32_t)i))
      clip(r, (uint32_t)i);
  uint32_t left = first_left(r, 0);
  enqueue_all(r, left);
  clip_ears(r);
  r->may_touch = true;
  while (r->remaining > 3 && r->looks < r->looks_max) {
    left = first_left(r, left);
    enqueue_all(r, left);
    clip_ears(r);
    left = first_left(r, left);
    if (r->remaining > 3)
      clip_crossed(r, left);
  }
  cover_rest(r, first_left(r, left));
}

/** Triangles from one corner to all edges. */
static void fan(vxm_triangulator *tri, const uint32_t *corners, size_t n, size_t apex) {
  for (size_t i = 1; i + 1 < n; i++)
    memcpy(tri->triangles + 3 * (i - 1),
           (uint32_t[]){corners[apex], corners[(apex + i) % n], corners[(apex + i + 1) % n]},
           3 * sizeof *corners);
}

vxm_status vxm_triangulate(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n,
                           const uint32_t **triangles, vxm_error *error) {
  vxm_status status = reserve(tri, n, error);
  if (status != VXM_OK)
    return status;
  *triangles = tri->triangles;
  double scale = n > 4 ? scale_of(positions, corners, n) : 0;
  if (scale == 0) {
    fan(tri, corners, n, vxm_polygon_apex(positions, corners, n));
    return VXM_OK;
  }
  project(tri, positions, corners, n, scale);
  vxm_ring r = {.tri = tri,
                .corners = corners,
                .positions = positions,
                .scale = scale,
                .n = n,
                .remaining = n,
                .is_convex = is_convex((const double(*)[2])tri->plane, n),
                .looks_max = SIZE_MAX,
                .triangle = tri->triangles};
  memset(tri->waits, 0xff, n * sizeof *tri->waits);
  for (size_t i = 0; i < n; i++) {
    tri->before[i] = (uint32_t)(i > 0 ? i - 1 : n - 1);
    tri->after[i] = (uint32_t)(i + 1 < n ? i + 1 : 0);
  }
  if (n > ALONE && !r.is_convex)
    vxm_ring_make_tree(&r);
  clip_all(&r);
  tri->looks += r.looks;
  if (r.looks_max < SIZE_MAX) {
    size_t used = r.looks - r.looks_crossed;
    tri->looks_left -= used < tri->looks_left ? used : tri->looks_left;
  }
  return VXM_OK;
}
