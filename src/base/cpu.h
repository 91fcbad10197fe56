/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether the builds for particular x86 processors are there, and may run on this one. */
#ifndef VXM_BASE_CPU_H
#define VXM_BASE_CPU_H

#include <stdbool.h>

#if defined(__x86_64__) && defined(__GNUC__)
#define VXM_KERNELS_X86 1
#else
#define VXM_KERNELS_X86 0
#endif

/** Whether the builds for AVX2 may run. */
static inline bool vxm_cpu_has_avx2(void) {
#if VXM_KERNELS_X86
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

/** Whether the builds for AVX-512 may run. */
static inline bool vxm_cpu_has_avx512(void) {
#if VXM_KERNELS_X86
  return vxm_cpu_has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

#endif
