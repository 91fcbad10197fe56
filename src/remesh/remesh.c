/* SPDX-License-Identifier: BSD-3-Clause */
#include "remesh/remesh.h"

#include "remesh/dual_surface.h"
#include "repair/repair.h"
#include "voxel/fields/distance.h"
#include "voxel/model/voxelize.h"

/** Voxels beyond which distances do not matter: a link has one voxel at most between its ends. */
static const double BAND = 2;

typedef struct remeshing {
  const vxm_grid *solid;
  vxm_dual_surface *surface;
} remeshing;

/** Takes the distances of some slices. */
static vxm_status put_slices(void *payload, const void *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  const remeshing *r = payload;
  const int64_t *dims = r->solid->space.dims;
  vxm_status status = VXM_OK;
  for (int64_t k = begin; k < end && status == VXM_OK; k++) {
    status = vxm_ask(r->solid->context, error);
    if (status == VXM_OK)
      status = vxm_dual_surface_put(r->surface, vxm_grid_row(r->solid, 0, k),
                                    (const float *)values + (k - begin) * dims[0] * dims[1], error);
  }
  return status;
}

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

static vxm_status make_surface(remeshing *r, vxm_model *model, const vxm_space *space, vxm_error *error) {
  vxm_distance_options options = VXM_DISTANCE_OPTIONS_INIT;
  vxm_voxelize_report again = {0}; /* as of the solid */
  vxm_distance_report report = {.voxelize = &again};
  const vxm_field_target target = {.layout = VXM_LAYOUT_GRID, .put = put_slices, .payload = r};
  options.band = BAND;
  vxm_status status = vxm_dual_surface_create(&r->surface, model->context, space, error);
  return status == VXM_OK ? vxm_distance_run(&target, &report, model, space, &options, error) : status;
}

static vxm_status remesh(vxm_soup **out, vxm_voxelize_report *report, vxm_model *model,
                         const vxm_space *space, vxm_error *error) {
  vxm_grid *solid;
  bool meets_itself = false;
  vxm_status status = vxm_voxelize_grid(&solid, report, model, space, error);
  if (status != VXM_OK)
    return status;
  remeshing r = {.solid = solid};
  status = make_surface(&r, model, space, error);
  if (status == VXM_OK)
    *out = vxm_dual_surface_take(r.surface, &meets_itself);
  vxm_dual_surface_destroy(r.surface);
  vxm_grid_destroy(solid);
  return status == VXM_OK && meets_itself ? part(out, error) : status;
}

vxm_status vxm_remesh(vxm_soup **out, vxm_voxelize_report *report, const vxm_soup *soup,
                      const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error) {
  vxm_model *model;
  const vxm_space wide = widened(space);
  *out = NULL;
  vxm_status status = vxm_model_make(&model, soup, options, error);
  if (status != VXM_OK)
    return status;
  status = remesh(out, report, model, &wide, error);
  vxm_model_destroy(model);
  return status;
}
