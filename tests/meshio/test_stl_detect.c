/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A binary STL is told whatever its header and its count say, and nothing else is taken for one, though its
 * size be that of an STL.
 */
#include "meshio/formats/stl.h"
#include "meshio_test.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

typedef struct head {
  const char *text;
  size_t size; /**< 0 = up to the terminator */
  char fill;
} head;

/** What the 80 bytes begin with, and what fills the rest. */
static const head heads[] = {
    {"", 0, ' '},
    {"", 0, '\0'},
    {"", 0, '\n'},
    {"", 0, '\xff'},
    {"", 0, '0'},
    {"", 0, '#'},
    {"solid", 0, ' '},
    {"solid", 0, '\0'},
    {"SOLID part", 0, ' '},
    {"solid x\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n", 0, ' '},
    {"facet normal 0 0 1", 0, ' '},
    {"exported by solid works", 0, '\0'},
    {"COLOR=\xff\x80\x40\xff,MATERIAL=", 0, '\0'},
    {"\xc3\xa4\xc3\xb6\xc3\xbc \xe6\xa8\xa1\xe5\x9e\x8b", 0, ' '},
    {"\xef\xbb\xbf", 0, ' '},
    {"\xef\xbb\xbfsolid", 0, ' '},
    {"\xef\xbb\xbfOFF\n8 12 0\n", 0, ' '},
    {"\xff\xfe", 0, ' '},
    {"\xfe\xff", 0, ' '},
    {"\xff\xfes\0o\0l\0i\0d\0 \0x\0\n\0f\0a\0c\0e\0t\0 \0n\0o\0r\0m\0a\0l\0 \0"
     "0\0 \0"
     "0\0 \0"
     "1\0\n\0",
     54, '\n'},
    {"\xfe\xff\0O\0F\0F\0\n\0"
     "8\0 \0"
     "1\0"
     "2\0 \0"
     "0",
     22, '\n'},
    {"8 12 0\n", 0, ' '},
    {"1", 0, ' '},
    {"3.14159 2.71828", 0, '\0'},
    {"OFF", 0, ' '},
    {"OFF\n8 12 0\n0 0 0\n", 0, ' '},
    {"OFF8 12 0\n", 0, ' '},
    {"OFF BINARY\n", 0, '\0'},
    {"COFF\n", 0, '\0'},
    {"STCN4nOFF\n", 0, '\n'},
    {"ply\n", 0, ' '},
    {"ply\nformat binary_little_endian 1.0\nelement vertex 8\n", 0, '\n'},
    {"ply\nformat ascii 1.0\ncomment", 0, ' '},
    {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 0, ' '},
    {"v 1 2 3", 0, '\0'},
    {"# made by hand\ng part\n", 0, ' '},
    {"mtllib a.mtl\n", 0, ' '},
    {"f 1 2 3", 0, ' '},
    {"g 1", 0, ' '},
    {"glTF\x02\0\0\0", 8, '\0'},
    {"{\"asset\":{\"version\":\"2.0\"}}", 0, ' '},
    {"PK\x03\x04 3D/3dmodel.model", 0, '\0'},
    {"\x1f\x8b\x08", 0, '\0'},
    {"\x93NUMPY\x01\0v\0{'descr': '<f4'}", 25, ' '},
    {"Kaydara FBX Binary  \0\x1a", 22, '\0'},
    {"; FBX 7.4.0 project file", 0, ' '},
    {"xof 0303txt 0032", 0, ' '},
    {"xof 0302bin 0064", 0, '\0'},
    {"ISO-10303-21;\nHEADER;\n", 0, ' '},
    {"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));", 0, ' '},
    {"                                                                        S      1", 0, ' '},
    {"FORM\0\0\0\0LWO2", 12, '\0'},
    {"AC3Db\n", 0, ' '},
    {"MM", 0, '\0'},
    {"BLENDER-v279", 0, '\0'},
    {"NRRD0004\ntype: uchar\n", 0, '\n'},
    {"#binvox 1\ndim 8 8 8\n", 0, '\n'},
    {"<?xml version=\"1.0\"?><COLLADA>", 0, ' '},
    {"<X3D>", 0, ' '},
    {"<amf unit=\"millimeter\">", 0, ' '},
    {"<!DOCTYPE html><html>", 0, ' '},
    {"version https://git-lfs.github.com/spec/v1\n", 0, ' '},
    {"#VRML V2.0 utf8\n", 0, ' '},
    {"MZ\x90", 0, '\0'},
    {"\x7f"
     "ELF",
     0, '\0'},
};

