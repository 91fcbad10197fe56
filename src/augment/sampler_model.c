/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/sampler_model.h"
#include "mesh/weld.h"

#include <math.h>

/** The box of the points that triangles have. */
static vxm_status measure(vxm_model_extent *out, const vxm_triangle_set *triangles, vxm_error *error) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t p = 0; p < triangles->first_apex; p++) {
    const double *at = triangles->positions[p];
    if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
      return vxm_lattice_refuse(triangles->vertex[p], at, error);
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], at[a]);
      high[a] = fmax(high[a], at[a]);
    }
  }
  double longest = 0;
  for (int a = 0; a < 3; a++) {
    out->side[a] = high[a] - low[a];
    out->centre[a] = low[a] + out->side[a] / 2;
    longest = fmax(longest, out->side[a]);
  }
  if (!(longest > 0))
    return vxm_fail(error, VXM_ERROR_EMPTY, "the mesh has no extent, so it cannot be fitted into a grid");
  if (!(longest < 0x1p500) || longest < 0x1p-500)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "the mesh is %g units wide, which cannot be computed with; scale it", longest);
  return VXM_OK;
}

/**
 * Entries of `count` vertices and of the points named by them. They are numbered in the order of the points,
 * so that a variant reads the noise nearly in order.
 */
static vxm_status find_entries(vxm_sampler_model *subject, const vxm_soup *soup, uint32_t size,
                               vxm_error *error) {
  vxm_context *context = subject->model->context;
  const vxm_triangle_set *triangles = &subject->model->analysis.triangles;
  size_t count = soup->vertex_count, points = triangles->first_apex;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *same = vxm_alloc(context, count, sizeof *same, &local);
  uint32_t *entry = same ? vxm_alloc(context, count, sizeof *entry, &local) : NULL;
  subject->entry = entry ? vxm_alloc(context, points, sizeof *subject->entry, &local) : NULL;
  if (subject->entry)
    (void)vxm_weld_exact(context, soup->positions, count, same, NULL, &local);
  uint32_t next = 0;
  if (local.code == VXM_OK) {
    for (size_t v = 0; v < count; v++)
      entry[v] = UINT32_MAX;
    for (size_t p = 0; p < points; p++) {
      uint32_t vertex = triangles->vertex[p];
      uint32_t *at = vertex < count ? &entry[same[vertex]] : &subject->entry[p];
      if (vertex >= count || *at == UINT32_MAX) {
        *at = next;
        next = next + 1 == size ? 0 : next + 1;
      }
      subject->entry[p] = *at;
    }
    for (size_t v = 0; v < count; v++) { /* what no triangle has is not displaced in any way that matters */
      entry[v] = entry[same[v]];
      if (entry[v] == UINT32_MAX)
        entry[v] = 0;
    }
  }
  vxm_free(context, same);
  if (local.code == VXM_OK && vxm_faces_wanted(&subject->model->options))
    subject->vertex_entry = entry;
  else
    vxm_free(context, entry);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_sampler_model_create(vxm_sampler_model *out, uint32_t number, const vxm_soup *soup,
                                    const vxm_voxelize_options *options, const vxm_noise *noise,
                                    vxm_error *error) {
  *out = (vxm_sampler_model){.number = number};
  vxm_status status = vxm_model_make(&out->model, soup, options, error);
  if (status == VXM_OK)
    status = measure(&out->extent, &out->model->analysis.triangles, error);
  if (status == VXM_OK)
    status = vxm_model_instance_prepare(out->model, error);
  if (status == VXM_OK && noise->size > 0)
    status = find_entries(out, soup, noise->size, error);
  if (status != VXM_OK)
    vxm_sampler_model_destroy(out);
  return status;
}

void vxm_sampler_model_destroy(vxm_sampler_model *subject) {
  if (!subject->model)
    return;
  vxm_free(subject->model->context, subject->entry);
  vxm_free(subject->model->context, subject->vertex_entry);
  vxm_model_destroy(subject->model);
  *subject = (vxm_sampler_model){.number = subject->number};
}
