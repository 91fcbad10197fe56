/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/weld/t_junctions.h"

#include "base/hash.h"
#include "mesh/geometry.h"

#include <float.h>
#include <math.h>
#include <string.h>

/** A vertex on an edge is nearer to it by so much than to its ends, and than the edge is to other corners. */
static const double FAR_NEARER = 16;

enum {
  AROUND_MAX = 64,     /**< open edges looked at about a vertex; where more meet, some are not found */
  CHAIN_MAX = 1024,    /**< divisions along one edge */
  SPAN_MAX = 16,       /**< vertices along a chain that other edges are looked for between */
  STEPS_PER_EDGE = 64, /**< on average; beyond, nothing more is looked for */
};

/** An open edge, or what is left of one. */
typedef struct open_edge {
  uint32_t end[2];
  uint32_t next[2]; /**< 1 + the next one at that end, or 0 */
  double room;      /**< how far the nearest corner beyond it is, scaled; below 0: it is not to be divided */
  int64_t balance;  /**< as far as we have come: sides from end[0] to end[1] less the others; or mod 2 */
} open_edge;

/** What an edge was before. */
typedef struct undoing {
  uint32_t edge;
  int64_t balance;
} undoing;

typedef struct search {
  vxm_repair_state *state;
  const vxm_soup *soup;
  vxm_error error;
  double scale, tolerance;
  bool is_signed;  /**< sides that run one way go with those that run the other; else any two */
  uint32_t *first; /**< per vertex: 1 + one of its open edges, or 0 */
  open_edge *edges;
  size_t count, capacity;
  size_t steps; /**< that are left */
  uint32_t chain[CHAIN_MAX + 2];
  undoing changed[3 * CHAIN_MAX];
  uint64_t divided[CHAIN_MAX]; /**< keys */
  uint32_t middle[CHAIN_MAX];
  size_t chain_count, changed_count, divided_count;
  vxm_edge_splits *splits;
} search;

static const uint32_t NONE = UINT32_MAX;

/* ---- The table of splits ---- */

static size_t slot_of(const vxm_edge_splits *splits, uint64_t key) {
  size_t slot = vxm_mix(key) & (splits->slots - 1);
  while (splits->keys[slot] != UINT64_MAX && splits->keys[slot] != key)
    slot = (slot + 1) & (splits->slots - 1);
  return slot;
}

uint32_t vxm_edge_split_at(const vxm_edge_splits *splits, uint32_t a, uint32_t b) {
  if (splits->slots == 0)
    return VXM_NO_VERTEX;
  size_t slot = slot_of(splits, vxm_edge_key(a, b));
  return splits->keys[slot] == UINT64_MAX ? VXM_NO_VERTEX : splits->middle[slot];
}

void vxm_edge_splits_destroy(vxm_edge_splits *splits, vxm_context *context) {
  vxm_free(context, splits->middle);
  vxm_free(context, splits->keys);
  *splits = (vxm_edge_splits){0};
}

/** Doubles the table where it is half full. */
static bool make_room(search *s) {
  vxm_edge_splits *splits = s->splits, grown = {.count = splits->count, .slots = 2 * splits->slots};
  if (2 * (splits->count + 1) <= splits->slots)
    return true;
  if (grown.slots == 0)
    grown.slots = 64;
  grown.keys = vxm_alloc(s->state->context, grown.slots, sizeof *grown.keys, &s->error);
  grown.middle = vxm_alloc(s->state->context, grown.slots, sizeof *grown.middle, &s->error);
  if (!grown.keys || !grown.middle) {
    vxm_edge_splits_destroy(&grown, s->state->context);
    return false;
  }
  memset(grown.keys, 0xff, grown.slots * sizeof *grown.keys);
  for (size_t i = 0; i < splits->slots; i++)
    if (splits->keys[i] != UINT64_MAX) {
      size_t slot = slot_of(&grown, splits->keys[i]);
      grown.keys[slot] = splits->keys[i];
      grown.middle[slot] = splits->middle[i];
    }
  vxm_edge_splits_destroy(splits, s->state->context);
  *splits = grown;
  return true;
}

/** The first that is said of an edge stays. */
static bool add_split(search *s, uint64_t key, uint32_t middle) {
  if (!make_room(s))
    return false;
  size_t slot = slot_of(s->splits, key);
  if (s->splits->keys[slot] == key)
    return true;
  s->splits->keys[slot] = key;
  s->splits->middle[slot] = middle;
  s->splits->count++;
  return true;
}

