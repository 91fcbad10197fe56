/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage_values.h"

#include <string.h>

vxm_coverage_values vxm_coverage_values_of(int n, vxm_scalar scalar) {
  vxm_coverage_values values = {.n = n, .scalar = scalar};
  int most = n * n * n;
  for (int count = 0; count <= most; count++) {
    values.fractions[count] = (float)count / (float)most;
    values.bytes[count] = (uint8_t)((2 * 255 * count + most) / (2 * most));
  }
  return values;
}

/** Four at a time, which gcc 12 does not do by itself. */
static void fill_floats(float *out, size_t some, float value) {
  typedef float four __attribute__((vector_size(16), aligned(4), may_alias));
  const four all = {value, value, value, value};
  size_t i = 0;
  for (; i + 4 <= some; i += 4)
    *(four *)(void *)(out + i) = all;
  for (; i < some; i++)
    out[i] = value;
}

void vxm_coverage_store_run(const vxm_coverage_values *values, size_t at, size_t some, unsigned count,
                            vxm_coverage_tally *tally) {
  unsigned n = (unsigned)values->n, most = n * n * n;
  if (values->scalar == VXM_UINT8)
    memset(values->out + at, values->bytes[count], some);
  else if (count == 0)
    memset((float *)(void *)values->out + at, 0, some * sizeof(float));
  else
    fill_floats((float *)(void *)values->out + at, some, values->fractions[count]);
  tally->subvoxels += (int64_t)(some * count);
  tally->full += count == most ? (int64_t)some : 0;
  tally->partial += count > 0 && count < most ? (int64_t)some : 0;
}
