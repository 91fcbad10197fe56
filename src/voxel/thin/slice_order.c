/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/slice_order.h"

/** Slices that are not told apart are few against the length of a triangle in a large window. */
enum { BIN_SLICES_SHIFT = 2, BINS_MAX = 1 << 11 };

/** Where triangles go. */
typedef struct bins {
  const uint64_t *cells;
  int bits; /**< of a cell before the number along the slow axis */
  int64_t begin, end;
  int shift;
} bins;

static bins bins_of(const vxm_thin_job *job) {
  bins b = {.cells = job->placed->cells,
            .bits = VXM_CELL_BITS * job->slow,
            .begin = job->view.begin[job->slow],
            .end = job->view.end[job->slow],
            .shift = BIN_SLICES_SHIFT};
  while ((b.end - b.begin) >> b.shift >= BINS_MAX - 1)
    b.shift++;
  return b;
}

/** The bin of the first slice of a triangle, or -1 if it meets nothing that has a voxel in the view. */
static inline int64_t bin_of(const bins *b, const uint32_t corner[3]) {
  const int64_t mask = (int64_t)vxm_cell_mask(0);
  int64_t p = (int64_t)(b->cells[corner[0]] >> b->bits) & mask,
          q = (int64_t)(b->cells[corner[1]] >> b->bits) & mask,
          r = (int64_t)(b->cells[corner[2]] >> b->bits) & mask;
  int64_t low = vxm_min(vxm_min(p, q), r), high = vxm_max(vxm_max(p, q), r);
  if (high < b->begin || low > b->end) /* a cell lies between its voxel and the one before */
    return -1;
  return vxm_max(low - b->begin, 0) >> b->shift;
}

vxm_status vxm_slice_order_make(vxm_slice_order *order, const vxm_thin_job *job, vxm_error *error) {
  const vxm_triangle_set *triangles = job->triangles;
  const bins b = bins_of(job);
  size_t next[BINS_MAX] = {0}, total = 0;
  vxm_status status = vxm_renew(order->context, (void **)&order->triangles, &order->capacity,
                                triangles->triangle_count, sizeof *order->triangles, error);
  order->count = 0;
  if (status != VXM_OK)
    return status;
  for (size_t p = 0; p < triangles->split.part_count; p++)
    for (size_t t = triangles->parts[p].begin; t < triangles->parts[p].caps && status == VXM_OK; t++) {
      int64_t bin = bin_of(&b, job->corners[t]);
      if (bin >= 0)
        next[bin]++;
      status = vxm_check_cancelled_at(t, order->context, error);
    }
  for (int i = 0; i < BINS_MAX; i++) {
    size_t here = next[i];
    next[i] = total;
    total += here;
  }
  for (size_t p = 0; p < triangles->split.part_count; p++)
    for (size_t t = triangles->parts[p].begin; t < triangles->parts[p].caps && status == VXM_OK; t++) {
      int64_t bin = bin_of(&b, job->corners[t]);
      if (bin >= 0)
        order->triangles[next[bin]++] = (uint32_t)t;
      status = vxm_check_cancelled_at(t, order->context, error);
    }
  order->count = status == VXM_OK ? total : 0;
  return status;
}

void vxm_slice_order_destroy(vxm_slice_order *order) {
  vxm_free(order->context, order->triangles);
  *order = (vxm_slice_order){.context = order->context};
}
