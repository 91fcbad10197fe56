/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/band_families.h"
#include "base/bits.h"
#include "base/threads.h"
#include "mesh/sort.h"
#include "voxel/closest/band_tile.h"

#include <math.h>
#include <string.h>

enum {
  SLICES = 64, /**< of triangles, for the threads */
  STAGED = 64  /**< triangles whose frames are made at once */
};

/** How wide a family gets, in voxels; a wider triangle is one by itself. */
static const double widest = 4;
/** A length in floats is off by less than this part of the lengths that it is made from: ninety-six
 * roundings, where some sixty are made. */
static const double rounding = 96 * 0x1p-24;
/** Vectors of voxels reach beyond a family's box by as much. */
static const double beyond[3] = {8, 1, 0};

typedef struct builder {
  vxm_band_families *made;
  vxm_band_corners_fn corners;
  const void *payload;
  void (*make_frames)(vxm_distance_triangle *out, const double (*corners)[3][3], size_t count);
  uint64_t *keys, *scratch; /**< of the triangles: where they lie, and which they are */
  uint32_t *starts;         /**< of each slice, from its first triangle on: where its families begin */
  size_t counts[SLICES + 1];
} builder;

static size_t slice_begin(const builder *b, size_t slice) {
  return vxm_slice_begin(b->made->triangle_count, SLICES, slice);
}

/* The library's own are calls. */
static inline double least_of(double a, double b) {
  return a < b ? a : b;
}

static inline double most_of(double a, double b) {
  return a > b ? a : b;
}

/* ---- Order ---- */

/** The low ten bits of a number, two zeros between any two of them. */
static uint32_t spread(uint32_t x) {
  x = (x | x << 16) & UINT32_C(0x030000ff);
  x = (x | x << 8) & UINT32_C(0x0300f00f);
  x = (x | x << 4) & UINT32_C(0x030c30c3);
  return (x | x << 2) & UINT32_C(0x09249249);
}

static void make_keys(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  const vxm_band_grid *grid = &b->made->grid;
  double most[3], scale = 2;
  for (int a = 0; a < 3; a++) {
    most[grid->axes[a]] = (double)grid->dims[a] * grid->step[grid->axes[a]];
    scale = least_of(scale, 1024 / most[grid->axes[a]]);
  }
  for (size_t i = slice_begin(b, slice); i < slice_begin(b, slice + 1); i++) {
    double corner[3][3];
    b->corners(corner, i, b->payload);
    uint32_t code = 0;
    for (int a = 0; a < 3; a++) {
      double at = (corner[0][a] + corner[1][a] + corner[2][a]) / 3;
      at = (at < 0 ? 0 : at > most[a] ? most[a] : at) * scale;
      code |= spread((uint32_t)least_of(at, 1023)) << a;
    }
    b->keys[i] = (uint64_t)code << 32 | i;
  }
}

/* ---- Which belong together ---- */

typedef struct box {
  double low[3], high[3];
} box;

static box box_of(const double corner[3][3]) {
  box made;
  for (int a = 0; a < 3; a++) {
    made.low[a] = least_of(least_of(corner[0][a], corner[1][a]), corner[2][a]);
    made.high[a] = most_of(most_of(corner[0][a], corner[1][a]), corner[2][a]);
  }
  return made;
}

static box joined(box a, box b) {
  for (int i = 0; i < 3; i++) {
    a.low[i] = least_of(a.low[i], b.low[i]);
    a.high[i] = most_of(a.high[i], b.high[i]);
  }
  return a;
}

static bool is_narrow(box b) {
  return most_of(most_of(b.high[0] - b.low[0], b.high[1] - b.low[1]), b.high[2] - b.low[2]) <= widest;
}

/** The corners are fetched once, and wait where their triangle's frame will be. */
static void fetch(double corner[3][3], const builder *b, size_t place) {
  b->corners(corner, (uint32_t)b->keys[place], b->payload);
  memcpy(&b->made->exact[place], corner, sizeof(double[3][3]));
}

static void find_starts(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  size_t begin = slice_begin(b, slice), end = slice_begin(b, slice + 1), count = 0, first = begin;
  box all = {{0}, {0}};
  for (size_t i = begin; i < end; i++) {
    double corner[3][3];
    fetch(corner, b, i);
    box own = box_of((const double(*)[3])corner), both = joined(all, own);
    if (i == begin || i - first == VXM_BAND_FAMILY || !is_narrow(both)) {
      b->starts[begin + count++] = (uint32_t)i;
      first = i;
      both = own;
    }
    all = both;
  }
  b->counts[slice] = count;
}

