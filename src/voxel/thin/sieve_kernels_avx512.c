/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of the sieve for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include "base/build_avx512.h"

#include "voxel/thin/sieve_kernels_body.inc"

#include "base/build_end.h"
#endif
