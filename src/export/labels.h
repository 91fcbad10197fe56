/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of a label per voxel, each with its table of labels in it or beside it. */
#ifndef VXM_EXPORT_LABELS_H
#define VXM_EXPORT_LABELS_H

#include "voxel/labels/labels.h"

/**
 * Makes the labels of a model into a file.
 *
 * @return as vxm_model_write_labels in voxmend.h; the options have been checked
 */
vxm_status vxm_labels_write(vxm_label_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_label_options *options, vxm_error *error);

#endif
