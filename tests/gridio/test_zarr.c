/* SPDX-License-Identifier: BSD-3-Clause */
/** Zarr arrays: what is written comes back; a folder appears whole or not at all, and nothing that is not
 * such an array is replaced; damage ends in an error, in bounded memory. */
#include "grids.h"

#include "base/file_transaction.h"
#include "gridio/common/format.h"

#include <sys/file.h>
#include <sys/stat.h>

static char folder[64], path[96];

static int set_up(void **state) {
  (void)state;
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.zarr", folder);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command);
}

static void empty(void) {
  assert_int_equal(tear_down(NULL), 0);
  assert_int_equal(mkdir(folder, 0700), 0);
}

static const char *inner(const char *name) {
  static char text[160];
  snprintf(text, sizeof text, "%s/%s", path, name);
  return text;
}

static int entries(const char *where) {
  DIR *list = opendir(where);
  int count = 0;
  for (const struct dirent *entry; list && (entry = readdir(list));)
    count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  if (list)
    closedir(list);
  return count;
}

/* ---- There and back ---- */

static void test_bits_come_back(void **state) {
  (void)state;
  vxm_rng rng = {31};
  for (int round = 0; round < 2 * KINDS; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_grid *back, *grid = new_grid(context, random_space(&rng, 140, false));
    fill_random(grid, &rng, round % KINDS);
    write_grid(grid, path);
    assert_int_equal(vxm_gridio_read(&back, context, path, NULL), VXM_OK);
    assert_memory_equal(&grid->space, &back->space, sizeof grid->space);
    assert_memory_equal(grid->words, back->words, grid->word_count * sizeof *grid->words);
    assert_int_equal(back->warnings.count, 0);
    assert_int_equal(entries(folder), 1);
    vxm_grid_destroy(back);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
}

static vxm_field *random_field(vxm_context *context, vxm_rng *rng, vxm_field_kind kind, vxm_scalar scalar) {
  const vxm_space space = random_space(rng, 90, false);
  vxm_field *field;
  assert_int_equal(vxm_field_make(&field, context, &space, kind, scalar, NULL), VXM_OK);
  size_t bytes = vxm_field_count(field) * vxm_field_voxel_bytes(field);
  for (size_t b = 0; b < bytes; b++)
    field->values[b] = (unsigned char)(b / 5000 % 3 == 0 ? 0 : vxm_rng_below(rng, 100));
  return field;
}

static void assert_field_comes_back(vxm_context *context, const vxm_field *field) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_field *back;
  vxm_grid *grid;
  assert_int_equal(vxm_gridio_write_field(field, path, NULL, &error), VXM_OK);
  assert_int_equal(vxm_gridio_read_either(&grid, &back, context, path, &error), VXM_OK);
  assert_null(grid);
  assert_int_equal(back->scalar, field->scalar);
  assert_int_equal(back->channels, field->channels);
  assert_int_equal(back->about.kind, field->about.kind);
  assert_true(back->about.is_declared == (field->about.kind != VXM_FIELD_NUMBERS));
  assert_memory_equal(&back->space, &field->space, sizeof field->space);
  assert_memory_equal(back->values, field->values, vxm_field_count(field) * vxm_field_voxel_bytes(field));
  assert_int_equal(back->about.table.count, field->about.table.count);
  for (size_t l = 1; l <= field->about.table.count; l++)
    assert_string_equal(vxm_label_table_name(&back->about.table, l),
                        vxm_label_table_name(&field->about.table, l));
  vxm_field_destroy(back);
}

