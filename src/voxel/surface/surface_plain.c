/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing for any processor. */
#include "base/build_plain.h"

#define LANES 2
#include "voxel/surface/surface_i64.inc"
