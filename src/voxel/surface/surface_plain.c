/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing for any processor. */
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define LANES 2
#define BUILD(name) name##_plain
#define BUILD_NAME "plain"
#include "voxel/surface/surface_i64.inc"