static void test_fields_come_back(void **state) {
  (void)state;
  static const struct {
    vxm_field_kind kind;
    vxm_scalar scalar;
  } all[] = {{VXM_FIELD_DISTANCE, VXM_FLOAT32}, {VXM_FIELD_DISTANCE, VXM_FLOAT16},
             {VXM_FIELD_NUMBERS, VXM_FLOAT64},  {VXM_FIELD_NUMBERS, VXM_INT64},
             {VXM_FIELD_COVERAGE, VXM_UINT8},   {VXM_FIELD_LABELS, VXM_UINT16},
             {VXM_FIELD_LABELS, VXM_UINT32},    {VXM_FIELD_COLORS, VXM_UINT8}};
  vxm_rng rng = {32};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  for (size_t a = 0; a < sizeof all / sizeof *all; a++) {
    vxm_field *field = random_field(context, &rng, all[a].kind, all[a].scalar);
    if (all[a].kind == VXM_FIELD_LABELS)
      for (int l = 0; l < 3; l++)
        assert_true(vxm_label_table_add(&field->about.table, context, l == 1 ? "Zähne \"b\"" : "a", l + 7));
    assert_field_comes_back(context, field);
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
}

static void test_threads_make_same_bytes(void **state) {
  (void)state;
  char other[96], command[256];
  snprintf(other, sizeof other, "%s/b.zarr", folder);
  for (int t = 0; t < 2; t++) {
    vxm_rng rng = {33};
    vxm_context *context = context_with(t == 0 ? 1 : 4, 0, NULL, NULL);
    vxm_grid *grid = new_grid(context, unit_space(130, 140, 150));
    fill_random(grid, &rng, 2);
    write_grid(grid, t == 0 ? path : other);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  snprintf(command, sizeof command, "diff -r %s %s", path, other);
  assert_int_equal(system(command), 0);
}

/* ---- Whole or not at all ---- */

static vxm_status write_box(vxm_context *context, const char *where, int64_t side, vxm_error *error) {
  vxm_grid *grid = new_grid(context, unit_space(side, side, side));
  vxm_grid_set(grid, 0, 0, 0, true);
  vxm_status status = vxm_gridio_write(grid, where, "zarr", error);
  vxm_grid_destroy(grid);
  return status;
}

static void test_only_arrays_are_replaced(void **state) {
  (void)state;
  char text[128];
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  snprintf(text, sizeof text, "%s///", path);
  assert_int_equal(write_box(context, text, 3, NULL), VXM_OK);
  assert_int_equal(chmod(path, 0750), 0);
  save_file(inner("7.7.7"), "old", 3);
  assert_int_equal(write_box(context, path, 4, NULL), VXM_OK);
  assert_int_not_equal(access(inner("7.7.7"), F_OK), 0);
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  assert_int_equal(info.st_mode & 0777, 0750);
  save_file(inner("note.txt"), "mine", 4);
  assert_int_equal(write_box(context, path, 5, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "\"note.txt\", which is no part of a Zarr array"));
  assert_int_equal(unlink(inner(".zarray")), 0);
  assert_int_equal(write_box(context, path, 5, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "this folder is not a Zarr array"));
  assert_int_equal(access(inner("note.txt"), F_OK), 0);
  assert_int_equal(entries(folder), 1);
  empty();
  assert_int_equal(mkdir(path, 0700), 0); /* an empty one is as good as none */
  assert_int_equal(write_box(context, path, 5, NULL), VXM_OK);
  empty();
  save_file(path, "a file", 6);
  assert_int_equal(write_box(context, path, 5, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(unlink(path), 0);
  assert_int_equal(symlink("/nowhere", path), 0);
  assert_int_equal(write_box(context, path, 5, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "a link of this name is there"));
  assert_int_equal(write_box(context, "-", 5, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(write_box(context, "/nowhere/at/all.zarr", 5, &error), VXM_ERROR_IO);
  vxm_context_destroy(context);
}

static int cancel(const char *phase, double fraction, void *payload) {
  (void)phase, (void)payload;
  return fraction > 0.5;
}

static void test_nothing_is_left_after_failure(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, cancel, NULL);
  vxm_grid *grid = new_grid(context, unit_space(200, 64, 64));
  for (int64_t i = 0; i < 200; i += 3)
    vxm_grid_set(grid, i, 5, 5, true);
  assert_int_equal(vxm_gridio_write(grid, path, NULL, NULL), VXM_ERROR_CANCELLED);
  assert_int_equal(entries(folder), 0);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

/** Together with files of the same run; what a killed program left is taken away. */
static void test_several_together(void **state) {
  (void)state;
  char other[96];
  vxm_error error = VXM_ERROR_INIT;
  snprintf(other, sizeof other, "%s/b.raw", folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  for (int drops = 1; drops >= 0; drops--) {
    assert_int_equal(vxm_context_hold_files(context, NULL), VXM_OK);
    assert_int_equal(write_box(context, path, 4, NULL), VXM_OK);
    assert_int_equal(write_box(context, path, 4, &error), VXM_ERROR_ARGUMENT);
    save_file(inner("9.9.9"), "", 0);
    if (drops)
      vxm_context_drop_files(context);
    else
      assert_int_equal(vxm_context_publish_files(context, NULL), VXM_OK);
    assert_int_equal(entries(folder), 1);
    assert_int_equal(access(inner("9.9.9"), F_OK) == 0, drops);
  }
  /* The second cannot get its name: the first goes back. */
  save_file(inner("9.9.9"), "", 0);
  assert_int_equal(vxm_context_hold_files(context, NULL), VXM_OK);
  assert_int_equal(write_box(context, path, 5, NULL), VXM_OK);
  assert_int_equal(vxm_file_write(context, other, "x", 1, NULL), VXM_OK);
  assert_int_equal(mkdir(other, 0700), 0);
  assert_int_equal(vxm_context_publish_files(context, NULL), VXM_ERROR_IO);
  assert_int_equal(access(inner("9.9.9"), F_OK), 0);
  assert_int_equal(entries(folder), 2);
  vxm_context_destroy(context);
}

static bool is_part(const char *name, bool is_folder, int depth) {
  (void)depth;
  return !is_folder && (name[0] == '.' || strspn(name, "0123456789.") == strlen(name));
}

/** A program that is killed leaves a folder, which the next one takes away; one that still writes keeps its
 * own. */
static void test_abandoned_folders(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_atomic_folder left;
  assert_int_equal(vxm_atomic_folder_open(&left, path, ".zarray", is_part, "a Zarr array", NULL), VXM_OK);
  assert_true(vxm_atomic_folder_put(&left, "0.0.0", "x", 1));
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  assert_int_equal(entries(folder), 2);
  assert_int_equal(close(left.descriptor), 0); /* and its lock */
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  assert_int_equal(entries(folder), 1);
  char moved[160]; /* the old one, where names cannot be exchanged */
  snprintf(moved, sizeof moved, "%s/%s", folder, left.temporary);
  memcpy(strrchr(moved, '.'), ".old", 5);
  assert_int_equal(mkdir(moved, 0700), 0);
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  assert_int_equal(entries(folder), 1);
  assert_int_equal(rename(path, moved), 0); /* all that is left of it */
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  assert_int_equal(entries(folder), 2);
  left.descriptor = -1;
  vxm_atomic_folder_close(&left);
  vxm_context_destroy(context);
}

static void open_new(vxm_atomic_folder *out, const char *chunk) {
  assert_int_equal(vxm_atomic_folder_open(out, path, ".zarray", is_part, "a Zarr array", NULL), VXM_OK);
  assert_true(vxm_atomic_folder_put(out, ".zarray", "{}", 2));
  assert_true(vxm_atomic_folder_put(out, chunk, "x", 1));
}

/** Two write one array at the same time: neither takes away what is the other's. */
static void test_two_writers(void **state) {
  (void)state;
  vxm_atomic_folder first, second, third;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  for (int locks = 1; locks >= 0; locks--) {
    open_new(&first, "0.0.1");
    assert_int_equal(vxm_atomic_folder_publish(&first, path, NULL), VXM_OK);
    if (!locks) /* as where folders cannot be locked */
      assert_int_equal(flock(first.old, LOCK_UN), 0);
    open_new(&second, "0.0.2");
    assert_int_equal(strcmp(first.temporary, second.temporary) == 0, !locks);
    open_new(&third, "0.0.3");
    vxm_atomic_folder_close(&first);
    assert_int_equal(vxm_atomic_folder_publish(&second, path, NULL), VXM_OK);
    vxm_atomic_folder_close(&second);
    assert_int_equal(access(inner("0.0.2"), F_OK), 0);
    assert_int_equal(vxm_atomic_folder_publish(&third, path, NULL), VXM_OK);
    vxm_atomic_folder_revert(&third);
    vxm_atomic_folder_close(&third);
    assert_int_equal(access(inner("0.0.2"), F_OK), 0);
    assert_int_equal(entries(path), 2);
    assert_int_equal(entries(folder), 1);
  }
  vxm_context_destroy(context);
}

/** What comes there while the new one is written is looked at too; a secret array stays one meanwhile. */
static void test_changes_meanwhile(void **state) {
  (void)state;
  vxm_atomic_folder late;
  struct stat info;
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
  assert_int_equal(chmod(path, 0700), 0);
  open_new(&late, "0.0.1");
  assert_int_equal(fstat(late.descriptor, &info), 0);
  assert_int_equal(info.st_mode & 0777, 0700);
  save_file(inner("note.txt"), "mine", 4);
  assert_int_equal(vxm_atomic_folder_publish(&late, path, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "\"note.txt\", which is no part"));
  vxm_atomic_folder_close(&late);
  assert_int_equal(entries(path), 4);
  assert_int_equal(entries(folder), 1);
  vxm_context_destroy(context);
}

/** Digits alone make no chunk. */
static void test_digits_are_kept(void **state) {
  (void)state;
  static const char *const names[] = {"0/1/2", "0/1/2/0", "3.1.2", "3.1.2.0",   "2024", "1.2", "1.2.3.4.5",
                                      "1..2",  "1.2.",    "3/1.2", "3/1/2/4/5", "3/1",  "3/a"};
  char command[256];
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    assert_int_equal(write_box(context, path, 3, NULL), VXM_OK);
    snprintf(command, sizeof command, "mkdir -p $(dirname %s/%s) && touch %s/%s", path, names[n], path,
             names[n]);
    assert_int_equal(system(command), 0);
    assert_int_equal(write_box(context, path, 4, NULL), n < 4 ? VXM_OK : VXM_ERROR_ARGUMENT);
    assert_int_equal(access(inner(names[n]), F_OK) == 0, n >= 4);
    empty();
  }
  vxm_context_destroy(context);
}

/** An array that is taken away while it is read is no array of fill values. */
static int replace_it(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  bool *done = payload;
  if (!*done)
    write_box(NULL, path, 5, NULL);
  *done = true;
  return 0;
}

static void test_replaced_while_read(void **state) {
  (void)state;
  bool done = false;
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *writer = context_with(1, 0, NULL, NULL), *reader = context_with(1, 0, replace_it, &done);
  vxm_grid *grid = new_grid(writer, unit_space(200, 64, 64)), *back;
  for (int64_t i = 0; i < 200; i += 3)
    vxm_grid_set(grid, i, 5, 5, true);
  assert_int_equal(vxm_gridio_write(grid, path, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_gridio_read(&back, reader, path, &error), VXM_ERROR_IO);
  assert_true(done);
  assert_null(back);
  assert_non_null(strstr(error.text, "was replaced while it was read"));
  vxm_grid_destroy(grid);
  vxm_context_destroy(writer);
  vxm_context_destroy(reader);
}

/* ---- Damage ---- */

static size_t mutate(unsigned char *data, size_t size, vxm_rng *rng) {
  uint64_t times = 1 + vxm_rng_below(rng, 3);
  for (uint64_t t = 0; t < times && size > 0; t++) {
    size_t at = vxm_rng_below(rng, size);
    switch (vxm_rng_below(rng, 5)) {
    case 0:
      data[at] ^= (unsigned char)(1u << vxm_rng_below(rng, 8));
      break;
    case 1:
      data[at] = (unsigned char)vxm_rng_next(rng);
      break;
    case 2:
      data[at] = (unsigned char)('0' + vxm_rng_below(rng, 10));
      break;
    case 3:
      memmove(data + at, data + at + 1, --size - at);
      break;
    default:
      memmove(data + at + 1, data + at, size - at);
      data[at] = (unsigned char)('0' + vxm_rng_below(rng, 10));
      size++;
    }
  }
  return size;
}

static void assert_mutants_are_read_or_refused(const char *name, const char *where, int rounds) {
  size_t size;
  unsigned char *sound = load_file(where, &size), *data = malloc(size + 8);
  vxm_context *context = context_with(2, 16 << 20, NULL, NULL);
  vxm_rng rng = {6};
  int read = 0, refused = 0;
  for (int round = 0; round < rounds; round++) {
    memcpy(data, sound, size);
    save_file(where, data, mutate(data, size, &rng));
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *grid;
    vxm_field *field;
    vxm_status status = vxm_gridio_read_either(&grid, &field, context, path, &error);
    assert_int_equal(grid || field, status == VXM_OK);
    if (status != VXM_OK) {
      assert_true(status == VXM_ERROR_FORMAT || status == VXM_ERROR_RANGE ||
                  status == VXM_ERROR_MEMORY_LIMIT);
      assert_non_null(strstr(error.text, "a.zarr"));
      refused++;
    } else
      read++;
    vxm_grid_destroy(grid);
    vxm_field_destroy(field);
  }
  if (read == 0 || refused == 0)
    fail_msg("%s: %d were read, %d refused", name, read, refused);
  save_file(where, sound, size);
  free(sound);
  free(data);
  vxm_context_destroy(context);
}

static void test_mutation(void **state) {
  (void)state;
  vxm_rng rng = {34};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_field *field;
  const vxm_space space = {{9, 70, 20}, {1, 2, 3}, {0.5, 0.5, 0.5}};
  assert_int_equal(vxm_field_make(&field, context, &space, VXM_FIELD_LABELS, VXM_UINT16, NULL), VXM_OK);
  for (size_t v = 0; v < vxm_field_count(field); v++)
    ((uint16_t *)(void *)field->values)[v] = (uint16_t)vxm_rng_below(&rng, 3);
  assert_true(vxm_label_table_add(&field->about.table, context, "first", 7));
  assert_int_equal(vxm_gridio_write_field(field, path, NULL, NULL), VXM_OK);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
  static const char *const names[] = {".zarray", ".zattrs", "0.1.0"};
  for (int n = 0; n < 3; n++) {
    char where[160];
    snprintf(where, sizeof where, "%s", inner(names[n]));
    assert_mutants_are_read_or_refused(names[n], where, 1500);
  }
}

static vxm_status read_described(vxm_field **field, vxm_context *context, const char *shape, const char *type,
                                 const char *fill, vxm_error *error) {
  char text[256];
  vxm_grid *grid;
  int length = snprintf(text, sizeof text,
                        "{\"zarr_format\":2,\"shape\":%s,\"chunks\":[1,1,1],\"dtype\":\"%s\",\"order\":\"C\","
                        "\"compressor\":null,\"fill_value\":%s,\"filters\":null}",
                        shape, type, fill);
  save_file(inner(".zarray"), text, (size_t)length);
  vxm_status status = vxm_gridio_read_either(&grid, field, context, path, error);
  vxm_grid_destroy(grid);
  return status;
}

static void test_odd_descriptions(void **state) {
  (void)state;
  vxm_error error = VXM_ERROR_INIT;
  vxm_field *field;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  assert_int_equal(mkdir(path, 0700), 0);
  assert_int_equal(read_described(&field, context, "[1,1,2]", "<i8", "9.1e15", &error), VXM_ERROR_FORMAT);
  assert_non_null(strstr(error.text, "fill_value"));
  assert_int_equal(read_described(&field, context, "[1,1,2]", "<i8", "9.0e15", &error), VXM_OK);
  assert_true(((const int64_t *)(const void *)field->values)[1] == INT64_C(9000000000000000));
  vxm_field_destroy(field);
  assert_int_equal(read_described(&field, context, "[1,1,2]", "|b1", "5", &error), VXM_OK);
  assert_null(field); /* bits, set */
  assert_int_equal(read_described(&field, context, "[500,200,200]", "|u1", "0", &error), VXM_ERROR_FORMAT);
  assert_non_null(strstr(error.text, "it has over 4194304 chunks"));
  vxm_context_destroy(context);
}

/** What is asked of a chunk that is not a file, or has another length. */
static void test_odd_chunks(void **state) {
  (void)state;
  static const char array[] =
      "{\"zarr_format\":2,\"shape\":[2,2,2],\"chunks\":[2,2,2],\"dtype\":\"|u1\",\"order\":\"C\","
      "\"compressor\":null,\"fill_value\":7,\"filters\":null}";
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid;
  vxm_field *field;
  assert_int_equal(mkdir(path, 0700), 0);
  save_file(inner(".zarray"), array, sizeof array - 1);
  assert_int_equal(vxm_gridio_read_either(&grid, &field, context, path, &error), VXM_OK);
  for (int v = 0; v < 8; v++)
    assert_int_equal(field->values[v], 7);
  assert_int_equal(field->warnings.count, 1); /* no place */
  vxm_field_destroy(field);
  for (size_t size = 0; size < 12; size++) {
    save_file(inner("0.0.0"), "\1\2\3\4\5\6\7\10\11\12\13\14", size);
    vxm_status status = vxm_gridio_read_either(&grid, &field, context, path, &error);
    assert_int_equal(status, size == 8 ? VXM_OK : VXM_ERROR_FORMAT);
    vxm_field_destroy(field);
  }
  assert_int_equal(unlink(inner("0.0.0")), 0);
  assert_int_equal(mkfifo(inner("0.0.0"), 0600), 0); /* never waited for */
  assert_int_equal(vxm_gridio_read_either(&grid, &field, context, path, &error), VXM_ERROR_IO);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_bits_come_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_fields_come_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_threads_make_same_bytes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_only_arrays_are_replaced, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_nothing_is_left_after_failure, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_several_together, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_abandoned_folders, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_two_writers, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_changes_meanwhile, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_digits_are_kept, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_replaced_while_read, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_mutation, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_odd_descriptions, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_odd_chunks, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
