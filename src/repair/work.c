/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/work.h"

#include "base/threads.h"

#include <string.h>

void *vxm_work_scratch(vxm_work *work, size_t count, size_t size, vxm_status *status, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  void *block = vxm_calloc(work->context, count, size, &local);
  if (!block) {
    *status = local.code;
    if (error)
      *error = local;
  }
  return block;
}

vxm_status vxm_work_edges(vxm_work *work, vxm_error *error) {
  if (work->has_edges)
    return VXM_OK;
  vxm_status status = vxm_edges_build(&work->edges, work->context, work->soup, NULL, error);
  work->has_edges = status == VXM_OK;
  return status;
}

void vxm_work_touch(vxm_work *work) {
  if (work->has_edges)
    vxm_edges_destroy(&work->edges);
  work->has_edges = false;
}

void vxm_work_extent(vxm_work *work, vxm_extent *extent) {
  vxm_extent_of(extent, work->context, work->soup, work->used);
}

/* ---- Merging vertices ---- */

enum { CORNERS_PER_SLICE = 1 << 16 };

typedef struct merging {
  vxm_soup *soup;
  const uint32_t *map;
} merging;

static void merge_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const merging *m = payload;
  size_t begin = slice * CORNERS_PER_SLICE, end = begin + CORNERS_PER_SLICE;
  if (end > m->soup->corner_count)
    end = m->soup->corner_count;
  for (size_t c = begin; c < end; c++)
    m->soup->indices[c] = m->map[m->soup->indices[c]];
}

int64_t vxm_work_merge(vxm_work *work, const uint32_t *map) {
  int64_t count = 0;
  for (size_t v = 0; v < work->soup->vertex_count; v++)
    if (map[v] != v) {
      count += !work->gone[v];
      work->gone[v] = 1;
    }
  if (count > 0) {
    merging m = {work->soup, map};
    vxm_parallel(work->context, work->soup->corner_count / CORNERS_PER_SLICE + 1, merge_slice, &m);
    vxm_work_touch(work);
  }
  return count;
}

/* ---- Removing faces ---- */

int64_t vxm_work_remove_faces(vxm_work *work, const uint8_t *remove) {
  vxm_soup *soup = work->soup;
  size_t kept = 0, corners = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    uint64_t begin = soup->offsets[f];
    size_t count = (size_t)(soup->offsets[f + 1] - begin);
    if (remove[f])
      continue;
    if (kept < f) {
      memmove(soup->indices + corners, soup->indices + begin, count * sizeof *soup->indices);
      soup->offsets[kept] = corners;
      if (soup->face_tags)
        soup->face_tags[kept] = soup->face_tags[f];
    }
    kept++;
    corners += count;
  }
  int64_t removed = (int64_t)(soup->face_count - kept);
  soup->offsets[kept] = corners;
  soup->face_count = kept;
  soup->corner_count = corners;
  if (removed > 0)
    vxm_work_touch(work);
  return removed;
}
