/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/oversized_triangles.h"

/* ---- Which are far ---- */

/** Differences of triangles that the shaders do: shaders/crossing.glsl, shaders/lattice.cl. */
static const int64_t reach = INT64_C(1) << 20;

static bool is_far_point(const vxm_point *p) {
  for (int a = 0; a < 3; a++)
    if (p->at[a] >= VXM_NARROW_MAX || p->at[a] <= -VXM_NARROW_MAX)
      return true;
  return false;
}

static bool is_far(const vxm_point *a, const vxm_point *b, const vxm_point *c) {
  if (is_far_point(a) || is_far_point(b) || is_far_point(c))
    return true;
  for (int i = 0; i < 3; i++) {
    int64_t low = vxm_min(vxm_min(a->at[i], b->at[i]), c->at[i]);
    int64_t high = vxm_max(vxm_max(a->at[i], b->at[i]), c->at[i]);
    if (high - low > reach)
      return true;
  }
  return false;
}

/** Whether all points lie so close together that no facet can be far. */
static bool are_all_near(const vxm_snapped_points *placed, size_t count) {
  int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
  if (placed->wide)
    return false;
  for (size_t p = 0; p < count; p++)
    for (int a = 0; a < 3; a++) {
      int32_t at = placed->narrow[p][a];
      low[a] = at < low[a] ? at : low[a];
      high[a] = at > high[a] ? at : high[a];
    }
  for (int a = 0; a < 3; a++)
    if ((int64_t)high[a] - low[a] > reach)
      return false;
  return true;
}

vxm_status vxm_oversized_find(vxm_oversized *far, const vxm_triangle_set *facets,
                              const vxm_snapped_points *placed, vxm_error *error) {
  far->count = 0;
  if (are_all_near(placed, facets->point_count))
    return VXM_OK;
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < facets->facet_count && status == VXM_OK; f++) {
    vxm_point p[3];
    for (int c = 0; c < 3; c++)
      p[c] = vxm_snapped_points_at(placed, facets->corners[f][c]);
    if (!is_far(&p[0], &p[1], &p[2]))
      continue;
    status = vxm_grow(far->context, (void **)&far->facets, &far->capacity, far->count + 1,
                      sizeof *far->facets, error);
    if (status == VXM_OK)
      far->facets[far->count++] = (uint32_t)f;
  }
  return status;
}

vxm_status vxm_oversized_surface_find(vxm_oversized_surface *far, const vxm_surface *surface,
                                      vxm_error *error) {
  vxm_status status = VXM_OK;
  far->count = 0;
  for (size_t t = 0; t < surface->triangle_count && status == VXM_OK; t++) {
    const uint32_t *corner = surface->corners + 3 * t;
    if (!is_far(&surface->points[corner[0]], &surface->points[corner[1]], &surface->points[corner[2]]))
      continue;
    status = vxm_grow(far->context, (void **)&far->corners, &far->capacity, far->count + 1,
                      sizeof *far->corners, error);
    for (int c = 0; c < 3 && status == VXM_OK; c++)
      far->corners[far->count][c] = corner[c];
    far->count += status == VXM_OK;
  }
  return status;
}

void vxm_oversized_destroy(vxm_oversized *far) {
  vxm_free(far->context, far->facets);
}

void vxm_oversized_surface_destroy(vxm_oversized_surface *far) {
  vxm_free(far->context, far->corners);
}

void vxm_oversized_narrow(int32_t (*out)[4], const vxm_point *points, size_t count) {
  for (size_t p = 0; p < count; p++) {
    out[p][3] = is_far_point(&points[p]);
    for (int a = 0; a < 3; a++)
      out[p][a] = out[p][3] ? 0 : (int32_t)points[p].at[a];
  }
}

vxm_status vxm_oversized_surface_add(const vxm_oversized_surface *far, const vxm_surface *surface,
                                     const vxm_window *window, vxm_surface_kind kind, vxm_error *error) {
  if (far->count == 0)
    return VXM_OK;
  vxm_surface some = *surface;
  some.corners = far->corners[0];
  some.triangle_count = far->count;
  return vxm_surface_add(&some, window, kind, false, error);
}

/* ---- What they flip, with the rules of shaders/crossing.glsl ---- */

typedef struct triangle {
  int64_t a[3], b[3], c[3]; /**< along u, v, w; b and c as differences to a, running around to the left */
  vxm_int128 nw;
} triangle;

static bool load(triangle *t, const vxm_snapped_points *placed, const uint32_t corners[3],
                 const int32_t axes[3]) {
  vxm_point p[3];
  for (int c = 0; c < 3; c++)
    p[c] = vxm_snapped_points_at(placed, corners[c]);
  for (int i = 0; i < 3; i++) {
    t->a[i] = p[0].at[axes[i]];
    t->b[i] = p[1].at[axes[i]] - t->a[i];
    t->c[i] = p[2].at[axes[i]] - t->a[i];
  }
  t->nw = (vxm_int128)t->b[0] * t->c[1] - (vxm_int128)t->b[1] * t->c[0];
  for (int i = 0; i < 3 && t->nw < 0; i++) {
    int64_t swap = t->b[i];
    t->b[i] = t->c[i];
    t->c[i] = swap;
  }
  t->nw = t->nw < 0 ? -t->nw : t->nw;
  return t->nw != 0;
}

