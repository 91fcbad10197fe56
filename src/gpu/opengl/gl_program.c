/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/opengl.h"

#include <stdio.h>
#include <string.h>

#include "shaders/shaders.inc"

enum { PARTS_MAX = 8, STAGES_MAX = 3, LOG_MAX = 400 };

static const char *shader_text(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof shader_table / sizeof shader_table[0]; i++)
    if (strncmp(shader_table[i].name, name, length) == 0 && shader_table[i].name[length] == '\0')
      return shader_table[i].text;
  return NULL;
}

static GLenum stage_of(const char *names) {
  const char *dot = strrchr(names, '.');
  if (dot && strcmp(dot, ".vert") == 0)
    return GL_VERTEX_SHADER;
  if (dot && strcmp(dot, ".geom") == 0)
    return GL_GEOMETRY_SHADER;
  return dot && strcmp(dot, ".frag") == 0 ? GL_FRAGMENT_SHADER : GL_COMPUTE_SHADER;
}

/** A log may have many lines; a message has one. */
static void to_one_line(char *log) {
  for (char *c = log; *c; c++)
    if ((unsigned char)*c < ' ')
      *c = ' ';
}

static vxm_status compile(GLuint program, const vxm_gl *gl, const char *names, const char *defines,
                          const char *own, vxm_error *error) {
  const char *text[PARTS_MAX + 3] = {"#version 430 core\n", defines};
  GLsizei count = 2;
  for (const char *at = names; *at && count < PARTS_MAX + 2;) {
    size_t length = strcspn(at, " ");
    bool is_own = *at == '|';
    if (is_own) /* its lines are counted from 1 */
      text[count++] = "\n#line 1\n";
    text[count++] = is_own ? own : shader_text(at, length);
    at += length + strspn(at + length, " ");
  }
  GLuint shader = gl->CreateShader(stage_of(names));
  gl->ShaderSource(shader, count, text, NULL);
  gl->CompileShader(shader);
  GLint done = GL_FALSE;
  gl->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
  vxm_status status = VXM_OK;
  if (!done) {
    char log[LOG_MAX] = "";
    gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
    to_one_line(log);
    status = own && strchr(names, '|')
                 ? vxm_fail(error, VXM_ERROR_ARGUMENT, "the colour function does not compile: %s", log)
                 : vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the OpenGL driver refuses the shader %s: %s",
                            names, log);
  }
  gl->AttachShader(program, shader);
  gl->DeleteShader(shader); /* once the program goes */
  return status;
}

vxm_status vxm_gl_program(GLuint *out, const vxm_gl *gl, const char *const stages[], const char *defines,
                          vxm_error *error) {
  return vxm_gl_program_with(out, gl, stages, defines, NULL, error);
}

vxm_status vxm_gl_program_with(GLuint *out, const vxm_gl *gl, const char *const stages[], const char *defines,
                               const char *own, vxm_error *error) {
  GLuint program = gl->CreateProgram();
  vxm_status status = VXM_OK;
  for (int s = 0; s < STAGES_MAX && stages[s] && status == VXM_OK; s++)
    status = compile(program, gl, stages[s], defines, own, error);
  GLint done = GL_FALSE;
  if (status == VXM_OK) {
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &done);
  }
  if (status == VXM_OK && !done) {
    char log[LOG_MAX] = "";
    gl->GetProgramInfoLog(program, sizeof log, NULL, log);
    to_one_line(log);
    status = vxm_fail(error, own ? VXM_ERROR_ARGUMENT : VXM_ERROR_UNAVAILABLE,
                      "the OpenGL driver cannot link %s: %s", stages[0], log);
  }
  if (status != VXM_OK) {
    gl->DeleteProgram(program);
    program = 0;
  }
  *out = program;
  return status;
}

vxm_status vxm_gl_use(vxm_opengl *engine, vxm_gl_program_id id, vxm_error *error) {
  static const char int64[] = "#extension GL_ARB_gpu_shader_int64 : require\n";
  static const struct {
    const char *stages[STAGES_MAX];
    bool wide;
  } sources[VXM_GL_PROGRAMS] = {
      [VXM_GL_FIND_COLUMNS] = {{"job.glsl rules.h crossing.glsl columns.comp"}, true},
      [VXM_GL_DRAW_COLUMNS] = {{"job.glsl cover.glsl columns.vert",
                                "job.glsl rules.h crossing.glsl columns.frag"},
                               true},
      [VXM_GL_FLIP] = {{"flips.comp"}, false},
      [VXM_GL_FOLD_ROWS] = {{"fold_rows.comp"}, false},
      [VXM_GL_FOLD_ACROSS] = {{"fold_across.comp"}, false},
      [VXM_GL_VOTE] = {{"vote.comp"}, false},
      [VXM_GL_TOUCH] = {{"touch.comp"}, false},
      [VXM_GL_DRAW_SLICES] = {{"nudge.glsl cover.glsl section.glsl corners.glsl slices.vert",
                               "nudge.glsl cover.glsl section.glsl slices.geom",
                               "nudge.glsl inside.glsl present.frag"},
                              false},
      [VXM_GL_DRAW_TETRA] = {{"nudge.glsl cover.glsl section.glsl corners.glsl tetra.vert",
                              "nudge.glsl inside.glsl present.frag"},
                             false},
      [VXM_GL_FIND_SURFACE] = {{"rules.h touching.glsl surface.comp"}, true},
      [VXM_GL_DRAW_SURFACE] = {{"surface.vert", "cover.glsl rules.h touching.glsl surface.geom",
                                "rules.h touching.glsl surface.frag"},
                               true},
      [VXM_GL_MOVE] = {{"move.vert"}, false},
      [VXM_GL_PACK] = {{"pack.comp"}, false},
      [VXM_GL_MERGE] = {{"merge.comp"}, false},
      [VXM_GL_DEVICE_VOXELS] = {{"device_voxels.comp"}, false},
  };
  vxm_status status = VXM_OK;
  if (sources[id].wide && !engine->base.info.int64)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "%s has no GL_ARB_gpu_shader_int64, which exact columns need; use --gl-method slices or "
                    "--engine cpu",
                    engine->base.info.renderer);
  char defines[160];
  snprintf(defines, sizeof defines, "%s%s#define SECTION\n", sources[id].wide ? int64 : "",
           engine->format->defines);
  if (!engine->programs[id])
    status = vxm_gl_program(&engine->programs[id], &engine->context.gl, sources[id].stages, defines, error);
  if (status == VXM_OK)
    engine->context.gl.UseProgram(engine->programs[id]);
  return status;
}

void vxm_gl_dispatch(const vxm_gl *gl, uint64_t count, bool groups) {
  enum { WIDTH_MAX = 65535 };
  uint64_t all = groups ? count : (count + 63) / 64;
  uint64_t height = (all + WIDTH_MAX - 1) / WIDTH_MAX;
  if (all > 0)
    gl->DispatchCompute((GLuint)(height > 1 ? WIDTH_MAX : all), (GLuint)height, 1);
}
