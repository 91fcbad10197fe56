/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/face_list.h"
#include "repair/weld/t_junctions.h"

#include <string.h>

/** A face with the vertices that come between its corners. */
typedef struct outline {
  uint32_t *corners;
  size_t count, capacity;
  size_t begin[4]; /**< of a triangle: where each side begins, and the end */
  uint32_t *stack; /**< of dividing a side */
  size_t stack_capacity;
} outline;

typedef struct dividing {
  vxm_repair_state *state;
  vxm_error error;
  vxm_edge_splits splits;
  uint8_t *ends;  /**< per vertex: whether an edge from there is to be divided */
  uint32_t *seen; /**< per vertex: 1 + the last face that had it, of those looked at */
  outline face;
  vxm_face_list made;
  bool puts; /**< else only counts */
  size_t faces, corners;
} dividing;

static bool put_vertex(dividing *d, uint32_t **list, size_t *count, size_t *capacity, uint32_t vertex) {
  void *grown = *list;
  if (vxm_grow(d->state->context, &grown, capacity, *count + 1, sizeof **list, &d->error) != VXM_OK)
    return false;
  *list = grown;
  (*list)[(*count)++] = vertex;
  return true;
}

/** Adds a side without its end: halves of what is divided may be divided themselves. */
static bool put_side(dividing *d, uint32_t from, uint32_t to) {
  outline *o = &d->face;
  size_t depth = 0;
  bool done = put_vertex(d, &o->corners, &o->count, &o->capacity, from);
  if (!d->ends[from] || !d->ends[to])
    return done;
  done = done && put_vertex(d, &o->stack, &depth, &o->stack_capacity, to);
  while (done && depth > 0) {
    uint32_t next = o->stack[depth - 1], middle = vxm_edge_split_at(&d->splits, from, next);
    if (middle != VXM_NO_VERTEX) {
      done = put_vertex(d, &o->stack, &depth, &o->stack_capacity, middle);
      continue;
    }
    depth--;
    from = next;
    if (depth > 0)
      done = put_vertex(d, &o->corners, &o->count, &o->capacity, from);
  }
  return done;
}

/** Whether a vertex comes twice: then it lies on the face's own edge, and the face stays as it is. */
static bool meets_itself(dividing *d, size_t face) {
  for (size_t i = 0; i < d->face.count; i++) {
    uint32_t *seen = &d->seen[d->face.corners[i]];
    if (*seen == (uint32_t)face + 1)
      return true;
    *seen = (uint32_t)face + 1;
  }
  return false;
}

static void emit(dividing *d, size_t face, const uint32_t *corner, size_t count) {
  if (d->puts)
    vxm_face_list_put(&d->made, d->state, face, corner, count);
  d->faces++;
  d->corners += count;
}

/** Triangles from a vertex to all sides of a run of the outline, which may pass its end. */
static void emit_fan(dividing *d, size_t face, uint32_t apex, size_t begin, size_t end) {
  const outline *o = &d->face;
  for (size_t i = begin; i < end; i++) {
    uint32_t triangle[3] = {apex, o->corners[i % o->count], o->corners[(i + 1) % o->count]};
    emit(d, face, triangle, 3);
  }
}

/** The divided side of a triangle to begin with: which one depends on no order of corners. */
static int first_side(const outline *o) {
  int chosen = -1;
  uint64_t least = UINT64_MAX;
  for (int i = 0; i < 3; i++) {
    uint64_t key = vxm_edge_key(o->corners[o->begin[i]], o->corners[o->begin[i + 1] % o->count]);
    if (o->begin[i + 1] - o->begin[i] > 1 && key < least) {
      least = key;
      chosen = i;
    }
  }
  return chosen;
}

/**
 * A triangle with vertices on its sides becomes triangles that have an area as it had: from the corner across
 * a divided side, and those at both ends of that from its first and last vertex, if their other sides are
 * divided too.
 */
static void emit_triangle(dividing *d, size_t face) {
  const outline *o = &d->face;
  int side = first_side(o);
  size_t a = o->begin[side], b = o->begin[side + 1], n = o->count;
  size_t beyond = o->begin[(side + 2) % 3]; /* the corner across */
  if (beyond < b)
    beyond += n;
  emit_fan(d, face, o->corners[a + 1], beyond, n + a);
  for (size_t i = a + 1; i + 1 < b; i++) {
    uint32_t triangle[3] = {o->corners[beyond % n], o->corners[i], o->corners[i + 1]};
    emit(d, face, triangle, 3);
  }
  emit_fan(d, face, o->corners[b - 1], b, beyond);
}

