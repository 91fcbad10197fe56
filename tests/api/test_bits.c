/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * No release changes a bit unknowingly: every sample model, as it is and turned in two ways, by every way to
 * voxelize, and repaired to every level that needs no module, has the hash that tests/api/bits.txt holds.
 *
 *   REFRESH=1 make check TESTS=tests/api/test_bits    writes that file anew: read the difference
 *   CPU=plain (or avx2)                               as on a processor with no more than that
 */
#include "api_support.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "voxmend/experimental.h"

enum { RESOLUTION = 28, ROOM = 64 * 1024 };

typedef struct way {
  const char *name;
  vxm_voxelize_options options;
} way;

/* Turned by whole fractions, so that no library of mathematics has a say. */
typedef struct pose {
  const char *name;
  double matrix[12];
} pose;

static const pose poses[] = {
    {"upright", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {"turned", {0.6, -0.8, 0, 0.03125, 0.8, 0.6, 0, -0.0625, 0, 0, 1, 0.015625}},
    {"sheared", {0.5625, 0.25, -0.125, 0, -0.1875, 0.625, 0.3125, 0, 0.25, -0.375, 0.6875, 0}},
};

/** What was found, as text. */
typedef struct account {
  char *text;
  size_t length;
} account;

static void add_line(account *out, const char *name, const char *how, const char *way_name, uint64_t hash) {
  char line[128];
  int length = snprintf(line, sizeof line, "%s %s %s %016" PRIx64 "\n", name, how, way_name, hash);
  assert_true(length > 0 && (size_t)length < sizeof line && out->length + (size_t)length < ROOM);
  memcpy(out->text + out->length, line, (size_t)length + 1);
  out->length += (size_t)length;
}

/** FNV-1a of the bytes of a number, the lowest first on any machine. */
static uint64_t hash_number(uint64_t hash, uint64_t number, int bytes) {
  for (int i = 0; i < bytes; i++)
    hash = (hash ^ (number >> 8 * i & 255)) * UINT64_C(0x100000001b3);
  return hash;
}

static uint64_t hash_mesh(const vxm_mesh *mesh) {
  int64_t coordinates = 3 * vxm_mesh_vertex_count(mesh), faces = vxm_mesh_face_count(mesh);
  const uint64_t *offsets = vxm_mesh_offsets(mesh);
  uint64_t hash = UINT64_C(0xcbf29ce484222325), bits;
  for (int64_t i = 0; i < coordinates; i++) {
    memcpy(&bits, vxm_mesh_vertices(mesh) + i, sizeof bits);
    hash = hash_number(hash, bits, 8);
  }
  for (int64_t f = 0; f <= faces; f++)
    hash = hash_number(hash, offsets[f], 8);
  for (uint64_t c = 0; c < offsets[faces]; c++)
    hash = hash_number(hash, vxm_mesh_indices(mesh)[c], 4);
  return hash;
}

static void add_repairs(account *out, const char *name, const vxm_mesh *raw) {
  static const char *const levels[] = {"clean", "manifold", "closed"};
  for (int level = VXM_LEVEL_CLEAN; level <= VXM_LEVEL_CLOSED; level++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = (vxm_level)level;
    vxm_mesh *mesh = NULL;
    assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, &options, NULL), VXM_OK);
    add_line(out, name, "repaired", levels[level], hash_mesh(mesh));
    vxm_mesh_destroy(mesh);
  }
}

static void add_voxels(account *out, const char *name, const vxm_mesh *mesh, const way *by) {
  vxm_space_options fitting = VXM_SPACE_OPTIONS_INIT;
  vxm_space space;
  vxm_model *made = NULL;
  vxm_grid *grid = NULL;
  fitting.resolution[0] = RESOLUTION;
  fitting.fit = VXM_FIT_SPHERE;
  fitting.pad = 4;
  assert_int_equal(vxm_space_fit(&space, mesh, &fitting, NULL), VXM_OK);
  assert_int_equal(vxm_model_create(&made, mesh, &by->options, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&grid, NULL, &space, NULL), VXM_OK);
  for (size_t p = 0; p < sizeof poses / sizeof poses[0]; p++) {
    assert_int_equal(vxm_model_voxelize(grid, NULL, made, poses[p].matrix, NULL), VXM_OK);
    add_line(out, name, poses[p].name, by->name, vxm_grid_hash(grid));
  }
  vxm_grid_destroy(grid);
  vxm_model_destroy(made);
}

