/* SPDX-License-Identifier: BSD-3-Clause */
/* Distances against every triangle asked for every voxel, by another formula and in long doubles. */
#include "shapes.h"

#include "grid/bitgrid.h"
#include "voxel/fields/distance.h"
#include "voxel/model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct vec {
  long double x, y, z;
} vec;

static vec sub(vec a, vec b) {
  return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static long double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec along(vec a, vec d, long double t) {
  return (vec){a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
}

static long double to_segment(vec p, vec a, vec b) {
  vec ab = sub(b, a);
  long double square = dot(ab, ab), t = square > 0 ? dot(sub(p, a), ab) / square : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  vec off = sub(p, along(a, ab, t));
  return sqrtl(dot(off, off));
}

/** The foot on the plane by barycentric coordinates where they are all positive; else the edges. */
static long double to_triangle(vec p, vec a, vec b, vec c) {
  vec ab = sub(b, a), ac = sub(c, a), ap = sub(p, a);
  long double aa = dot(ab, ab), bb = dot(ac, ac), cc = dot(ab, ac), determinant = aa * bb - cc * cc;
  if (determinant > 1e-16L * aa * bb) {
    long double u = (dot(ap, ab) * bb - dot(ap, ac) * cc) / determinant;
    long double v = (dot(ap, ac) * aa - dot(ap, ab) * cc) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) {
      vec off = sub(p, along(along(a, ab, u), ac, v));
      return sqrtl(dot(off, off));
    }
  }
  return fminl(to_segment(p, a, b), fminl(to_segment(p, b, c), to_segment(p, c, a)));
}

/** All as seen from the origin of the space, which may be far from that of the model. */
static vec corner_of(const vxm_soup *soup, const vxm_space *s, size_t face, size_t corner) {
  size_t n;
  const double *p = vxm_position(soup, vxm_face(soup, face, &n)[corner]);
  vec origin = {s->origin[0], s->origin[1], s->origin[2]};
  return sub((vec){p[0], p[1], p[2]}, origin);
}

/** Faces are triangles, or flat and convex. */
static long double brute(const vxm_soup *soup, const vxm_space *s, vec p) {
  long double least = INFINITY;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    vxm_face(soup, f, &n);
    for (size_t c = 2; c < n; c++)
      least = fminl(least, to_triangle(p, corner_of(soup, s, f, 0), corner_of(soup, s, f, c - 1),
                                       corner_of(soup, s, f, c)));
  }
  return least;
}

static vec centre_of(const vxm_space *s, int64_t i, int64_t j, int64_t k) {
  return (vec){((long double)i + 0.5L) * s->voxel_size[0], ((long double)j + 0.5L) * s->voxel_size[1],
               ((long double)k + 0.5L) * s->voxel_size[2]};
}

