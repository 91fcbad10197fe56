/* SPDX-License-Identifier: BSD-3-Clause */
/** The JSON file beside a grid file that cannot hold its transform: "x.raw.json" beside "x.raw". */
#ifndef VXM_GRIDIO_SIDECAR_H
#define VXM_GRIDIO_SIDECAR_H

#include "base/output.h"
#include "grid/bitgrid.h"
#include "voxel/labelling.h"

/** What a format says of itself in its JSON. */
typedef struct vxm_sidecar_text {
  const char *format; /**< such as "voxmend raw" */
  const char *order;  /**< of the voxels */
  const char *bits;   /**< within a byte; NULL where voxels are whole bytes */
} vxm_sidecar_text;

/**
 * Opens the JSON beside `data_path` and fills it. *out is NULL if `data_path` is standard output, a pipe or a
 * device, which have nothing beside them.
 */
vxm_status vxm_sidecar_open(vxm_output **out, vxm_context *context, const vxm_space *space,
                            const char *data_path, const vxm_sidecar_text *text, vxm_error *error);

/** The same with a table of labels. */
vxm_status vxm_sidecar_open_labels(vxm_output **out, vxm_context *context, const vxm_space *space,
                                   const char *data_path, const vxm_sidecar_text *text,
                                   const vxm_label_table *labels, vxm_error *error);

/** Whether there is a JSON file beside `data_path`. */
bool vxm_sidecar_exists(const char *data_path);

/**
 * Reads the JSON beside `data_path`, and checks the space in it.
 *
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT if it is not the JSON of such a format; VXM_ERROR_RANGE,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_sidecar_read(vxm_space *space, vxm_context *context, const char *data_path, const char *format,
                            vxm_error *error);

#endif
