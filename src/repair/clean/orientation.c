/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/containment.h"
#include "repair/clean/held_patches.h"
#include "repair/clean/spanning_turns.h"
#include "repair/clean/touching_rims.h"
#include "repair/state/repair_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/** A patch whose vector area is at least this part of its area is a sheet; of a hemisphere it is half. */
static const double SHEET = 0.45;
/** A volume of at most this part of the area times the diagonal is none. */
static const double NO_VOLUME = 1e-12;

/** Faces joined by edges that have exactly two sides, but for rims that touch (touching_rims.h). */
typedef struct patch {
  int64_t conflicts;    /**< sides along edges that no turning makes consistent */
  int64_t inconsistent; /**< sides along edges that are not consistent in the input */
  double area, turned_area;
  vxm_vec3 vector_area;
} patch;

typedef struct orienting {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_error error;
  vxm_unit_scale frame;
  const uint32_t *sides; /**< per corner: its edge */
  size_t (*pair)[2];     /**< per edge with two sides: their faces */
  uint8_t *fold;         /**< per edge: its faces lie on each other and are not joined by it */
  uint32_t *label;       /**< per face: its patch */
  uint8_t *turn;         /**< per face: 1 = against the first face of its patch, later: against the input */
  size_t *queue;
  patch *patches;
  size_t patch_count, patch_capacity;
  double volume; /**< where all is one patch that is consistent, and so measured in one go */
} orienting;

static void *allocate(orienting *o, size_t count, size_t size) {
  return vxm_calloc(o->state->context, count, size, &o->error);
}

/** Whether no face has to be turned for the sake of others. */
static bool is_consistent(const orienting *o) {
  return o->state->edges.crowded == 0 && o->state->edges.against == 0;
}

/* ---- Patches ---- */

/** To be asked at every so many steps: false if the work has been cancelled. */
static bool goes_on(orienting *o, size_t step) {
  return vxm_check_cancelled_at(step, o->state->context, &o->error) == VXM_OK;
}

static bool pair_faces(orienting *o) {
  const vxm_edges *edges = &o->state->edges;
  for (size_t e = 0; e < edges->count; e++) {
    if (!goes_on(o, e))
      return false;
    o->pair[e][0] = o->pair[e][1] = SIZE_MAX;
  }
  for (size_t f = 0; f < o->soup->face_count; f++) {
    if (!goes_on(o, f))
      return false;
    for (uint64_t c = o->soup->offsets[f]; c < o->soup->offsets[f + 1]; c++) {
      size_t e = o->sides[c];
      if (e != VXM_NO_EDGE && edges->edges[e].count == 2)
        o->pair[e][o->pair[e][0] != SIZE_MAX] = f;
    }
  }
  return true;
}

/** Whether the sides of a face are walked backward: a walk that is the same for the face and its reverse
 * makes the walk over a patch the same after it was turned. */
static bool walks_backward(const uint32_t *corner, size_t count) {
  for (size_t i = 1; i < count; i++)
    if (corner[i] != corner[count - i])
      return corner[i] > corner[count - i];
  return false;
}

/** Meets the neighbours of a face: labels and queues the new ones, counts conflicts with the old ones. */
static size_t visit(orienting *o, size_t face, size_t queued) {
  patch *p = &o->patches[o->label[face]];
  size_t count;
  const uint32_t *corner = vxm_face(o->soup, face, &count);
  bool backward = walks_backward(corner, count);
  for (size_t i = 0; i < count; i++) {
    size_t e = o->sides[o->soup->offsets[face] + (backward ? count - 1 - i : i)];
    if (e == VXM_NO_EDGE || o->state->edges.edges[e].count != 2 || o->fold[e])
      continue;
    size_t other = o->pair[e][o->pair[e][0] == face];
    uint8_t against = o->state->edges.edges[e].forward != 1, turn = o->turn[face] ^ against;
    p->inconsistent += against;
    if (other == face)
      p->conflicts += against;
    else if (o->label[other] != VXM_NO_COMPONENT)
      p->conflicts += o->turn[other] != turn;
    else {
      o->label[other] = o->label[face];
      o->turn[other] = turn;
      o->queue[queued++] = other;
    }
  }
  return queued;
}