/* ---- Families ---- */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/** Axes along which the triangles are about flat: any will do. */
static void choose_frame(double axis[3][3], const vxm_distance_triangle *t, size_t count) {
  double sum[3] = {0, 0, 0}, part;
  memcpy(axis, t[0].axis, sizeof t[0].axis);
  if (count == 1)
    return;
  for (size_t i = 0; i < count; i++) {
    double area = t[i].length * t[i].apex[1];
    area = dot(sum, t[i].axis[2]) < 0 ? -area : area;
    for (int a = 0; a < 3; a++)
      sum[a] += area * t[i].axis[2][a];
  }
  double length = sqrt(dot(sum, sum)), least = least_of(least_of(fabs(sum[0]), fabs(sum[1])), fabs(sum[2]));
  if (!(length > 0))
    return;
  for (int a = 0; a < 3; a++) {
    axis[2][a] = sum[a] / length;
    axis[0][a] = fabs(sum[a]) > least ? 0 : 1;
  }
  part = dot(axis[0], axis[2]);
  for (int a = 0; a < 3; a++)
    axis[0][a] -= part * axis[2][a];
  length = 1 / sqrt(dot(axis[0], axis[0]));
  for (int a = 0; a < 3; a++)
    axis[0][a] *= length;
  cross(axis[1], axis[2], axis[0]);
}

static void narrow_triangle(vxm_band_triangle *out, const vxm_distance_triangle *t, const double corner[3][3],
                            const double origin[3], const int axes[3]) {
  double base[3];
  for (int a = 0; a < 3; a++) {
    int c = axes[a];
    base[a] = t->base[a] - origin[a];
    out->middle[a] = (float)((corner[0][c] + corner[1][c] + corner[2][c]) / 3 - origin[c]);
  }
  for (int a = 0; a < 3; a++) {
    for (int c = 0; c < 3; c++)
      out->axis[a][c] = (float)t->axis[a][axes[c]];
    out->offset[a] = (float)dot(t->axis[a], base);
  }
  out->length = (float)t->length;
  for (int i = 0; i < 2; i++) {
    out->leg[i][0] = (float)t->leg[i][0];
    out->leg[i][1] = (float)t->leg[i][1];
    out->leg_length[i] = (float)t->leg_length[i];
  }
}

/** The box of a family in its frame. Returns how far it reaches. */
static double measure_family(vxm_band_family *f, const int axes[3], const double (*corners)[3][3],
                             const double axis[3][3]) {
  double reach2 = 0, low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (int c = 0; c < 3; c++)
      f->axis[a][c] = (float)axis[a][axes[c]];
  }
  for (uint32_t i = 0; i < f->count; i++) {
    double corner[3][3];
    memcpy(corner, corners[i], sizeof corner);
    for (int c = 0; c < 3; c++) {
      for (int a = 0; a < 3; a++)
        corner[c][a] -= f->origin[a];
      reach2 = most_of(reach2, dot(corner[c], corner[c]));
      for (int a = 0; a < 3; a++) {
        double at = dot(corner[c], axis[a]);
        low[a] = least_of(low[a], at);
        high[a] = most_of(high[a], at);
      }
    }
  }
  for (int a = 0; a < 3; a++) {
    f->low[a] = (float)low[a];
    f->high[a] = (float)high[a];
  }
  return sqrt(reach2);
}

/** The voxels that a box grown by the band holds. */
static void find_voxels(vxm_band_family *f, const vxm_band_grid *grid, const box *around) {
  for (int a = 0; a < 3; a++) {
    int axis = grid->axes[a];
    double low = (around->low[axis] - grid->band) / grid->step[axis] - 0.5,
           high = (around->high[axis] + grid->band) / grid->step[axis] - 0.5, most = (double)grid->dims[a];
    f->box[a][0] = (int32_t)least_of(most_of(ceil(low - 1e-6), 0), most);
    f->box[a][1] = (int32_t)least_of(most_of(floor(high + 1e-6) + 1, 0), most);
  }
  for (int a = 0; a < 3; a++)
    if (f->box[a][0] >= f->box[a][1])
      f->box[0][0] = f->box[0][1] = 0;
}

/** With the frames of its triangles made. */
static void make_family(const builder *b, size_t at, size_t first, size_t end,
                        const double (*corners)[3][3]) {
  vxm_band_families *made = b->made;
  const vxm_band_grid *grid = &made->grid;
  vxm_band_family *f = &made->families[at];
  double axis[3][3], reach2 = 0;
  box around = {{0}, {0}};
  f->first = (uint32_t)first;
  f->count = (uint32_t)(end - first);
  for (size_t i = first; i < end; i++) {
    box own = box_of(corners[i - first]);
    around = i == first ? own : joined(around, own);
    made->family_of[i] = (uint32_t)at;
  }
  for (int a = 0; a < 3; a++)
    f->origin[a] = (around.low[a] + around.high[a]) / 2;
  for (int a = 0; a < 3; a++) {
    int c = grid->axes[a];
    double far = (around.high[c] - f->origin[c]) + grid->band + (beyond[a] + 2) * grid->step[c];
    reach2 += far * far;
  }
  for (size_t i = first; i < end; i++)
    narrow_triangle(&made->rough[i], &made->exact[i], corners[i - first], f->origin, grid->axes);
  choose_frame(axis, &made->exact[first], end - first);
  for (int a = 0; a < 3; a++) {
    int c = grid->axes[a];
    f->half[a] = (float)(around.high[c] - f->origin[c]);
  }
  double off = (measure_family(f, grid->axes, corners, (const double(*)[3])axis) + sqrt(reach2)) * rounding;
  f->room = (float)(off * (2 * (grid->band + 1) + 3 * off));
  for (int a = 0; a < 3; a++) {
    f->low[a] -= (float)off;
    f->high[a] += (float)off;
    f->half[a] += (float)off;
  }
  find_voxels(f, grid, &around);
}