/* ---- A body of facets ---- */

enum { RINGS = 8, SLICES = 23, FACETS = 2 * RINGS * SLICES }; /* 368 */

static void on_ball(double p[3], int ring, int slice) {
  double a = 3.14159265358979 * ring / RINGS, b = 2 * 3.14159265358979 * slice / SLICES;
  p[0] = 17.25 * sin(a) * cos(b), p[1] = 17.25 * sin(a) * sin(b), p[2] = 17.25 * cos(a);
}

static void add_float(bytes *b, double value) {
  float single = (float)value;
  bytes_add(b, &single, 4);
}

typedef enum normals { NORMALS_ZERO, NORMALS_UNIT, NORMALS_WRONG, NORMALS } normals;

static void add_facet(bytes *b, double p[3][3], normals kind, uint16_t colour) {
  double n[3], length = 0;
  for (int c = 0; c < 3; c++) {
    int u = (c + 1) % 3, v = (c + 2) % 3;
    n[c] = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
    length += n[c] * n[c];
  }
  length = kind == NORMALS_UNIT && length > 0 ? sqrt(length) : 1;
  for (int c = 0; c < 3; c++)
    add_float(b, kind == NORMALS_ZERO ? 0 : n[c] / length);
  for (int c = 0; c < 9; c++)
    add_float(b, p[c / 3][c % 3]);
  bytes_add(b, &colour, 2);
}

static void add_ball(bytes *b, normals kind) {
  for (int r = 0; r < RINGS; r++)
    for (int s = 0; s < SLICES; s++) {
      double p[4][3];
      for (int k = 0; k < 4; k++)
        on_ball(p[k], r + k / 2, s + k % 2);
      double one[3][3], two[3][3];
      for (int c = 0; c < 3; c++) {
        one[0][c] = p[0][c], one[1][c] = p[2][c], one[2][c] = p[1][c];
        two[0][c] = p[1][c], two[1][c] = p[2][c], two[2][c] = p[3][c];
      }
      add_facet(b, one, kind, (uint16_t)(kind == NORMALS_UNIT ? 0x7fff - s : 0));
      add_facet(b, two, kind, 0);
    }
}

static void add_head(bytes *b, const head *h, uint32_t announced) {
  char text[80];
  size_t size = h->size ? h->size : strlen(h->text);
  memset(text, h->fill, sizeof text);
  memcpy(text, h->text, size < 80 ? size : 80);
  bytes_add(b, text, sizeof text);
  bytes_add(b, &announced, 4);
}

/* ---- Every header ---- */

static void expect_stl(const bytes *b, const char *name, size_t facets, const head *h) {
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  if (read_bytes(&soup, b->data, b->size, name, &error) != VXM_OK)
    fail_msg("%s with the header \"%.20s\" is refused: %s", name, h->text, error.text);
  if (strcmp(soup->format, "stl binary") != 0 || soup->face_count != facets)
    fail_msg("%s with the header \"%.20s\" is read as %s with %zu faces", name, h->text, soup->format,
             soup->face_count);
  vxm_soup_destroy(soup);
}

static const char *const names[] = {"a.stl", "a.STL",  "a.off", "a.obj", "a.ply",
                                    "a.glb", "a.step", "a.dat", "a",     "-"};

static void test_heads(void **state) {
  (void)state;
  static const uint32_t counts[] = {FACETS, 0, FACETS - 1, FACETS + 1, 1, 1000000, 0x0a0a0a0a, UINT32_MAX};
  for (size_t h = 0; h < COUNT(heads); h++)
    for (size_t c = 0; c < COUNT(counts); c++)
      for (normals kind = 0; kind < NORMALS; kind++) {
        bytes b = {0};
        add_head(&b, &heads[h], counts[c]);
        add_ball(&b, kind);
        assert_int_equal(b.size, 84 + 50 * FACETS);
        for (size_t n = 0; n < 3; n++) /* each with some of the names */
          expect_stl(&b, names[(h + 3 * c + 7 * kind + n) % COUNT(names)], FACETS, &heads[h]);
        bytes_free(&b);
      }
}

