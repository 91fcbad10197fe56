/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/sieve_kernels.h"

extern const vxm_sieve_kernels vxm_sieve_kernels_plain, vxm_sieve_kernels_avx2, vxm_sieve_kernels_avx512;

const vxm_sieve_kernels *vxm_sieve_kernels_of(const vxm_kernels *kernels) {
  static const vxm_sieve_kernels *const builds[] = VXM_CPU_BUILDS(vxm_sieve_kernels);
  return builds[(kernels ? kernels : vxm_kernels_get())->level];
}