/* ---- Open edges ---- */

static bool add_open(search *s, uint32_t a, uint32_t b, double room, int64_t balance) {
  void *edges = s->edges;
  if (s->count >= NONE - 1 ||
      vxm_grow(s->state->context, &edges, &s->capacity, s->count + 1, sizeof *s->edges, &s->error) != VXM_OK)
    return false;
  s->edges = edges;
  s->edges[s->count++] = (open_edge){{a, b}, {s->first[a], s->first[b]}, room, balance};
  s->first[a] = s->first[b] = (uint32_t)s->count;
  return true;
}

static vxm_vec3 from_to(const search *s, uint32_t from, uint32_t to) {
  return vxm_vec3_between(vxm_position(s->soup, to), vxm_position(s->soup, from), s->scale);
}

/** How far a corner is from the line through two others. */
static double height_over(const search *s, uint32_t a, uint32_t b, uint32_t corner) {
  vxm_vec3 along = from_to(s, a, b);
  return vxm_vec3_length(vxm_vec3_cross(along, from_to(s, a, corner))) / vxm_vec3_length(along);
}

static int64_t balance_of(const search *s, const vxm_edge *edge) {
  return s->is_signed ? 2 * (int64_t)edge->forward - (int64_t)edge->count : edge->count & 1;
}

static bool list_open(search *s) {
  const vxm_edges *edges = &s->state->edges;
  for (size_t e = 0; e < edges->count; e++) {
    int64_t balance = balance_of(s, &edges->edges[e]);
    if (balance != 0 && !add_open(s, edges->edges[e].a, edges->edges[e].b, DBL_MAX, balance))
      return false;
  }
  return true;
}

/** Looks how much room there is in triangles along open edges, which are listed; a polygon takes any vertex.
 */
static bool measure_room(search *s) {
  const vxm_edges *edges = &s->state->edges;
  const vxm_soup *soup = s->soup;
  uint32_t *number = vxm_alloc(s->state->context, edges->count, sizeof *number, &s->error), next = 0;
  bool done = number != NULL;
  for (size_t e = 0; e < edges->count && done; e++)
    number[e] = balance_of(s, &edges->edges[e]) != 0 ? next++ : NONE;
  for (size_t f = 0; f < soup->face_count && done; f++) {
    uint64_t begin = soup->offsets[f];
    done = vxm_check_cancelled_at(f, s->state->context, &s->error) == VXM_OK;
    for (uint64_t i = 0; i < 3 && soup->offsets[f + 1] - begin == 3; i++) {
      uint32_t e = edges->sides[begin + i];
      if (e == VXM_NO_EDGE || number[e] == NONE)
        continue;
      open_edge *open = &s->edges[number[e]];
      double height = height_over(s, open->end[0], open->end[1], soup->indices[begin + (i + 2) % 3]);
      if (!(height >= open->room))
        open->room = height > 0 ? height : -1;
    }
  }
  vxm_free(s->state->context, number);
  return done;
}

/** Whether a vertex lies on the edge between two others that has so much room. */
static bool lies_on(const search *s, uint32_t vertex, uint32_t a, uint32_t b, double room) {
  vxm_vec3 along = from_to(s, a, b), to = from_to(s, a, vertex);
  double length = vxm_vec3_length(along), at = vxm_vec3_dot(along, to) / length;
  double distance = vxm_vec3_length(vxm_vec3_cross(along, to)) / length, nearer = FAR_NEARER * distance;
  return at > 0 && at < length && distance <= s->tolerance && nearer <= room && nearer <= at &&
         nearer <= length - at;
}

static uint32_t other_end(const open_edge *edge, uint32_t vertex) {
  return edge->end[edge->end[0] == vertex];
}

static uint32_t next_at(const open_edge *edge, uint32_t vertex) {
  return edge->next[edge->end[1] == vertex];
}

static int64_t balance_from(const search *s, uint32_t edge, uint32_t vertex) {
  const open_edge *e = &s->edges[edge];
  return s->is_signed && e->end[1] == vertex ? -e->balance : e->balance;
}

