/* SPDX-License-Identifier: BSD-3-Clause */
/** Rows of distances for any processor. */
#define LANES 2
#define BUILD(name) name##_plain
#include "voxel/triangle_row.inc"
