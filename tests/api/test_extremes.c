/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Numbers that no one means: every field of every options struct at its extremes, counts that memory cannot
 * hold, coordinates at both ends of what a double can say, and objects destroyed in any order.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "voxmend.h"
#include "voxmend/experimental.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static vxm_error error;
static vxm_context *context;
static vxm_mesh *mesh;
static vxm_grid *grid;

/** Once by one: nothing is too large to be refused within this. */
enum { LIMIT = 64 << 20 };

/* ---- Options ---- */

typedef enum field_kind {
  CHOICE, /**< an int or enum: what is none of its values is refused */
  COUNT,  /**< int64_t */
  NUMBER  /**< double: what is not finite is refused */
} field_kind;

typedef struct field {
  const char *name;
  size_t offset;
  field_kind kind;
} field;

/** A struct of options, and a call that takes it. */
typedef struct options_case {
  const char *name;
  const void *start;
  size_t size;
  vxm_status (*call)(const void *options);
  field fields[20];
} options_case;

static vxm_status make_context(const void *options) {
  vxm_context *made;
  vxm_status status = vxm_context_create(&made, options, &error);
  vxm_context_destroy(made);
  return status;
}

static vxm_status make_mesh(const void *options) {
  vxm_mesh *made;
  vxm_status status = vxm_mesh_create(&made, context, options, &error);
  vxm_mesh_destroy(made);
  return status;
}

