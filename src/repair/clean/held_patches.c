/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/held_patches.h"
#include "mesh/sort.h"

#include <stdlib.h>

/** A side along an edge with an even number of sides, four or more. */
typedef struct crossing {
  size_t edge;
  uint32_t patch;
  int along; /**< 1 upward, -1 downward */
} crossing;

static int by_edge_then_patch(const void *a, const void *b) {
  const crossing *p = a, *q = b;
  return vxm_compare_pairs(p->edge, p->patch, q->edge, q->patch);
}

/** Lists (or, with NULL, counts) the sides at crossings, as the faces are turned by now. */
static vxm_status list_crossings(crossing *crossings, size_t *out, const vxm_repair_state *state,
                                 const uint32_t *label, const uint8_t *turn, vxm_error *error) {
  const vxm_edges *edges = &state->edges;
  size_t listed = 0;
  for (size_t f = 0; f < state->soup->face_count; f++) {
    vxm_status status = vxm_check_cancelled_at(f, state->context, error);
    if (status != VXM_OK)
      return status;
    size_t count;
    const uint32_t *corner = vxm_face(state->soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      size_t e = edges->sides[state->soup->offsets[f] + (turn[f] ? count - 1 - i : i)];
      if (e == VXM_NO_EDGE || edges->edges[e].count < 4 || vxm_edge_is_odd(&edges->edges[e]))
        continue;
      int along = corner[i] < corner[i + 1 < count ? i + 1 : 0] ? 1 : -1;
      if (crossings)
        crossings[listed] = (crossing){e, label[f], along};
      listed++;
    }
  }
  *out = listed;
  return VXM_OK;
}

/** Marks the patches that are out of balance about an edge by themselves, but in balance together. */
static void mark_held(const crossing *crossings, size_t count, uint8_t *held) {
  for (size_t i = 0, j; i < count; i = j) {
    int balance = 0;
    for (j = i; j < count && crossings[j].edge == crossings[i].edge; j++)
      balance += crossings[j].along;
    for (size_t k = i, next; k < j && balance == 0; k = next) {
      int own = 0;
      for (next = k; next < j && crossings[next].patch == crossings[k].patch; next++)
        own += crossings[next].along;
      held[crossings[k].patch] |= own != 0;
    }
  }
}

vxm_status vxm_held_patches_find(uint8_t *held, vxm_repair_state *state, const uint32_t *label,
                                 const uint8_t *turn, vxm_error *error) {
  size_t count = 0;
  if (state->edges.crowded == 0)
    return VXM_OK;
  vxm_status status = list_crossings(NULL, &count, state, label, turn, error);
  crossing *crossings = NULL;
  if (status == VXM_OK && count > 0)
    crossings = vxm_repair_state_scratch(state, count, sizeof *crossings, &status, error);
  if (crossings)
    status = list_crossings(crossings, &count, state, label, turn, error);
  if (crossings && status == VXM_OK) {
    qsort(crossings, count, sizeof *crossings, by_edge_then_patch);
    mark_held(crossings, count, held);
  }
  vxm_free(state->context, crossings);
  return status;
}
