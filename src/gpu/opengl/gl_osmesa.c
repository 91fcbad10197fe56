/* SPDX-License-Identifier: BSD-3-Clause */
/** OSMesa: Mesa's renderer in software, off-screen. Its header left Mesa with version 25.1, the library with
 * it; older systems have both. */
#include "gpu/opengl/gl_context.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef void *(*create_fn)(const int *attributes, void *share);
typedef unsigned char (*make_current_fn)(void *context, void *buffer, unsigned type, int width, int height);
typedef void (*destroy_fn)(void *context);
typedef vxm_gl_function (*getproc_fn)(const char *name);

/* From the interface of OSMesa 11.2 and later. */
enum {
  OSMESA_FORMAT = 0x22,
  OSMESA_DEPTH_BITS = 0x30,
  OSMESA_PROFILE = 0x33,
  OSMESA_CORE_PROFILE = 0x34,
  OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
  OSMESA_CONTEXT_MINOR_VERSION = 0x37,
  OSMESA_RGBA = GL_RGBA
};

/** A context has to have a colour buffer, although all is drawn into others. */
enum { SIDE = 16 };

static struct {
  void *library;
  create_fn create;
  make_current_fn make_current;
  destroy_fn destroy;
  getproc_fn getproc;
} osmesa;

static void find(void *out, const char *name) {
  void *symbol = dlsym(osmesa.library, name);
  memcpy(out, &symbol, sizeof symbol);
}

/** It stays loaded: renderers leave threads behind. */
static void load(void) {
  static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
  for (size_t i = 0; i < sizeof names / sizeof names[0] && !osmesa.library; i++)
    osmesa.library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
  if (!osmesa.library)
    return;
  find(&osmesa.create, "OSMesaCreateContextAttribs");
  find(&osmesa.make_current, "OSMesaMakeCurrent");
  find(&osmesa.destroy, "OSMesaDestroyContext");
  find(&osmesa.getproc, "OSMesaGetProcAddress");
}

static bool is_loaded(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, load);
  return osmesa.create && osmesa.make_current && osmesa.destroy && osmesa.getproc;
}

static int count(vxm_error *error) {
  if (is_loaded())
    return 1;
  vxm_fail(error, VXM_ERROR_UNAVAILABLE, "libOSMesa.so.8 is not installed (Debian: libosmesa6)");
  return 0;
}

static vxm_status create(vxm_gl_context *out, int index, vxm_error *error) {
  static const int attributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_DEPTH_BITS,
                                   0,
                                   OSMESA_PROFILE,
                                   OSMESA_CORE_PROFILE,
                                   OSMESA_CONTEXT_MAJOR_VERSION,
                                   4,
                                   OSMESA_CONTEXT_MINOR_VERSION,
                                   3,
                                   0};
  if (index != 0 || count(error) == 0)
    return VXM_ERROR_UNAVAILABLE;
  out->display = calloc(SIDE * SIDE, 4);
  out->handle = out->display ? osmesa.create(attributes, NULL) : NULL;
  if (out->handle)
    return VXM_OK;
  free(out->display);
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "OSMesa makes no context of OpenGL 4.3");
}

static bool enter(vxm_gl_context *context) {
  return osmesa.make_current(context->handle, context->display, GL_UNSIGNED_BYTE, SIDE, SIDE);
}

static void leave(vxm_gl_context *context) {
  (void)context;
  osmesa.make_current(NULL, NULL, 0, 0, 0);
}

static void destroy(vxm_gl_context *context) {
  osmesa.destroy(context->handle);
  free(context->display);
}

static vxm_gl_function getproc(const char *name) {
  return osmesa.getproc(name);
}

const vxm_gl_driver vxm_gl_osmesa = {.name = "osmesa",
                                     .count = count,
                                     .create = create,
                                     .enter = enter,
                                     .leave = leave,
                                     .destroy = destroy,
                                     .getproc = getproc};
