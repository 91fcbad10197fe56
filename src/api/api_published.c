/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of the published OpenCL program, and of the stages of an OpenCL engine: they check
 * arguments and call down. */
#include "base/sized.h"
#include "config.h"
#include "voxel/engine/engine.h"
#include "voxmend/experimental.h"

#ifdef HAVE_OPENCL
#include "gpu/opencl/faieghi.h"
#endif

#include <float.h>
#include <inttypes.h>
#include <string.h>

static bool is_opencl(const vxm_engine *engine) {
  return engine->ops && strncmp(engine->info.name, "opencl:", 7) == 0 && engine->info.devices == 1;
}

static vxm_status check(const vxm_engine *engine, const vxm_published_options *options, vxm_error *error) {
  if (!(options->voxel_size >= (double)FLT_MIN && options->voxel_size <= 1 / (double)FLT_MIN))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "published program: voxel size %g is not a positive number that a 32-bit float holds",
                    options->voxel_size);
  if (!is_opencl(engine))
    return vxm_fail(
        error, VXM_ERROR_UNAVAILABLE,
        "the published program needs an engine of OpenCL, and this one is %s; use --engine opencl",
        engine->info.name);
  return VXM_OK;
}

vxm_status vxm_published_create(vxm_published **out, vxm_space *space, vxm_engine *engine,
                                const vxm_mesh *mesh, const vxm_published_options *options,
                                vxm_error *error) {
  if (out)
    *out = NULL;
  if (space)
    *space = (vxm_space){0};
  if (!out || !engine || !mesh || !options)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "published program: an argument is NULL");
  vxm_published_options chosen = VXM_PUBLISHED_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "published program", error);
  if (status == VXM_OK)
    status = check(engine, &chosen, error);
#ifdef HAVE_OPENCL
  vxm_space local;
  chosen.material = chosen.material ? chosen.material : 1;
  if (status == VXM_OK)
    status =
        vxm_cl_published_create(out, space ? space : &local, vxm_opencl_of(engine), mesh, &chosen, error);
#endif
  return status;
}

vxm_status vxm_published_voxelize(vxm_published_report *report, vxm_published *published, vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!published)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "published program: an argument is NULL");
#ifdef HAVE_OPENCL
  vxm_published_report made = {0};
  vxm_status status = vxm_cl_published_voxelize(&made, published, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
#else
  return VXM_OK; /* there are none to voxelize */
#endif
}

vxm_status vxm_published_read(uint8_t *voxels, double *ms, vxm_published *published, vxm_transfer how,
                              vxm_error *error) {
  double local;
  ms = ms ? ms : &local;
  *ms = 0;
  if (!published)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "published program: an argument is NULL");
  if ((unsigned)how > VXM_TRANSFER_READ)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "published program: transfer %d is unknown", (int)how);
  if (how == VXM_TRANSFER_READ && !voxels)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "published program: voxels are read into memory, not into NULL");
#ifdef HAVE_OPENCL
  return vxm_cl_published_read(voxels, ms, published, how, error);
#else
  return VXM_OK;
#endif
}

void vxm_published_destroy(vxm_published *published) {
#ifdef HAVE_OPENCL
  vxm_cl_published_destroy(published);
#else
  (void)published;
#endif
}

vxm_status vxm_engine_measure(vxm_engine_stages *out, vxm_engine *engine, bool measure, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!engine)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "stages: an argument is NULL");
  if (!is_opencl(engine))
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "stages are those of an engine of OpenCL, and this one is %s", engine->info.name);
#ifdef HAVE_OPENCL
  vxm_opencl *opencl = vxm_opencl_of(engine);
  const vxm_cl_stages *s = &opencl->own_stages;
  vxm_engine_stages made = {.pairs_ms = s->pairs,
                            .sort_ms = s->sort,
                            .tiles_ms = s->tiles,
                            .pairs = (int64_t)s->pair_count,
                            .tiles = (int64_t)s->tile_count,
                            .active_ms = s->cells,
                            .construct_ms = s->construct,
                            .voxelize_ms = s->voxelize,
                            .propagate_ms = s->propagate,
                            .prune_ms = s->prune,
                            .active = (int64_t)s->cells_active,
                            .nodes = (int64_t)s->nodes};
  VXM_RESULT_WRITE(out, &made);
  opencl->own_stages = (vxm_cl_stages){0};
  opencl->stages = measure ? &opencl->own_stages : NULL;
#else
  (void)measure;
#endif
  return VXM_OK;
}
