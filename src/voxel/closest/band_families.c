/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/band_families.h"
#include "base/bits.h"
#include "base/threads.h"
#include "mesh/sort.h"
#include "voxel/closest/band_tile.h"

#include <math.h>
#include <string.h>

enum {
  SLICES = 64,     /**< of triangles, for the threads */
  PLACE_SHIFT = 32 /**< in keys: where triangles lie, above their numbers */
};

/** How wide a family gets, in voxels; a wider triangle is one by itself. */
static const double widest = 6;
/** A length in floats is off by less than this part of the lengths that it is made from: ninety-six
 * roundings, where some eighty are made, what flat triangles lose included. */
static const double rounding = 96 * 0x1p-24;
/** Bricks of voxels reach beyond a family's box by as much. */
static const double beyond[3] = {3, 1, 1};

/** How wide it gets in times of its widest triangle: what lies farther apart had better not wait for each
 * other. */
static const double widest_of_own = 5;

typedef struct box {
  double low[3], high[3];
} box;

typedef struct builder {
  vxm_band_families *made;
  const vxm_band_soup *soup;
  const vxm_band_kernels *kernels;
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

/** The low ten bits of two numbers, the other one from bit 32 on, with two zeros between any two of them. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 16) & UINT64_C(0x030000ff030000ff);
  x = (x | x << 8) & UINT64_C(0x0300f00f0300f00f);
  x = (x | x << 4) & UINT64_C(0x030c30c3030c30c3);
  return (x | x << 2) & UINT64_C(0x0924924909249249);
}

static void make_keys(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  const vxm_band_grid *grid = &b->made->grid;
  const double(*points)[3] = b->soup->points;
  double scale = 2;
  for (int a = 0; a < 3; a++)
    scale = least_of(scale, 1024 / ((double)grid->dims[a] * grid->step[grid->axes[a]]));
  for (size_t i = slice_begin(b, slice); i < slice_begin(b, slice + 1); i++) {
    const uint32_t *c = b->soup->corners[i];
    uint32_t at[3];
    for (int a = 0; a < 3; a++) {
      double place = (points[c[0]][a] + points[c[1]][a] + points[c[2]][a]) * (scale / 3);
      at[a] = (uint32_t)(int32_t)least_of(most_of(place, 0), 1023);
    }
    uint64_t two = spread(at[0] | (uint64_t)at[1] << 32);
    b->keys[i] = (two | two >> 31 | spread(at[2]) << 2) << PLACE_SHIFT | i;
  }
}

/* ---- Which belong together ---- */

static box box_of(const vxm_band_soup *soup, size_t triangle) {
  const uint32_t *c = soup->corners[triangle];
  const double *x = soup->points[c[0]], *y = soup->points[c[1]], *z = soup->points[c[2]];
  box made;
  for (int a = 0; a < 3; a++) {
    made.low[a] = least_of(least_of(x[a], y[a]), z[a]);
    made.high[a] = most_of(most_of(x[a], y[a]), z[a]);
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

static double width_of(box b) {
  return most_of(most_of(b.high[0] - b.low[0], b.high[1] - b.low[1]), b.high[2] - b.low[2]);
}

static void find_starts(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  size_t begin = slice_begin(b, slice), end = slice_begin(b, slice + 1), count = 0, first = begin;
  box all = {{0}, {0}};
  double most = 0;
  for (size_t i = begin; i < end; i++) {
    box own = box_of(b->soup, (uint32_t)b->keys[i]), both = joined(all, own);
    double width = width_of(own);
    most = most_of(most, width);
    if (i == begin || i - first == VXM_BAND_FAMILY ||
        width_of(both) > least_of(widest, widest_of_own * most)) {
      b->starts[begin + count++] = (uint32_t)i;
      first = i;
      both = own;
      most = width;
    }
    all = both;
  }
  b->counts[slice] = count;
}

/* ---- Families ---- */

/** The voxels that a box grown by the band holds. */
static void find_voxels(vxm_band_family *f, const vxm_band_grid *grid) {
  for (int a = 0; a < 3; a++) {
    int axis = grid->axes[a];
    double reach = (double)f->half[a] + grid->band, most = (double)grid->dims[a];
    double low = (f->origin[axis] - reach) / grid->step[axis] - 0.5,
           high = (f->origin[axis] + reach) / grid->step[axis] - 0.5;
    /* Rounded up, and down: what lies behind the point is dropped. */
    f->box[a][0] = (int32_t)least_of(most_of(low - 2e-6 + 1, 0), most);
    f->box[a][1] = (int32_t)least_of(most_of(high + 1e-6 + 1, 0), most);
  }
  for (int a = 0; a < 3; a++)
    if (f->box[a][0] >= f->box[a][1])
      f->box[0][0] = f->box[0][1] = 0;
}

static void make_family(const builder *b, size_t at, size_t first, size_t end) {
  vxm_band_families *made = b->made;
  const vxm_band_grid *grid = &made->grid;
  vxm_band_family *f = &made->families[at];
  double reach2 = 0;
  f->first = (uint32_t)first;
  f->count = (uint32_t)(end - first);
  for (size_t i = first; i < end; i++)
    memcpy(made->triangles[i].corner, b->soup->corners[(uint32_t)b->keys[i]], sizeof(uint32_t[3]));
  double reach = b->kernels->make_family(f, &made->triangles[first], b->soup->points, grid);
  for (int a = 0; a < 3; a++) {
    double far = (double)f->half[a] + grid->band + (beyond[a] + 2) * grid->step[grid->axes[a]];
    reach2 += far * far;
  }
  double off = (reach + sqrt(reach2)) * rounding;
  f->room = (float)(off * (2 * (grid->band + 1) + 3 * off));
  for (int a = 0; a < 3; a++) {
    f->low[a] -= (float)off;
    f->high[a] += (float)off;
    f->half[a] += (float)off;
  }
  find_voxels(f, grid);
}

static void make_families(size_t slice, int worker, void *payload) {
  (void)worker;
  const builder *b = payload;
  size_t begin = slice_begin(b, slice), end = slice_begin(b, slice + 1), count = b->counts[slice];
  size_t at = 0;
  for (size_t s = 0; s < slice; s++)
    at += b->counts[s];
  const uint32_t *starts = b->starts + begin;
  for (size_t n = 0; n < count; n++)
    make_family(b, at + n, starts[n], n + 1 < count ? starts[n + 1] : end);
}

/* ---- All of them ---- */

uint64_t vxm_band_families_bytes(size_t count) {
  uint64_t triangle = sizeof(vxm_band_triangle) + sizeof(uint32_t) + 2 * sizeof(uint64_t);
  return count * (triangle + sizeof(vxm_band_family)) + sizeof(vxm_band_families) + 4096;
}

/** Fails by its error; what could be had is freed with the families. */
static void allocate(builder *b, vxm_error *error) {
  vxm_band_families *made = b->made;
  vxm_context *context = made->context;
  size_t count = made->triangle_count;
  made->triangles = vxm_alloc(context, count, sizeof *made->triangles, error);
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
  vxm_sort_keys_above(b->keys, b->scratch, made->triangle_count, PLACE_SHIFT);
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

vxm_status vxm_band_families_create(vxm_band_families **out, vxm_context *context, const vxm_band_soup *soup,
                                    const vxm_band_grid *grid, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  builder b = {.made = vxm_calloc(context, 1, sizeof *b.made, &local),
               .soup = soup,
               .kernels = vxm_band_kernels_best()};
  *out = NULL;
  if (b.made) {
    b.made->context = context;
    b.made->grid = *grid;
    b.made->points = soup->points;
    b.made->triangle_count = soup->count;
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
  vxm_free(context, families->triangles);
  vxm_free(context, families);
}
