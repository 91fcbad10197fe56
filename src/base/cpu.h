/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether the builds for particular x86 processors are there, and may run on this one: it has the
 * instructions, and they are not above the limit of the process (voxmend/experimental.h). */
#ifndef VXM_BASE_CPU_H
#define VXM_BASE_CPU_H

#include "voxmend/experimental.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define VXM_KERNELS_X86 1
#else
#define VXM_KERNELS_X86 0
#endif

/** Whether the builds for AVX2 may run. */
static inline bool vxm_cpu_has_avx2(void) {
  return vxm_cpu_used() >= VXM_CPU_AVX2;
}

/** Whether the builds for AVX-512 may run. */
static inline bool vxm_cpu_has_avx512(void) {
  return vxm_cpu_used() >= VXM_CPU_AVX512;
}

#endif
