/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/tetra.h"
#include "base/threads.h"

#include <string.h>

/** The inner side of a face of a tetrahedron: normal . (p - origin) >= threshold. */
typedef struct half_space {
  vxm_point origin;
  vxm_int128 normal[3];
  int threshold; /**< 0 if centres on the plane are inside by the perturbation, else 1 */
} half_space;

static vxm_int128 along(const vxm_int128 normal[3], const vxm_point *origin, const vxm_point *p) {
  vxm_int128 sum = 0;
  for (int a = 0; a < 3; a++)
    sum += normal[a] * (p->at[a] - origin->at[a]);
  return sum;
}

/** The side of plane pqr on which s lies; false if s lies on it. */
static bool inner_side(half_space *out, const vxm_point *p, const vxm_point *q, const vxm_point *r,
                       const vxm_point *s) {
  out->origin = *p;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    out->normal[a] = (vxm_int128)(q->at[b] - p->at[b]) * (r->at[c] - p->at[c]) -
                     (vxm_int128)(q->at[c] - p->at[c]) * (r->at[b] - p->at[b]);
  }
  vxm_int128 side = along(out->normal, p, s);
  if (side == 0)
    return false;
  int first = 0; /* sign of the first component that is not 0 */
  for (int a = 0; a < 3; a++) {
    if (side < 0)
      out->normal[a] = -out->normal[a];
    if (first == 0 && out->normal[a] != 0)
      first = out->normal[a] > 0 ? 1 : -1;
  }
  out->threshold = first > 0 ? 0 : 1;
  return true;
}

static vxm_int128 floor_div(vxm_int128 a, vxm_int128 b) {
  vxm_int128 q = a / b;
  return q - (a % b < 0);
}

/** Narrows [*low, *high], lattice positions along an axis, to the half-space, for the line through p.
 */
static bool clip(const half_space *h, const vxm_point *line, int axis, int64_t *low, int64_t *high) {
  vxm_point p = *line;
  p.at[axis] = h->origin.at[axis];
  vxm_int128 excess = along(h->normal, &h->origin, &p) - h->threshold; /* normal (x - origin) + excess >= 0 */
  vxm_int128 n = h->normal[axis];
  if (n == 0)
    return excess >= 0;
  if (n > 0) {
    vxm_int128 x = h->origin.at[axis] - floor_div(excess, n);
    if (x > *low)
      *low = x > *high ? *high + 1 : (int64_t)x;
  } else {
    vxm_int128 x = h->origin.at[axis] + floor_div(excess, -n);
    if (x < *high)
      *high = x < *low ? *low - 1 : (int64_t)x;
  }
  return *low <= *high;
}

/** Flips voxels begin..end-1 of a row, cut to its `length`. */
static void flip_span(uint64_t *row, int64_t begin, int64_t end, int64_t length) {
  begin = vxm_max(begin, 0);
  end = vxm_min(end, length);
  if (begin >= end)
    return;
  size_t first = (size_t)begin, last = (size_t)end - 1;
  for (size_t w = first / 64; w <= last / 64; w++) {
    uint64_t mask = ~UINT64_C(0);
    if (w == first / 64)
      mask &= ~UINT64_C(0) << (first % 64);
    if (w == last / 64)
      mask &= vxm_low_bits((unsigned)(last % 64) + 1);
    row[w] ^= mask;
  }
}

typedef struct tetra_state {
  vxm_workspace *workspace;
  const vxm_window *window;
  const vxm_parity_union_job *job;
  vxm_slabs slabs;
  vxm_task_progress progress;
} tetra_state;

/** Voxels first..end-1 whose centres may lie between the corners along an axis. */
static void range_of(const tetra_state *state, const vxm_point corner[4], int axis, int64_t *first,
                     int64_t *end) {
  int64_t low = corner[0].at[axis], high = low;
  for (int c = 1; c < 4; c++) {
    low = vxm_min(low, corner[c].at[axis]);
    high = vxm_max(high, corner[c].at[axis]);
  }
  const vxm_lattice *lattice = &state->job->placed->lattice;
  *first = vxm_max(*first, vxm_lattice_first(lattice, low));
  *end = vxm_min(*end, vxm_lattice_last(lattice, high) + 1);
}

