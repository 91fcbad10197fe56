/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/voxel_set.h"

/** The slot that a voxel has, or would have; the table has a free one. */
static size_t slot_of(const vxm_voxel_set *set, uint64_t voxel) {
  size_t slot = (size_t)(voxel * UINT64_C(0x9e3779b97f4a7c15) >> 20) & (set->size - 1);
  while (set->slots[slot] && set->slots[slot] != voxel + 1)
    slot = (slot + 1) & (set->size - 1);
  return slot;
}

bool vxm_voxel_set_has(const vxm_voxel_set *set, uint64_t voxel) {
  return set->size > 0 && set->slots[slot_of(set, voxel)] != 0;
}

static vxm_status grow(vxm_voxel_set *set, vxm_error *error) {
  const size_t least = 1024;
  vxm_voxel_set larger = {
      .context = set->context, .size = set->size ? 2 * set->size : least, .count = set->count};
  vxm_status status = VXM_OK;
  larger.slots = vxm_try_calloc(set->context, larger.size, sizeof *larger.slots, &status, error);
  if (!larger.slots)
    return status;
  for (size_t s = 0; s < set->size; s++)
    if (set->slots[s])
      larger.slots[slot_of(&larger, set->slots[s] - 1)] = set->slots[s];
  vxm_free(set->context, set->slots);
  *set = larger;
  return VXM_OK;
}

vxm_status vxm_voxel_set_add(vxm_voxel_set *set, uint64_t voxel, vxm_error *error) {
  vxm_status status = 2 * (set->count + 1) > set->size ? grow(set, error) : VXM_OK;
  if (status != VXM_OK)
    return status;
  size_t slot = slot_of(set, voxel);
  set->count += set->slots[slot] == 0;
  set->slots[slot] = voxel + 1;
  return VXM_OK;
}

void vxm_voxel_set_destroy(vxm_voxel_set *set) {
  vxm_free(set->context, set->slots);
  *set = (vxm_voxel_set){.context = set->context};
}
