/* SPDX-License-Identifier: BSD-3-Clause */
/** Contexts of OpenGL without a display: OSMesa, EGL without a surface, and EGL on a device. */
#ifndef VXM_GPU_OPENGL_GL_CONTEXT_H
#define VXM_GPU_OPENGL_GL_CONTEXT_H

#include "gpu/opengl/gl.h"

typedef struct vxm_gl_driver vxm_gl_driver;

/** A context. It is current in a thread only between enter and leave. */
typedef struct vxm_gl_context {
  const vxm_gl_driver *driver;
  void *handle, *display; /**< the driver's own */
  void *before[4];        /**< what was current in the thread before; OSMesa leaves nothing current */
  unsigned api_before;    /**< the same of EGL's interfaces */
  vxm_gl gl;
} vxm_gl_context;

/** How contexts are made by one library. */
struct vxm_gl_driver {
  const char *name; /**< such as "osmesa"; devices have their number behind it */
  /** How many of its kind there are, without making any: 0 or 1, or the number of devices. */
  int (*count)(vxm_error *error);
  /** Makes context number `index`, not yet current. */
  vxm_status (*create)(vxm_gl_context *out, int index, vxm_error *error);
  bool (*enter)(vxm_gl_context *context);
  void (*leave)(vxm_gl_context *context);
  void (*destroy)(vxm_gl_context *context);
  vxm_gl_function (*getproc)(const char *name);
};

extern const vxm_gl_driver vxm_gl_osmesa, vxm_gl_egl_surfaceless, vxm_gl_egl_device;

/** Makes a context and looks up its functions. Destroy with vxm_gl_context_destroy, also after a failure. */
vxm_status vxm_gl_context_create(vxm_gl_context *out, const vxm_gl_driver *driver, int index,
                                 vxm_error *error);
void vxm_gl_context_destroy(vxm_gl_context *context);

/** Makes it current in this thread. @return VXM_OK, VXM_ERROR_UNAVAILABLE */
vxm_status vxm_gl_enter(vxm_gl_context *context, vxm_error *error);
/** Gives the thread back what was current before. */
void vxm_gl_leave(vxm_gl_context *context);

#endif
