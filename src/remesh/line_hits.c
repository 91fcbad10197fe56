/* SPDX-License-Identifier: BSD-3-Clause */
#include "remesh/line_hits.h"
#include "base/hash.h"
#include "voxel/surface/surface.h"

#include <math.h>

/** Runs of so many voxels may be all there is of a plate. */
enum { SHORT_RUN = 3 };

/** Rows of a triangle after which it is asked whether to go on. */
enum { ASK_ROWS = 256 };

/** The solid is made of vertices on a lattice: faces may be off by that, in voxels, against the bits. */
static const double NEAR = 1.0 / 64;

/** Plates come out so thick at least, in voxels; a little more, for rounding and 32-bit files. */
static const double THINNEST = 2.0 / 3 + 1e-3;

/** No plate is looked for along a line that meets its faces at a lower sine. */
static const double LOWEST_SINE = 0.3;

/** A place on a line, counted from the centre of voxel 0, and the face that is there. */
typedef struct hit {
  float at;
  float sine;   /**< of the angle between line and face */
  uint8_t main; /**< the axis along which its normal is longest */
} hit;

/** The first and the last at a run, or at one end of a long one. */
typedef struct extent {
  uint64_t key; /**< 0: none */
  hit low, high;
} extent;

struct vxm_line_hits {
  vxm_context *context;
  const vxm_grid *solid;
  extent *table; /**< open addressing */
  size_t count, capacity;
};

/** A line of voxels along an axis. */
typedef struct line {
  int axis;
  int64_t at[3]; /**< of a voxel; at[axis] does not matter */
} line;

typedef struct run {
  int64_t first, last; /**< voxels */
  bool is_short;       /**< of a long one only the end that was asked for is right */
} run;

/* ---- Runs ---- */

static bool is_set(const vxm_grid *solid, const line *l, int64_t i) {
  int64_t at[3] = {l->at[0], l->at[1], l->at[2]};
  at[l->axis] = i;
  for (int a = 0; a < 3; a++)
    if (at[a] < 0 || at[a] >= solid->space.dims[a])
      return false;
  return vxm_grid_row(solid, at[1], at[2])[at[0] / 64] >> (at[0] % 64) & 1;
}

/** That of a set voxel; looks no further than tells whether it is short. */
static run run_of(const vxm_grid *solid, const line *l, int64_t voxel) {
  run r = {voxel, voxel, true};
  while (r.last - r.first < SHORT_RUN && is_set(solid, l, r.first - 1))
    r.first--;
  while (r.last - r.first < SHORT_RUN && is_set(solid, l, r.last + 1))
    r.last++;
  r.is_short = r.last - r.first < SHORT_RUN;
  return r;
}

/** The key of a short run (end 0, its first voxel) or of one end of a long one. */
static uint64_t key_of(const vxm_grid *solid, const line *l, int64_t voxel, int end) {
  int64_t at[3] = {l->at[0], l->at[1], l->at[2]};
  at[l->axis] = voxel;
  uint64_t centre = (uint64_t)((at[2] * solid->space.dims[1] + at[1]) * solid->space.dims[0] + at[0]);
  return (centre * 3 + (uint64_t)l->axis) * 2 + (uint64_t)end + 1;
}

/* ---- Table ---- */

static extent *slot_of(extent *table, size_t capacity, uint64_t key) {
  size_t at = (size_t)vxm_mix(key) & (capacity - 1);
  while (table[at].key && table[at].key != key)
    at = (at + 1) & (capacity - 1);
  return &table[at];
}

static vxm_status make_room(vxm_line_hits *hits, vxm_error *error) {
  if (hits->count < hits->capacity / 4 * 3)
    return VXM_OK;
  vxm_status status = VXM_OK;
  size_t capacity = hits->capacity ? 2 * hits->capacity : 1024;
  extent *table = vxm_try_calloc(hits->context, capacity, sizeof *table, &status, error);
  if (!table)
    return status;
  for (size_t i = 0; i < hits->capacity; i++)
    if (hits->table[i].key)
      *slot_of(table, capacity, hits->table[i].key) = hits->table[i];
  vxm_free(hits->context, hits->table);
  hits->table = table;
  hits->capacity = capacity;
  return VXM_OK;
}