static vxm_status read_mesh(const void *options) {
  static const char text[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  vxm_mesh *made;
  vxm_status status = vxm_mesh_read_memory_with(&made, context, text, sizeof text - 1, "x", options, &error);
  vxm_mesh_destroy(made);
  return status;
}

static vxm_status write_mesh(const void *options) {
  return vxm_mesh_write(mesh, "/dev/null", options, &error);
}

static vxm_status compare_with(const void *options) {
  return vxm_baseline_voxelize(grid, NULL, mesh, options, &error);
}

static vxm_status repair_mesh(const void *options) {
  vxm_mesh *made;
  vxm_status status = vxm_mesh_repair(&made, NULL, mesh, options, &error);
  vxm_mesh_destroy(made);
  return status;
}

static vxm_status write_grid(const void *options) {
  return vxm_grid_write(grid, "/dev/null", options, &error);
}

static vxm_status draw(const void *options) {
  return vxm_grid_picture(grid, "/dev/null", options, &error);
}

static vxm_status show(const void *options) {
  return vxm_grid_page(grid, "/dev/null", options, &error);
}

static vxm_status make_engine(const void *options) {
  vxm_engine *made;
  vxm_status status = vxm_engine_create(&made, context, "cpu", options, &error);
  vxm_engine_destroy(made);
  return status;
}

static vxm_status fit(const void *options) {
  vxm_space space;
  return vxm_space_fit(&space, mesh, options, &error);
}

static const vxm_space_options four = {.size = sizeof(vxm_space_options), .resolution = {4, 0, 0}};

static vxm_status voxelize(const void *options) {
  vxm_grid *made;
  vxm_status status = vxm_voxelize(&made, NULL, mesh, &four, options, &error);
  vxm_grid_destroy(made);
  return status;
}

static vxm_status with_model(vxm_status (*call)(vxm_model *, const vxm_space *, const void *),
                             const void *options) {
  static const vxm_space space = {{4, 4, 4}, {0, 0, 0}, {0.25, 0.25, 0.25}};
  vxm_model *model;
  assert_int_equal(vxm_model_create(&model, mesh, NULL, NULL), VXM_OK);
  vxm_status status = call(model, &space, options);
  vxm_model_destroy(model);
  return status;
}

static float values[4 * 4 * 4];

static vxm_status cover_model(vxm_model *model, const vxm_space *space, const void *options) {
  return vxm_model_coverage(values, NULL, model, space, options, &error);
}

static vxm_status measure_model(vxm_model *model, const vxm_space *space, const void *options) {
  return vxm_model_distance(values, NULL, model, space, options, &error);
}

static vxm_status label_model(vxm_model *model, const vxm_space *space, const void *options) {
  return vxm_model_labels((uint16_t *)values, NULL, model, space, options, &error);
}

static vxm_status color_model(vxm_model *model, const vxm_space *space, const void *options) {
  return vxm_model_colors((uint8_t *)values, NULL, model, space, options, &error);
}

static vxm_status cover(const void *options) {
  return with_model(cover_model, options);
}

static vxm_status measure(const void *options) {
  return with_model(measure_model, options);
}

static vxm_status label(const void *options) {
  return with_model(label_model, options);
}

static vxm_status color(const void *options) {
  return with_model(color_model, options);
}

static vxm_status sample(const void *options) {
  vxm_sampler *made;
  vxm_status status = vxm_sampler_create(&made, context, options, &error);
  if (status == VXM_OK && vxm_sampler_put(made, UINT32_MAX, mesh, NULL) == VXM_OK) {
    vxm_pose pose = VXM_POSE_INIT;
    assert_int_equal(vxm_sampler_pose(&pose, made, &(vxm_variant){UINT32_MAX, UINT32_MAX, UINT32_MAX}, NULL),
                     VXM_OK);
    for (int i = 0; i < 12; i++)
      assert_true(isfinite(pose.transform[i]));
  }
  vxm_sampler_destroy(made);
  return status;
}

static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const int64_t indices[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
static const vxm_mesh_arrays arrays = {.size = sizeof(vxm_mesh_arrays),
                                       .index_scalar = VXM_INT64,
                                       .vertices = corners,
                                       .vertex_count = 4,
                                       .indices = indices,
                                       .index_count = 12,
                                       .face_count = 4};
static const vxm_context_options context_options = VXM_CONTEXT_OPTIONS_INIT;
static const vxm_mesh_read_options read_options = {.size = sizeof(vxm_mesh_read_options), .deflection = 0.5};
static const vxm_mesh_write_options mesh_write = {.size = sizeof(vxm_mesh_write_options), .format = "off"};
static const vxm_repair_options repair = {.size = sizeof(vxm_repair_options),
                                          .weld = VXM_WELD_TOLERANCE,
                                          .weld_tolerance = 1e-9,
                                          .level = VXM_LEVEL_MANIFOLD};
static const vxm_grid_write_options grid_write = {.size = sizeof(vxm_grid_write_options), .format = "npy"};
static const vxm_picture_options picture = {sizeof(vxm_picture_options), 8, 8, 30, 25, 3, 0, 0.5};
static const vxm_page_options page = {.size = sizeof(vxm_page_options), .title = "title", .up = 3};
static const vxm_engine_options engine_options = VXM_ENGINE_OPTIONS_INIT;
static const vxm_space_options size_options = {.size = sizeof(vxm_space_options), .voxel_size = 0.25};
static const vxm_space_options bounds_options = {.size = sizeof(vxm_space_options),
                                                 .resolution = {4, 4, 4},
                                                 .use_bounds = true,
                                                 .bounds = {0, 0, 0, 1, 1, 1}};
static const vxm_voxelize_options voxelize_options = {.size = sizeof(vxm_voxelize_options)};
static const vxm_coverage_options coverage_options = {sizeof(vxm_coverage_options), 2, VXM_UINT8, NULL};
static const vxm_distance_options distance_options = VXM_DISTANCE_OPTIONS_INIT;
static const vxm_label_options label_options = VXM_LABEL_OPTIONS_INIT;
static const vxm_baseline_options baseline_options = {.size = sizeof(vxm_baseline_options),
                                                      .method = VXM_BASELINE_DENSITY};
static const vxm_color_options color_options = VXM_COLOR_OPTIONS_INIT;
static const vxm_sampler_options sampler_options = {.size = sizeof(vxm_sampler_options),
                                                    .resolution = 8,
                                                    .rotation = VXM_ROTATION_AXIS,
                                                    .axis = {0, 0, 1},
                                                    .noise = 64,
                                                    .displace = 0.01,
                                                    .voxelize = &voxelize_options};

#define F(type, member, kind) \
  { #member, offsetof(type, member), kind }
#define S(start, call) #start, &(start), sizeof(start), call

static const options_case cases[] = {
    {S(context_options, make_context), {F(vxm_context_options, threads, CHOICE)}},
    {S(arrays, make_mesh),
     {F(vxm_mesh_arrays, vertex_scalar, CHOICE), F(vxm_mesh_arrays, index_scalar, CHOICE),
      F(vxm_mesh_arrays, vertex_count, COUNT), F(vxm_mesh_arrays, index_count, COUNT),
      F(vxm_mesh_arrays, face_count, COUNT)}},
    {S(read_options, read_mesh), {F(vxm_mesh_read_options, deflection, NUMBER)}},
    {S(mesh_write, write_mesh), {{NULL, 0, CHOICE}}},
    {S(repair, repair_mesh),
     {F(vxm_repair_options, weld, CHOICE), F(vxm_repair_options, weld_tolerance, NUMBER),
      F(vxm_repair_options, level, CHOICE), F(vxm_repair_options, fill_holes, COUNT),
      F(vxm_repair_options, hole_fill, CHOICE), F(vxm_repair_options, wrap_alpha, NUMBER),
      F(vxm_repair_options, wrap_offset, NUMBER), F(vxm_repair_options, max_change, NUMBER),
      F(vxm_repair_options, drop_faces, COUNT), F(vxm_repair_options, drop_volume, NUMBER),
      F(vxm_repair_options, fallback_alpha, NUMBER), F(vxm_repair_options, sheets, CHOICE),
      F(vxm_repair_options, thickness, NUMBER)}},
    {S(grid_write, write_grid), {{NULL, 0, CHOICE}}},
    {S(picture, draw),
     {F(vxm_picture_options, width, CHOICE), F(vxm_picture_options, height, CHOICE),
      F(vxm_picture_options, azimuth, NUMBER), F(vxm_picture_options, elevation, NUMBER),
      F(vxm_picture_options, up, CHOICE), F(vxm_picture_options, slice_axis, CHOICE),
      F(vxm_picture_options, slice, NUMBER)}},
    {S(page, show), {F(vxm_page_options, up, CHOICE)}},
    {S(engine_options, make_engine),
     {F(vxm_engine_options, gl_method, CHOICE), F(vxm_engine_options, slice_axis, CHOICE),
      F(vxm_engine_options, displacement, NUMBER), F(vxm_engine_options, cl_method, CHOICE)}},
    {S(size_options, fit),
     {F(vxm_space_options, voxel_size, NUMBER), F(vxm_space_options, voxel_sizes[1], NUMBER),
      F(vxm_space_options, fit, CHOICE), F(vxm_space_options, pad, COUNT),
      F(vxm_space_options, resolution[0], COUNT), F(vxm_space_options, resolution[2], COUNT)}},
    {S(bounds_options, fit),
     {F(vxm_space_options, bounds[0], NUMBER), F(vxm_space_options, bounds[5], NUMBER),
      F(vxm_space_options, resolution[0], COUNT), F(vxm_space_options, resolution[1], COUNT)}},
    {S(voxelize_options, voxelize),
     {F(vxm_voxelize_options, method, CHOICE), F(vxm_voxelize_options, vote, CHOICE),
      F(vxm_voxelize_options, split_mode, CHOICE), F(vxm_voxelize_options, cavities, CHOICE),
      F(vxm_voxelize_options, mode, CHOICE), F(vxm_voxelize_options, surface, CHOICE),
      F(vxm_voxelize_options, thin, CHOICE)}},
    {S(coverage_options, cover),
     {F(vxm_coverage_options, subdivision, CHOICE), F(vxm_coverage_options, scalar, CHOICE)}},
    {S(distance_options, measure), {F(vxm_distance_options, band, NUMBER)}},
    {S(label_options, label), {F(vxm_label_options, by, CHOICE)}},
    {S(color_options, color), {F(vxm_color_options, by, CHOICE)}},
    {S(baseline_options, compare_with),
     {F(vxm_baseline_options, method, CHOICE), F(vxm_baseline_options, radius, NUMBER)}},
    {S(sampler_options, sample),
     {F(vxm_sampler_options, resolution, COUNT), F(vxm_sampler_options, pad, COUNT),
      F(vxm_sampler_options, rotation, CHOICE), F(vxm_sampler_options, axis[0], NUMBER),
      F(vxm_sampler_options, scale, NUMBER), F(vxm_sampler_options, displacement, CHOICE),
      F(vxm_sampler_options, displace, NUMBER), F(vxm_sampler_options, translate, NUMBER),
      F(vxm_sampler_options, noise, CHOICE), F(vxm_sampler_options, mirror, CHOICE)}},
};
enum { CASES = sizeof cases / sizeof *cases };

/** Calls with one field changed; what must be refused is, and either way there is one line or none. */
static void try_field(const options_case *c, const field *f, const void *value, size_t size, bool refused) {
  uint64_t room[64];
  assert_true(c->size <= sizeof room);
  memcpy(room, c->start, c->size);
  memcpy((char *)room + f->offset, value, size);
  error = (vxm_error)VXM_ERROR_INIT;
  vxm_status status = c->call(room);
  if (refused && status == VXM_OK)
    fail_msg("%s.%s is not looked at", c->name, f->name);
  if (status != error.code || (status != VXM_OK && (!error.text[0] || strchr(error.text, '\n'))))
    fail_msg("%s.%s: %s, but \"%s\"", c->name, f->name, vxm_status_name(status), error.text);
}

static void try_all(const options_case *c, const field *f) {
  static const int choices[] = {-1, 99, INT_MAX, INT_MIN};
  static const int64_t few[] = {INT64_MIN, INT64_MIN + 1, -1},
                       many[] = {INT64_MAX, INT64_MAX / 2, INT64_MAX / 24};
  static const double wrong[] = {NAN, INFINITY, -INFINITY};
  static const double odd[] = {
      -1, -0.0, 5e-324, 1e-300, 1e300, 1.7976931348623157e308, -1.7976931348623157e308};
  for (size_t i = 0; f->kind == CHOICE && i < 4; i++)
    try_field(c, f, &choices[i], sizeof choices[i], choices[i] != 99);
  for (size_t i = 0; f->kind == COUNT && i < 3; i++) {
    try_field(c, f, &few[i], sizeof few[i], false);
    try_field(c, f, &many[i], sizeof many[i], false);
  }
  for (size_t i = 0; f->kind == NUMBER && i < 3; i++)
    try_field(c, f, &wrong[i], sizeof wrong[i], true);
  for (size_t i = 0; f->kind == NUMBER && i < sizeof odd / sizeof *odd; i++)
    try_field(c, f, &odd[i], sizeof odd[i], false);
}

static void test_options(void **state) {
  (void)state;
  static const uint32_t versions[] = {0, 2, UINT32_MAX};
  for (int i = 0; i < CASES; i++) {
    error = (vxm_error)VXM_ERROR_INIT;
    if (cases[i].call(cases[i].start) != VXM_OK)
      fail_msg("%s: %s", cases[i].name, error.text);
    const field version = {"version", 0, CHOICE};
    for (int v = 0; v < 3; v++)
      try_field(&cases[i], &version, &versions[v], sizeof versions[v], true);
    for (const field *f = cases[i].fields; f->name; f++)
      try_all(&cases[i], f);
  }
}

/* ---- Counts ---- */

#define REFUSED(call)                           \
  do {                                          \
    error = (vxm_error)VXM_ERROR_INIT;          \
    assert_int_equal(call, VXM_ERROR_ARGUMENT); \
    assert_true(error.text[0] != '\0');         \
  } while (0)

static void test_counts(void **state) {
  (void)state;
  static const size_t counts[] = {SIZE_MAX, SIZE_MAX - 1, SIZE_MAX / 2 + 1, SIZE_MAX / 4, SIZE_MAX / 12};
  vxm_sampler *sampler;
  assert_int_equal(vxm_sampler_create(&sampler, context, &sampler_options, NULL), VXM_OK);
  vxm_variant variant = {0, 0, 0};
  const char *path = "/dev/null";
  vxm_device_voxels *voxels;
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
    REFUSED(vxm_sampler_batch(values, sampler, &variant, counts[i], VXM_VOXEL_FORMAT_UINT8, &error));
    REFUSED(vxm_sampler_batch_device(&voxels, sampler, &variant, counts[i], VXM_VOXEL_FORMAT_UINT8, &error));
    REFUSED(vxm_sampler_files(&path, sampler, &variant, counts[i], NULL, NULL, &error));
  }
  assert_int_equal(vxm_sampler_batch(values, sampler, &variant, 0, VXM_VOXEL_FORMAT_UINT8, &error), VXM_OK);
  vxm_sampler_destroy(sampler);
  vxm_mesh *made;
  REFUSED(vxm_mesh_read_memory(&made, context, "OFF", SIZE_MAX, "x", &error));
  REFUSED(vxm_mesh_read_memory(&made, context, "OFF", SIZE_MAX / 2 + 1, "x", &error));
  vxm_defects *defects;
  REFUSED(vxm_mesh_defects(&defects, mesh, INT64_MIN, false, &error));
  assert_int_equal(vxm_mesh_defects(&defects, mesh, INT64_MAX, false, NULL), VXM_OK);
  vxm_defects_destroy(defects);
  int64_t count;
  REFUSED(vxm_engines_find(NULL, INT64_MIN, &count, &error));
  REFUSED(vxm_engines_find(NULL, INT64_MAX, &count, &error));
  vxm_sampler_options list = sampler_options;
  list.rotation = VXM_ROTATION_LIST;
  list.rotations = corners;
  list.rotation_count = INT64_MAX;
  REFUSED(vxm_sampler_create(&sampler, context, &list, &error));
}

/** A face of very many corners, by offsets that end beyond all memory. */
static void test_offsets(void **state) {
  (void)state;
  static const int64_t ends[] = {INT64_MAX, INT64_MAX - 1, INT64_MAX / 4, INT64_MAX / 8 + 1};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    int64_t offsets[] = {0, ends[i]};
    vxm_mesh_arrays long_face = arrays;
    long_face.offsets = offsets;
    long_face.index_count = ends[i];
    long_face.face_count = 1;
    vxm_mesh *made = mesh;
    error = (vxm_error)VXM_ERROR_INIT;
    assert_int_not_equal(vxm_mesh_create(&made, context, &long_face, &error), VXM_OK);
    assert_null(made);
    assert_true(error.text[0] != '\0');
  }
}

/** Indices of getters and kinds beyond all that there is. */
static void test_indices(void **state) {
  (void)state;
  static const int64_t beyond[] = {-1, INT64_MIN, INT64_MAX, INT64_C(1) << 32};
  vxm_model *model;
  assert_int_equal(vxm_model_create(&model, mesh, NULL, NULL), VXM_OK);
  vxm_sparse *sparse;
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
    int64_t at = beyond[i];
    assert_string_equal(vxm_mesh_tag_name(mesh, at), "");
    assert_string_equal(vxm_mesh_warning(mesh, at), "");
    assert_string_equal(vxm_grid_warning(grid, at), "");
    assert_string_equal(vxm_model_warning(model, at), "");
    assert_string_equal(vxm_model_label_name(model, at), "");
    assert_int_equal(vxm_model_label_voxels(model, at), 0);
    assert_false(vxm_grid_get(grid, at, at, at));
    assert_false(vxm_sparse_get(sparse, 0, at, 0));
    vxm_grid_set(grid, at, 0, 0, true);
    int kind = (int)at;
    assert_string_equal(vxm_defect_name((vxm_defect_kind)(kind ? kind : 99)), "");
    assert_string_equal(vxm_status_name((vxm_status)(kind ? kind : 99)), "unknown");
  }
  vxm_sparse_destroy(sparse);
  vxm_model_destroy(model);
}

