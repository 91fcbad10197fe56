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

/** Whether eight cells, or the last ones, are all 0. */
static bool are_clear(const uint8_t *cell, int64_t count) {
  uint64_t any = 0;
  if (count >= 8) /* so that copying takes no call */
    memcpy(&any, cell, 8);
  else
    memcpy(&any, cell, (size_t)count);
  return any == 0;
}

bool vxm_brick_mask_raise(vxm_brick_mask *mask) {
  for (int l = 0; l + 1 < mask->levels; l++) {
    const int64_t *first = mask->first[l], *count = mask->count[l], *above = mask->count[l + 1];
    const uint8_t *cell = mask->cells[l];
    for (int64_t z = 0; z < count[2]; z++)
      for (int64_t y = 0; y < count[1]; y++, cell += count[0]) {
        int64_t row = ((first[2] + z) / 2 - first[2] / 2) * above[1] + (first[1] + y) / 2 - first[1] / 2;
        uint8_t *to = mask->cells[l + 1] + row * above[0];
        for (int64_t x = 0; x < count[0];)
          if (are_clear(cell + x, count[0] - x))
            x += 8;
          else
            for (int64_t end = x + 8 < count[0] ? x + 8 : count[0]; x < end; x++)
              to[(first[0] + x) / 2 - first[0] / 2] |= cell[x];
      }
  }
  return mask->cells[mask->levels - 1][0] != 0; /* which is one cell */
}

void vxm_brick_mask_destroy(vxm_brick_mask *mask) {
  vxm_free(mask->context, mask->cells[0]);
  *mask = (vxm_brick_mask){.context = mask->context};
}
