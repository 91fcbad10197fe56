/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/band_tile.h"
#include "base/cpu.h"

extern const vxm_band_kernels vxm_band_kernels_plain, vxm_band_kernels_avx2, vxm_band_kernels_avx512;

size_t vxm_band_kernels_all(const vxm_band_kernels *out[3]) {
  size_t count = 0;
  out[count++] = &vxm_band_kernels_plain;
#if VXM_KERNELS_X86
  if (vxm_cpu_has_avx2())
    out[count++] = &vxm_band_kernels_avx2;
  if (vxm_cpu_has_avx512())
    out[count++] = &vxm_band_kernels_avx512;
#endif
  return count;
}

const vxm_band_kernels *vxm_band_kernels_best(void) {
  const vxm_band_kernels *all[3];
  return all[vxm_band_kernels_all(all) - 1];
}
