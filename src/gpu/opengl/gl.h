/* SPDX-License-Identifier: BSD-3-Clause */
/** The functions of OpenGL 4.3 that are used, looked up in the driver at run time: nothing is linked. */
#ifndef VXM_GPU_OPENGL_GL_H
#define VXM_GPU_OPENGL_GL_H

#include "base/error.h"

#include <GL/glcorearb.h>

/* X(name in capitals as in PFNGL...PROC, name) */
#define VXM_GL_FUNCTIONS(X)                           \
  X(ATTACHSHADER, AttachShader)                       \
  X(BINDBUFFER, BindBuffer)                           \
  X(BINDBUFFERBASE, BindBufferBase)                   \
  X(BINDFRAMEBUFFER, BindFramebuffer)                 \
  X(BINDIMAGETEXTURE, BindImageTexture)               \
  X(BINDTEXTURE, BindTexture)                         \
  X(BINDVERTEXARRAY, BindVertexArray)                 \
  X(BUFFERDATA, BufferData)                           \
  X(BUFFERSUBDATA, BufferSubData)                     \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)   \
  X(CLEARBUFFERDATA, ClearBufferData)                 \
  X(CLEARBUFFERFV, ClearBufferfv)                     \
  X(CLEARBUFFERUIV, ClearBufferuiv)                   \
  X(CLIENTWAITSYNC, ClientWaitSync)                   \
  X(COMPILESHADER, CompileShader)                     \
  X(COPYBUFFERSUBDATA, CopyBufferSubData)             \
  X(CREATEPROGRAM, CreateProgram)                     \
  X(CREATESHADER, CreateShader)                       \
  X(DELETEBUFFERS, DeleteBuffers)                     \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)           \
  X(DELETEPROGRAM, DeleteProgram)                     \
  X(DELETESHADER, DeleteShader)                       \
  X(DELETESYNC, DeleteSync)                           \
  X(DELETETEXTURES, DeleteTextures)                   \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)           \
  X(DISABLE, Disable)                                 \
  X(DISPATCHCOMPUTE, DispatchCompute)                 \
  X(DRAWARRAYS, DrawArrays)                           \
  X(DRAWARRAYSINDIRECT, DrawArraysIndirect)           \
  X(DRAWBUFFERS, DrawBuffers)                         \
  X(ENABLE, Enable)                                   \
  X(FENCESYNC, FenceSync)                             \
  X(FINISH, Finish)                                   \
  X(FLUSH, Flush)                                     \
  X(FRAMEBUFFERPARAMETERI, FramebufferParameteri)     \
  X(FRAMEBUFFERTEXTURELAYER, FramebufferTextureLayer) \
  X(GENBUFFERS, GenBuffers)                           \
  X(GENFRAMEBUFFERS, GenFramebuffers)                 \
  X(GENTEXTURES, GenTextures)                         \
  X(GENVERTEXARRAYS, GenVertexArrays)                 \
  X(GETBUFFERSUBDATA, GetBufferSubData)               \
  X(GETERROR, GetError)                               \
  X(GETINTEGER64V, GetInteger64v)                     \
  X(GETINTEGERV, GetIntegerv)                         \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
  X(GETPROGRAMIV, GetProgramiv)                       \
  X(GETSHADERINFOLOG, GetShaderInfoLog)               \
  X(GETSHADERIV, GetShaderiv)                         \
  X(GETSTRING, GetString)                             \
  X(GETSTRINGI, GetStringi)                           \
  X(LINKPROGRAM, LinkProgram)                         \
  X(LOGICOP, LogicOp)                                 \
  X(MAPBUFFERRANGE, MapBufferRange)                   \
  X(MEMORYBARRIER, MemoryBarrier)                     \
  X(PIXELSTOREI, PixelStorei)                         \
  X(READPIXELS, ReadPixels)                           \
  X(SHADERSOURCE, ShaderSource)                       \
  X(TEXPARAMETERI, TexParameteri)                     \
  X(TEXSTORAGE3D, TexStorage3D)                       \
  X(UNIFORM1I, Uniform1i)                             \
  X(UNIFORM1UI, Uniform1ui)                           \
  X(UNIFORM4I, Uniform4i)                             \
  X(UNIFORM4UI, Uniform4ui)                           \
  X(UNMAPBUFFER, UnmapBuffer)                         \
  X(USEPROGRAM, UseProgram)                           \
  X(VIEWPORT, Viewport)

typedef struct vxm_gl {
#define VXM_GL_FIELD(UPPER, name) PFNGL##UPPER##PROC name;
  VXM_GL_FUNCTIONS(VXM_GL_FIELD)
#undef VXM_GL_FIELD
  PFNGLGETGRAPHICSRESETSTATUSPROC GetGraphicsResetStatus; /**< NULL where the driver has none */
} vxm_gl;

typedef void (*vxm_gl_function)(void);
typedef vxm_gl_function (*vxm_gl_getproc)(const char *name);

/** Looks up all functions. @return VXM_OK; VXM_ERROR_UNAVAILABLE with the first that is missing */
vxm_status vxm_gl_load(vxm_gl *out, vxm_gl_getproc getproc, vxm_error *error);

/** Turns what OpenGL reports since the last time into a status. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_UNAVAILABLE (the context is lost, or the driver refused something) */
vxm_status vxm_gl_check(const vxm_gl *gl, const char *doing, vxm_error *error);

#endif