static size_t voxels_of(const vxm_space *space) {
  return (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
}

static vxm_model *model_of(const vxm_soup *soup) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP; /* of which signs know nothing */
  vxm_model *model;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_create(&model, soup, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return model;
}

static vxm_distance_report measure(float *values, vxm_model *model, const vxm_space *space, double band,
                                   bool is_unsigned) {
  vxm_distance_options options = VXM_DISTANCE_OPTIONS_INIT;
  options.band = band;
  options.is_unsigned = is_unsigned;
  vxm_distance_report report = VXM_DISTANCE_REPORT_INIT;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_distance(values, &report, model, space, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return report;
}

static void check(const vxm_soup *soup, const vxm_space *space, double band) {
  double side = fmax(space->voxel_size[0], fmax(space->voxel_size[1], space->voxel_size[2]));
  double most = band > 0 ? band * side : INFINITY;
  vxm_model *model = model_of(soup);
  vxm_grid *solid;
  assert_int_equal(vxm_grid_create(&solid, soup->context, space, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(solid, NULL, model, NULL, NULL), VXM_OK);
  float *signed_values = malloc(voxels_of(space) * sizeof(float)),
        *values = malloc(voxels_of(space) * sizeof(float));
  measure(values, model, space, band, true);
  vxm_distance_report report = measure(signed_values, model, space, band, false);
  int64_t exact = 0;
  size_t at = 0;
  for (int64_t i = 0; i < space->dims[0]; i++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t k = 0; k < space->dims[2]; k++, at++) {
        double right = (double)fminl(most, brute(soup, space, centre_of(space, i, j, k)));
        /* The nearest float, or one as near but for the rounding of doubles. */
        if (fabs((double)values[at] - right) > right * 0x1.00001p-24 + side * 1e-12)
          fail_msg("(%d, %d, %d): %.9g, not %.9g", (int)i, (int)j, (int)k, (double)values[at], right);
        bool is_inside = vxm_grid_get(solid, i, j, k);
        assert_true(signed_values[at] == (is_inside ? -values[at] : values[at]));
        assert_true((double)values[at] <= (double)(float)most);
        exact += (double)values[at] < (double)(float)most;
      }
  assert_true(report.exact >= exact);
  free(values);
  free(signed_values);
  vxm_grid_destroy(solid);
  vxm_model_destroy(model);
}

/** Small, large, thin, flat along an axis, or without area; some reach beyond the grid. */
static void add_triangle(vxm_soup *soup, vxm_rng *rng, int kind) {
  double size = kind == 0 ? 1 : kind == 1 ? 30 : 8, from[3], to[3] = {0, 0, 0};
  for (int a = 0; a < 3; a++)
    from[a] = 20 * vxm_rng_unit(rng) - 2;
  for (uint32_t c = 0; c < 3; c++) {
    double p[3], wide = vxm_rng_unit(rng);
    for (int a = 0; a < 3; a++) {
      p[a] = from[a] + size * (vxm_rng_unit(rng) - 0.5);
      to[a] = c == 0 ? size * (vxm_rng_unit(rng) - 0.5) : to[a];
      if (kind == 3) /* a sliver */
        p[a] = from[a] + wide * to[a] + 1e-4 * vxm_rng_unit(rng);
      if (kind == 4) /* a segment */
        p[a] = from[a] + wide * to[a];
      if (kind == 5 && a == 1)
        p[a] = from[a];
    }
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  uint32_t v = (uint32_t)soup->vertex_count - 3;
  shape_triangle(soup, v, v + 1, v + 2);
}

static void test_equals_brute_force(void **state) {
  (void)state;
  static const double bands[] = {3, 1.5, 0, 6, 40, 0.3};
  vxm_rng rng = {21};
  for (int round = 0; round < 36; round++) {
    vxm_soup *soup = shape_empty(context);
    int count = 1 + (int)vxm_rng_below(&rng, round % 4 == 0 ? 60 : 12);
    for (int t = 0; t < count; t++)
      add_triangle(soup, &rng, (round + t) % 6);
    vxm_space space = {{3 + (int64_t)vxm_rng_below(&rng, 20), 3 + (int64_t)vxm_rng_below(&rng, 20),
                        3 + (int64_t)vxm_rng_below(&rng, 36)},
                       {-1, 0.3, 0.1},
                       {1, 1, 1}};
    if (round % 3 == 1)
      for (int a = 0; a < 3; a++)
        space.voxel_size[a] = 0.3 + vxm_rng_unit(&rng);
    check(soup, &space, bands[round % 6]);
    vxm_soup_destroy(soup);
  }
}

static void test_closed_shapes(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0.51, 1, 1.5}, (double[]){9, 7.5, 4});
  vxm_space space = {{11, 9, 7}, {-0.3, 0, 0}, {1, 1, 1}};
  check(soup, &space, 3);
  check(soup, &space, 0);
  space = (vxm_space){{22, 11, 20}, {-0.3, 0, 0}, {0.5, 0.9, 0.3}};
  check(soup, &space, 2);
  check(soup, &space, 0);
  vxm_soup_destroy(soup);
}

/** Many triangles in a corner: voxels look for them, and pass over those beyond the band. */
static void test_a_crowd_in_a_corner(void **state) {
  (void)state;
  vxm_rng rng = {22};
  vxm_soup *soup = shape_empty(context);
  for (int v = 0; v < 6000; v++) {
    double x = 2 * vxm_rng_unit(&rng), y = 3 + vxm_rng_unit(&rng);
    shape_vertex(soup, x, y, vxm_rng_unit(&rng));
  }
  for (uint32_t t = 0; t < 2000; t++)
    shape_triangle(soup, 3 * t, 3 * t + 1, 3 * t + 2);
  shape_vertex(soup, 4, 4, 58.3);
  shape_triangle(soup, 6000, 6000, 6000);
  vxm_space space = {{5, 6, 64}, {0, 0, 0}, {1, 1, 1}};
  check(soup, &space, 4);
  space = (vxm_space){{64, 5, 6}, {-60, 0, 0}, {1, 1, 1}};
  check(soup, &space, 5.5);
  vxm_soup_destroy(soup);
}

/** Far from the origin, in small units: lengths count in voxels. */
static void test_scale(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  for (int c = 0; c < 3; c++)
    shape_vertex(soup, 1000 + 1e-6 * c, -5, 3 + 1e-6 * (c == 1));
  shape_triangle(soup, 0, 1, 2);
  vxm_space space = {{20, 9, 9}, {1000 - 3e-6, -5 - 1e-6, 3 - 1e-6}, {5e-7, 5e-7, 5e-7}};
  check(soup, &space, 3);
  check(soup, &space, 0);
  vxm_soup_destroy(soup);
}

/** A model of 1 mm, a thousand kilometres off; and triangles that are far away themselves. */
static void test_far_off(void **state) {
  (void)state;
  vxm_rng rng = {23};
  for (int round = 0; round < 6; round++) {
    vxm_soup *soup = shape_empty(context);
    double size = round % 2 ? 1e-6 : 1e-3, off = round < 4 ? 1e6 : 300 * size;
    for (uint32_t t = 0; t < 20; t++) {
      for (int c = 0; c < 3; c++)
        shape_vertex(soup, off + size * vxm_rng_unit(&rng), off + size * vxm_rng_unit(&rng),
                     -off + size * vxm_rng_unit(&rng));
      shape_triangle(soup, 3 * t, 3 * t + 1, 3 * t + 2);
    }
    vxm_space space = {{12, 13, 14}, {1e6, 1e6, -1e6}, {size / 10, size / 10, size / 9}};
    if (round >= 4)
      space.origin[0] = space.origin[1] = space.origin[2] = 0;
    check(soup, &space, 0);
    check(soup, &space, 2);
    vxm_soup_destroy(soup);
  }
}

/** Wider than the grid, though not than the distances. */
static void test_wide_band(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){-100, 1, 1}, (double[]){-9, 2, 2});
  vxm_space space = {{5, 4, 3}, {0, 0, 0}, {1, 1, 1}};
  check(soup, &space, 11);
  vxm_soup_destroy(soup);
}

