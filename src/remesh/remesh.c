/* SPDX-License-Identifier: BSD-3-Clause */
#include "remesh/remesh.h"

#include "remesh/dual_surface.h"
#include "remesh/line_hits.h"
#include "repair/repair.h"
#include "voxel/model/voxelize.h"

/** A sheet that has an edge in common with itself is given two there. */
static vxm_status part(vxm_soup **soup, vxm_error *error) {
  vxm_soup *whole = *soup;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_MANIFOLD;
  options.weld = VXM_WELD_OFF;
  vxm_status status = vxm_repair_run(soup, NULL, whole, &options, error);
  vxm_soup_destroy(whole);
  return status;
}

/** Room around the solid, so that its surface is closed. */
static vxm_space widened(const vxm_space *space) {
  enum { MARGIN = 2 };
  vxm_space wide = *space;
  for (int a = 0; a < 3; a++) {
    wide.dims[a] += 2 * MARGIN;
    wide.origin[a] -= MARGIN * wide.voxel_size[a];
  }
  return wide;
}

static vxm_status put_slices(vxm_dual_surface *surface, const vxm_line_hits *hits, const vxm_grid *solid,
                             vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  const int64_t *dims = solid->space.dims;
  float(*shares)[3] = vxm_calloc(solid->context, (size_t)dims[0] * (size_t)dims[1], sizeof *shares, &local);
  for (int64_t k = 0; k < dims[2] && local.code == VXM_OK; k++)
    if (vxm_check_cancelled(solid->context, &local) == VXM_OK) {
      vxm_line_hits_slice(shares, hits, k);
      vxm_dual_surface_put(surface, vxm_grid_row(solid, 0, k), (const float(*)[3])shares, &local);
    }
  vxm_free(solid->context, shares);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status remesh(vxm_soup **out, vxm_voxelize_report *report, vxm_model *model,
                         const vxm_space *space, vxm_error *error) {
  vxm_grid *solid;
  vxm_line_hits *hits = NULL;
  vxm_dual_surface *surface = NULL;
  bool meets_itself = false;
  vxm_status status = vxm_voxelize_grid(&solid, report, model, space, error);
  if (status != VXM_OK)
    return status;
  status = vxm_line_hits_create(&hits, model->analysis.soup, solid, error);
  if (status == VXM_OK)
    status = vxm_dual_surface_create(&surface, model->context, space, error);
  if (status == VXM_OK)
    status = put_slices(surface, hits, solid, error);
  if (status == VXM_OK)
    *out = vxm_dual_surface_take(surface, &meets_itself);
  vxm_dual_surface_destroy(surface);
  vxm_line_hits_destroy(hits);
  vxm_grid_destroy(solid);
  return status == VXM_OK && meets_itself ? part(out, error) : status;
}

vxm_status vxm_remesh(vxm_soup **out, vxm_voxelize_report *report, const vxm_soup *soup,
                      const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error) {
  vxm_model *model;
  vxm_voxelize_options held = *options;
  const vxm_space wide = widened(space);
  *out = NULL;
  /* Voxels that touch along an edge alone stay apart, and a slanted plate of such would fall to pieces. */
  if (vxm_thin_separating(options))
    held.thin = VXM_THIN_KEEP26;
  vxm_status status = vxm_model_make(&model, soup, &held, error);
  if (status != VXM_OK)
    return status;
  status = remesh(out, report, model, &wide, error);
  vxm_model_destroy(model);
  return status;
}
