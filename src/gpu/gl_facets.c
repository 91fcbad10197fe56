/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl.h"

vxm_status vxm_gl_upload_points(vxm_opengl *engine, vxm_gl_buffer_id id, const vxm_point *points,
                                size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  int32_t(*narrow)[4] = vxm_alloc(engine->base.context, count, sizeof *narrow, &local);
  if (narrow)
    vxm_far_narrow(narrow, points, count);
  vxm_status status = narrow ? vxm_gl_upload(engine, id, narrow, count * sizeof *narrow, &local) : local.code;
  vxm_free(engine->base.context, narrow);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

static vxm_status upload_apexes(vxm_opengl *engine, const vxm_facets *facets, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t count = facets->facet_count;
  uint32_t *apex = vxm_alloc(engine->base.context, count, sizeof *apex, &local);
  for (size_t f = 0; apex && f < count; f++)
    apex[f] = vxm_apex_of(facets, facets->part[f]);
  vxm_status status =
      apex ? vxm_gl_upload(engine, VXM_GL_APEXES, apex, count * sizeof *apex, &local) : local.code;
  vxm_free(engine->base.context, apex);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

vxm_status vxm_gl_place(vxm_opengl *engine, const vxm_facets *facets, const vxm_placed *placed,
                        vxm_error *error) {
  vxm_status status = VXM_OK;
  if (engine->facets_serial != facets->serial) {
    engine->facets_serial = 0;
    status = vxm_gl_upload(engine, VXM_GL_CORNERS, facets->corners,
                           facets->facet_count * sizeof *facets->corners, error);
    if (status == VXM_OK && engine->base.wants_apexes)
      status = upload_apexes(engine, facets, error);
    if (status != VXM_OK)
      return status;
    engine->facets_serial = facets->serial;
  }
  if (engine->placed_serial == placed->serial)
    return VXM_OK;
  engine->placed_serial = 0;
  size_t count = facets->point_count;
  status = placed->wide
               ? vxm_gl_upload_points(engine, VXM_GL_POINTS, placed->wide, count, error)
               : vxm_gl_upload(engine, VXM_GL_POINTS, placed->narrow, count * sizeof *placed->narrow, error);
  if (status == VXM_OK)
    status = vxm_far_find(&engine->far, facets, placed, error);
  if (status == VXM_OK)
    engine->placed_serial = placed->serial;
  return status;
}

vxm_status vxm_gl_passes_create(vxm_passes *out, vxm_opengl *engine, const vxm_window *window,
                                const vxm_unite_job *job, vxm_error *error) {
  /* Slices move points, and the apex in any case a little. */
  double move = engine->options.displacement;
  int64_t margin = engine->base.wants_apexes ? (int64_t)(move < 1 << 20 ? move : 1 << 20) + 1 : 0;
  vxm_status status = vxm_passes_create(out, engine->base.context, window, job, margin, error);
  if (status == VXM_OK && out->order)
    status = vxm_gl_upload(engine, VXM_GL_ORDER, out->order, out->order_count * sizeof *out->order, error);
  if (status == VXM_OK && out->boxes)
    status = vxm_gl_upload(engine, VXM_GL_BOXES, out->boxes, out->box_count * sizeof *out->boxes, error);
  return status;
}
