/* SPDX-License-Identifier: BSD-3-Clause */
/** glTF through Assimp: transforms, names, what a file requires, and damage. */
#include "gltf_test.h"

#include "scenes.h"

/** A scene of wedges. `nodes` are the JSON objects of the nodes, of which the first is the root. */
static bytes gltf(const char *nodes, const char *primitive) {
  bytes b = {0};
  bytes_text(&b, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],",
             nodes);
  bytes_text(&b,
             "\"materials\":[{\"name\":\"red\"},{}],\"meshes\":[{\"name\":\"wedge\",\"primitives\":[{"
             "\"attributes\":{\"POSITION\":0}%s}]}],",
             primitive);
  bytes_text(&b, "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","
                 "\"min\":[0,0,0],\"max\":[1,1,1]},{\"bufferView\":1,\"componentType\":5123,\"count\":12,"
                 "\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
                 "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":24}],\"buffers\":[{\"byteLength\":72,"
                 "\"uri\":\"data:application/octet-stream;base64," WEDGE "\"}]}");
  return b;
}

#define TRIANGLES ",\"indices\":1,\"material\":0"

static vxm_soup *read_gltf(const char *nodes, const char *primitive) {
  bytes b = gltf(nodes, primitive);
  vxm_soup *soup = read_data(b.data, b.size, "dir/a.gltf");
  assert_string_equal(soup->format, "gltf");
  bytes_free(&b);
  return soup;
}

static void test_transforms(void **state) {
  (void)state;
  static const struct {
    const char *node;
    double bounds[6], volume;
  } cases[] = {
      {"{\"mesh\":0}", {0, 0, 0, 1, 1, 1}, 1.0 / 6},
      {"{\"mesh\":0,\"translation\":[1,2,3]}", {1, 2, 3, 2, 3, 4}, 1.0 / 6},
      {"{\"mesh\":0,\"scale\":[2,3,4]}", {0, 0, 0, 2, 3, 4}, 4},
      {"{\"mesh\":0,\"scale\":[-2,3,4]}", {-2, 0, 0, 0, 3, 4}, 4}, /* mirrored, and outward all the same */
      {"{\"mesh\":0,\"scale\":[-2,-3,4]}", {-2, -3, 0, 0, 0, 4}, 4},
      {"{\"mesh\":0,\"rotation\":[0,0,0.70710678118654752,0.70710678118654752]}",
       {-1, 0, 0, 0, 1, 1},
       1.0 / 6},
      {"{\"mesh\":0,\"matrix\":[0,2,0,0,-3,0,0,0,0,0,4,0,5,6,7,1]}", {2, 6, 7, 5, 8, 11}, 4},
      /* The outer transform comes after the inner one. */
      {"{\"translation\":[10,0,0],\"scale\":[2,2,2],\"children\":[1]},{\"mesh\":0,\"translation\":[1,0,0]}",
       {12, 0, 0, 14, 2, 2},
       8.0 / 6},
  };
  if (!vxm_module_exists("assimp"))
    skip();
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    vxm_soup *soup = read_gltf(cases[i].node, TRIANGLES);
    expect_counts(soup, 4, 4);
    expect_no_warnings(soup);
    expect_body(soup, cases[i].bounds, cases[i].volume, 1e-6);
    vxm_soup_destroy(soup);
  }
}

static void test_names(void **state) {
  (void)state;
  static const struct {
    const char *nodes, *primitive;
    size_t faces;
    const char *tags[8];
  } cases[] = {
      {"{\"name\":\"part\",\"mesh\":0}", TRIANGLES, 4, {"wedge/red"}}, /* a root is no part of its own */
      {"{\"children\":[1]},{\"name\":\"part\",\"mesh\":0}", TRIANGLES, 4, {"part/red"}},
      {"{\"children\":[1]},{\"name\":\"part\",\"mesh\":0}", ",\"indices\":1", 4, {"part"}},
      {"{\"children\":[1,2,3]},{\"name\":\"a\",\"mesh\":0},{\"name\":\"b\",\"mesh\":0},{\"name\":\"a\","
       "\"mesh\":0}",
       TRIANGLES,
       12,
       {"a#1/red", "b/red", "a#2/red"}},
      {"{\"children\":[1]},{\"name\":\"a\",\"mesh\":0,\"children\":[2]},{\"name\":\"b\",\"mesh\":0}",
       TRIANGLES,
       8,
       {"a/red", "b/red"}},
      {"{\"children\":[1]},{\"name\":\"  M\\u00fcller/\\u0001b \",\"mesh\":0}",
       TRIANGLES,
       4,
       {"M\xc3\xbcller/?b/red"}},
  };
  if (!vxm_module_exists("assimp"))
    skip();
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    vxm_soup *soup = read_gltf(cases[i].nodes, cases[i].primitive);
    assert_int_equal(soup->face_count, cases[i].faces);
    expect_tags(soup, cases[i].tags);
    vxm_soup_destroy(soup);
  }
}

static void test_lines_and_points(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  for (int mode = 0; mode < 2; mode++) {
    char primitive[48];
    snprintf(primitive, sizeof primitive, ",\"indices\":1,\"mode\":%d", mode);
    vxm_soup *soup = read_gltf("{\"mesh\":0}", primitive);
    assert_int_equal(soup->face_count, 0);
    assert_int_equal(soup->tag_count, 0);
    expect_warning(soup, mode == 0 ? "lines and points are skipped (elements: 12)"
                                   : "lines and points are skipped (elements: 6)");
    expect_warning(soup, "the file has no faces");
    vxm_soup_destroy(soup);
  }
}

