/* SPDX-License-Identifier: BSD-3-Clause */
/** The picture of a grid: a camera, bands of rows drawn by all threads, and PNG. */
#include "gridio/picture/picture.h"
#include "base/threads.h"
#include "gridio/common/png_write.h"
#include "gridio/picture/shade.h"
#include "gridio/picture/slice.h"
#include "gridio/picture/tiles.h"

#include <string.h>

enum {
  SIZE_MAX_PIXELS = 16384,
  BAND = 32,
  SAMPLES = 4,
  FLOOR = 4 /**< pixels between points of the floor */
};

/* ---- What is to be seen ---- */

typedef struct box {
  int64_t low[3], high[3]; /**< high is exclusive */
} box;

/** The smallest box around the set voxels; the whole grid if there are none. */
static box occupied_box(const vxm_grid *grid) {
  const int64_t *dims = grid->space.dims;
  box b = {{dims[0], dims[1], dims[2]}, {0, 0, 0}};
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++) {
      const uint64_t *row = vxm_grid_row(grid, j, k);
      int64_t first = -1, last = -1;
      for (size_t w = 0; w < grid->row_words; w++)
        if (row[w]) {
          if (first < 0)
            first = (int64_t)w * 64 + __builtin_ctzll(row[w]);
          last = (int64_t)w * 64 + 63 - __builtin_clzll(row[w]);
        }
      if (first < 0)
        continue;
      const int64_t low[3] = {first, j, k}, high[3] = {last + 1, j + 1, k + 1};
      for (int a = 0; a < 3; a++) {
        b.low[a] = low[a] < b.low[a] ? low[a] : b.low[a];
        b.high[a] = high[a] > b.high[a] ? high[a] : b.high[a];
      }
    }
  if (b.high[0] == 0)
    b = (box){{0, 0, 0}, {dims[0], dims[1], dims[2]}};
  return b;
}

/** The corner of the box that the bits of `corner` choose, in scene coordinates. */
static vxm_ray_vec3 box_corner(const box *b, const double step[3], int corner) {
  vxm_ray_vec3 p;
  for (int a = 0; a < 3; a++)
    p.c[a] = (double)(corner >> a & 1 ? b->high[a] : b->low[a]) * step[a];
  return p;
}

/** Points whose hull holds all set voxels closely. */
typedef struct outline {
  vxm_ray_vec3 *points;
  size_t count;
} outline;

static void add_cell(outline *o, const box *limits, const double step[3], const int64_t cell[3],
                     int64_t side) {
  box b;
  for (int a = 0; a < 3; a++) {
    b.low[a] = cell[a] * side > limits->low[a] ? cell[a] * side : limits->low[a];
    b.high[a] = (cell[a] + 1) * side < limits->high[a] ? (cell[a] + 1) * side : limits->high[a];
  }
  for (int corner = 0; corner < 8; corner++)
    o->points[o->count++] = box_corner(&b, step, corner);
}

/** The first and last cell of each row of a coarse level, cut to the occupied box; the box if all is empty.
 */
static vxm_status find_outline(outline *o, const vxm_scene *scene, const box *limits, vxm_error *error) {
  const vxm_occupancy_mips *mips = &scene->mips;
  int level = 0;
  while (level + 1 < mips->levels && mips->level[level].dims[1] * mips->level[level].dims[2] > 1024)
    level++;
  const int64_t *dims = mips->level[level].dims;
  vxm_status status = VXM_OK;
  size_t most = 16 * (size_t)(dims[1] * dims[2]);
  o->count = 0;
  o->points = vxm_try_alloc(scene->grid->context, most, sizeof *o->points, &status, error);
  if (!o->points)
    return status;
  int64_t side = INT64_C(4) << level;
  for (int64_t row = 0; row < dims[1] * dims[2]; row++) {
    const uint8_t *cells = mips->level[level].cells + row * dims[0];
    int64_t first = 0, last = dims[0] - 1;
    while (first < dims[0] && !cells[first])
      first++;
    if (first == dims[0])
      continue;
    while (!cells[last])
      last--;
    add_cell(o, limits, scene->step, (int64_t[3]){first, row % dims[1], row / dims[1]}, side);
    add_cell(o, limits, scene->step, (int64_t[3]){last, row % dims[1], row / dims[1]}, side);
  }
  for (int corner = 0; o->count < 8; corner++)
    o->points[o->count++] = box_corner(limits, scene->step, corner);
  return VXM_OK;
}

