/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/point_in_mesh.h"

#include "base/box.h"
#include "base/hash.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"

#include <math.h>

enum {
  CELLS_MAX = 4096,        /**< along an axis */
  ENTRIES_PER_TRIANGLE = 4 /**< at most, on average */
};

typedef struct vxm_point_in_mesh_triangle triangle;

/** The axes across: u and v with (u, v, axis) a turn of (x, y, z). */
typedef struct plane {
  int u, v, axis;
} plane;

static plane plane_across(int axis) {
  return (plane){(axis + 1) % 3, (axis + 2) % 3, axis};
}

static double coordinate(const vxm_point_in_mesh *inside, uint32_t vertex, int axis) {
  return vxm_position(inside->soup, vertex)[axis] * inside->scale;
}

/* ---- Binning ---- */

typedef struct cell_range {
  size_t low[2], high[2];
} cell_range;

static size_t cell_of(const vxm_point_in_mesh_bins *bins, int side, double from_low) {
  double cell = from_low * bins->per_unit[side];
  if (!(cell > 0))
    return 0;
  return cell < (double)(bins->cells[side] - 1) ? (size_t)cell : bins->cells[side] - 1;
}

static cell_range range_of(const vxm_point_in_mesh *inside, const vxm_point_in_mesh_bins *bins,
                           const triangle *t, plane p) {
  const int axes[2] = {p.u, p.v};
  cell_range range;
  for (int side = 0; side < 2; side++) {
    int axis = axes[side];
    double a = coordinate(inside, t->v[0], axis), b = coordinate(inside, t->v[1], axis);
    double c = coordinate(inside, t->v[2], axis), base = inside->box[axis];
    range.low[side] = cell_of(bins, side, fmin(a, fmin(b, c)) - base);
    range.high[side] = cell_of(bins, side, fmax(a, fmax(b, c)) - base);
  }
  return range;
}

/** Calls the visitor for all fan triangles whose corners are finite. */
typedef void (*triangle_fn)(const triangle *t, void *payload);

static vxm_status for_each_triangle(const vxm_point_in_mesh *inside, triangle_fn visit, void *payload,
                                    vxm_error *error) {
  for (size_t i = 0; i < inside->face_count; i++) {
    size_t count;
    vxm_status status = vxm_check_cancelled_at(i, inside->soup->context, error);
    if (status != VXM_OK)
      return status;
    const uint32_t *corner = vxm_face(inside->soup, inside->faces[i], &count);
    bool finite = true;
    for (size_t c = 0; c < count && finite; c++)
      finite = vxm_is_finite(vxm_position(inside->soup, corner[c]));
    /* in an order that does not change when the face is reversed, nor then does the rounding */
    for (size_t c = 2; c < count && finite; c++) {
      uint32_t p = corner[c - 1], q = corner[c];
      visit(&(triangle){{corner[0], p < q ? p : q, p < q ? q : p}, p > q}, payload);
    }
  }
  return VXM_OK;
}

typedef struct binning {
  const vxm_point_in_mesh *inside;
  vxm_point_in_mesh_bins *bins;
  plane across;
  size_t triangles, entries;
} binning;

static void count_entries(const triangle *t, void *payload) {
  binning *b = payload;
  cell_range r = range_of(b->inside, b->bins, t, b->across);
  b->triangles++;
  b->entries += (r.high[0] - r.low[0] + 1) * (r.high[1] - r.low[1] + 1);
}

static void count_cells(const triangle *t, void *payload) {
  binning *b = payload;
  cell_range r = range_of(b->inside, b->bins, t, b->across);
  for (size_t j = r.low[1]; j <= r.high[1]; j++)
    for (size_t i = r.low[0]; i <= r.high[0]; i++)
      b->bins->begin[j * b->bins->cells[0] + i + 1]++;
}

static void put_entries(const triangle *t, void *payload) {
  binning *b = payload;
  cell_range r = range_of(b->inside, b->bins, t, b->across);
  for (size_t j = r.low[1]; j <= r.high[1]; j++)
    for (size_t i = r.low[0]; i <= r.high[0]; i++)
      b->bins->triangles[b->bins->begin[j * b->bins->cells[0] + i]++] = *t;
}

