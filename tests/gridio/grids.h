/* SPDX-License-Identifier: BSD-3-Clause */
/** Random grids, contexts and scratch folders for the tests of grids in and out. */
#ifndef VXM_TESTS_GRIDS_H
#define VXM_TESTS_GRIDS_H

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/rng.h"
#include "grid/bitgrid.h"
#include "gridio/gridio.h"

static inline vxm_context *context_with(int threads, uint64_t limit, vxm_progress_fn progress,
                                        void *payload) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = limit;
  options.progress = progress;
  options.payload = payload;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  return context;
}

static inline vxm_grid *new_grid(vxm_context *context, vxm_space space) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (vxm_grid_create(&grid, context, &space, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

static inline vxm_space unit_space(int64_t nx, int64_t ny, int64_t nz) {
  return (vxm_space){{nx, ny, nz}, {0, 0, 0}, {1, 1, 1}};
}

/** Kinds of content: sparse, dense, long runs, blocks, empty, full. */
enum { KINDS = 6 };

static inline void fill_random(vxm_grid *grid, vxm_rng *rng, int kind) {
  const int64_t *n = grid->space.dims;
  uint64_t left = 0;
  bool value = false;
  for (int64_t k = 0; k < n[2]; k++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t i = 0; i < n[0]; i++) {
        if (kind == 0)
          value = vxm_rng_below(rng, 20) == 0;
        else if (kind == 1)
          value = vxm_rng_below(rng, 2) == 0;
        else if (kind == 2 && left-- == 0) {
          value = !value;
          left = vxm_rng_below(rng, 1200);
        } else if (kind == 3)
          value = vxm_mix((uint64_t)(i / 5 + 100 * (j / 3) + 10000 * (k / 4))) % 3 == 0;
        else if (kind > 3)
          value = kind == 5;
        vxm_grid_set(grid, i, j, k, value);
      }
}

/** Sides of 1 to `most`, often at and around multiples of 64. */
static inline int64_t random_side(vxm_rng *rng, int64_t most) {
  static const int64_t special[] = {1, 2, 63, 64, 65, 127, 128, 129};
  int64_t side = vxm_rng_below(rng, 3) == 0 ? special[vxm_rng_below(rng, 8)]
                                            : 1 + (int64_t)vxm_rng_below(rng, (uint64_t)most);
  return side < most ? side : most;
}

static inline vxm_space random_space(vxm_rng *rng, int64_t most, bool cubes) {
  vxm_space space;
  for (int a = 0; a < 3; a++) {
    space.dims[a] = random_side(rng, most);
    space.origin[a] = (vxm_rng_unit(rng) - 0.5) * (a == 1 ? 1e-3 : 1e3);
    space.voxel_size[a] = cubes && a > 0 ? space.voxel_size[0] : 1e-2 + vxm_rng_unit(rng);
  }
  return space;
}

/** Bits beyond a row's end are zero. */
static inline void assert_padding_clear(const vxm_grid *grid) {
  uint64_t padding = ~vxm_grid_tail_mask(grid);
  for (size_t w = grid->row_words - 1; w < grid->word_count; w += grid->row_words)
    assert_true((grid->words[w] & padding) == 0);
}

static inline void assert_same_bits(const vxm_grid *a, const vxm_grid *b) {
  assert_memory_equal(a->space.dims, b->space.dims, sizeof a->space.dims);
  assert_padding_clear(b);
  assert_memory_equal(a->words, b->words, a->word_count * sizeof *a->words);
}

/** The number 1 as a file has it. */
static inline void put_one(unsigned char *to, size_t size, bool is_float, bool is_big) {
  unsigned char one[8] = {1};
  if (is_float) {
    one[0] = 0;
    one[size - 1] = size == 2 ? 0x3c : 0x3f;
    if (size > 2)
      one[size - 2] = size == 4 ? 0x80 : 0xf0;
  }
  for (size_t b = 0; b < size; b++)
    to[b] = one[is_big ? size - 1 - b : b];
}

/* ---- Files ---- */

static inline void write_grid(const vxm_grid *grid, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_write(grid, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

static inline vxm_grid *read_back(vxm_context *context, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  if (vxm_gridio_read(&grid, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

/** The file is the grid, bit for bit, and nothing is noted of it. */
static inline void assert_reads_back(const vxm_grid *grid, const char *path) {
  vxm_grid *back = read_back(grid->context, path);
  assert_same_bits(grid, back);
  assert_memory_equal(&grid->space, &back->space, sizeof grid->space);
  assert_int_equal(back->warnings.count, 0);
  vxm_grid_destroy(back);
}

static inline vxm_field *make_field(vxm_context *context, const vxm_space *space, vxm_field_kind kind,
                                    vxm_scalar scalar) {
  vxm_field *field;
  assert_int_equal(vxm_field_make(&field, context, space, kind, scalar, NULL), VXM_OK);
  field->about.is_declared = true;
  return field;
}

static inline void write_field(const vxm_field *field, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_write_field(field, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

static inline vxm_field *read_field(vxm_context *context, const char *path) {
  vxm_grid *grid;
  vxm_field *field;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_read_either(&grid, &field, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_null(grid);
  assert_non_null(field);
  return field;
}

/** An empty folder of its own in the present one. */
static inline void make_folder(char folder[64]) {
  strcpy(folder, "gridio-test-XXXXXX");
  assert_non_null(mkdtemp(folder));
}

static inline int count_files(const char *folder) {
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(dir)) != NULL;)
    count += entry->d_name[0] != '.';
  closedir(dir);
  return count;
}

static inline void empty_folder(const char *folder) {
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  for (struct dirent *entry; (entry = readdir(dir)) != NULL;)
    if (entry->d_name[0] != '.') {
      char path[400];
      snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
      remove(path);
    }
  closedir(dir);
}

static inline void remove_folder(const char *folder) {
  empty_folder(folder);
  rmdir(folder);
}

/** One of four texts that are used in turn. */
static inline const char *path_in(const char *folder, const char *name) {
  static char paths[4][400];
  static int next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", folder, name);
  return path;
}

/** The whole file in a block of exactly its size, to be freed. */
static inline unsigned char *load_file(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  unsigned char *data = malloc(*size ? *size : 1);
  assert_int_equal(fread(data, 1, *size, file), *size);
  fclose(file);
  return data;
}

static inline void save_file(const char *path, const void *data, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(data, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

#endif
