/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/volume_colors.h"
#include "base/task_progress.h"
#include "base/threads.h"

#include <math.h>
#include <string.h>

typedef struct volume_task {
  vxm_volume_sampler sampler;
  const vxm_grid *grid;
  uint8_t *values;
  vxm_task_progress progress;
} volume_task;

vxm_status vxm_volume_colors_check(const vxm_field *volume, const vxm_space *space, vxm_error *error) {
  const vxm_space *own = &volume->space;
  if (volume->about.kind == VXM_FIELD_LABELS)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "colours: the volume holds labels, between which there is nothing; give it numbers or "
                    "colours");
  for (int a = 0; a < 3; a++)
    if (own->origin[a] >= space->origin[a] + (double)space->dims[a] * space->voxel_size[a] ||
        own->origin[a] + (double)own->dims[a] * own->voxel_size[a] <= space->origin[a])
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "colours: the volume lies beside the grid along %c: they have to be in the same "
                      "coordinates",
                      'x' + a);
  return VXM_OK;
}

/* ---- A point of the volume ---- */

/** The two voxels whose centres a point lies between along an axis, and how far from the first; beyond the
 * outer centres the point is moved there. */
typedef struct between {
  int64_t index[2];
  double part;
} between;

static between between_of(const vxm_space *space, int axis, double at) {
  double f = (at - space->origin[axis]) / space->voxel_size[axis] - 0.5;
  double last = (double)(space->dims[axis] - 1);
  f = f > 0 ? fmin(f, last) : 0;
  between b = {.index = {(int64_t)f, 0}};
  b.index[1] = vxm_min(b.index[0] + 1, space->dims[axis] - 1);
  b.part = f - (double)b.index[0];
  return b;
}

/** Red, green and blue of a voxel of the volume, or its number three times; the share in which it counts: 0
 * of what has no colour or is no number. */
static double corner(double out[3], const vxm_volume_sampler *sampler, size_t index) {
  const vxm_field *volume = sampler->volume;
  if (volume->channels == 4) {
    const uint8_t *color = (const uint8_t *)volume->values + 4 * index;
    for (int c = 0; c < 3; c++)
      out[c] = color[c] / 255.0;
    return color[3] / 255.0;
  }
  double value;
  vxm_field_doubles(&value, volume, index, 1);
  if (!isfinite(value))
    return 0;
  double half = sampler->high / 2 - sampler->low / 2; /* the whole may be more than a double holds */
  out[0] = out[1] = out[2] = half > 0 ? (value / 2 - sampler->low / 2) / half : 0;
  return 1;
}

static void sample(double out[3], const vxm_volume_sampler *sampler, const double at[3]) {
  const vxm_space *space = &sampler->volume->space;
  between b[3];
  double sum[3] = {0, 0, 0}, all = 0, color[3];
  for (int a = 0; a < 3; a++)
    b[a] = between_of(space, a, at[a]);
  for (int i = 0; i < 8; i++) {
    const int side[3] = {i & 1, (i >> 1) & 1, i >> 2};
    double share = 1;
    for (int a = 0; a < 3; a++)
      share *= side[a] ? b[a].part : 1 - b[a].part;
    if (share == 0)
      continue;
    int64_t index =
        (b[0].index[side[0]] * space->dims[1] + b[1].index[side[1]]) * space->dims[2] + b[2].index[side[2]];
    share *= corner(color, sampler, (size_t)index);
    for (int c = 0; share > 0 && c < 3; c++)
      sum[c] += share * color[c];
    all += share;
  }
  for (int c = 0; c < 3; c++)
    out[c] = all > 0 ? sum[c] / all : 0;
}

/* ---- All voxels ---- */

vxm_volume_sampler vxm_volume_sampler_of(const vxm_field *volume) {
  enum { AT_ONCE = 512 };
  double values[AT_ONCE];
  size_t count = vxm_field_count(volume);
  vxm_volume_sampler sampler = {volume, INFINITY, -INFINITY};
  for (size_t begin = 0; begin < count && volume->channels == 1; begin += AT_ONCE) {
    size_t some = count - begin < AT_ONCE ? count - begin : AT_ONCE;
    vxm_field_doubles(values, volume, begin, some);
    for (size_t n = 0; n < some; n++)
      if (isfinite(values[n])) {
        sampler.low = fmin(sampler.low, values[n]);
        sampler.high = fmax(sampler.high, values[n]);
      }
  }
  return sampler;
}

void vxm_volume_color(uint8_t value[4], const vxm_volume_sampler *sampler, const vxm_space *space,
                      const int64_t voxel[3]) {
  double at[3], color[3];
  for (int a = 0; a < 3; a++)
    at[a] = space->origin[a] + ((double)voxel[a] + 0.5) * space->voxel_size[a];
  sample(color, sampler, at);
  for (int c = 0; c < 3; c++)
    value[c] = (uint8_t)(color[c] * 255 + 0.5);
  value[3] = 255;
}

static void color_slice(size_t i, int worker, void *payload) {
  volume_task *task = payload;
  const vxm_space *space = &task->grid->space;
  size_t plane = (size_t)(space->dims[1] * space->dims[2]);
  uint8_t *to = task->values + 4 * i * plane;
  if (vxm_task_progress_stopped(&task->progress, worker))
    return;
  memset(to, 0, 4 * plane);
  for (int64_t j = 0; j < space->dims[1]; j++)
    for (int64_t k = 0; k < space->dims[2]; k++, to += 4)
      if (vxm_grid_get(task->grid, (int64_t)i, j, k))
        vxm_volume_color(to, &task->sampler, space, (const int64_t[3]){(int64_t)i, j, k});
  vxm_task_progress_step(&task->progress);
}

vxm_status vxm_volume_colors(uint8_t *values, const vxm_grid *grid, const vxm_field *volume,
                             vxm_error *error) {
  volume_task task = {.sampler = vxm_volume_sampler_of(volume), .grid = grid, .values = values};
  size_t slices = (size_t)grid->space.dims[0];
  vxm_task_progress_start(&task.progress, grid->context, "colouring", slices, error);
  vxm_parallel(grid->context, slices, color_slice, &task);
  return vxm_task_progress_end(&task.progress);
}