static bool find_patches(orienting *o) {
  o->patch_count = 0;
  for (size_t f = 0; f < o->soup->face_count; f++)
    o->label[f] = VXM_NO_COMPONENT;
  for (size_t f = 0; f < o->soup->face_count; f++) {
    if (o->label[f] != VXM_NO_COMPONENT)
      continue;
    void *patches = o->patches;
    if (vxm_grow(o->state->context, &patches, &o->patch_capacity, o->patch_count + 1, sizeof *o->patches,
                 &o->error) != VXM_OK)
      return false;
    o->patches = patches;
    o->patches[o->patch_count] = (patch){0};
    o->label[f] = (uint32_t)o->patch_count++;
    o->queue[0] = f;
    for (size_t next = 0, queued = 1; next < queued; next++) {
      queued = visit(o, o->queue[next], queued);
      if (!goes_on(o, next + 1))
        return false;
    }
    if (!goes_on(o, f + 1))
      return false;
  }
  return true;
}

/** Finds the patches; bodies that touch with their rims are not one. */
static bool part_patches(orienting *o) {
  bool any;
  if (vxm_flat_folds_find(o->fold, &any, o->state, (const size_t(*)[2])o->pair, o->frame.scale, &o->error) !=
          VXM_OK ||
      !find_patches(o))
    return false;
  vxm_rimmed_patches patches = {o->state, (const size_t(*)[2])o->pair, o->label, o->turn, o->patch_count};
  if (any && vxm_touching_rims_keep(o->fold, &any, &patches, o->frame.scale, &o->error) != VXM_OK)
    return false;
  return !any || find_patches(o);
}

/** Where all faces go together as they are, what edges connect is known. */
static bool take_patches(orienting *o) {
  if (vxm_repair_state_patches(o->state, &o->error) != VXM_OK)
    return false;
  o->label = o->state->patches.of_face;
  o->patch_count = o->state->patches.count;
  o->patches = allocate(o, o->patch_count, sizeof *o->patches);
  return o->patches != NULL;
}

/* ---- Turning ---- */

static void add_area(patch *p, vxm_vec3 area) {
  p->vector_area = vxm_vec3_sum(p->vector_area, area);
}

/** The areas of patches that are consistent. */
static bool measure_patches(orienting *o) {
  if (o->patch_count == 1) {
    vxm_status status = vxm_repair_state_measure(o->state, NULL, &o->error);
    const vxm_surface_sums *sums = &o->state->sums;
    o->patches[0] = (patch){.area = sums->area, .vector_area = sums->vector_area};
    o->volume = sums->volume;
    return status == VXM_OK;
  }
  for (size_t f = 0; f < o->soup->face_count && goes_on(o, f); f++) {
    patch *p = &o->patches[o->label[f]];
    vxm_vec3 area = vxm_face_area(o->soup, f, o->frame.scale);
    p->area += vxm_vec3_length(area);
    add_area(p, area);
  }
  return o->error.code == VXM_OK;
}

/** Counts the sides along edges that turning as it is now leaves inconsistent, of the patches chosen. */
static void count_conflicts(orienting *o, const uint8_t *chosen) {
  for (size_t i = 0; i < o->patch_count; i++)
    o->patches[i].conflicts = chosen[i] ? 0 : o->patches[i].conflicts;
  for (size_t e = 0; e < o->state->edges.count; e++) {
    const vxm_edge *edge = &o->state->edges.edges[e];
    const size_t *pair = o->pair[e];
    if (edge->count != 2 || pair[1] == SIZE_MAX || o->fold[e] || !chosen[o->label[pair[0]]])
      continue;
    bool against = edge->forward != 1;
    o->patches[o->label[pair[0]]].conflicts += 2 * ((o->turn[pair[0]] ^ o->turn[pair[1]]) != against);
  }
}

/** Turns what no turning makes consistent so that it does not hang on the face with which the walk began. */
static bool settle_conflicts(orienting *o) {
  bool any = false;
  uint8_t *chosen = allocate(o, o->patch_count, sizeof *chosen);
  for (size_t i = 0; chosen && i < o->patch_count; i++) {
    chosen[i] = o->patches[i].conflicts > 0;
    any |= chosen[i];
  }
  vxm_joined_faces joined = {o->label, (const size_t(*)[2])o->pair, o->fold, chosen};
  bool done = chosen != NULL;
  if (any)
    done = vxm_spanning_turns_find(o->turn, o->state, &joined, &o->error) == VXM_OK;
  if (any && done)
    count_conflicts(o, chosen);
  vxm_free(o->state->context, chosen);
  return done;
}

/** Makes patches consistent, with most of their area as it was; without a gain they stay as they are. */
static bool make_consistent(orienting *o) {
  if (!settle_conflicts(o))
    return false;
  for (size_t f = 0; f < o->soup->face_count && goes_on(o, f); f++) {
    patch *p = &o->patches[o->label[f]];
    double area = vxm_vec3_length(vxm_face_area(o->soup, f, o->frame.scale));
    p->area += area;
    p->turned_area += o->turn[f] ? area : 0;
  }
  for (size_t f = 0; f < o->soup->face_count && o->error.code == VXM_OK && goes_on(o, f); f++) {
    patch *p = &o->patches[o->label[f]];
    if (p->inconsistent <= p->conflicts)
      o->turn[f] = 0;
    else
      o->turn[f] ^= 2 * p->turned_area > p->area;
    if (o->turn[f])
      vxm_soup_reverse_face(o->soup, f);
    add_area(p, vxm_face_area(o->soup, f, o->frame.scale));
  }
  return o->error.code == VXM_OK;
}

