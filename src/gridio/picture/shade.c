/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/shade.h"

/* Linear colours of the voxels, the sun, the sky and the light that the floor throws back. */
static const vxm_ray_vec3 surface = {{0.58, 0.215, 0.075}};
static const vxm_ray_vec3 sun = {{1.50, 1.40, 1.24}};
static const vxm_ray_vec3 sky = {{0.42, 0.50, 0.62}};
static const vxm_ray_vec3 ground = {{0.30, 0.27, 0.24}};

/* The sun's disk: a shadow is soft over a tenth of the distance to what throws it. */
static const double sun_radius = 0.09;

static double clamp01(double x) {
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

/** 0 below a, 1 above b, smooth between. */
static double ramp(double a, double b, double x) {
  double t = clamp01((x - a) / (b - a));
  return t * t * (3 - 2 * t);
}

static void to_voxels(const vxm_scene *scene, vxm_ray_vec3 v, double out[3]) {
  for (int a = 0; a < 3; a++)
    out[a] = v.c[a] / scene->step[a];
}

/* ---- How the surface lies, from the voxels around ---- */

enum { REACH = 3, WIDTH = 2 * REACH + 1 };

/** The bits i-REACH..i+REACH of a row; outside the grid they are 0. */
static unsigned window(const vxm_grid *grid, int64_t i, int64_t j, int64_t k) {
  if (j < 0 || k < 0 || j >= grid->space.dims[1] || k >= grid->space.dims[2])
    return 0;
  const uint64_t *row = vxm_grid_row(grid, j, k);
  int64_t begin = i - REACH;
  if (begin < 0)
    return (unsigned)(row[0] << -begin) & ((1u << WIDTH) - 1);
  size_t w = (size_t)begin / 64;
  unsigned shift = (unsigned)(begin % 64);
  uint64_t bits = row[w] >> shift;
  if (shift > 64 - WIDTH && w + 1 < grid->row_words)
    bits |= row[w + 1] << (64 - shift);
  return (unsigned)bits & ((1u << WIDTH) - 1);
}

static const double weight[WIDTH] = {0.15, 0.45, 0.80, 1.0, 0.80, 0.45, 0.15};

void vxm_scene_weigh(vxm_scene *scene) {
  for (int n = 0; n < VXM_SCENE_TURNS; n++) {
    double turn = 6.283185307179586 * n / VXM_SCENE_TURNS;
    scene->turned[n][0] = cos(turn);
    scene->turned[n][1] = sin(turn);
  }
  for (unsigned bits = 0; bits < 1u << WIDTH; bits++) {
    double mass = 0, moment = 0;
    for (int at = 0; at < WIDTH; at++)
      if (bits >> at & 1) {
        mass += weight[at];
        moment += weight[at] * (at - REACH);
      }
    scene->weighed[bits].mass = mass;
    scene->weighed[bits].moment = moment;
  }
}

/** A gradient of this length, or more, is that of a surface; on a flat side of a solid it is 31. */
static const double whole_gradient = 8;

/**
 * The gradient as seen from a face. What is a voxel thick has as much behind it as in front, so that its
 * gradient is of what stands near by, or of rounding alone: the weaker it is, the more the face itself
 * counts, and none turns away from it, since there is nothing before a face that is seen.
 */
static vxm_ray_vec3 seen_from(vxm_ray_vec3 face, vxm_ray_vec3 gradient) {
  double away = vxm_ray_vec3_dot(gradient, face);
  if (away < 0)
    gradient = vxm_ray_vec3_add(gradient, -away, face);
  double lacking = whole_gradient - sqrt(vxm_ray_vec3_dot(gradient, gradient));
  return lacking > 0 ? vxm_ray_vec3_add(gradient, lacking, face) : gradient;
}

/** The direction in which the neighbourhood empties: the gradient of a blurred grid, in scene coordinates. */
static vxm_ray_vec3 smooth_normal(const vxm_scene *scene, const int64_t voxel[3], vxm_ray_vec3 face) {
  vxm_ray_vec3 sum = {{0, 0, 0}};
  for (int dk = -REACH; dk <= REACH; dk++)
    for (int dj = -REACH; dj <= REACH; dj++) {
      unsigned bits = window(scene->grid, voxel[0], voxel[1] + dj, voxel[2] + dk);
      double mass = scene->weighed[bits].mass, moment = scene->weighed[bits].moment;
      sum = vxm_ray_vec3_add(sum, -weight[dj + REACH] * weight[dk + REACH],
                             vxm_ray_vec3_of(moment, mass * dj, mass * dk));
    }
  sum = seen_from(face, sum);
  for (int a = 0; a < 3; a++)
    sum.c[a] /= scene->step[a];
  return vxm_ray_vec3_unit(sum);
}

/** The two axes along a face, and where on it (0 to 1) a point in voxel coordinates lies. */
static void face_axes(const vxm_hit *hit, const double point[3], int axes[2], double part[2]) {
  axes[0] = (hit->axis + 1) % 3;
  axes[1] = (hit->axis + 2) % 3;
  for (int n = 0; n < 2; n++)
    part[n] = clamp01(point[axes[n]] - (double)hit->voxel[axes[n]]);
}

/**
 * How open the corners of a face are: each of the three voxels in front of it that touch a corner takes a
 * share; interpolated over the face. 1 is fully open.
 */
static double corner_openness(const vxm_grid *grid, const vxm_hit *hit, const int axes[2],
                              const double part[2]) {
  bool near[3][3];
  for (int u = -1; u <= 1; u++)
    for (int v = -1; v <= 1; v++) {
      int64_t at[3] = {hit->voxel[0], hit->voxel[1], hit->voxel[2]};
      at[hit->axis] += hit->positive ? 1 : -1;
      at[axes[0]] += u;
      at[axes[1]] += v;
      near[u + 1][v + 1] = vxm_grid_get(grid, at[0], at[1], at[2]);
    }
  double open = 0;
  for (int u = 0; u < 2; u++)
    for (int v = 0; v < 2; v++) {
      bool a = near[2 * u][1], b = near[1][2 * v], c = near[2 * u][2 * v];
      int blocked = a && b ? 3 : a + b + c;
      open += (u ? part[0] : 1 - part[0]) * (v ? part[1] : 1 - part[1]) * (1 - 0.22 * blocked);
    }
  return open;
}

/** 1 inside a face, 0 on the line between two voxels. */
static double off_line(double width, const double part[2]) {
  double nearest = 1;
  for (int n = 0; n < 2; n++) {
    double distance = part[n] < 0.5 ? part[n] : 1 - part[n];
    nearest = distance < nearest ? distance : nearest;
  }
  return ramp(0.25 * width, width, nearest);
}

/* ---- Light ---- */

/** How much of the sky is seen, by looking along the normal over four distances. 1 is all. */
static double sky_openness(const vxm_scene *scene, const double point[3], vxm_ray_vec3 normal) {
  static const double strength[4] = {0.50, 0.50, 0.45, 0.40};
  double open = 1;
  for (int l = 0; l < 4 && l < scene->mips.levels; l++) {
    double at[3], distance = (double)(4 << l);
    for (int a = 0; a < 3; a++)
      at[a] = point[a] + distance * normal.c[a];
    open *= 1 - strength[l] * vxm_occupancy_mips_sample(&scene->mips, l, at);
  }
  return open;
}

/** Whether the sun, or the point of it that `jitter` picks, is seen from a point in voxel coordinates. */
static bool sees_sun(const vxm_scene *scene, const double point[3], const double jitter[2], double radius) {
  const double *turned = scene->turned[(unsigned)(jitter[0] * VXM_SCENE_TURNS) % VXM_SCENE_TURNS];
  double out = radius * sqrt(jitter[1]), direction[3];
  vxm_ray_vec3 toward = vxm_ray_vec3_add(vxm_ray_vec3_add(scene->light, out * turned[0], scene->side[0]),
                                         out * turned[1], scene->side[1]);
  to_voxels(scene, toward, direction);
  vxm_hit hit;
  return !vxm_raycast(&hit, &scene->mips, point, direction);
}

static vxm_light shade_voxel(const vxm_scene *scene, const vxm_hit *hit, const double origin[3],
                             const double direction[3], const double jitter[2]) {
  double point[3], part[2], outside[3];
  int axes[2];
  for (int a = 0; a < 3; a++)
    outside[a] = point[a] = origin[a] + hit->t * direction[a];
  /* Exactly on the face, then a little in front of it. */
  point[hit->axis] = (double)(hit->voxel[hit->axis] + hit->positive);
  outside[hit->axis] = point[hit->axis] + (hit->positive ? 1e-3 : -1e-3);
  face_axes(hit, point, axes, part);

  vxm_ray_vec3 face = {{0, 0, 0}};
  face.c[hit->axis] = hit->positive ? 1 : -1;
  vxm_ray_vec3 normal = face;
  double crisp = 1 - scene->smoothness, open = 1;
  if (scene->smoothness > 0) {
    vxm_ray_vec3 smooth = smooth_normal(scene, hit->voxel, face);
    normal = vxm_ray_vec3_unit(vxm_ray_vec3_add(vxm_ray_vec3_scale(crisp, face), scene->smoothness, smooth));
    /* A smooth surface throws no shadow from step to step. */
    for (int a = 0; a < 3; a++)
      outside[a] += 2.5 * scene->smoothness * smooth.c[a];
  }
  if (crisp > 0)
    open = 1 - crisp * (1 - corner_openness(scene->grid, hit, axes, part));
  open *= sky_openness(scene, point, normal);

  double toward = vxm_ray_vec3_dot(normal, scene->light), direct = 0, most = 0;
  if (toward > 0 && vxm_ray_vec3_dot(face, scene->light) > -scene->smoothness) {
    most = toward;
    direct = sees_sun(scene, outside, jitter, sun_radius) ? toward : 0;
  }
  double upward = 0.5 + 0.5 * vxm_ray_vec3_dot(normal, scene->up);
  double line = 1 - 0.30 * crisp * (1 - off_line(scene->line_width, part));
  vxm_ray_vec3 own = scene->paint ? scene->paint(scene->painted, hit->voxel) : surface;
  vxm_light seen;
  for (int n = 0; n < 3; n++) {
    double ambient = open * (upward * sky.c[n] + (1 - upward) * ground.c[n]);
    seen.colour.c[n] = line * own.c[n] * (direct * sun.c[n] + ambient);
    seen.plain.c[n] = own.c[n] * (most * sun.c[n] + ambient);
  }
  return seen;
}

/* ---- What is behind the voxels ---- */

vxm_ray_vec3 vxm_shade_background(const vxm_scene *scene, vxm_ray_vec3 origin, vxm_ray_vec3 direction,
                                  double turn) {
  vxm_ray_vec3 white = {{1, 1, 1}};
  double down = vxm_ray_vec3_dot(direction, scene->up),
         height = vxm_ray_vec3_dot(origin, scene->up) - scene->floor;
  if (down >= 0 || height <= 0)
    return white;
  vxm_ray_vec3 at = vxm_ray_vec3_add(origin, -height / down, direction);
  vxm_ray_vec3 away = vxm_ray_vec3_add(at, -1, scene->centre);
  double distance = sqrt(vxm_ray_vec3_dot(away, away)) / scene->radius;
  double near = 1 - ramp(1.2, 3.2, distance);
  if (near <= 0)
    return white;
  double point[3];
  to_voxels(scene, vxm_ray_vec3_add(at, 1e-6, scene->up), point);
  double open = sky_openness(scene, point, scene->up);
  double direct = 0;
  for (int n = 0; n < 8; n++) {
    const double jitter[2] = {turn + 0.125 * n, ((n * 3 & 7) + 0.5) / 8};
    direct += 0.125 * sees_sun(scene, point, jitter, 2 * sun_radius);
  }
  vxm_ray_vec3 colour;
  for (int n = 0; n < 3; n++)
    colour.c[n] = 1 - near * (0.40 * (1 - direct) + (0.60 - 0.02 * n) * (1 - open));
  return colour;
}

bool vxm_shade(vxm_light *out, const vxm_scene *scene, vxm_ray_vec3 origin, vxm_ray_vec3 direction,
               const double jitter[2]) {
  double from[3], along[3];
  to_voxels(scene, origin, from);
  to_voxels(scene, direction, along);
  vxm_hit hit;
  if (!vxm_raycast(&hit, &scene->mips, from, along) || hit.axis < 0)
    return false;
  *out = shade_voxel(scene, &hit, from, along, jitter);
  return true;
}