/* ---- Coordinates ---- */

static vxm_mesh *box(const double low[3], const double high[3]) {
  static const int64_t faces[] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};
  static const int64_t offsets[] = {0, 4, 8, 12, 16, 20, 24};
  double positions[24];
  for (int v = 0; v < 8; v++) {
    bool x = v == 1 || v == 2 || v == 5 || v == 6, y = v % 4 > 1, z = v > 3;
    positions[3 * v] = x ? high[0] : low[0];
    positions[3 * v + 1] = y ? high[1] : low[1];
    positions[3 * v + 2] = z ? high[2] : low[2];
  }
  vxm_mesh_arrays a = {.size = sizeof a,
                       .index_scalar = VXM_INT64,
                       .vertices = positions,
                       .vertex_count = 8,
                       .offsets = offsets,
                       .indices = faces,
                       .index_count = sizeof faces / sizeof *faces,
                       .face_count = 6};
  vxm_mesh *made;
  assert_int_equal(vxm_mesh_create(&made, context, &a, NULL), VXM_OK);
  return made;
}

/** As exact arithmetic has it, rounded to a double or to infinity. */
static void check_measure(double value, long double right) {
  if (right > (long double)1.7976931348623157e308)
    assert_true(isinf(value) && value > 0);
  else
    assert_true(fabs(value - (double)right) <= 1e-14 * (double)right);
}

