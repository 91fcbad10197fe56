/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Colours of voxels from the mesh against brute force: the nearest of all triangles, textures sampled by a
 * formula of the test's own, means against many points strewn over the surface; and what readers make of
 * colours in files.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "meshio/meshio.h"
#include "voxel/labels/mesh_colors.h"
#include "voxel/labels/surface_mean.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TRIANGLES = 14, SIDE = 9, VOXELS = SIDE * SIDE * SIDE };

static uint64_t state;

/** splitmix64 */
static uint64_t next(void) {
  uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static double between(double low, double high) {
  return low + (high - low) * (double)(next() >> 11) * 0x1p-53;
}

/* ---- Meshes ---- */

typedef enum kind { VERTICES, FACES, MATERIALS, TEXTURES, PRODUCT, KINDS } kind;

/** Random triangles whose vertices are their own, with what `k` says. */
static vxm_soup *make(kind k, int threads) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  vxm_context *context;
  vxm_soup *soup;
  options.threads = threads;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
  assert_int_equal(vxm_appearance_create(&soup->appearance, soup->context, NULL), VXM_OK);
  vxm_context_destroy(context);
  vxm_appearance *appearance = soup->appearance;
  uint32_t material[3], image[2];
  for (int t = 0; t < TRIANGLES; t++) {
    double middle[3] = {between(1, 8), between(1, 8), between(1, 8)};
    for (int c = 0; c < 3; c++)
      vxm_soup_add_vertex(soup, middle[0] + between(-3, 3), middle[1] + between(-3, 3),
                          middle[2] + between(-3, 3), NULL);
    const uint32_t corners[3] = {3 * (uint32_t)t, 3 * (uint32_t)t + 1, 3 * (uint32_t)t + 2};
    vxm_soup_add_face(soup, corners, 3, NULL);
  }
  appearance->is_product = k == PRODUCT;
  appearance->vertices.unit = appearance->faces.unit = 255;
  for (size_t v = 0; v < soup->vertex_count && (k == VERTICES || k == PRODUCT); v++)
    vxm_gather_color(
        &appearance->vertices, soup->context, v,
        (const double[4]){(double)(next() % 256), (double)(next() % 256), (double)(next() % 256), 0}, NULL);
  for (size_t f = 0; f < soup->face_count && k == FACES; f++)
    vxm_gather_color(
        &appearance->faces, soup->context, f,
        (const double[4]){(double)(next() % 256), (double)(next() % 256), (double)(next() % 256), 0}, NULL);
  assert_int_equal(vxm_appearance_settle(appearance, soup->vertex_count, soup->face_count, NULL), VXM_OK);
  if (k < MATERIALS)
    return soup;
  for (int i = 0; i < 2; i++) {
    vxm_appearance_image(appearance, i ? "second" : "first", i ? 6 : 5, &image[i], NULL);
    vxm_image *made = &appearance->images[image[i]];
    made->width = i ? 3 : 7;
    made->height = i ? 8 : 5;
    made->size = 4 * (uint64_t)made->width * made->height;
    made->bytes = vxm_alloc(soup->context, (size_t)made->size, 1, NULL);
    for (size_t b = 0; b < made->size; b++)
      made->bytes[b] = (unsigned char)next();
  }
  for (int m = 0; m < 3; m++) {
    vxm_appearance_add_material(appearance, "m", 1, &material[m], NULL);
    vxm_material *made = &appearance->materials[material[m]];
    made->has_color = true;
    for (int c = 0; c < 3; c++)
      made->color[c] = (float)between(0, 1);
    made->image = k == MATERIALS || m == 2 ? VXM_APPEARANCE_NONE : image[m];
    for (int a = 0; a < 2; a++)
      made->wrap[a] = (uint8_t)(next() % 3);
  }
  appearance->corner_uvs = vxm_alloc(soup->context, soup->corner_count, sizeof *appearance->corner_uvs, NULL);
  appearance->corner_uv_count = soup->corner_count;
  for (size_t c = 0; c < soup->corner_count; c++)
    for (int a = 0; a < 2; a++)
      appearance->corner_uvs[c][a] = c == 4 ? NAN : (float)between(-0.7, 1.6);
  for (size_t f = 0; f < soup->face_count; f++)
    vxm_appearance_set_material(appearance, f, f == 0 ? VXM_APPEARANCE_NONE : material[next() % 3], NULL);
  return soup;
}

