/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/mesh_analysis.h"

#include <time.h>

static void chain_once_begin(vxm_chain_once *once, vxm_context *context) {
  pthread_mutex_init(&once->mutex, NULL);
  once->chain.context = context;
}

static void chain_once_end(vxm_chain_once *once) {
  vxm_winding_chain_destroy(&once->chain);
  pthread_mutex_destroy(&once->mutex);
}

vxm_status vxm_mesh_analysis_create(vxm_mesh_analysis *out, const vxm_soup *soup, vxm_split_rule rule,
                                    bool overlaps, vxm_error *error) {
  vxm_context *context = soup->context;
  *out = (vxm_mesh_analysis){.context = context,
                             .soup = soup,
                             .triangles = {.context = context},
                             .self_overlap.chain.context = context};
  vxm_status status = VXM_OK;
  out->orientation = vxm_try_calloc(context, 1, sizeof *out->orientation, &status, error);
  if (!out->orientation)
    return status;
  chain_once_begin(&out->orientation->open, context);
  chain_once_begin(&out->orientation->all, context);
  status = vxm_triangle_set_create(&out->triangles, soup, rule, error);
  if (status != VXM_OK)
    return status;
  if (out->triangles.triangle_count == 0)
    return vxm_fail(error, VXM_ERROR_EMPTY,
                    "the mesh has no face with three different corners, so there is nothing to voxelize");
  /* A cavity that is kept may be wound as what is around it is: then it is wound twice, and meant to be
   * hollow. */
  overlaps &= rule.cavities != VXM_CAVITIES_KEEP || out->triangles.split.cavity_count == 0;
  return overlaps ? vxm_self_overlap_find(&out->self_overlap, &out->triangles, error) : VXM_OK;
}

void vxm_mesh_analysis_destroy(vxm_mesh_analysis *analysis) {
  if (!analysis->orientation)
    return;
  chain_once_end(&analysis->orientation->open);
  chain_once_end(&analysis->orientation->all);
  vxm_free(analysis->context, analysis->orientation);
  vxm_self_overlap_destroy(&analysis->self_overlap);
  vxm_triangle_set_destroy(&analysis->triangles);
  *analysis = (vxm_mesh_analysis){.context = analysis->context};
}

/** Locks, and asks now and then whether to go on waiting: what another thread makes may take long. */
static vxm_status lock(pthread_mutex_t *mutex, vxm_context *context, vxm_error *error) {
  enum { WAIT_NS = 20000000 };
  vxm_status status = VXM_OK;
  while (status == VXM_OK && pthread_mutex_trylock(mutex) != 0) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += WAIT_NS;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    if (pthread_mutex_timedlock(mutex, &until) == 0)
      break;
    status = vxm_check_cancelled(context, error);
  }
  return status;
}

static vxm_status make_chain(vxm_winding_chain *out, const vxm_mesh_analysis *analysis,
                             vxm_facing_finder find, void *payload, vxm_error *error) {
  vxm_facings facings = {.context = analysis->context};
  vxm_status status = find(&facings, analysis, payload, error);
  if (status == VXM_OK)
    status = vxm_oriented_chain_create(out, &analysis->triangles, &facings, error);
  vxm_facings_destroy(&facings);
  return status;
}

vxm_status vxm_chain_once_get(const vxm_winding_chain **out, vxm_chain_once *once,
                              const vxm_mesh_analysis *analysis, vxm_facing_finder find, void *payload,
                              vxm_error *error) {
  vxm_status status = lock(&once->mutex, analysis->context, error);
  if (status != VXM_OK)
    return status;
  if (!once->chain.closed)
    status = make_chain(&once->chain, analysis, find, payload, error);
  pthread_mutex_unlock(&once->mutex);
  *out = &once->chain;
  return status;
}