/** Whether two edges from a vertex have sides that may go together. */
static bool may_meet(const search *s, uint32_t p, uint32_t q, uint32_t from) {
  int64_t a = balance_from(s, p, from), b = balance_from(s, q, from);
  return s->is_signed ? (a < 0 && b > 0) || (a > 0 && b < 0) : a != 0 && b != 0;
}

static uint32_t find_open(const search *s, uint32_t a, uint32_t b) {
  uint32_t at = s->first[a];
  for (int seen = 0; at != 0 && seen < AROUND_MAX; seen++, at = next_at(&s->edges[at - 1], a))
    if (other_end(&s->edges[at - 1], a) == b)
      return at - 1;
  return NONE;
}

/** The shortest open edge from `from` that ends on the edge from there, or (`longer`) on which that one ends.
 */
static uint32_t find_along(const search *s, uint32_t from, uint32_t edge, bool longer) {
  uint32_t to = other_end(&s->edges[edge], from), found = NONE;
  double shortest = DBL_MAX;
  uint32_t at = s->first[from];
  for (int seen = 0; at != 0 && seen < AROUND_MAX; seen++) {
    const open_edge *open = &s->edges[at - 1];
    uint32_t end = other_end(open, from), number = at - 1;
    at = next_at(open, from);
    if (number == edge || end == to || !may_meet(s, number, edge, from))
      continue;
    if (longer ? !lies_on(s, to, from, end, open->room) : !lies_on(s, end, from, to, s->edges[edge].room))
      continue;
    double length = vxm_vec3_length(from_to(s, from, end));
    if (length < shortest || (length == shortest && end < other_end(&s->edges[found], from))) {
      found = number;
      shortest = length;
    }
  }
  return found;
}

/* ---- Along an edge ---- */

/** Adds sides from a vertex to an edge. */
static void change(search *s, uint32_t edge, uint32_t from, int64_t balance) {
  open_edge *e = &s->edges[edge];
  s->changed[s->changed_count++] = (undoing){edge, e->balance};
  if (s->is_signed)
    e->balance += e->end[0] == from ? balance : -balance;
  else
    e->balance = (e->balance + balance) & 1;
}

static void undo(search *s) {
  while (s->changed_count > 0) {
    undoing *u = &s->changed[--s->changed_count];
    s->edges[u->edge].balance = u->balance;
  }
}

/**
 * Divides the longer one of two edges from a vertex where the shorter one ends.
 *
 * @param[out] rest what is left, or NONE if that closes another one
 * @return false if that can not be, or after a failure
 */
static bool divide(search *s, uint32_t from, uint32_t longer, uint32_t shorter, uint32_t *rest) {
  uint32_t middle = other_end(&s->edges[shorter], from), end = other_end(&s->edges[longer], from);
  if (s->divided_count == CHAIN_MAX || vxm_edge_split_at(s->splits, from, end) != VXM_NO_VERTEX ||
      vxm_edge_split_at(s->splits, middle, end) != VXM_NO_VERTEX)
    return false;
  s->divided[s->divided_count] = vxm_edge_key(from, end);
  s->middle[s->divided_count++] = middle;
  s->chain[s->chain_count++] = middle;
  int64_t balance = balance_from(s, longer, from);
  change(s, longer, from, -balance);
  change(s, shorter, from, balance);
  uint32_t left = find_open(s, middle, end);
  if (left == NONE) {
    if (!add_open(s, middle, end, s->edges[longer].room, 0))
      return false;
    left = (uint32_t)s->count - 1;
  }
  if (s->edges[left].room > s->edges[longer].room)
    s->edges[left].room = s->edges[longer].room;
  change(s, left, middle, balance);
  *rest = s->edges[left].balance != 0 ? left : NONE;
  return true;
}

/** Whether a chain comes to an end where nothing is left of an edge from its start. */
static bool follow(search *s, uint32_t from, uint32_t edge) {
  uint32_t rest = edge;
  s->chain[0] = from;
  s->chain_count = 1;
  s->divided_count = s->changed_count = 0;
  while (rest != NONE) {
    edge = rest;
    uint32_t end = other_end(&s->edges[edge], from);
    if (s->steps == 0)
      return false;
    s->steps--;
    uint32_t other = find_along(s, from, edge, false), next = end;
    if (other != NONE) {
      next = other_end(&s->edges[other], from);
      if (!divide(s, from, edge, other, &rest))
        return false;
    } else {
      other = find_along(s, from, edge, true);
      if (other == NONE || !divide(s, from, other, edge, &rest))
        return false;
      end = other_end(&s->edges[other], from);
    }
    from = next;
    if (rest == NONE)
      s->chain[s->chain_count++] = end;
  }
  return true;
}

