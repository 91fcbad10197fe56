/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/box.h"
#include "mesh/geometry.h"
#include "repair/state/repair_state.h"

/* A face without area may be all that joins two others whose shared side has a vertex more on one of them: a
   sliver between A-B on one side and A-C, C-B on the other. Without it the mesh would be open there. So such
   a face goes only if that does not leave more edges odd. Removing one may let its neighbours go: an edge
   that has become odd puts the faces along it forward again. */

typedef struct removal {
  vxm_repair_state *state;
  uint8_t *flat;     /**< per face: 1 = without area, 2 = to be removed */
  size_t sides;      /**< of all faces without area */
  uint8_t *odd;      /**< per edge, of the faces not to be removed */
  size_t *side_face; /**< per side: its face */
  size_t *side_next; /**< per side: 1 + another side along the same edge, or 0 */
  size_t *edge_side; /**< per edge: 1 + one of its sides, or 0 */
  size_t *queue;     /**< edges to look at again */
  uint8_t *queued;   /**< per edge */
  size_t queue_begin, queue_count;
} removal;

static void count_sides(removal *r) {
  const vxm_soup *soup = r->state->soup;
  for (size_t f = 0; f < soup->face_count; f++)
    if (r->flat[f])
      r->sides += (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
}

static size_t edge_of_side(const removal *r, const uint32_t *corners, size_t count, size_t i) {
  return vxm_edges_find(&r->state->edges, corners[i], corners[i + 1 < count ? i + 1 : 0]);
}

/** Lists the sides of the faces without area by edge, the first face's last so that lists start with it. */
static void list_sides(removal *r) {
  const vxm_soup *soup = r->state->soup;
  for (size_t e = 0; e < r->state->edges.count; e++)
    r->odd[e] = vxm_edge_is_odd(&r->state->edges.edges[e]);
  size_t side = 0;
  for (size_t f = soup->face_count; f-- > 0;) {
    size_t count;
    const uint32_t *corners = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count && r->flat[f]; i++) {
      size_t e = edge_of_side(r, corners, count, i);
      r->side_face[side] = f;
      r->side_next[side] = r->edge_side[e];
      r->edge_side[e] = ++side;
    }
  }
}

static void put_forward(removal *r, size_t edge) {
  if (r->queued[edge])
    return;
  r->queued[edge] = 1;
  r->queue[(r->queue_begin + r->queue_count++) % r->state->edges.count] = edge;
}

/** Turns the sides of a face between odd and even; returns by how many more edges are odd now. */
static int64_t toggle(removal *r, const uint32_t *corners, size_t count) {
  int64_t more = 0;
  for (size_t i = 0; i < count; i++) {
    uint8_t *odd = &r->odd[edge_of_side(r, corners, count, i)];
    more += *odd ? -1 : 1;
    *odd ^= 1;
  }
  return more;
}

static void try_face(removal *r, size_t face) {
  if (r->flat[face] != 1)
    return;
  size_t count;
  const uint32_t *corners = vxm_face(r->state->soup, face, &count);
  if (toggle(r, corners, count) > 0) {
    toggle(r, corners, count);
    return;
  }
  r->flat[face] = 2;
  for (size_t i = 0; i < count; i++) {
    size_t e = edge_of_side(r, corners, count, i);
    if (r->odd[e])
      put_forward(r, e);
  }
}

static void choose_faces(removal *r) {
  for (size_t f = 0; f < r->state->soup->face_count; f++)
    try_face(r, f);
  while (r->queue_count > 0) {
    size_t edge = r->queue[r->queue_begin];
    r->queue_begin = (r->queue_begin + 1) % r->state->edges.count;
    r->queue_count--;
    r->queued[edge] = 0;
    for (size_t side = r->edge_side[edge]; side != 0; side = r->side_next[side - 1])
      try_face(r, r->side_face[side - 1]);
  }
}

