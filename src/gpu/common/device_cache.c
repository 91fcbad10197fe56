/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/device_cache.h"

vxm_device_cache vxm_device_cache_of(vxm_engine *engine, vxm_device_cache_upload upload,
                                     vxm_device_cache_release release) {
  return (vxm_device_cache){.engine = engine,
                            .upload = upload,
                            .release = release,
                            .oversized.context = engine->context,
                            .oversized_surface.context = engine->context};
}

void vxm_device_cache_destroy(vxm_device_cache *cache) {
  vxm_oversized_destroy(&cache->oversized);
  vxm_oversized_surface_destroy(&cache->oversized_surface);
}

static vxm_status put(vxm_device_cache *cache, vxm_device_cache_id id, const void *data, size_t bytes,
                      vxm_error *error) {
  return cache->upload(cache->engine, id, 0, data, bytes, error);
}

/* ---- Triangles ---- */

/** Brings points in 32 bits; those that do not fit are marked. */
static vxm_status put_points(vxm_device_cache *cache, vxm_device_cache_id id, const vxm_point *points,
                             size_t count, vxm_error *error) {
  vxm_context *context = cache->engine->context;
  vxm_error local = VXM_ERROR_INIT;
  int32_t(*narrow)[4] = vxm_alloc(context, count, sizeof *narrow, &local);
  if (narrow)
    vxm_oversized_narrow(narrow, points, count);
  vxm_status status = narrow ? put(cache, id, narrow, count * sizeof *narrow, &local) : local.code;
  vxm_free(context, narrow);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status put_apexes(vxm_device_cache *cache, const vxm_triangle_set *triangles, vxm_error *error) {
  vxm_context *context = cache->engine->context;
  vxm_error local = VXM_ERROR_INIT;
  size_t count = triangles->triangle_count;
  uint32_t *apex = vxm_alloc(context, count, sizeof *apex, &local);
  for (size_t f = 0; apex && f < count; f++)
    apex[f] = vxm_apex_of(triangles, triangles->part[f]);
  vxm_status status = apex ? put(cache, VXM_CACHED_APEXES, apex, count * sizeof *apex, &local) : local.code;
  vxm_free(context, apex);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status put_corners(vxm_device_cache *cache, const vxm_triangle_set *triangles, vxm_error *error) {
  if (cache->triangles_serial == triangles->serial)
    return VXM_OK;
  cache->triangles_serial = 0;
  vxm_status status = put(cache, VXM_CACHED_CORNERS, triangles->corners,
                          triangles->triangle_count * sizeof *triangles->corners, error);
  if (status == VXM_OK && cache->engine->wants_apexes)
    status = put_apexes(cache, triangles, error);
  if (status == VXM_OK)
    cache->triangles_serial = triangles->serial;
  return status;
}

vxm_status vxm_device_cache_triangles(vxm_device_cache *cache, const vxm_triangle_set *triangles,
                                      const vxm_snapped_points *placed, vxm_error *error) {
  vxm_status status = put_corners(cache, triangles, error);
  if (status != VXM_OK || cache->placed_serial == placed->serial)
    return status;
  cache->placed_serial = 0;
  size_t count = triangles->point_count;
  status = placed->wide
               ? put_points(cache, VXM_CACHED_POINTS, placed->wide, count, error)
               : put(cache, VXM_CACHED_POINTS, placed->narrow, count * sizeof *placed->narrow, error);
  if (status == VXM_OK)
    status = vxm_oversized_find(&cache->oversized, triangles, placed, error);
  if (status == VXM_OK)
    cache->placed_serial = placed->serial;
  return status;
}

vxm_status vxm_device_cache_surface(vxm_device_cache *cache, const vxm_surface *surface, vxm_error *error) {
  if (cache->surface_serial == surface->serial)
    return VXM_OK;
  cache->surface_serial = 0;
  size_t count = surface->soup->vertex_count;
  vxm_status status =
      surface->wide
          ? put_points(cache, VXM_CACHED_SURFACE_POINTS, surface->wide, count, error)
          : put(cache, VXM_CACHED_SURFACE_POINTS, surface->narrow, count * sizeof *surface->narrow, error);
  if (status == VXM_OK && cache->surface_corners_serial != surface->corners_serial) {
    cache->surface_corners_serial = 0;
    status = put(cache, VXM_CACHED_SURFACE_CORNERS, surface->corners,
                 surface->triangle_count * 3 * sizeof *surface->corners, error);
    if (status == VXM_OK)
      cache->surface_corners_serial = surface->corners_serial;
  }
  if (status == VXM_OK)
    status = vxm_oversized_surface_find(&cache->oversized_surface, surface, error);
  if (status == VXM_OK)
    cache->surface_serial = surface->serial;
  return status;
}

vxm_status vxm_device_cache_passes(vxm_disjoint_passes *out, vxm_device_cache *cache,
                                   const vxm_window *window, const vxm_parity_union_job *job, int64_t margin,
                                   size_t most, vxm_error *error) {
  vxm_status status =
      vxm_disjoint_passes_create(out, cache->engine->context, window, job, margin, most, error);
  if (status == VXM_OK && out->order)
    status = put(cache, VXM_CACHED_ORDER, out->order, out->order_count * sizeof *out->order, error);
  if (status == VXM_OK && out->boxes)
    status = put(cache, VXM_CACHED_BOXES, out->boxes, out->box_count * sizeof *out->boxes, error);
  return status;
}

/* ---- Variants ---- */

static vxm_status put_originals(vxm_device_cache *cache, const vxm_vertex_transform *motion,
                                vxm_error *error) {
  if (cache->originals_serial == motion->from_serial)
    return VXM_OK;
  cache->originals_serial = 0;
  vxm_status status =
      put(cache, VXM_CACHED_ORIGINALS, motion->from, motion->count * sizeof *motion->from, error);
  /* A shader has to have a buffer also where it does not read it. */
  if (status == VXM_OK)
    status = put(cache, VXM_CACHED_ENTRIES, motion->entry,
                 motion->entry ? motion->count * sizeof *motion->entry : sizeof *motion->entry, error);
  if (status == VXM_OK)
    cache->originals_serial = motion->from_serial;
  return status;
}

static vxm_status put_noise(vxm_device_cache *cache, const vxm_vertex_transform *motion, vxm_error *error) {
  if (!motion->entry)
    return put(cache, VXM_CACHED_NOISE, NULL, sizeof *motion->noise, error);
  if (cache->noise_serial == motion->noise_serial)
    return VXM_OK;
  cache->noise_serial = 0;
  vxm_status status =
      put(cache, VXM_CACHED_NOISE, motion->noise, motion->noise_size * sizeof *motion->noise, error);
  if (status == VXM_OK)
    cache->noise_serial = motion->noise_serial;
  return status;
}

/** Whether there is room for it beside all that is to come: it takes no more than a quarter of what is left.
 */
static bool has_room(const vxm_device_cache *cache, const vxm_vertex_transform *motion) {
  size_t bytes = 0;
  if (cache->originals_serial != motion->from_serial)
    bytes += motion->count * (sizeof *motion->from + sizeof *motion->entry);
  if (motion->entry && cache->noise_serial != motion->noise_serial)
    bytes += motion->noise_size * sizeof *motion->noise;
  return bytes <= vxm_memory_left(cache->engine->context) / 4;
}

bool vxm_device_cache_motion(vxm_device_cache *cache, const vxm_vertex_transform *motion, size_t points) {
  static const vxm_device_cache_id own[] = {VXM_CACHED_ORIGINALS, VXM_CACHED_ENTRIES, VXM_CACHED_NOISE};
  cache->placed_serial = 0;
  if (motion->from_serial != 0 && motion->count <= UINT32_MAX / 3 && has_room(cache, motion) &&
      put_originals(cache, motion, NULL) == VXM_OK && put_noise(cache, motion, NULL) == VXM_OK &&
      put(cache, VXM_CACHED_POINTS, NULL, points * sizeof(int32_t[4]), NULL) == VXM_OK)
    return true;
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    cache->release(cache->engine, own[i]);
  cache->originals_serial = cache->noise_serial = 0;
  return false;
}

vxm_status vxm_device_cache_moved(vxm_device_cache *cache, vxm_snapped_points *placed,
                                  const vxm_move_job *job, bool *done, vxm_error *error) {
  const vxm_triangle_set *triangles = job->triangles;
  size_t first = triangles->first_apex, size = sizeof *placed->narrow;
  vxm_engine_info *info = &cache->engine->info;
  size_t *tried = &cache->tried[job->motion->entry != NULL];
  if (!vxm_snapped_points_take(placed, triangles))
    return VXM_OK;
  if (*tried < VXM_MOVED_TRIED) {
    *tried += job->motion->count;
    info->moves = vxm_device_transform_alike(placed, job->motion);
    if (!info->moves)
      return VXM_OK;
  }
  vxm_snapped_points_apexes(placed, triangles, job->apexes);
  vxm_status status = cache->upload(cache->engine, VXM_CACHED_POINTS, first * size, placed->narrow + first,
                                    (triangles->point_count - first) * size, error);
  if (status == VXM_OK)
    status = vxm_oversized_find(&cache->oversized, triangles, placed, error);
  if (status == VXM_OK)
    cache->placed_serial = placed->serial;
  *done = status == VXM_OK;
  return status;
}
