/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/outer_sides.h"

#include "mesh/geometry.h"
#include "repair/clean/face_place.h"
#include "repair/state/turned_sets.h"

/** An edge, as the faces that count have it. */
typedef struct meeting {
  size_t face; /**< the first one there */
  bool forward;
  uint8_t count; /**< 3 = three or more */
} meeting;

typedef struct patch {
  double volume; /**< as the face that stands for it is turned */
  double sizes;  /**< of its cones, whatever their signs */
  size_t first;  /**< the face that comes first in space, plus 1 */
} patch;

/** Of all cones: what is less is no volume. */
static const double no_volume = 1e-9;

typedef struct turning {
  const vxm_repair_state *state;
  const vxm_soup *soup;
  const uint32_t *sides;
  const uint8_t *counts;
  vxm_turned_link *links; /**< per face */
  patch *patches;         /**< per face that stands for one */
  meeting *meetings;      /**< per edge */
} turning;

typedef void (*side_fn)(turning *t, size_t face, size_t edge, bool forward);

static void meet(turning *t, size_t face, size_t edge, bool forward) {
  meeting *m = &t->meetings[edge];
  if (m->count == 0)
    *m = (meeting){.face = face, .forward = forward};
  m->count = (uint8_t)(m->count < 3 ? m->count + 1 : 3);
}

static void join_there(turning *t, size_t face, size_t edge, bool forward) {
  const meeting *m = &t->meetings[edge];
  if (m->count == 2 && m->face != face)
    vxm_turned_sets_join(t->links, face, m->face, m->forward == forward);
}

static vxm_status for_each_side(turning *t, side_fn visit, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < t->soup->face_count && status == VXM_OK; f++) {
    status = vxm_check_cancelled_at(f, t->state->context, error);
    for (uint64_t c = t->soup->offsets[f]; c < t->soup->offsets[f + 1] && t->counts[f]; c++)
      if (t->sides[c] != VXM_NO_EDGE)
        visit(t, f, t->sides[c], t->soup->indices[c] == t->state->edges.edges[t->sides[c]].a);
  }
  return status;
}

static void add_volumes(turning *t, vxm_unit_scale frame) {
  for (size_t f = 0; f < t->soup->face_count; f++) {
    bool against;
    if (!t->counts[f])
      continue;
    double cone = vxm_face_cone(NULL, t->soup, f, frame.centre, frame.scale);
    patch *p = &t->patches[vxm_turned_set_of(t->links, f, &against)];
    p->volume += against ? -cone : cone;
    p->sizes += fabs(cone);
    if (p->first == 0 || vxm_face_lies_before(t->soup, f, p->first - 1, frame.scale))
      p->first = f + 1;
  }
}

/** Whether a face looks down the axis along which it lies least. */
static bool looks_down(const turning *t, size_t face, double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(t->soup, face, &count);
  vxm_vec3 area = vxm_polygon_area(t->soup->positions, corner, count, scale);
  double x = fabs(area.x), y = fabs(area.y), z = fabs(area.z);
  return (z >= x && z >= y ? area.z : y >= x ? area.y : area.x) < 0;
}

/** Whether the face that stands for a patch runs the wrong way. */
static bool is_inward(turning *t, const patch *p, double scale) {
  bool against = false;
  if (p->first == 0 || fabs(p->volume) > no_volume * p->sizes)
    return p->volume < 0;
  vxm_turned_set_of(t->links, p->first - 1, &against);
  return looks_down(t, p->first - 1, scale) != against;
}

static vxm_status find_turns(turning *t, uint8_t *turn, vxm_unit_scale frame, vxm_error *error) {
  vxm_turned_sets_begin(t->links, t->soup->face_count);
  vxm_status status = for_each_side(t, meet, error);
  if (status == VXM_OK)
    status = for_each_side(t, join_there, error);
  if (status != VXM_OK)
    return status;
  add_volumes(t, frame);
  for (size_t f = 0; f < t->soup->face_count; f++) {
    bool against;
    size_t root = vxm_turned_set_of(t->links, f, &against);
    turn[f] = t->counts[f] && is_inward(t, &t->patches[root], frame.scale) != against;
  }
  return VXM_OK;
}

vxm_status vxm_outer_sides_find(uint8_t *turn, vxm_repair_state *state, const uint32_t *sides,
                                const uint8_t *counts, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  turning t = {.state = state, .soup = state->soup, .sides = sides, .counts = counts};
  t.links = vxm_repair_state_scratch(state, t.soup->face_count, sizeof *t.links, &status, error);
  if (t.links)
    t.patches = vxm_repair_state_scratch(state, t.soup->face_count, sizeof *t.patches, &status, error);
  if (t.patches)
    t.meetings = vxm_repair_state_scratch(state, state->edges.count, sizeof *t.meetings, &status, error);
  if (t.meetings)
    status = find_turns(&t, turn, vxm_unit_scale_of(extent.bounds), error);
  vxm_free(state->context, t.meetings);
  vxm_free(state->context, t.patches);
  vxm_free(state->context, t.links);
  return status;
}
