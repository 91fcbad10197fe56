/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb_field.h"
#include "base/bits.h"
#include "gridio/formats/vdb_blocks.h"

#include <string.h>

enum { SIDE = VXM_VDB_SIDE, VOXELS = VXM_VDB_VOXELS };

struct vxm_vdb_field {
  vxm_context *context;
  vxm_vdb_target target;
  vxm_vdb_kind kind;
  int64_t dims[3];
  size_t slice;  /**< values of a slice */
  float *values; /**< of up to 8 slices */
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
    field->values = vxm_alloc(context, SIDE * field->slice, sizeof *field->values, &local);
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
  vxm_free(field->context, field->values);
  vxm_free(field->context, field);
}

/* ---- Blocks ---- */

/** Copies a block, with the background beyond the space; whether its voxels are all alike. */
static bool gather(float block[VOXELS], const vxm_vdb_field *field, int64_t slices, int64_t y, int64_t z) {
  int64_t rows = vxm_min(SIDE, field->dims[1] - y), length = vxm_min(SIDE, field->dims[2] - z);
  bool is_cut = slices < SIDE || rows < SIDE || length < SIDE;
  for (int v = 0; v < VOXELS && is_cut; v++)
    block[v] = field->kind.background;
  for (int64_t dx = 0; dx < slices; dx++)
    for (int64_t dy = 0; dy < rows; dy++)
      memcpy(block + (dx * SIDE + dy) * SIDE,
             field->values + (size_t)dx * field->slice + (size_t)((y + dy) * field->dims[2] + z),
             (size_t)length * sizeof *block);
  /* Equal to the one before, each of them. */
  return memcmp(block, block + 1, (VOXELS - 1) * sizeof *block) == 0;
}

static vxm_status put_block(const vxm_vdb_field *field, const float block[VOXELS], bool is_even,
                            const int64_t at[3], vxm_error *error) {
  const vxm_vdb_functions *functions = field->target.functions;
  if (!is_even)
    return functions->put_numbers(field->target.vdb, at, block, error);
  return block[0] == field->kind.background
             ? VXM_OK
             : functions->put_cube(field->target.vdb, at, SIDE, block[0], error);
}

static vxm_status put_slab(const vxm_vdb_field *field, int64_t x, int64_t slices, vxm_error *error) {
  vxm_status status = VXM_OK;
  float block[VOXELS];
  for (int64_t y = 0; y < field->dims[1]; y += SIDE)
    for (int64_t z = 0; z < field->dims[2] && status == VXM_OK; z += SIDE) {
      bool is_even = gather(block, field, slices, y, z);
      status = put_block(field, block, is_even, (int64_t[3]){x, y, z}, error);
    }
  return status;
}

vxm_status vxm_vdb_field_put(vxm_vdb_field *field, const float *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  vxm_status status = VXM_OK;
  for (int64_t x = begin; x < end && status == VXM_OK; x++) {
    memcpy(field->values + (size_t)(x % SIDE) * field->slice, values + (size_t)(x - begin) * field->slice,
           field->slice * sizeof *values);
    if ((x + 1) % SIDE == 0 || x + 1 == field->dims[0])
      status = put_slab(field, x / SIDE * SIDE, x % SIDE + 1, error);
  }
  return status;
}

vxm_status vxm_vdb_field_write(vxm_vdb_field *field, vxm_output *output, vxm_error *error) {
  return field->target.functions->write(field->target.vdb, output, error);
}