/** Steps in proportion to the voxel sizes; a millionth of the longest side is the least that can be seen. */
static void set_steps(vxm_scene *scene, const vxm_space *space) {
  double longest = 0;
  for (int a = 0; a < 3; a++) {
    double side = (double)space->dims[a] * 0x1p-60 * space->voxel_size[a];
    longest = side > longest ? side : longest;
  }
  for (int a = 0; a < 3; a++) {
    double step = space->voxel_size[a] * 0x1p-60 / longest, least = 1e-6 / (double)space->dims[a];
    scene->step[a] = step > least ? step : least;
  }
}

static vxm_ray_vec3 axis_vector(int axis) {
  vxm_ray_vec3 v = {{0, 0, 0}};
  v.c[axis % 3] = 1;
  return v;
}

/* ---- The camera ---- */

/** Moves the camera back along its axis until the whole outline is in the picture, and centres it. */
static void frame(vxm_camera *cam, const outline *o, vxm_ray_vec3 target) {
  const double half_angle_tangent = 0.24, margin = 0.88;
  double shorter = cam->width < cam->height ? cam->width : cam->height;
  cam->pixel = 2 * half_angle_tangent / shorter;
  double reach[2] = {margin * cam->pixel * cam->width / 2, margin * cam->pixel * cam->height / 2};
  for (int round = 0; round < 8; round++) {
    double distance = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < o->count; i++) {
      vxm_ray_vec3 p = vxm_ray_vec3_add(o->points[i], -1, target);
      double x = fabs(vxm_ray_vec3_dot(p, cam->right)), y = fabs(vxm_ray_vec3_dot(p, cam->top));
      double needed = fmax(x / reach[0], y / reach[1]) + vxm_ray_vec3_dot(p, cam->back);
      distance = needed > distance ? needed : distance;
    }
    cam->eye = vxm_ray_vec3_add(target, distance, cam->back);
    for (size_t i = 0; i < o->count; i++) {
      vxm_ray_vec3 p = vxm_ray_vec3_add(o->points[i], -1, target);
      double depth = distance - vxm_ray_vec3_dot(p, cam->back);
      double at[2] = {vxm_ray_vec3_dot(p, cam->right) / depth, vxm_ray_vec3_dot(p, cam->top) / depth};
      for (int n = 0; n < 2; n++) {
        low[n] = at[n] < low[n] ? at[n] : low[n];
        high[n] = at[n] > high[n] ? at[n] : high[n];
      }
    }
    target = vxm_ray_vec3_add(target, distance * (low[0] + high[0]) / 2, cam->right);
    target = vxm_ray_vec3_add(target, distance * (low[1] + high[1]) / 2, cam->top);
  }
}

