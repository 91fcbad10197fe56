/* SPDX-License-Identifier: BSD-3-Clause */
/** glTF and other scenes through Assimp: transforms, instances, names, polygons, and damage. */
#include "external_test.h"

#include "scenes.h"

/* ---- glTF as text ---- */

/** A wedge (0,0,0) (1,0,0) (0,1,0) (0,0,1), its volume 1/6: 4 positions, then 12 indices of 16 bits. */
#define WEDGE \
  "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAQACAAMAAgAAAAMA"

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
  if (!has_module("assimp"))
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
  if (!has_module("assimp"))
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
  if (!has_module("assimp"))
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
  if (!has_module("assimp"))
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

/* ---- Extensions of glTF ---- */

/** A .glb of a text and a buffer. */
static bytes glb(const char *json, const void *data, size_t size) {
  bytes b = {0};
  uint32_t length = (uint32_t)(strlen(json) + 3) / 4 * 4, rest = (uint32_t)(size + 3) / 4 * 4;
  const uint32_t head[] = {2, 12 + 8 + length + 8 + rest, length};
  bytes_add(&b, "glTF", 4);
  bytes_add(&b, head, sizeof head);
  bytes_text(&b, "JSON%s%*s", json, (int)(length - strlen(json)), "");
  bytes_add(&b, &rest, sizeof rest);
  bytes_add(&b, "BIN\0", 4);
  bytes_add(&b, data, size);
  bytes_add(&b, "\0\0\0", rest - size);
  return b;
}

/** A wedge of 4 vertices with `numbers` of a kind for positions, 8 bytes for each vertex, then its indices.
 */
static bytes quantized(int kind, bool is_normalized, const int64_t numbers[12], const char *more) {
  static const uint16_t faces[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  unsigned char data[4 * 8 + sizeof faces] = {0};
  char json[1600];
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++)
      if (kind < 5122)
        data[8 * v + c] = (unsigned char)numbers[3 * v + c];
      else
        memcpy(data + 8 * v + 2 * c, (uint16_t[]){(uint16_t)numbers[3 * v + c]}, 2);
  memcpy(data + 4 * 8, faces, sizeof faces);
  snprintf(
      json, sizeof json,
      "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0%s}],"
      "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"meshes\":[{\"primitives\":[{\"attributes\":{"
      "\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":%d,\"count\":4,"
      "\"type\":\"VEC3\",\"normalized\":%s},{\"bufferView\":1,\"componentType\":5123,\"count\":12,"
      "\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":32,\"byteStride\":8},"
      "{\"buffer\":0,\"byteOffset\":32,\"byteLength\":24}],\"buffers\":[{\"byteLength\":56}]}",
      more, kind, is_normalized ? "true" : "false");
  return glb(json, data, sizeof data);
}

/** What the numbers of each kind stand for (glTF 2.0, 3.6.2.2, and KHR_mesh_quantization). */
static void test_quantized(void **state) {
  (void)state;
  static const struct {
    int kind;
    int64_t least, most;
  } kinds[] = {{5120, -128, 127}, {5121, 0, 255}, {5122, -32768, 32767}, {5123, 0, 65535}};
  if (!has_module("assimp"))
    skip();
  for (int k = 0; k < 4; k++)
    for (int n = 0; n < 2; n++) {
      int64_t least = kinds[k].least, most = kinds[k].most;
      const int64_t numbers[12] = {least, 0, 1, most, 100, 3, 17, most, most / 2, 5, least, most};
      bytes b = quantized(kinds[k].kind, n, numbers, "");
      vxm_soup *soup = read_data(b.data, b.size, "a.glb");
      expect_counts(soup, 4, 4);
      expect_no_warnings(soup);
      for (size_t i = 0; i < 12; i++) {
        double whole = (double)numbers[i], wanted = n ? fmax(whole / (double)most, -1) : whole;
        assert_true(soup->positions[i] == (double)(float)wanted);
      }
      vxm_soup_destroy(soup);
      bytes_free(&b);
    }
}

