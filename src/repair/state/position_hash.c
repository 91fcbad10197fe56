/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/position_hash.h"

#include "base/hash.h"

#include <string.h>

vxm_status vxm_position_hash_open(vxm_position_hash *places, const vxm_soup *soup, size_t most,
                                  vxm_merge_rule rule, vxm_error *error) {
  size_t slots = 64;
  while (slots < 2 * most)
    slots *= 2;
  vxm_error local = VXM_ERROR_INIT;
  *places = (vxm_position_hash){.soup = soup, .rule = rule, .mask = slots - 1};
  places->slots = vxm_calloc(soup->context, slots, sizeof *places->slots, &local);
  if (!places->slots)
    vxm_error_pass(error, &local);
  return places->slots ? VXM_OK : local.code;
}

void vxm_position_hash_close(vxm_position_hash *places) {
  if (places->soup)
    vxm_free(places->soup->context, places->slots);
  *places = (vxm_position_hash){0};
}

static uint64_t hash_position(const double p[3], vxm_merge_rule rule) {
  uint64_t hash = 0;
  for (int a = 0; a < 3; a++) {
    double value = vxm_merge_place(p[a], rule);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash = vxm_hash_word(hash, bits);
  }
  return hash;
}

/** The slot of a position: that of the vertex that has it, or a free one. */
static size_t find_slot(const vxm_position_hash *places, const double p[3]) {
  const vxm_merge_rule rule = places->rule;
  size_t slot = (size_t)hash_position(p, rule) & places->mask;
  for (; places->slots[slot] != 0; slot = (slot + 1) & places->mask) {
    const double *q = vxm_position(places->soup, places->slots[slot] - 1);
    int same = 0;
    for (int a = 0; a < 3; a++)
      same += vxm_merge_place(p[a], rule) == vxm_merge_place(q[a], rule);
    if (same == 3)
      break;
  }
  return slot;
}

bool vxm_position_hash_taken(const vxm_position_hash *places, const double p[3]) {
  return places->slots[find_slot(places, p)] != 0;
}

uint32_t vxm_position_hash_find(const vxm_position_hash *places, const double p[3]) {
  uint32_t slot = places->slots[find_slot(places, p)];
  return slot != 0 ? slot - 1 : VXM_NO_VERTEX;
}

void vxm_position_hash_add(vxm_position_hash *places, uint32_t vertex) {
  places->slots[find_slot(places, vxm_position(places->soup, vertex))] = vertex + 1;
}