/** Azimuth turns about the up axis from the axis that follows it (x, if z is up) to the one after. */
static vxm_status set_up(vxm_camera *cam, vxm_scene *scene, const vxm_picture_options *options,
                         vxm_error *error) {
  const double degree = 3.14159265358979323846 / 180;
  int up = options->up == 0 ? 2 : options->up - 1;
  double azimuth = options->azimuth * degree, elevation = options->elevation * degree;
  vxm_ray_vec3 e1 = axis_vector(up + 1), e2 = axis_vector(up + 2);
  scene->up = axis_vector(up);
  vxm_ray_vec3 level = vxm_ray_vec3_add(vxm_ray_vec3_scale(cos(azimuth), e1), sin(azimuth), e2);
  cam->back = vxm_ray_vec3_add(vxm_ray_vec3_scale(cos(elevation), level), sin(elevation), scene->up);
  cam->right = vxm_ray_vec3_add(vxm_ray_vec3_scale(-sin(azimuth), e1), cos(azimuth), e2);
  cam->top = vxm_ray_vec3_cross(cam->back, cam->right);

  box b = occupied_box(scene->grid);
  vxm_ray_vec3 low = box_corner(&b, scene->step, 0), high = box_corner(&b, scene->step, 7);
  scene->centre = vxm_ray_vec3_scale(0.5, vxm_ray_vec3_add(low, 1, high));
  vxm_ray_vec3 half = vxm_ray_vec3_add(high, -1, scene->centre);
  scene->radius = sqrt(vxm_ray_vec3_dot(half, half));
  scene->floor = low.c[up];
  outline o;
  vxm_status status = find_outline(&o, scene, &b, error);
  if (status != VXM_OK)
    return status;
  frame(cam, &o, scene->centre);
  vxm_free(scene->grid->context, o.points);

  /* The sun stands behind the left shoulder, high. */
  vxm_ray_vec3 light = vxm_ray_vec3_add(vxm_ray_vec3_scale(-0.45, cam->right), 0.95, scene->up);
  scene->light = vxm_ray_vec3_unit(vxm_ray_vec3_add(light, 0.24, level));
  scene->side[0] = vxm_ray_vec3_unit(vxm_ray_vec3_cross(scene->light, cam->right));
  scene->side[1] = vxm_ray_vec3_cross(scene->light, scene->side[0]);

  /* Voxels of 10 pixels are drawn as cubes with lines between them, those of 2 as a smooth surface. */
  vxm_ray_vec3 away = vxm_ray_vec3_add(cam->eye, -1, scene->centre);
  double step = fmax(scene->step[0], fmax(scene->step[1], scene->step[2]));
  double pixels = step / (cam->pixel * sqrt(vxm_ray_vec3_dot(away, away)));
  scene->smoothness = fmin(fmax((10 - pixels) / 8, 0), 1) * 0.9;
  scene->line_width = 1.2 / pixels;
  return VXM_OK;
}

/* ---- Drawing ---- */

/** What the picture shows at a corner of pixels. */
typedef struct corner {
  float light[3]; /**< as vxm_light */
  float plain[3]; /**< -1 if there is no voxel */
} corner;

typedef struct drawing {
  const vxm_camera *cam;
  const vxm_scene *scene;
  vxm_tiles tiles;
  int row;           /**< first of the band */
  float (*floor)[3]; /**< what is behind the voxels, at every FLOOR-th corner of every FLOOR-th row */
  size_t floor_width;
  corner *corners; /**< of its rows of pixels: a row more, and in each one more than pixels */
  unsigned char *pixels;
} drawing;

/** The sRGB value of linear light (IEC 61966-2-1). */
static unsigned char encode(double light) {
  if (!(light > 0))
    return 0;
  if (light >= 1)
    return 255;
  double value = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
  return (unsigned char)(255 * value + 0.5);
}

/** Neighbouring pixels look at different points of the sun; their mean is even (Jimenez 2014). */
static double turn_at(int x, int y) {
  double start = 52.9829189 * fmod(0.06711056 * x + 0.00583715 * y, 1);
  return start - floor(start);
}

/** A row of points of the floor. Its shadow is soft, and takes more rays than points. */
static void look_behind(size_t task, int worker, void *payload) {
  (void)worker;
  const drawing *d = payload;
  int y = d->row + FLOOR * (int)task;
  float(*row)[3] = d->floor + task * d->floor_width;
  for (size_t n = 0; n < d->floor_width; n++) {
    int x = FLOOR * (int)n;
    vxm_ray_vec3 light =
        vxm_shade_background(d->scene, d->cam->eye, vxm_camera_direction(d->cam, x, y), turn_at(x, y));
    for (int c = 0; c < 3; c++)
      row[n][c] = (float)light.c[c];
  }
}

/** What is behind the voxels, between four points of the floor. */
static void behind(float out[3], const drawing *d, double x, double y) {
  double u = x / FLOOR, v = (y - d->row) / FLOOR;
  size_t i = (size_t)u, j = (size_t)v;
  float s = (float)(u - (double)i), t = (float)(v - (double)j);
  const float(*upper)[3] = (const float(*)[3])d->floor + j * d->floor_width + i,
        (*lower)[3] = upper + d->floor_width;
  for (int c = 0; c < 3; c++)
    out[c] =
        (1 - t) * ((1 - s) * upper[0][c] + s * upper[1][c]) + t * ((1 - s) * lower[0][c] + s * lower[1][c]);
}

