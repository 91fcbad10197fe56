/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/color.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "grid/space.h"
#include "voxel/labels/labels.h"
#include "voxel/labels/mesh_colors.h"
#include "voxel/model/voxelize.h"

#include <math.h>
#include <string.h>

bool vxm_color_wants_parts(const vxm_color_options *options) {
  return options->by == VXM_COLOR_PART || options->by == VXM_COLOR_GLSL;
}

/* ---- The functions, as shaders/noise.glsl and shaders/color_*.glsl have them, in floats too ---- */

static float corner_gradient(const int32_t corner[3], const float p[3]) {
  uint32_t h = (uint32_t)corner[0] * 0x8da6b343u ^ (uint32_t)corner[1] * 0xd8163841u ^
               (uint32_t)corner[2] * 0xcb1ab31fu;
  h ^= h >> 13;
  h *= 0x5bd1e995u;
  h ^= h >> 15;
  h %= 12;
  float a = h < 8 ? p[0] : p[1], b = h < 4 ? p[1] : p[2];
  return (h & 1 ? -a : a) + (h & 2 ? -b : b);
}

static float mix(float a, float b, float t) {
  return a * (1 - t) + b * t;
}

static float noise(const float p[3]) {
  float f[3], w[3], value[8];
  int32_t whole[3];
  for (int a = 0; a < 3; a++) {
    float floor_of = floorf(p[a]);
    whole[a] = (int32_t)floor_of;
    f[a] = p[a] - floor_of;
    w[a] = f[a] * f[a] * f[a] * (f[a] * (f[a] * 6 - 15) + 10);
  }
  for (int i = 0; i < 8; i++) {
    const int d[3] = {i & 1, (i >> 1) & 1, i >> 2};
    const int32_t corner[3] = {whole[0] + d[0], whole[1] + d[1], whole[2] + d[2]};
    const float from[3] = {f[0] - (float)d[0], f[1] - (float)d[1], f[2] - (float)d[2]};
    value[i] = corner_gradient(corner, from);
  }
  float low = mix(mix(value[0], value[1], w[0]), mix(value[2], value[3], w[0]), w[1]);
  float high = mix(mix(value[4], value[5], w[0]), mix(value[6], value[7], w[0]), w[1]);
  return mix(low, high, w[2]);
}

static float clamp(float x) {
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

static void color_by_noise(float out[3], const float unit[3]) {
  static const float deep[3] = {0.12F, 0.28F, 0.50F}, high[3] = {0.97F, 0.90F, 0.72F};
  float p[3] = {unit[0] * 8, unit[1] * 8, unit[2] * 8}, sum = 0, size = 0.5F;
  for (int octave = 0; octave < 4; octave++, size *= 0.5F) {
    sum += size * noise(p);
    for (int a = 0; a < 3; a++)
      p[a] *= 2;
  }
  for (int c = 0; c < 3; c++)
    out[c] = mix(deep[c], high[c], clamp(0.5F + sum));
}

static void color_by_part(float out[3], uint16_t part) {
  float turns = (float)part * 0.61803398875F, hue = (turns - floorf(turns)) * 6;
  const float raw[3] = {fabsf(hue - 3) - 1, 2 - fabsf(hue - 2), 2 - fabsf(hue - 4)};
  for (int c = 0; c < 3; c++)
    out[c] = 0.25F + 0.75F * clamp(raw[c]);
}

/* ---- By the CPU ---- */

typedef struct color_task {
  const vxm_color_job *job;
  uint8_t *values;
  float longest;
  vxm_task_progress progress;
} color_task;

void vxm_color_voxel(uint8_t value[4], vxm_color_by by, const vxm_space *space, float longest,
                     const int64_t at[3], uint16_t part) {
  float color[3], unit[3];
  for (int a = 0; a < 3; a++)
    unit[a] = ((float)at[a] + 0.5F) * (float)space->voxel_size[a] / longest;
  if (by == VXM_COLOR_NOISE)
    color_by_noise(color, unit);
  else if (by == VXM_COLOR_PART)
    color_by_part(color, part);
  else
    memcpy(color, unit, sizeof color);
  for (int c = 0; c < 3; c++)
    value[c] = (uint8_t)(clamp(color[c]) * 255 + 0.5F);
  value[3] = 255;
}

static void color_voxel(const color_task *task, const int64_t at[3], size_t index) {
  const vxm_color_job *job = task->job;
  vxm_color_voxel(task->values + 4 * index, job->options->by, &job->grid->space, task->longest, at,
                  job->parts ? job->parts[index] : 0);
}

static void color_slice(size_t i, int worker, void *payload) {
  color_task *task = payload;
  const int64_t *dims = task->job->grid->space.dims;
  size_t index = i * (size_t)(dims[1] * dims[2]);
  if (vxm_task_progress_stopped(&task->progress, worker))
    return;
  memset(task->values + 4 * index, 0, 4 * (size_t)(dims[1] * dims[2]));
  for (int64_t j = 0; j < dims[1]; j++)
    for (int64_t k = 0; k < dims[2]; k++, index++)
      if (vxm_grid_get(task->job->grid, (int64_t)i, j, k))
        color_voxel(task, (const int64_t[3]){(int64_t)i, j, k}, index);
  vxm_task_progress_step(&task->progress);
}

static vxm_status color_by_cpu(uint8_t *values, const vxm_color_job *job, vxm_context *context,
                               vxm_error *error) {
  size_t slices = (size_t)job->grid->space.dims[0];
  color_task task = {
      .job = job, .values = values, .longest = (float)vxm_space_longest_side(&job->grid->space)};
  if (job->options->by == VXM_COLOR_GLSL)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "a colour function in GLSL needs OpenGL: --engine opengl (vxm_voxelize_options.engine)");
  vxm_task_progress_start(&task.progress, context, "colouring", slices, error);
  vxm_parallel(context, slices, color_slice, &task);
  return vxm_task_progress_end(&task.progress);
}

