/* SPDX-License-Identifier: BSD-3-Clause */
/** Minecraft's .schem and .litematic in: the content tells which it is. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_READ_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_READ_H

#include "gridio/common/values.h"

/** Blocks of one kind are bits; several are VXM_ERROR_NUMBERS. As `read` of a vxm_grid_format. */
vxm_status vxm_block_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
/** A label for each kind of block, with its name; or what voxmend wrote. As `read_field`. */
vxm_status vxm_block_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);

#endif
