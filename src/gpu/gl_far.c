/* SPDX-License-Identifier: BSD-3-Clause */
/** Facets that reach so far that products of their differences do not fit the 64 bits of the shaders: the CPU
 * tells what they flip, with the rules of shaders/crossing.glsl in 128 bits. There are few, in odd meshes. */
#include "gpu/opengl.h"

typedef struct triangle {
  int64_t a[3], b[3], c[3]; /**< along u, v, w; b and c as differences to a, running around to the left */
  vxm_int128 nw;
} triangle;

static bool load(triangle *t, const vxm_placed *placed, const uint32_t corners[3], const int32_t axes[3]) {
  vxm_point p[3];
  for (int c = 0; c < 3; c++)
    p[c] = vxm_placed_at(placed, corners[c]);
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

static int64_t crossing(const triangle *t, const int64_t p[2], const vxm_gl_job *tile) {
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

static vxm_status put(flips *out, const triangle *t, const vxm_gl_job *tile, int64_t u, int64_t v,
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

static vxm_status put_facet(flips *out, const triangle *t, const vxm_lattice *lattice, const vxm_gl_job *tile,
                            vxm_error *error) {
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

vxm_status vxm_gl_far_flips(uint32_t **out, size_t *count, const vxm_opengl *engine, const vxm_gl_job *tile,
                            const vxm_unite_job *job, const vxm_gl_passes *passes, size_t pass,
                            vxm_error *error) {
  flips found = {.context = engine->base.context};
  const vxm_facets *facets = job->facets;
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < engine->far_count && status == VXM_OK; i++) {
    size_t f = engine->far[i], part = facets->part[f];
    triangle t;
    if (part < job->part_begin || part >= job->part_end ||
        passes->pass_of[part - passes->part_begin] != pass || !(vxm_role_of(facets, f) & job->roles))
      continue;
    if (load(&t, job->placed, facets->corners[f], tile->axes))
      status = put_facet(&found, &t, &job->placed->lattice, tile, error);
  }
  if (status != VXM_OK) {
    vxm_free(found.context, found.bit);
    found = (flips){0};
  }
  *out = found.bit;
  *count = found.count;
  return status;
}