static void test_stool(void **state) {
  (void)state;
  static const double bounds[6] = {-0.2, 0, -0.15, 0.2, 0.45, 0.15};
  static const char *const tags[] = {"seat/oak",    "leg#1/steel", "leg#2/steel",
                                     "leg#3/steel", "leg#4/steel", NULL};
  static const char *const names[] = {"dir/stool.glb", "stool.GLB", "stool.dat", "stool.gltf",
                                      "stool",         "-",         "<memory>"};
  if (!vxm_module_exists("assimp"))
    skip();
  double leg = STOOL_CORNERS / 2.0 * sin(2 * 3.14159265358979323846 / STOOL_CORNERS) * STOOL_RADIUS *
               STOOL_RADIUS * STOOL_LEG;
  double volume = (STOOL_LEGS * leg + (double)STOOL_WIDTH * STOOL_DEPTH * STOOL_SEAT) / 1e9;
  bytes b = scene_bytes(scene_write_glb);
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    vxm_soup *soup = read_data(b.data, b.size, names[n]);
    expect_body(soup, bounds, volume, 1e-6);
    expect_tags(soup, tags);
    assert_string_equal(soup->format, "gltf");
    vxm_soup_destroy(soup);
  }
  bytes_free(&b);
}

/** What a file says that it cannot be read right without. */
static void test_required(void **state) {
  (void)state;
  static const char *const harmless[] = {"KHR_materials_unlit", "KHR_texture_transform", "KHR_texture_basisu",
                                         "KHR_lights_punctual", "EXT_texture_webp"};
  static const struct {
    const char *name, *advice;
  } refused[] = {{"EXT_meshopt_compression", "unpack it with 'gltf-transform copy IN OUT.glb'"},
                 {"EXT_mesh_gpu_instancing", "export it with a node for each instance"},
                 {"KHR_texture", "export it without"},
                 {"CESIUM_RTC", "export it without"},
                 {"XX_unknown", "export it without"}};
  char nodes[200], told[200];
  if (!vxm_module_exists("assimp"))
    skip();
  for (size_t i = 0; i < 5; i++) {
    snprintf(nodes, sizeof nodes, "{\"mesh\":0}],\"extensionsRequired\":[\"%s\"", harmless[i]);
    vxm_soup *soup = read_gltf(nodes, TRIANGLES);
    expect_counts(soup, 4, 4);
    vxm_soup_destroy(soup);
  }
  for (size_t i = 0; i < 5; i++) {
    snprintf(nodes, sizeof nodes, "{\"mesh\":0}],\"extensionsRequired\":[\"KHR_materials_unlit\",\"%s\"",
             refused[i].name);
    snprintf(told, sizeof told, "a.gltf: it needs the glTF extension %s, which is not read: %s",
             refused[i].name, refused[i].advice);
    bytes b = gltf(nodes, TRIANGLES);
    read_fails(b.data, b.size, "a.gltf", VXM_ERROR_FORMAT, told);
    bytes_free(&b);
  }
  /* Instances would be lost, also where the file does not call them required. */
  bytes b = gltf("{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}", TRIANGLES);
  read_fails(b.data, b.size, "a.gltf", VXM_ERROR_FORMAT,
             "it needs the glTF extension EXT_mesh_gpu_instancing");
  bytes_free(&b);
  b = gltf("{\"name\":\"\xe9\",\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}", TRIANGLES);
  read_fails(b.data, b.size, "a.gltf", VXM_ERROR_FORMAT, "its JSON is damaged: line 1");
  bytes_free(&b);
}

/** The named format decides where the name of the file says nothing. */
static void test_format(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  bytes b = gltf("{\"mesh\":0}", TRIANGLES);
  options.format = "gltf";
  assert_int_equal(vxm_meshio_read(&soup, NULL, b.data, b.size, "a", &options, &error), VXM_OK);
  expect_counts(soup, 4, 4);
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

static void test_damage(void **state) {
  (void)state;
  enum { TIMES = 40 / SLOWER };
  if (!vxm_module_exists("assimp"))
    skip();
  bytes glb = scene_bytes(scene_write_glb), text = gltf("{\"mesh\":0}", TRIANGLES);
  damage_many(&glb, "a.glb", TIMES);
  damage_many(&text, "a.gltf", TIMES);
  bytes_free(&glb);
  bytes_free(&text);
  text_fails("{\"asset\":{\"version\":\"2.0\"}", "a.gltf",
             "a.gltf: Assimp cannot read it: it is likely cut off or damaged, or no .gltf file");
  text_fails("glTF\2", "a.dat", "a.dat: the file is cut off: 5 of 20 bytes are there");
}

static void test_in_process(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  bytes glb = scene_bytes(scene_write_glb);
  vxm_soup_destroy(read_in_process("assimp", "glb", &glb));
  bytes_free(&glb);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_transforms),       cmocka_unit_test(test_names),
      cmocka_unit_test(test_lines_and_points), cmocka_unit_test(test_stool),
      cmocka_unit_test(test_required),         cmocka_unit_test(test_format),
      cmocka_unit_test(test_damage),           cmocka_unit_test(test_in_process)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
