/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of the sieve for any processor. */
#include "base/build_plain.h"

#include "voxel/thin/sieve_kernels_body.inc"
