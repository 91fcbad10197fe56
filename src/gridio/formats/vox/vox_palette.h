/* SPDX-License-Identifier: BSD-3-Clause */
/** The up to 255 colours of a .vox file. */
#ifndef VXM_GRIDIO_FORMATS_VOX_VOX_PALETTE_H
#define VXM_GRIDIO_FORMATS_VOX_VOX_PALETTE_H

#include "gridio/common/values.h"

enum { VXM_VOX_COLORS = 255 /**< number 0 stands for no voxel */ };

typedef struct vxm_vox_palette {
  vxm_context *context;
  uint64_t *count;    /**< voxels of each bin of colours */
  uint64_t (*sum)[3]; /**< of their colours */
  uint8_t *number;    /**< of each bin: 1 to VXM_VOX_COLORS */
  uint8_t color[VXM_VOX_COLORS][3];
  int size;
} vxm_vox_palette;

/** Chooses the colours for those of a field. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_vox_palette_of_colors(vxm_vox_palette *out, const vxm_field *field, vxm_error *error);
void vxm_vox_palette_destroy(vxm_vox_palette *palette);
/** The number of the colour of a voxel; 0 where there is none. */
uint8_t vxm_vox_palette_number(const vxm_vox_palette *palette, const uint8_t rgba[4]);

#endif
