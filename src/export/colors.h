/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of a colour per voxel: .npy, .ply and .vox. */
#ifndef VXM_EXPORT_COLORS_H
#define VXM_EXPORT_COLORS_H

#include "base/output.h"
#include "gridio/common/values.h"
#include "voxel/labels/color.h"

/** Colours to write: [x][y][z][4] in C order, the fourth 0 where there is no voxel. */
typedef struct vxm_colored {
  vxm_context *context;
  const vxm_space *space;
  const uint8_t *values;
} vxm_colored;

/** Makes the colours of a model into a file. @return as vxm_model_write_colors in voxmend.h; the options have
 * been checked */
vxm_status vxm_colors_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_color_options *options, vxm_error *error);

/** Writes colours into a file: .npy, .ply or .vox. @param about goes along into .npy; NULL = nothing */
vxm_status vxm_colored_write(const vxm_colored *colored, const vxm_about *about, const char *path,
                             const char *format, vxm_error *error);

/** Writes MagicaVoxel's format (vox.c). @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_vox_write(vxm_output *output, const vxm_colored *colored, vxm_error *error);

/** The colour of a voxel, or NULL outside the grid. */
static inline const uint8_t *vxm_colored_at(const vxm_colored *c, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = c->space->dims;
  if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2])
    return NULL;
  return c->values + 4 * (size_t)((i * dims[1] + j) * dims[2] + k);
}

#endif