/** Flips in slices begin..end-1, whose words start at `words`. Whether the tetrahedron reaches them. */
static bool draw_tetrahedron(const tetra_state *state, size_t triangle, int64_t begin, int64_t end,
                             uint64_t *words) {
  const vxm_triangle_set *triangles = state->job->triangles;
  const vxm_snapped_points *placed = state->job->placed;
  const vxm_window *window = state->window;
  const vxm_layout *axes = &window->layout;
  vxm_point corner[4];
  for (int k = 0; k < 3; k++)
    corner[k] = vxm_snapped_points_at(placed, triangles->corners[triangle][k]);
  corner[3] = vxm_snapped_points_at(placed, vxm_apex_of(triangles, triangles->part[triangle]));
  int64_t s_begin = begin, s_end = end, m_begin = 0, m_end = window->middle_dim;
  range_of(state, corner, axes->slow, &s_begin, &s_end);
  range_of(state, corner, axes->middle, &m_begin, &m_end);
  if (s_begin >= s_end || m_begin >= m_end)
    return false;
  half_space face[4];
  for (int f = 0; f < 4; f++)
    if (!inner_side(&face[f], &corner[(f + 1) % 4], &corner[(f + 2) % 4], &corner[(f + 3) % 4], &corner[f]))
      return false; /* no volume, so no (perturbed) centre inside */
  const vxm_lattice *lattice = &placed->lattice;
  for (int64_t s = s_begin; s < s_end; s++)
    for (int64_t m = m_begin; m < m_end; m++) {
      vxm_point line = {{0, 0, 0}};
      line.at[axes->middle] = vxm_lattice_centre(lattice, m);
      line.at[axes->slow] = vxm_lattice_centre(lattice, s);
      int64_t low = INT64_MAX, high = INT64_MIN;
      for (int c = 0; c < 4; c++) {
        low = vxm_min(low, corner[c].at[axes->fast]);
        high = vxm_max(high, corner[c].at[axes->fast]);
      }
      bool inside = true;
      for (int f = 0; f < 4 && inside; f++)
        inside = clip(&face[f], &line, axes->fast, &low, &high);
      if (inside)
        flip_span(words + (size_t)(s - begin) * window->slice_words + (size_t)m * window->row_words,
                  vxm_lattice_first(lattice, low), vxm_lattice_last(lattice, high) + 1, window->fast_dim);
    }
  return true;
}

enum { ASK_TRIANGLES = 1024 /**< between two questions whether to go on, where none reaches the slab */ };

static void do_slab(size_t task, int worker, void *payload) {
  tetra_state *state = payload;
  const vxm_window *window = state->window;
  const vxm_triangle_set *triangles = state->job->triangles;
  if (vxm_task_progress_stopped(&state->progress, worker))
    return;
  int64_t first = (int64_t)task << state->slabs.shift;
  int64_t begin = window->begin + first,
          end = vxm_min(begin + (INT64_C(1) << state->slabs.shift), window->end);
  uint64_t *out = window->words + (size_t)first * window->slice_words;
  uint64_t *work = state->workspace->scratch + (size_t)worker * state->slabs.words;
  size_t count = (size_t)(end - begin) * window->slice_words;
  if (state->job->fresh)
    memset(out, 0, count * sizeof *out);
  for (size_t p = state->job->part_begin; p < state->job->part_end; p++) {
    bool drawn = false;
    for (size_t f = triangles->parts[p].begin; f < triangles->parts[p].caps; f++) {
      bool reaches = draw_tetrahedron(state, f, begin, end, work);
      drawn |= reaches;
      if ((reaches || f % ASK_TRIANGLES == 0) && vxm_task_progress_stopped(&state->progress, worker)) {
        memset(work, 0, count * sizeof *work); /* as whoever comes next expects it */
        return;
      }
    }
    if (drawn && vxm_kernels_get()->move_or(out, work, count) && state->job->has_voxels)
      atomic_store_explicit(&state->job->has_voxels[p], 1, memory_order_relaxed);
  }
  vxm_task_progress_step(&state->progress);
}

vxm_status vxm_tetra_unite(vxm_workspace *workspace, const vxm_window *window,
                           const vxm_parity_union_job *job, vxm_error *error) {
  int threads = vxm_context_threads(workspace->context);
  tetra_state state = {.workspace = workspace, .window = window, .job = job};
  state.slabs = vxm_slabs_of(window->end - window->begin, window->slice_words, threads);
  vxm_status status = vxm_workspace_scratch(workspace, (size_t)threads * state.slabs.words, error);
  if (status != VXM_OK)
    return status;
  vxm_task_progress_start(&state.progress, workspace->context, job->phase, state.slabs.count, error);
  vxm_parallel(workspace->context, state.slabs.count, do_slab, &state);
  return vxm_task_progress_end(&state.progress);
}