static vxm_status take(vxm_line_hits *hits, uint64_t key, const hit *h, vxm_error *error) {
  vxm_status status = make_room(hits, error);
  if (status != VXM_OK)
    return status;
  extent *e = slot_of(hits->table, hits->capacity, key);
  if (!e->key) {
    *e = (extent){key, *h, *h};
    hits->count++;
  }
  if (h->at < e->low.at)
    e->low = *h;
  if (h->at > e->high.at)
    e->high = *h;
  return VXM_OK;
}

static const extent *find(const vxm_line_hits *hits, uint64_t key) {
  if (hits->count == 0)
    return NULL;
  const extent *e = slot_of(hits->table, hits->capacity, key);
  return e->key ? e : NULL;
}

/* ---- Hits ---- */

typedef struct search {
  vxm_line_hits *hits;
  const vxm_surface *surface;
  /** Faces that lie on the empty centre next to a run count only where no other one is on that link: they
   * may be those of a body beyond a gap. So all others are looked at first. */
  bool at_neighbours;
  bool seen_some; /**< of those */
  size_t rows;    /**< that have been looked at */
} search;

/** A hit at the centre beside a run. @return whether the run wants it */
static bool is_wanted(const vxm_line_hits *hits, uint64_t key, const run *r, bool above, double at) {
  const extent *e = find(hits, key);
  if (!e)
    return true;
  return above ? e->high.at < (double)r->last + NEAR || e->high.at > at - 2 * NEAR
               : e->low.at > (double)r->first - NEAR || e->low.at < at + 2 * NEAR;
}

/** Gives a hit to the run that a set voxel beside it belongs to. */
static vxm_status give(search *s, const line *l, int64_t voxel, const hit *h, vxm_error *error) {
  const vxm_grid *solid = s->hits->solid;
  run r = run_of(solid, l, voxel);
  double at = (double)h->at;
  int end = 0;
  if (!r.is_short) {
    bool is_first = !is_set(solid, l, voxel - 1), is_last = !is_set(solid, l, voxel + 1);
    /* An end voxel may lie beyond the face, where it holds a thin part together. */
    if (!(is_first && at < (double)voxel + 1) && !(is_last && at > (double)voxel - 1))
      return VXM_OK;
    end = is_last;
    r.first = r.last = voxel;
  }
  bool above = at > (double)r.last + 1 - NEAR, below = at < (double)r.first - 1 + NEAR;
  uint64_t key = key_of(solid, l, end ? r.last : r.first, end);
  s->seen_some |= above || below;
  if ((above || below) != s->at_neighbours)
    return VXM_OK;
  if ((above || below) && !is_wanted(s->hits, key, &r, above, at))
    return VXM_OK;
  return take(s->hits, key, h, error);
}

static vxm_status add_hit(search *s, const line *l, const hit *h, vxm_error *error) {
  const int64_t begin = (int64_t)floor((double)h->at - NEAR), end = (int64_t)floor((double)h->at + NEAR) + 1;
  vxm_status status = VXM_OK;
  run last = {0, INT64_MIN, false};
  for (int64_t i = begin; i <= end && status == VXM_OK; i++)
    if (i > last.last && is_set(s->hits->solid, l, i)) {
      run r = run_of(s->hits->solid, l, i);
      last.last = r.is_short ? r.last : i;
      status = give(s, l, i, h, error);
    }
  return status;
}