static way make_way(const char *name, vxm_method method, vxm_mode mode, vxm_thin_parts thin) {
  way made = {name, VXM_VOXELIZE_OPTIONS_INIT};
  made.options.method = method;
  made.options.mode = mode;
  made.options.thin = thin;
  return made;
}

static void add_model(account *out, const char *name, const vxm_mesh *raw) {
  const way ways[] = {
      make_way("solid", VXM_METHOD_VOTE, VXM_MODE_SOLID, VXM_THIN_AUTO),
      make_way("centres", VXM_METHOD_VOTE, VXM_MODE_SOLID, VXM_THIN_DROP),
      make_way("tetra", VXM_METHOD_TETRA, VXM_MODE_SOLID, VXM_THIN_AUTO),
      make_way("winding", VXM_METHOD_WINDING, VXM_MODE_SOLID, VXM_THIN_AUTO),
      make_way("surface", VXM_METHOD_VOTE, VXM_MODE_SURFACE, VXM_THIN_AUTO),
      make_way("both", VXM_METHOD_VOTE, VXM_MODE_BOTH, VXM_THIN_KEEP26),
  };
  vxm_mesh *mesh = NULL;
  add_repairs(out, name, raw);
  assert_int_equal(vxm_mesh_prepare(&mesh, NULL, raw, NULL, NULL), VXM_OK);
  for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
    add_voxels(out, name, mesh, &ways[w]);
  vxm_mesh_destroy(mesh);
}

/** The whole of a file, with a 0 behind it. */
static char *read_text(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file)
    fail_msg("cannot open %s", path);
  char *text = calloc(ROOM + 1, 1);
  assert_non_null(text);
  assert_true(fread(text, 1, ROOM, file) < ROOM);
  fclose(file);
  return text;
}

static void write_text(const char *path, const account *text) {
  FILE *file = fopen(path, "wb");
  if (!file)
    fail_msg("cannot open %s", path);
  assert_int_equal(fwrite(text->text, 1, text->length, file), text->length);
  assert_int_equal(fclose(file), 0);
}

/** Tells the lines that differ, and how many they are. */
static void compare(const char *stored, const char *found) {
  int differences = 0;
  while (*stored || *found) {
    size_t a = strcspn(stored, "\n"), b = strcspn(found, "\n");
    if (a != b || memcmp(stored, found, a) != 0) {
      if (++differences <= 10)
        print_error("stored %.*s, found %.*s\n", (int)a, stored, (int)b, found);
    }
    stored += stored[a] ? a + 1 : a;
    found += found[b] ? b + 1 : b;
  }
  if (differences > 0)
    fail_msg("%d hashes are not those of tests/api/bits.txt", differences);
}

static void test_bits(void **state) {
  (void)state;
  const char *source = getenv("SRCDIR");
  char path[4096];
  assert_true(snprintf(path, sizeof path, "%s/tests/api/bits.txt", source ? source : ".") < (int)sizeof path);
  account found = {calloc(ROOM, 1), 0};
  assert_non_null(found.text);
  for (size_t i = 0; i < model_count; i++) {
    vxm_mesh *raw = mesh_of_model(NULL, models[i].name);
    add_model(&found, models[i].name, raw);
    vxm_mesh_destroy(raw);
  }
  shape made = model_rocket();
  vxm_mesh *raw = mesh_of_shape(NULL, &made);
  shape_free(&made);
  add_model(&found, "rocket", raw);
  vxm_mesh_destroy(raw);
  if (getenv("REFRESH")) {
    write_text(path, &found);
  } else {
    char *stored = read_text(path);
    compare(stored, found.text);
    free(stored);
  }
  free(found.text);
}

static int limit_processor(void **state) {
  (void)state;
  const char *level = getenv("CPU");
  if (!level)
    return 0;
  vxm_cpu_level most = strcmp(level, "plain") == 0 ? VXM_CPU_PLAIN : VXM_CPU_AVX2;
  return vxm_cpu_limit(most, NULL) == VXM_OK ? 0 : -1;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_bits)};
  return cmocka_run_group_tests(tests, limit_processor, NULL);
}
