/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/ear_clipping.h"
#include "mesh/orient2d.h"

#include <math.h>
#include <string.h>

/* ---- A tree of corners ---- */

static void make_leaf(const vxm_ring *r, size_t leaf) {
  const vxm_triangulator *tri = r->tri;
  size_t node = r->leaves + leaf, begin = leaf * VXM_SPATIAL_SORT_LEAF, end = begin + VXM_SPATIAL_SORT_LEAF;
  double(*box)[2] = tri->boxes[node];
  tri->counts[node] = 0;
  for (size_t s = begin; s < end && s < r->n; s++) {
    const double *p = tri->plane[tri->points[s].index];
    tri->places[tri->points[s].index] = (uint32_t)s;
    for (int c = 0; c < 2; c++) {
      box[0][c] = s == begin ? p[c] : fmin(box[0][c], p[c]);
      box[1][c] = s == begin ? p[c] : fmax(box[1][c], p[c]);
    }
    tri->counts[node]++;
  }
}

void vxm_ring_make_tree(vxm_ring *r) {
  vxm_triangulator *tri = r->tri;
  for (size_t i = 0; i < r->n; i++)
    tri->points[i] = (vxm_spatial_point){{(float)tri->plane[i][0], (float)tri->plane[i][1], 0}, (uint32_t)i};
  (void)vxm_spatial_sort(tri->points, r->n, NULL, NULL); /* as it cannot be cancelled */
  for (r->leaves = 1; r->leaves * VXM_SPATIAL_SORT_LEAF < r->n;)
    r->leaves *= 2;
  for (size_t leaf = 0; leaf < r->leaves; leaf++)
    make_leaf(r, leaf);
  for (size_t node = r->leaves; --node > 0;) {
    double(*box)[2] = tri->boxes[node], (*left)[2] = tri->boxes[2 * node],
    (*right)[2] = tri->boxes[2 * node + 1];
    tri->counts[node] = tri->counts[2 * node] + tri->counts[2 * node + 1];
    memcpy(box, left, sizeof *tri->boxes);
    for (int c = 0; c < 2 && tri->counts[2 * node + 1]; c++) {
      box[0][c] = fmin(box[0][c], right[0][c]);
      box[1][c] = fmax(box[1][c], right[1][c]);
    }
  }
}

void vxm_ring_drop(const vxm_ring *r, uint32_t i) {
  if (r->leaves)
    for (size_t node = r->leaves + r->tri->places[i] / VXM_SPATIAL_SORT_LEAF; node > 0; node /= 2)
      r->tri->counts[node]--;
}

/* ---- Ears ---- */

vxm_ear vxm_ear_at(const vxm_ring *r, uint32_t i) {
  vxm_ear e = {.corner = {r->tri->before[i], i, r->tri->after[i]}};
  for (int k = 0; k < 3; k++)
    e.at[k] = r->tri->plane[e.corner[k]];
  for (int c = 0; c < 2; c++) {
    e.low[c] = fmin(e.at[0][c], fmin(e.at[1][c], e.at[2][c]));
    e.high[c] = fmax(e.at[0][c], fmax(e.at[1][c], e.at[2][c]));
  }
  return e;
}

/** Whether the way from a place on the rim of an ear to another one leads inside; `side` is 0 for the sides
 * on which the place lies. */
static bool leads_inside(const vxm_ear *e, const int side[3], const double *to) {
  for (int s = 0; s < 3; s++)
    if (side[s] == 0 && vxm_orient2d(e->at[s], e->at[(s + 1) % 3], to) <= 0)
      return false;
  return true;
}

/** Whether two points lie the same way from a third. */
static bool is_same_way(const double *from, const double *a, const double *b) {
  for (int c = 0; c < 2; c++)
    if ((a[c] > from[c] && b[c] <= from[c]) || (a[c] < from[c] && b[c] >= from[c]))
      return false;
  return vxm_orient2d(from, a, b) == 0;
}

/** Whether a corner of the ring forbids to cut off an ear: it lies in it, or an edge leads from it inside. */
static bool forbids(vxm_ring *r, const vxm_ear *e, uint32_t k) {
  r->looks++;
  if (k == e->corner[0] || k == e->corner[1] || k == e->corner[2])
    return false;
  const vxm_triangulator *tri = r->tri;
  int side[3], sides = 0;
  for (int s = 0; s < 3; s++) {
    side[s] = vxm_orient2d(e->at[s], e->at[(s + 1) % 3], tri->plane[k]);
    if (side[s] < 0)
      return false;
    sides += side[s] == 0;
  }
  if (sides == 0 || (sides == 1 && !r->may_touch))
    return true;
  const double *before = tri->plane[tri->before[k]], *after = tri->plane[tri->after[k]];
  if (side[0] == 0 && side[1] == 0 && is_same_way(e->at[1], e->at[0], after) &&
      is_same_way(e->at[1], e->at[2], before))
    return true; /* both sides there and back: nothing tells on which side of them the inside is */
  return leads_inside(e, side, before) || leads_inside(e, side, after);
}

/** Whether a box lies beside an ear: beyond one of its sides, or of the sides of its own box. */
static bool is_beside(const vxm_ear *e, double (*box)[2]) {
  for (int c = 0; c < 2; c++)
    if (box[0][c] > e->high[c] || box[1][c] < e->low[c])
      return true;
  for (int s = 0; s < 3; s++) {
    const double *p = e->at[s], *q = e->at[(s + 1) % 3];
    const double leftmost[2] = {box[q[1] <= p[1]][0], box[q[0] >= p[0]][1]};
    if (vxm_orient2d(p, q, leftmost) < 0)
      return true;
  }
  return false;
}

/** Whether no corner of the ring that is in a node forbids to cut off an ear. */
static bool is_free_in(vxm_ring *r, const vxm_ear *e, size_t node) {
  const vxm_triangulator *tri = r->tri;
  r->looks++;
  if (tri->counts[node] == 0 || is_beside(e, tri->boxes[node]))
    return true;
  if (node < r->leaves)
    return is_free_in(r, e, 2 * node) && is_free_in(r, e, 2 * node + 1);
  size_t begin = (node - r->leaves) * VXM_SPATIAL_SORT_LEAF, end = begin + VXM_SPATIAL_SORT_LEAF;
  for (size_t s = begin; s < end && s < r->n; s++)
    if (tri->after[tri->points[s].index] != VXM_RING_CLIPPED && forbids(r, e, tri->points[s].index))
      return false;
  return true;
}

bool vxm_ear_is_free(vxm_ring *r, const vxm_ear *e) {
  if (r->leaves)
    return is_free_in(r, e, 1);
  for (uint32_t k = r->tri->after[e->corner[2]]; k != e->corner[0]; k = r->tri->after[k])
    if (forbids(r, e, k))
      return false;
  return true;
}
