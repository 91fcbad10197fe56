/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels for any processor. */
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define VXM_USE_AVX2 0
#define VXM_USE_AVX512 0
#define BUILD(name) name##_plain
#define BUILD_NAME "plain"
#include "voxel/parity/kernels_body.inc"