static bool divide_face(dividing *d, size_t face) {
  outline *o = &d->face;
  size_t count;
  const uint32_t *corner = vxm_face(d->state->soup, face, &count);
  o->count = 0;
  for (size_t i = 0; i < count; i++) {
    if (i < 3)
      o->begin[i] = o->count;
    if (!put_side(d, corner[i], corner[i + 1 < count ? i + 1 : 0]))
      return false;
  }
  o->begin[3] = o->count;
  if (o->count == count || meets_itself(d, face)) {
    emit(d, face, corner, count);
    return true;
  }
  vxm_repair_state_note_face(d->state, VXM_PASS_T_JUNCTIONS, face);
  if (count == 3)
    emit_triangle(d, face);
  else
    emit(d, face, o->corners, o->count);
  return true;
}

static bool divide_all(dividing *d, bool puts) {
  d->puts = puts;
  d->faces = d->corners = 0;
  memset(d->seen, 0, d->state->soup->vertex_count * sizeof *d->seen);
  for (size_t f = 0; f < d->state->soup->face_count; f++)
    if (vxm_check_cancelled_at(f, d->state->context, &d->error) != VXM_OK || !divide_face(d, f))
      return false;
  return true;
}

static void mark_ends(dividing *d) {
  for (size_t i = 0; i < d->splits.slots; i++)
    if (d->splits.keys[i] != UINT64_MAX)
      d->ends[d->splits.keys[i] >> 32] = d->ends[(uint32_t)d->splits.keys[i]] = 1;
}

/** Puts the faces in their place, unless that would make many more corners than there are: what has so many
 * faces at one edge is no surface. */
static bool divide_faces(dividing *d, bool *changed) {
  vxm_repair_state *state = d->state;
  size_t corners = state->soup->corner_count;
  d->ends = vxm_calloc(state->context, state->soup->vertex_count, sizeof *d->ends, &d->error);
  d->seen = vxm_calloc(state->context, state->soup->vertex_count, sizeof *d->seen, &d->error);
  if (!d->ends || !d->seen)
    return false;
  mark_ends(d);
  if (!divide_all(d, false))
    return false;
  if (d->corners == corners || d->corners / 16 > corners)
    return true;
  if (vxm_face_list_create(&d->made, state, d->faces, d->corners, &d->error) != VXM_OK ||
      !divide_all(d, true))
    return false;
  vxm_face_list_exchange(&d->made, state);
  *changed = true;
  return true;
}

static vxm_status divide_once(vxm_repair_state *state, bool is_signed, bool *changed, vxm_error *error) {
  *changed = false;
  dividing d = {.state = state, .error = VXM_ERROR_INIT};
  vxm_status status = vxm_t_junctions_find(&d.splits, state, is_signed, error);
  if (status == VXM_OK && d.splits.count > 0 && !divide_faces(&d, changed)) {
    status = d.error.code;
    vxm_error_pass(error, &d.error);
  }
  if (*changed)
    state->counts[VXM_PASS_T_JUNCTIONS] += (int64_t)d.splits.count;
  vxm_face_list_destroy(&d.made, state);
  vxm_free(state->context, d.face.stack);
  vxm_free(state->context, d.face.corners);
  vxm_free(state->context, d.seen);
  vxm_free(state->context, d.ends);
  vxm_edge_splits_destroy(&d.splits, state->context);
  return status;
}

/**
 * Divides edges at vertices that lie on them, where that closes edges: polygons get them as corners,
 * triangles become several. No vertex moves. Where many lie on each other there may be more to find after
 * that; each time fewer edges are open.
 */
vxm_status vxm_pass_t_junctions(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool is_signed = true, more = true;
  vxm_status status = VXM_OK;
  *changed = false;
  while ((more || is_signed) && status == VXM_OK) {
    is_signed = more;
    status = divide_once(state, is_signed, &more, error);
    *changed = *changed || more;
  }
  return status;
}
