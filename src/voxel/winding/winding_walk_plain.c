/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of winding numbers for any processor. */
#include "base/build_plain.h"

#include "voxel/winding/winding_walk_body.inc"