typedef struct taken {
  const vxm_space *space;
  vxm_layout layout;
  float *values; /**< as [x][y][z] */
  int calls;
} taken;

static const vxm_space layout_space = {{37, 70, 40}, {-1.5, -1.6, -1.2}, {0.08, 0.05, 0.06}};

static vxm_status take(void *payload, const void *values, int64_t begin, int64_t end, vxm_error *error) {
  (void)error;
  taken *t = payload;
  t->calls++;
  const int64_t *dims = t->space->dims;
  const float *from = values;
  int64_t at[3];
  for (at[t->layout.slow] = begin; at[t->layout.slow] < end; at[t->layout.slow]++)
    for (at[t->layout.middle] = 0; at[t->layout.middle] < dims[t->layout.middle]; at[t->layout.middle]++)
      for (at[t->layout.fast] = 0; at[t->layout.fast] < dims[t->layout.fast]; at[t->layout.fast]++)
        t->values[(at[0] * dims[1] + at[1]) * dims[2] + at[2]] = *from++;
  return VXM_OK;
}

/** Tiles come from several threads, but no voxel twice. */
static vxm_status take_tile(void *payload, const vxm_value_tile *tile, vxm_error *error) {
  (void)error;
  const taken *t = payload;
  const int64_t *dims = t->space->dims;
  const int axes[3] = {t->layout.fast, t->layout.middle, t->layout.slow};
  int64_t at[3];
  for (int a = 0; a < 3; a++) {
    assert_true(tile->first[a] % 8 == 0 && tile->count[a] > 0 && tile->count[a] <= VXM_VALUE_TILE);
    assert_true(tile->first[a] + tile->count[a] <= dims[axes[a]]);
  }
  for (int z = 0; z < tile->count[2]; z++)
    for (int y = 0; y < tile->count[1]; y++)
      for (int x = 0; x < tile->count[0]; x++) {
        at[axes[0]] = tile->first[0] + x;
        at[axes[1]] = tile->first[1] + y;
        at[axes[2]] = tile->first[2] + z;
        t->values[(at[0] * dims[1] + at[1]) * dims[2] + at[2]] =
            tile->values ? tile->values[(size_t)z * tile->slice + (size_t)y * tile->row + (size_t)x]
                         : tile->value;
      }
  return VXM_OK;
}

