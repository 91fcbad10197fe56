/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The XOR of tetrahedra, slice by slice across y: each triangle and the centroid are the corners of one, the
 * plane of a slice cuts it in one triangle or two, and these flip the voxels whose centres they cover (Rueda
 * et al., sections 4 and 5; Ogayar et al., section III-B). A scan-line that flips bits stands for the
 * rasterizer with its XOR.
 *
 * Points of a section go from the lower to the upper end of an edge, sides of it likewise, so that what two
 * tetrahedra or two triangles share is the same number for both and cancels.
 */
#include "experimental/baseline.h"

#include <math.h>

enum { ACROSS = 1 };

/** Corners by their coordinate across slices. */
typedef struct tetrahedron {
  double at[4][3];
} tetrahedron;

typedef struct work {
  const vxm_baseline_job *job;
  double centroid[3];
  tetrahedron *made; /**< one for each triangle, or NULL */
  uint32_t *order;   /**< by the slice in which they begin, or NULL */
  uint32_t *active;  /**< those that the present slice meets */
  size_t active_count;
} work;

/** A centre, moved as the lattice's perturbation moves it: by amounts that doubles hold beside it. */
static double centre(const vxm_lattice *lattice, int64_t voxel, int axis) {
  static const double moved[3] = {0x1p-24, 0x1p-31, 0x1p-38};
  return (double)vxm_lattice_centre(lattice, voxel) + moved[axis] * (double)lattice->unit;
}

/** The first voxel whose centre lies at or beyond a coordinate, within the grid or behind it. */
static int64_t first_voxel(const vxm_lattice *lattice, double at, int axis) {
  double voxel = ceil((at - centre(lattice, 0, axis)) / (double)lattice->unit);
  double most = (double)lattice->space.dims[axis];
  return voxel < 0 ? 0 : voxel > most ? lattice->space.dims[axis] : (int64_t)voxel;
}

/* ---- Tetrahedra ---- */

static void swap_if_above(double a[3], double b[3]) {
  for (int i = 0; i < 3 && a[ACROSS] > b[ACROSS]; i++) {
    int axis = (ACROSS + 1 + i) % 3; /* the axis that is compared comes last */
    double kept = a[axis];
    a[axis] = b[axis];
    b[axis] = kept;
  }
}

static void make(tetrahedron *out, const work *w, size_t triangle) {
  vxm_point p[3];
  vxm_baseline_triangle(p, w->job, triangle);
  for (int a = 0; a < 3; a++) {
    for (int c = 0; c < 3; c++)
      out->at[c][a] = (double)p[c].at[a];
    out->at[3][a] = w->centroid[a];
  }
  static const int network[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}}; /* as in their shader */
  for (int i = 0; i < 5; i++)
    swap_if_above(out->at[network[i][0]], out->at[network[i][1]]);
}

/* ---- Sections ---- */

/** Where an edge meets the plane: x and z. */
static void cut(double out[2], const double low[3], const double high[3], double plane) {
  double share = (plane - low[ACROSS]) / (high[ACROSS] - low[ACROSS]);
  out[0] = low[0] + share * (high[0] - low[0]);
  out[1] = low[2] + share * (high[2] - low[2]);
}

static void flip_from(uint64_t *row, const vxm_grid *grid, int64_t voxel) {
  size_t word = (size_t)voxel / 64;
  if (word == grid->row_words)
    return;
  row[word] ^= ~UINT64_C(0) << (voxel % 64);
  for (word++; word < grid->row_words; word++)
    row[word] ^= ~UINT64_C(0);
}

/** Flips, in one row of a slice, what lies behind each side that the row crosses: two or none. What lies
 * behind the grid's end is flipped an even number of times over all. */