/* ---- Outward ---- */

static bool is_closed_or_nearly(const patch *p) {
  return p->conflicts == 0 && p->area > 0 && vxm_vec3_length(p->vector_area) < SHEET * p->area;
}

/** What bounds no volume goes with the model. */
static bool is_inward(const vxm_containment *containment, size_t i, bool follow) {
  return containment->volume[i] < 0 || (containment->volume[i] == 0 && follow);
}

/** Which patches to turn over: outward those that bound a volume, but for cavities. The others that `follow`
 * the model are turned over where it came inside out. */
static void choose_sides(const vxm_containment *containment, const uint8_t *solid, const uint8_t *held,
                         bool follow, uint8_t *over, uint8_t *known, size_t *chain) {
  for (size_t i = 0; i < containment->count; i++) {
    size_t depth = 0, at = i;
    if (!solid[i])
      over[i] = follow;
    for (; !known[at] && solid[at]; at = containment->parent[at]) {
      chain[depth++] = at;
      if (containment->parent[at] == VXM_NO_COMPONENT)
        break;
    }
    while (depth > 0) {
      size_t child = chain[--depth];
      uint32_t parent = containment->parent[child];
      bool inward = is_inward(containment, child, follow);
      uint32_t body = containment->body[child];
      over[child] = inward;
      if (containment->volume[child] == 0 && parent != VXM_NO_COMPONENT &&
          inward != is_inward(containment, parent, follow))
        over[child] = over[parent]; /* against the parent it stays */
      else if (body != VXM_NO_COMPONENT)
        over[child] =
            held[body] ? follow : is_inward(containment, body, follow); /* as what it is a void of */
      if (held[child])
        over[child] = follow;
      known[child] = 1;
    }
  }
}

/** Volume about the middle of the model of all faces as they are by now. */
static double volume_of_all(const orienting *o) {
  double volume = 0;
  for (size_t f = 0; f < o->soup->face_count; f++)
    volume += vxm_face_cone(NULL, o->soup, f, o->frame.centre, o->frame.scale);
  return volume;
}

/** A sum of areas or volumes below that part of all is rounding. */
static const double rounding = 1e-6;

/** Whether the model came inside out: what bounds a volume is a quarter of its area or more, and most of that
 * inward; or, where nothing does but faces meet along edges that have more than two, all faces together are.
 * So the patches that have no side of their own stand to the others as they did, and reversing all faces of a
 * file changes nothing about how they meet. */
static bool is_inside_out(const orienting *o, const vxm_containment *containment, const uint8_t *solid) {
  double outward = 0, bounding = 0, all = 0;
  for (size_t i = 0; i < containment->count; i++) {
    all += o->patches[i].area;
    if (solid[i] && containment->parent[i] == VXM_NO_COMPONENT && containment->volume[i] != 0) {
      outward += containment->volume[i] < 0 ? -o->patches[i].area : o->patches[i].area;
      bounding += o->patches[i].area;
    }
  }
  if (outward == 0 && o->state->edges.crowded > 0)
    return volume_of_all(o) < -rounding;
  return 4 * bounding > all && outward < -rounding * all;
}

/** What lies inside what, and the volumes; freed with vxm_containment_destroy. */
static bool find_containment(orienting *o, const uint8_t *solid, vxm_containment *containment) {
  if (o->patch_count > 1 || !is_consistent(o))
    return vxm_containment_build(containment, o->soup, o->label, o->patch_count, solid, &o->error) == VXM_OK;
  *containment = (vxm_containment){.context = o->state->context, .count = 1};
  containment->parent = allocate(o, 1, sizeof *containment->parent);
  containment->body = allocate(o, 1, sizeof *containment->body);
  containment->volume = allocate(o, 1, sizeof *containment->volume);
  if (!containment->parent || !containment->body || !containment->volume)
    return false;
  containment->parent[0] = containment->body[0] = VXM_NO_COMPONENT;
  containment->volume[0] = o->volume;
  return true;
}

