/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/surface_paint.h"
#include "mesh/inward_faces.h"
#include "mesh/nonfinite.h"
#include "mesh/triangulate.h"

#include <math.h>
#include <string.h>

/* ---- Triangles ---- */

/** The corners of a polygon, side by side, for the triangulation. */
typedef struct cutter {
  vxm_surface_paint *paint;
  vxm_triangulator triangulator;
  double *positions;
  uint32_t *numbers; /**< 0, 1, 2, ... */
  uint8_t *inward;   /**< per face */
  size_t capacity, number_capacity, triangle_capacity;
} cutter;

static vxm_status add(cutter *cut, size_t face, const uint32_t *corners, const uint32_t corner[3],
                      vxm_error *error) {
  vxm_surface_paint *paint = cut->paint;
  vxm_context *context = paint->soup->context;
  const uint32_t triangle[3] = {corners[corner[0]], corners[corner[1]], corners[corner[2]]};
  if (!vxm_face_is_finite(paint->soup, triangle, 3))
    return VXM_OK;
  if (paint->count >= UINT32_MAX - 1 || face > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "colours: the mesh has 2^32 triangles or more");
  vxm_status status = vxm_grow(context, (void **)&paint->triangles, &cut->triangle_capacity, paint->count + 1,
                               sizeof *paint->triangles, error);
  bool turns = cut->inward[face];
  if (status == VXM_OK)
    paint->triangles[paint->count++] =
        (vxm_painted_triangle){(uint32_t)face, {corner[0], corner[turns ? 2 : 1], corner[turns ? 1 : 2]}};
  return status;
}

static vxm_status cut_polygon(cutter *cut, size_t face, const uint32_t *corners, size_t n, vxm_error *error) {
  const vxm_soup *soup = cut->paint->soup;
  vxm_context *context = soup->context;
  const uint32_t *triangles;
  vxm_status status =
      vxm_renew(context, (void **)&cut->positions, &cut->capacity, n, 3 * sizeof *cut->positions, error);
  if (status == VXM_OK)
    status =
        vxm_renew(context, (void **)&cut->numbers, &cut->number_capacity, n, sizeof *cut->numbers, error);
  if (status != VXM_OK)
    return status;
  for (size_t c = 0; c < n; c++) {
    memcpy(cut->positions + 3 * c, vxm_position(soup, corners[c]), 3 * sizeof(double));
    cut->numbers[c] = (uint32_t)c;
  }
  status = vxm_triangulate(&cut->triangulator, cut->positions, cut->numbers, n, &triangles, error);
  for (size_t t = 0; t + 2 < n && status == VXM_OK; t++)
    status = add(cut, face, corners, triangles + 3 * t, error);
  return status;
}

static vxm_status cut_all(cutter *cut, vxm_error *error) {
  static const uint32_t whole[3] = {0, 1, 2};
  const vxm_soup *soup = cut->paint->soup;
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t n;
    const uint32_t *corners = vxm_face(soup, f, &n);
    if (n == 3)
      status = add(cut, f, corners, whole, error);
    else if (n > 3 && n < UINT32_MAX)
      status = cut_polygon(cut, f, corners, n, error);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(f, soup->context, error);
  }
  return status;
}

vxm_status vxm_surface_paint_open(vxm_surface_paint *paint, const vxm_soup *soup, vxm_error *error) {
  *paint = (vxm_surface_paint){.soup = soup};
  for (int b = 0; b < 256; b++)
    paint->light[b] = (float)vxm_srgb_decode(b / 255.0);
  cutter cut = {.paint = paint};
  vxm_error local = VXM_ERROR_INIT;
  cut.inward = vxm_alloc(soup->context, soup->face_count, sizeof *cut.inward, &local);
  vxm_status status = cut.inward ? vxm_inward_faces(cut.inward, soup, &local) : local.code;
  vxm_triangulator_open(&cut.triangulator, soup->context);
  if (status == VXM_OK)
    status = cut_all(&cut, &local);
  vxm_triangulator_close(&cut.triangulator);
  vxm_free(soup->context, cut.positions);
  vxm_free(soup->context, cut.numbers);
  vxm_free(soup->context, cut.inward);
  if (status != VXM_OK) {
    vxm_surface_paint_close(paint);
    vxm_error_pass(error, &local);
  }
  return status;
}

void vxm_surface_paint_close(vxm_surface_paint *paint) {
  vxm_free(paint->soup->context, paint->triangles);
  paint->triangles = NULL;
  paint->count = 0;
}

/** Where a corner of a triangle stands among those of the soup. */
static size_t corner_of(const vxm_surface_paint *paint, const vxm_painted_triangle *triangle, int c) {
  return (size_t)paint->soup->offsets[triangle->face] + triangle->corner[c];
}

void vxm_surface_paint_corners(double out[3][3], size_t triangle, const void *paint) {
  const vxm_surface_paint *p = paint;
  for (int c = 0; c < 3; c++)
    memcpy(out[c], vxm_position(p->soup, p->soup->indices[corner_of(p, &p->triangles[triangle], c)]),
           sizeof out[c]);
}

/* ---- Textures ---- */

/** Brings a coordinate into 0 to 1. */
static double wrap(double x, uint8_t how) {
  if (how == VXM_WRAP_CLAMP)
    return x < 0 ? 0 : x > 1 ? 1 : x;
  double turns = how == VXM_WRAP_MIRROR ? 2 : 1, rest = x - turns * floor(x / turns);
  return rest > 1 ? turns - rest : rest;
}