static vxm_status choose(removal *r, vxm_error *error) {
  vxm_status status = vxm_repair_state_edges(r->state, error);
  if (status != VXM_OK)
    return status;
  size_t edges = r->state->edges.count;
  vxm_error local = VXM_ERROR_INIT;
  vxm_repair_state *state = r->state;
  r->odd = vxm_repair_state_scratch(state, edges, sizeof *r->odd, &status, &local);
  r->queued = r->odd ? vxm_repair_state_scratch(state, edges, sizeof *r->queued, &status, &local) : NULL;
  r->queue = r->queued ? vxm_repair_state_scratch(state, edges, sizeof *r->queue, &status, &local) : NULL;
  r->edge_side =
      r->queue ? vxm_repair_state_scratch(state, edges, sizeof *r->edge_side, &status, &local) : NULL;
  r->side_face =
      r->edge_side ? vxm_repair_state_scratch(state, r->sides, sizeof *r->side_face, &status, &local) : NULL;
  r->side_next =
      r->side_face ? vxm_repair_state_scratch(state, r->sides, sizeof *r->side_next, &status, &local) : NULL;
  if (r->side_next) {
    list_sides(r);
    choose_faces(r);
  } else
    vxm_error_pass(error, &local);
  vxm_free(state->context, r->side_next);
  vxm_free(state->context, r->side_face);
  vxm_free(state->context, r->edge_side);
  vxm_free(state->context, r->queue);
  vxm_free(state->context, r->queued);
  vxm_free(state->context, r->odd);
  return status;
}

/** Whether a face that goes has a shape: it is only small, beside all that there is. */
static bool has_shape(const vxm_soup *soup, size_t face) {
  const double sliver = 1e-4; /* of the squared diagonal: flatter than that it would go in any company */
  double bounds[6];
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  vxm_box_empty(bounds, bounds + 3);
  for (size_t i = 0; i < count; i++)
    vxm_box_include(bounds, bounds + 3, vxm_position(soup, corner[i]));
  vxm_unit_scale own = vxm_unit_scale_of(bounds);
  return vxm_polygon_fan_area(soup->positions, corner, count, own.scale) >
         sliver * own.diagonal * own.diagonal;
}

/** Where most faces have no area beside the whole, something lies far off, and what goes was meant. */
static void warn_of_far(const removal *r) {
  vxm_soup *soup = r->state->soup;
  size_t lost = 0;
  if (r->state->sums.flat_faces <= soup->face_count / 2)
    return;
  for (size_t f = 0; f < soup->face_count; f++)
    lost += r->flat[f] && has_shape(soup, f);
  if (lost > 0)
    vxm_warn(
        &soup->warnings,
        "most faces are too small to have an area beside the size of the whole: does something lie far off? "
        "%zu of them %s removed for that",
        lost, lost == 1 ? "was" : "were");
}

/** Faces have been reduced before: they have at least three corners, and no side from a vertex to itself. */
vxm_status vxm_pass_degenerate_faces(vxm_repair_state *state, bool *changed, vxm_error *error) {
  removal r = {.state = state};
  vxm_status status = VXM_OK;
  *changed = false;
  r.flat = vxm_repair_state_scratch(state, state->soup->face_count, sizeof *r.flat, &status, error);
  if (!r.flat)
    return status;
  status = vxm_repair_state_measure(state, r.flat, error);
  if (status == VXM_OK && state->sums.flat_faces > 0) {
    count_sides(&r);
    status = choose(&r, error);
    for (size_t f = 0; f < state->soup->face_count; f++)
      r.flat[f] = r.flat[f] == 2;
    if (status == VXM_OK) {
      warn_of_far(&r);
      vxm_repair_state_note_marked(state, VXM_PASS_DEGENERATE_FACES, r.flat);
    }
    int64_t count = status == VXM_OK ? vxm_repair_state_remove_faces(state, r.flat) : 0;
    state->counts[VXM_PASS_DEGENERATE_FACES] += count;
    *changed = count > 0;
  }
  vxm_free(state->context, r.flat);
  return status;
}
