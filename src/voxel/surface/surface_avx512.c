/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include "base/build_avx512.h"

#define LANES 8
#include "voxel/surface/surface_i64.inc"

#include "base/build_end.h"
#endif
