/* SPDX-License-Identifier: BSD-3-Clause */
/** The JSON file beside a grid file that cannot hold its transform: "x.raw.json" beside "x.raw". */
#ifndef VXM_GRIDIO_COMMON_SIDECAR_H
#define VXM_GRIDIO_COMMON_SIDECAR_H

#include "base/output.h"
#include "gridio/common/values.h"

/** What a format says of itself in its JSON. */
typedef struct vxm_sidecar_text {
  const char *format; /**< such as "voxmend raw" */
  const char *order;  /**< of the voxels */
  const char *bits;   /**< within a byte; NULL where voxels are whole bytes */
} vxm_sidecar_text;

/** For formats with x fastest whose JSON has nothing but the table of labels. */
extern const vxm_sidecar_text vxm_sidecar_labels;

/**
 * Opens the JSON beside `data_path` and fills it. *out is NULL if `data_path` is standard output, a pipe or a
 * device, which have nothing beside them.
 *
 * @param about what the values are, and the table of labels; NULL = nothing
 */
vxm_status vxm_sidecar_open(vxm_output **out, vxm_context *context, const vxm_space *space,
                            const char *data_path, const vxm_sidecar_text *text, const vxm_about *about,
                            vxm_error *error);

/** Whether there is a JSON file beside `data_path`. */
bool vxm_sidecar_exists(const char *data_path);

/**
 * Reads the JSON beside `data_path`, and checks the space in it.
 *
 * @param about takes what it says of the values; destroyed by the caller, also after a failure; NULL = that
 *              is not wanted
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT if it is not the JSON of such a format; VXM_ERROR_RANGE,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_sidecar_read(vxm_space *space, vxm_about *about, vxm_context *context, const char *data_path,
                            const char *format, vxm_error *error);

/** Removes the table of labels of a file that has been written anew, without one; any other JSON stays. */
void vxm_sidecar_remove_labels(vxm_context *context, const char *data_path);

/**
 * Reads the table of labels beside a file whose transform it has itself, unless the file says that its values
 * are not labels.
 *
 * @param space takes the space that the JSON has; the one of the file is to be compared with it
 * @return whether there is a table that can be read
 */
bool vxm_sidecar_read_labels(vxm_space *space, vxm_about *about, const vxm_input *input);
/** The same into `about`, if the JSON is of a grid of these dimensions. */
void vxm_sidecar_take_labels(vxm_about *about, const int64_t dims[3], const vxm_input *input);

#endif
