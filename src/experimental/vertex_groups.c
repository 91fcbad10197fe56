/* SPDX-License-Identifier: BSD-3-Clause */
#include "experimental/vertex_groups.h"

/** Lowers the tags of a triangle's vertices to the least of them; whether any was higher. */
static bool lower(uint32_t *tags, const uint32_t corners[3]) {
  uint32_t least = tags[corners[0]];
  bool changed = false;
  for (int c = 1; c < 3; c++)
    least = tags[corners[c]] < least ? tags[corners[c]] : least;
  for (int c = 0; c < 3; c++) {
    changed |= tags[corners[c]] > least;
    tags[corners[c]] = least;
  }
  return changed;
}

/** Goes over all faces until no tag changes: lines 7 to 24. */
static vxm_status spread(uint32_t *tags, const vxm_baseline_job *job, vxm_error *error) {
  const vxm_surface *surface = job->surface;
  bool changed = true;
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < surface->soup->vertex_count; v++)
    tags[v] = (uint32_t)v;
  while (changed && status == VXM_OK) {
    changed = false;
    for (size_t t = 0; t < surface->triangle_count; t++)
      changed |= lower(tags, surface->corners + 3 * t);
    job->report->rounds++;
    status = vxm_check_cancelled(job->context, error);
  }
  return status;
}

/** Orders the triangles by the tags of their vertices, by counting. `numbers`: room for one per vertex. */
static void sort(vxm_vertex_groups *out, uint32_t *numbers, const vxm_surface *surface) {
  const uint32_t *tags = out->tags, *corners = surface->corners;
  for (size_t t = 0; t < surface->triangle_count; t++)
    numbers[tags[corners[3 * t]]]++;
  for (size_t v = 0; v < surface->soup->vertex_count; v++)
    if (numbers[v] > 0) {
      out->begin[out->count + 1] = out->begin[out->count] + numbers[v];
      numbers[v] = (uint32_t)out->begin[out->count++];
    }
  for (size_t t = 0; t < surface->triangle_count; t++)
    out->members[numbers[tags[corners[3 * t]]]++] = (uint32_t)t;
}

vxm_status vxm_vertex_groups_find(vxm_vertex_groups *out, const vxm_baseline_job *job, bool grouped,
                                  vxm_error *error) {
  size_t triangles = job->surface->triangle_count, vertices = job->surface->soup->vertex_count;
  *out = (vxm_vertex_groups){.context = job->context};
  uint32_t *numbers = vxm_baseline_block(job, vertices, sizeof *numbers, error);
  out->tags = numbers ? vxm_baseline_block(job, vertices, sizeof *out->tags, error) : NULL;
  out->members = out->tags ? vxm_baseline_block(job, triangles, sizeof *out->members, error) : NULL;
  out->begin = out->members ? vxm_baseline_block(job, triangles + 1, sizeof *out->begin, error) : NULL;
  vxm_status status = out->begin ? VXM_OK : error->code;
  if (status == VXM_OK && grouped)
    status = spread(out->tags, job, error);
  if (status == VXM_OK)
    sort(out, numbers, job->surface);
  vxm_free(job->context, numbers);
  return status;
}

void vxm_vertex_groups_destroy(vxm_vertex_groups *groups) {
  vxm_free(groups->context, groups->tags);
  vxm_free(groups->context, groups->members);
  vxm_free(groups->context, groups->begin);
}
