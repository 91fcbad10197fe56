/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/kernels.h"

extern const vxm_kernels vxm_kernels_plain, vxm_kernels_avx2, vxm_kernels_avx512;

static const vxm_kernels *const builds[] = VXM_CPU_BUILDS(vxm_kernels);

static _Atomic(const vxm_kernels *) forced;

size_t vxm_kernels_all(const vxm_kernels *out[3]) {
  size_t count = (size_t)vxm_cpu_used() + 1;
  for (size_t i = 0; i < count; i++)
    out[i] = builds[i];
  return count;
}

void vxm_kernels_force(const vxm_kernels *kernels) {
  atomic_store_explicit(&forced, kernels, memory_order_relaxed);
}

const vxm_kernels *vxm_kernels_get(void) {
  const vxm_kernels *kernels = atomic_load_explicit(&forced, memory_order_relaxed);
  return kernels ? kernels : builds[vxm_cpu_used()];
}
