/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons into triangles, where polygons will not do. */
#ifndef VXM_REPAIR_SPLIT_H
#define VXM_REPAIR_SPLIT_H

#include "repair/work.h"

/** Splits polygons of more than three corners; with `touching` only those with a corner that comes twice. */
vxm_status vxm_split_polygons(vxm_work *work, bool touching, vxm_error *error);

#endif
