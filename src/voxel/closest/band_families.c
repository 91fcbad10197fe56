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
 * roundings, where some sixty are made. */
static const double rounding = 96 * 0x1p-24;
/** Bricks of voxels reach beyond a family's box by as much. */
static const double beyond[3] = {3, 1, 1};

typedef struct builder {
  vxm_band_families *made;
  vxm_band_corners_fn corners;
  const void *payload;
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
    b->keys[i] = (uint64_t)code << PLACE_SHIFT | i;
  }
}

/* ---- Which belong together ---- */

static vxm_band_box box_of(const double corner[3][3]) {
  vxm_band_box made;
  for (int a = 0; a < 3; a++) {
    made.low[a] = least_of(least_of(corner[0][a], corner[1][a]), corner[2][a]);
    made.high[a] = most_of(most_of(corner[0][a], corner[1][a]), corner[2][a]);
  }
  return made;
}

static vxm_band_box joined(vxm_band_box a, vxm_band_box b) {
  for (int i = 0; i < 3; i++) {
    a.low[i] = least_of(a.low[i], b.low[i]);
    a.high[i] = most_of(a.high[i], b.high[i]);
  }
  return a;
}

static bool is_narrow(vxm_band_box b) {
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
  vxm_band_box all = {{0}, {0}};
  for (size_t i = begin; i < end; i++) {
    double corner[3][3];
    fetch(corner, b, i);
    vxm_band_box own = box_of((const double(*)[3])corner), both = joined(all, own);
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

/** The voxels that a box grown by the band holds. */
static void find_voxels(vxm_band_family *f, const vxm_band_grid *grid, const vxm_band_box *around) {
  for (int a = 0; a < 3; a++) {
    int axis = grid->axes[a];
    double low = (around->low[axis] - grid->band) / grid->step[axis] - 0.5,
           high = (around->high[axis] + grid->band) / grid->step[axis] - 0.5, most = (double)grid->dims[a];
    /* Rounded up, and down: what lies behind the point is dropped. */
    f->box[a][0] = (int32_t)least_of(most_of(low - 2e-6 + 1, 0), most);
    f->box[a][1] = (int32_t)least_of(most_of(high + 1e-6 + 1, 0), most);
  }
  for (int a = 0; a < 3; a++)
    if (f->box[a][0] >= f->box[a][1])
      f->box[0][0] = f->box[0][1] = 0;
}

/** With the frames of its triangles made, whose first is `staged`. */
static void make_family(const builder *b, size_t at, size_t first, size_t end, const vxm_band_stage *stage,
                        size_t staged) {
  vxm_band_families *made = b->made;
  const vxm_band_grid *grid = &made->grid;
  vxm_band_family *f = &made->families[at];
  vxm_band_box around;
  double reach2 = 0;
  f->first = (uint32_t)first;
  f->count = (uint32_t)(end - first);
  double reach = b->kernels->make_family(f, &around, &made->rough[first], stage, staged, grid);
  for (int a = 0; a < 3; a++) {
    int c = grid->axes[a];
    double far = (around.high[c] - f->origin[c]) + grid->band + (beyond[a] + 2) * grid->step[c];
    reach2 += far * far;
  }
  double off = (reach + sqrt(reach2)) * rounding;
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
  vxm_band_stage stage;
  memset(&stage, 0, sizeof stage);
  for (size_t n = 0; n < count;) {
    double corners[VXM_BAND_STAGED][3][3];
    size_t first = starts[n], next = n, stop = first;
    for (; next < count && (next + 1 < count ? starts[next + 1] : end) - first <= VXM_BAND_STAGED; next++)
      stop = next + 1 < count ? starts[next + 1] : end;
    for (size_t i = first; i < stop; i++)
      memcpy(corners[i - first], &b->made->exact[i], sizeof corners[0]);
    b->kernels->make_frames(&b->made->exact[first], &stage, (const double(*)[3][3])corners, stop - first);
    for (; n < next; n++)
      make_family(b, at + n, starts[n], n + 1 < count ? starts[n + 1] : end, &stage, starts[n] - first);
  }
}

/* ---- All of them ---- */

uint64_t vxm_band_families_bytes(size_t count) {
  uint64_t triangle =
      sizeof(vxm_distance_triangle) + sizeof(vxm_band_triangle) + sizeof(uint32_t) + 2 * sizeof(uint64_t);
  return count * (triangle + sizeof(vxm_band_family)) + sizeof(vxm_band_families) + 4096;
}

/** Fails by its error; what could be had is freed with the families. */
static void allocate(builder *b, vxm_error *error) {
  vxm_band_families *made = b->made;
  vxm_context *context = made->context;
  size_t count = made->triangle_count;
  made->exact = vxm_alloc(context, count, sizeof *made->exact, error);
  made->rough = vxm_alloc(context, count, sizeof *made->rough, error);
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

vxm_status vxm_band_families_create(vxm_band_families **out, vxm_context *context, size_t count,
                                    vxm_band_corners_fn corners, const void *payload,
                                    const vxm_band_grid *grid, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  builder b = {.made = vxm_calloc(context, 1, sizeof *b.made, &local),
               .corners = corners,
               .payload = payload,
               .kernels = vxm_band_kernels_best()};
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
  vxm_free(context, families);
}
