/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface.h"
#include "base/threads.h"
#include "meshio/triangulate.h"

#include <stdatomic.h>
#include <string.h>

typedef struct triangle {
  uint32_t corner[3];
} triangle;

typedef struct surface_job {
  vxm_grid *grid;
  const vxm_lattice *lattice;
  const vxm_point *points;
  const triangle *triangles;
  size_t count, slabs;
  uint8_t *confidence;
  atomic_size_t done;
  atomic_bool stop;
  vxm_status status;
  vxm_error *error;
} surface_job;

/** A condition on the minimum corner p of a voxel, in voxels: a . p + b >= 0. */
typedef struct condition {
  vxm_int128 a[3], b;
} condition;

/** Two for the plane, three for the edges in each of the three projections. */
enum { CONDITIONS = 2 + 9 };

static vxm_int128 floor_div(vxm_int128 a, vxm_int128 b) {
  vxm_int128 q = a / b;
  return q - (a % b < 0);
}

/** n . (p unit - v) at the corner of the box that lies farthest along n: it must not be below 0. */
static condition not_before(const vxm_int128 n[3], const vxm_point *v, int64_t unit) {
  condition c = {{0, 0, 0}, 0};
  for (int a = 0; a < 3; a++) {
    c.a[a] = n[a] * unit;
    c.b += (n[a] > 0 ? n[a] * unit : 0) - n[a] * v->at[a];
  }
  return c;
}

static void make_conditions(condition out[CONDITIONS], const vxm_point *const v[3], int64_t unit) {
  vxm_int128 normal[3];
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    normal[a] = (vxm_int128)(v[1]->at[b] - v[0]->at[b]) * (v[2]->at[c] - v[0]->at[c]) -
                (vxm_int128)(v[1]->at[c] - v[0]->at[c]) * (v[2]->at[b] - v[0]->at[b]);
  }
  /* The box meets the plane if one of its corners is not before it, and one not behind. */
  const vxm_int128 back[3] = {-normal[0], -normal[1], -normal[2]};
  out[0] = not_before(normal, v[0], unit);
  out[1] = not_before(back, v[0], unit);
  /* In each projection the square meets the triangle if it is not wholly outside of an edge. Seen edge-on the
     triangle is a segment, whose edges run both ways: then the three conditions bound it from both sides. */
  for (int w = 0; w < 3; w++) {
    int a = (w + 1) % 3, b = (w + 2) % 3, sign = normal[w] >= 0 ? 1 : -1;
    for (int e = 0; e < 3; e++) {
      const vxm_point *p = v[e], *q = v[(e + 1) % 3];
      vxm_int128 inward[3] = {0, 0, 0};
      inward[a] = -(vxm_int128)(q->at[b] - p->at[b]) * sign;
      inward[b] = (vxm_int128)(q->at[a] - p->at[a]) * sign;
      out[2 + 3 * w + e] = not_before(inward, p, unit);
    }
  }
}

/** Narrows [*begin, *end) to the voxels of row (j, k) for which all conditions hold. */
static bool clip_row(const condition conditions[CONDITIONS], int64_t j, int64_t k, int64_t *begin,
                     int64_t *end) {
  for (int c = 0; c < CONDITIONS && *begin < *end; c++) {
    vxm_int128 a = conditions[c].a[0],
               room = conditions[c].a[1] * j + conditions[c].a[2] * k + conditions[c].b;
    if (a > 0) { /* i >= -room / a */
      vxm_int128 least = -floor_div(room, a);
      *begin = least > *begin ? (least < *end ? (int64_t)least : *end) : *begin;
    } else if (a < 0) { /* i <= room / -a */
      vxm_int128 most = floor_div(room, -a) + 1;
      *end = most < *end ? (most > *begin ? (int64_t)most : *begin) : *end;
    } else if (room < 0)
      return false;
  }
  return *begin < *end;
}

/** Voxels whose closed extent along an axis meets [low, high], cut to [first, last). */
static void touched_range(const vxm_lattice *lattice, int64_t low, int64_t high, int64_t first, int64_t last,
                          int64_t *begin, int64_t *end) {
  *begin = vxm_max(first, ((low + lattice->unit - 1) >> lattice->bits) - 1);
  *end = vxm_min(last, (high >> lattice->bits) + 1);
}

