/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels that stay in a 3D texture of the engine's context: shaders/device_voxels.comp. */
#include "gpu/opengl/gl_solid.h"

/** A texture lives in the context of its engine, which it holds. */
typedef struct gl_voxels {
  vxm_device_voxels base; /**< first, so that it is one */
  vxm_opengl *engine;
} gl_voxels;

static void release(vxm_device_voxels *voxels) {
  vxm_opengl *engine = ((gl_voxels *)voxels)->engine;
  bool is_there = engine->base.ops != NULL; /* else the context is gone, and the texture with it */
  if (is_there && voxels->info.texture && vxm_gl_enter(&engine->context, NULL) == VXM_OK) {
    engine->context.gl.DeleteTextures(1, &voxels->info.texture);
    vxm_gl_leave(&engine->context);
  }
  vxm_engine_destroy(&engine->base);
}

static GLenum format_of(vxm_voxel_format format) {
  return format == VXM_VOXEL_FORMAT_UINT8 ? GL_R8UI : format == VXM_VOXEL_FORMAT_FLOAT32 ? GL_R32F : GL_R32UI;
}

static vxm_status measure(vxm_device_info *info, const vxm_opengl *engine, vxm_error *error) {
  GLint most = 0;
  engine->context.gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  size_t element = vxm_voxel_format_bytes(info->format);
  info->bytes = element == 0 ? (int64_t)sizeof(uint32_t) : (int64_t)element;
  for (int a = 0; a < 3; a++) {
    info->texels[a] = a == 0 && element == 0 ? (info->dims[0] + 31) / 32 : info->dims[a];
    info->bytes *= info->texels[a]; /* of 2^20 voxels along an axis at most */
    if (info->texels[a] > most)
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "%lld texels are more than the %d that %s gives to a 3D texture along an axis",
                      (long long)info->texels[a], most, engine->base.info.renderer);
  }
  return VXM_OK;
}

static vxm_status make_texture(vxm_opengl *engine, vxm_device_voxels *made, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  vxm_device_info *info = &made->info;
  vxm_status status = vxm_memory_take(made->context, (size_t)info->bytes, error);
  if (status != VXM_OK)
    return status;
  made->bytes = (size_t)info->bytes;
  gl->GenTextures(1, &info->texture);
  gl->BindTexture(GL_TEXTURE_3D, info->texture);
  gl->TexStorage3D(GL_TEXTURE_3D, 1, info->texture_format, (GLsizei)info->texels[0], (GLsizei)info->texels[1],
                   (GLsizei)info->texels[2]);
  gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST); /* of whole numbers none other is */
  gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl->BindTexture(GL_TEXTURE_3D, 0);
  status = vxm_gl_check(gl, "opengl: making a texture", error);
  if (status != VXM_OK) { /* here, as the context is the engine's now: `release` would enter it again */
    gl->DeleteTextures(1, &info->texture);
    info->texture = 0;
  }
  return status;
}

static vxm_status make(vxm_opengl *engine, vxm_device_voxels **out, vxm_device_info *info, vxm_error *error) {
  vxm_context *context = engine->base.context;
  vxm_status status = measure(info, engine, error);
  if (status != VXM_OK)
    return status;
  gl_voxels *made = vxm_try_calloc(context, 1, sizeof *made, &status, error);
  if (!made)
    return status;
  status = vxm_context_acquire(&made->base.context, context, error);
  made->base.info = *info;
  made->base.layout = (vxm_layout)VXM_LAYOUT_GRID;
  made->base.release = release;
  made->engine = engine;
  atomic_init(&made->base.reference_count, 1);
  atomic_fetch_add(&engine->base.reference_count, 1);
  if (status == VXM_OK)
    status = make_texture(engine, &made->base, error);
  if (status == VXM_OK)
    *out = &made->base;
  else
    vxm_device_voxels_drop(&made->base);
  return status;
}

