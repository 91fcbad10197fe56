/* SPDX-License-Identifier: BSD-3-Clause */
/** A number per voxel as a tree of OpenVDB. */
#ifndef VXM_GRIDIO_FORMATS_VDB_VDB_FIELD_H
#define VXM_GRIDIO_FORMATS_VDB_VDB_FIELD_H

#include "grid/value_tile.h"
#include "gridio/formats/vdb/vdb.h"

typedef struct vxm_vdb_field vxm_vdb_field;

/** @return VXM_OK; VXM_ERROR_UNAVAILABLE, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_vdb_field_create(vxm_vdb_field **out, vxm_context *context, const vxm_space *space,
                                const vxm_vdb_kind *kind, vxm_error *error);
void vxm_vdb_field_destroy(vxm_vdb_field *field);

/** Allocates what slices need, at the first of them if it has not been done before. */
vxm_status vxm_vdb_field_make_room(vxm_vdb_field *field, vxm_error *error);
/** Takes the next slices begin..end-1 across x: z fastest, then y. */
vxm_status vxm_vdb_field_put(vxm_vdb_field *field, const float *values, int64_t begin, int64_t end,
                             vxm_error *error);
/**
 * Takes a tile that begins at multiples of 8 voxels, in the order of vxm_vdb_field_put, each once; from
 * several threads at once. What never comes is the background. Not for a field that takes slices.
 */
vxm_status vxm_vdb_field_put_tile(vxm_vdb_field *field, const vxm_value_tile *tile, vxm_error *error);
/** Writes the file; VXM_ERROR_IO if a write failed, of which committing the output tells the reason. */
vxm_status vxm_vdb_field_write(vxm_vdb_field *field, vxm_output *output, vxm_error *error);

#endif
