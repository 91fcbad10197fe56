/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/spanning_turns.h"

#include "mesh/geometry.h"
#include "repair/state/turned_sets.h"

#include <stdlib.h>

/** An edge between two faces. */
typedef struct joint {
  double length;
  const double *low, *high; /**< its ends: that which comes first in space, and the other */
  size_t edge;
} joint;

static int compare_points(const double *p, const double *q) {
  return vxm_lies_before(p, q) ? -1 : vxm_lies_before(q, p);
}

static int longer_first(const void *a, const void *b) {
  const joint *p = a, *q = b;
  if (p->length != q->length)
    return p->length > q->length ? -1 : 1;
  int low = compare_points(p->low, q->low), high = low ? low : compare_points(p->high, q->high);
  return high ? high : p->edge < q->edge ? -1 : p->edge > q->edge;
}

/** Lists (or, with NULL, counts) the edges between two faces of a chosen patch. */
static size_t list_joints(joint *joints, const vxm_repair_state *state, const vxm_joined_faces *joined,
                          double scale) {
  size_t count = 0;
  for (size_t e = 0; e < state->edges.count; e++) {
    const vxm_edge *edge = &state->edges.edges[e];
    const size_t *pair = joined->pair[e];
    if (edge->count != 2 || pair[0] == pair[1] || pair[1] == SIZE_MAX || joined->apart[e] ||
        !joined->chosen[joined->label[pair[0]]])
      continue;
    const double *p = vxm_position(state->soup, edge->a), *q = vxm_position(state->soup, edge->b);
    bool first = vxm_lies_before(p, q);
    if (joints)
      joints[count] =
          (joint){.length = vxm_vec3_length(vxm_vec3_between(first ? q : p, first ? p : q, scale)),
                  .low = first ? p : q,
                  .high = first ? q : p,
                  .edge = e};
    count++;
  }
  return count;
}

vxm_status vxm_spanning_turns_find(uint8_t *turn, vxm_repair_state *state, const vxm_joined_faces *joined,
                                   vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  double scale = vxm_unit_scale_of(extent.bounds).scale;
  size_t faces = state->soup->face_count, count = list_joints(NULL, state, joined, scale);
  vxm_turned_link *links = vxm_repair_state_scratch(state, faces, sizeof *links, &status, error);
  joint *joints = links ? vxm_repair_state_scratch(state, count, sizeof *joints, &status, error) : NULL;
  if (joints) {
    list_joints(joints, state, joined, scale);
    qsort(joints, count, sizeof *joints, longer_first);
    vxm_turned_sets_begin(links, faces);
  }
  for (size_t i = 0; i < count && joints && status == VXM_OK; i++) {
    const size_t *pair = joined->pair[joints[i].edge];
    vxm_turned_sets_join(links, pair[0], pair[1], state->edges.edges[joints[i].edge].forward != 1);
    status = vxm_check_cancelled_at(i, state->context, error);
  }
  for (size_t f = 0; f < faces && joints && status == VXM_OK; f++) {
    bool against = false;
    if (joined->chosen[joined->label[f]])
      vxm_turned_set_of(links, f, &against);
    turn[f] = joined->chosen[joined->label[f]] ? against : turn[f];
  }
  vxm_free(state->context, joints);
  vxm_free(state->context, links);
  return status;
}