/* ---- All of it ---- */

static vxm_status make_colors(uint8_t *values, const vxm_color_job *job, vxm_model *model, vxm_error *error) {
  vxm_engine *engine = model->options.engine;
  if (job->options->by == VXM_COLOR_MESH) {
    vxm_status status = vxm_progress(model->context, "colouring", 0, error);
    if (status == VXM_OK)
      status = vxm_mesh_colors(values, job->grid, job->options->mesh, job->options->average, error);
    return status == VXM_OK ? vxm_progress(model->context, "colouring", 1, error) : status;
  }
  if (!engine || !engine->ops || !engine->ops->color)
    return color_by_cpu(values, job, model->context, error);
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = engine->ops->color(engine, values, job, &local);
  if (status != VXM_OK && job->options->by != VXM_COLOR_GLSL && vxm_engine_falls_back(engine, &local))
    return color_by_cpu(values, job, model->context, error);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Which part each voxel belongs to. */
static vxm_status make_parts(uint16_t *parts, vxm_model *model, const vxm_space *space, vxm_error *error) {
  vxm_face_labels labelling;
  vxm_voxelize_report voxelize;
  vxm_label_report report = {.voxelize = &voxelize};
  vxm_status status = vxm_face_labels_create(&labelling, model->analysis.soup, VXM_LABEL_PART, error);
  if (status == VXM_OK)
    status = vxm_labels_run(parts, (vxm_layout){2, 1, 0}, &report, model, space, &labelling, error);
  vxm_face_labels_destroy(&labelling);
  return status;
}

vxm_status vxm_colors_run(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                          const vxm_space *space, const vxm_color_options *options, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  uint16_t *parts = NULL;
  vxm_status status = VXM_OK;
  if (vxm_color_wants_parts(options)) {
    parts = vxm_alloc(model->context, (size_t)(space->dims[0] * space->dims[1] * space->dims[2]),
                      sizeof *parts, &local);
    status = parts ? make_parts(parts, model, space, &local) : local.code;
  }
  if (status == VXM_OK)
    status = vxm_voxelize_grid(&grid, report, model, space, &local);
  vxm_color_job job = {.grid = grid, .parts = parts, .options = options};
  if (status == VXM_OK)
    status = make_colors(values, &job, model, &local);
  vxm_free(model->context, parts);
  vxm_grid_destroy(grid);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