/** Square cells, about `wanted` of them. */
static void set_cells(binning *b, double wanted) {
  const double *box = b->inside->box;
  double size[2] = {box[b->across.u + 3] - box[b->across.u], box[b->across.v + 3] - box[b->across.v]};
  double side = sqrt(size[0] * size[1] / wanted);
  for (int i = 0; i < 2; i++) {
    double cells = side > 0 ? size[i] / side : 1;
    b->bins->cells[i] = cells > 1 ? (cells < CELLS_MAX ? (size_t)cells : CELLS_MAX) : 1;
    b->bins->per_unit[i] = size[i] > 0 ? (double)b->bins->cells[i] / size[i] : 0;
  }
}

/** Chooses as many cells as triangles, or fewer if they are so large that they would be in too many cells: at
 * last a single one, also of a box that is much longer than wide. */
static vxm_status choose_cells(binning *b, vxm_error *error) {
  double wanted = (double)b->inside->face_count;
  for (;; wanted /= 4) {
    set_cells(b, wanted);
    b->triangles = b->entries = 0;
    vxm_status status = for_each_triangle(b->inside, count_entries, b, error);
    if (status != VXM_OK || b->entries <= ENTRIES_PER_TRIANGLE * b->triangles ||
        b->bins->cells[0] * b->bins->cells[1] <= 1)
      return status;
  }
}

/** Counts the triangles of every cell, then lists them. */
static vxm_status fill_cells(binning *b, vxm_error *error) {
  vxm_point_in_mesh_bins *bins = b->bins;
  size_t cells = bins->cells[0] * bins->cells[1];
  vxm_status status = for_each_triangle(b->inside, count_cells, b, error);
  for (size_t c = 0; c < cells; c++)
    bins->begin[c + 1] += bins->begin[c];
  return status == VXM_OK ? for_each_triangle(b->inside, put_entries, b, error) : status;
}

static vxm_status build(vxm_point_in_mesh *inside, int axis, vxm_error *error) {
  vxm_context *context = inside->soup->context;
  vxm_point_in_mesh_bins *bins = &inside->bins[axis];
  binning b = {.inside = inside, .bins = bins, .across = plane_across(axis)};
  vxm_error local = VXM_ERROR_INIT;
  bool done = choose_cells(&b, &local) == VXM_OK;
  size_t cells = bins->cells[0] * bins->cells[1];
  if (done)
    bins->begin = vxm_calloc(context, cells + 1, sizeof *bins->begin, &local);
  if (bins->begin)
    bins->triangles = vxm_alloc(context, b.entries, sizeof *bins->triangles, &local);
  done = bins->triangles && fill_cells(&b, &local) == VXM_OK;
  if (!done) {
    vxm_free(context, bins->triangles);
    vxm_free(context, bins->begin);
    *bins = (vxm_point_in_mesh_bins){0};
    vxm_error_pass(error, &local);
    return local.code;
  }
  /* every begin has moved to its end */
  for (size_t c = cells; c > 0; c--)
    bins->begin[c] = bins->begin[c - 1];
  bins->begin[0] = 0;
  bins->built = true;
  return VXM_OK;
}

/* ---- Crossing ---- */

/** Whether an edge of the projection crosses the ray from the point along u: half open along v, and computed
 * from the lower to the higher vertex, so that two triangles agree on the edge they share. */
static bool edge_crosses(const vxm_point_in_mesh *inside, plane across, uint32_t a, uint32_t b,
                         const double point[3]) {
  if (a > b) {
    uint32_t kept = a;
    a = b;
    b = kept;
  }
  double av = coordinate(inside, a, across.v) - point[across.v];
  double bv = coordinate(inside, b, across.v) - point[across.v];
  if ((av > 0) == (bv > 0))
    return false;
  double au = coordinate(inside, a, across.u) - point[across.u];
  double bu = coordinate(inside, b, across.u) - point[across.u];
  double turn = au * bv - bu * av;
  return bv > av ? turn > 0 : turn < 0;
}

/** Height of the triangle over the point, relative to it. `turn`: 1 if its corners run to the left as seen
 * from above, else -1. */
static double height_over(const vxm_point_in_mesh *inside, plane across, const triangle *t,
                          const double point[3], int *turn) {
  double d[3][3];
  for (int c = 0; c < 3; c++) {
    d[c][0] = coordinate(inside, t->v[c], across.u) - point[across.u];
    d[c][1] = coordinate(inside, t->v[c], across.v) - point[across.v];
    d[c][2] = coordinate(inside, t->v[c], across.axis) - point[across.axis];
  }
  double weight = 0, sum = 0;
  for (int c = 0; c < 3; c++) {
    const double *p = d[(c + 1) % 3], *q = d[(c + 2) % 3];
    double part = p[0] * q[1] - p[1] * q[0];
    weight += part;
    sum += part * d[c][2];
  }
  *turn = (weight > 0) != t->reversed ? 1 : -1;
  return weight != 0 ? sum / weight : d[0][2];
}

