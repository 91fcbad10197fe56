/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of winding numbers for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#define VXM_TARGET "avx512f,avx512cd,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt"
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target(VXM_TARGET))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512cd,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define VXM_USE_AVX2 1
#define VXM_USE_AVX512 1
#define BUILD(name) name##_avx512
#include "voxel/winding/winding_walk_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