/** Draws the part of a triangle in slices k_first..k_last-1; returns the rows it looked at. */
static size_t draw_triangle(const surface_job *job, const triangle *t, int64_t k_first, int64_t k_last) {
  const vxm_point *v[3];
  vxm_point low, high;
  int64_t begin[3], end[3];
  const int64_t *dims = job->grid->space.dims;
  for (int c = 0; c < 3; c++)
    v[c] = &job->points[t->corner[c]];
  for (int a = 0; a < 3; a++) {
    low.at[a] = vxm_min(vxm_min(v[0]->at[a], v[1]->at[a]), v[2]->at[a]);
    high.at[a] = vxm_max(vxm_max(v[0]->at[a], v[1]->at[a]), v[2]->at[a]);
    touched_range(job->lattice, low.at[a], high.at[a], a == 2 ? k_first : 0, a == 2 ? k_last : dims[a],
                  &begin[a], &end[a]);
    if (begin[a] >= end[a])
      return 0;
  }
  condition conditions[CONDITIONS];
  make_conditions(conditions, v, job->lattice->unit);
  for (int64_t k = begin[2]; k < end[2]; k++)
    for (int64_t j = begin[1]; j < end[1]; j++) {
      int64_t i = begin[0], i_end = end[0];
      if (!clip_row(conditions, j, k, &i, &i_end))
        continue;
      vxm_row_set_span(vxm_grid_row(job->grid, j, k), i, i_end);
      if (job->confidence)
        memset(job->confidence + (k * dims[1] + j) * dims[0] + i, 255, (size_t)(i_end - i));
    }
  return (size_t)((end[2] - begin[2]) * (end[1] - begin[1]));
}

/** Rows between two looks at the progress callback; a triangle counts as one too. */
enum { POLL_ROWS = 1 << 16 };

/** A slab of slices, whose words belong to this task alone. */
static void draw_slab(size_t slab, int worker, void *payload) {
  surface_job *job = payload;
  size_t slices = (size_t)job->grid->space.dims[2];
  int64_t first = (int64_t)vxm_slice_begin(slices, job->slabs, slab);
  int64_t last = (int64_t)vxm_slice_begin(slices, job->slabs, slab + 1);
  size_t rows = POLL_ROWS;
  for (size_t t = 0; t < job->count; t++) {
    rows += 1 + draw_triangle(job, &job->triangles[t], first, last);
    if (rows < POLL_ROWS)
      continue;
    rows = 0;
    if (worker == 0 &&
        job->status == VXM_OK) { /* the calling thread, the only one that may report progress */
      double done = (double)atomic_load_explicit(&job->done, memory_order_relaxed);
      job->status =
          vxm_progress(job->grid->context, "voxelizing the surface", done / (double)job->slabs, job->error);
      if (job->status != VXM_OK)
        atomic_store_explicit(&job->stop, true, memory_order_relaxed);
    }
    if (atomic_load_explicit(&job->stop, memory_order_relaxed))
      return;
  }
  atomic_fetch_add_explicit(&job->done, 1, memory_order_relaxed);
}

/* ---- Triangles ---- */

/** Most triangles that the faces of a soup can give. */
static size_t count_triangles(const vxm_soup *soup) {
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    vxm_face(soup, f, &n);
    count += n > 2 ? n - 2 : 0;
  }
  return count;
}

static vxm_status list_triangles(surface_job *job, triangle *out, const vxm_soup *soup, vxm_error *error) {
  vxm_triangulator triangulator;
  vxm_status status = VXM_OK;
  vxm_triangulator_open(&triangulator, soup->context);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n), *cut = corner;
    if (n > 3)
      status = vxm_triangulate(&triangulator, soup->positions, corner, n, &cut, error);
    for (size_t t = 0; t + 2 < n && status == VXM_OK; t++)
      memcpy(out[job->count++].corner, cut + 3 * t, sizeof out->corner);
  }
  vxm_triangulator_close(&triangulator);
  return status;
}

vxm_status vxm_surface_unite(vxm_grid *grid, const vxm_soup *soup, const vxm_lattice *lattice,
                             uint8_t *confidence, vxm_error *error) {
  vxm_context *context = grid->context;
  vxm_error local = VXM_ERROR_INIT;
  surface_job job = {.grid = grid, .lattice = lattice, .confidence = confidence, .error = error};
  job.slabs = (size_t)vxm_context_threads(context) * 4;
  atomic_init(&job.done, 0);
  atomic_init(&job.stop, false);
  vxm_point *points = vxm_alloc(context, soup->vertex_count, sizeof *points, &local);
  triangle *triangles = points ? vxm_alloc(context, count_triangles(soup), sizeof *triangles, &local) : NULL;
  vxm_status status = triangles ? VXM_OK : local.code;
  if (!triangles && error)
    *error = local;
  if (status == VXM_OK)
    for (size_t v = 0; v < soup->vertex_count; v++)
      (void)vxm_lattice_place(lattice, vxm_position(soup, v), &points[v]);
  if (status == VXM_OK)
    status = list_triangles(&job, triangles, soup, error);
  if (status == VXM_OK) {
    job.points = points;
    job.triangles = triangles;
    vxm_parallel(context, job.slabs, draw_slab, &job);
    status = job.status == VXM_OK ? vxm_progress(context, "voxelizing the surface", 1.0, error) : job.status;
  }
  vxm_free(context, triangles);
  vxm_free(context, points);
  return status;
}