/** A pixel's number, which may be one beyond the borders. */
static size_t wrap_pixel(int64_t at, uint32_t size, uint8_t how) {
  if (at >= 0 && at < (int64_t)size)
    return (size_t)at;
  if (how == VXM_WRAP_REPEAT)
    return at < 0 ? size - 1 : 0;
  return at < 0 ? 0 : size - 1;
}

/** Between the four pixels about a place: their middles are at halves. */
static void sample(const vxm_surface_paint *paint, const vxm_image *image, const uint8_t how[2], double u,
                   double v, double rgb[3]) {
  double x = wrap(u, how[0]) * image->width - 0.5, y = (1 - wrap(v, how[1])) * image->height - 0.5;
  double left = floor(x), top = floor(y), across = x - left, down = y - top;
  const double share[2][2] = {{(1 - across) * (1 - down), across * (1 - down)},
                              {(1 - across) * down, across * down}};
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int r = 0; r < 2; r++)
    for (int c = 0; c < 2; c++) {
      size_t row = wrap_pixel((int64_t)top + r, image->height, how[1]),
             column = wrap_pixel((int64_t)left + c, image->width, how[0]);
      const unsigned char *pixel = image->bytes + 4 * (row * image->width + column);
      for (int a = 0; a < 3; a++)
        rgb[a] += share[r][c] * (double)paint->light[pixel[a]];
    }
}

static const vxm_material *material_of(const vxm_surface_paint *paint, size_t face) {
  const vxm_appearance *appearance = paint->soup->appearance;
  bool has =
      face < appearance->face_material_count && appearance->face_materials[face] < appearance->material_count;
  return has ? &appearance->materials[appearance->face_materials[face]] : NULL;
}

static const vxm_image *image_of(const vxm_surface_paint *paint, const vxm_material *material) {
  const vxm_appearance *appearance = paint->soup->appearance;
  if (!material || material->image >= appearance->image_count || !appearance->corner_uvs)
    return NULL;
  const vxm_image *image = &appearance->images[material->image];
  return image->width > 0 ? image : NULL;
}

/** The texture coordinates of a point of a triangle; false where corners have none. */
static bool find_uv(const vxm_surface_paint *paint, const vxm_painted_triangle *triangle,
                    const double weight[3], double uv[2]) {
  uv[0] = uv[1] = 0;
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 2; a++)
      uv[a] += weight[c] * (double)paint->soup->appearance->corner_uvs[corner_of(paint, triangle, c)][a];
  return isfinite(uv[0]) && isfinite(uv[1]);
}

static bool find_texture(const vxm_surface_paint *paint, const vxm_painted_triangle *triangle,
                         const vxm_material *material, const double weight[3], double rgb[3]) {
  const vxm_image *image = image_of(paint, material);
  double uv[2];
  if (!image || !find_uv(paint, triangle, weight, uv))
    return false;
  sample(paint, image, material->wrap, uv[0], uv[1], rgb);
  return true;
}

double vxm_surface_paint_pixels(const vxm_surface_paint *paint, size_t triangle, const double (*weight)[3],
                                int count) {
  const vxm_painted_triangle *t = &paint->triangles[triangle];
  const vxm_image *image = image_of(paint, material_of(paint, t->face));
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, uv[2];
  for (int i = 0; i < count && image; i++) {
    if (!find_uv(paint, t, weight[i], uv))
      return 0;
    for (int a = 0; a < 2; a++) {
      low[a] = fmin(low[a], uv[a]);
      high[a] = fmax(high[a], uv[a]);
    }
  }
  return image ? fmax((high[0] - low[0]) * image->width, (high[1] - low[1]) * image->height) : 0;
}

/* ---- Colours ---- */

static bool find_vertex_color(const vxm_surface_paint *paint, const vxm_painted_triangle *triangle,
                              const double weight[3], double rgb[3]) {
  const vxm_soup *soup = paint->soup;
  const vxm_appearance *appearance = soup->appearance;
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int c = 0; c < 3; c++) {
    uint32_t vertex = soup->indices[corner_of(paint, triangle, c)];
    if (vertex >= appearance->vertex_color_count || appearance->vertex_colors[vertex][3] == 0)
      return false;
    for (int a = 0; a < 3; a++)
      rgb[a] += weight[c] * (double)paint->light[appearance->vertex_colors[vertex][a]];
  }
  return true;
}

static bool find_face_color(const vxm_surface_paint *paint, size_t face, double rgb[3]) {
  const vxm_appearance *appearance = paint->soup->appearance;
  if (face >= appearance->face_color_count || appearance->face_colors[face][3] == 0)
    return false;
  for (int a = 0; a < 3; a++)
    rgb[a] = (double)paint->light[appearance->face_colors[face][a]];
  return true;
}

void vxm_surface_paint_color(const vxm_surface_paint *paint, size_t triangle, const double weight[3],
                             double rgb[3]) {
  const vxm_painted_triangle *t = &paint->triangles[triangle];
  const vxm_material *material = material_of(paint, t->face);
  const bool is_product = paint->soup->appearance->is_product;
  double part[3], product[3] = {1, 1, 1};
  for (int a = 0; a < 3 && material && material->has_color; a++)
    product[a] = (double)material->color[a];
  bool found = find_texture(paint, t, material, weight, part);
  for (int a = 0; a < 3 && found; a++)
    product[a] = is_product ? product[a] * part[a] : part[a];
  if (!found || is_product) {
    found = find_vertex_color(paint, t, weight, part) || find_face_color(paint, t->face, part);
    for (int a = 0; a < 3 && found; a++)
      product[a] = is_product ? product[a] * part[a] : part[a];
  }
  memcpy(rgb, product, sizeof product);
}
