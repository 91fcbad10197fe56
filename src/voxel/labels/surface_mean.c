/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/surface_mean.h"
#include "base/bits.h"

#include <math.h>

enum {
  RUN = 8,             /**< slices that share a list of triangles */
  CORNERS_MAX = 9,     /**< a triangle cut by six planes */
  SUBDIVISION_MAX = 32 /**< of an edge, where a texture has more pixels */
};

/** In voxels: a surface as near as this to a voxel's border lies on it, whatever its corners are rounded to.
 */
static const double border = 0x1p-20;

/** A convex part of a triangle. */
typedef struct polygon {
  int count;
  double at[CORNERS_MAX][3];     /**< in voxels from the corner of the grid on */
  double weight[CORNERS_MAX][3]; /**< of the triangle's corners */
} polygon;

/* ---- Lists of triangles ---- */

static double in_voxels(const vxm_space *space, int axis, double position) {
  return (position - space->origin[axis]) / space->voxel_size[axis];
}

/** The whole numbers of voxels that low to high touches, within 0 to count; none if first > last. */
static void span_of(double low, double high, int64_t count, int64_t *first, int64_t *last) {
  low = floor(low - border);
  high = floor(high + border);
  *first = low > 0 ? low < (double)count ? (int64_t)low : count : 0;
  *last = high < (double)(count - 1) ? high >= 0 ? (int64_t)high : -1 : count - 1;
}

static void slices_of(const vxm_surface_slices *slices, size_t triangle, int64_t *first, int64_t *last) {
  double corner[3][3], low = INFINITY, high = -INFINITY;
  vxm_surface_paint_corners(corner, triangle, slices->paint);
  for (int c = 0; c < 3; c++) {
    double x = in_voxels(slices->space, 0, corner[c][0]);
    low = fmin(low, x);
    high = fmax(high, x);
  }
  span_of(low, high, slices->space->dims[0], first, last);
}

/** Counts the triangles of each run behind the run's place, or puts them into their lists. */
static vxm_status list(vxm_surface_slices *slices, bool is_counting, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < slices->paint->count && status == VXM_OK; t++) {
    int64_t first, last;
    slices_of(slices, t, &first, &last);
    for (int64_t run = first / RUN; first <= last && run <= last / RUN; run++)
      if (is_counting)
        slices->first[run + 1]++;
      else
        slices->triangles[slices->first[run]++] = (uint32_t)t;
    status = vxm_check_cancelled_at(t, slices->paint->soup->context, error);
  }
  return status;
}

vxm_status vxm_surface_slices_open(vxm_surface_slices *slices, const vxm_surface_paint *paint,
                                   const vxm_space *space, vxm_error *error) {
  vxm_context *context = paint->soup->context;
  vxm_error local = VXM_ERROR_INIT;
  *slices = (vxm_surface_slices){
      .paint = paint, .space = space, .run_count = (size_t)(space->dims[0] + RUN - 1) / RUN};
  slices->first = vxm_calloc(context, slices->run_count + 1, sizeof *slices->first, &local);
  if (slices->first)
    list(slices, true, &local);
  for (size_t r = 0; r < slices->run_count && slices->first; r++)
    slices->first[r + 1] += slices->first[r];
  if (local.code == VXM_OK)
    slices->triangles =
        vxm_alloc(context, (size_t)slices->first[slices->run_count], sizeof *slices->triangles, &local);
  if (local.code == VXM_OK && list(slices, false, &local) == VXM_OK) {
    for (size_t r = slices->run_count; r > 0; r--) /* each has moved on to its end */
      slices->first[r] = slices->first[r - 1];
    slices->first[0] = 0;
    return VXM_OK;
  }
  vxm_surface_slices_close(slices);
  vxm_error_pass(error, &local);
  return local.code;
}

void vxm_surface_slices_close(vxm_surface_slices *slices) {
  vxm_context *context = slices->paint->soup->context;
  vxm_free(context, slices->triangles);
  vxm_free(context, slices->first);
}

/* ---- Cutting ---- */

static void put(polygon *out, const polygon *in, int a, int b, double part) {
  for (int c = 0; c < 3; c++) {
    out->at[out->count][c] = in->at[a][c] + part * (in->at[b][c] - in->at[a][c]);
    out->weight[out->count][c] = in->weight[a][c] + part * (in->weight[b][c] - in->weight[a][c]);
  }
  out->count++;
}

/** The part of a convex polygon on one side of a plane: sign * at[axis] <= sign * limit (Sutherland and
 * Hodgman 1974). */
static void cut(polygon *out, const polygon *in, int axis, double sign, double limit) {
  out->count = 0;
  for (int a = 0; a < in->count; a++) {
    int b = a + 1 < in->count ? a + 1 : 0;
    double here = sign * (in->at[a][axis] - limit), there = sign * (in->at[b][axis] - limit);
    if (here <= 0 && out->count < CORNERS_MAX)
      put(out, in, a, b, 0);
    if ((here < 0 && there > 0) || (here > 0 && there < 0))
      if (out->count < CORNERS_MAX)
        put(out, in, a, b, here / (here - there));
  }
}

/** The part within the voxels of one number along an axis. */
static void cut_layer(polygon *out, const polygon *in, int axis, int64_t number) {
  polygon half;
  cut(&half, in, axis, -1, (double)number - border);
  cut(out, &half, axis, 1, (double)(number + 1) + border);
}