static const double boxes[][6] = {
    {-1e308, -1e308, -1e308, 1e308, 1e308, 1e308},
    {-1.7976931348623157e308, -1.7976931348623157e308, -1.7976931348623157e308, 1.7976931348623157e308,
     1.7976931348623157e308, 1.7976931348623157e308},
    {0, 0, 0, 1e102, 1e102, 1e102},
    {0, 0, 0, 1e103, 1e103, 1e103},
    {1.7e308, 1.7e308, 1.7e308, 1.7976931348623157e308, 1.7976931348623157e308, 1.7976931348623157e308},
    {1e308, 0, 0, 1.0000000000000002e308, 1e-10, 1e-10},
    {-1.7e308, 0, 0, 1.7e308, 1e-308, 1e-300},
    {1e308, 0, 0, 1e308, 1e-10, 1e-10}, /* flat, and its frame is far smaller than its place */
    {0, 0, 0, 1e-100, 1e-100, 1e-100},
    {0, 0, 0, 1e-150, 1, 1e150},
    {0, 0, 0, 5e-324, 5e-324, 5e-324},
};

static void test_census(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
    const double *b = boxes[i];
    vxm_mesh *made = box(b, b + 3);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_mesh_census(&census, made, NULL), VXM_OK);
    long double x = (long double)b[3] - b[0], y = (long double)b[4] - b[1], z = (long double)b[5] - b[2];
    check_measure(census.area, 2 * (x * y + y * z + z * x));
    check_measure(census.volume, x * y * z);
    assert_memory_equal(census.bounds, b, sizeof census.bounds);
    assert_int_equal(census.vertices, 8);
    assert_int_equal(census.boundary_edges, 0);
    assert_int_equal(census.components, 1);
    vxm_mesh_destroy(made);
  }
}

