/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/gl.h"

#include <string.h>

typedef struct entry {
  const char *name;
  size_t offset;
} entry;

static const entry entries[] = {
#define VXM_GL_ENTRY(UPPER, name) {"gl" #name, offsetof(vxm_gl, name)},
    VXM_GL_FUNCTIONS(VXM_GL_ENTRY)
#undef VXM_GL_ENTRY
};

vxm_status vxm_gl_load(vxm_gl *out, vxm_gl_getproc getproc, vxm_error *error) {
  memset(out, 0, sizeof *out);
  for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
    vxm_gl_function function = getproc(entries[i].name);
    if (!function)
      return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the OpenGL driver has no %s: OpenGL 4.3 is needed",
                      entries[i].name);
    memcpy((char *)out + entries[i].offset, &function, sizeof function);
  }
  vxm_gl_function reset = getproc("glGetGraphicsResetStatus");
  if (!reset)
    reset = getproc("glGetGraphicsResetStatusARB");
  memcpy(&out->GetGraphicsResetStatus, &reset, sizeof reset);
  return VXM_OK;
}

vxm_status vxm_gl_check(const vxm_gl *gl, const char *doing, vxm_error *error) {
  if (gl->GetGraphicsResetStatus && gl->GetGraphicsResetStatus() != GL_NO_ERROR)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "%s: the OpenGL context was lost (the driver was reset); use --engine cpu", doing);
  GLenum first = gl->GetError();
  if (first == GL_NO_ERROR)
    return VXM_OK;
  bool memory = first == GL_OUT_OF_MEMORY;
  /* There may be several, one flag each; a lost context may repeat one for ever. */
  for (int i = 0; i < 16; i++) {
    GLenum next = gl->GetError();
    if (next == GL_NO_ERROR)
      break;
    memory |= next == GL_OUT_OF_MEMORY;
  }
  if (memory)
    return vxm_fail(error, VXM_ERROR_MEMORY,
                    "%s: the OpenGL driver is out of memory; lower the resolution or use --engine cpu",
                    doing);
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s: the OpenGL driver reports error 0x%x; use --engine cpu",
                  doing, first);
}