/** Light of the voxel at a point of the picture, if there is one. */
static bool look_at_voxels(vxm_light *light, const drawing *d, double x, double y, const double jitter[2]) {
  const vxm_camera *cam = d->cam;
  double depth = (double)vxm_tiles_depth(&d->tiles, x, y);
  if (!(depth < INFINITY))
    return false;
  vxm_ray_vec3 direction = vxm_camera_direction(cam, x, y);
  double begin = depth / -vxm_ray_vec3_dot(direction, cam->back);
  return vxm_shade(light, d->scene, vxm_ray_vec3_add(cam->eye, begin, direction), direction, jitter);
}

/** What is seen at a point of the picture. `part`, 0 to 3, is the quarter of the sun that is looked at;
 * `start` turns the sun's disk. */
static corner look(const drawing *d, double x, double y, double start, int part) {
  double jitter[2] = {start + 0.25 * part, (part * 2 % SAMPLES + part / 2 + 0.5) / SAMPLES};
  vxm_light light;
  corner seen = {{1, 1, 1}, {-1, -1, -1}};
  if (!look_at_voxels(&light, d, x, y, jitter))
    behind(seen.light, d, x, y);
  else
    for (int n = 0; n < 3; n++) {
      seen.light[n] = (float)fmin(light.colour.c[n], 1.0);
      seen.plain[n] = (float)light.plain.c[n];
    }
  return seen;
}

/** A row of corners: the four of any pixel look at the four quarters of the sun. */
static void look_along(size_t task, int worker, void *payload) {
  (void)worker;
  const drawing *d = payload;
  int y = d->row + (int)task;
  corner *row = d->corners + task * ((size_t)d->cam->width + 1);
  for (int x = 0; x <= d->cam->width; x++)
    row[x] = look(d, x, y, turn_at(x, y), 2 * (y & 1) + (x & 1));
}

/** Whether something ends within a pixel: its corners see different things, or in different light. */
static bool has_edge(const corner *upper, const corner *lower) {
  const corner *all[4] = {upper, upper + 1, lower, lower + 1};
  for (int n = 0; n < 3; n++) {
    float low = all[0]->plain[n], high = low;
    for (int c = 1; c < 4; c++) {
      low = fminf(low, all[c]->plain[n]);
      high = fmaxf(high, all[c]->plain[n]);
    }
    if (high - low > 0.02F + 0.12F * fmaxf(high, 0))
      return true;
  }
  return false;
}

/** A pixel with an edge is the mean of four rays, spread so that no two share a row or column of its 4 x 4
 * parts. */
static void draw_edge(const drawing *d, int x, int y, double sum[3]) {
  static const double offset[SAMPLES][2] = {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};
  double start = turn_at(x, y);
  for (int s = 0; s < SAMPLES; s++) {
    corner seen = look(d, x + offset[s][0], y + offset[s][1], start, s);
    for (int n = 0; n < 3; n++)
      sum[n] += (double)seen.light[n] / SAMPLES;
  }
}

/** Most pixels are the mean of their corners, each of which four pixels share. */
static void draw_row(size_t task, int worker, void *payload) {
  (void)worker;
  const drawing *d = payload;
  size_t width = (size_t)d->cam->width;
  unsigned char *row = d->pixels + task * 3 * width;
  const corner *upper = d->corners + task * (width + 1), *lower = upper + width + 1;
  for (int x = 0; x < d->cam->width; x++, upper++, lower++) {
    double sum[3] = {0, 0, 0};
    if (has_edge(upper, lower))
      draw_edge(d, x, d->row + (int)task, sum);
    else
      for (int n = 0; n < 3; n++)
        sum[n] = ((double)upper->light[n] + upper[1].light[n] + lower->light[n] + lower[1].light[n]) / 4;
    for (int n = 0; n < 3; n++)
      row[3 * x + n] = encode(sum[n]);
  }
}

/** Draws all bands of rows. */
static vxm_status draw_bands(vxm_png *png, drawing *d, vxm_error *error) {
  vxm_context *context = d->scene->grid->context;
  int height = d->cam->height;
  vxm_status status = VXM_OK;
  for (d->row = 0; status == VXM_OK && d->row < height; d->row += BAND) {
    int rows = height - d->row < BAND ? height - d->row : BAND;
    vxm_parallel(context, BAND / FLOOR + 2, look_behind, d);
    vxm_parallel(context, (size_t)rows + 1, look_along, d);
    vxm_parallel(context, (size_t)rows, draw_row, d);
    status = vxm_png_rows(png, d->pixels, rows, error);
    if (status == VXM_OK)
      status = vxm_progress(context, "drawing", (double)(d->row + rows) / height, error);
  }
  return status;
}