/** Distances in an order and under a limit, as [x][y][z]; returns whether they could be had. */
static bool measure_in(float *values, vxm_layout layout, int threads, uint64_t limit, double band,
                       bool in_tiles, int *windows) {
  vxm_space space = layout_space;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = limit;
  vxm_context *own;
  assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
  vxm_soup *soup = shape_empty(own);
  shape_torus(soup, 20, 12, 1, 0.4, (double[]){0.01, 0.02, 0.03});
  vxm_model *model = model_of(soup);
  taken t = {&space, layout, values, 0};
  vxm_field_target target = {layout, NULL, take, &t, in_tiles ? take_tile : NULL};
  for (size_t v = 0; v < voxels_of(&space) && in_tiles; v++)
    values[v] = (float)(band * 0.08);
  vxm_distance_options chosen = VXM_DISTANCE_OPTIONS_INIT;
  chosen.band = band;
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_distance_report report = VXM_DISTANCE_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_status status = vxm_distance_run(&target, &report, model, &space, &chosen, NULL);
  assert_true(status == VXM_OK || (limit > 0 && status == VXM_ERROR_MEMORY_LIMIT));
  assert_true(limit == 0 || vxm_context_peak_bytes(own) <= limit);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
  vxm_context_destroy(own);
  *windows = t.calls;
  return status == VXM_OK;
}

/** The order of the values, and how many slices are made at once, change no bit. */
static void test_layouts(void **state) {
  (void)state;
  static const vxm_layout layouts[] = {{2, 1, 0}, {0, 1, 2}, {1, 2, 0}, {0, 2, 1}};
  size_t bytes = voxels_of(&layout_space) * sizeof(float);
  float *first = malloc(bytes), *next = malloc(bytes);
  int windows, most = 0;
  for (int n = 0; n < 2; n++) {
    double band = n == 0 ? 4 : 0;
    assert_true(measure_in(first, layouts[0], 1, 0, band, false, &windows));
    for (int l = 1; l < 4; l++) {
      for (int tiles = 0; tiles < 2; tiles++) {
        assert_true(measure_in(next, layouts[l], l, 0, band, tiles, &windows));
        assert_memory_equal(first, next, bytes);
        assert_true((windows == 0) == (tiles && n == 0));
      }
    }
    for (int tiles = 0; tiles < 2; tiles++)
      for (uint64_t limit = 11 << 20; measure_in(next, layouts[n], 2, limit, band, tiles, &windows);
           limit -= 100000) {
        assert_memory_equal(first, next, bytes);
        most = windows > most ? windows : most;
      }
  }
  assert_true(most > 2);
  free(next);
  free(first);
}

static vxm_status refuse_tile(void *payload, const vxm_value_tile *tile, vxm_error *error) {
  (void)payload;
  (void)tile;
  return vxm_fail(error, VXM_ERROR_IO, "no room");
}

/** Large bodies, with whole tiles inside and such that the mouth of an open one goes through: whatever is
 * beyond the band. */
static void test_far_tiles(void **state) {
  (void)state;
  vxm_space space = {{150, 131, 170}, {0, 0, 0}, {1, 1, 1}};
  size_t bytes = voxels_of(&space) * sizeof(float);
  float *first = malloc(bytes), *next = malloc(bytes);
  for (int round = 0; round < 6; round++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1 + round % 3;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = shape_empty(own);
    shape_box(soup, (double[]){3.5, 4.2, 5.1}, (double[]){146.3, 125.4, 160.2});
    if (round >= 2)
      soup->face_count--;
    vxm_model *model = model_of(soup);
    taken t = {&space, {2, 1, 0}, next, 0};
    vxm_field_target target = {t.layout, NULL, take, &t, take_tile};
    vxm_distance_options chosen = VXM_DISTANCE_OPTIONS_INIT;
    chosen.is_unsigned = round == 5;
    vxm_distance_report report = measure(first, model, &space, 3, round == 5),
                        other = VXM_DISTANCE_REPORT_INIT;
    vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
    other.voxelize = &voxelize;
    for (size_t v = 0; v < voxels_of(&space); v++)
      next[v] = 3;
    assert_int_equal(vxm_distance_run(&target, &other, model, &space, &chosen, NULL), VXM_OK);
    assert_memory_equal(first, next, bytes);
    assert_int_equal(t.calls, 0);
    assert_int_equal(report.exact, other.exact);
    assert_true(report.min == other.min && report.max == other.max);
    target.put_tile = refuse_tile;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_distance_run(&target, &other, model, &space, &chosen, &error), VXM_ERROR_IO);
    assert_string_equal(error.text, "no room");
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  free(next);
  free(first);
}

