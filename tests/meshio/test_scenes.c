/* SPDX-License-Identifier: BSD-3-Clause */
/** COLLADA and small scene formats through Assimp: transforms, polygons, names, options, and damage. */
#include "external_test.h"

#define COLLADA_HEAD                                                                          \
  "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" " \
  "version=\"1.4.1\"><asset><unit name=\"cm\" meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset>"
#define COLLADA_SOURCE                                                                                     \
  "<library_geometries><geometry id=\"g\" name=\"block\"><mesh><source id=\"p\"><float_array id=\"a\" "    \
  "count=\"24\">0 0 0 1 0 0 1 2 0 0 2 0 0 0 3 1 0 3 1 2 3 0 2 3</float_array><technique_common><accessor " \
  "source=\"#a\" count=\"8\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "            \
  "type=\"float\"/>"                                                                                       \
  "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
#define COLLADA_FACES                                                                                       \
  "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><polylist count=\"6\"><input " \
  "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>4 4 4 4 4 4</vcount><p>0 3 2 1 4 5 6 7 0 1 5 4 " \
  "1 2 6 5 2 3 7 6 3 0 4 7</p></polylist></mesh></geometry></library_geometries>"
#define COLLADA_SCENE                                                                                        \
  "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n1\" name=\"box one\"><translate>10 0 0"         \
  "</translate><instance_geometry url=\"#g\"/></node><node id=\"n2\" name=\"box two\"><scale>2 2 2</scale>"  \
  "<node id=\"n3\" name=\"inner\"><translate>0 0 1</translate><instance_geometry url=\"#g\"/></node></node>" \
  "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"

static const char collada[] = COLLADA_HEAD COLLADA_SOURCE COLLADA_FACES COLLADA_SCENE;

/** Polygons stay polygons; Assimp makes metres of the file's unit and turns z upward into y upward. */
static void test_collada(void **state) {
  (void)state;
  static const double bounds[6] = {0, 0, -0.04, 0.11, 0.08, 0};
  static const char *const tags[] = {"box one", "inner", NULL};
  if (!vxm_module_exists("assimp"))
    skip();
  vxm_soup *soup = read_text(collada, "a.txt");
  assert_string_equal(soup->format, "collada");
  assert_int_equal(soup->face_count, 12);
  for (size_t f = 0; f < soup->face_count; f++)
    assert_int_equal(soup->offsets[f + 1] - soup->offsets[f], 4);
  expect_body(soup, bounds, 54e-6, 1e-7);
  expect_tags(soup, tags);
  vxm_soup_destroy(soup);
}

#define WEDGE_FACES_X "4; 3;0,2,1;, 3;0,1,3;, 3;1,2,3;, 3;2,0,3;;"

/** One wedge at (5,0,0) in several formats, of which some have z the other way round. */
static void test_small_formats(void **state) {
  (void)state;
  static const struct {
    const char *text, *format;
    double z; /**< of the lower side */
  } cases[] = {
      {"<?xml version=\"1.0\"?><X3D profile=\"Interchange\" version=\"3.0\"><Scene><Transform DEF=\"wedge\" "
       "translation=\"5 0 0\"><Shape><IndexedFaceSet coordIndex=\"0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1\">"
       "<Coordinate point=\"0 0 0 1 0 0 0 1 0 0 0 1\"/></IndexedFaceSet></Shape></Transform></Scene></X3D>",
       "x3d", 0},
      {"AC3Db\nMATERIAL \"grey\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\nOBJECT world\n"
       "kids 1\nOBJECT poly\nname \"wedge\"\nloc 5 0 0\nnumvert 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nnumsurf 4\n"
       "SURF 0x0\nmat 0\nrefs 3\n0 0 0\n2 0 0\n1 0 0\nSURF 0x0\nmat 0\nrefs 3\n0 0 0\n1 0 0\n3 0 0\n"
       "SURF 0x0\nmat 0\nrefs 3\n1 0 0\n2 0 0\n3 0 0\nSURF 0x0\nmat 0\nrefs 3\n2 0 0\n0 0 0\n3 0 0\nkids 0\n",
       "ac3d", 0},
      {"xof 0303txt 0032\nFrame wedge {\n FrameTransformMatrix { 1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, "
       "0.0,0.0,1.0,0.0, 5.0,0.0,0.0,1.0;; }\n Mesh m { 4; 0.0;0.0;0.0;, 1.0;0.0;0.0;, 0.0;1.0;0.0;, "
       "0.0;0.0;1.0;; " WEDGE_FACES_X " }\n}\n",
       "x", -1},
  };
  if (!vxm_module_exists("assimp"))
    skip();
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const double bounds[6] = {5, 0, cases[i].z, 6, 1, cases[i].z + 1};
    vxm_soup *soup = read_text(cases[i].text, "a.txt");
    assert_string_equal(soup->format, cases[i].format);
    expect_body(soup, bounds, 1.0 / 6, 1e-6);
    assert_int_equal(soup->tag_count, 1);
    assert_memory_equal(soup->tags[0], "wedge", 5);
    vxm_soup_destroy(soup);
  }
}

static void test_options(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  const unsigned char *data = (const unsigned char *)collada;
  /* The named format decides against content and name. */
  options.format = "Collada";
  assert_int_equal(vxm_meshio_read(&soup, NULL, data, strlen(collada), "a.obj", &options, &error), VXM_OK);
  vxm_soup_destroy(soup);
  options.format = "dae"; /* an extension is a name as well */
  assert_int_equal(vxm_meshio_read(&soup, NULL, data, strlen(collada), "<stdin>", &options, &error), VXM_OK);
  assert_string_equal(soup->format, "collada");
  vxm_soup_destroy(soup);
  options.format = "fbx";
  assert_int_equal(vxm_meshio_read(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_FORMAT);
  options.format = "off";
  assert_int_equal(vxm_meshio_read(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_FORMAT);
  assert_null(strstr(error.text, "Assimp"));
  options.format = "word";
  assert_int_equal(vxm_meshio_read(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "mesh format \"word\" is not known"));
}

static bytes collada_bytes(void) {
  bytes b = {0};
  bytes_add(&b, collada, strlen(collada));
  return b;
}

static void test_damage(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  bytes dae = collada_bytes();
  damage_many(&dae, "a.dae", 40 / SLOWER);
  bytes_free(&dae);
  text_fails("what is this", "a.fbx", "a.fbx: Assimp cannot read it: ");
  text_fails("what is this", "a.lws", "a.lws: this kind of scene imports other files, and is not read");
  text_fails("what is this", "a.IRR", "a.IRR: this kind of scene imports other files, and is not read");
  text_fails("what is this", "a.smd", "a.smd: this kind of file is not read: export it as .glb or .obj");
  text_fails("what is this", "a.xyz", "not a known mesh format");
}

static void test_in_process(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  bytes dae = collada_bytes();
  vxm_soup_destroy(read_in_process("assimp", "dae", &dae));
  bytes_free(&dae);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_collada), cmocka_unit_test(test_options),
                                     cmocka_unit_test(test_small_formats), cmocka_unit_test(test_damage),
                                     cmocka_unit_test(test_in_process)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