/** Calls the visitor for every triangle that the line through the point along an axis meets. */
typedef void (*crossing_fn)(double height, int turn, void *payload);

static vxm_status for_each_crossing(vxm_point_in_mesh *inside, const double point[3], int axis,
                                    crossing_fn visit, void *payload, vxm_error *error) {
  vxm_point_in_mesh_bins *bins = &inside->bins[axis];
  plane across = plane_across(axis);
  for (int a = 0; a < 3; a++)
    if (!(point[a] >= inside->box[a] && point[a] <= inside->box[a + 3]))
      return VXM_OK;
  vxm_status status = bins->built ? VXM_OK : build(inside, axis, error);
  if (status != VXM_OK)
    return status;
  size_t cell = cell_of(bins, 1, point[across.v] - inside->box[across.v]) * bins->cells[0] +
                cell_of(bins, 0, point[across.u] - inside->box[across.u]);
  for (size_t i = bins->begin[cell]; i < bins->begin[cell + 1]; i++) {
    const triangle *t = &bins->triangles[i];
    status = vxm_check_cancelled_at(++inside->tests, inside->soup->context, error);
    if (status != VXM_OK)
      return status;
    bool covers = false;
    for (int c = 0; c < 3; c++)
      covers ^= edge_crosses(inside, across, t->v[c], t->v[(c + 1) % 3], point);
    if (!covers)
      continue;
    int turn;
    double height = height_over(inside, across, t, point, &turn);
    visit(height, turn, payload);
  }
  return VXM_OK;
}

static void count_odd(double height, int turn, void *payload) {
  int *odd = payload;
  (void)turn;
  odd[height > 0] ^= 1;
}

void vxm_point_in_mesh_find_box(vxm_point_in_mesh *inside) {
  vxm_box_empty(inside->box, inside->box + 3);
  for (size_t i = 0; i < inside->face_count; i++) {
    size_t count;
    const uint32_t *corner = vxm_face(inside->soup, inside->faces[i], &count);
    for (size_t c = 0; c < count; c++)
      for (int a = 0; a < 3; a++) {
        double x = vxm_position(inside->soup, corner[c])[a] * inside->scale;
        inside->box[a] = fmin(inside->box[a], x);
        inside->box[a + 3] = fmax(inside->box[a + 3], x);
      }
  }
}

/** The sides of a face by hashes of their edges: those of an edge with an even number of sides cancel. */
static uint64_t hash_of_sides(const uint32_t *corner, size_t count) {
  uint64_t sum = 0;
  for (size_t c = 0; c < count; c++) {
    uint64_t a = corner[c], b = corner[c + 1 < count ? c + 1 : 0];
    if (a != b)
      sum ^= vxm_hash_word(0, a < b ? a << 32 | b : b << 32 | a);
  }
  return sum;
}

vxm_status vxm_point_in_mesh_is_closed(vxm_point_in_mesh *inside, bool *result, vxm_error *error) {
  uint64_t odd = 0;
  for (size_t i = 0; i < inside->face_count && inside->closed == 0; i++) {
    size_t count;
    vxm_status status = vxm_check_cancelled_at(i, inside->soup->context, error);
    if (status != VXM_OK)
      return status;
    const uint32_t *corner = vxm_face(inside->soup, inside->faces[i], &count);
    odd ^= hash_of_sides(corner, count);
  }
  if (inside->closed == 0)
    inside->closed = odd == 0 ? 1 : -1;
  *result = inside->closed > 0;
  return VXM_OK;
}

vxm_status vxm_point_in_mesh_vote(vxm_point_in_mesh *inside, const double point[3], int axis, int *votes,
                                  vxm_error *error) {
  int odd[2] = {0, 0};
  vxm_status status = for_each_crossing(inside, point, axis, count_odd, odd, error);
  *votes = status == VXM_OK ? odd[0] + odd[1] : 0;
  return status;
}

typedef struct winding {
  double gap;
  int above, below;
} winding;

static void count_turns(double height, int turn, void *payload) {
  winding *w = payload;
  if (height > w->gap)
    w->above += turn;
  else if (height < -w->gap)
    w->below -= turn;
}

vxm_status vxm_point_in_mesh_winding(vxm_point_in_mesh *inside, const double point[3], int axis, double gap,
                                     int *above, int *below, vxm_error *error) {
  winding w = {.gap = gap};
  vxm_status status = for_each_crossing(inside, point, axis, count_turns, &w, error);
  *above = w.above;
  *below = w.below;
  return status;
}