static void draw_row(const work *w, uint64_t *row, const double *const p[3], double z) {
  for (int side = 0; side < 3; side++) {
    const double *a = p[side], *b = p[(side + 1) % 3];
    if ((a[1] < z) == (b[1] < z))
      continue;
    const double *low = a[1] < b[1] ? a : b, *high = a[1] < b[1] ? b : a;
    double x = low[0] + (z - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
    flip_from(row, w->job->grid, first_voxel(&w->job->surface->lattice, x, 0));
  }
}

static void draw(const work *w, int64_t slice, const double a[2], const double b[2], const double c[2]) {
  const vxm_lattice *lattice = &w->job->surface->lattice;
  const double *const p[3] = {a, b, c};
  int64_t end = first_voxel(lattice, fmax(fmax(a[1], b[1]), c[1]), 2);
  w->job->report->sections++;
  for (int64_t k = first_voxel(lattice, fmin(fmin(a[1], b[1]), c[1]), 2); k < end; k++)
    draw_row(w, vxm_grid_row(w->job->grid, slice, k), p, centre(lattice, k, 2));
}

/** The section with a slice, by the edges of their table 1, in which P2 between B and C lies on AC. */
static void draw_section(const work *w, const tetrahedron *t, int64_t slice) {
  double plane = centre(&w->job->surface->lattice, slice, ACROSS), p[4][2];
  const double *a = t->at[0], *b = t->at[1], *c = t->at[2], *d = t->at[3];
  w->job->report->tests++;
  if (!(a[ACROSS] < plane && plane <= d[ACROSS]))
    return;
  bool below_b = plane <= b[ACROSS], below_c = plane <= c[ACROSS];
  cut(p[0], a, d, plane);
  cut(p[1], below_b ? a : b, below_b ? b : d, plane);
  cut(p[2], below_c ? a : c, below_c ? c : d, plane);
  draw(w, slice, p[0], p[1], p[2]);
  if (!below_b && below_c) {
    cut(p[3], b, c, plane);
    draw(w, slice, p[1], p[3], p[2]);
  }
}

/* ---- Orders of slices and tetrahedra ---- */

static int64_t first_slice(const work *w, const tetrahedron *t) {
  return first_voxel(&w->job->surface->lattice, t->at[0][ACROSS], ACROSS);
}

static int64_t end_slice(const work *w, const tetrahedron *t) {
  return first_voxel(&w->job->surface->lattice, t->at[3][ACROSS], ACROSS);
}

/** By counting. `begin`: room for one more than there are slices and one beyond. */
static void sort(work *w, size_t *begin) {
  size_t count = w->job->surface->triangle_count, slices = (size_t)w->job->grid->space.dims[ACROSS];
  for (size_t t = 0; t < count; t++)
    begin[first_slice(w, &w->made[t]) + 1]++;
  for (size_t s = 0; s <= slices; s++)
    begin[s + 1] += begin[s];
  for (size_t t = 0; t < count; t++)
    w->order[begin[first_slice(w, &w->made[t])]++] = (uint32_t)t;
}

static vxm_status prepare(work *w, vxm_error *error) {
  const vxm_baseline_job *job = w->job;
  size_t count = job->surface->triangle_count, slices = (size_t)job->grid->space.dims[ACROSS];
  if (job->options->method == VXM_BASELINE_TETRA_ANEW)
    return VXM_OK;
  w->made = vxm_baseline_block(job, count, sizeof *w->made, error);
  if (!w->made)
    return error->code;
  for (size_t t = 0; t < count; t++)
    make(&w->made[t], w, t);
  if (job->options->method != VXM_BASELINE_TETRA_LISTED)
    return VXM_OK;
  size_t *begin = vxm_baseline_block(job, slices + 2, sizeof *begin, error);
  w->order = begin ? vxm_baseline_block(job, count, sizeof *w->order, error) : NULL;
  w->active = w->order ? vxm_baseline_block(job, count, sizeof *w->active, error) : NULL;
  if (w->active)
    sort(w, begin);
  vxm_free(job->context, begin);
  return w->active ? VXM_OK : error->code;
}

/** Those that begin in a slice join the active ones; those that have ended leave. */
static void draw_listed(work *w, int64_t slice, size_t *next) {
  size_t count = w->job->surface->triangle_count, kept = 0;
  while (*next < count && first_slice(w, &w->made[w->order[*next]]) <= slice)
    w->active[w->active_count++] = w->order[(*next)++];
  for (size_t i = 0; i < w->active_count; i++)
    if (end_slice(w, &w->made[w->active[i]]) > slice)
      w->active[kept++] = w->active[i];
  w->active_count = kept;
  for (size_t i = 0; i < kept; i++)
    draw_section(w, &w->made[w->active[i]], slice);
}

static void draw_all(work *w, int64_t slice) {
  for (size_t t = 0; t < w->job->surface->triangle_count; t++) {
    tetrahedron anew;
    if (!w->made)
      make(&anew, w, t);
    draw_section(w, w->made ? &w->made[t] : &anew, slice);
  }
}

static vxm_status draw_slices(work *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t next = 0;
  for (int64_t s = 0; s < w->job->grid->space.dims[ACROSS] && status == VXM_OK; s++) {
    if (w->order)
      draw_listed(w, s, &next);
    else
      draw_all(w, s);
    status = vxm_check_cancelled(w->job->context, error);
  }
  return status;
}

static vxm_status draw_layers(work *w, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < w->job->surface->triangle_count && status == VXM_OK; t++) {
    int64_t end = end_slice(w, &w->made[t]);
    for (int64_t s = first_slice(w, &w->made[t]); s < end; s++)
      draw_section(w, &w->made[t], s);
    status = vxm_check_cancelled_at(t, w->job->context, error);
  }
  return status;
}

/** The mean of the vertices of triangles. */
static void find_centroid(work *w) {
  size_t count = w->job->surface->triangle_count;
  for (size_t t = 0; t < count; t++) {
    vxm_point p[3];
    vxm_baseline_triangle(p, w->job, t);
    for (int a = 0; a < 3; a++)
      w->centroid[a] += (double)(p[0].at[a] + p[1].at[a] + p[2].at[a]) / 3 / (double)count;
  }
}

vxm_status vxm_baseline_tetra(const vxm_baseline_job *job, vxm_error *error) {
  work w = {.job = job};
  double start = vxm_clock_ms();
  find_centroid(&w);
  vxm_status status = prepare(&w, error);
  job->report->setup_ms = vxm_clock_ms() - start;
  if (status == VXM_OK)
    status =
        job->options->method == VXM_BASELINE_TETRA_LAYERS ? draw_layers(&w, error) : draw_slices(&w, error);
  for (size_t last = job->grid->row_words - 1; last < job->grid->word_count; last += job->grid->row_words)
    job->grid->words[last] &= vxm_grid_tail_mask(job->grid);
  vxm_free(job->context, w.made);
  vxm_free(job->context, w.order);
  vxm_free(job->context, w.active);
  return status;
}
