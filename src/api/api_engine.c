/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of engines: they check arguments and call down. */
#include "base/sized.h"
#include "gpu/engines.h"

#include <math.h>
#include <string.h>

vxm_status vxm_engine_create(vxm_engine **out, vxm_context *context, const char *name,
                             const vxm_engine_options *options, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !name)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: an argument is NULL");
  vxm_engine_options chosen = VXM_ENGINE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "engine", error);
  if (status != VXM_OK)
    return status;
  if ((unsigned)chosen.gl_method > VXM_GL_TETRA_VERTEX)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: method %d is unknown", (int)chosen.gl_method);
  if ((unsigned)chosen.cl_method > VXM_CL_TILES)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: OpenCL method %d is unknown", (int)chosen.cl_method);
  if (chosen.slice_axis < 0 || chosen.slice_axis > 2)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: slice axis %d is none of 0, 1, 2", chosen.slice_axis);
  if (!(chosen.displacement >= 0) || !isfinite(chosen.displacement))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engine: displacement %g is not 0 or more",
                    chosen.displacement);
  if (chosen.displacement > 0 &&
      (strncmp(name, "opengl", strlen("opengl")) != 0 || chosen.gl_method == VXM_GL_COLUMNS))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "engine: only OpenGL's slicing methods displace vertices, not '%.40s'", name);
  return vxm_engines_make(out, context, name, &chosen, error);
}

const vxm_engine_info *vxm_engine_describe(const vxm_engine *engine) {
  return engine ? &engine->info : NULL;
}

vxm_status vxm_engines_find(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_error *error) {
  if (count)
    *count = 0;
  if (!count || capacity < 0 || (capacity > 0 && !out))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "engines: an argument is NULL or negative");
  vxm_context *context;
  vxm_status status = vxm_context_acquire(&context, NULL, error);
  if (status != VXM_OK)
    return status;
  vxm_engine_info *made = NULL;
  status = vxm_engines_list(NULL, 0, count, context, error);
  int64_t room = capacity < *count ? capacity : *count;
  if (status == VXM_OK && room > 0) {
    made = vxm_try_calloc(context, (size_t)room, sizeof *made, &status, error);
    if (made)
      status = vxm_engines_list(made, room, count, context, error);
  }
  for (int64_t i = 0; status == VXM_OK && i < room; i++)
    VXM_RESULT_WRITE((vxm_engine_info *)((char *)out + (size_t)i * vxm_result_stride(out, sizeof *made)),
                     &made[i]);
  vxm_free(context, made);
  vxm_context_release(context);
  return status;
}