/** The transforms of nodes bring the numbers to size; bones, which may do it too, are told of. */
static void test_quantized_scale(void **state) {
  (void)state;
  static const double bounds[6] = {1, 0, 0, 2, 1, 1};
  static const int64_t numbers[12] = {0, 0, 0, 100, 0, 0, 0, 100, 0, 0, 0, 100};
  if (!has_module("assimp"))
    skip();
  bytes b = quantized(5122, false, numbers, ",\"scale\":[0.01,0.01,0.01],\"translation\":[1,0,0]");
  vxm_soup *soup = read_data(b.data, b.size, "a.glb");
  expect_body(soup, bounds, 1.0 / 6, 1e-6);
  vxm_soup_destroy(soup);
  bytes_free(&b);
  b = quantized(5122, false, numbers, ",\"skin\":0");
  soup = read_data(b.data, b.size, "a.glb");
  expect_warning(soup, "meshes with bones have positions in whole numbers");
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

/** Changes a text of a file in place; both have the same length. */
static void replace(bytes *b, const char *from, const char *to) {
  unsigned char *at = memmem(b->data, b->size, from, strlen(from));
  assert_non_null(at);
  assert_int_equal(strlen(from), strlen(to));
  memcpy(at, to, strlen(to));
}

/** Accessors that reach beyond what is there, or cannot be read for another reason. */
static void test_quantized_damage(void **state) {
  (void)state;
  static const int64_t numbers[12] = {0, 0, 0, 100, 0, 0, 0, 100, 0, 0, 0, 100};
  static const struct {
    const char *from, *to, *told;
  } cases[] = {
      {"\"byteLength\":32", "\"byteLength\":29", "it reaches beyond its buffer"},
      {"\"byteLength\":32", "\"byteLength\":99", "its buffer is not there, or cut off"},
      {"\"buffer\":0", "\"buffer\":7", "its buffer is not there, or cut off"},
      {"\"count\":4", "\"count\":5", "it reaches beyond its buffer"},
      {"\"count\":4", "\"cound\":4", NULL},
      {"\"byteStride\":8", "\"byteStride\":9", "it reaches beyond its buffer"},
      {"5122", "5125", "its numbers have neither 8 nor 16 bits"},
      {"\"VEC3\"", "\"VEC9\"", "it is damaged"},
      {"\"normalized\":false", "\"sparse\":{\"a\":333}", "it is sparse"},
      {"\"bufferView\":0", "\"bufferView\":9", "its buffer is not there, or cut off"},
      {"\"bufferView\":0", "\"bufferVieW\":0", "it is damaged"},
      {"{\"asset\"", "[\"asset\"", "its JSON is damaged: line 1"},
      {"BIN", "BIX", NULL},
  };
  if (!has_module("assimp"))
    skip();
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    bytes b = quantized(5122, false, numbers, "");
    replace(&b, cases[i].from, cases[i].to);
    if (cases[i].told)
      read_fails(b.data, b.size, "a.glb", VXM_ERROR_FORMAT, cases[i].told);
    else
      survives(&b, "a.glb");
    bytes_free(&b);
  }
  bytes whole = quantized(5122, true, numbers, "");
  damage_many(&whole, "a.glb", 80 / SLOWER);
  char told[64];
  snprintf(told, sizeof told, "a.glb: the file is cut off: 500 of %zu bytes are there", whole.size);
  read_fails(whole.data, 500, "a.glb", VXM_ERROR_FORMAT, told);
  bytes_free(&whole);
}