vxm_status vxm_gl_device_voxels(vxm_engine *base, vxm_device_voxels **out, const vxm_device_info *shape,
                                vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_device_info info = *shape;
  bool is_osmesa = engine->context.driver == &vxm_gl_osmesa;
  if (info.count != 1)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "variants stay on OpenCL devices only, and this engine is %s; use --engine opencl",
                    base->info.name);
  info.kind = is_osmesa ? VXM_DEVICE_OSMESA : VXM_DEVICE_EGL;
  info.context = engine->context.handle;
  info.display = is_osmesa ? NULL : engine->context.display;
  info.texture_format = format_of(info.format);
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = make(engine, out, &info, error);
  vxm_gl_leave(&engine->context);
  return status;
}

/* ---- A window that stays ---- */

vxm_status vxm_gl_device_voxels_begin(vxm_engine *base, const vxm_window *window, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_gl_reserve(engine, VXM_GL_STAYING, vxm_window_bytes(window), error);
  if (status == VXM_OK) {
    gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[VXM_GL_STAYING].name);
    gl->ClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  }
  vxm_gl_leave(&engine->context);
  return status;
}

static vxm_status copy(vxm_opengl *engine, vxm_gl_buffer_id from, size_t from_at, vxm_gl_buffer_id to,
                       size_t to_at, size_t bytes, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl->BindBuffer(GL_COPY_READ_BUFFER, engine->buffers[from].name);
  gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[to].name);
  gl->CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, (GLintptr)from_at, (GLintptr)to_at,
                        (GLsizeiptr)bytes);
  return vxm_gl_check(gl, "opengl: copying a buffer", error);
}

vxm_status vxm_gl_slab_stay(vxm_opengl *engine, const vxm_slab *slab, vxm_error *error) {
  return copy(engine, VXM_GL_RESULT, 0, VXM_GL_STAYING, vxm_slab_offset(slab), slab->words * sizeof(uint64_t),
              error);
}

vxm_status vxm_gl_slab_bring(vxm_opengl *engine, const vxm_slab *slab, vxm_error *error) {
  size_t bytes = slab->words * sizeof(uint64_t);
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_RESULT, bytes, error);
  return status == VXM_OK
             ? copy(engine, VXM_GL_STAYING, vxm_slab_offset(slab), VXM_GL_RESULT, 0, bytes, error)
             : status;
}

static vxm_status take(vxm_opengl *engine, const vxm_device_info *info, const vxm_window *window,
                       vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  GLuint words = (GLuint)(vxm_window_bytes(window) / sizeof(uint32_t));
  GLuint unit = info->format == VXM_VOXEL_FORMAT_FLOAT32 ? 1 : 0;
  vxm_status status = vxm_gl_use(engine, VXM_GL_DEVICE_VOXELS, error);
  if (status != VXM_OK)
    return status;
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  vxm_gl_bind(engine, 3, VXM_GL_STAYING);
  gl->BindImageTexture(unit, info->texture, 0, GL_TRUE, 0, GL_WRITE_ONLY, info->texture_format);
  gl->Uniform1ui(0, words);
  gl->Uniform4ui(1, (GLuint)(2 * window->row_words), (GLuint)window->middle_dim, (GLuint)window->fast_dim,
                 (GLuint)info->format);
  vxm_gl_dispatch(gl, words, false);
  gl->BindImageTexture(unit, 0, 0, GL_TRUE, 0, GL_WRITE_ONLY, info->texture_format);
  gl->MemoryBarrier(GL_ALL_BARRIER_BITS);
  gl->Finish();
  return vxm_gl_check(gl, "opengl: keeping voxels", error);
}

vxm_status vxm_gl_device_voxels_end(vxm_engine *base, vxm_device_voxels *voxels, int64_t index,
                                    const vxm_window *window, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  (void)index; /* there is one */
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  if (window->words)
    status = vxm_gl_upload(engine, VXM_GL_STAYING, window->words, vxm_window_bytes(window), error);
  if (status == VXM_OK)
    status = take(engine, &voxels->info, window, error);
  vxm_gl_leave(&engine->context);
  return status;
}
