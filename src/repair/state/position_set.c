/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/position_set.h"

#include "base/hash.h"

#include <string.h>

vxm_status vxm_position_set_open(vxm_position_set *set, const vxm_soup *soup, size_t most,
                                 vxm_merge_rule rule, vxm_error *error) {
  size_t slots = 64;
  while (slots < 2 * most)
    slots *= 2;
  vxm_error local = VXM_ERROR_INIT;
  *set = (vxm_position_set){.soup = soup, .rule = rule, .mask = slots - 1};
  set->slots = vxm_calloc(soup->context, slots, sizeof *set->slots, &local);
  if (!set->slots)
    vxm_error_pass(error, &local);
  return set->slots ? VXM_OK : local.code;
}

void vxm_position_set_close(vxm_position_set *set) {
  if (set->soup)
    vxm_free(set->soup->context, set->slots);
  *set = (vxm_position_set){0};
}

static uint64_t hash_position(const double p[3], vxm_merge_rule rule) {
  uint64_t hash = 0;
  for (int a = 0; a < 3; a++) {
    double value = vxm_merge_coordinate(p[a], rule);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash = vxm_hash_word(hash, bits);
  }
  return hash;
}

/** The slot of a position: that of the vertex that has it, or a free one. */
static size_t find_slot(const vxm_position_set *set, const double p[3]) {
  const vxm_merge_rule rule = set->rule;
  size_t slot = (size_t)hash_position(p, rule) & set->mask;
  for (; set->slots[slot] != 0; slot = (slot + 1) & set->mask) {
    const double *q = vxm_position(set->soup, set->slots[slot] - 1);
    int same = 0;
    for (int a = 0; a < 3; a++)
      same += vxm_merge_coordinate(p[a], rule) == vxm_merge_coordinate(q[a], rule);
    if (same == 3)
      break;
  }
  return slot;
}

bool vxm_position_set_taken(const vxm_position_set *set, const double p[3]) {
  return set->slots[find_slot(set, p)] != 0;
}

uint32_t vxm_position_set_find(const vxm_position_set *set, const double p[3]) {
  uint32_t slot = set->slots[find_slot(set, p)];
  return slot != 0 ? slot - 1 : VXM_NO_VERTEX;
}

void vxm_position_set_add(vxm_position_set *set, uint32_t vertex) {
  set->slots[find_slot(set, vxm_position(set->soup, vertex))] = vertex + 1;
}
