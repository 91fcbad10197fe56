/* SPDX-License-Identifier: BSD-3-Clause */
/** What follows in a file is the build for any processor (base/cpu.h). */
#define VXM_USE_AVX2 0
#define VXM_USE_AVX512 0
#define BUILD(name) name##_plain
#define BUILD_LEVEL VXM_CPU_PLAIN

#if defined(__SSE2__)
#include <immintrin.h>
#endif
