/* SPDX-License-Identifier: BSD-3-Clause */
/** The kernels of the sieve for any processor. */
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define VXM_USE_AVX2 0
#define VXM_USE_AVX512 0
#define BUILD(name) name##_plain
#include "voxel/thin/sieve_kernels_body.inc"
