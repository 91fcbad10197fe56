/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/oversized_triangles.h"
#include "voxel/parity/kernels.h"

/* ---- Which are oversized ---- */

/** Differences of triangles that the shaders do: shaders/job.glsl, shaders/lattice.cl. */
static const int64_t reach = INT64_C(1) << 20;

static bool is_far_point(const vxm_point *p) {
  for (int a = 0; a < 3; a++)
    if (p->at[a] >= VXM_NARROW_MAX || p->at[a] <= -VXM_NARROW_MAX)
      return true;
  return false;
}

static bool is_far(const vxm_point *a, const vxm_point *b, const vxm_point *c) {
  if (is_far_point(a) || is_far_point(b) || is_far_point(c))
    return true;
  for (int i = 0; i < 3; i++) {
    int64_t low = vxm_min(vxm_min(a->at[i], b->at[i]), c->at[i]);
    int64_t high = vxm_max(vxm_max(a->at[i], b->at[i]), c->at[i]);
    if (high - low > reach)
      return true;
  }
  return false;
}

/** Whether all points lie so close together that no triangle can be oversized. */
static bool are_all_near(const vxm_snapped_points *placed, size_t count) {
  int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
  if (placed->wide)
    return false;
  for (size_t p = 0; p < count; p++)
    for (int a = 0; a < 3; a++) {
      int32_t at = placed->narrow[p][a];
      low[a] = at < low[a] ? at : low[a];
      high[a] = at > high[a] ? at : high[a];
    }
  for (int a = 0; a < 3; a++)
    if ((int64_t)high[a] - low[a] > reach)
      return false;
  return true;
}

vxm_status vxm_oversized_find(vxm_oversized *oversized, const vxm_triangle_set *triangles,
                              const vxm_snapped_points *placed, vxm_error *error) {
  oversized->count = 0;
  if (are_all_near(placed, triangles->point_count))
    return VXM_OK;
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < triangles->triangle_count && status == VXM_OK; f++) {
    vxm_point p[3];
    for (int c = 0; c < 3; c++)
      p[c] = vxm_snapped_points_at(placed, triangles->corners[f][c]);
    if (!is_far(&p[0], &p[1], &p[2]))
      continue;
    status = vxm_grow(oversized->context, (void **)&oversized->triangles, &oversized->capacity,
                      oversized->count + 1, sizeof *oversized->triangles, error);
    if (status == VXM_OK)
      oversized->triangles[oversized->count++] = (uint32_t)f;
  }
  return status;
}

vxm_status vxm_oversized_surface_find(vxm_oversized_surface *oversized, const vxm_surface *surface,
                                      vxm_error *error) {
  vxm_status status = VXM_OK;
  oversized->count = 0;
  for (size_t t = 0; t < surface->triangle_count && status == VXM_OK; t++) {
    const uint32_t *corner = surface->corners + 3 * t;
    vxm_point p[3];
    for (int c = 0; c < 3; c++)
      p[c] = vxm_surface_at(surface, corner[c]);
    if (!is_far(&p[0], &p[1], &p[2]))
      continue;
    status = vxm_grow(oversized->context, (void **)&oversized->corners, &oversized->capacity,
                      oversized->count + 1, sizeof *oversized->corners, error);
    for (int c = 0; c < 3 && status == VXM_OK; c++)
      oversized->corners[oversized->count][c] = corner[c];
    oversized->count += status == VXM_OK;
  }
  return status;
}

void vxm_oversized_destroy(vxm_oversized *oversized) {
  vxm_free(oversized->context, oversized->triangles);
}

void vxm_oversized_surface_destroy(vxm_oversized_surface *oversized) {
  vxm_free(oversized->context, oversized->corners);
}

void vxm_oversized_narrow(int32_t (*out)[4], const vxm_point *points, size_t count) {
  for (size_t p = 0; p < count; p++) {
    out[p][3] = is_far_point(&points[p]);
    for (int a = 0; a < 3; a++)
      out[p][a] = out[p][3] ? 0 : (int32_t)points[p].at[a];
  }
}

vxm_status vxm_oversized_surface_add(const vxm_oversized_surface *oversized, const vxm_surface *surface,
                                     const vxm_window *window, vxm_surface_kind kind, vxm_error *error) {
  if (oversized->count == 0)
    return VXM_OK;
  vxm_surface some = *surface;
  some.corners = oversized->corners[0];
  some.triangle_count = oversized->count;
  return vxm_surface_add(&some, window, kind, false, error);
}

