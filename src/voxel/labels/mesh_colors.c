/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/mesh_colors.h"
#include "base/threads.h"
#include "voxel/closest/surface_tree.h"
#include "voxel/labels/surface_mean.h"

#include <math.h>
#include <string.h>

vxm_status vxm_mesh_colors_check(const vxm_soup *mesh, vxm_error *error) {
  const vxm_appearance *appearance = mesh->appearance;
  if (!appearance)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "colours: the mesh was read without its colours, or is the result of a repair");
  if (vxm_appearance_has_colors(appearance))
    return VXM_OK;
  for (size_t m = 0; m < appearance->material_count && appearance->face_materials; m++) {
    const vxm_material *material = &appearance->materials[m];
    if (material->image < appearance->image_count && appearance->images[material->image].failure[0])
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "the mesh has no colours: the texture %.80s of material %.40s cannot be read: %.199s",
                      appearance->images[material->image].name, material->name,
                      appearance->images[material->image].failure);
    if (material->image < appearance->image_count && !appearance->corner_uvs)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "the mesh has no colours: its corners have no coordinates for the texture %.80s",
                      appearance->images[material->image].name);
  }
  if (appearance->library_failure[0])
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "the mesh has no colours: %s", appearance->library_failure);
  if (appearance->material_count > 0)
    return vxm_fail(
        error, VXM_ERROR_ARGUMENT, "the mesh has no colours: nothing is known of its material%s%.100s",
        appearance->materials[0].name[0] ? " " : ", which has no name", appearance->materials[0].name);
  return vxm_fail(error, VXM_ERROR_ARGUMENT,
                  "the mesh has no colours: neither its vertices and faces nor materials give any");
}

/* ---- One point ---- */