/** With bytes behind the last facet, and cut off within one. */
static void test_other_sizes(void **state) {
  (void)state;
  for (size_t h = 0; h < COUNT(heads); h++)
    for (normals kind = 0; kind < NORMALS; kind++) {
      bytes b = {0};
      add_head(&b, &heads[h], FACETS);
      add_ball(&b, kind);
      bytes cut = {b.data, b.size - 60, 0};
      expect_stl(&cut, "a.dat", FACETS - 2, &heads[h]);
      for (int more = 0; more < 3; more++) {
        bytes_add(&b, "tail of it\n\0\0\0\0\0", 16);
        expect_stl(&b, "a.dat", FACETS, &heads[h]);
      }
      bytes_free(&b);
    }
}

/** Facets that say nothing themselves: blank ones, and such as are not numbers. The count proves them. */
static void test_hollow_facets(void **state) {
  (void)state;
  static const char fills[] = {'\0', '\xff', ' ', '0'};
  for (size_t h = 0; h < COUNT(heads); h++)
    for (size_t f = 0; f < COUNT(fills); f++)
      for (uint32_t facets = 1; facets < 300; facets += 13) {
        bytes b = {0};
        char facet[50];
        if (strncmp(heads[h].text, "OFF BINARY", 10) == 0 && fills[f] != '\0')
          continue; /* the one case where the count alone is not enough */
        add_head(&b, &heads[h], facets);
        memset(facet, fills[f], sizeof facet);
        for (uint32_t i = 0; i < facets; i++)
          bytes_add(&b, facet, sizeof facet);
        expect_stl(&b, "a.dat", facets, &heads[h]);
        bytes_free(&b);
      }
}

/* ---- The reverse ---- */

static void add_off(bytes *b) {
  bytes_text(b, "OFF\n3 1 0\n0.125 0 0\n1 0.25 0\n0 1 17.375\n3 0 1 2\n");
}

static void add_obj(bytes *b) {
  bytes_text(b, "v 0.125 0 0\nv 1 0.25 0\nv 0 1 17.375\nf 1 2 3\n");
}

static void add_ply(bytes *b) {
  bytes_text(b,
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n0.125 0 0\n1 0.25 0\n"
             "0 1 17.375\n3 0 1 2\n");
}

static void add_stl(bytes *b) {
  bytes_text(b,
             "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0.125 0 0\nvertex 1 0.25 0\nvertex 0 1 17.375\n"
             "endloop\nendfacet\nendsolid x\n");
}

/** Lines of numbers, as the files of large meshes are full of; `?` stands where floats near 1 have their
 * highest byte. */
static const char *const fillers[] = {"#\n",
                                      "# 0.123456 -17.25 3.5e-07\n",
                                      "# ????????????????????\n",
                                      " \n",
                                      "# \xe6\xa8\xa1\xe5\x9e\x8b \xc3\xa4\n",
                                      "\n",
                                      "\r\n",
                                      "\t"};

static void check_reverse(void (*add)(bytes *), const char *format, const char *filler, size_t facets,
                          int wide) {
  bytes b = {0}, c = {0};
  add(&b);
  size_t target = 84 + 50 * facets, length = strlen(filler);
  if (wide)
    target = target / 2 - 1;
  while (b.size + length <= target)
    bytes_add(&b, filler, length);
  while (b.size < target)
    bytes_add(&b, "\n", 1);
  if (wide) {
    bytes_add(&c, wide == 1 ? "\xff\xfe" : "\xfe\xff", 2);
    for (size_t i = 0; i < b.size; i++) {
      unsigned char pair[2] = {0, 0};
      pair[wide - 1] = b.data[i];
      bytes_add(&c, pair, 2);
    }
    bytes_free(&b);
    b = c;
  }
  assert_int_equal(b.size, 84 + 50 * facets);
  for (size_t n = 0; n < COUNT(names); n++) {
    vxm_soup *soup = read_data(b.data, b.size, names[n]);
    assert_string_equal(soup->format, format);
    expect_counts(soup, 3, 1);
    expect_vertex(soup, 2, 0.0, 1.0, 17.375);
    vxm_soup_destroy(soup);
  }
  bytes_free(&b);
}

