/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/outer_sides.h"

#include "mesh/geometry.h"

/** A face in its patch. */
typedef struct link {
  size_t parent; /**< another face of it, or itself */
  bool against;  /**< it runs the other way than that */
  double volume; /**< of the patch, if it stands for it, as it is turned itself */
} link;

/** An edge, as the faces that count have it. */
typedef struct meeting {
  size_t face; /**< the first one there */
  bool forward;
  uint8_t count; /**< 3 = three or more */
} meeting;

typedef struct turning {
  const vxm_repair_state *state;
  const vxm_soup *soup;
  const uint32_t *sides;
  const uint8_t *counts;
  link *links;       /**< per face */
  meeting *meetings; /**< per edge */
} turning;

/** The face that stands for a patch, and whether this one runs the other way; shortens the way there. */
static size_t root_of(link *links, size_t face, bool *against) {
  size_t root = face;
  bool turned = false;
  for (; links[root].parent != root; root = links[root].parent)
    turned ^= links[root].against;
  *against = turned;
  for (size_t at = face; at != root;) {
    size_t next = links[at].parent;
    bool own = links[at].against;
    links[at].parent = root;
    links[at].against = turned;
    turned ^= own;
    at = next;
  }
  return root;
}

static void join(link *links, size_t a, size_t b, bool same_way) {
  bool turned[2];
  size_t root = root_of(links, a, &turned[0]), other = root_of(links, b, &turned[1]);
  if (root == other)
    return;
  links[root].parent = other;
  links[root].against = (turned[0] != turned[1]) != same_way;
}

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
    join(t->links, face, m->face, m->forward == forward);
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
    size_t count;
    bool against;
    const uint32_t *corner = vxm_face(t->soup, f, &count);
    if (!t->counts[f] || count == 0)
      continue;
    double cone =
        vxm_polygon_cone(vxm_vec3_between(vxm_position(t->soup, corner[0]), frame.centre, frame.scale),
                         vxm_polygon_area(t->soup->positions, corner, count, frame.scale));
    size_t root = root_of(t->links, f, &against);
    t->links[root].volume += against ? -cone : cone;
  }
}

static vxm_status find_turns(turning *t, uint8_t *turn, vxm_unit_scale frame, vxm_error *error) {
  for (size_t f = 0; f < t->soup->face_count; f++)
    t->links[f].parent = f;
  vxm_status status = for_each_side(t, meet, error);
  if (status == VXM_OK)
    status = for_each_side(t, join_there, error);
  if (status != VXM_OK)
    return status;
  add_volumes(t, frame);
  for (size_t f = 0; f < t->soup->face_count; f++) {
    bool against;
    size_t root = root_of(t->links, f, &against);
    turn[f] = t->counts[f] && (t->links[root].volume < 0) != against;
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
    t.meetings = vxm_repair_state_scratch(state, state->edges.count, sizeof *t.meetings, &status, error);
  if (t.meetings)
    status = find_turns(&t, turn, vxm_unit_scale_of(extent.bounds), error);
  vxm_free(state->context, t.meetings);
  vxm_free(state->context, t.links);
  return status;
}
