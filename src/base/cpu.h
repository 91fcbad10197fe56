/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Builds of one source for several processors. A file begins each with base/build_plain.h, build_avx2.h or
 * build_avx512.h, after which BUILD(name) is a name with the build's ending and BUILD_LEVEL its level, and
 * ends the last two with base/build_end.h. At run time vxm_cpu_used() says which to take: the best whose
 * instructions the processor has and which is not above the limit of the process (voxmend/experimental.h).
 */
#ifndef VXM_BASE_CPU_H
#define VXM_BASE_CPU_H

#include "voxmend/experimental.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define VXM_KERNELS_X86 1
#else
#define VXM_KERNELS_X86 0
#endif

/** The builds of a table or function, from an array by level: VXM_CPU_BUILDS(vxm_kernels) lists those of
 * vxm_kernels_plain, and so on. */
#if VXM_KERNELS_X86
#define VXM_CPU_BUILDS(name) \
  { &name##_plain, &name##_avx2, &name##_avx512 }
#else
#define VXM_CPU_BUILDS(name) \
  { &name##_plain }
#endif

/** "plain", "avx2" or "avx512". */
const char *vxm_cpu_level_name(vxm_cpu_level level);

/** Whether the builds for AVX2 may run. */
static inline bool vxm_cpu_has_avx2(void) {
  return vxm_cpu_used() >= VXM_CPU_AVX2;
}

/** Whether the builds for AVX-512 may run. */
static inline bool vxm_cpu_has_avx512(void) {
  return vxm_cpu_used() >= VXM_CPU_AVX512;
}

#endif