/* ---- The oracle ---- */

static double light_of(uint8_t byte) {
  double x = byte / 255.0;
  return x < 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

static int byte_of(double light) {
  double x = light < 0.0031308 ? light * 12.92 : 1.055 * pow(light, 1 / 2.4) - 0.055;
  return (int)lround(fmin(fmax(x, 0), 1) * 255);
}

/** The pixel of a column or row number that may lie anywhere. */
static int fold(int at, int size, int how) {
  if (how == VXM_WRAP_CLAMP)
    return at < 0 ? 0 : at >= size ? size - 1 : at;
  int period = how == VXM_WRAP_MIRROR ? 2 * size : size;
  at = (at % period + period) % period;
  return at < size ? at : period - 1 - at;
}

/** All pixels are looked at, each with the weight of a tent about its middle. */
static void texture(const vxm_image *image, const uint8_t how[2], double u, double v, double rgb[3]) {
  double x = u * image->width, y = (1 - v) * image->height;
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int row = (int)floor(y) - 2; row <= (int)floor(y) + 2; row++)
    for (int column = (int)floor(x) - 2; column <= (int)floor(x) + 2; column++) {
      double weight = fmax(0, 1 - fabs(x - column - 0.5)) * fmax(0, 1 - fabs(y - row - 0.5));
      const unsigned char *pixel =
          image->bytes + 4 * (fold(row, (int)image->height, how[1]) * (int)image->width +
                              fold(column, (int)image->width, how[0]));
      for (int c = 0; c < 3; c++)
        rgb[c] += weight * light_of(pixel[c]);
    }
}

static void color_at(const vxm_soup *soup, size_t f, const double weight[3], double rgb[3]) {
  const vxm_appearance *appearance = soup->appearance;
  double u = 0, v = 0, vertex[3] = {0, 0, 0}, picture[3];
  bool has_texture = false;
  for (int a = 0; a < 3; a++)
    rgb[a] = appearance->face_colors ? light_of(appearance->face_colors[f][a]) : 1;
  for (int c = 0; c < 3 && appearance->vertex_colors; c++)
    for (int a = 0; a < 3; a++)
      vertex[a] += weight[c] * light_of(appearance->vertex_colors[3 * f + (size_t)c][a]);
  if (appearance->face_materials && appearance->face_materials[f] != VXM_APPEARANCE_NONE) {
    const vxm_material *material = &appearance->materials[appearance->face_materials[f]];
    for (int a = 0; a < 3; a++)
      rgb[a] = (double)material->color[a];
    for (int c = 0; c < 3; c++) {
      u += weight[c] * (double)appearance->corner_uvs[3 * f + (size_t)c][0];
      v += weight[c] * (double)appearance->corner_uvs[3 * f + (size_t)c][1];
    }
    has_texture = material->image != VXM_APPEARANCE_NONE && isfinite(u) && isfinite(v);
    if (has_texture)
      texture(&appearance->images[material->image], material->wrap, u, v, picture);
  }
  for (int a = 0; a < 3; a++) {
    if (appearance->is_product)
      rgb[a] *= (has_texture ? picture[a] : 1) * (appearance->vertex_colors ? vertex[a] : 1);
    else if (has_texture)
      rgb[a] = picture[a];
    else if (appearance->vertex_colors)
      rgb[a] = vertex[a];
  }
}

