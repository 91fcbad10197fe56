/* SPDX-License-Identifier: BSD-3-Clause */
/** EGL without a window system: on Mesa's surfaceless platform, and on devices (EGL_EXT_platform_device). */
#include "gpu/opengl/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <pthread.h>
#include <string.h>

#ifndef EGL_PLATFORM_SURFACELESS_MESA
#define EGL_PLATFORM_SURFACELESS_MESA 0x31DD
#endif

enum { DEVICES_MAX = 64 };

static struct {
  void *library;
  PFNEGLGETPROCADDRESSPROC getproc;
  PFNEGLQUERYSTRINGPROC query_string;
  PFNEGLINITIALIZEPROC initialize;
  PFNEGLBINDAPIPROC bind_api;
  PFNEGLQUERYAPIPROC query_api;
  PFNEGLCHOOSECONFIGPROC choose_config;
  PFNEGLCREATECONTEXTPROC create_context;
  PFNEGLDESTROYCONTEXTPROC destroy_context;
  PFNEGLMAKECURRENTPROC make_current;
  PFNEGLGETCURRENTCONTEXTPROC current_context;
  PFNEGLGETCURRENTDISPLAYPROC current_display;
  PFNEGLGETCURRENTSURFACEPROC current_surface;
  PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display;
  PFNEGLQUERYDEVICESEXTPROC query_devices;
  bool complete;
  const char *extensions; /**< of clients */
} egl;

static bool find(void *out, const char *name) {
  void *symbol = dlsym(egl.library, name);
  memcpy(out, &symbol, sizeof symbol);
  return symbol != NULL;
}

/** It stays loaded: drivers leave threads behind. */
static void load(void) {
  egl.library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!egl.library)
    return;
  egl.complete =
      find(&egl.getproc, "eglGetProcAddress") && find(&egl.query_string, "eglQueryString") &&
      find(&egl.initialize, "eglInitialize") && find(&egl.bind_api, "eglBindAPI") &&
      find(&egl.query_api, "eglQueryAPI") && find(&egl.choose_config, "eglChooseConfig") &&
      find(&egl.create_context, "eglCreateContext") && find(&egl.destroy_context, "eglDestroyContext") &&
      find(&egl.make_current, "eglMakeCurrent") && find(&egl.current_context, "eglGetCurrentContext") &&
      find(&egl.current_display, "eglGetCurrentDisplay") &&
      find(&egl.current_surface, "eglGetCurrentSurface");
  if (!egl.complete)
    return;
  __eglMustCastToProperFunctionPointerType function = egl.getproc("eglGetPlatformDisplayEXT");
  memcpy(&egl.platform_display, &function, sizeof function);
  function = egl.getproc("eglQueryDevicesEXT");
  memcpy(&egl.query_devices, &function, sizeof function);
  egl.extensions = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!egl.extensions)
    egl.extensions = "";
}

static bool has(const char *extension) {
  size_t length = strlen(extension);
  for (const char *at = egl.extensions; (at = strstr(at, extension)); at += length)
    if (at[length] == ' ' || at[length] == '\0')
      return true;
  return false;
}

static bool is_loaded(vxm_error *error) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, load);
  if (egl.complete && egl.platform_display)
    return true;
  vxm_fail(error, VXM_ERROR_UNAVAILABLE,
           "libEGL.so.1 is %s (Debian: libegl1 with a driver, such as libgl1-mesa-dri)",
           egl.library ? "too old" : "not installed");
  return false;
}

static int count_surfaceless(vxm_error *error) {
  if (!is_loaded(error))
    return 0;
  if (has("EGL_MESA_platform_surfaceless"))
    return 1;
  vxm_fail(error, VXM_ERROR_UNAVAILABLE,
           "EGL has no surfaceless platform (Debian: libegl-mesa0, libgl1-mesa-dri)");
  return 0;
}