static void make_families(size_t slice, int worker, void *payload) {
  (void)worker;
  const builder *b = payload;
  size_t begin = slice_begin(b, slice), end = slice_begin(b, slice + 1), count = b->counts[slice];
  size_t at = 0;
  for (size_t s = 0; s < slice; s++)
    at += b->counts[s];
  const uint32_t *starts = b->starts + begin;
  for (size_t n = 0; n < count;) {
    double corners[STAGED][3][3];
    size_t first = starts[n], next = n, stop = first;
    for (; next < count && (next + 1 < count ? starts[next + 1] : end) - first <= STAGED; next++)
      stop = next + 1 < count ? starts[next + 1] : end;
    for (size_t i = first; i < stop; i++)
      memcpy(corners[i - first], &b->made->exact[i], sizeof corners[0]);
    b->make_frames(&b->made->exact[first], (const double(*)[3][3])corners, stop - first);
    for (; n < next; n++)
      make_family(b, at + n, starts[n], n + 1 < count ? starts[n + 1] : end,
                  (const double(*)[3][3])corners + (starts[n] - first));
  }
}

/* ---- All of them ---- */

uint64_t vxm_band_families_bytes(size_t count) {
  uint64_t triangle =
      sizeof(vxm_distance_triangle) + sizeof(vxm_band_triangle) + 2 * sizeof(uint32_t) + 2 * sizeof(uint64_t);
  return count * (triangle + sizeof(vxm_band_family)) + sizeof(vxm_band_families) + 4096;
}

/** Fails by its error; what could be had is freed with the families. */
static void allocate(builder *b, vxm_error *error) {
  vxm_band_families *made = b->made;
  vxm_context *context = made->context;
  size_t count = made->triangle_count;
  made->exact = vxm_alloc(context, count, sizeof *made->exact, error);
  made->rough = vxm_alloc(context, count, sizeof *made->rough, error);
  made->family_of = vxm_alloc(context, count, sizeof *made->family_of, error);
  b->starts = vxm_alloc(context, count, sizeof *b->starts, error);
  b->keys = vxm_alloc(context, count, sizeof *b->keys, error);
  b->scratch = vxm_alloc(context, count, sizeof *b->scratch, error);
}

static vxm_status build(builder *b, vxm_error *error) {
  vxm_band_families *made = b->made;
  vxm_context *context = made->context;
  vxm_status status = vxm_parallel_asked(context, SLICES, make_keys, b, error);
  if (status != VXM_OK)
    return status;
  vxm_sort_keys(b->keys, b->scratch, made->triangle_count);
  status = vxm_parallel_asked(context, SLICES, find_starts, b, error);
  if (status != VXM_OK)
    return status;
  for (size_t s = 0; s < SLICES; s++)
    made->count += b->counts[s];
  made->families = vxm_alloc(context, made->count, sizeof *made->families, error);
  if (!made->families)
    return error->code;
  return vxm_parallel_asked(context, SLICES, make_families, b, error);
}

vxm_status vxm_band_families_create(vxm_band_families **out, vxm_context *context, size_t count,
                                    vxm_band_corners_fn corners, const void *payload,
                                    const vxm_band_grid *grid, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  builder b = {.made = vxm_calloc(context, 1, sizeof *b.made, &local),
               .corners = corners,
               .payload = payload,
               .make_frames = vxm_band_kernels_best()->make_frames};
  *out = NULL;
  if (b.made) {
    b.made->context = context;
    b.made->grid = *grid;
    b.made->triangle_count = count;
    allocate(&b, &local);
  }
  if (local.code == VXM_OK && build(&b, &local) == VXM_OK)
    *out = b.made;
  vxm_free(context, b.scratch);
  vxm_free(context, b.keys);
  vxm_free(context, b.starts);
  if (local.code != VXM_OK) {
    vxm_band_families_destroy(b.made);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_band_families_destroy(vxm_band_families *families) {
  if (!families)
    return;
  vxm_context *context = families->context;
  vxm_free(context, families->families);
  vxm_free(context, families->exact);
  vxm_free(context, families->rough);
  vxm_free(context, families->family_of);
  vxm_free(context, families);
}