/** The nearest point of a triangle by what is least over its inside and its edges; the weights there. */
static double nearest(const vxm_soup *soup, size_t f, const double p[3], double weight[3]) {
  const double *a = vxm_position(soup, 3 * f), *b = a + 3, *c = a + 6;
  double g[2][2] = {{0, 0}, {0, 0}}, r[2] = {0, 0}, best = INFINITY;
  for (int i = 0; i < 3; i++) {
    g[0][0] += (b[i] - a[i]) * (b[i] - a[i]);
    g[0][1] += (b[i] - a[i]) * (c[i] - a[i]);
    g[1][1] += (c[i] - a[i]) * (c[i] - a[i]);
    r[0] += (b[i] - a[i]) * (p[i] - a[i]);
    r[1] += (c[i] - a[i]) * (p[i] - a[i]);
  }
  double determinant = g[0][0] * g[1][1] - g[0][1] * g[0][1];
  double s = (r[0] * g[1][1] - r[1] * g[0][1]) / determinant,
         t = (r[1] * g[0][0] - r[0] * g[0][1]) / determinant;
  double tries[4][2] = {
      {s, t}, {fmin(1, fmax(0, r[0] / g[0][0])), 0}, {0, fmin(1, fmax(0, r[1] / g[1][1]))}, {0, 0}};
  double along = (g[0][0] - g[0][1] - r[0] + r[1]) / (g[0][0] - 2 * g[0][1] + g[1][1]);
  along = fmin(1, fmax(0, along));
  tries[3][0] = 1 - along;
  tries[3][1] = along;
  for (int n = 0; n < 4; n++) {
    if (tries[n][0] < 0 || tries[n][1] < 0 || tries[n][0] + tries[n][1] > 1 + 1e-12)
      continue;
    double square = 0;
    for (int i = 0; i < 3; i++) {
      double at = a[i] + tries[n][0] * (b[i] - a[i]) + tries[n][1] * (c[i] - a[i]);
      square += (p[i] - at) * (p[i] - at);
    }
    if (square < best) {
      best = square;
      weight[1] = tries[n][0];
      weight[2] = tries[n][1];
      weight[0] = 1 - weight[1] - weight[2];
    }
  }
  return best;
}

static vxm_grid *make_grid(vxm_context *context) {
  const vxm_space space = {{SIDE, SIDE, SIDE}, {0.125, -0.25, 0}, {1, 0.75, 1.25}};
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  for (int64_t i = 0; i < SIDE; i++)
    for (int64_t j = 0; j < SIDE; j++)
      for (int64_t k = 0; k < SIDE; k++)
        if (next() % 4)
          vxm_row_set_span(vxm_grid_row(grid, j, k), i, i + 1);
  return grid;
}

static void expect_near(const uint8_t *got, const double rgb[3], int off) {
  for (int c = 0; c < 3; c++)
    assert_in_range(got[c] - byte_of(rgb[c]) + off, 0, 2 * off);
}

/* ---- Tests ---- */