/** Threads and limits change no bit; nor does a band change those within. */
static void test_threads_and_limits(void **state) {
  (void)state;
  vxm_space space = {{60, 61, 62}, {-1.55, -1.5, -1.5}, {0.05, 0.05, 0.05}};
  float *first = malloc(voxels_of(&space) * sizeof *first), *next = malloc(voxels_of(&space) * sizeof *next);
  for (int round = 0; round < 8; round++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1 + round / 2;
    options.memory_limit = round >= 6 ? UINT64_C(20) << 20 : 0;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = shape_empty(own);
    shape_torus(soup, 48, 24, 1, 0.4, (double[]){0.01, 0.02, 0.03});
    vxm_model *model = model_of(soup);
    measure(round < 2 ? first : next, model, &space, round % 2 ? 3 : 0, false);
    if (round == 0)
      memcpy(next, first, voxels_of(&space) * sizeof *first);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    assert_true(options.memory_limit == 0 || vxm_context_peak_bytes(own) <= options.memory_limit);
    vxm_context_destroy(own);
    if (round % 2) /* `first` has the band by now */
      assert_memory_equal(round == 1 ? first : next, first, voxels_of(&space) * sizeof *first);
    else if (round > 0)
      for (size_t i = 0; i < voxels_of(&space); i++) {
        float most = (float)(3 * space.voxel_size[0]);
        assert_true(fminf(fmaxf(next[i], -most), most) == first[i]);
      }
  }
  free(next);
  free(first);
}

static void test_what_is_refused(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1});
  vxm_voxelize_options surface = VXM_VOXELIZE_OPTIONS_INIT;
  surface.mode = VXM_MODE_SURFACE;
  vxm_model *model;
  assert_int_equal(vxm_model_create(&model, soup, &surface, NULL), VXM_OK);
  vxm_space space = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  vxm_distance_options options = VXM_DISTANCE_OPTIONS_INIT;
  float value = 7;
  assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.is_unsigned = true;
  assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, NULL), VXM_OK);
  assert_true(value == 0.5f);
  options.band = -1;
  assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.band = NAN;
  assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.band = 3;
  options.size = 2;
  assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/** What 32-bit floats do not hold is refused; with a band distances go as far as that, without one as the
 * grid. */
static void test_float_range(void **state) {
  (void)state;
  static const struct {
    double size, band;
    vxm_status status;
  } cases[] = {
      {1e300, 3, VXM_ERROR_RANGE},  {1e-300, 3, VXM_ERROR_RANGE}, {1e38, 3, VXM_OK},
      {1.2e38, 3, VXM_ERROR_RANGE}, {1.2e38, 0, VXM_OK},          {3e38, 0, VXM_ERROR_RANGE},
      {2e-38, 3, VXM_OK},           {1e-38, 3, VXM_ERROR_RANGE},  {1e-38, 0, VXM_ERROR_RANGE},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double s = cases[i].size;
    vxm_soup *soup = shape_empty(context);
    shape_box(soup, (double[]){0, 0, 0}, (double[]){s, s, s});
    vxm_model *model;
    vxm_voxelize_options surface = VXM_VOXELIZE_OPTIONS_INIT;
    surface.mode = VXM_MODE_SURFACE;
    assert_int_equal(vxm_model_create(&model, soup, &surface, NULL), VXM_OK);
    vxm_space space = {{1, 1, 1}, {0, 0, 0}, {s, s, s}};
    vxm_distance_options options = VXM_DISTANCE_OPTIONS_INIT;
    options.is_unsigned = true;
    options.band = cases[i].band;
    vxm_error error = VXM_ERROR_INIT;
    float value = 7;
    assert_int_equal(vxm_model_distance(&value, NULL, model, &space, &options, &error), cases[i].status);
    assert_true(cases[i].status == VXM_OK ? value == (float)(s / 2)
                                          : strstr(error.text, "32-bit floats") != NULL);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equals_brute_force),  cmocka_unit_test(test_closed_shapes),
      cmocka_unit_test(test_a_crowd_in_a_corner), cmocka_unit_test(test_scale),
      cmocka_unit_test(test_threads_and_limits),  cmocka_unit_test(test_what_is_refused),
      cmocka_unit_test(test_float_range),         cmocka_unit_test(test_far_off),
      cmocka_unit_test(test_wide_band),           cmocka_unit_test(test_layouts),
      cmocka_unit_test(test_far_tiles),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
