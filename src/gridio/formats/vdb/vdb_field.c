/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb/vdb_field.h"
#include "base/bits.h"
#include "gridio/formats/vdb/vdb_blocks.h"

#include <pthread.h>
#include <string.h>

enum { SIDE = VXM_VDB_SIDE, VOXELS = VXM_VDB_VOXELS };

struct vxm_vdb_field {
  vxm_context *context;
  vxm_vdb_target target;
  vxm_vdb_kind kind;
  int64_t dims[3];
  size_t slice;          /**< values of a slice */
  float *values;         /**< of up to 8 slices; NULL before the first */
  pthread_mutex_t mutex; /**< held to put a tile into the tree */
};

vxm_status vxm_vdb_field_create(vxm_vdb_field **out, vxm_context *context, const vxm_space *space,
                                const vxm_vdb_kind *kind, vxm_error *error) {
  *out = NULL;
  vxm_error local = VXM_ERROR_INIT;
  vxm_vdb_field *field = vxm_calloc(context, 1, sizeof *field, &local);
  if (field) {
    field->context = context;
    field->kind = *kind;
    memcpy(field->dims, space->dims, sizeof field->dims);
    field->slice = (size_t)(space->dims[1] * space->dims[2]);
    pthread_mutex_init(&field->mutex, NULL);
  }
  if (local.code == VXM_OK)
    vxm_vdb_open_writer(&field->target.functions, space, &local);
  if (local.code == VXM_OK)
    field->target.functions->create(&field->target.vdb, context, kind, space, &local);
  if (local.code != VXM_OK) {
    vxm_vdb_field_destroy(field);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = field;
  return VXM_OK;
}

void vxm_vdb_field_destroy(vxm_vdb_field *field) {
  if (!field)
    return;
  if (field->target.vdb)
    field->target.functions->destroy(field->target.vdb);
  pthread_mutex_destroy(&field->mutex);
  vxm_free(field->context, field->values);
  vxm_free(field->context, field);
}

/* ---- Blocks ---- */

/** Copies a block of which x by y by z voxels are there, with the background beyond them; whether its voxels
 * are all alike. */
static bool gather(float block[VOXELS], const vxm_vdb_field *field, const float *values, size_t row,
                   size_t slice, const int64_t count[3]) {
  bool is_cut = count[0] < SIDE || count[1] < SIDE || count[2] < SIDE;
  for (int v = 0; v < VOXELS && is_cut; v++)
    block[v] = field->kind.background;
  for (int64_t dx = 0; dx < count[0]; dx++)
    for (int64_t dy = 0; dy < count[1]; dy++)
      memcpy(block + (dx * SIDE + dy) * SIDE, values + (size_t)dx * slice + (size_t)dy * row,
             (size_t)count[2] * sizeof *block);
  /* Equal to the one before, each of them. */
  return memcmp(block, block + 1, (VOXELS - 1) * sizeof *block) == 0;
}

/** To the sign of 0. */
static bool is_background(const vxm_vdb_field *field, float value) {
  return memcmp(&value, &field->kind.background, sizeof value) == 0;
}

static vxm_status put_block(const vxm_vdb_field *field, const float block[VOXELS], bool is_even,
                            const int64_t at[3], vxm_error *error) {
  const vxm_vdb_functions *functions = field->target.functions;
  if (!is_even)
    return functions->put_numbers(field->target.vdb, at, block, error);
  return is_background(field, block[0]) ? VXM_OK
                                        : functions->put_cube(field->target.vdb, at, SIDE, block[0], error);
}

static vxm_status put_slab(const vxm_vdb_field *field, int64_t x, int64_t slices, vxm_error *error) {
  vxm_status status = VXM_OK;
  float block[VOXELS];
  for (int64_t y = 0; y < field->dims[1]; y += SIDE)
    for (int64_t z = 0; z < field->dims[2] && status == VXM_OK; z += SIDE) {
      const int64_t count[3] = {slices, vxm_min(SIDE, field->dims[1] - y), vxm_min(SIDE, field->dims[2] - z)};
      bool is_even = gather(block, field, field->values + y * field->dims[2] + z, (size_t)field->dims[2],
                            field->slice, count);
      status = put_block(field, block, is_even, (int64_t[3]){x, y, z}, error);
    }
  return status;
}

vxm_status vxm_vdb_field_make_room(vxm_vdb_field *field, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  if (!field->values)
    field->values = vxm_alloc(field->context, SIDE * field->slice, sizeof *field->values, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_vdb_field_put(vxm_vdb_field *field, const float *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  vxm_status status = vxm_vdb_field_make_room(field, error);
  for (int64_t x = begin; x < end && status == VXM_OK; x++) {
    memcpy(field->values + (size_t)(x % SIDE) * field->slice, values + (size_t)(x - begin) * field->slice,
           field->slice * sizeof *values);
    if ((x + 1) % SIDE == 0 || x + 1 == field->dims[0])
      status = put_slab(field, x / SIDE * SIDE, x % SIDE + 1, error);
  }
  return status;
}

/* ---- Tiles ---- */

/** Gathers a block of a tile, which begins there; whether its voxels are all alike. */
static bool gather_of_tile(float block[VOXELS], const vxm_vdb_field *field, const vxm_value_tile *tile, int x,
                           int y, int z) {
  const int64_t count[3] = {vxm_min(SIDE, tile->count[2] - x), vxm_min(SIDE, tile->count[1] - y),
                            vxm_min(SIDE, tile->count[0] - z)};
  if (tile->values)
    return gather(block, field, tile->values + (size_t)x * tile->slice + (size_t)y * tile->row + (size_t)z,
                  tile->row, tile->slice, count);
  float row[SIDE];
  for (int v = 0; v < SIDE; v++)
    row[v] = tile->value;
  return gather(block, field, row, 0, 0, count);
}

static vxm_status put_tile_blocks(vxm_vdb_field *field, const vxm_value_tile *tile, vxm_error *error) {
  vxm_status status = VXM_OK;
  float block[VOXELS];
  for (int x = 0; x < tile->count[2]; x += SIDE)
    for (int y = 0; y < tile->count[1]; y += SIDE)
      for (int z = 0; z < tile->count[0] && status == VXM_OK; z += SIDE) {
        const int64_t at[3] = {tile->first[2] + x, tile->first[1] + y, tile->first[0] + z};
        bool is_even = gather_of_tile(block, field, tile, x, y, z);
        pthread_mutex_lock(&field->mutex);
        status = put_block(field, block, is_even, at, error);
        pthread_mutex_unlock(&field->mutex);
      }
  return status;
}

static bool is_even_cube(const vxm_value_tile *tile) {
  bool is_cube = true;
  for (int a = 0; a < 3; a++)
    is_cube = is_cube && tile->count[a] == VXM_VALUE_TILE;
  return is_cube && !tile->values;
}

vxm_status vxm_vdb_field_put_tile(vxm_vdb_field *field, const vxm_value_tile *tile, vxm_error *error) {
  if (!is_even_cube(tile))
    return put_tile_blocks(field, tile, error);
  const int64_t at[3] = {tile->first[2], tile->first[1], tile->first[0]};
  pthread_mutex_lock(&field->mutex);
  vxm_status status =
      is_background(field, tile->value)
          ? VXM_OK
          : field->target.functions->put_cube(field->target.vdb, at, VXM_VALUE_TILE, tile->value, error);
  pthread_mutex_unlock(&field->mutex);
  return status;
}

vxm_status vxm_vdb_field_write(vxm_vdb_field *field, vxm_output *output, vxm_error *error) {
  return field->target.functions->write(field->target.vdb, output, error);
}
