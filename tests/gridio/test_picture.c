/* SPDX-License-Identifier: BSD-3-Clause */
/** Pictures: valid PNG, the same for all threads, with the model in the middle and the right way up. */
#include "config.h"

#include "grids.h"

#include "gridio/gridio.h"
#include "gridio/picture/picture.h"
#include "gridio/picture/raycast.h"
#include "gridio/picture/tiles.h"

#include <math.h>

static vxm_context *context_of(int threads) {
  return context_with(threads, 0, NULL, NULL);
}

/* ---- Rays ---- */

/** The first set voxel along a ray, by cutting the ray with every voxel's box. */
static bool slow_trace(vxm_hit *hit, const vxm_grid *grid, const double o[3], const double d[3]) {
  hit->t = INFINITY;
  for (int64_t k = 0; k < grid->space.dims[2]; k++)
    for (int64_t j = 0; j < grid->space.dims[1]; j++)
      for (int64_t i = 0; i < grid->space.dims[0]; i++) {
        if (!vxm_grid_get(grid, i, j, k))
          continue;
        const int64_t low[3] = {i, j, k};
        double in = 0, out = INFINITY;
        for (int a = 0; a < 3; a++) {
          double t1 = ((double)low[a] - o[a]) / d[a], t2 = ((double)low[a] + 1 - o[a]) / d[a];
          in = fmax(in, fmin(t1, t2));
          out = fmin(out, fmax(t1, t2));
        }
        if (in < out && in < hit->t) {
          hit->t = in;
          memcpy(hit->voxel, low, sizeof low);
        }
      }
  return hit->t < INFINITY;
}

