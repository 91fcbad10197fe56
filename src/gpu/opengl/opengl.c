/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/opengl.h"
#include "gpu/opengl/gl_solid.h"

#include <stdio.h>
#include <string.h>

/* ---- What the driver says ---- */

static bool has_extension(const vxm_gl *gl, const char *name) {
  GLint count = 0;
  gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; i++)
    if (strcmp((const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i), name) == 0)
      return true;
  return false;
}

static void copy_string(char *out, size_t size, const GLubyte *text) {
  snprintf(out, size, "%s", text ? (const char *)text : "");
}

static bool is_software(const char *renderer) {
  static const char *const known[] = {"llvmpipe", "softpipe", "swrast", "SWR", "Software", "software"};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    if (strstr(renderer, known[i]))
      return true;
  return false;
}

static vxm_status read_limits(vxm_opengl *engine, vxm_error *error) {
  vxm_engine_info *info = &engine->base.info;
  const vxm_gl *gl = &engine->context.gl;
  GLint major = 0, minor = 0, viewport[2] = {0, 0}, side[2] = {0, 0}, layers = 0, bits = 0, blocks = 0,
        late = 0, all = 0, texture = 0;
  copy_string(info->renderer, sizeof info->renderer, gl->GetString(GL_RENDERER));
  copy_string(info->version, sizeof info->version, gl->GetString(GL_VERSION));
  info->hardware = !is_software(info->renderer);
  gl->GetIntegerv(GL_MAJOR_VERSION, &major);
  gl->GetIntegerv(GL_MINOR_VERSION, &minor);
  if (major < 4 || (major == 4 && minor < 3))
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s has OpenGL %d.%d only; 4.3 is needed", info->renderer,
                    major, minor);
  GLint64 block = 0;
  gl->GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
  gl->GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  gl->GetIntegerv(GL_MAX_FRAMEBUFFER_WIDTH, &side[0]);
  gl->GetIntegerv(GL_MAX_FRAMEBUFFER_HEIGHT, &side[1]);
  gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
  gl->GetIntegerv(GL_SUBPIXEL_BITS, &bits);
  gl->GetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &blocks);
  info->block_bytes = block;
  info->viewport = vxm_min(vxm_min(viewport[0], viewport[1]), vxm_min(side[0], side[1]));
  gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  info->viewport = vxm_min(info->viewport, texture);
  info->layers = layers;
  info->subpixel_bits = bits;
  info->int64 = has_extension(gl, "GL_ARB_gpu_shader_int64");
  gl->GetIntegerv(GL_MAX_GEOMETRY_SHADER_STORAGE_BLOCKS, &late);
  gl->GetIntegerv(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS, &all);
  engine->can_pull = blocks >= 5 && all >= 9;
  info->moves = blocks >= 4;
  engine->can_pull_late = blocks >= 1 && late >= 3 && all >= 7;
  return vxm_gl_check(gl, "opengl: asking for limits", error);
}

/* ---- The XOR self-test ---- */

enum { TEST_SIDE = 16 };

static const vxm_gl_format formats[] = {{"r8ui", "", GL_R8UI, GL_RED_INTEGER, 1, false},
                                        {"r8", "#define NORMALIZED\n", GL_R8, GL_RED, 1, false},
                                        {"image", "#define IMAGE\n", GL_R32UI, GL_RED_INTEGER, 4, true}};

static void draw_test(const vxm_gl *gl, GLuint program, GLuint texture, const vxm_gl_format *f) {
  static const GLuint zeros[4] = {0, 0, 0, 0};
  static const GLfloat black[4] = {0, 0, 0, 0};
  const GLenum to = GL_COLOR_ATTACHMENT0, none = GL_NONE;
  gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture, 0, 0);
  gl->DrawBuffers(1, &to);
  gl->Viewport(0, 0, TEST_SIDE, TEST_SIDE);
  if (f->internal == GL_R8)
    gl->ClearBufferfv(GL_COLOR, 0, black);
  else
    gl->ClearBufferuiv(GL_COLOR, 0, zeros);
  gl->UseProgram(program);
  if (f->is_image) {
    gl->DrawBuffers(1, &none);
    gl->BindImageTexture(0, texture, 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
  } else {
    gl->Enable(GL_COLOR_LOGIC_OP);
    gl->LogicOp(GL_XOR);
  }
  for (GLuint half = 0; half < 2; half++) {
    gl->Uniform1ui(0, half);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl->Disable(GL_COLOR_LOGIC_OP);
  gl->MemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
  gl->DrawBuffers(1, &to);
}

/** Whether what was drawn twice is gone, and what was drawn once is there. */
static bool passes_test(const vxm_gl *gl, const vxm_gl_format *f) {
  uint32_t wide[TEST_SIDE * TEST_SIDE];
  uint8_t narrow[TEST_SIDE * TEST_SIDE];
  memset(wide, 0x55, sizeof wide);
  memset(narrow, 0x55, sizeof narrow);
  gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
  if (f->internal == GL_R8)
    gl->ReadPixels(0, 0, TEST_SIDE, TEST_SIDE, f->read, GL_UNSIGNED_BYTE, narrow);
  else
    gl->ReadPixels(0, 0, TEST_SIDE, TEST_SIDE, f->read, GL_UNSIGNED_INT, wide);
  for (int i = 0; i < TEST_SIDE * TEST_SIDE; i++) {
    uint32_t expected = i % TEST_SIDE < TEST_SIDE / 2 ? 0 : 1;
    uint32_t found = f->internal == GL_R8 ? (narrow[i] == 255) | (narrow[i] % 255 != 0) * 2U : wide[i];
    if (found != expected)
      return false;
  }
  return true;
}

static bool try_format(vxm_opengl *engine, const vxm_gl_format *f) {
  static const char *const stages[] = {"test.vert", "present.frag", NULL};
  const vxm_gl *gl = &engine->context.gl;
  GLuint program, texture = 0, framebuffer = 0;
  if (vxm_gl_program(&program, gl, stages, f->defines, NULL) != VXM_OK)
    return false;
  gl->GenTextures(1, &texture);
  gl->GenFramebuffers(1, &framebuffer);
  gl->BindTexture(GL_TEXTURE_2D_ARRAY, texture);
  gl->TexStorage3D(GL_TEXTURE_2D_ARRAY, 1, f->internal, TEST_SIDE, TEST_SIDE, 1);
  gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  draw_test(gl, program, texture, f);
  bool passed = gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && passes_test(gl, f);
  passed &= vxm_gl_check(gl, "opengl: self-test", NULL) == VXM_OK;
  gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl->DeleteFramebuffers(1, &framebuffer);
  gl->DeleteTextures(1, &texture);
  gl->DeleteProgram(program);
  return passed;
}

static vxm_status choose_attachment(vxm_opengl *engine, vxm_error *error) {
  vxm_engine_info *info = &engine->base.info;
  for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
    if (try_format(engine, &formats[i])) {
      engine->format = &formats[i];
      snprintf(info->attachment, sizeof info->attachment, "%s", formats[i].name);
      return VXM_OK;
    }
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "%s fails the XOR self-test in every format; use --engine cpu or another driver",
                  info->renderer);
}

