/* SPDX-License-Identifier: BSD-3-Clause */
/** Every shared mesh against the counts of its manifest; skipped where the meshes are not at hand. */
#include "meshio_test.h"

static char meshes[512];

/** The columns of the manifest that are compared. */
enum { FILE_NAME, FORMAT, VERTICES, FACES, POLYGONS, COLUMNS };
static const char *const titles[COLUMNS] = {"file", "format", "n_vertices", "n_faces",
                                            "n_faces_over_3_corners"};

/**
 * Where we read a damaged file differently from the program that made the manifest, which kept faces with
 * wrong indices, had no strips and gave some files up.
 */
static const struct {
  const char *file;
  long vertices, faces, polygons;
  const char *reason;
} differences[] = {
    {"malformed/assimp-malformed.obj", 8, 4, 4, "two faces with indices 0 and 12 of 8 are skipped"},
    {"malformed/openscad-toomanyvertices.stl", 40, 13, 1, "the facet of 4 vertices is kept as a polygon"},
    {"malformed/threejs-dolphins_be.ply", 855, 148, 0, "what is left of the ruined file is read"},
    {"malformed/tinyobj-invalid-relative-vertex-index.obj", 0, 0, 0,
     "the face without any vertex is skipped"},
    {"malformed/tinyobj-issue-140-zero-face-idx.obj", 4, 1, 0, "the face with index 0 is skipped"},
    {"malformed/tinyply-elephant.ply", 19753, 39290, 0, "the strips are taken apart"},
    {"malformed/trimesh-fuze_ascii.ply", 502, 1000, 0, "read line by line, with a warning"},
    {"malformed/trimesh-notenoughindices.obj", 3, 1, 0, "the face of 2 corners is skipped"},
};

typedef struct row {
  char *field[COLUMNS];
} row;

/** Cuts a line at its tabs; fields that are not there are "". */
static void split(char *line, char **fields, size_t count) {
  static char none[] = "";
  for (size_t i = 0; i < count; i++) {
    fields[i] = line ? line : none;
    line = line ? strchr(line, '\t') : NULL;
    if (line)
      *line++ = '\0';
  }
}

static vxm_soup *read_file(const char *file, vxm_error *error) {
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", meshes, file);
  vxm_context *context;
  vxm_input input;
  assert_int_equal(vxm_context_create(&context, NULL, error), VXM_OK);
  if (vxm_input_open(&input, context, path, error) != VXM_OK)
    fail_msg("%s", error->text);
  vxm_soup *soup;
  if (vxm_meshio_read(&soup, context, input.data, input.size, path, NULL, error) != VXM_OK)
    soup = NULL;
  else
    check_invariants(soup);
  vxm_input_close(&input);
  vxm_context_destroy(context);
  return soup;
}

static void expect_row(const row *r) {
  const char *file = r->field[FILE_NAME];
  bool damaged = strncmp(file, "malformed/", 10) == 0, refused = strcmp(r->field[VERTICES], "-") == 0;
  long vertices = strtol(r->field[VERTICES], NULL, 10), faces = strtol(r->field[FACES], NULL, 10),
       polygons = strtol(r->field[POLYGONS], NULL, 10);
  for (size_t d = 0; d < sizeof differences / sizeof *differences; d++)
    if (strcmp(file, differences[d].file) == 0) {
      vertices = differences[d].vertices;
      faces = differences[d].faces;
      polygons = differences[d].polygons;
      refused = false;
    }
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup = read_file(file, &error);
  if (refused) {
    if (soup)
      fail_msg("%s is read, not refused", file);
    assert_int_equal(error.code, VXM_ERROR_FORMAT);
    assert_true(strlen(error.text) > 0);
    assert_null(strchr(error.text, '\n'));
    return;
  }
  if (!soup)
    fail_msg("%s", error.text);
  long over = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    over += soup->offsets[f + 1] - soup->offsets[f] > 3;
  if ((long)soup->vertex_count != vertices || (long)soup->face_count != faces || over != polygons)
    fail_msg("%s: %zu vertices, %zu faces, %ld polygons; expected %ld, %ld, %ld", file, soup->vertex_count,
             soup->face_count, over, vertices, faces, polygons);
  if (!damaged) {
    assert_string_equal(soup->format, r->field[FORMAT]);
    if (soup->warnings.count)
      fail_msg("%s: %s", file, soup->warnings.text[0]);
  }
  vxm_soup_destroy(soup);
}

static void test_files(void **state) {
  (void)state;
  const char *source = getenv("SRCDIR");
  snprintf(meshes, sizeof meshes, "%s/../shared/meshes", source ? source : ".");
  char path[600], line[8192];
  snprintf(path, sizeof path, "%s/MANIFEST.tsv", meshes);
  FILE *manifest = fopen(path, "r");
  if (!manifest)
    skip();
  char *fields[64];
  int column[COLUMNS];
  assert_non_null(fgets(line, sizeof line, manifest));
  line[strcspn(line, "\r\n")] = '\0';
  split(line, fields, 64);
  for (int c = 0; c < COLUMNS; c++) {
    column[c] = -1;
    for (int f = 0; f < 64; f++)
      if (strcmp(fields[f], titles[c]) == 0)
        column[c] = f;
    assert_true(column[c] >= 0);
  }
  int rows = 0;
  while (fgets(line, sizeof line, manifest)) {
    line[strcspn(line, "\r\n")] = '\0';
    split(line, fields, 64);
    row r;
    for (int c = 0; c < COLUMNS; c++)
      r.field[c] = fields[column[c]];
    expect_row(&r);
    rows++;
  }
  fclose(manifest);
  assert_true(rows > 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_files)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