/** Room for a band; the caller frees what there is. */
static vxm_status make_room(drawing *d, vxm_context *context, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t width = (size_t)d->cam->width;
  d->floor_width = width / FLOOR + 2;
  d->floor = vxm_alloc(context, (BAND / FLOOR + 2) * d->floor_width, sizeof *d->floor, &local);
  if (d->floor)
    d->corners = vxm_alloc(context, (BAND + 1) * (width + 1), sizeof *d->corners, &local);
  if (d->corners)
    d->pixels = vxm_alloc(context, BAND * width, 3, &local);
  if (!d->pixels)
    vxm_error_pass(error, &local);
  return d->pixels ? VXM_OK : local.code;
}

static vxm_status draw(vxm_output *output, const vxm_camera *cam, const vxm_scene *scene, vxm_error *error) {
  vxm_context *context = scene->grid->context;
  drawing d = {.cam = cam, .scene = scene, .tiles = {.context = context}};
  vxm_png *png = NULL;
  vxm_status status = make_room(&d, context, error);
  if (status == VXM_OK)
    status = vxm_tiles_create(&d.tiles, scene, cam, error);
  if (status == VXM_OK)
    status = vxm_png_create(&png, context, output, cam->width, cam->height, error);
  if (status == VXM_OK)
    status = draw_bands(png, &d, error);
  if (status == VXM_OK)
    status = vxm_png_finish(png, error);
  vxm_png_destroy(png);
  vxm_tiles_destroy(&d.tiles);
  vxm_free(context, d.pixels);
  vxm_free(context, d.corners);
  vxm_free(context, d.floor);
  return status;
}

vxm_status vxm_gridio_picture_check(const vxm_picture_options *o, vxm_error *error) {
  if (o->width < 0 || o->height < 0 || o->width > SIZE_MAX_PIXELS || o->height > SIZE_MAX_PIXELS)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "picture: %d x %d pixels; choose 1 to %d each", o->width,
                    o->height, SIZE_MAX_PIXELS);
  if (!isfinite(o->azimuth) || !(fabs(o->elevation) <= 90))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "picture: azimuth %g and elevation %g; choose a finite azimuth and -90 to 90 degrees",
                    o->azimuth, o->elevation);
  if (o->up < 0 || o->up > 3)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "picture: up axis %d; choose 1 (x), 2 (y) or 3 (z)", o->up);
  if (o->slice_axis < 0 || o->slice_axis > 3 || !(o->slice >= 0 && o->slice <= 1))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "picture: slice at %g along axis %d; choose 0 to 1 along 1 (x), 2 (y) or 3 (z)", o->slice,
                    o->slice_axis);
  return vxm_png_check(error);
}

vxm_status vxm_gridio_picture(const vxm_grid *grid, vxm_paint_fn paint, const void *painted, const char *path,
                              const vxm_picture_options *options, vxm_error *error) {
  vxm_status status = vxm_gridio_picture_check(options, error);
  if (status != VXM_OK)
    return status;
  if (options->slice_axis != 0)
    return vxm_gridio_slice(grid, NULL, VXM_FIELD_NUMBERS, NULL, path, options, error);
  vxm_camera cam = {.width = options->width ? options->width : 800,
                    .height = options->height ? options->height : 600};
  vxm_scene scene = {.grid = grid, .paint = paint, .painted = painted};
  set_steps(&scene, &grid->space);
  vxm_scene_weigh(&scene);
  status = vxm_occupancy_mips_create(&scene.mips, grid, error);
  if (status != VXM_OK)
    return status;
  vxm_output *output;
  status = set_up(&cam, &scene, options, error);
  if (status == VXM_OK)
    status = vxm_output_open(&output, grid->context, path, error);
  if (status == VXM_OK) {
    status = draw(output, &cam, &scene, error);
    if (status == VXM_OK)
      status = vxm_output_commit(output, error);
    else
      vxm_output_abort(output);
  }
  vxm_occupancy_mips_destroy(&scene.mips);
  return status;
}