static void test_rays(void **state) {
  (void)state;
  vxm_context *context = context_of(1);
  vxm_rng rng = {21};
  for (int round = 0; round < 120; round++) {
    vxm_space space = random_space(&rng, 40, false);
    if (round % 4 == 0) /* flat, and long */
      space.dims[round / 4 % 3] = round % 8 == 0 ? 150 : 1;
    vxm_grid *grid = new_grid(context, space);
    for (int n = 0; n < (round % 4) * 8; n++) {
      int64_t p[3];
      for (int a = 0; a < 3; a++)
        p[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)space.dims[a]);
      vxm_grid_set(grid, p[0], p[1], p[2], true);
    }
    vxm_occupancy_mips mips;
    assert_int_equal(vxm_occupancy_mips_create(&mips, grid, NULL), VXM_OK);
    for (int r = 0; r < 40; r++) {
      double o[3], d[3];
      for (int a = 0; a < 3; a++) {
        o[a] = (vxm_rng_unit(&rng) * 3 - 1) * (double)space.dims[a];
        d[a] = vxm_rng_unit(&rng) * (double)space.dims[a] - o[a]; /* toward the grid */
      }
      vxm_hit fast, slow;
      bool hit = vxm_raycast(&fast, &mips, o, d);
      assert_int_equal(hit, slow_trace(&slow, grid, o, d));
      if (hit) {
        assert_memory_equal(fast.voxel, slow.voxel, sizeof fast.voxel);
        assert_true(fabs(fast.t - slow.t) < 1e-9);
      }
    }
    vxm_occupancy_mips_destroy(&mips);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

/** Rays square to an axis meet the voxels of their row. */
static void test_rays_along_axes(void **state) {
  (void)state;
  vxm_context *context = context_of(1);
  vxm_grid *grid = new_grid(context, unit_space(70, 30, 20));
  vxm_grid_set(grid, 66, 10, 5, true);
  vxm_occupancy_mips mips;
  assert_int_equal(vxm_occupancy_mips_create(&mips, grid, NULL), VXM_OK);
  for (int axis = 0; axis < 3; axis++)
    for (int forward = 0; forward < 2; forward++) {
      double o[3] = {66.5, 10.5, 5.5}, d[3] = {0, 0, 0};
      o[axis] = forward ? -3 : 200;
      d[axis] = forward ? 2 : -2;
      vxm_hit hit;
      assert_true(vxm_raycast(&hit, &mips, o, d));
      assert_true(hit.axis == axis && hit.positive == !forward && hit.voxel[0] == 66);
      o[(axis + 1) % 3] += 1;
      assert_false(vxm_raycast(&hit, &mips, o, d));
      o[(axis + 1) % 3] = -1;
      assert_false(vxm_raycast(&hit, &mips, o, d));
    }
  vxm_occupancy_mips_destroy(&mips);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

/** The mips counts right, to rounding, and is 0 only where all is clear. */
static void test_pyramid(void **state) {
  (void)state;
  vxm_context *context = context_of(2);
  vxm_rng rng = {22};
  for (int round = 0; round < 12; round++) {
    vxm_grid *grid = new_grid(context, random_space(&rng, 70, false));
    fill_random(grid, &rng, round % KINDS);
    const int64_t *n = grid->space.dims;
    vxm_occupancy_mips mips;
    assert_int_equal(vxm_occupancy_mips_create(&mips, grid, NULL), VXM_OK);
    for (int l = 0; l < mips.levels; l++) {
      int64_t side = INT64_C(4) << l;
      for (int64_t k = 0; k < n[2]; k += side)
        for (int64_t j = 0; j < n[1]; j += side)
          for (int64_t i = 0; i < n[0]; i += side) {
            int64_t count = 0;
            for (int64_t v = 0; v < side * side * side; v++)
              count += vxm_grid_get(grid, i + v % side, j + v / side % side, k + v / side / side);
            double part = 255.0 * (double)count / (double)(side * side * side);
            uint8_t cell = vxm_occupancy_mips_cell(&mips, l, (int64_t[3]){i, j, k});
            assert_true(cell >= part - 1e-9 && cell < part + l + 1 && (cell == 0) == (count == 0));
          }
    }
    vxm_occupancy_mips_destroy(&mips);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

/** No voxel lies before the depth of its tile, nor where there is none; and most tiles without voxels know
 * it.
 */
static void test_tiles(void **state) {
  (void)state;
  vxm_context *context = context_of(1);
  vxm_rng rng = {25};
  for (int round = 0; round < 40; round++) {
    vxm_grid *grid = new_grid(context, unit_space(90, 50, 70));
    for (int n = 0; n < 6; n++)
      vxm_grid_set(grid, (int64_t)vxm_rng_below(&rng, 90), (int64_t)vxm_rng_below(&rng, 50),
                   (int64_t)vxm_rng_below(&rng, 70), true);
    vxm_scene scene = {.grid = grid, .step = {1, 1, 1}};
    assert_int_equal(vxm_occupancy_mips_create(&scene.mips, grid, NULL), VXM_OK);
    double angle = vxm_rng_unit(&rng) * 6;
    vxm_camera cam = {.width = 100, .height = 77, .pixel = 0.01, .top = {{0, 0, 1}}};
    cam.back = vxm_ray_vec3_of(cos(angle), sin(angle), 0);
    cam.right = vxm_ray_vec3_of(-sin(angle), cos(angle), 0);
    cam.eye = vxm_ray_vec3_add(vxm_ray_vec3_of(45, 25, 35), round < 4 ? 20 : 150, cam.back); /* 20: within */
    vxm_tiles tiles;
    assert_int_equal(vxm_tiles_create(&tiles, &scene, &cam, NULL), VXM_OK);
    int empty = 0;
    for (int r = 0; r < 3000; r++) {
      double x = vxm_rng_unit(&rng) * cam.width, y = vxm_rng_unit(&rng) * cam.height;
      vxm_ray_vec3 direction = vxm_camera_direction(&cam, x, y);
      vxm_hit hit;
      double depth = (double)vxm_tiles_depth(&tiles, x, y);
      empty += isinf(depth) != 0;
      if (vxm_raycast(&hit, &scene.mips, cam.eye.c, direction.c))
        assert_true(depth <= -hit.t * vxm_ray_vec3_dot(direction, cam.back));
    }
    assert_true(round < 4 || empty > 1500);
    vxm_tiles_destroy(&tiles);
    vxm_occupancy_mips_destroy(&scene.mips);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

#ifdef HAVE_PNG

#include <png.h>

typedef struct image {
  int width, height;
  unsigned char *rgb;
} image;

static image draw(const vxm_grid *grid, const char *path, const vxm_picture_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_picture(grid, NULL, NULL, path, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  png_image png = {.version = PNG_IMAGE_VERSION};
  assert_true(png_image_begin_read_from_file(&png, path));
  png.format = PNG_FORMAT_RGB;
  image result = {(int)png.width, (int)png.height, malloc(PNG_IMAGE_SIZE(png))};
  assert_non_null(result.rgb);
  assert_true(png_image_finish_read(&png, NULL, result.rgb, 0, NULL));
  return result;
}

/** Voxels are orange; the background and the shadow on it are grey. */
static bool is_voxel(const image *i, int x, int y) {
  const unsigned char *rgb = i->rgb + 3 * ((size_t)y * (size_t)i->width + (size_t)x);
  return rgb[0] > rgb[2] + 20;
}

typedef struct extent {
  int x0, y0, x1, y1, count;
} extent;

static extent find_voxels(const image *i) {
  extent e = {i->width, i->height, -1, -1, 0};
  for (int y = 0; y < i->height; y++)
    for (int x = 0; x < i->width; x++)
      if (is_voxel(i, x, y)) {
        e.x0 = x < e.x0 ? x : e.x0;
        e.x1 = x > e.x1 ? x : e.x1;
        e.y0 = y < e.y0 ? y : e.y0;
        e.y1 = y > e.y1 ? y : e.y1;
        e.count++;
      }
  return e;
}

static vxm_picture_options small(void) {
  vxm_picture_options options = VXM_PICTURE_OPTIONS_INIT;
  options.width = 160;
  options.height = 120;
  return options;
}

/** From every side the model is whole in the picture, in its middle, and fills most of one direction. */
static void test_framing(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_of(2);
  vxm_rng rng = {23};
  for (int round = 0; round < 24; round++) {
    vxm_space space = random_space(&rng, 60, round % 2);
    if (round % 3 == 0)
      space.voxel_size[1] *= 1e-200, space.voxel_size[0] *= 1e-200, space.voxel_size[2] *= 1e-200;
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % 4 == 0 ? 5 : round % 4);
    vxm_grid_set(grid, 0, 0, 0, true);
    vxm_picture_options options = small();
    options.azimuth = vxm_rng_unit(&rng) * 1000 - 500;
    options.elevation = round == 0 ? 90 : round == 1 ? -90 : vxm_rng_unit(&rng) * 180 - 90;
    options.up = round % 4;
    image i = draw(grid, path_in(folder, "p.png"), &options);
    assert_true(i.width == 160 && i.height == 120);
    extent e = find_voxels(&i);
    assert_true(e.count > 0 && e.x0 > 2 && e.y0 > 2 && e.x1 < 157 && e.y1 < 117);
    assert_true(e.x1 - e.x0 > 110 || e.y1 - e.y0 > 80);
    free(i.rgb);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

static void fill_box(vxm_grid *grid, const int64_t low[3], const int64_t high[3]) {
  for (int64_t k = low[2]; k < high[2]; k++)
    for (int64_t j = low[1]; j < high[1]; j++)
      vxm_row_set_span(vxm_grid_row(grid, j, k), low[0], high[0]);
}

/** A tower on a plate stands up, and on the side that the azimuth says. */
static void test_way_up(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_of(2);
  for (int up = 0; up < 4; up++) {
    int axis = up == 0 ? 2 : up - 1, e1 = (axis + 1) % 3, e2 = (axis + 2) % 3;
    vxm_grid *grid = new_grid(context, unit_space(32, 32, 32));
    int64_t low[3] = {0, 0, 0}, high[3] = {32, 32, 32};
    high[axis] = 6;
    fill_box(grid, low, high); /* the plate; the tower stands at its low end of e2 */
    high[axis] = 32;
    high[e2] = 8;
    low[e1] = 12;
    high[e1] = 20;
    fill_box(grid, low, high);
    vxm_picture_options options = small();
    options.up = up;
    options.azimuth = 0; /* seen from far along e1: e2 points right */
    options.elevation = 10;
    image i = draw(grid, path_in(folder, "p.png"), &options);
    extent e = find_voxels(&i);
    int width = e.x1 - e.x0, height = e.y1 - e.y0;
    assert_true(is_voxel(&i, e.x0 + width / 8, e.y0 + height / 4));      /* tower at the left, above */
    assert_false(is_voxel(&i, e.x0 + width * 7 / 8, e.y0 + height / 4)); /* nothing at the right, above */
    assert_true(is_voxel(&i, e.x0 + width * 7 / 8, e.y1 - height / 10)); /* the plate, below */
    free(i.rgb);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** How red a point of a plate is in the picture, in front of the post that may stand in its middle. */
static int plate_brightness(vxm_context *context, int axis, int64_t thickness, bool has_post,
                            const char *path) {
  vxm_grid *grid = new_grid(context, unit_space(96, 96, 96));
  int64_t low[3] = {0, 0, 0}, high[3] = {96, 96, 96};
  high[axis] = thickness;
  fill_box(grid, low, high);
  for (int a = 0; a < 3; a++) {
    low[a] = a == axis ? 0 : 47;
    high[a] = a == axis ? 30 : 49;
  }
  if (has_post)
    fill_box(grid, low, high);
  vxm_picture_options options = small();
  options.up = axis + 1;
  options.elevation = 40;
  image i = draw(grid, path, &options);
  extent e = find_voxels(&i);
  int x = (e.x0 + e.x1) / 2, y = e.y0 + (e.y1 - e.y0) * 8 / 10, red = i.rgb[3 * (y * i.width + x)];
  free(i.rgb);
  vxm_grid_destroy(grid);
  return red;
}

/** A plate of one voxel, small in the picture, has as much behind it as in front: it is lit as a thick one.
 */
static void test_thin_plates(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_of(2);
  for (int axis = 0; axis < 3; axis++)
    for (int post = 0; post < 2; post++) {
      int thick = plate_brightness(context, axis, 10, post, path_in(folder, "p.png"));
      for (int64_t thickness = 1; thickness < 4; thickness++)
        assert_in_range(plate_brightness(context, axis, thickness, post, path_in(folder, "p.png")),
                        thick - 12, thick + 12);
    }
  vxm_context_destroy(context);
  remove_folder(folder);
}

static void test_same_for_all_threads(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  unsigned char *first = NULL;
  size_t first_size = 0;
  static const int threads[] = {1, 2, 7};
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of(threads[t]);
    vxm_rng rng = {24};
    vxm_grid *grid = new_grid(context, unit_space(70, 60, 50));
    fill_random(grid, &rng, 3);
    vxm_picture_options options = small();
    assert_int_equal(vxm_gridio_picture(grid, NULL, NULL, path_in(folder, "p.png"), &options, NULL), VXM_OK);
    size_t size;
    unsigned char *data = load_file(path_in(folder, "p.png"), &size);
    if (first) {
      assert_int_equal(size, first_size);
      assert_memory_equal(data, first, size);
      free(data);
    } else {
      first = data;
      first_size = size;
    }
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  free(first);
  remove_folder(folder);
}

/** Default size, an empty grid, and options out of range. */
static void test_options(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_of(2);
  vxm_grid *grid = new_grid(context, unit_space(5, 5, 5));
  vxm_picture_options options = VXM_PICTURE_OPTIONS_INIT;
  image i = draw(grid, path_in(folder, "p.png"), &options);
  assert_true(i.width == 800 && i.height == 600);
  assert_int_equal(find_voxels(&i).count, 0);
  free(i.rgb);
  empty_folder(folder);
  vxm_picture_options bad[8];
  for (int b = 0; b < 8; b++)
    bad[b] = options;
  bad[0].width = -1;
  bad[1].height = 16385;
  bad[2].azimuth = NAN;
  bad[3].elevation = 90.5;
  bad[4].elevation = NAN;
  bad[5].up = 4;
  bad[6].up = -1;
  bad[7].azimuth = INFINITY;
  for (int b = 0; b < 8; b++) {
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_gridio_picture(grid, NULL, NULL, path_in(folder, "p.png"), &bad[b], &error),
                     VXM_ERROR_ARGUMENT);
    assert_true(error.text[0] != '\0');
  }
  assert_int_equal(count_files(folder), 0);
  assert_int_equal(vxm_gridio_picture(grid, NULL, NULL, path_in(folder, "no/p.png"), &options, NULL),
                   VXM_ERROR_IO);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

#else

static void test_unavailable(void **state) {
  (void)state;
  vxm_context *context = context_of(1);
  vxm_grid *grid = new_grid(context, unit_space(5, 5, 5));
  vxm_picture_options options = VXM_PICTURE_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_gridio_picture(grid, NULL, NULL, "no.png", &options, &error), VXM_ERROR_UNAVAILABLE);
  assert_non_null(strstr(error.text, "libpng"));
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rays),        cmocka_unit_test(test_rays_along_axes),
      cmocka_unit_test(test_pyramid),     cmocka_unit_test(test_tiles),
#ifdef HAVE_PNG
      cmocka_unit_test(test_framing),     cmocka_unit_test(test_way_up),
      cmocka_unit_test(test_thin_plates), cmocka_unit_test(test_same_for_all_threads),
      cmocka_unit_test(test_options),
#else
      cmocka_unit_test(test_unavailable),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
