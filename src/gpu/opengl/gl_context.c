/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/gl_context.h"

vxm_status vxm_gl_context_create(vxm_gl_context *out, const vxm_gl_driver *driver, int index,
                                 vxm_error *error) {
  *out = (vxm_gl_context){.driver = driver};
  vxm_status status = driver->create(out, index, error);
  if (status == VXM_OK)
    status = vxm_gl_enter(out, error);
  if (status != VXM_OK)
    return status;
  status = vxm_gl_load(&out->gl, driver->getproc, error);
  vxm_gl_leave(out);
  return status;
}

void vxm_gl_context_destroy(vxm_gl_context *context) {
  if (context->handle)
    context->driver->destroy(context);
  context->handle = NULL;
}

vxm_status vxm_gl_enter(vxm_gl_context *context, vxm_error *error) {
  if (context->driver->enter(context))
    return VXM_OK;
  return vxm_fail(
      error, VXM_ERROR_UNAVAILABLE,
      "opengl: the context of %s cannot be made current (it is in use in another thread, or lost)",
      context->driver->name);
}

void vxm_gl_leave(vxm_gl_context *context) {
  context->driver->leave(context);
}