/** Some accessors may lie over the same bytes, but not any number of them. */
static void test_quantized_sharing(void **state) {
  (void)state;
  static const int counts[] = {20, 200}; /* of 24 bytes each, over a buffer of 72 */
  if (!has_module("assimp"))
    skip();
  for (int k = 0; k < 2; k++) {
    bytes b = {0};
    bytes_text(&b, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{"
                   "\"mesh\":0}],\"meshes\":[{\"primitives\":[");
    for (int n = 0; n < counts[k]; n++)
      bytes_text(&b, "%s{\"attributes\":{\"POSITION\":%d},\"indices\":%d}", n > 0 ? "," : "", n, counts[k]);
    bytes_text(&b, "]}],\"accessors\":[");
    for (int n = 0; n < counts[k]; n++)
      bytes_text(&b, "{\"bufferView\":0,\"componentType\":5123,\"count\":4,\"type\":\"VEC3\"},");
    bytes_text(&b, "{\"bufferView\":1,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],"
                   "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"
                   "\"byteLength\":24}],\"buffers\":[{\"byteLength\":72,"
                   "\"uri\":\"data:application/octet-stream;base64," WEDGE "\"}]}");
    if (k == 0) {
      vxm_soup *soup = read_data(b.data, b.size, "a.gltf");
      expect_counts(soup, 4 * 20, 4 * 20);
      vxm_soup_destroy(soup);
    } else
      read_fails(b.data, b.size, "a.gltf", VXM_ERROR_FORMAT, "too many others lie over the same bytes");
    bytes_free(&b);
  }
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
  if (!has_module("assimp"))
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

/* ---- Other formats ---- */

/** Adds a file that is not packed to an archive (PKWARE's application note, 4.3). Where it is `wide` all
 * numbers in the directory have 64 bits (4.5.3). */
static void zip_add(bytes *archive, bytes *directory, bool wide, const char *name, const char *text) {
  uint32_t crc = UINT32_MAX, size = (uint32_t)strlen(text), length = (uint32_t)strlen(name);
  for (uint32_t i = 0; i < size; i++) {
    crc ^= (unsigned char)text[i];
    for (int k = 0; k < 8; k++)
      crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  const uint16_t how[] = {20, 0, 0, 0, 0}; /* version, flags, method, time, date */
  const uint32_t sizes[] = {~crc, size, size};
  const uint16_t names[] = {(uint16_t)length, 0};
  const uint16_t wide_names[] = {(uint16_t)length, 8 + 4 + 28};
  const uint16_t rest[] = {0, 0, 0};
  const uint32_t where[] = {0, wide ? UINT32_MAX : (uint32_t)archive->size};
  const uint32_t ones[] = {~crc, UINT32_MAX, UINT32_MAX};
  const uint16_t extra[] = {0x7777, 4, 1, 1, 1, 28}; /* another extra field, then that of 64 bits */
  const uint64_t numbers[] = {size, size, archive->size};
  bytes_add(directory, "PK\1\2\x14\0", 6);
  bytes_add(directory, how, sizeof how);
  bytes_add(directory, wide ? ones : sizes, sizeof sizes);
  bytes_add(directory, wide ? wide_names : names, sizeof names);
  bytes_add(directory, rest, sizeof rest);
  bytes_add(directory, where, sizeof where);
  bytes_add(directory, name, length);
  if (wide) {
    bytes_add(directory, extra, sizeof extra);
    bytes_add(directory, numbers, sizeof numbers);
    bytes_add(directory, "\0\0\0", 4);
  }
  bytes_add(archive, "PK\3\4", 4);
  bytes_add(archive, how, sizeof how);
  bytes_add(archive, sizes, sizeof sizes);
  bytes_add(archive, names, sizeof names);
  bytes_add(archive, name, length);
  bytes_add(archive, text, size);
}

/** A wedge, and a pair of it; placed twice. */
static const char three_mf_model[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model unit=\"millimeter\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" "
    "type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" "
    "z=\"0\"/><vertex "
    "x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles><triangle v1=\"0\" "
    "v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"1\" v2=\"2\" "
    "v3=\"3\"/><triangle "
    "v1=\"2\" v2=\"0\" v3=\"3\"/></triangles></mesh></object><object id=\"2\" type=\"model\"><components>"
    "<component objectid=\"1\"/><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 5 0 "
    "0\"/></components>"
    "</object></resources><build><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 10 0\"/>"
    "<item objectid=\"1\"/></build></model>";

/** The end of an archive, which tells of the directory. */
static void zip_end(bytes *archive, const bytes *directory, bool wide, int count) {
  const uint64_t end = archive->size + directory->size;
  const uint16_t versions[] = {45, 45}, counts[] = {0, 0, (uint16_t)count, (uint16_t)count};
  const uint64_t head[] = {44},
                 numbers[] = {(uint64_t)count, (uint64_t)count, directory->size, archive->size};
  const uint32_t place[] = {(uint32_t)directory->size, wide ? UINT32_MAX : (uint32_t)archive->size};
  bytes_add(archive, directory->data, directory->size);
  if (wide) {
    bytes_add(archive, "PK\6\6", 4);
    bytes_add(archive, head, sizeof head);
    bytes_add(archive, versions, sizeof versions);
    bytes_add(archive, "\0\0\0\0\0\0\0", 8);
    bytes_add(archive, numbers, sizeof numbers);
    bytes_add(archive, "PK\6\7\0\0\0", 8);
    bytes_add(archive, &end, sizeof end);
    bytes_add(archive, "\1\0\0", 4);
  }
  bytes_add(archive, "PK\5\6", 4);
  bytes_add(archive, counts, sizeof counts);
  bytes_add(archive, place, sizeof place);
  bytes_add(archive, "\0", 2);
}

/** An archive of a model, and of another file that it may name. */
static bytes three_mf_of(bool wide, const char *model, const char *other) {
  static const char types[] =
      "<?xml version=\"1.0\"?><Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
      "<Default Extension=\"model\" "
      "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>";
  static const char relations[] =
      "<?xml version=\"1.0\"?><Relationships "
      "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
      "Target=\"/3D/3dmodel.model\" Id=\"r\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  bytes archive = {0}, directory = {0};
  zip_add(&archive, &directory, wide, "[Content_Types].xml", types);
  zip_add(&archive, &directory, wide, "_rels/.rels", relations);
  zip_add(&archive, &directory, wide, "3D/3dmodel.model", model);
  if (other)
    zip_add(&archive, &directory, wide, "3D/Objects/object_1.model", other);
  zip_end(&archive, &directory, wide, other ? 4 : 3);
  bytes_free(&directory);
  return archive;
}

static bytes three_mf(void) {
  return three_mf_of(false, three_mf_model, NULL);
}

static void test_3mf(void **state) {
  (void)state;
  static const double bounds[6] = {0, 0, 0, 6, 11, 1};
  if (!has_module("assimp"))
    skip();
  bytes b = three_mf();
  static const char *const names[] = {"a.3mf", "a.zip"};
  for (int n = 0; n < 2; n++) {
    vxm_soup *soup = read_data(b.data, b.size, names[n]);
    assert_string_equal(soup->format, "3mf");
    expect_counts(soup, 12, 12);
    expect_body(soup, bounds, 0.5, 1e-6);
    assert_int_equal(soup->tag_count, 3);
    vxm_soup_destroy(soup);
  }
  bytes_free(&b);
  read_fails("PK\3\4rubbish", 11, "a.zip", VXM_ERROR_FORMAT, "is a zip archive: unpack it first");
}

/** Extensions of 3MF. `head` are attributes of the model, `item` is one of an item. */
static bytes three_mf_with(bool wide, const char *head, const char *item, const char *other) {
  char model[2000];
  const char *before = strstr(three_mf_model, "xmlns="),
             *last = strstr(three_mf_model, "<item objectid=\"1\"");
  snprintf(model, sizeof model, "%.*s%s %.*s<item %s%s", (int)(before - three_mf_model), three_mf_model, head,
           (int)(last - before), before, item, last + strlen("<item"));
  return three_mf_of(wide, model, other);
}

#define PRODUCTION "xmlns:p='http://schemas.microsoft.com/3dmanufacturing/production/2015/06'"
#define BEAMS "xmlns:b = \"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\""
#define MATERIAL "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\""

static void test_3mf_extensions(void **state) {
  (void)state;
  static const struct {
    const char *head, *item, *told;
  } cases[] = {
      {PRODUCTION " requiredextensions=\"p\"", "p:UUID=\"3\"", NULL},
      {PRODUCTION " requiredextensions=\"p\"", "p:path=\"/3D/Objects/object_1.model\"",
       "a.3mf: its objects lie in files of their own within it (the 3MF production extension"},
      {PRODUCTION, "p:UUID='3' p:path = '/3D/Objects/object_1.model'", "the 3MF production extension"},
      {PRODUCTION, "", NULL},
      {PRODUCTION, "q:path=\"/a\"", NULL},
      {MATERIAL " requiredextensions=\"m\"", "", NULL},
      {BEAMS, "", NULL},
      {BEAMS " " MATERIAL " requiredextensions=\"m b\"", "",
       "a.3mf: it needs the 3MF extension http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02, "
       "which "
       "is not read: export it without, or as .stl or .obj"},
      {BEAMS " requiredextensions=\"bb\"", "", NULL},
  };
  if (!has_module("assimp"))
    skip();
  const size_t count = sizeof cases / sizeof *cases;
  for (size_t n = 0; n < 2 * count; n++) { /* lib3mf writes numbers of 64 bits whatever the size */
    size_t i = n % count;
    bytes b = three_mf_with(n >= count, cases[i].head, cases[i].item, three_mf_model);
    if (cases[i].told)
      read_fails(b.data, b.size, "a.3mf", VXM_ERROR_FORMAT, cases[i].told);
    else {
      vxm_soup *soup = read_data(b.data, b.size, "a.3mf");
      expect_counts(soup, 12, 12);
      vxm_soup_destroy(soup);
    }
    damage_many(&b, "a.3mf", 4);
    bytes_free(&b);
  }
}

/** Many entries of the same bytes could make work for hours of a small archive. */
static void test_3mf_overlap(void **state) {
  (void)state;
  if (!has_module("assimp"))
    skip();
  bytes archive = {0}, directory = {0};
  char model[1000];
  snprintf(model, sizeof model, "<model %s>%800s</model>", PRODUCTION, "");
  zip_add(&archive, &directory, false, "3D/3dmodel.model", model);
  bytes entry = {0};
  bytes_add(&entry, directory.data, directory.size);
  for (int n = 1; n < 4; n++)
    bytes_add(&directory, entry.data, entry.size);
  zip_end(&archive, &directory, false, 4);
  read_fails(archive.data, archive.size, "a.3mf", VXM_ERROR_FORMAT, "the 3MF production extension");
  bytes_free(&entry);
  bytes_free(&directory);
  bytes_free(&archive);
}

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
  if (!has_module("assimp"))
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
  if (!has_module("assimp"))
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

/* ---- Options, damage ---- */

static void test_options(void **state) {
  (void)state;
  if (!has_module("assimp"))
    skip();
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  const unsigned char *data = (const unsigned char *)collada;
  /* The named format decides against content and name. */
  options.format = "Collada";
  assert_int_equal(vxm_meshio_read_with(&soup, NULL, data, strlen(collada), "a.obj", &options, &error),
                   VXM_OK);
  vxm_soup_destroy(soup);
  options.format = "fbx";
  assert_int_equal(vxm_meshio_read_with(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_FORMAT);
  options.format = "off";
  assert_int_equal(vxm_meshio_read_with(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_FORMAT);
  assert_null(strstr(error.text, "Assimp"));
  options.format = "word";
  assert_int_equal(vxm_meshio_read_with(&soup, NULL, data, strlen(collada), "a.dae", &options, &error),
                   VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "mesh format \"word\" is not known"));
  bytes b = gltf("{\"mesh\":0}", TRIANGLES);
  options.format = "gltf";
  assert_int_equal(vxm_meshio_read_with(&soup, NULL, b.data, b.size, "a", &options, &error), VXM_OK);
  expect_counts(soup, 4, 4);
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

static void test_damage(void **state) {
  (void)state;
  enum { TIMES = 40 / SLOWER };
  if (!has_module("assimp"))
    skip();
  bytes glb = scene_bytes(scene_write_glb), zip = three_mf(), text = gltf("{\"mesh\":0}", TRIANGLES),
        dae = {0};
  bytes_text(&dae, "%s", COLLADA_HEAD);
  bytes_text(&dae, "%s%s%s", COLLADA_SOURCE, COLLADA_FACES, COLLADA_SCENE);
  damage_many(&glb, "a.glb", TIMES);
  damage_many(&zip, "a.3mf", TIMES);
  damage_many(&text, "a.gltf", TIMES);
  damage_many(&dae, "a.dae", TIMES);
  bytes_free(&glb);
  bytes_free(&zip);
  bytes_free(&text);
  bytes_free(&dae);
  text_fails("{\"asset\":{\"version\":\"2.0\"}", "a.gltf",
             "a.gltf: Assimp cannot read it: it is likely cut off or damaged, or no .gltf file");
  text_fails("glTF\2", "a.dat", "a.dat: the file is cut off: 5 of 20 bytes are there");
  text_fails("what is this", "a.fbx", "a.fbx: Assimp cannot read it: ");
  text_fails("what is this", "a.lws", "a.lws: this kind of scene imports other files, and is not read");
  text_fails("what is this", "a.IRR", "a.IRR: this kind of scene imports other files, and is not read");
  text_fails("what is this", "a.smd", "a.smd: this kind of file is not read: export it as .glb or .obj");
  text_fails("what is this", "a.xyz", "not a known mesh format");
}

static void test_in_process(void **state) {
  (void)state;
  if (!has_module("assimp"))
    skip();
  bytes glb = scene_bytes(scene_write_glb), zip = three_mf(), dae = {0};
  bytes_text(&dae, "%s", COLLADA_HEAD);
  bytes_text(&dae, "%s%s%s", COLLADA_SOURCE, COLLADA_FACES, COLLADA_SCENE);
  vxm_soup_destroy(read_in_process("assimp", "glb", &glb));
  vxm_soup_destroy(read_in_process("assimp", "3mf", &zip));
  vxm_soup_destroy(read_in_process("assimp", "dae", &dae));
  bytes_free(&glb);
  bytes_free(&zip);
  bytes_free(&dae);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_transforms),       cmocka_unit_test(test_names),
      cmocka_unit_test(test_lines_and_points), cmocka_unit_test(test_stool),
      cmocka_unit_test(test_quantized),        cmocka_unit_test(test_quantized_scale),
      cmocka_unit_test(test_quantized_damage), cmocka_unit_test(test_quantized_sharing),
      cmocka_unit_test(test_required),         cmocka_unit_test(test_3mf),
      cmocka_unit_test(test_3mf_extensions),   cmocka_unit_test(test_3mf_overlap),
      cmocka_unit_test(test_collada),          cmocka_unit_test(test_options),
      cmocka_unit_test(test_small_formats),    cmocka_unit_test(test_damage),
      cmocka_unit_test(test_in_process)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