typedef struct rays {
  int odd[2], turns[2];
} rays;

static void count_both(double height, int turn, void *payload) {
  rays *r = payload;
  r->odd[height > 0] ^= 1;
  r->turns[height > 0] += height > 0 ? turn : -turn;
}

vxm_status vxm_point_in_mesh_surrounds(vxm_point_in_mesh *inside, const double point[3], int axis, int *votes,
                                       vxm_error *error) {
  rays r = {{0}, {0}};
  vxm_status status = for_each_crossing(inside, point, axis, count_both, &r, error);
  bool wound = r.turns[0] != 0 && r.turns[0] == r.turns[1];
  *votes = status != VXM_OK ? 0 : wound ? 2 : r.odd[0] + r.odd[1];
  return status;
}

typedef struct way_in {
  double gap, next[2]; /**< below, above */
  bool odd[2];
} way_in;

static void note_next(double height, int turn, void *payload) {
  way_in *w = payload;
  int side = height > 0;
  (void)turn;
  if (fabs(height) <= w->gap)
    return;
  w->odd[side] = !w->odd[side];
  w->next[side] = fmin(w->next[side], fabs(height));
}

vxm_status vxm_point_in_mesh_into(vxm_point_in_mesh *inside, const double point[3], int axis, double gap,
                                  double *height, vxm_error *error) {
  way_in w = {.gap = gap, .next = {INFINITY, INFINITY}};
  vxm_status status = for_each_crossing(inside, point, axis, note_next, &w, error);
  *height = status != VXM_OK || w.odd[0] == w.odd[1] ? 0 : w.odd[1] ? w.next[1] / 2 : -w.next[0] / 2;
  return status;
}

/* ---- On a face ---- */

static bool is_on_triangle(const vxm_point_in_mesh *inside, const triangle *t, const double point[3],
                           double gap) {
  double d[3][3];
  for (int a = 2; a >= 0; a--) {
    for (int c = 0; c < 3; c++)
      d[c][a] = coordinate(inside, t->v[c], a) - point[a];
    if (fmin(d[0][a], fmin(d[1][a], d[2][a])) > gap || fmax(d[0][a], fmax(d[1][a], d[2][a])) < -gap)
      return false;
  }
  vxm_vec3 u = vxm_vec3_between(d[1], d[0], 1), v = vxm_vec3_between(d[2], d[0], 1);
  vxm_vec3 normal = vxm_vec3_cross(u, v);
  double height = vxm_vec3_dot(normal, (vxm_vec3){d[0][0], d[0][1], d[0][2]});
  return fabs(height) <= gap * vxm_vec3_length(normal);
}

vxm_status vxm_point_in_mesh_on_face(vxm_point_in_mesh *inside, const double point[3], double gap,
                                     bool *result, vxm_error *error) {
  vxm_point_in_mesh_bins *bins = &inside->bins[2];
  plane across = plane_across(2);
  const int axes[2] = {across.u, across.v};
  cell_range cells;
  *result = false;
  vxm_status status = bins->built ? VXM_OK : build(inside, 2, error);
  for (int side = 0; side < 2 && status == VXM_OK; side++) {
    double from_low = point[axes[side]] - inside->box[axes[side]];
    cells.low[side] = cell_of(bins, side, from_low - gap);
    cells.high[side] = cell_of(bins, side, from_low + gap);
  }
  for (size_t j = cells.low[1]; status == VXM_OK && j <= cells.high[1]; j++)
    for (size_t i = cells.low[0]; i <= cells.high[0]; i++) {
      size_t cell = j * bins->cells[0] + i;
      for (size_t k = bins->begin[cell]; k < bins->begin[cell + 1] && status == VXM_OK; k++) {
        status = vxm_check_cancelled_at(++inside->tests, inside->soup->context, error);
        if (status == VXM_OK && is_on_triangle(inside, &bins->triangles[k], point, gap)) {
          *result = true;
          return VXM_OK;
        }
      }
    }
  return status;
}

void vxm_point_in_mesh_release(vxm_point_in_mesh *inside) {
  for (int axis = 0; axis < 3; axis++) {
    vxm_free(inside->soup->context, inside->bins[axis].triangles);
    vxm_free(inside->soup->context, inside->bins[axis].begin);
    inside->bins[axis] = (vxm_point_in_mesh_bins){0};
  }
}