static bool is_left(const int64_t from[2], const int64_t to[2], const int64_t p[2], bool u_first) {
  int64_t du = to[0] - from[0], dv = to[1] - from[1];
  vxm_int128 value = (vxm_int128)du * (p[1] - from[1]) - (vxm_int128)dv * (p[0] - from[0]);
  bool on = u_first ? (dv != 0 ? dv < 0 : du > 0) : (du != 0 ? du > 0 : dv < 0);
  return value > 0 || (value == 0 && on);
}

static int64_t crossing(const triangle *t, const int64_t p[2], const vxm_slice_job_columns *tile) {
  vxm_int128 normal[3], nu = (vxm_int128)t->b[1] * t->c[2] - (vxm_int128)t->b[2] * t->c[1],
                        nv = (vxm_int128)t->b[2] * t->c[0] - (vxm_int128)t->b[0] * t->c[2];
  normal[tile->axes[0]] = nu;
  normal[tile->axes[1]] = nv;
  normal[tile->axes[2]] = t->nw;
  bool on_is_beyond = (normal[0] != 0 ? normal[0] : normal[1] != 0 ? normal[1] : normal[2]) > 0;
  int64_t unit = INT64_C(1) << tile->bits, base = t->a[2] >> tile->bits;
  vxm_int128 step = t->nw * unit;
  vxm_int128 across = -nu * p[0] - nv * p[1] - t->nw * (unit / 2 - (t->a[2] - base * unit)) - on_is_beyond;
  vxm_int128 quotient = across / step;
  quotient -= quotient * step > across;
  return base + 1 + (int64_t)quotient;
}

typedef struct flips {
  vxm_context *context;
  uint32_t *bit;
  size_t count, capacity;
} flips;

static vxm_status put(flips *out, const triangle *t, const vxm_slice_job_columns *tile, int64_t u, int64_t v,
                      vxm_error *error) {
  static const int64_t origin[2] = {0, 0};
  int64_t unit = INT64_C(1) << tile->bits;
  const int64_t p[2] = {u * unit + unit / 2 - t->a[0], v * unit + unit / 2 - t->a[1]};
  bool u_first = tile->axes[0] < tile->axes[1];
  if (!is_left(origin, t->b, p, u_first) || !is_left(t->b, t->c, p, u_first) ||
      !is_left(t->c, origin, p, u_first))
    return VXM_OK;
  int64_t w = crossing(t, p, tile);
  if (w >= tile->last[2] || (w < tile->first[2] && !tile->keep_before))
    return VXM_OK;
  w = vxm_max(w, tile->first[2]);
  vxm_status status =
      vxm_grow(out->context, (void **)&out->bit, &out->capacity, out->count + 1, sizeof *out->bit, error);
  if (status == VXM_OK)
    out->bit[out->count++] = (uint32_t)(u - tile->first[0]) * tile->step[0] +
                             (uint32_t)(v - tile->first[1]) * tile->step[1] +
                             (uint32_t)(w - tile->first[2]) * tile->step[2];
  return status;
}

static vxm_status put_facet(flips *out, const triangle *t, const vxm_lattice *lattice,
                            const vxm_slice_job_columns *tile, vxm_error *error) {
  int64_t begin[2], end[2];
  for (int i = 0; i < 2; i++) {
    int64_t low = t->a[i] + vxm_min(0, vxm_min(t->b[i], t->c[i]));
    int64_t high = t->a[i] + vxm_max(0, vxm_max(t->b[i], t->c[i]));
    begin[i] = vxm_max(vxm_lattice_first(lattice, low), tile->first[i]);
    end[i] = vxm_min(vxm_lattice_first(lattice, high), tile->last[i]);
  }
  vxm_status status = VXM_OK;
  for (int64_t v = begin[1]; v < end[1] && status == VXM_OK; v++)
    for (int64_t u = begin[0]; u < end[0] && status == VXM_OK; u++)
      status = put(out, t, tile, u, v, error);
  return status;
}

vxm_status vxm_oversized_flips(uint32_t **out, size_t *count, const vxm_oversized *far,
                               const vxm_slice_job_columns *tile, const vxm_parity_union_job *job,
                               const vxm_disjoint_passes *passes, size_t pass, vxm_error *error) {
  flips found = {.context = far->context};
  const vxm_triangle_set *facets = job->facets;
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < far->count && status == VXM_OK; i++) {
    size_t f = far->facets[i], part = facets->part[f];
    triangle t;
    if (part < job->part_begin || part >= job->part_end ||
        passes->pass_of[part - passes->part_begin] != pass || !(vxm_role_of(facets, f) & job->roles))
      continue;
    if (load(&t, job->placed, facets->corners[f], tile->axes))
      status = put_facet(&found, &t, &job->placed->lattice, tile, error);
    if (status == VXM_OK) /* each may cover all columns */
      status = vxm_progress(far->context, job->phase, (double)pass / (double)passes->count, error);
  }
  if (status != VXM_OK) {
    vxm_free(found.context, found.bit);
    found = (flips){0};
  }
  *out = found.bit;
  *count = found.count;
  return status;
}
