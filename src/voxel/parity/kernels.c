/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/kernels.h"
#include "base/cpu.h"

extern const vxm_kernels vxm_kernels_plain, vxm_kernels_avx2, vxm_kernels_avx512;

static _Atomic(const vxm_kernels *) forced;

size_t vxm_kernels_all(const vxm_kernels *out[4]) {
  size_t count = 0;
  out[count++] = &vxm_kernels_plain;
#if VXM_KERNELS_X86
  if (vxm_cpu_has_avx2())
    out[count++] = &vxm_kernels_avx2;
  if (vxm_cpu_has_avx512())
    out[count++] = &vxm_kernels_avx512;
#endif
  return count;
}

void vxm_kernels_force(const vxm_kernels *kernels) {
  atomic_store_explicit(&forced, kernels, memory_order_relaxed);
}

const vxm_kernels *vxm_kernels_get(void) {
  const vxm_kernels *kernels = atomic_load_explicit(&forced, memory_order_relaxed), *all[4];
  return kernels ? kernels : all[vxm_kernels_all(all) - 1];
}
