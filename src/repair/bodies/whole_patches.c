/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/whole_patches.h"

#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "mesh/unit_scale.h"

#include <stdlib.h>

/** A side along an edge that has more than two. */
typedef struct side {
  size_t edge, patch;
  int turn; /**< 1 if it runs along the edge, -1 if the other way */
} side;

static int by_edge_then_patch(const void *a, const void *b) {
  const side *s = a, *t = b;
  return vxm_compare_pairs(s->edge, s->patch, t->edge, t->patch);
}

/** Lists those of groups in doubt; without a list only counts them. */
static size_t list_sides(const vxm_layers *l, const uint8_t *doubted, side *sides) {
  const vxm_soup *soup = l->state->soup;
  const vxm_edge *edges = l->state->edges.edges;
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && doubted[l->groups->of_face[f]]; c++) {
      size_t e = l->groups->sides[c];
      if (e == VXM_NO_EDGE || edges[e].count == 2)
        continue;
      if (sides)
        sides[count] = (side){e, vxm_set_of(l->patch, f), soup->indices[c] == edges[e].a ? 1 : -1};
      count++;
    }
  return count;
}

static vxm_status look_at_patches(uint8_t *whole, const vxm_layers *l, const uint8_t *doubted,
                                  vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = list_sides(l, doubted, NULL), faces = l->state->soup->face_count;
  side *sides = vxm_repair_state_scratch(l->state, count, sizeof *sides, &status, error);
  if (!sides)
    return status;
  list_sides(l, doubted, sides);
  for (size_t f = 0; f < faces; f++)
    whole[f] = doubted[l->groups->of_face[f]];
  for (size_t f = 0; f < faces; f++)
    if (l->copies[f].same + l->copies[f].opposite > 1)
      whole[vxm_set_of(l->patch, f)] = 0;
  qsort(sides, count, sizeof *sides, by_edge_then_patch);
  for (size_t i = 0, j; i < count; i = j) {
    int sum = 0;
    for (j = i; j < count && by_edge_then_patch(&sides[i], &sides[j]) == 0; j++)
      sum += sides[j].turn;
    whole[sides[i].patch] &= sum == 0;
  }
  vxm_free(l->state->context, sides);
  return VXM_OK;
}

/** Adds up the volumes of patches, about the middle of the mesh. */
static void add_volumes(const vxm_layers *l, double *volume) {
  const vxm_soup *soup = l->state->soup;
  vxm_extent extent;
  vxm_repair_state_extent(l->state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  for (size_t f = 0; f < soup->face_count; f++)
    if (l->asked[l->groups->of_face[f]])
      volume[vxm_set_of(l->patch, f)] += vxm_face_cone(NULL, soup, f, frame.centre, frame.scale);
}

/** Groups that have failed, have a patch that is cut through, or patches of which some are wound inward and
 * others are not. */
static bool find_doubted(uint8_t *doubted, const uint8_t *failed, const vxm_layers *l, double *volume) {
  enum { OUTWARD = 2, INWARD = 4 };
  bool any = false;
  add_volumes(l, volume);
  for (size_t f = 0; f < l->state->soup->face_count; f++) {
    size_t group = l->groups->of_face[f], patch = vxm_set_of(l->patch, f);
    if (l->asked[group])
      doubted[group] |= volume[patch] < 0 ? INWARD : volume[patch] > 0 ? OUTWARD : 0;
    doubted[group] |= failed[group] || (l->asked[group] && l->cut[patch]);
  }
  for (size_t g = 0; g < l->groups->count; g++) {
    doubted[g] = doubted[g] & 1 || doubted[g] == (OUTWARD | INWARD);
    any |= doubted[g];
  }
  return any;
}

vxm_status vxm_whole_patches_find(uint8_t *whole, uint8_t *failed, const vxm_layers *layers,
                                  vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *doubted =
      vxm_repair_state_scratch(layers->state, layers->groups->count, sizeof *doubted, &status, error);
  double *volume = doubted ? vxm_repair_state_scratch(layers->state, layers->state->soup->face_count,
                                                      sizeof *volume, &status, error)
                           : NULL;
  if (volume && find_doubted(doubted, failed, layers, volume)) {
    status = look_at_patches(whole, layers, doubted, error);
    for (size_t f = 0; status == VXM_OK && f < layers->state->soup->face_count; f++)
      doubted[layers->groups->of_face[f]] &= whole[vxm_set_of(layers->patch, f)];
    for (size_t g = 0; status == VXM_OK && g < layers->groups->count; g++)
      failed[g] |= doubted[g];
  }
  vxm_free(layers->state->context, volume);
  vxm_free(layers->state->context, doubted);
  return status;
}