static int devices(EGLDeviceEXT found[DEVICES_MAX], vxm_error *error) {
  EGLint count = 0;
  if (!is_loaded(error))
    return 0;
  if (has("EGL_EXT_platform_device") && egl.query_devices && egl.query_devices(DEVICES_MAX, found, &count) &&
      count > 0)
    return count;
  vxm_fail(error, VXM_ERROR_UNAVAILABLE, "EGL knows no device (Debian: libegl-mesa0, libgl1-mesa-dri)");
  return 0;
}

static int count_devices(vxm_error *error) {
  EGLDeviceEXT found[DEVICES_MAX];
  return devices(found, error);
}

static EGLContext make_context(EGLDisplay display, bool tells_resets) {
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               tells_resets ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
                               EGL_LOSE_CONTEXT_ON_RESET,
                               EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLContext context = egl.create_context(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) { /* without EGL_KHR_no_config_context */
    static const EGLint any[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLint count = 0;
    if (egl.choose_config(display, any, &config, 1, &count) && count == 1)
      context = egl.create_context(display, config, EGL_NO_CONTEXT, attributes);
  }
  return context;
}

/** Displays are shared by all contexts on them and stay initialized: ending one would end the others'. */
static vxm_status create_on(vxm_gl_context *out, EGLenum platform, void *native, vxm_error *error) {
  EGLDisplay display = egl.platform_display(platform, native, NULL);
  if (display == EGL_NO_DISPLAY || !egl.initialize(display, NULL, NULL))
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "EGL cannot open the display (no driver for it?)");
  if (!egl.bind_api(EGL_OPENGL_API))
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "EGL offers no OpenGL here");
  /* Only a context that asks for it is told when the driver was reset. */
  EGLContext context = make_context(display, true);
  if (context == EGL_NO_CONTEXT)
    context = make_context(display, false);
  if (context == EGL_NO_CONTEXT)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "EGL makes no context of OpenGL 4.3 here");
  out->display = display;
  out->handle = context;
  return VXM_OK;
}

static vxm_status create_surfaceless(vxm_gl_context *out, int index, vxm_error *error) {
  if (index != 0 || count_surfaceless(error) == 0)
    return VXM_ERROR_UNAVAILABLE;
  return create_on(out, EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, error);
}

static vxm_status create_on_device(vxm_gl_context *out, int index, vxm_error *error) {
  EGLDeviceEXT found[DEVICES_MAX];
  int count = devices(found, error);
  if (count == 0)
    return VXM_ERROR_UNAVAILABLE;
  if (index < 0 || index >= count)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "EGL has no device %d, only %d of them", index, count);
  return create_on(out, EGL_PLATFORM_DEVICE_EXT, found[index], error);
}

static bool enter(vxm_gl_context *context) {
  context->before[0] = egl.current_display();
  context->before[1] = egl.current_surface(EGL_DRAW);
  context->before[2] = egl.current_surface(EGL_READ);
  context->before[3] = egl.current_context();
  context->api_before = egl.query_api();
  return egl.bind_api(EGL_OPENGL_API) &&
         egl.make_current(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->handle);
}

static void leave(vxm_gl_context *context) {
  void **before = context->before;
  if (before[3] != EGL_NO_CONTEXT)
    egl.make_current(before[0], before[1], before[2], before[3]);
  else
    egl.make_current(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  egl.bind_api(context->api_before);
}

static void destroy(vxm_gl_context *context) {
  egl.destroy_context(context->display, context->handle);
}

static vxm_gl_function getproc(const char *name) {
  return egl.getproc(name);
}

const vxm_gl_driver vxm_gl_egl_surfaceless = {.name = "egl-surfaceless",
                                              .count = count_surfaceless,
                                              .create = create_surfaceless,
                                              .enter = enter,
                                              .leave = leave,
                                              .destroy = destroy,
                                              .getproc = getproc};

const vxm_gl_driver vxm_gl_egl_device = {.name = "egl-device",
                                         .count = count_devices,
                                         .create = create_on_device,
                                         .enter = enter,
                                         .leave = leave,
                                         .destroy = destroy,
                                         .getproc = getproc};