static void test_texts(void **state) {
  (void)state;
  static const struct {
    void (*add)(bytes *);
    const char *format;
  } forms[] = {{add_off, "off"}, {add_obj, "obj"}, {add_ply, "ply ascii"}, {add_stl, "stl ascii"}};
  for (size_t f = 0; f < COUNT(forms); f++)
    for (size_t k = 0; k < COUNT(fillers); k++)
      for (size_t facets = 6; facets < 600; facets += facets < 30 ? 1 : 97) {
        check_reverse(forms[f].add, forms[f].format, fillers[k], facets, 0);
        if ((unsigned char)fillers[k][2 % strlen(fillers[k])] < 0x80)
          for (int wide = 1; wide <= 2; wide++)
            check_reverse(forms[f].add, forms[f].format, fillers[k], facets + 6, wide);
      }
}

/** Lets a file grow to each size up to a few facets, and asks of each that is an STL's. */
static void never_stl(bytes *b, const char *what, vxm_rng *rng, size_t unit) {
  while ((b->size < 84 || (b->size - 84) % 50 != 0) && b->size < 20000) {
    uint64_t value = vxm_rng_next(rng);
    bytes_add(b, &value, unit);
  }
  if (b->size >= 20000)
    return;
  if (vxm_stl_is_binary(b->data, b->size))
    fail_msg("%s of %zu bytes is taken for STL", what, b->size);
}

static void add_big(bytes *b, uint32_t word) {
  unsigned char big[4] = {(unsigned char)(word >> 24), (unsigned char)(word >> 16),
                          (unsigned char)(word >> 8), (unsigned char)word};
  bytes_add(b, big, 4);
}

/** Binary files of other formats: floats and indices, of either byte order and at any place, and packed data.
 */
static void test_binaries(void **state) {
  (void)state;
  static const char *const magics[] = {"ply\nformat binary_little_endian 1.0\n",
                                       "OFF BINARY\n",
                                       "glTF\x02",
                                       "PK\x03\x04",
                                       "Kaydara FBX Binary  ",
                                       "MM",
                                       "BLENDER-v279",
                                       "xof 0302bin 0064",
                                       "FORM",
                                       ""};
  vxm_rng rng = {11};
  for (size_t m = 0; m < COUNT(magics); m++)
    for (int round = 0; round < 300; round++) {
      bytes b = {0};
      bytes_text(&b, "%s", magics[m]);
      for (size_t i = vxm_rng_below(&rng, 200); i > 0; i--) /* a header of some length */
        bytes_text(&b, "%c", "{\"a\":0, }\n"[vxm_rng_below(&rng, 10)]);
      int kind = round % 4;
      size_t words = 30 + (size_t)vxm_rng_below(&rng, 2000);
      for (size_t i = 0; i < words; i++) {
        float single = (float)(vxm_rng_unit(&rng) * 20 - 10);
        uint32_t index = (uint32_t)vxm_rng_below(&rng, 3000), word;
        memcpy(&word, &single, 4);
        if (kind == 0) /* vertices, then faces */
          bytes_add(&b, i < words / 2 ? (void *)&single : (void *)&index, 4);
        else if (kind == 1)
          add_big(&b, i < words / 2 ? word : index);
        else if (kind == 2) /* coordinates on a lattice, big-endian: their bytes are few */
          add_big(&b, i % 2 ? UINT32_C(0x3f800000) : UINT32_C(0x40000000) + (uint32_t)(i % 7) * 0x200000);
        else { /* packed */
          uint64_t noise = vxm_rng_next(&rng);
          bytes_add(&b, &noise, 4);
        }
      }
      if (kind == 0 || kind == 1)
        for (int i = 0; i < 50; i++) /* so many indices more, to an STL's size */
          if (b.size < 84 || (b.size - 84) % 50 != 0)
            kind == 0 ? bytes_add(&b, "\x05\0\0\0", 4) : add_big(&b, 5);
      never_stl(&b, magics[m], &rng, 1);
      bytes_free(&b);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_heads), cmocka_unit_test(test_other_sizes),
                                     cmocka_unit_test(test_hollow_facets), cmocka_unit_test(test_texts),
                                     cmocka_unit_test(test_binaries)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
