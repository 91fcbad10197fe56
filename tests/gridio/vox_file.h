/* SPDX-License-Identifier: BSD-3-Clause */
/** .vox files as other programs write them, put together chunk by chunk. */
#ifndef VOX_FILE_H
#define VOX_FILE_H

#include "grids.h"

#include "gridio/common/format.h"

/** A file in the making. */
typedef struct vox_bytes {
  unsigned char data[4096];
  size_t size;
} vox_bytes;

static inline void put(vox_bytes *b, const void *data, size_t size) {
  assert_true(b->size + size <= sizeof b->data);
  memcpy(b->data + b->size, data, size);
  b->size += size;
}

static inline void put_word(vox_bytes *b, int32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    put(b, &(unsigned char){(unsigned char)((uint32_t)value >> shift)}, 1);
}

static inline void put_string(vox_bytes *b, const char *text) {
  put_word(b, (int32_t)strlen(text));
  put(b, text, strlen(text));
}

static inline void put_chunk(vox_bytes *b, const char *name, const vox_bytes *content) {
  put(b, name, 4);
  put_word(b, (int32_t)content->size);
  put_word(b, 0);
  put(b, content->data, content->size);
}

static inline void put_model(vox_bytes *b, const int size[3], const unsigned char (*voxels)[4], int count) {
  vox_bytes c = {.size = 0};
  for (int a = 0; a < 3; a++)
    put_word(&c, size[a]);
  put_chunk(b, "SIZE", &c);
  c.size = 0;
  put_word(&c, count);
  put(&c, voxels, 4 * (size_t)count);
  put_chunk(b, "XYZI", &c);
}

static inline void put_transform(vox_bytes *b, int number, int child, const char *turn, const char *step) {
  vox_bytes c = {.size = 0};
  put_word(&c, number);
  put_word(&c, 1);
  put_string(&c, "_name");
  put_string(&c, "of another program");
  put_word(&c, child);
  put_word(&c, -1);
  put_word(&c, 0);
  put_word(&c, 1);
  put_word(&c, (turn != NULL) + (step != NULL));
  if (turn) {
    put_string(&c, "_r");
    put_string(&c, turn);
  }
  if (step) {
    put_string(&c, "_t");
    put_string(&c, step);
  }
  put_chunk(b, "nTRN", &c);
}

/** A group of these, or a shape of one model. */
static inline void put_node(vox_bytes *b, const char *name, int number, const int *children, int count) {
  vox_bytes c = {.size = 0};
  put_word(&c, number);
  put_word(&c, 0);
  put_word(&c, count);
  for (int i = 0; i < count; i++) {
    put_word(&c, children[i]);
    if (strcmp(name, "nSHP") == 0)
      put_word(&c, 0);
  }
  put_chunk(b, name, &c);
}

static inline vox_bytes close_file_of(const vox_bytes *chunks) {
  vox_bytes file = {.size = 0};
  put(&file, "VOX ", 4);
  put_word(&file, 200);
  put(&file, "MAIN", 4);
  put_word(&file, 0);
  put_word(&file, (int32_t)chunks->size);
  put(&file, chunks->data, chunks->size);
  return file;
}

static inline vxm_status read_vox(vxm_grid **grid, vxm_field **field, vxm_context *context,
                                  const vox_bytes *file, vxm_error *error) {
  unsigned char *copy = malloc(file->size + 1); /* a block of this size, for sanitizers */
  memcpy(copy, file->data, file->size);
  vxm_input input = {.data = copy, .size = file->size, .name = "x.vox", .context = context};
  vxm_status status = grid ? vxm_format_vox.read(grid, &input, VXM_BITS_ANY, error)
                           : vxm_format_vox.read_field(field, &input, error);
  free(copy);
  return status;
}

/**
 * A bar along x, 3 x 1 x 1, that is turned a quarter about z (its x becomes y, its y becomes -x) and stands
 * at (10, 20, 30), beside one that is only moved, within a group that stands at (100, 0, 0).
 */
static inline vox_bytes make_turned(void) {
  static const unsigned char bar[3][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {2, 0, 0, 7}};
  vox_bytes b = {.size = 0};
  put_model(&b, (const int[3]){3, 1, 1}, bar, 3);
  put_transform(&b, 0, 1, NULL, "100 0 0");
  put_node(&b, "nGRP", 1, (const int[]){2, 4}, 2);
  /* row 0 has its number in column 1, and it is -1; row 1 in column 0 */
  put_transform(&b, 2, 3, "17", "10 20 30");
  put_node(&b, "nSHP", 3, (const int[]){0}, 1);
  put_transform(&b, 4, 5, NULL, "0 0 0");
  put_node(&b, "nSHP", 5, (const int[]){0}, 1);
  return close_file_of(&b);
}

#endif