static void test_nearest(void **unused) {
  (void)unused;
  for (int round = 0; round < 30; round++) {
    state = (uint64_t)round;
    vxm_soup *soup = make((kind)(round % KINDS), 1);
    vxm_grid *grid = make_grid(soup->context);
    uint8_t values[4 * VOXELS];
    assert_int_equal(vxm_mesh_colors(values, grid, soup, false, NULL), VXM_OK);
    for (int v = 0; v < VOXELS; v++) {
      const int64_t at[3] = {v / (SIDE * SIDE), v / SIDE % SIDE, v % SIDE};
      double p[3], weight[3], rgb[3], best = INFINITY;
      if (!vxm_grid_get(grid, at[0], at[1], at[2])) {
        assert_memory_equal(values + 4 * v, "\0\0\0", 4);
        continue;
      }
      for (int a = 0; a < 3; a++)
        p[a] = grid->space.origin[a] + ((double)at[a] + 0.5) * grid->space.voxel_size[a];
      for (size_t f = 0; f < TRIANGLES; f++) {
        double here[3], square = nearest(soup, f, p, here);
        if (square >= best)
          continue;
        best = square;
        color_at(soup, f, here, rgb);
        memcpy(weight, here, sizeof here);
      }
      expect_near(values + 4 * v, rgb, 1);
      assert_int_equal(values[4 * v + 3], 255);
    }
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** Many points of each triangle, each for as much area. */
static void strew(vxm_surface_sum *sums, const vxm_soup *soup, const vxm_space *space) {
  enum { CUTS = 300 };
  for (size_t f = 0; f < TRIANGLES; f++) {
    const double *a = vxm_position(soup, 3 * f), *b = a + 3, *c = a + 6;
    double normal[3], area = 0;
    for (int i = 0; i < 3; i++) {
      int y = (i + 1) % 3, z = (i + 2) % 3;
      normal[i] = (b[y] - a[y]) * (c[z] - a[z]) - (b[z] - a[z]) * (c[y] - a[y]);
      area += normal[i] * normal[i];
    }
    area = sqrt(area) / 2 / (CUTS * CUTS);
    for (int row = 0; row < CUTS; row++)
      for (int turn = 0; turn < 2; turn++)
        for (int column = 0; column < CUTS - row - turn; column++) {
          double off = (1 + turn) / 3.0, weight[3], rgb[3];
          int64_t at[3];
          weight[1] = (column + off) / CUTS;
          weight[2] = (row + off) / CUTS;
          weight[0] = 1 - weight[1] - weight[2];
          bool is_inside = true;
          for (int i = 0; i < 3; i++) {
            double p = weight[0] * a[i] + weight[1] * b[i] + weight[2] * c[i];
            at[i] = (int64_t)floor((p - space->origin[i]) / space->voxel_size[i]);
            is_inside = is_inside && at[i] >= 0 && at[i] < SIDE;
          }
          if (!is_inside)
            continue;
          vxm_surface_sum *sum = &sums[(at[0] * SIDE + at[1]) * SIDE + at[2]];
          color_at(soup, f, weight, rgb);
          for (int i = 0; i < 3; i++)
            sum->light[i] += area * rgb[i];
          sum->area += area;
        }
  }
}

static void test_mean(void **unused) {
  (void)unused;
  int compared = 0;
  for (int round = 0; round < 10; round++) {
    state = 1000 + (uint64_t)round;
    vxm_soup *soup = make((kind)(round % KINDS), 1);
    vxm_grid *grid = make_grid(soup->context);
    uint8_t values[4 * VOXELS], plain[4 * VOXELS];
    vxm_surface_sum *sums = calloc(VOXELS, sizeof *sums);
    assert_int_equal(vxm_mesh_colors(values, grid, soup, true, NULL), VXM_OK);
    assert_int_equal(vxm_mesh_colors(plain, grid, soup, false, NULL), VXM_OK);
    strew(sums, soup, &grid->space);
    for (int v = 0; v < VOXELS; v++) {
      if (values[4 * v + 3] == 0)
        continue;
      double rgb[3];
      for (int c = 0; c < 3; c++)
        rgb[c] = sums[v].light[c] / sums[v].area;
      if (sums[v].area > 0.1) {
        expect_near(values + 4 * v, rgb, 5);
        compared++;
      } else if (sums[v].area == 0 && memcmp(values + 4 * v, plain + 4 * v, 4) != 0)
        compared -= 1; /* the points have missed a corner */
    }
    free(sums);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
  assert_in_range(compared, 600, 7300);
}

/** What lies on the border of two voxels colours both, but the one before it only faintly. */
static void test_border(void **unused) {
  (void)unused;
  state = 5;
  vxm_soup *soup = make(FACES, 1);
  soup->face_count = 1;
  const double at[9] = {4.125, -4, -4, 4.125, 40, -4, 4.125, -4, 40};
  memcpy(soup->positions, at, sizeof at);
  vxm_grid *grid = make_grid(soup->context);
  vxm_surface_paint paint;
  vxm_surface_slices slices;
  vxm_surface_sum sums[2][SIDE * SIDE] = {0};
  assert_int_equal(vxm_surface_paint_open(&paint, soup, NULL), VXM_OK);
  assert_int_equal(vxm_surface_slices_open(&slices, &paint, &grid->space, NULL), VXM_OK);
  for (int s = 0; s < 2; s++)
    vxm_surface_slices_sum(&slices, 3 + s, sums[s]);
  for (int v = 0; v < SIDE * SIDE; v++)
    for (int s = 0; s < 2; s++)
      assert_true(fabs(sums[s][v].area / (s == 0 ? 1 : 0x1p-30) - 0.75 * 1.25) < 1e-5);
  vxm_surface_slices_close(&slices);
  vxm_surface_paint_close(&paint);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/* ---- Bodies that touch ---- */

enum { EDGE = 4, CELLS = EDGE * EDGE * EDGE, BODIES = 3, FINE = 3, FINE_EDGE = EDGE * FINE };

/** Bodies of cells: 0 = none, else the number of a body. */
static int body_at(const int *cells, int x, int y, int z) {
  bool is_there = x >= 0 && y >= 0 && z >= 0 && x < EDGE && y < EDGE && z < EDGE;
  return is_there ? cells[(x * EDGE + y) * EDGE + z] : 0;
}

static const uint8_t palette[BODIES + 1][3] = {{0, 0, 0}, {255, 0, 0}, {0, 0, 255}, {0, 255, 0}};

/** Adds the square between a cell of a body and what is beside it, as two triangles of the body's colour. */
static void add_wall(vxm_soup *soup, uint32_t *vertices, const int at[3], int side, int b, bool inward,
                     double unit) {
  int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  uint32_t square[4];
  for (int c = 0; c < 4; c++) {
    int p[3] = {at[0], at[1], at[2]};
    p[axis] += side % 2;
    p[u] += c == 1 || c == 2;
    p[v] += c >= 2;
    uint32_t *vertex = &vertices[(p[0] * (EDGE + 1) + p[1]) * (EDGE + 1) + p[2]];
    if (*vertex == 0) {
      vxm_soup_add_vertex(soup, unit * p[0], unit * p[1], unit * p[2], NULL);
      *vertex = (uint32_t)soup->vertex_count;
    }
    square[(side % 2 == 1) != inward ? c : 3 - c] = *vertex - 1;
  }
  uint64_t cut = next() % 2;
  for (uint64_t t = 0; t < 2; t++) {
    const uint32_t corners[3] = {square[cut], square[(cut + 1 + t) % 4], square[(cut + 2 + t) % 4]};
    vxm_gather_color(&soup->appearance->faces, soup->context, soup->face_count,
                     (const double[4]){palette[b][0], palette[b][1], palette[b][2], 0}, NULL);
    vxm_soup_add_face(soup, corners, 3, NULL);
  }
}

/** The skins of all bodies, so that there are two walls where they touch, in a random order of bodies. */
static vxm_soup *make_bodies(vxm_context *context, const int *cells, bool inward, double unit) {
  enum { CORNERS = (EDGE + 1) * (EDGE + 1) * (EDGE + 1) };
  vxm_soup *soup;
  uint64_t first = next();
  assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
  assert_int_equal(vxm_appearance_create(&soup->appearance, soup->context, NULL), VXM_OK);
  soup->appearance->faces.unit = 255;
  for (uint64_t turn = 0; turn < BODIES; turn++) {
    uint32_t vertices[CORNERS] = {0};
    int b = 1 + (int)((first + turn) % BODIES);
    for (int cell = 0; cell < CELLS; cell++)
      for (int side = 0; side < 6 && cells[cell] == b; side++) {
        int at[3] = {cell / EDGE / EDGE, cell / EDGE % EDGE, cell % EDGE}, beside[3] = {at[0], at[1], at[2]};
        beside[side / 2] += side % 2 ? 1 : -1;
        if (body_at(cells, beside[0], beside[1], beside[2]) != b)
          add_wall(soup, vertices, at, side, b, inward, unit);
      }
  }
  assert_int_equal(vxm_appearance_settle(soup->appearance, soup->vertex_count, soup->face_count, NULL),
                   VXM_OK);
  return soup;
}

/** Whether a wall of the body at a voxel is on its border. */
static bool is_at_wall(const int *cells, const int at[3]) {
  int b = body_at(cells, at[0] / FINE, at[1] / FINE, at[2] / FINE);
  for (int side = 0; side < 6; side++) {
    int beside[3] = {at[0], at[1], at[2]};
    beside[side / 2] += side % 2 ? 1 : -1;
    if (beside[side / 2] < 0 || body_at(cells, beside[0] / FINE, beside[1] / FINE, beside[2] / FINE) != b)
      return true;
  }
  return false;
}

/** Each voxel has the colour of the body that it is in, though those beside it have walls as near. */
static void assert_bodies(vxm_context *context, const int *cells, bool inward, double unit, bool average) {
  vxm_soup *soup = make_bodies(context, cells, inward, unit);
  const double size = unit / FINE;
  const vxm_space space = {{FINE_EDGE, FINE_EDGE, FINE_EDGE}, {0, 0, 0}, {size, size, size}};
  static uint8_t values[FINE_EDGE * FINE_EDGE * FINE_EDGE][4];
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  for (int j = 0; j < FINE_EDGE; j++)
    for (int k = 0; k < FINE_EDGE; k++)
      for (int i = 0; i < FINE_EDGE; i++)
        if (body_at(cells, i / FINE, j / FINE, k / FINE))
          vxm_row_set_span(vxm_grid_row(grid, j, k), i, i + 1);
  assert_int_equal(vxm_mesh_colors(values[0], grid, soup, average, NULL), VXM_OK);
  for (int v = 0; v < FINE_EDGE * FINE_EDGE * FINE_EDGE; v++) {
    const int at[3] = {v / FINE_EDGE / FINE_EDGE, v / FINE_EDGE % FINE_EDGE, v % FINE_EDGE};
    int b = body_at(cells, at[0] / FINE, at[1] / FINE, at[2] / FINE);
    if (b > 0 && (!average || is_at_wall(cells, at)))
      assert_memory_equal(values[v], palette[b], 3);
  }
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

static void test_bodies(void **unused) {
  (void)unused;
  static const double units[] = {1, 0.1, 25.4};
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  for (int round = 0; round < 60; round++) {
    int cells[CELLS];
    state = 5000 + (uint64_t)round;
    uint64_t emptiness = next() % 3;
    for (int c = 0; c < CELLS; c++)
      cells[c] = next() % 4 < emptiness ? 0 : 1 + (int)(next() % BODIES);
    for (int average = 0; average < 2; average++)
      assert_bodies(context, cells, round % 4 == 3, units[round % 3], average == 1);
  }
  vxm_context_destroy(context);
}

static void test_threads(void **unused) {
  (void)unused;
  static const int threads[] = {1, 2, 7};
  for (int average = 0; average < 2; average++) {
    uint8_t values[3][4 * VOXELS];
    for (int t = 0; t < 3; t++) {
      state = 77;
      vxm_soup *soup = make(PRODUCT, threads[t]);
      vxm_grid *grid = make_grid(soup->context);
      assert_int_equal(vxm_mesh_colors(values[t], grid, soup, average, NULL), VXM_OK);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
    }
    assert_memory_equal(values[0], values[1], sizeof values[0]);
    assert_memory_equal(values[0], values[2], sizeof values[0]);
  }
}

/* ---- Readers ---- */

/** A triangle and a square, of which the second face or the last vertices may be looked at. */
static vxm_soup *read_text(const void *data, size_t size, const char *name) {
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  options.colors = true;
  if (vxm_meshio_read(&soup, NULL, data, size, name, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_non_null(soup->appearance);
  return soup;
}

#define READ(text, name) read_text(text, sizeof text - 1, name)
#define EXPECT(colors, index, r, g, b) \
  assert_memory_equal(colors[index], ((const uint8_t[4]){r, g, b, 255}), 4)

static void test_vertices(void **unused) {
  (void)unused;
  static const char obj[] = "v 0 0 0 1 0 0.5\nv 1 0 0\nv 0 1 0 0 1 0\nf 1 2 3\n",
                    bytes[] = "v 0 0 0 255 0 7\nv 1 0 0 1 1 1\nv 0 1 0 0 2 0\nf 1 2 3\n",
                    ply[] =
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n",
                    coff[] =
                        "COFF\n3 1 0\n0 0 0 10 20 30 255\n1 0 0 40 50 60 255\n0 1 0 70 80 90 255\n3 0 1 2\n",
                    floats[] = "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n";
  vxm_soup *soup = READ(obj, "a.obj");
  EXPECT(soup->appearance->vertex_colors, 0, 255, 0, 128);
  assert_int_equal(soup->appearance->vertex_colors[1][3], 0);
  EXPECT(soup->appearance->vertex_colors, 2, 0, 255, 0);
  vxm_soup_destroy(soup);
  soup = READ(bytes, "a.obj");
  EXPECT(soup->appearance->vertex_colors, 0, 255, 0, 7);
  EXPECT(soup->appearance->vertex_colors, 1, 1, 1, 1);
  vxm_soup_destroy(soup);
  soup = READ(ply, "a.ply");
  EXPECT(soup->appearance->vertex_colors, 2, 7, 8, 9);
  vxm_soup_destroy(soup);
  soup = READ(coff, "a.off");
  EXPECT(soup->appearance->vertex_colors, 1, 40, 50, 60);
  vxm_soup_destroy(soup);
  soup = READ(floats, "a.off");
  EXPECT(soup->appearance->vertex_colors, 2, 0, 0, 255);
  vxm_soup_destroy(soup);
}

static void test_faces(void **unused) {
  (void)unused;
  static const char off[] =
      "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 255 0 0\n3 0 1 9 7 7 7\n3 0 2 3 0 0 255\n",
                    ply[] =
                        "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement vertex 3\n"
                        "property float x\nproperty float y\nproperty float z\nend_header\n"
                        "3 0 1 2 1 2 3\n3 0 2 1 4 5 6\n0 0 0\n1 0 0\n0 1 0\n";
  vxm_soup *soup = READ(off, "a.off");
  assert_int_equal(soup->face_count, 2); /* the second names no vertex: the third keeps its colour */
  EXPECT(soup->appearance->face_colors, 0, 255, 0, 0);
  EXPECT(soup->appearance->face_colors, 1, 0, 0, 255);
  vxm_soup_destroy(soup);
  soup = READ(ply, "a.ply");
  EXPECT(soup->appearance->face_colors, 1, 4, 5, 6);
  vxm_soup_destroy(soup);
}

/** Damage in colours is not damage to the mesh. */
static void test_damaged_colors(void **unused) {
  (void)unused;
  static const char text[] =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\n"
      "end_header\n0 0 0 1 2 3\n1 0 0 4 five 6\n0 1 0 7\n0 0 1 7 8 9\n3 0 2 3 4 5 6\n3 0 1 2 1 2\n";
  vxm_soup *soup = READ(text, "a.ply");
  assert_int_equal(soup->face_count, 2);
  assert_int_equal(soup->warnings.count, 0);
  EXPECT(soup->appearance->vertex_colors, 0, 1, 2, 3);
  assert_int_equal(soup->appearance->vertex_colors[1][3], 0);
  assert_int_equal(soup->appearance->vertex_colors[2][3], 0);
  EXPECT(soup->appearance->vertex_colors, 3, 7, 8, 9);
  EXPECT(soup->appearance->face_colors, 0, 4, 5, 6);
  assert_int_equal(soup->appearance->face_colors[1][3], 0);
  vxm_soup_destroy(soup);
}

static void test_binary(void **unused) {
  (void)unused;
  static const char head[] =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar "
      "alpha\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nend_header\n";
  unsigned char data[sizeof head - 1 + 3 * 16 + 2 * 16] = {0}, *at = data + sizeof head - 1;
  memcpy(data, head, sizeof head - 1);
  for (int v = 0; v < 3; v++, at += 16) {
    const float p[3] = {v == 1, v == 2, 0};
    memcpy(at, p, 12);
    for (int c = 0; c < 4; c++)
      at[12 + c] = (unsigned char)(10 * v + c);
  }
  for (int f = 0; f < 2; f++, at += 16) {
    const int32_t corners[3] = {0, 1 + f, 2 - f};
    at[0] = 3;
    memcpy(at + 1, corners, 12);
    for (int c = 0; c < 3; c++)
      at[13 + c] = (unsigned char)(100 + 10 * f + c);
  }
  vxm_soup *soup = read_text(data, sizeof data, "a.ply");
  assert_int_equal(soup->face_count, 2);
  EXPECT(soup->appearance->vertex_colors, 2, 20, 21, 22);
  EXPECT(soup->appearance->face_colors, 1, 110, 111, 112);
  vxm_soup_destroy(soup);
}

static void test_obj_corners(void **unused) {
  (void)unused;
  static const char text[] =
      "mtllib none.mtl  other one.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0\nvt 0 nan\n"
      "usemtl wood\nf 1/1/1 2/2 3\nf 1/7 2/-3 9\nusemtl steel\nf 1//4 2/-2 3/3\n";
  vxm_soup *soup = READ(text, "a.obj");
  const vxm_appearance *appearance = soup->appearance;
  assert_int_equal(soup->face_count, 2);
  assert_int_equal(appearance->material_count, 2);
  assert_int_equal(appearance->face_materials[0], 0);
  assert_int_equal(appearance->face_materials[1], 1);
  static const float want[6][2] = {{0.25F, 0.5F}, {1, 0}, {NAN, NAN}, {NAN, NAN}, {1, 0}, {0, NAN}};
  for (int c = 0; c < 6; c++)
    for (int a = 0; a < 2; a++)
      assert_true(isnan(want[c][a]) ? isnan(appearance->corner_uvs[c][a])
                                    : appearance->corner_uvs[c][a] == want[c][a]);
  assert_int_not_equal(vxm_mesh_colors_check(soup, NULL), VXM_OK);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nearest),        cmocka_unit_test(test_mean),
      cmocka_unit_test(test_border),         cmocka_unit_test(test_bodies),
      cmocka_unit_test(test_threads),        cmocka_unit_test(test_vertices),
      cmocka_unit_test(test_faces),          cmocka_unit_test(test_binary),
      cmocka_unit_test(test_damaged_colors), cmocka_unit_test(test_obj_corners)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