static void between(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = b[i] - a[i];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Weights along the longest edge of a triangle that is no more than that. */
static void weigh_edge(const double at[3][3], const double p[3], double weight[3]) {
  double longest = -1, ab[3], ap[3];
  for (int e = 0; e < 3; e++) {
    int b = (e + 1) % 3;
    between(ab, at[e], at[b]);
    between(ap, at[e], p);
    double length2 = dot(ab, ab), along = length2 > 0 ? dot(ab, ap) / length2 : 0;
    if (length2 <= longest)
      continue;
    longest = length2;
    along = along < 0 ? 0 : along > 1 ? 1 : along;
    weight[(e + 2) % 3] = 0;
    weight[e] = 1 - along;
    weight[b] = along;
  }
}

/** The weights of the corners at a point of a triangle (Ericson, Real-Time Collision Detection, 3.4). */
static void weigh(const double at[3][3], const double p[3], double weight[3]) {
  double ab[3], ac[3], ap[3];
  between(ab, at[0], at[1]);
  between(ac, at[0], at[2]);
  between(ap, at[0], p);
  double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
  double area = bb * cc - bc * bc, sum = 0;
  if (!(area > 1e-12 * bb * cc)) {
    weigh_edge(at, p, weight);
    return;
  }
  weight[1] = (cc * pb - bc * pc) / area;
  weight[2] = (bb * pc - bc * pb) / area;
  weight[0] = 1 - weight[1] - weight[2];
  for (int c = 0; c < 3; c++) {
    weight[c] = weight[c] > 0 ? weight[c] : 0;
    sum += weight[c];
  }
  for (int c = 0; c < 3; c++)
    weight[c] /= sum;
}

/* ---- All voxels ---- */

typedef struct color_task {
  const vxm_space *space;
  const vxm_grid *grid; /**< all voxels; NULL = those of a node */
  const uint64_t *rows; /**< of the node whose first voxel is `first` */
  int64_t first[3];
  const vxm_surface_paint *paint;
  const vxm_surface_tree *tree;
  const vxm_surface_slices *slices; /**< NULL = no means */
  vxm_surface_sum *sums;            /**< a slice for each worker */
  uint8_t *values;
} color_task;

static void put_color(uint8_t value[4], const double light[3]) {
  for (int c = 0; c < 3; c++)
    value[c] = vxm_srgb_encode(light[c]);
  value[3] = 255;
}

/** Voxels along an edge of a tile, which look together for what may be near; its halves do so in turn, over
 * so many levels, where there are voxels enough for it to be worth it. */
enum { TILE = 8, LEVELS = 3, WORTH = 6 };

static void find_centre(double p[3], const vxm_space *space, const int64_t at[3]) {
  for (int a = 0; a < 3; a++)
    p[a] = space->origin[a] + ((double)at[a] + 0.5) * space->voxel_size[a];
}

static void color_by_hit(const color_task *task, const vxm_surface_hit *hit, uint8_t value[4]) {
  double corner[3][3], weight[3] = {1, 0, 0}, light[3];
  vxm_surface_paint_corners(corner, hit->triangle, task->paint);
  weigh((const double(*)[3])corner, hit->foot, weight);
  vxm_surface_paint_color(task->paint, hit->triangle, weight, light);
  put_color(value, light);
}

/** A box of voxels. */
typedef struct tile {
  int64_t first[3], end[3];
} tile;

static uint8_t *value_at(const color_task *task, const int64_t at[3]) {
  const int64_t *dims = task->space->dims, *first = task->first;
  if (!task->grid)
    return task->values +
           4 * (size_t)(((at[2] - first[2]) * VXM_NODE_SIDE + at[1] - first[1]) * VXM_NODE_SIDE + at[0] -
                        first[0]);
  return task->values + 4 * (size_t)((at[0] * dims[1] + at[1]) * dims[2] + at[2]);
}

static bool is_set(const color_task *task, const int64_t at[3]) {
  const int64_t *first = task->first;
  if (task->grid)
    return vxm_grid_get(task->grid, at[0], at[1], at[2]);
  return task->rows[(at[2] - first[2]) * VXM_NODE_SIDE + at[1] - first[1]] >> (at[0] - first[0]) & 1;
}

/** The next voxel from `at` on that is set and has no mean. */
static bool find_voxel(const color_task *task, const tile *t, int64_t at[3]) {
  for (; at[0] < t->end[0]; at[0]++, at[1] = t->first[1])
    for (; at[1] < t->end[1]; at[1]++, at[2] = t->first[2])
      for (; at[2] < t->end[2]; at[2]++)
        if (is_set(task, at) && value_at(task, at)[3] == 0)
          return true;
  return false;
}

static int count_voxels(const color_task *task, const tile *t) {
  int count = 0;
  int64_t at[3] = {t->first[0], t->first[1], t->first[2]};
  for (; find_voxel(task, t, at); at[2]++)
    count++;
  return count;
}

/** The ball around the centres of a tile's voxels. */
static double find_ball(double centre[3], const color_task *task, const tile *t) {
  const int64_t last[3] = {t->end[0] - 1, t->end[1] - 1, t->end[2] - 1};
  double low[3], high[3], square = 0;
  find_centre(low, task->space, t->first);
  find_centre(high, task->space, last);
  for (int a = 0; a < 3; a++) {
    centre[a] = low[a] / 2 + high[a] / 2;
    double half = fmax(high[a] - centre[a], centre[a] - low[a]);
    square += half * half;
  }
  return sqrt(square) * (1 + 1e-9);
}

static void color_voxels(const color_task *task, const tile *t, const vxm_surface_candidates *among,
                         uint32_t *near) {
  int64_t at[3] = {t->first[0], t->first[1], t->first[2]};
  for (; find_voxel(task, t, at); at[2]++) {
    double p[3];
    find_centre(p, task->space, at);
    vxm_surface_hit hit = among ? vxm_surface_candidates_nearest(among, p, *near)
                                : vxm_surface_tree_nearest(task->tree, p, *near);
    *near = hit.place;
    color_by_hit(task, &hit, value_at(task, at));
  }
}

static int64_t lesser(int64_t a, int64_t b) {
  return a < b ? a : b;
}

/** Colours a tile part by part: each gathers what may be near out of what the whole has gathered.
 * @param room for each level
 * @param among the candidates of a larger tile, or NULL */
static void color_tile(const color_task *task, const tile *t, int level, vxm_surface_candidates *room,
                       const vxm_surface_candidates *among, uint32_t *near) {
  const int64_t half = TILE >> (level + 1);
  double centre[3];
  const int count = count_voxels(task, t);
  if (count < WORTH) {
    color_voxels(task, t, among, near);
    return;
  }
  const double radius = find_ball(centre, task, t);
  if (among ? vxm_surface_candidates_narrow(room, among, centre, radius, near)
            : vxm_surface_candidates_gather(room, task->tree, centre, radius, near))
    among = room++;
  if (level + 1 == LEVELS) {
    color_voxels(task, t, among, near);
    return;
  }
  for (int part = 0; part < 8; part++) {
    tile inner;
    bool is_there = true;
    for (int a = 0; a < 3; a++) {
      inner.first[a] = t->first[a] + (part >> a & 1) * half;
      inner.end[a] = lesser(inner.first[a] + half, t->end[a]);
      is_there = is_there && inner.first[a] < inner.end[a];
    }
    if (is_there)
      color_tile(task, &inner, level + 1, room, among, near);
  }
}

/** Means of the surface within the voxels of a slice. */
static void color_by_means(const color_task *task, int64_t slice, vxm_surface_sum *sums) {
  const int64_t *dims = task->space->dims;
  const size_t rows = (size_t)(dims[1] * dims[2]);
  uint8_t *value = value_at(task, (const int64_t[3]){slice, 0, 0});
  memset(sums, 0, rows * sizeof *sums);
  vxm_surface_slices_sum(task->slices, slice, sums);
  for (int64_t j = 0; j < dims[1]; j++)
    for (int64_t k = 0; k < dims[2]; k++, value += 4, sums++)
      if (sums->area > 0 && vxm_grid_get(task->grid, slice, j, k)) {
        const double light[3] = {sums->light[0] / sums->area, sums->light[1] / sums->area,
                                 sums->light[2] / sums->area};
        put_color(value, light);
      }
}

/** TILE slices. */
static void color_slab(size_t slab, int worker, void *payload) {
  const color_task *task = payload;
  const int64_t *dims = task->space->dims;
  const size_t rows = (size_t)(dims[1] * dims[2]);
  tile t = {.first = {(int64_t)slab * TILE}};
  t.end[0] = lesser(t.first[0] + TILE, dims[0]);
  vxm_surface_candidates room[LEVELS];
  uint32_t near = 0;
  memset(value_at(task, t.first), 0, 4 * rows * (size_t)(t.end[0] - t.first[0]));
  for (int64_t i = t.first[0]; i < t.end[0] && task->slices; i++)
    color_by_means(task, i, task->sums + (size_t)worker * rows);
  for (t.first[1] = 0; t.first[1] < dims[1]; t.first[1] += TILE) {
    t.end[1] = lesser(t.first[1] + TILE, dims[1]);
    for (t.first[2] = 0; t.first[2] < dims[2]; t.first[2] += TILE) {
      t.end[2] = lesser(t.first[2] + TILE, dims[2]);
      color_tile(task, &t, 0, room, NULL, &near);
    }
  }
}

static vxm_status color_all(color_task *task, bool average, vxm_error *error) {
  vxm_context *context = task->grid->context;
  const int64_t *dims = task->space->dims;
  vxm_surface_slices slices;
  vxm_error local = VXM_ERROR_INIT;
  bool is_open = false;
  if (average) {
    is_open = vxm_surface_slices_open(&slices, task->paint, &task->grid->space, &local) == VXM_OK;
    task->slices = &slices;
    if (is_open)
      task->sums = vxm_alloc(context, (size_t)vxm_context_threads(context),
                             (size_t)(dims[1] * dims[2]) * sizeof *task->sums, &local);
  }
  if (local.code == VXM_OK)
    vxm_parallel_cancellable(context, (size_t)((dims[0] + TILE - 1) / TILE), color_slab, task, &local);
  vxm_free(context, task->sums);
  if (is_open)
    vxm_surface_slices_close(&slices);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/* ---- Meshes ---- */

struct vxm_mesh_painter {
  vxm_context *context;
  vxm_surface_paint paint;
  vxm_surface_tree *tree;
};

vxm_status vxm_mesh_painter_create(vxm_mesh_painter **out, vxm_context *context, const vxm_soup *mesh,
                                   vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_mesh_painter *p = *out = vxm_calloc(context, 1, sizeof *p, &local);
  vxm_status status = p ? vxm_surface_paint_open(&p->paint, mesh, &local) : local.code;
  if (status != VXM_OK) {
    vxm_free(context, p);
    *out = NULL;
    vxm_error_pass(error, &local);
    return status;
  }
  p->context = context;
  if (p->paint.count == 0)
    status = vxm_fail(error, VXM_ERROR_EMPTY, "colours: the mesh has no triangle with finite corners");
  if (status == VXM_OK)
    status = vxm_surface_tree_create(&p->tree, context, p->paint.count, vxm_surface_paint_corners, &p->paint,
                                     error);
  if (status != VXM_OK) {
    vxm_mesh_painter_destroy(p);
    *out = NULL;
  }
  return status;
}

void vxm_mesh_painter_destroy(vxm_mesh_painter *painter) {
  if (!painter)
    return;
  vxm_surface_tree_destroy(painter->tree);
  vxm_surface_paint_close(&painter->paint);
  vxm_free(painter->context, painter);
}

void vxm_mesh_painter_node(const vxm_mesh_painter *painter, uint8_t *values, const vxm_space *space,
                           const int64_t at[3], const uint64_t *rows, uint32_t *near) {
  const color_task task = {.space = space,
                           .rows = rows,
                           .first = {at[0], at[1], at[2]},
                           .paint = &painter->paint,
                           .tree = painter->tree,
                           .values = values};
  vxm_surface_candidates room[LEVELS];
  for (int part = 0; part < 8; part++) {
    tile t;
    for (int a = 0; a < 3; a++) {
      t.first[a] = at[a] + (part >> a & 1) * TILE;
      t.end[a] = lesser(t.first[a] + TILE, at[a] + vxm_node_count(space, at, a));
    }
    color_tile(&task, &t, 0, room, NULL, near);
  }
}

vxm_status vxm_mesh_colors(uint8_t *values, const vxm_grid *grid, const vxm_soup *mesh, bool average,
                           vxm_error *error) {
  vxm_mesh_painter *painter;
  vxm_status status = vxm_mesh_painter_create(&painter, grid->context, mesh, error);
  if (status != VXM_OK)
    return status;
  color_task task = {
      .space = &grid->space, .grid = grid, .paint = &painter->paint, .tree = painter->tree, .values = values};
  status = color_all(&task, average, error);
  vxm_mesh_painter_destroy(painter);
  return status;
}

uint64_t vxm_mesh_colors_bytes(const vxm_soup *mesh, const vxm_space *space, bool average) {
  size_t triangles =
      mesh->corner_count > 2 * mesh->face_count ? mesh->corner_count - 2 * mesh->face_count : 0;
  uint64_t bytes = vxm_surface_tree_bytes(triangles) + 2 * triangles * sizeof(vxm_painted_triangle) +
                   mesh->face_count * (1 + sizeof(uint32_t));
  if (average)
    bytes += (uint64_t)vxm_context_threads(mesh->context) * (uint64_t)(space->dims[1] * space->dims[2]) *
             sizeof(vxm_surface_sum);
  return bytes;
}
