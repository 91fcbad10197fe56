/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The three ways in which Schwarz and Seidel 2010, section 3.2, go through a triangle's voxels: all of its
 * box; by specializations for boxes of one and two dimensions and for the dominant axis of the normal; and
 * these with the triangles sorted, so that neighbours take the same way. In the paper sorting serves threads
 * that run in lockstep.
 */
#include "experimental/touch.h"

#include <stdlib.h>

typedef struct work {
  const vxm_baseline_job *job;
  vxm_touch touch; /**< the present triangle */
  int64_t first[3], end[3];
  bool thin;
} work;

/** Clips the box to the grid; false if nothing is left. */
static bool clip(work *w) {
  bool some = true;
  for (int a = 0; a < 3; a++) {
    w->first[a] = vxm_max(w->touch.first[a], 0);
    w->end[a] = vxm_min(w->touch.end[a], w->job->grid->space.dims[a]);
    some &= w->first[a] < w->end[a];
  }
  return some;
}

/* ---- All voxels of the box ---- */

static void draw_simple(work *w) {
  for (int64_t k = w->first[2]; k < w->end[2]; k++)
    for (int64_t j = w->first[1]; j < w->end[1]; j++)
      for (int64_t i = w->first[0]; i < w->end[0]; i++) {
        const int64_t voxel[3] = {i, j, k};
        bool meets = vxm_touch_plane(&w->touch, voxel);
        for (int axis = 0; axis < 3 && meets; axis++)
          meets = vxm_touch_seen(&w->touch, voxel, axis);
        w->job->report->tests++;
        if (meets)
          vxm_baseline_set(w->job->grid, voxel);
      }
}

/* ---- Specializations ---- */

/** A box longer than a voxel along one axis at most: the triangle runs through all of it. */
static void draw_line(const work *w) {
  for (int64_t k = w->first[2]; k < w->end[2]; k++)
    for (int64_t j = w->first[1]; j < w->end[1]; j++)
      for (int64_t i = w->first[0]; i < w->end[0]; i++)
        vxm_baseline_set(w->job->grid, (const int64_t[]){i, j, k});
}

/** A box one voxel thick: a projection tells. */
static void draw_sheet(const work *w) {
  int thin = 0;
  while (w->touch.end[thin] - w->touch.first[thin] > 1)
    thin++;
  int u = (thin + 1) % 3, v = (thin + 2) % 3;
  int64_t voxel[3];
  voxel[thin] = w->first[thin];
  for (voxel[v] = w->first[v]; voxel[v] < w->end[v]; voxel[v]++)
    for (voxel[u] = w->first[u]; voxel[u] < w->end[u]; voxel[u]++) {
      w->job->report->tests++;
      if (vxm_touch_seen(&w->touch, voxel, thin))
        vxm_baseline_set(w->job->grid, voxel);
    }
}

/** The voxels of a column along the dominant axis that the plane meets; one alone needs no further test, but
 * for the thin surface. */
static void draw_depths(const work *w, int64_t voxel[3]) {
  int axis = w->touch.dominant, u = (axis + 1) % 3, v = (axis + 2) % 3;
  int64_t first, last;
  vxm_touch_depths(&w->touch, voxel, &first, &last);
  bool alone = first == last && !w->thin;
  last = vxm_min(last, w->end[axis] - 1);
  for (voxel[axis] = vxm_max(first, w->first[axis]); voxel[axis] <= last; voxel[axis]++) {
    w->job->report->tests += !alone;
    if (alone || (vxm_touch_seen(&w->touch, voxel, u) && vxm_touch_seen(&w->touch, voxel, v)))
      vxm_baseline_set(w->job->grid, voxel);
  }
}

static void draw_body(const work *w) {
  int axis = w->touch.dominant, u = (axis + 1) % 3, v = (axis + 2) % 3;
  int64_t voxel[3];
  for (voxel[v] = w->first[v]; voxel[v] < w->end[v]; voxel[v]++)
    for (voxel[u] = w->first[u]; voxel[u] < w->end[u]; voxel[u]++) {
      voxel[axis] = w->first[axis];
      w->job->report->tests++;
      if (vxm_touch_seen(&w->touch, voxel, axis))
        draw_depths(w, voxel);
    }
}

/** A triangle without area has no dominant axis. */
static bool has_area(const vxm_touch *touch) {
  return touch->normal[touch->dominant] != 0;
}

/** Thin boxes, too, need the plane for the thin surface (section 3.4). */
static void draw_special(work *w) {
  int extent = vxm_touch_extent(&w->touch);
  if (!has_area(&w->touch))
    draw_simple(w);
  else if (w->thin || extent == 3)
    draw_body(w);
  else if (extent == 2)
    draw_sheet(w);
  else
    draw_line(w);
}

/* ---- Triangles ---- */

static void take(work *w, size_t triangle) {
  vxm_point p[3];
  vxm_baseline_triangle(p, w->job, triangle);
  vxm_touch_make(&w->touch, &w->job->surface->lattice, p, w->thin);
}

static void count(const work *w) {
  int extent = vxm_touch_extent(&w->touch);
  w->job->report->boxes[extent < 1 ? 0 : extent - 1]++;
}

static int compare(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/** The case of a triangle: what its box is, along which axis, and how many columns it has; then its number.
 */
static uint64_t key_of(const work *w, size_t triangle) {
  const uint64_t most = (UINT64_C(1) << 27) - 1;
  int axis = w->touch.dominant, u = (axis + 1) % 3, v = (axis + 2) % 3;
  int64_t columns = (w->touch.end[u] - w->touch.first[u]) * (w->touch.end[v] - w->touch.first[v]);
  uint64_t size = (uint64_t)columns < most ? (uint64_t)columns : most;
  return (uint64_t)vxm_touch_extent(&w->touch) << 62 | (uint64_t)axis << 60 | size << 33 | triangle;
}

static vxm_status sort(uint64_t **out, work *w, vxm_error *error) {
  size_t triangles = w->job->surface->triangle_count;
  uint64_t *keys = vxm_baseline_block(w->job, triangles, sizeof *keys, error);
  if (!keys)
    return error->code;
  for (size_t t = 0; t < triangles; t++) {
    take(w, t);
    keys[t] = key_of(w, t);
  }
  qsort(keys, triangles, sizeof *keys, compare);
  *out = keys;
  return VXM_OK;
}

vxm_status vxm_baseline_boxes(const vxm_baseline_job *job, vxm_error *error) {
  const uint64_t numbers = (UINT64_C(1) << 33) - 1;
  work w = {.job = job, .thin = job->options->thin};
  uint64_t *keys = NULL;
  double start = vxm_clock_ms();
  vxm_status status = VXM_OK;
  if (job->options->method == VXM_BASELINE_SORTED)
    status = sort(&keys, &w, error);
  job->report->setup_ms = vxm_clock_ms() - start;
  for (size_t t = 0; t < job->surface->triangle_count && status == VXM_OK; t++) {
    take(&w, keys ? (size_t)(keys[t] & numbers) : t);
    count(&w);
    if (clip(&w)) {
      if (job->options->method == VXM_BASELINE_SIMPLE)
        draw_simple(&w);
      else
        draw_special(&w);
    }
    status = vxm_check_cancelled_at(t, job->context, error);
  }
  vxm_free(job->context, keys);
  return status;
}
