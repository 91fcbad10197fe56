/* SPDX-License-Identifier: BSD-3-Clause */
/** Rows of distances for x86 processors with AVX2. */
#include "voxel/kernels_x86.h"

#if VXM_KERNELS_X86
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 4
#define BUILD(name) name##_avx2
#include "voxel/triangle_row.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
