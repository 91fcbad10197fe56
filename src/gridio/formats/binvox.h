/* SPDX-License-Identifier: BSD-3-Clause */
/** .binvox: what the files of bits and those of labels share. */
#ifndef VXM_GRIDIO_FORMATS_BINVOX_H
#define VXM_GRIDIO_FORMATS_BINVOX_H

#include "base/output.h"
#include "gridio/common/values_writer.h"

/** The side of the cube that a space is padded to. */
uint64_t vxm_binvox_side(const vxm_space *space);
/** Refuses voxels that are not cubes, and a cube far larger than the grid. */
vxm_status vxm_binvox_check(const vxm_space *space, const char *path, vxm_error *error);
/** What a file has at least, without the header: two bytes for 255 voxels. */
uint64_t vxm_binvox_bytes(const vxm_space *space);
/** @param version 1, or 2 where values are labels */
void vxm_binvox_header_write(vxm_output *output, const vxm_space *space, int version);
/** Writes a slice across x of labels up to 255, y fastest, then z, and its padding to a side of the cube. */
void vxm_binvox_put_slice(vxm_output *output, const vxm_space *space, const uint16_t *values);
/** Writes the padding behind the last slice. */
void vxm_binvox_put_end(vxm_output *output, const vxm_space *space);

/** Labels (binvox_labels.c), which are put as VXM_UINT16. */
extern const vxm_values_writer_kind vxm_binvox_labels;
/** Refuses what is not a label up to 255. */
vxm_status vxm_binvox_check_field(const vxm_field *field, const char *path, vxm_error *error);

#endif
