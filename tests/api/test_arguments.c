/* SPDX-License-Identifier: BSD-3-Clause */
/** Every public function with arguments that it must refuse, and what it says then: contexts and meshes. */
#include "arguments_test.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

/** What a call was to create is NULL after any failure, whatever the variable held before. */
static void test_outputs_after_refusal(void **state) {
  (void)state;
#define NULL_AFTER(type, call)                  \
  do {                                          \
    type *created = junk;                       \
    assert_int_equal(call, VXM_ERROR_ARGUMENT); \
    assert_null(created);                       \
  } while (0)
  NULL_AFTER(vxm_mesh, vxm_mesh_create(&created, NULL, NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_read(&created, NULL, NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_read_memory(&created, NULL, NULL, 5, "x.off", NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_read_with(&created, NULL, NULL, NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_read_memory_with(&created, NULL, NULL, 5, "x.off", NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_repair(&created, NULL, NULL, NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_mesh_prepare(&created, NULL, NULL, NULL, NULL));
  NULL_AFTER(vxm_mesh, vxm_grid_surface_mesh(&created, NULL, NULL));
  NULL_AFTER(vxm_grid, vxm_grid_create(&created, NULL, NULL, NULL));
  NULL_AFTER(vxm_grid, vxm_grid_read(&created, NULL, NULL, NULL));
  NULL_AFTER(vxm_grid, vxm_voxelize(&created, NULL, NULL, NULL, NULL, NULL));
#undef NULL_AFTER
}

static void test_names(void **state) {
  (void)state;
  char version[32];
  snprintf(version, sizeof version, "%d.%d.%d", VXM_VERSION_MAJOR, VXM_VERSION_MINOR, VXM_VERSION_PATCH);
  assert_string_equal(vxm_version(), version);
  for (int a = VXM_OK; a <= VXM_ERROR_CANCELLED; a++)
    for (int b = VXM_OK; b < a; b++)
      assert_string_not_equal(vxm_status_name((vxm_status)a), vxm_status_name((vxm_status)b));
  assert_string_equal(vxm_status_name((vxm_status)1000), "unknown");
}

static void test_destroying_nothing(void **state) {
  (void)state;
  vxm_context_destroy(NULL);
  vxm_mesh_destroy(NULL);
  vxm_grid_destroy(NULL);
}

static void test_context(void **state) {
  (void)state;
  vxm_context *context = junk;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  REFUSED(vxm_context_create(NULL, &options, &error), VXM_ERROR_ARGUMENT);
  options.size = 2;
  REFUSED(vxm_context_create(&context, &options, &error), VXM_ERROR_ARGUMENT);
  assert_null(context);
  options = (vxm_context_options)VXM_CONTEXT_OPTIONS_INIT;
  options.threads = -1;
  REFUSED(vxm_context_create(&context, &options, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_ERROR_ARGUMENT);
  options.threads = 3;
  assert_int_equal(vxm_context_create(&context, &options, &error), VXM_OK);
  assert_int_equal(vxm_context_threads(context), 3);
  assert_true(vxm_context_threads(NULL) >= 1);
  assert_int_equal(vxm_context_peak_bytes(context), 0);
  vxm_context_destroy(context);
}

/* ---- Meshes ---- */

static void test_mesh_arrays(void **state) {
  (void)state;
  vxm_mesh *mesh = junk;
  vxm_mesh_arrays arrays = tetrahedron();
  REFUSED(vxm_mesh_create(NULL, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_create(&mesh, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  arrays.size = 2;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_null(mesh);
  arrays = tetrahedron();
  arrays.vertex_scalar = (vxm_scalar)7;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays = tetrahedron();
  arrays.vertices = NULL;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays = tetrahedron();
  arrays.indices = NULL;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays = tetrahedron();
  arrays.vertex_count = -1;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays = tetrahedron();
  arrays.face_count = -1;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays = tetrahedron();
  arrays.vertex_count = INT64_C(1) << 40;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_RANGE);
  arrays = tetrahedron();
  arrays.face_count = INT64_MAX;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_RANGE);
  assert_null(mesh);
}

/** No index is read that the caller has not said to be there, and none is left over. */
static void test_counts_of_arrays(void **state) {
  (void)state;
  static const int64_t whole[] = {0, 3, 6, 9, 12}, shorter[] = {0, 3, 6, 9, 11}, beyond[] = {0, 3, 6, 9, 15};
  static const struct {
    const int64_t *offsets;
    int64_t count;
    vxm_status status;
  } cases[] = {{NULL, 12, VXM_OK},
               {NULL, 11, VXM_ERROR_ARGUMENT},
               {NULL, 13, VXM_ERROR_ARGUMENT},
               {NULL, 0, VXM_ERROR_ARGUMENT},
               {NULL, -1, VXM_ERROR_ARGUMENT},
               {whole, 12, VXM_OK},
               {whole, 11, VXM_ERROR_ARGUMENT},
               {whole, 13, VXM_ERROR_ARGUMENT},
               {shorter, 12, VXM_ERROR_ARGUMENT},
               {beyond, 12, VXM_ERROR_ARGUMENT}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    vxm_mesh *mesh = junk;
    vxm_mesh_arrays arrays = tetrahedron();
    arrays.offsets = cases[i].offsets;
    arrays.index_count = cases[i].count;
    assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), cases[i].status);
    assert_int_equal(mesh == NULL, cases[i].status != VXM_OK);
    vxm_mesh_destroy(mesh);
  }
}

/** Indices of every type make the same mesh; what no vertex can be is told by face in each. */
static void test_types_of_indices(void **state) {
  (void)state;
  const vxm_scalar types[] = {VXM_INT64, VXM_UINT32, VXM_INT32};
  for (int corner = -1; corner < 12; corner++)
    for (int type = 0; type < 3; type++) {
      vxm_mesh_arrays arrays = tetrahedron();
      int64_t wide[12];
      uint32_t whole[12];
      int32_t narrow[12];
      memcpy(wide, arrays.indices, sizeof wide);
      for (int c = 0; c < 12; c++) {
        if (c == corner)
          wide[c] = type == 1 ? 4 : -1;
        whole[c] = (uint32_t)wide[c];
        narrow[c] = (int32_t)wide[c];
      }
      const void *const given[] = {wide, whole, narrow};
      arrays.indices = given[type];
      arrays.index_scalar = types[type];
      vxm_mesh *mesh = junk;
      if (corner >= 0) {
        REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
        assert_int_equal(error.element, corner / 3);
        continue;
      }
      assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_OK);
      for (int c = 0; c < 12; c++)
        assert_int_equal(vxm_mesh_indices(mesh)[c], wide[c]);
      vxm_mesh_destroy(mesh);
    }
  vxm_mesh *mesh = junk;
  vxm_mesh_arrays arrays = tetrahedron();
  arrays.index_scalar = VXM_UINT8;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
}

/** The face at fault is named by its number. */
static void test_faces_at_fault(void **state) {
  (void)state;
  static const int64_t high[] = {0, 2, 1, 0, 1, 3, 1, 2, 4, 2, 0, 3};
  static const int64_t negative[] = {0, 2, 1, 0, -1, 3, 1, 2, 3, 2, 0, 3};
  static const int64_t backward[] = {0, 3, 6, 5, 12}, thin[] = {0, 3, 6, 9, 11},
                       shifted[] = {1, 4, 7, 10, 12};
  vxm_mesh *mesh = junk;
  vxm_mesh_arrays arrays = tetrahedron();
  arrays.indices = high;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(error.element, 2);
  assert_non_null(strstr(error.text, "face 2"));
  arrays.indices = negative;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(error.element, 1);
  arrays = tetrahedron();
  arrays.offsets = backward;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(error.element, 2);
  arrays.offsets = thin;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(error.element, 3);
  arrays.offsets = shifted;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_null(mesh);
}

/** 32- and 64-bit coordinates, triangles with and without offsets: the same mesh. */
static void test_kinds_of_arrays(void **state) {
  (void)state;
  float single[12];
  for (int i = 0; i < 12; i++)
    single[i] = (float)corners[i];
  static const int64_t offsets[] = {0, 3, 6, 9, 12};
  vxm_mesh *meshes[2] = {NULL, NULL};
  vxm_mesh_arrays arrays = tetrahedron();
  assert_int_equal(vxm_mesh_create(&meshes[0], NULL, &arrays, NULL), VXM_OK);
  arrays.vertex_scalar = VXM_FLOAT32;
  arrays.vertices = single;
  arrays.offsets = offsets;
  assert_int_equal(vxm_mesh_create(&meshes[1], NULL, &arrays, NULL), VXM_OK);
  for (int i = 0; i < 2; i++) {
    assert_int_equal(vxm_mesh_vertex_count(meshes[i]), 4);
    assert_int_equal(vxm_mesh_face_count(meshes[i]), 4);
    assert_memory_equal(vxm_mesh_vertices(meshes[i]), corners, sizeof corners);
    for (int f = 0; f <= 4; f++)
      assert_int_equal(vxm_mesh_offsets(meshes[i])[f], 3 * f);
    for (int c = 0; c < 12; c++)
      assert_int_equal(vxm_mesh_indices(meshes[i])[c], ((const int64_t *)arrays.indices)[c]);
    assert_string_equal(vxm_mesh_format(meshes[i]), "arrays");
    assert_int_equal(vxm_mesh_tag_count(meshes[i]), 0);
    assert_null(vxm_mesh_face_tags(meshes[i]));
    assert_string_equal(vxm_mesh_tag_name(meshes[i], 0), "");
    assert_string_equal(vxm_mesh_warning(meshes[i], -1), "");
    vxm_mesh_destroy(meshes[i]);
  }
}

static void test_mesh_tags(void **state) {
  (void)state;
  static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const int64_t numbers[6] = {0, 1, 2, 1, 2, 3};
  static const char *const names[2] = {"one/red", "two"};
  uint32_t tags[2] = {1, 0};
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = points;
  arrays.vertex_count = 4;
  arrays.indices = numbers;
  arrays.index_count = 6;
  arrays.face_count = 2;
  arrays.tags = names;
  arrays.face_tags = tags;
  arrays.tag_count = 2;
  vxm_mesh *mesh = NULL;
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), VXM_OK);
  assert_int_equal(vxm_mesh_tag_count(mesh), 2);
  assert_string_equal(vxm_mesh_tag_name(mesh, 0), "one/red");
  assert_string_equal(vxm_mesh_tag_name(mesh, 1), "two");
  assert_memory_equal(vxm_mesh_face_tags(mesh), tags, sizeof tags);
  vxm_mesh_destroy(mesh);
  tags[1] = 2;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(error.element, 1);
  arrays.face_tags = NULL;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays.tag_count = -1;
  REFUSED(vxm_mesh_create(&mesh, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
}

static void test_mesh_files(void **state) {
  (void)state;
  vxm_mesh *mesh = junk;
  REFUSED(vxm_mesh_read(NULL, NULL, "x.off", &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_read(&mesh, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_read(&mesh, NULL, "no/such/file.off", &error), VXM_ERROR_IO);
  assert_null(mesh);
  assert_string_equal(error.file, "no/such/file.off");
  assert_int_equal(error.system, ENOENT);
  assert_non_null(strstr(error.text, "no/such/file.off"));
  REFUSED(vxm_mesh_read(&mesh, NULL, ".", &error), VXM_ERROR_IO);
  assert_int_equal(error.system, EISDIR);
  REFUSED(vxm_mesh_read_memory(&mesh, NULL, NULL, 5, "x.off", &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_read_memory(&mesh, NULL, "", 0, "x.off", &error), VXM_ERROR_FORMAT);
  REFUSED(vxm_mesh_read_memory(&mesh, NULL, "\x01\x02\x03", 3, NULL, &error), VXM_ERROR_FORMAT);
  assert_null(mesh);

  static const char text[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  vxm_mesh_read_options reading = {.size = 2};
  REFUSED(vxm_mesh_read_with(&mesh, NULL, "x.off", &reading, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_read_memory_with(&mesh, NULL, text, strlen(text), "x", &reading, &error),
          VXM_ERROR_ARGUMENT);
  static const double wrong[] = {-0.5, 1.5, NAN, INFINITY};
  for (size_t w = 0; w < sizeof wrong / sizeof *wrong; w++) {
    reading = (vxm_mesh_read_options){.size = sizeof(vxm_mesh_read_options), .deflection = wrong[w]};
    REFUSED(vxm_mesh_read_with(&mesh, NULL, "x.off", &reading, &error), VXM_ERROR_ARGUMENT);
    REFUSED(vxm_mesh_read_memory_with(&mesh, NULL, text, strlen(text), "x", &reading, &error),
            VXM_ERROR_ARGUMENT);
  }
  reading = (vxm_mesh_read_options){.size = sizeof(vxm_mesh_read_options), .format = "word"};
  REFUSED(vxm_mesh_read_memory_with(&mesh, NULL, text, strlen(text), "x", &reading, &error),
          VXM_ERROR_ARGUMENT);
  assert_null(mesh);
  reading.format = "OFF";
  assert_int_equal(vxm_mesh_read_memory_with(&mesh, NULL, text, strlen(text), "x.stl", &reading, &error),
                   VXM_OK);
  vxm_mesh_destroy(mesh);
  reading.format = "stl";
  REFUSED(vxm_mesh_read_memory_with(&mesh, NULL, text, strlen(text), "x.off", &reading, &error),
          VXM_ERROR_FORMAT);

  vxm_mesh_arrays arrays = tetrahedron();
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), VXM_OK);
  vxm_mesh_write_options options = VXM_MESH_WRITE_OPTIONS_INIT;
  REFUSED(vxm_mesh_write(NULL, "x.off", NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_write(mesh, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_write(mesh, "x.dwg", NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_write(mesh, "no/such/folder/x.off", NULL, &error), VXM_ERROR_IO);
  options.format = "dwg";
  REFUSED(vxm_mesh_write(mesh, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
  options = (vxm_mesh_write_options){.size = 2, .format = "off"};
  REFUSED(vxm_mesh_write(mesh, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
  vxm_mesh_destroy(mesh);
}

static void test_census_and_repair(void **state) {
  (void)state;
  vxm_mesh *mesh = NULL, *repaired = junk;
  vxm_mesh_arrays arrays = tetrahedron();
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), VXM_OK);
  vxm_census census = VXM_CENSUS_INIT;
  REFUSED(vxm_mesh_census(NULL, mesh, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_census(&census, NULL, &error), VXM_ERROR_ARGUMENT);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  REFUSED(vxm_mesh_repair(NULL, NULL, mesh, &options, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_mesh_repair(&repaired, NULL, NULL, &options, &error), VXM_ERROR_ARGUMENT);
  options.size = 0;
  REFUSED(vxm_mesh_repair(&repaired, NULL, mesh, &options, &error), VXM_ERROR_ARGUMENT);
  assert_null(repaired);
  options = (vxm_repair_options)VXM_REPAIR_OPTIONS_INIT;
  options.weld = (vxm_weld)9;
  REFUSED(vxm_mesh_repair(&repaired, NULL, mesh, &options, &error), VXM_ERROR_ARGUMENT);
  options.weld = VXM_WELD_TOLERANCE;
  static const double tolerances[] = {-1.0, (double)NAN, (double)INFINITY};
  for (int i = 0; i < 3; i++) {
    options.weld_tolerance = tolerances[i];
    REFUSED(vxm_mesh_repair(&repaired, NULL, mesh, &options, &error), VXM_ERROR_ARGUMENT);
  }
  vxm_mesh_destroy(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_outputs_after_refusal),
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_destroying_nothing),
      cmocka_unit_test(test_context),
      cmocka_unit_test(test_mesh_arrays),
      cmocka_unit_test(test_counts_of_arrays),
      cmocka_unit_test(test_types_of_indices),
      cmocka_unit_test(test_faces_at_fault),
      cmocka_unit_test(test_kinds_of_arrays),
      cmocka_unit_test(test_mesh_tags),
      cmocka_unit_test(test_mesh_files),
      cmocka_unit_test(test_census_and_repair),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
