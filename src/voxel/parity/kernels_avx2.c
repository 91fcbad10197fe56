/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels for x86 processors with AVX2. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include "base/build_avx2.h"

#include "voxel/parity/kernels_body.inc"

#include "base/build_end.h"
#endif