/* ---- What they flip ---- */

/** All columns of a slab as one piece of work. */
static vxm_columns columns_of(const vxm_slab_columns *slab, unsigned roles) {
  const int32_t *axes = slab->axes;
  vxm_columns columns = {.u = axes[0],
                         .v = axes[1],
                         .w = axes[2],
                         .keep_before = slab->keep_before != 0,
                         .slab_axis = axes[1],
                         .slab_shift = 62,
                         .roles = roles};
  for (int i = 0; i < 3; i++) {
    columns.begin[axes[i]] = slab->first[i];
    columns.end[axes[i]] = slab->last[i];
    columns.step[axes[i]] = slab->step[i];
  }
  return columns;
}

static size_t words_of(const vxm_slab_columns *slab) {
  uint64_t bits = 0;
  for (int i = 0; i < 3; i++) {
    uint64_t along = (uint64_t)(slab->last[i] - slab->first[i]) * slab->step[i];
    bits = along > bits ? along : bits;
  }
  return (size_t)(bits + 63) / 64;
}

typedef struct flips {
  vxm_context *context;
  uint32_t *bit;
  size_t count, capacity;
} flips;

/** Adds bits of a piece. */
static vxm_status take(flips *out, const vxm_crossing_bin_piece *piece, vxm_error *error) {
  size_t count = piece->count;
  if (piece->is_bitmap) {
    count = 0;
    for (size_t w = 0; w < piece->count; w++)
      count += (size_t)vxm_popcount(piece->data[w]);
  }
  vxm_status status =
      vxm_grow(out->context, (void **)&out->bit, &out->capacity, out->count + count, sizeof *out->bit, error);
  for (size_t w = 0; w < piece->count && status == VXM_OK; w++) {
    if (!piece->is_bitmap)
      out->bit[out->count++] = (uint32_t)piece->data[w];
    else
      for (uint64_t left = piece->data[w]; left != 0; left &= left - 1)
        out->bit[out->count++] = (uint32_t)(64 * w + (size_t)__builtin_ctzll(left));
  }
  return status;
}

static vxm_status take_all(flips *out, const vxm_crossing_bins *bins, vxm_error *error) {
  vxm_status status = vxm_crossing_bins_check(bins, error);
  if (status != VXM_OK)
    return status;
  vxm_crossing_bin_reader reader = vxm_crossing_bin_read(vxm_crossing_bins_at(bins, 0, 0, 0), false);
  vxm_crossing_bin_piece piece;
  while (reader.part != VXM_BIN_NONE && status == VXM_OK)
    while (status == VXM_OK && vxm_crossing_bin_next(&reader, &piece))
      status = take(out, &piece, error);
  return status;
}

vxm_status vxm_oversized_flips(uint32_t **out, size_t *count, const vxm_oversized *oversized,
                               const vxm_slab_columns *slab, const vxm_parity_union_job *job,
                               const vxm_disjoint_passes *passes, size_t pass, vxm_error *error) {
  flips found = {.context = oversized->context};
  const vxm_triangle_set *triangles = job->triangles;
  vxm_crossing_bins bins = {.context = oversized->context};
  vxm_columns columns = columns_of(slab, job->roles);
  vxm_raster_task task = {
      .placed = job->placed, .triangles = triangles, .columns = &columns, .columns_count = 1, .bins = &bins};
  vxm_status status = vxm_crossing_bins_reset(&bins, 1, 1, 1, words_of(slab), error);
  for (size_t i = 0; i < oversized->count && status == VXM_OK; i++) {
    size_t f = oversized->triangles[i], part = triangles->part[f];
    if (part < job->part_begin || part >= job->part_end || passes->pass_of[part - passes->part_begin] != pass)
      continue;
    task.begin = f;
    task.end = f + 1;
    vxm_kernels_get()->raster(&task);
    /* each may cover all columns */
    status = vxm_progress(oversized->context, job->phase, (double)pass / (double)passes->count, error);
  }
  if (status == VXM_OK)
    status = take_all(&found, &bins, error);
  vxm_crossing_bins_destroy(&bins);
  if (status != VXM_OK) {
    vxm_free(found.context, found.bit);
    found = (flips){0};
  }
  *out = found.bit;
  *count = found.count;
  return status;
}
