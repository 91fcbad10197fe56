/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/sieve_kernels.h"

#include "base/cpu.h"

#include <string.h>

extern const vxm_sieve_kernels vxm_sieve_kernels_plain, vxm_sieve_kernels_avx2, vxm_sieve_kernels_avx512;

const vxm_sieve_kernels *vxm_sieve_kernels_of(const vxm_kernels *kernels) {
  const char *name = (kernels ? kernels : vxm_kernels_get())->name;
#if VXM_KERNELS_X86
  if (strcmp(name, "avx512") == 0)
    return &vxm_sieve_kernels_avx512;
  if (strcmp(name, "avx2") == 0)
    return &vxm_sieve_kernels_avx2;
#endif
  (void)name;
  return &vxm_sieve_kernels_plain;
}
