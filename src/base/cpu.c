/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/cpu.h"
#include "base/error.h"

#include <stdatomic.h>

static atomic_int limit = VXM_CPU_AVX512;

const char *vxm_cpu_level_name(vxm_cpu_level level) {
  static const char *const names[] = {"plain", "avx2", "avx512"};
  return names[level];
}

vxm_cpu_level vxm_cpu_highest(void) {
#if VXM_KERNELS_X86
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma"))
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                   __builtin_cpu_supports("avx512vl")
               ? VXM_CPU_AVX512
               : VXM_CPU_AVX2;
#endif
  return VXM_CPU_PLAIN;
}

vxm_cpu_level vxm_cpu_used(void) {
  int most = atomic_load_explicit(&limit, memory_order_relaxed), highest = (int)vxm_cpu_highest();
  return (vxm_cpu_level)(highest < most ? highest : most);
}

vxm_status vxm_cpu_limit(vxm_cpu_level level, vxm_error *error) {
  int wanted = (int)level, highest = (int)vxm_cpu_highest();
  if (wanted < VXM_CPU_PLAIN || wanted > VXM_CPU_AVX512)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%d is no level of processors", wanted);
  if (wanted > highest)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "this processor has no %s, only %s",
                    vxm_cpu_level_name(level), vxm_cpu_level_name(vxm_cpu_highest()));
  atomic_store_explicit(&limit, wanted, memory_order_relaxed);
  return VXM_OK;
}