/** Whatever becomes of such meshes, it is told in one line. */
static void test_pipeline(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++)
    for (int level = VXM_LEVEL_CLEAN; level <= VXM_LEVEL_CLOSED; level++) {
      vxm_mesh *made = box(boxes[i], boxes[i] + 3), *repaired;
      vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
      options.level = (vxm_level)level;
      options.part_changes = true;
      error = (vxm_error)VXM_ERROR_INIT;
      if (vxm_mesh_repair(&repaired, NULL, made, &options, &error) != VXM_OK)
        assert_true(error.text[0] != '\0');
      vxm_voxelize_options grid_options = voxelize_options;
      grid_options.method = level == VXM_LEVEL_CLOSED ? VXM_METHOD_WINDING : VXM_METHOD_VOTE;
      grid_options.mode = level == VXM_LEVEL_MANIFOLD ? VXM_MODE_BOTH : VXM_MODE_SOLID;
      vxm_grid *voxels;
      vxm_status status =
          vxm_voxelize(&voxels, NULL, repaired ? repaired : made, &four, &grid_options, &error);
      if (status == VXM_OK) {
        const vxm_space *space = vxm_grid_space(voxels);
        for (int a = 0; a < 3; a++)
          assert_true(isfinite(space->origin[a] + (double)space->dims[a] * space->voxel_size[a]));
      }
      vxm_grid_destroy(voxels);
      vxm_mesh_destroy(repaired);
      vxm_mesh_destroy(made);
    }
}

