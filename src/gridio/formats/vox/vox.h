/* SPDX-License-Identifier: BSD-3-Clause */
/** MagicaVoxel's .vox: how it is read, and what voxmend writes into it beside what the format has. */
#ifndef VXM_GRIDIO_FORMATS_VOX_VOX_H
#define VXM_GRIDIO_FORMATS_VOX_VOX_H

#include "gridio/common/values.h"

/* Attributes of the root: "bits", "labels" or "colors"; three numbers each; the name of a label, by its
 * number. */
#define VXM_VOX_VALUES_KEY "voxmend_values"
#define VXM_VOX_ORIGIN_KEY "voxmend_origin"
#define VXM_VOX_SIZE_KEY "voxmend_voxel_size"
#define VXM_VOX_LABEL_KEY "voxmend_label_"

bool vxm_vox_sniff(const vxm_input *input);
/** Voxels of one colour are bits; several are VXM_ERROR_NUMBERS. As `read` of a vxm_grid_format. */
vxm_status vxm_vox_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
/** Colours, or the labels that voxmend wrote. As `read_field`. */
vxm_status vxm_vox_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);

#endif