/** Other edges between the vertices of a chain lie on them, too. */
static bool split_spans(search *s) {
  const vxm_edges *edges = &s->state->edges;
  for (size_t i = 0; i + 2 < s->chain_count && s->chain_count <= SPAN_MAX; i++)
    for (size_t j = i + 2; j < s->chain_count; j++)
      if (vxm_edges_find(edges, s->chain[i], s->chain[j]) < edges->count &&
          !add_split(s, vxm_edge_key(s->chain[i], s->chain[j]), s->chain[i + 1]))
        return false;
  return true;
}

static bool commit(search *s) {
  for (size_t i = 0; i < s->divided_count; i++)
    if (!add_split(s, s->divided[i], s->middle[i]))
      return false;
  return split_spans(s);
}

/** Whether any open edge begins as another one does, as few do: then it is worth it to look closer. */
static bool is_any_along(search *s) {
  for (size_t e = 0; e < 2 * s->count; e++)
    if (find_along(s, s->edges[e / 2].end[e % 2], (uint32_t)(e / 2), false) != NONE)
      return true;
  return false;
}

static bool find_all(search *s) {
  size_t open = s->count;
  s->steps = STEPS_PER_EDGE * open;
  for (size_t e = 0; e < 2 * open; e++) {
    uint32_t from = s->edges[e / 2].end[e % 2];
    if (s->edges[e / 2].balance == 0 || find_along(s, from, (uint32_t)(e / 2), false) == NONE)
      continue;
    bool closes = follow(s, from, (uint32_t)(e / 2));
    if (s->error.code != VXM_OK || vxm_check_cancelled_at(e, s->state->context, &s->error) != VXM_OK)
      return false;
    if (!closes)
      undo(s);
    else if (!commit(s))
      return false;
  }
  return true;
}

/* ---- All of it ---- */

static double tolerance_of(const vxm_repair_state *state, const vxm_extent *extent,
                           const vxm_unit_scale *frame) {
  double largest = 0;
  for (int i = 0; i < 6; i++)
    largest = fmax(largest, fabs(extent->bounds[i]) * frame->scale);
  double rounding = 8 * DBL_EPSILON * largest;
  if (state->options.weld == VXM_WELD_OFF)
    return rounding;
  if (state->options.weld == VXM_WELD_TOLERANCE)
    return fmax(rounding, state->options.weld_tolerance * frame->scale);
  return fmax(rounding, VXM_CRACK_WIDTH * frame->diagonal);
}

/** Whether there is anything to look at; with fewer than three such edges nothing can be closed. */
static bool has_unbalanced(const vxm_repair_state *state, bool is_signed) {
  size_t count = 0;
  if (!is_signed)
    return state->edges.odd > 2;
  for (size_t e = 0; state->has_edges && e < state->edges.count && count < 3; e++)
    count += state->edges.edges[e].count != 2 * state->edges.edges[e].forward;
  return count > 2;
}

vxm_status vxm_t_junctions_find(vxm_edge_splits *out, vxm_repair_state *state, bool is_signed,
                                vxm_error *error) {
  *out = (vxm_edge_splits){0};
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || !has_unbalanced(state, is_signed))
    return status;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  search *s = vxm_repair_state_scratch(state, 1, sizeof *s, &status, error);
  if (!s)
    return status;
  s->state = state;
  s->soup = state->soup;
  s->error = (vxm_error)VXM_ERROR_INIT;
  s->scale = frame.scale;
  s->tolerance = tolerance_of(state, &extent, &frame);
  s->is_signed = is_signed;
  s->splits = out;
  s->first = vxm_calloc(state->context, state->soup->vertex_count, sizeof *s->first, &s->error);
  if (s->first && list_open(s) && is_any_along(s) && measure_room(s))
    find_all(s);
  status = s->error.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &s->error);
  vxm_free(state->context, s->edges);
  vxm_free(state->context, s->first);
  vxm_free(state->context, s);
  return status;
}
