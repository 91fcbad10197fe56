/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/band_clusters.h"
#include "base/bits.h"
#include "base/threads.h"
#include "mesh/sort.h"
#include "voxel/closest/band_tile.h"

#include <math.h>
#include <string.h>

enum { SLICES = 64 /**< of triangles, for the threads */ };

/** A length in floats is off by less than this part of the lengths that it is made from: ninety-six
 * roundings, where some eighty are made, what flat triangles lose included. */
static const double rounding = 96 * 0x1p-24;
/** Bricks of voxels reach beyond a cluster's box by as much. */
static const double beyond[3] = {3, 1, 1};

typedef struct builder {
  vxm_band_clusters *made;
  const vxm_band_soup *soup;
  const vxm_band_kernels *kernels;
  uint64_t *keys, *scratch; /**< of the triangles: where they lie, and which they are */
  uint32_t *starts;         /**< of each slice, from its first triangle on: where its clusters begin */
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

static void make_keys(size_t slice, int worker, void *payload) {
  (void)worker;
  const builder *b = payload;
  b->kernels->make_keys(b->keys, b->soup, &b->made->grid, slice_begin(b, slice), slice_begin(b, slice + 1));
}

static void find_starts(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  size_t begin = slice_begin(b, slice);
  b->counts[slice] =
      b->kernels->find_starts(b->starts + begin, b->soup, b->keys, begin, slice_begin(b, slice + 1));
}

/* ---- Clusters ---- */

/** The voxels that a box grown by the band holds. */
static void find_voxels(vxm_band_cluster *cluster, const vxm_band_grid *grid) {
  for (int a = 0; a < 3; a++) {
    int axis = grid->axes[a];
    double reach = (double)cluster->half[a] + grid->band, most = (double)grid->dims[a];
    double low = (cluster->origin[axis] - reach) / grid->step[axis] - 0.5,
           high = (cluster->origin[axis] + reach) / grid->step[axis] - 0.5;
    /* Rounded up, and down: what lies behind the point is dropped. */
    cluster->box[a][0] = (int32_t)least_of(most_of(low - 2e-6 + 1, 0), most);
    cluster->box[a][1] = (int32_t)least_of(most_of(high + 1e-6 + 1, 0), most);
  }
  for (int a = 0; a < 3; a++)
    if (cluster->box[a][0] >= cluster->box[a][1])
      cluster->box[0][0] = cluster->box[0][1] = 0;
}

static void make_cluster(const builder *b, size_t at, size_t first, size_t end) {
  vxm_band_clusters *made = b->made;
  const vxm_band_grid *grid = &made->grid;
  vxm_band_cluster *cluster = &made->clusters[at];
  double reach2 = 0;
  cluster->first = (uint32_t)first;
  cluster->count = (uint32_t)(end - first);
  double reach = b->kernels->make_cluster(cluster, &made->triangles[first], b->soup, &b->keys[first], grid);
  for (int a = 0; a < 3; a++) {
    double far = (double)cluster->half[a] + grid->band + (beyond[a] + 2) * grid->step[grid->axes[a]];
    reach2 += far * far;
  }
  double off = (reach + sqrt(reach2)) * rounding;
  cluster->margin = (float)(off * (2 * (grid->band + 1) + 3 * off));
  for (int a = 0; a < 3; a++) {
    cluster->low[a] -= (float)off;
    cluster->high[a] += (float)off;
    cluster->half[a] += (float)off;
  }
  find_voxels(cluster, grid);
}

static void make_clusters(size_t slice, int worker, void *payload) {
  (void)worker;
  const builder *b = payload;
  size_t begin = slice_begin(b, slice), end = slice_begin(b, slice + 1), count = b->counts[slice];
  size_t at = 0;
  for (size_t s = 0; s < slice; s++)
    at += b->counts[s];
  const uint32_t *starts = b->starts + begin;
  for (size_t n = 0; n < count; n++)
    make_cluster(b, at + n, starts[n], n + 1 < count ? starts[n + 1] : end);
}

/* ---- All of them ---- */

uint64_t vxm_band_clusters_bytes(size_t count) {
  uint64_t triangle = sizeof(vxm_band_triangle) + sizeof(uint32_t) + 2 * sizeof(uint64_t);
  return count * (triangle + sizeof(vxm_band_cluster)) + sizeof(vxm_band_clusters) + 4096;
}

/** Fails by its error; what could be had is freed with the clusters. */
static void allocate(builder *b, vxm_error *error) {
  vxm_band_clusters *made = b->made;
  vxm_context *context = made->context;
  size_t count = made->triangle_count;
  made->triangles = vxm_alloc(context, count, sizeof *made->triangles, error);
  b->starts = vxm_alloc(context, count, sizeof *b->starts, error);
  b->keys = vxm_alloc(context, count, sizeof *b->keys, error);
  b->scratch = vxm_alloc(context, count, sizeof *b->scratch, error);
}

static vxm_status build(builder *b, vxm_error *error) {
  vxm_band_clusters *made = b->made;
  vxm_context *context = made->context;
  vxm_status status = vxm_parallel_cancellable(context, SLICES, make_keys, b, error);
  if (status != VXM_OK)
    return status;
  vxm_sort_keys_above(b->keys, b->scratch, made->triangle_count, VXM_BAND_PLACE_SHIFT);
  status = vxm_parallel_cancellable(context, SLICES, find_starts, b, error);
  if (status != VXM_OK)
    return status;
  for (size_t s = 0; s < SLICES; s++)
    made->count += b->counts[s];
  made->clusters = vxm_alloc(context, made->count, sizeof *made->clusters, error);
  if (!made->clusters)
    return error->code;
  return vxm_parallel_cancellable(context, SLICES, make_clusters, b, error);
}

vxm_status vxm_band_clusters_create(vxm_band_clusters **out, vxm_context *context, const vxm_band_soup *soup,
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
    vxm_band_clusters_destroy(b.made);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_band_clusters_destroy(vxm_band_clusters *clusters) {
  if (!clusters)
    return;
  vxm_context *context = clusters->context;
  vxm_free(context, clusters->clusters);
  vxm_free(context, clusters->triangles);
  vxm_free(context, clusters);
}
