/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of winding numbers for x86 processors with AVX2. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define VXM_USE_AVX2 1
#define VXM_USE_AVX512 0
#define BUILD(name) name##_avx2
#include "voxel/winding/winding_walk_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
