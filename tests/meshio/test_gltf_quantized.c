/* SPDX-License-Identifier: BSD-3-Clause */
/** glTF with positions in whole numbers (KHR_mesh_quantization), which Assimp does not read by itself. */
#include "gltf_test.h"

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
  if (!vxm_module_exists("assimp"))
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
  if (!vxm_module_exists("assimp"))
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
  if (!vxm_module_exists("assimp"))
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
  if (!vxm_module_exists("assimp"))
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

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_quantized), cmocka_unit_test(test_quantized_scale),
                                     cmocka_unit_test(test_quantized_damage),
                                     cmocka_unit_test(test_quantized_sharing)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