static bool turn_outward(orienting *o) {
  size_t count = o->patch_count;
  uint8_t *solid = allocate(o, count, sizeof *solid), *over = allocate(o, count, sizeof *over);
  uint8_t *known = allocate(o, count, sizeof *known), *held = allocate(o, count, sizeof *held);
  size_t *chain = allocate(o, count, sizeof *chain);
  vxm_containment containment = {0};
  bool done = solid && over && known && held && chain &&
              vxm_held_patches_find(held, o->state, o->label, o->turn, &o->error) == VXM_OK;
  for (size_t i = 0; done && i < count; i++)
    solid[i] = is_closed_or_nearly(&o->patches[i]);
  if (done && find_containment(o, solid, &containment)) {
    double unit = o->frame.scale * o->frame.scale * o->frame.scale;
    for (size_t i = 0; i < count; i++)
      if (!(fabs(containment.volume[i]) * unit > NO_VOLUME * o->patches[i].area * o->frame.diagonal))
        containment.volume[i] = 0;
    o->state->has_held_patches = memchr(held, 1, count) != NULL;
    choose_sides(&containment, solid, held, is_inside_out(o, &containment, solid), over, known, chain);
    bool any = memchr(over, 1, count) != NULL;
    for (size_t f = 0; any && f < o->soup->face_count; f++)
      if (over[o->label[f]]) {
        o->turn[f] ^= 1;
        vxm_soup_reverse_face(o->soup, f);
      }
  }
  done = o->error.code == VXM_OK;
  vxm_containment_destroy(&containment);
  vxm_free(o->state->context, chain);
  vxm_free(o->state->context, held);
  vxm_free(o->state->context, known);
  vxm_free(o->state->context, over);
  vxm_free(o->state->context, solid);
  return done;
}

static bool orient(orienting *o) {
  size_t faces = o->soup->face_count;
  if (vxm_repair_state_count_edges(o->state, &o->error) != VXM_OK)
    return false;
  if (is_consistent(o)) {
    o->turn = allocate(o, faces, sizeof *o->turn);
    return o->turn && take_patches(o) && measure_patches(o) && turn_outward(o);
  }
  o->sides = o->state->edges.sides;
  o->pair = allocate(o, o->state->edges.count, sizeof *o->pair);
  o->fold = allocate(o, o->state->edges.count, sizeof *o->fold);
  o->label = allocate(o, faces, sizeof *o->label);
  o->turn = allocate(o, faces, sizeof *o->turn);
  o->queue = allocate(o, faces, sizeof *o->queue);
  if (!o->pair || !o->fold || !o->label || !o->turn || !o->queue)
    return false;
  return pair_faces(o) && part_patches(o) && make_consistent(o) && turn_outward(o);
}

/** Notes which faces run the other way than when they came in, by this pass and those before. */
static bool note_turned(orienting *o, bool *changed) {
  vxm_repair_state *state = o->state;
  for (size_t f = 0; f < o->soup->face_count && !*changed; f++)
    *changed = o->turn[f];
  if (*changed && !state->turned)
    state->turned = allocate(o, o->soup->face_count, sizeof *state->turned);
  for (size_t f = 0; f < o->soup->face_count && *changed && state->turned; f++)
    state->turned[f] ^= o->turn[f];
  return !*changed || state->turned;
}

/**
 * Turns faces: consistent within a patch, and patches that are closed or nearly so outward. A patch inside
 * another one that was wound against it is a cavity and stays so, unless it lies in a cavity of that. Patches
 * that only together are consistent about an edge stay as they are, and sheets keep the side that most of
 * their area has; both are turned where the model as a whole came inside out. A patch that no turning makes
 * consistent gets as few inconsistent edges as a longest spanning tree leaves (spanning_turns.h). Bodies
 * whose rims lie on each other do not turn each other (touching_rims.h).
 */
vxm_status vxm_pass_orientation(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (state->options.keep_orientation || state->soup->face_count == 0)
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  orienting o = {.state = state,
                 .soup = state->soup,
                 .error = VXM_ERROR_INIT,
                 .frame = vxm_unit_scale_of(extent.bounds)};
  state->has_held_patches = false;
  bool done = orient(&o);
  state->nonorientable_patches = 0;
  if (done)
    done = note_turned(&o, changed);
  for (size_t i = 0; done && i < o.patch_count; i++)
    state->nonorientable_patches += o.patches[i].conflicts > 0;
  if (done && *changed)
    vxm_repair_state_turn(state, o.turn);
  vxm_free(state->context, o.patches);
  vxm_free(state->context, o.queue);
  vxm_free(state->context, o.turn);
  if (o.label != state->patches.of_face)
    vxm_free(state->context, o.label);
  vxm_free(state->context, o.fold);
  vxm_free(state->context, o.pair);
  if (!done) {
    vxm_error_pass(error, &o.error);
    return o.error.code;
  }
  return VXM_OK;
}
