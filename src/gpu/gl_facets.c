/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl.h"

/** Differences of facets that the shaders do: shaders/crossing.glsl. */
static const int64_t reach = INT64_C(1) << 20;

static bool is_far_point(const vxm_point *p) {
  for (int a = 0; a < 3; a++)
    if (p->at[a] >= VXM_NARROW_MAX || p->at[a] <= -VXM_NARROW_MAX)
      return true;
  return false;
}

bool vxm_gl_is_far(const vxm_point *a, const vxm_point *b, const vxm_point *c) {
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

static bool is_far(const vxm_placed *placed, const uint32_t corners[3]) {
  vxm_point a = vxm_placed_at(placed, corners[0]), b = vxm_placed_at(placed, corners[1]);
  vxm_point c = vxm_placed_at(placed, corners[2]);
  return vxm_gl_is_far(&a, &b, &c);
}

/** Whether all points lie so close together that no facet can be far. */
static bool are_all_near(const vxm_placed *placed, size_t count) {
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

static vxm_status list_far(vxm_opengl *engine, const vxm_facets *facets, const vxm_placed *placed,
                           vxm_error *error) {
  engine->far_count = 0;
  if (are_all_near(placed, facets->point_count))
    return VXM_OK;
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < facets->facet_count && status == VXM_OK; f++) {
    if (!is_far(placed, facets->corners[f]))
      continue;
    status = vxm_grow(engine->base.context, (void **)&engine->far, &engine->far_capacity,
                      engine->far_count + 1, sizeof *engine->far, error);
    if (status == VXM_OK)
      engine->far[engine->far_count++] = (uint32_t)f;
  }
  return status;
}

vxm_status vxm_gl_upload_points(vxm_opengl *engine, vxm_gl_buffer_id id, const vxm_point *points,
                                size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  int32_t(*narrow)[4] = vxm_alloc(engine->base.context, count, sizeof *narrow, &local);
  for (size_t p = 0; narrow && p < count; p++) {
    narrow[p][3] = is_far_point(&points[p]);
    for (int a = 0; a < 3; a++)
      narrow[p][a] = narrow[p][3] ? 0 : (int32_t)points[p].at[a];
  }
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
    status = list_far(engine, facets, placed, error);
  if (status == VXM_OK)
    engine->placed_serial = placed->serial;
  return status;
}
