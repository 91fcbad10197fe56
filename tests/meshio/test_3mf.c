/* SPDX-License-Identifier: BSD-3-Clause */
/** 3MF through Assimp: archives of both kinds, extensions, and damage. */
#include "external_test.h"

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
  if (!vxm_module_exists("assimp"))
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

/** Coordinates are in millimetres, whatever the unit: as of STEP. What is placed is, too. */
static void test_3mf_units(void **state) {
  (void)state;
  static const struct {
    const char *unit;
    double size;
  } cases[] = {{"unit=\"micron\"", 0.001}, {"unit = 'millimeter'", 1}, {"unit=\"centimeter\"", 10},
               {"unit=\"inch\"", 25.4},    {"unit=\"foot\"", 304.8},   {"unit=\"meter\"", 1000},
               {"unit=\"parsec\"", 1},     {"xml:unit=\"inch\"", 1},   {"", 1}};
  if (!vxm_module_exists("assimp"))
    skip();
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    char model[2000];
    const char *before = strstr(three_mf_model, "unit="), *after = strstr(three_mf_model, "xmlns=");
    snprintf(model, sizeof model, "%.*s%s %s", (int)(before - three_mf_model), three_mf_model, cases[c].unit,
             after);
    bytes b = three_mf_of(c % 2 == 1, model, NULL);
    vxm_soup *soup = read_data(b.data, b.size, "a.3mf");
    const double size = cases[c].size, bounds[6] = {0, 0, 0, 6 * size, 11 * size, size};
    expect_body(soup, bounds, 0.5 * size * size * size, 1e-6 * size);
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
}

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
  if (!vxm_module_exists("assimp"))
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
  if (!vxm_module_exists("assimp"))
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

static void test_damage(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  bytes b = three_mf();
  damage_many(&b, "a.3mf", 40 / SLOWER);
  bytes_free(&b);
}

static void test_in_process(void **state) {
  (void)state;
  if (!vxm_module_exists("assimp"))
    skip();
  bytes b = three_mf();
  vxm_soup_destroy(read_in_process("assimp", "3mf", &b));
  bytes_free(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_3mf),
                                     cmocka_unit_test(test_3mf_units),
                                     cmocka_unit_test(test_3mf_extensions),
                                     cmocka_unit_test(test_3mf_overlap),
                                     cmocka_unit_test(test_damage),
                                     cmocka_unit_test(test_in_process)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