/** A grid whose far corner is no number, and one of voxels that are as small as numbers get. */
static void test_spaces(void **state) {
  (void)state;
  static const vxm_space wrong[] = {{{1 << 20, 1, 1}, {1e308, 0, 0}, {1e305, 1, 1}},
                                    {{2, 2, 2}, {0, 0, 0}, {1e308, 1e308, 1e308}},
                                    {{1, 1, 1}, {0, 0, 0}, {0, 1, 1}},
                                    {{1, 1, 1}, {0, NAN, 0}, {1, 1, 1}},
                                    {{1, INT64_MAX, 1}, {0, 0, 0}, {1, 1, 1}},
                                    {{INT64_MIN, 1, 1}, {0, 0, 0}, {1, 1, 1}}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    vxm_grid *made = grid;
    error = (vxm_error)VXM_ERROR_INIT;
    assert_int_not_equal(vxm_grid_create(&made, context, &wrong[i], &error), VXM_OK);
    assert_null(made);
    assert_true(error.text[0] != '\0');
  }
  static const vxm_space small = {{3, 3, 3}, {-1e308, 0, 0}, {5e-324, 5e-324, 5e-324}};
  vxm_grid *made;
  assert_int_equal(vxm_grid_create(&made, context, &small, NULL), VXM_OK);
  vxm_mesh *surface;
  vxm_grid_set(made, 1, 1, 1, true);
  assert_int_equal(vxm_grid_surface_mesh(&surface, made, NULL), VXM_OK);
  vxm_mesh_destroy(surface);
  vxm_grid_destroy(made);
}

