/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the readers of grids, and of the JSON beside them. */
#include "fuzz.h"
#include "fuzz_soup.h"

#include "gridio/common/format.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/** What a grid may take: run lengths make much of little, and the limit is what stops them. */
enum { BESIDES = 1 << 22, RATE = 64 };

/** What is read in a process of its own needs room there. */
static vxm_context *context_of(const char *name, size_t size) {
  enum { ROOM = 512 << 20 };
  return strcmp(name, "vdb") == 0 ? fuzz_context(0, 0, ROOM) : fuzz_context(size, RATE, BESIDES);
}

static const vxm_grid_format *format_of(const char *name) {
  static const vxm_grid_format *const formats[] = {&vxm_format_binvox, &vxm_format_npy, &vxm_format_nrrd,
                                                   &vxm_format_rle,    &vxm_format_vdb, &vxm_format_vox,
                                                   &vxm_format_schem};
  for (size_t f = 0; f < sizeof formats / sizeof *formats; f++)
    if (strcmp(name, formats[f]->name) == 0)
      return formats[f];
  return &vxm_format_raw;
}

/** Padding that is not 0 would be counted. */
static void check_padding(const vxm_grid *grid) {
  uint64_t beyond = ~vxm_grid_tail_mask(grid);
  for (size_t w = grid->row_words - 1; w < grid->word_count; w += grid->row_words)
    fuzz_require((grid->words[w] & beyond) == 0, "rows end with zeros");
}

static void check_grid(const vxm_grid *grid) {
  fuzz_require(vxm_space_check(&grid->space, NULL) == VXM_OK, "the space is one");
  check_padding(grid);
  for (int n = 0; n < grid->warnings.count; n++)
    fuzz_require(grid->warnings.text[n][0] && !strchr(grid->warnings.text[n], '\n'), "warnings are one line");
}

/** Numbers, where there are some: they can be looked at and made into bits. */
static void check_field(const vxm_field *field) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_threshold_options half = VXM_THRESHOLD_OPTIONS_INIT;
  vxm_grid *grid;
  half.use_at_least = true;
  half.at_least = 0.5;
  fuzz_require(vxm_space_check(&field->space, NULL) == VXM_OK, "the space is one");
  fuzz_require(vxm_field_measure(&range, field, NULL) == VXM_OK && range.min <= range.max,
               "the range is one");
  if (vxm_field_threshold(&grid, field, &half, NULL) != VXM_OK)
    return;
  check_grid(grid);
  vxm_grid_destroy(grid);
}

static void read_numbers(const char *name, const char *path, const uint8_t *data, size_t size) {
  const vxm_grid_format *format = format_of(name);
  vxm_context *context = context_of(name, size);
  vxm_input input = {.data = data, .size = size, .name = path, .context = context};
  vxm_field *field = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = format->read_field(&field, &input, &error);
  fuzz_require((status == VXM_OK) == (field != NULL), "a field comes with success alone");
  if (status == VXM_OK)
    check_field(field);
  else
    fuzz_check_error(&error, status);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

static void read_as(const char *name, const char *path, const uint8_t *data, size_t size) {
  vxm_context *context = context_of(name, size);
  vxm_input input = {.data = data, .size = size, .name = path, .context = context};
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = format_of(name)->read(&grid, &input, VXM_BITS_ANY, &error);
  fuzz_require((status == VXM_OK) == (grid != NULL), "a grid comes with success alone");
  if (status == VXM_OK)
    check_grid(grid);
  else
    fuzz_check_error(&error, status);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

void fuzz_grid(const char *name, const uint8_t *data, size_t size) {
  const vxm_grid_format *format = format_of(name);
  vxm_context *context = context_of(name, size);
  vxm_input input = {.data = data, .size = size, .name = "fuzz", .context = context};
  (void)format->sniff(&input);
  vxm_context_destroy(context);
  read_as(name, "fuzz", data, size);
  if (format->read_field)
    read_numbers(name, "fuzz", data, size);
}

/* ---- The JSON beside a file ---- */

static char data_path[64], json_path[80];
static int json = -1;

static void remove_folder(void) {
  unlink(json_path);
  *strrchr(data_path, '/') = '\0';
  rmdir(data_path);
}

/** The JSON is a link to memory: disks are slow. */
static void make_folder(void) {
  char folder[] = "/tmp/voxmend-fuzz.XXXXXX", memory[40];
  json = memfd_create("json", MFD_CLOEXEC);
  fuzz_require(json >= 0 && mkdtemp(folder) != NULL, "there is a folder for files");
  snprintf(data_path, sizeof data_path, "%s/x.raw", folder);
  snprintf(json_path, sizeof json_path, "%s.json", data_path);
  snprintf(memory, sizeof memory, "/proc/self/fd/%d", json);
  fuzz_require(symlink(memory, json_path) == 0, "there is a link");
  atexit(remove_folder);
}

/** Puts the bytes where the JSON of data_path lies. */
static void put_json(const uint8_t *data, size_t size) {
  if (json < 0)
    make_folder();
  fuzz_require(ftruncate(json, 0) == 0 && pwrite(json, data, size, 0) == (ssize_t)size,
               "the JSON is written");
}

void fuzz_sidecar(const char *name, const uint8_t *data, size_t size) {
  (void)name;
  put_json(data, size);
  vxm_context *context = fuzz_context(size, RATE, BESIDES);
  vxm_space space;
  vxm_error error = VXM_ERROR_INIT;
  vxm_about about = {.is_declared = false};
  vxm_status status = vxm_sidecar_read(&space, &about, context, data_path, "voxmend raw", &error);
  if (status == VXM_OK)
    fuzz_require(vxm_space_check(&space, NULL) == VXM_OK, "the space is one");
  else
    fuzz_check_error(&error, status);
  vxm_about_destroy(&about);
  vxm_context_destroy(context);
}

/** The JSON, a zero byte, and the voxels. */
void fuzz_raw(const char *name, const uint8_t *data, size_t size) {
  const uint8_t *zero = memchr(data, 0, size);
  size_t length = zero ? (size_t)(zero - data) : size, rest = zero ? size - length - 1 : 0;
  put_json(data, length);
  uint8_t *voxels = malloc(rest ? rest : 1); /* a block of just this size, for sanitizers */
  fuzz_require(voxels != NULL, "there is memory");
  if (rest > 0)
    memcpy(voxels, zero + 1, rest);
  read_as(name, data_path, voxels, rest);
  free(voxels);
}
