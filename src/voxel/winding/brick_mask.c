/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/brick_mask.h"

#include <string.h>

static size_t cells_of(const int64_t count[3]) {
  return (size_t)(count[0] * count[1] * count[2]);
}

vxm_status vxm_brick_mask_begin(vxm_brick_mask *mask, const int64_t begin[3], const int64_t end[3],
                                int levels, vxm_error *error) {
  size_t total = 0;
  mask->levels = levels;
  for (int l = 0; l < levels; l++) {
    for (int a = 0; a < 3; a++) {
      mask->first[l][a] = begin[a] >> (l + 2);
      mask->count[l][a] = ((end[a] - 1) >> (l + 2)) - mask->first[l][a] + 1;
    }
    total += cells_of(mask->count[l]);
  }
  vxm_status status = vxm_renew(mask->context, (void **)&mask->cells[0], &mask->capacity, total, 1, error);
  if (status != VXM_OK)
    return status;
  for (int l = 1; l < mask->levels; l++)
    mask->cells[l] = mask->cells[l - 1] + cells_of(mask->count[l - 1]);
  memset(mask->cells[0], 0, total);
  return VXM_OK;
}

bool vxm_brick_mask_raise(vxm_brick_mask *mask) {
  for (int l = 0; l + 1 < mask->levels; l++) {
    const uint8_t *cell = mask->cells[l];
    int64_t at[3];
    for (int64_t z = 0; z < mask->count[l][2]; z++)
      for (int64_t y = 0; y < mask->count[l][1]; y++)
        for (int64_t x = 0; x < mask->count[l][0]; x++, cell++)
          if (*cell) {
            at[0] = (mask->first[l][0] + x) << (l + 2);
            at[1] = (mask->first[l][1] + y) << (l + 2);
            at[2] = (mask->first[l][2] + z) << (l + 2);
            *vxm_brick_mask_at(mask, at, l + 1) = 1;
          }
  }
  return mask->cells[mask->levels - 1][0] != 0; /* which is one cell */
}

void vxm_brick_mask_destroy(vxm_brick_mask *mask) {
  vxm_free(mask->context, mask->cells[0]);
  *mask = (vxm_brick_mask){.context = mask->context};
}