/** Nothing at all, through everything. */
static void test_empty(void **state) {
  (void)state;
  vxm_mesh_arrays none = VXM_MESH_ARRAYS_INIT;
  vxm_mesh *empty, *repaired;
  vxm_census census = VXM_CENSUS_INIT;
  vxm_verification verification = VXM_VERIFICATION_INIT;
  vxm_defects *defects;
  vxm_model *model;
  assert_int_equal(vxm_mesh_create(&empty, context, &none, NULL), VXM_OK);
  assert_int_equal(vxm_mesh_census(&census, empty, NULL), VXM_OK);
  assert_false(census.closed);
  for (int level = VXM_LEVEL_CLEAN; level <= VXM_LEVEL_CLOSED; level++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = (vxm_level)level;
    options.part_changes = true;
    assert_int_equal(vxm_mesh_repair(&repaired, NULL, empty, &options, NULL), VXM_OK);
    assert_int_equal(vxm_mesh_part_change_count(repaired), 0);
    vxm_mesh_destroy(repaired);
    assert_int_equal(vxm_mesh_verify(&verification, empty, &options, NULL), VXM_OK);
  }
  assert_int_equal(vxm_mesh_defects(&defects, empty, 0, false, NULL), VXM_OK);
  assert_int_equal(vxm_defects_count(defects), 0);
  assert_int_equal(vxm_defects_write(defects, empty, "/dev/null", NULL), VXM_ERROR_ARGUMENT);
  vxm_defects_destroy(defects);
  assert_int_equal(vxm_model_create(&model, empty, NULL, &error), VXM_ERROR_EMPTY);
  vxm_sampler *sampler;
  assert_int_equal(vxm_sampler_create(&sampler, context, &sampler_options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, empty, NULL), VXM_ERROR_EMPTY);
  assert_int_equal(vxm_sampler_put(sampler, 0, NULL, NULL), VXM_OK);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(empty);
}

static int set_up(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = LIMIT;
  if (vxm_context_create(&context, &options, NULL) != VXM_OK)
    return 1;
  return vxm_mesh_create(&mesh, context, &arrays, NULL) == VXM_OK &&
                 vxm_voxelize(&grid, NULL, mesh, &four, NULL, NULL) == VXM_OK
             ? 0
             : 1;
}

static int tear_down(void **state) {
  (void)state;
  vxm_context_destroy(context);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_options), cmocka_unit_test(test_counts), cmocka_unit_test(test_offsets),
      cmocka_unit_test(test_indices), cmocka_unit_test(test_census), cmocka_unit_test(test_pipeline),
      cmocka_unit_test(test_spaces),  cmocka_unit_test(test_empty),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
