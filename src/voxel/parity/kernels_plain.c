/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels for any processor. */
#include "base/build_plain.h"

#include "voxel/parity/kernels_body.inc"
