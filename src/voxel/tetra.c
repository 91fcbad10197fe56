/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/tetra.h"

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

/** Narrows [*low, *high], lattice positions along x, to the half-space, for the row at (y, z). */
static bool clip(const half_space *h, int64_t y, int64_t z, int64_t *low, int64_t *high) {
  vxm_point p = {{h->origin.at[0], y, z}};
  vxm_int128 room = along(h->normal, &h->origin, &p) - h->threshold; /* normal_x (x - origin_x) + room >= 0 */
  vxm_int128 nx = h->normal[0];
  if (nx == 0)
    return room >= 0;
  if (nx > 0) {
    vxm_int128 x = h->origin.at[0] - floor_div(room, nx);
    if (x > *low)
      *low = x > *high ? *high + 1 : (int64_t)x;
  } else {
    vxm_int128 x = h->origin.at[0] + floor_div(room, -nx);
    if (x < *high)
      *high = x < *low ? *low - 1 : (int64_t)x;
  }
  return *low <= *high;
}

static void flip_span(const vxm_raster *raster, int64_t j, int64_t k, int64_t begin, int64_t end) {
  begin = vxm_max(begin, raster->box.w_begin);
  end = vxm_min(end, raster->box.w_end);
  if (begin >= end)
    return;
  uint64_t *row = raster->words + (size_t)(k - raster->box.v_begin) * raster->v_stride +
                  (size_t)(j - raster->box.u_begin) * raster->row_words;
  size_t first = (size_t)(begin - raster->x_first), last = (size_t)(end - 1 - raster->x_first);
  for (size_t w = first / 64; w <= last / 64; w++) {
    uint64_t mask = ~UINT64_C(0);
    if (w == first / 64)
      mask &= ~UINT64_C(0) << (first % 64);
    if (w == last / 64)
      mask &= vxm_low_bits((unsigned)(last % 64) + 1);
    row[w] ^= mask;
  }
}

static void draw_tetrahedron(const vxm_unite_job *job, const vxm_facet *facet, const vxm_raster *raster) {
  const vxm_facets *facets = job->facets;
  const vxm_point *corner[4] = {&facets->points[facet->corner[0]], &facets->points[facet->corner[1]],
                                &facets->points[facet->corner[2]],
                                &facets->points[facets->parts[facet->part].apex]};
  half_space face[4];
  for (int f = 0; f < 4; f++)
    if (!inner_side(&face[f], corner[(f + 1) % 4], corner[(f + 2) % 4], corner[(f + 3) % 4], corner[f]))
      return; /* no volume, so no (perturbed) centre inside */
  vxm_point low = *corner[0], high = low;
  for (int c = 1; c < 4; c++)
    for (int a = 0; a < 3; a++) {
      low.at[a] = vxm_min(low.at[a], corner[c]->at[a]);
      high.at[a] = vxm_max(high.at[a], corner[c]->at[a]);
    }
  const vxm_lattice *lattice = job->lattice;
  const vxm_box *box = &raster->box;
  int64_t k_begin = vxm_max(box->v_begin, vxm_lattice_first(lattice, low.at[2]));
  int64_t k_end = vxm_min(box->v_end, vxm_lattice_last(lattice, high.at[2]) + 1);
  int64_t j_begin = vxm_max(box->u_begin, vxm_lattice_first(lattice, low.at[1]));
  int64_t j_end = vxm_min(box->u_end, vxm_lattice_last(lattice, high.at[1]) + 1);
  for (int64_t k = k_begin; k < k_end; k++)
    for (int64_t j = j_begin; j < j_end; j++) {
      int64_t y = vxm_lattice_centre(lattice, j), z = vxm_lattice_centre(lattice, k);
      int64_t x_low = low.at[0], x_high = high.at[0];
      bool inside = true;
      for (int f = 0; f < 4 && inside; f++)
        inside = clip(&face[f], y, z, &x_low, &x_high);
      if (inside)
        flip_span(raster, j, k, vxm_lattice_first(lattice, x_low), vxm_lattice_last(lattice, x_high) + 1);
    }
}

static bool fold_presence(vxm_grid *grid, const vxm_raster *raster) {
  const vxm_box *box = &raster->box;
  uint64_t any = 0, *words = raster->words;
  for (int64_t k = box->v_begin; k < box->v_end; k++)
    for (int64_t j = box->u_begin; j < box->u_end; j++, words += raster->row_words) {
      uint64_t *row = vxm_grid_row(grid, j, k) + raster->x_first / 64;
      for (size_t w = 0; w < raster->row_words; w++) {
        row[w] |= words[w];
        any |= words[w];
        words[w] = 0;
      }
    }
  return any != 0;
}

vxm_status vxm_tetra_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_error *error) {
  vxm_unite_job tetra = *job;
  tetra.axes = vxm_axes_of(0);
  tetra.roles = VXM_FACET_TRIANGLE;
  tetra.to_apex = true;
  return vxm_unite(grid, &tetra, draw_tetrahedron, fold_presence, error);
}
