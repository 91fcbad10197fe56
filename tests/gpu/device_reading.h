/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels on a device as another program would read them: by the driver's own functions, looked up here. */
#ifndef TEST_GPU_DEVICE_READING_H
#define TEST_GPU_DEVICE_READING_H

#include "config.h"

#include <dlfcn.h>
#include <stdint.h>
#include <string.h>

static inline void read_symbol(void *out, const char *library, const char *name) {
  void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL), *symbol = handle ? dlsym(handle, name) : NULL;
  assert_non_null(symbol);
  memcpy(out, &symbol, sizeof symbol);
}

#ifdef HAVE_OPENCL
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#define CL_SYMBOL(name)           \
  __typeof__(&cl##name) my##name; \
  read_symbol(&my##name, "libOpenCL.so.1", "cl" #name)

/** Copies a buffer through a queue of the reader's own. */
static inline void read_buffer(void *out, void *within, void *device, void *buffer, size_t bytes) {
  CL_SYMBOL(CreateCommandQueue);
  CL_SYMBOL(EnqueueReadBuffer);
  CL_SYMBOL(ReleaseCommandQueue);
  cl_int code = CL_SUCCESS;
  cl_command_queue queue = myCreateCommandQueue(within, device, 0, &code);
  assert_int_equal(code, CL_SUCCESS);
  assert_int_equal(myEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, bytes, out, 0, NULL, NULL), CL_SUCCESS);
  myReleaseCommandQueue(queue);
}

/** Who else holds a buffer; changed by `change`, 1 or -1, before. */
static inline cl_uint buffer_holders(void *buffer, int change) {
  CL_SYMBOL(GetMemObjectInfo);
  CL_SYMBOL(RetainMemObject);
  CL_SYMBOL(ReleaseMemObject);
  cl_uint count = 0;
  if (change > 0)
    myRetainMemObject(buffer);
  assert_int_equal(myGetMemObjectInfo(buffer, CL_MEM_REFERENCE_COUNT, sizeof count, &count, NULL),
                   CL_SUCCESS);
  if (change < 0)
    myReleaseMemObject(buffer);
  return count;
}

static inline size_t buffer_bytes(void *buffer) {
  CL_SYMBOL(GetMemObjectInfo);
  size_t bytes = 0;
  assert_int_equal(myGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof bytes, &bytes, NULL), CL_SUCCESS);
  return bytes;
}
#endif

#ifdef HAVE_OPENGL
#include <EGL/egl.h>
#include <GL/glcorearb.h>

static char osmesa_pixels[16 * 16 * 4];

static inline void gl_symbol(void *out, bool is_osmesa, const char *name) {
  __eglMustCastToProperFunctionPointerType (*getproc)(const char *);
  read_symbol(&getproc, is_osmesa ? "libOSMesa.so.8" : "libEGL.so.1",
              is_osmesa ? "OSMesaGetProcAddress" : "eglGetProcAddress");
  __eglMustCastToProperFunctionPointerType symbol = getproc(name);
  assert_non_null(symbol);
  memcpy(out, &symbol, sizeof symbol);
}

/** Makes the context current, or none. */
static inline void gl_current(bool is_osmesa, void *display, void *within) {
  if (is_osmesa) {
    unsigned char (*make_current)(void *, void *, unsigned, int, int);
    read_symbol(&make_current, "libOSMesa.so.8", "OSMesaMakeCurrent");
    make_current(within, within ? osmesa_pixels : NULL, GL_UNSIGNED_BYTE, within ? 16 : 0, within ? 16 : 0);
    return;
  }
  PFNEGLMAKECURRENTPROC make_current;
  PFNEGLBINDAPIPROC bind_api;
  read_symbol(&make_current, "libEGL.so.1", "eglMakeCurrent");
  read_symbol(&bind_api, "libEGL.so.1", "eglBindAPI");
  bind_api(EGL_OPENGL_API);
  assert_true(make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, within));
}

static inline bool is_texture(bool is_osmesa, void *display, void *within, uint32_t texture) {
  PFNGLISTEXTUREPROC ask;
  gl_symbol(&ask, is_osmesa, "glIsTexture");
  gl_current(is_osmesa, display, within);
  bool is_one = ask(texture);
  gl_current(is_osmesa, display, NULL);
  return is_one;
}

/** All texels of a 3D texture, and of which size it is. */
static inline void read_texture(void *out, GLint size[3], bool is_osmesa, void *display, void *within,
                                uint32_t texture, GLenum format, GLenum type) {
  PFNGLBINDTEXTUREPROC bind;
  PFNGLGETTEXIMAGEPROC get;
  PFNGLGETTEXLEVELPARAMETERIVPROC measure;
  PFNGLPIXELSTOREIPROC store;
  PFNGLGETERRORPROC error;
  gl_symbol(&bind, is_osmesa, "glBindTexture");
  gl_symbol(&get, is_osmesa, "glGetTexImage");
  gl_symbol(&measure, is_osmesa, "glGetTexLevelParameteriv");
  gl_symbol(&store, is_osmesa, "glPixelStorei");
  gl_symbol(&error, is_osmesa, "glGetError");
  gl_current(is_osmesa, display, within);
  bind(GL_TEXTURE_3D, texture);
  measure(GL_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &size[0]);
  measure(GL_TEXTURE_3D, 0, GL_TEXTURE_HEIGHT, &size[1]);
  measure(GL_TEXTURE_3D, 0, GL_TEXTURE_DEPTH, &size[2]);
  store(GL_PACK_ALIGNMENT, 1);
  get(GL_TEXTURE_3D, 0, format, type, out);
  bind(GL_TEXTURE_3D, 0);
  assert_int_equal(error(), GL_NO_ERROR);
  gl_current(is_osmesa, display, NULL);
}
#endif

#endif