/* ---- Making and freeing ---- */

static void delete_objects(vxm_opengl *engine) {
  const vxm_gl *gl = &engine->context.gl;
  for (int p = 0; p < VXM_GL_PROGRAMS; p++)
    if (engine->programs[p])
      gl->DeleteProgram(engine->programs[p]);
  for (int b = 0; b < VXM_GL_BUFFERS; b++)
    vxm_gl_release(engine, (vxm_gl_buffer_id)b);
  vxm_gl_presence_release(engine);
  if (engine->framebuffer)
    gl->DeleteFramebuffers(1, &engine->framebuffer);
  if (engine->vertex_array)
    gl->DeleteVertexArrays(1, &engine->vertex_array);
}

static void destroy(vxm_engine *base) {
  vxm_opengl *engine = vxm_opengl_of(base);
  if (engine->context.handle && vxm_gl_enter(&engine->context, NULL) == VXM_OK) {
    delete_objects(engine);
    vxm_gl_leave(&engine->context);
  }
  /* Of a context that is lost, what it held is given back to the memory limit all the same. */
  for (int b = 0; b < VXM_GL_BUFFERS; b++)
    vxm_memory_give(base->context, engine->buffers[b].bytes);
  vxm_memory_give(base->context, engine->presence.bytes);
  vxm_gl_context_destroy(&engine->context);
  vxm_device_cache_destroy(&engine->device_cache);
}

static const vxm_engine_ops opengl_ops = {.move = vxm_gl_move,
                                          .unite = vxm_gl_unite,
                                          .vote = vxm_gl_vote,
                                          .surface = vxm_gl_surface,
                                          .color = vxm_gl_color,
                                          .device_voxels = vxm_gl_device_voxels,
                                          .device_voxels_begin = vxm_gl_device_voxels_begin,
                                          .device_voxels_end = vxm_gl_device_voxels_end,
                                          .destroy = destroy};

static vxm_status start(vxm_opengl *engine, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = read_limits(engine, error);
  if (status != VXM_OK)
    return status;
  gl->GenVertexArrays(1, &engine->vertex_array);
  gl->BindVertexArray(engine->vertex_array);
  gl->GenFramebuffers(1, &engine->framebuffer);
  status = choose_attachment(engine, error);
  if (status != VXM_OK)
    return status;
  gl->Disable(GL_DEPTH_TEST);
  gl->Disable(GL_CULL_FACE);
  gl->Disable(GL_DITHER);
  engine->base.info.available = true;
  engine->base.info.devices = 1;
  return vxm_gl_check(gl, "opengl: starting", error);
}

vxm_status vxm_opengl_create(vxm_engine **out, vxm_context *context, const vxm_gl_driver *driver, int index,
                             const vxm_engine_options *options, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_opengl *engine = vxm_try_calloc(context, 1, sizeof *engine, &status, error);
  *out = NULL;
  if (!engine)
    return status;
  engine->base.ops = &opengl_ops;
  engine->base.wants_apexes = options->gl_method != VXM_GL_COLUMNS;
  engine->base.displaces = options->displacement > 0;
  engine->base.context = context;
  engine->device_cache =
      vxm_device_cache_of(&engine->base, vxm_gl_device_cache_upload, vxm_gl_device_cache_release);
  engine->options = *options;
  vxm_opengl_name(engine->base.info.name, sizeof engine->base.info.name, driver, index);
  status = vxm_gl_context_create(&engine->context, driver, index, error);
  if (status == VXM_OK) {
    status = vxm_gl_enter(&engine->context, error);
    if (status == VXM_OK) {
      status = start(engine, error);
      vxm_gl_leave(&engine->context);
    }
  }
  if (status != VXM_OK) {
    destroy(&engine->base);
    vxm_free(context, engine);
    return status;
  }
  *out = &engine->base;
  return VXM_OK;
}

void vxm_opengl_name(char *out, size_t size, const vxm_gl_driver *driver, int index) {
  if (driver == &vxm_gl_egl_device)
    snprintf(out, size, "opengl:%s%d", driver->name, index);
  else
    snprintf(out, size, "opengl:%s", driver->name);
}
