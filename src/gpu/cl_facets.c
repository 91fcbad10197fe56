/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl.h"

static vxm_status upload_points(vxm_opencl *engine, vxm_cl_buffer_id id, const vxm_point *points,
                                size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  int32_t(*narrow)[4] = vxm_alloc(engine->base.context, count, sizeof *narrow, &local);
  if (narrow)
    vxm_far_narrow(narrow, points, count);
  vxm_status status = narrow ? vxm_cl_upload(engine, id, narrow, count * sizeof *narrow, &local) : local.code;
  vxm_free(engine->base.context, narrow);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

vxm_status vxm_cl_place(vxm_opencl *engine, const vxm_facets *facets, const vxm_placed *placed,
                        vxm_error *error) {
  vxm_status status = VXM_OK;
  if (engine->facets_serial != facets->serial) {
    engine->facets_serial = 0;
    status = vxm_cl_upload(engine, VXM_CL_CORNERS, facets->corners,
                           facets->facet_count * sizeof *facets->corners, error);
    if (status != VXM_OK)
      return status;
    engine->facets_serial = facets->serial;
  }
  if (engine->placed_serial == placed->serial)
    return VXM_OK;
  engine->placed_serial = 0;
  size_t count = facets->point_count;
  status = placed->wide
               ? upload_points(engine, VXM_CL_POINTS, placed->wide, count, error)
               : vxm_cl_upload(engine, VXM_CL_POINTS, placed->narrow, count * sizeof *placed->narrow, error);
  if (status == VXM_OK)
    status = vxm_far_find(&engine->far, facets, placed, error);
  if (status == VXM_OK)
    engine->placed_serial = placed->serial;
  return status;
}

vxm_status vxm_cl_place_surface(vxm_opencl *engine, const vxm_surface *surface, vxm_error *error) {
  if (engine->surface_serial == surface->serial)
    return VXM_OK;
  engine->surface_serial = 0;
  vxm_status status =
      upload_points(engine, VXM_CL_SURFACE_POINTS, surface->points, surface->soup->vertex_count, error);
  if (status == VXM_OK && engine->surface_corners_serial != surface->corners_serial) {
    engine->surface_corners_serial = 0;
    status = vxm_cl_upload(engine, VXM_CL_SURFACE_CORNERS, surface->corners,
                           surface->triangle_count * 3 * sizeof *surface->corners, error);
    if (status == VXM_OK)
      engine->surface_corners_serial = surface->corners_serial;
  }
  if (status == VXM_OK)
    status = vxm_far_surface_find(&engine->far_surface, surface, error);
  if (status == VXM_OK)
    engine->surface_serial = surface->serial;
  return status;
}

vxm_status vxm_cl_passes_create(vxm_passes *out, vxm_opencl *engine, const vxm_window *window,
                                const vxm_unite_job *job, size_t most, vxm_error *error) {
  vxm_status status = vxm_passes_create(out, engine->base.context, window, job, 0, most, error);
  if (status == VXM_OK && out->order)
    status = vxm_cl_upload(engine, VXM_CL_ORDER, out->order, out->order_count * sizeof *out->order, error);
  if (status == VXM_OK && out->boxes)
    status = vxm_cl_upload(engine, VXM_CL_BOXES, out->boxes, out->box_count * sizeof *out->boxes, error);
  return status;
}

vxm_status vxm_cl_clear_large(vxm_opencl *engine, size_t facets, vxm_error *error) {
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_LARGE, (1 + facets) * sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_LARGE, sizeof(uint32_t), error);
  /* An argument has to be a buffer, also where facets are not looked up. */
  return status == VXM_OK ? vxm_cl_reserve(engine, VXM_CL_ORDER, sizeof(uint32_t), error) : status;
}
