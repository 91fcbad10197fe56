/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of winding numbers for any processor. */
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define VXM_USE_AVX2 0
#define VXM_USE_AVX512 0
#define BUILD(name) name##_plain
#include "voxel/winding/winding_walk_body.inc"