/** The lines along an axis that a triangle meets, in a row of them: those between two points of its edges. */
static vxm_status add_row(search *s, const double p[3][3], line *l, hit h, vxm_error *error) {
  const int a = l->axis, b = (a + 1) % 3, c = (a + 2) % 3;
  const double row = (double)l->at[c];
  const int64_t *dims = s->hits->solid->space.dims;
  double from[2] = {INFINITY, 0}, to[2] = {-INFINITY, 0};
  for (int e = 0; e < 3; e++) {
    const double *q = p[e], *r = p[(e + 1) % 3];
    double d = r[c] - q[c], share = d == 0 ? 0 : fmin(fmax((row - q[c]) / d, 0), 1);
    if (fmin(q[c], r[c]) > row + 1e-9 || fmax(q[c], r[c]) < row - 1e-9)
      continue;
    for (int twice = 0; twice < (d == 0 ? 2 : 1); twice++, share = 1) {
      double at[2] = {q[b] + share * (r[b] - q[b]), q[a] + share * (r[a] - q[a])};
      if (at[0] < from[0])
        from[0] = at[0], from[1] = at[1];
      if (at[0] > to[0])
        to[0] = at[0], to[1] = at[1];
    }
  }
  vxm_status status = VXM_OK;
  double first = fmax(ceil(from[0] - 1e-9), 0), last = fmin(floor(to[0] + 1e-9), (double)(dims[b] - 1));
  for (double i = first; i <= last && status == VXM_OK; i++) {
    double share = to[0] > from[0] ? fmin(fmax((i - from[0]) / (to[0] - from[0]), 0), 1) : 0;
    double at = from[1] + share * (to[1] - from[1]);
    l->at[b] = (int64_t)i;
    h.at = (float)at;
    if (at > -1 && at < (double)dims[a])
      status = add_hit(s, l, &h, error);
  }
  return status;
}

static vxm_status add_triangle(search *s, const double p[3][3], vxm_error *error) {
  double u[3], v[3], n[3];
  for (int a = 0; a < 3; a++) {
    u[a] = p[1][a] - p[0][a];
    v[a] = p[2][a] - p[0][a];
  }
  for (int a = 0; a < 3; a++)
    n[a] = fabs(u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3]);
  double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  int main = n[0] >= n[1] && n[0] >= n[2] ? 0 : n[1] >= n[2] ? 1 : 2;
  vxm_status status = VXM_OK;
  for (int a = 0; a < 3; a++) {
    const int c = (a + 2) % 3;
    if (!(n[a] > 1e-6 * length)) /* where it lies along the lines its neighbours are met */
      continue;
    double low = fmin(fmin(p[0][c], p[1][c]), p[2][c]), high = fmax(fmax(p[0][c], p[1][c]), p[2][c]);
    double first = fmax(ceil(low - 1e-9), 0),
           last = fmin(floor(high + 1e-9), (double)(s->hits->solid->space.dims[c] - 1));
    for (double j = first; j <= last && status == VXM_OK; j++) {
      line l = {.axis = a};
      l.at[c] = (int64_t)j;
      status = add_row(s, p, &l, (hit){.sine = (float)(n[a] / length), .main = (uint8_t)main}, error);
      if (status == VXM_OK && ++s->rows % ASK_ROWS == 0)
        status = vxm_check_cancelled(s->hits->context, error);
    }
  }
  return status;
}

static vxm_status add_triangles(search *s, vxm_error *error) {
  const vxm_soup *soup = s->surface->soup;
  const vxm_space *space = &s->hits->solid->space;
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < s->surface->triangle_count && status == VXM_OK; t++) {
    double p[3][3];
    if (t % 4096 == 0 && (status = vxm_check_cancelled(s->hits->context, error)) != VXM_OK)
      break;
    for (size_t c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        p[c][a] = (vxm_position(soup, s->surface->corners[3 * t + c])[a] - space->origin[a]) /
                      space->voxel_size[a] -
                  0.5;
    status = add_triangle(s, p, error);
  }
  return status;
}

