/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/tiles.h"

typedef struct extent {
  double low[2], high[2]; /**< pixels */
  double depth;           /**< of the nearest corner */
} extent;

/** Where a cell of `side` voxels lies in the picture; false if some corner of it is not before the eye. */
static bool project(extent *out, const vxm_scene *scene, const vxm_camera *cam, const int64_t cell[3],
                    int64_t side) {
  *out = (extent){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY};
  for (int corner = 0; corner < 8; corner++) {
    vxm_ray_vec3 p;
    for (int a = 0; a < 3; a++)
      p.c[a] = (double)((cell[a] + (corner >> a & 1)) * side) * scene->step[a];
    p = vxm_ray_vec3_add(p, -1, cam->eye);
    double depth = -vxm_ray_vec3_dot(p, cam->back);
    if (!(depth > 1e-9))
      return false;
    double scale = 1 / (depth * cam->pixel);
    double at[2] = {0.5 * cam->width + vxm_ray_vec3_dot(p, cam->right) * scale,
                    0.5 * cam->height - vxm_ray_vec3_dot(p, cam->top) * scale};
    for (int n = 0; n < 2; n++) {
      out->low[n] = at[n] < out->low[n] ? at[n] : out->low[n];
      out->high[n] = at[n] > out->high[n] ? at[n] : out->high[n];
    }
    out->depth = depth < out->depth ? depth : out->depth;
  }
  return true;
}

static int tile_at(double pixel, int tiles) {
  double tile = floor(pixel / VXM_PICTURE_TILE);
  return tile < 0 ? 0 : tile >= tiles ? tiles - 1 : (int)tile;
}

/** Marks the tiles under a cell. A pixel more on each side, and a little less depth, are for rounding. */
static void mark(vxm_tiles *tiles, const vxm_scene *scene, const vxm_camera *cam, const int64_t cell[3],
                 int64_t side) {
  extent e;
  if (!project(&e, scene, cam, cell, side))
    e = (extent){{0, 0}, {cam->width, cam->height}, 0};
  if (e.high[0] < -1 || e.high[1] < -1 || e.low[0] > cam->width + 1 || e.low[1] > cam->height + 1)
    return;
  float depth = (float)(e.depth * 0.999);
  int x1 = tile_at(e.high[0] + 1, tiles->width), y1 = tile_at(e.high[1] + 1, tiles->height);
  for (int y = tile_at(e.low[1] - 1, tiles->height); y <= y1; y++)
    for (int x = tile_at(e.low[0] - 1, tiles->width); x <= x1; x++) {
      float *at = tiles->depth + y * tiles->width + x;
      *at = depth < *at ? depth : *at;
    }
}

/** The finest level whose number of cells is bounded: to go through them takes less time than it saves. */
static int choose_level(const vxm_occupancy_mips *mips) {
  const int64_t most = 1 << 19;
  int level = 0;
  while (level + 1 < mips->levels &&
         mips->level[level].dims[0] * mips->level[level].dims[1] * mips->level[level].dims[2] > most)
    level++;
  return level;
}

vxm_status vxm_tiles_create(vxm_tiles *out, const vxm_scene *scene, const vxm_camera *cam, vxm_error *error) {
  *out = (vxm_tiles){.context = scene->grid->context,
                     .width = cam->width / VXM_PICTURE_TILE + 1,
                     .height = cam->height / VXM_PICTURE_TILE + 1};
  size_t count = (size_t)out->width * (size_t)out->height;
  vxm_status status = VXM_OK;
  out->depth = vxm_try_alloc(out->context, count, sizeof *out->depth, &status, error);
  if (!out->depth)
    return status;
  for (size_t i = 0; i < count; i++)
    out->depth[i] = INFINITY;
  int level = choose_level(&scene->mips);
  const int64_t *dims = scene->mips.level[level].dims;
  const uint8_t *cells = scene->mips.level[level].cells;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++) {
        if (*cells++ != 0)
          mark(out, scene, cam, (int64_t[3]){i, j, k}, INT64_C(4) << level);
      }
  return VXM_OK;
}

void vxm_tiles_destroy(vxm_tiles *tiles) {
  vxm_free(tiles->context, tiles->depth);
  tiles->depth = NULL;
}