static void reach(const polygon *p, int axis, int64_t count, int64_t *first, int64_t *last) {
  double low = INFINITY, high = -INFINITY;
  for (int c = 0; c < p->count; c++) {
    low = fmin(low, p->at[c][axis]);
    high = fmax(high, p->at[c][axis]);
  }
  span_of(low, high, count, first, last);
}

/* ---- Adding ---- */

/** The part of a triangle's area that lies between three points of it, by their weights. */
static double share_of(const double a[3], const double b[3], const double c[3]) {
  return fabs((b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]));
}

/** Adds a triangle cut into n x n, each with the colour of its middle. */
static void add_cut(const vxm_surface_paint *paint, size_t triangle, const double *corner[3], double area,
                    int n, vxm_surface_sum *sum) {
  double each = area / ((double)n * n);
  for (int row = 0; row < n; row++)
    for (int column = 0; column < 2 * (n - row) - 1; column++) {
      /* Those that stand on their base and those on their tip take turns. */
      double off = column % 2 ? 2.0 / 3 : 1.0 / 3, b = (column / 2 + off) / n, c = (row + off) / n, rgb[3];
      double weight[3];
      for (int i = 0; i < 3; i++)
        weight[i] = (1 - b - c) * corner[0][i] + b * corner[1][i] + c * corner[2][i];
      vxm_surface_paint_color(paint, triangle, weight, rgb);
      for (int i = 0; i < 3; i++)
        sum->light[i] += each * rgb[i];
    }
  sum->area += area;
}

static void add_piece(const vxm_surface_paint *paint, size_t triangle, double area, const polygon *piece,
                      vxm_surface_sum *sum) {
  if (piece->count < 3)
    return;
  double pixels = vxm_surface_paint_pixels(paint, triangle, (const double(*)[3])piece->weight, piece->count);
  /* Between pixels light is not linear either: two places for each, and one more. */
  int n = pixels > SUBDIVISION_MAX / 2 ? SUBDIVISION_MAX : pixels > 0 ? (int)ceil(2 * pixels) + 1 : 1;
  n = n < SUBDIVISION_MAX ? n : SUBDIVISION_MAX;
  for (int c = 1; c + 1 < piece->count; c++) {
    const double *corner[3] = {piece->weight[0], piece->weight[c], piece->weight[c + 1]};
    double part = area * share_of(corner[0], corner[1], corner[2]);
    if (part > 0)
      add_cut(paint, triangle, corner, part, n, sum);
  }
}

static double area_of(double corner[3][3]) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    double normal = (corner[1][b] - corner[0][b]) * (corner[2][c] - corner[0][c]) -
                    (corner[1][c] - corner[0][c]) * (corner[2][b] - corner[0][b]);
    square += normal * normal;
  }
  return sqrt(square) / 2;
}

/** Of the area that lies on the border of a voxel and has its outer side there: so much counts. It is seen
 * only where the voxel holds nothing else, while the wall of a body beside the voxel's own takes no part. */
static const double faint = 0x1p-30;

/** Along an axis, the voxels that a triangle turns its outer side to from their border; -2 if there are none.
 */
static int64_t faced_from_border(const polygon *triangle, int axis) {
  const double *p = triangle->at[0], *q = triangle->at[1], *r = triangle->at[2];
  int b = (axis + 1) % 3, c = (axis + 2) % 3;
  double plane = rint(p[axis]), normal = (q[b] - p[b]) * (r[c] - p[c]) - (r[b] - p[b]) * (q[c] - p[c]);
  for (int corner = 0; corner < 3; corner++)
    if (!(fabs(triangle->at[corner][axis] - plane) <= border))
      return -2;
  return fabs(plane) > 0x1p40 ? -2 : (int64_t)plane - (normal < 0);
}

static void add_triangle(const vxm_surface_slices *slices, size_t triangle, int64_t i,
                         vxm_surface_sum *sums) {
  const int64_t *dims = slices->space->dims;
  double corner[3][3];
  polygon whole = {.count = 3, .weight = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, slice, row, piece;
  int64_t first[3], last[3];
  vxm_surface_paint_corners(corner, triangle, slices->paint);
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      whole.at[c][a] = in_voxels(slices->space, a, corner[c][a]);
  cut_layer(&slice, &whole, 0, i);
  int64_t faced[3];
  for (int a = 0; a < 3; a++)
    faced[a] = faced_from_border(&whole, a);
  double area = area_of(corner) * (i == faced[0] ? faint : 1);
  reach(&slice, 1, dims[1], &first[1], &last[1]);
  for (int64_t j = first[1]; j <= last[1]; j++) {
    cut_layer(&row, &slice, 1, j);
    reach(&row, 2, dims[2], &first[2], &last[2]);
    for (int64_t k = first[2]; k <= last[2]; k++) {
      cut_layer(&piece, &row, 2, k);
      double counted = area * (j == faced[1] || k == faced[2] ? faint : 1);
      add_piece(slices->paint, triangle, counted, &piece, &sums[j * dims[2] + k]);
    }
  }
}

void vxm_surface_slices_sum(const vxm_surface_slices *slices, int64_t i, vxm_surface_sum *sums) {
  size_t run = (size_t)i / RUN;
  for (uint64_t t = slices->first[run]; t < slices->first[run + 1]; t++) {
    int64_t first, last;
    slices_of(slices, slices->triangles[t], &first, &last);
    if (first <= i && i <= last)
      add_triangle(slices, slices->triangles[t], i, sums);
  }
}