vxm_status vxm_line_hits_create(vxm_line_hits **out, const vxm_soup *soup, const vxm_grid *solid,
                                vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_surface *surface = NULL;
  vxm_line_hits *hits = *out = vxm_calloc(solid->context, 1, sizeof *hits, &local);
  if (hits) {
    *hits = (vxm_line_hits){.context = solid->context, .solid = solid};
    vxm_surface_make(&surface, solid->context, soup, &local);
  }
  search s = {.hits = hits, .surface = surface};
  if (surface && add_triangles(&s, &local) == VXM_OK && s.seen_some) {
    s.at_neighbours = true;
    add_triangles(&s, &local);
  }
  vxm_surface_destroy(surface);
  if (local.code != VXM_OK) {
    vxm_line_hits_destroy(hits);
    *out = NULL;
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_line_hits_destroy(vxm_line_hits *hits) {
  if (!hits)
    return;
  vxm_context *context = hits->context;
  vxm_free(context, hits->table);
  vxm_free(context, hits);
}

/* ---- Crossings ---- */

/** Whether what a face bounds is no thicker along the normal of the face than a short run. */
static bool is_thin(const vxm_grid *solid, const line *l, int64_t voxel, int main) {
  line across = *l;
  across.at[l->axis] = voxel;
  across.axis = main;
  return run_of(solid, &across, across.at[main]).is_short;
}

/** Along how many axes a voxel has no neighbour: one in a plate, two in a rod, three in a crumb. */
static int bare_axes(const vxm_grid *solid, const line *l, int64_t voxel) {
  line across = *l;
  int count = 0;
  across.at[l->axis] = voxel;
  for (across.axis = 0; across.axis < 3; across.axis++) {
    int64_t at = across.at[across.axis];
    count += !is_set(solid, &across, at - 1) && !is_set(solid, &across, at + 1);
  }
  return count;
}

/** How thick a short run must come out along its line. */
static double least_along(const vxm_grid *solid, const line *l, const run *r, const extent *e) {
  if (!e)
    return THINNEST + (double)(r->last - r->first);
  const hit *h = e->high.sine > e->low.sine ? &e->high : &e->low;
  bool thin = is_thin(solid, l, r->first, h->main) || is_thin(solid, l, r->last, h->main);
  return thin ? THINNEST / fmax((double)h->sine, LOWEST_SINE) : 0;
}

/** The place of the surface at one end of a run. */
static double end_of(const vxm_line_hits *hits, const line *l, int64_t voxel, bool above) {
  const vxm_grid *solid = hits->solid;
  run r = run_of(solid, l, voxel);
  if (!r.is_short) {
    const extent *e = find(hits, key_of(solid, l, voxel, above));
    return e ? (double)(above ? e->high.at : e->low.at) : (double)voxel + (above ? 0.5 : -0.5);
  }
  const extent *e = find(hits, key_of(solid, l, r.first, 0));
  double middle = e ? 0.5 * ((double)e->low.at + (double)e->high.at) : 0.5 * (double)(r.first + r.last);
  double length = e ? (double)e->high.at - (double)e->low.at : 0;
  int axes = r.first == r.last ? bare_axes(solid, l, voxel) : 1;
  /* A vertex beside a rod is in the middle between the crossings of two axes, half as far out as these. */
  length = axes > 1 ? axes * fmax(length, THINNEST) : fmax(length, least_along(solid, l, &r, e));
  return above ? middle + 0.5 * length : middle - 0.5 * length;
}

/** The links that begin at a centre. */
static void share_links(float shares[3], const vxm_line_hits *hits, const int64_t centre[3]) {
  for (int a = 0; a < 3; a++) {
    const line l = {a, {centre[0], centre[1], centre[2]}};
    const int64_t at = centre[a];
    bool begins = is_set(hits->solid, &l, at);
    if (begins != is_set(hits->solid, &l, at + 1))
      shares[a] = (float)(end_of(hits, &l, begins ? at : at + 1, begins) - (double)at);
  }
}

void vxm_line_hits_slice(float (*shares)[3], const vxm_line_hits *hits, int64_t slice) {
  const vxm_grid *solid = hits->solid;
  const int64_t *dims = solid->space.dims;
  for (int64_t j = 0; j < dims[1]; j++) {
    const uint64_t *row = vxm_grid_row(solid, j, slice);
    const uint64_t *beside = j + 1 < dims[1] ? row + solid->row_words : row;
    const uint64_t *above = slice + 1 < dims[2] ? row + solid->slice_words : row;
    for (size_t w = 0; w < solid->row_words; w++) {
      uint64_t next = row[w] >> 1 | (w + 1 < solid->row_words ? row[w + 1] << 63 : 0);
      uint64_t crossed = (row[w] ^ next) | (row[w] ^ beside[w]) | (row[w] ^ above[w]);
      for (; crossed; crossed &= crossed - 1) {
        const int64_t i = 64 * (int64_t)w + __builtin_ctzll(crossed);
        share_links(shares[j * dims[0] + i], hits, (const int64_t[3]){i, j, slice});
      }
    }
  }
}
