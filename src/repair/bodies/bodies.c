/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/bodies.h"

#include "mesh/sort.h"
#include "repair/bodies/body_faces.h"
#include "repair/bodies/flush_bodies.h"
#include "repair/bodies/hanging_sheets.h"
#include "repair/bodies/layers.h"
#include "repair/bodies/whole_patches.h"

#include <stdlib.h>

typedef struct parting {
  vxm_repair_state *state;
  const vxm_soup *soup;
  vxm_copies *copies;
  vxm_edge_groups groups;
  vxm_group_rims rims;
  uint8_t *asked;  /**< per group: it is to be divided into layers */
  uint8_t *failed; /**< per group: it was asked and could not be */
  uint8_t *whole;  /**< per face that stands for a patch of such a group: the patch is closed for itself */
  vxm_layers layers;
  vxm_body_faces result;
  bool any_inward; /**< a group winds round something the other way */
  vxm_error error;
} parting;

static bool fail(parting *p, vxm_status status) {
  p->error.code = status;
  return false;
}

static void *scratch(parting *p, size_t count, size_t size) {
  vxm_status status = VXM_OK;
  return vxm_repair_state_scratch(p->state, count, size, &status, &p->error);
}

/** Asks now and then whether to go on. */
static bool goes_on(parting *p, size_t step) {
  return vxm_check_cancelled_at(step, p->state->context, &p->error) == VXM_OK;
}

/* ---- Which groups ---- */

/** Groups that are closed round a vertex which is in others, too. Where they are open it may be one surface
 * with a slit, so there they stay together. */
static bool mark_touching(parting *p, uint8_t *touches) {
  const vxm_soup *soup = p->soup;
  size_t *group_at = scratch(p, soup->vertex_count, sizeof *group_at);
  bool done = group_at != NULL;
  for (size_t f = 0; done && f < soup->face_count; f++) {
    done = goes_on(p, f);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      uint32_t vertex = soup->indices[c];
      size_t *at = &group_at[vertex], group = p->groups.of_face[f];
      if (*at == 0)
        *at = group + 1;
      else if (*at != group + 1) {
        touches[group] |= !vxm_group_is_open_at(&p->rims, group, vertex);
        touches[*at - 1] |= !vxm_group_is_open_at(&p->rims, *at - 1, vertex);
      }
    }
  }
  vxm_free(p->state->context, group_at);
  return done;
}

/* ---- Layers ---- */

static bool put(parting *p, uint64_t body, size_t face, bool reversed) {
  return vxm_body_faces_add(&p->result, p->state->context, (vxm_body_face){body, face, reversed},
                            &p->error) == VXM_OK;
}

/** Layer k > 0 bounds what the faces wind round at least k times, layer k < 0 what they wind round -k times
 * or more the other way. */
static uint64_t body_of(size_t group, int64_t layer) {
  return ((uint64_t)group + 1) << 32 | (uint64_t)(layer + INT32_MAX);
}

static bool put_layers(parting *p, size_t face) {
  size_t group = p->groups.of_face[face];
  int64_t front = p->layers.front[vxm_set_of(p->layers.patch, face)];
  int64_t behind = front + vxm_layers_surplus(&p->layers, face);
  bool done = true;
  for (int64_t k = front + 1; k <= behind && done; k++)
    done = put(p, body_of(group, k > 0 ? k : k - 1), face, k <= 0 && p->state->options.keep_orientation);
  p->any_inward |= front < 0;
  return done;
}

/** What is closed for itself in a group without layers is a body of its own: above all other numbers. */
static uint64_t body_of_patch(size_t patch) {
  return UINT64_C(1) << 63 | patch;
}

static bool put_faces(parting *p, const uint8_t *touches) {
  bool done = true;
  for (size_t f = 0; f < p->soup->face_count && done; f++) {
    size_t group = p->groups.of_face[f];
    if (p->failed[group] && p->whole && p->whole[vxm_set_of(p->layers.patch, f)])
      done = put(p, body_of_patch(vxm_set_of(p->layers.patch, f)), f, false);
    else if (!p->asked[group] || p->failed[group])
      done = put(p, touches[group] ? body_of(group, 0) : 0, f, false);
    else if (vxm_layers_surplus(&p->layers, f) == 0)
      done = p->copies[f].first != f || vxm_layers_hides(&p->layers, f) ||
             put(p, 0, f, false); /* a sheet, of which one side is enough */
    else if (vxm_layers_stands(&p->layers, f))
      done = put_layers(p, f);
    done = done && goes_on(p, f);
  }
  return done;
}

typedef struct side {
  size_t group, edge;
  uint64_t body;
  int turn;
} side;

static int by_edge_then_body(const void *a, const void *b) {
  const side *s = a, *t = b;
  return vxm_compare_pairs(s->edge, s->body, t->edge, t->body);
}

/** A layer that is not closed for itself is none: faces cut through each other elsewhere than at their edges.
 * Along edges with two sides they are, as both are of one patch. */
static bool check_layers(parting *p) {
  const vxm_soup *soup = p->soup;
  size_t count = 0;
  for (size_t i = 0; i < p->result.count; i++)
    count += (size_t)(soup->offsets[p->result.faces[i].face + 1] - soup->offsets[p->result.faces[i].face]);
  side *sides = scratch(p, count, sizeof *sides);
  if (!sides)
    return false;
  count = 0;
  for (size_t i = 0; i < p->result.count; i++) {
    const vxm_body_face *q = &p->result.faces[i];
    size_t group = p->groups.of_face[q->face];
    for (uint64_t c = soup->offsets[q->face];
         c < soup->offsets[q->face + 1] && q->body != 0 && p->asked[group] && !p->failed[group]; c++) {
      size_t edge = p->groups.sides[c];
      bool forward = edge != VXM_NO_EDGE && soup->indices[c] == p->state->edges.edges[edge].a;
      if (edge != VXM_NO_EDGE && p->state->edges.edges[edge].count > 2)
        sides[count++] = (side){group, edge, q->body, forward != q->reversed ? 1 : -1};
    }
  }
  qsort(sides, count, sizeof *sides, by_edge_then_body);
  for (size_t i = 0, j; i < count; i = j) {
    int sum = 0;
    for (j = i; j < count && by_edge_then_body(&sides[i], &sides[j]) == 0; j++)
      sum += sides[j].turn;
    p->failed[sides[i].group] |= sum != 0;
  }
  vxm_free(p->state->context, sides);
  return true;
}

static bool find_whole(parting *p) {
  p->whole = scratch(p, p->soup->face_count, sizeof *p->whole);
  vxm_status status =
      p->whole ? vxm_whole_patches_find(p->whole, p->failed, &p->layers, &p->error) : p->error.code;
  return status == VXM_OK || fail(p, status);
}

/* ---- The pass ---- */

/** A group of which a patch is not known has no layers. */
static void fail_unknown(parting *p) {
  for (size_t f = 0; f < p->soup->face_count; f++) {
    size_t group = p->groups.of_face[f];
    if (p->asked[group] && vxm_layers_stands(&p->layers, f))
      p->failed[group] |= !p->layers.known[vxm_set_of(p->layers.patch, f)];
  }
}

static bool find_layers(parting *p) {
  size_t faces = p->soup->face_count;
  vxm_duplicates found;
  vxm_layers *l = &p->layers;
  uint8_t *kinds = scratch(p, faces, sizeof *kinds);
  p->copies = kinds ? scratch(p, faces, sizeof *p->copies) : NULL;
  l->patch = p->copies ? scratch(p, faces, sizeof *l->patch) : NULL;
  l->front = l->patch ? scratch(p, faces, sizeof *l->front) : NULL;
  l->known = l->front ? scratch(p, faces, sizeof *l->known) : NULL;
  l->cut = l->known ? scratch(p, faces, sizeof *l->cut) : NULL;
  p->failed = l->cut ? scratch(p, p->groups.count, sizeof *p->failed) : NULL;
  bool done = p->failed &&
              vxm_duplicates_find(&found, p->state->context, p->soup, kinds, p->copies, &p->error) == VXM_OK;
  l->state = p->state;
  l->copies = p->copies;
  l->groups = &p->groups;
  l->asked = p->asked;
  done = done && vxm_layers_find(l, &p->error) == VXM_OK;
  if (done)
    fail_unknown(p);
  vxm_free(p->state->context, kinds);
  return done;
}

/** Repeated faces that stay where they are: of groups that could not be divided. */
static int64_t count_shared(const parting *p) {
  int64_t count = 0;
  for (size_t f = 0; f < p->soup->face_count; f++) {
    size_t group = p->groups.of_face[f];
    count += p->copies[f].first != f && (!p->asked[group] || p->failed[group]);
  }
  return count;
}

/** Leaves only groups that wind round something one way and round something else the other way. */
static bool keep_mixed(parting *p, bool *any) {
  enum { OUTWARD = 1, INWARD = 2 };
  uint8_t *ways = scratch(p, p->groups.count, sizeof *ways);
  for (size_t f = 0; ways && f < p->soup->face_count; f++) {
    if (!p->asked[p->groups.of_face[f]] || !vxm_layers_stands(&p->layers, f))
      continue;
    int64_t front = p->layers.front[vxm_set_of(p->layers.patch, f)];
    uint8_t *way = &ways[p->groups.of_face[f]];
    *way |= front + vxm_layers_surplus(&p->layers, f) > 0 ? OUTWARD : 0;
    *way |= front < 0 ? INWARD : 0;
  }
  *any = false;
  for (size_t g = 0; ways && g < p->groups.count; g++) {
    p->asked[g] = p->asked[g] && !p->failed[g] && ways[g] == (OUTWARD | INWARD);
    *any = *any || p->asked[g];
  }
  vxm_free(p->state->context, ways);
  return ways != NULL;
}

static bool divide(parting *p, const uint8_t *touches, bool mixed, bool *changed) {
  vxm_repair_state *state = p->state;
  bool any = true;
  if (!find_layers(p) || (mixed && !keep_mixed(p, &any)))
    return false;
  if (!any)
    return true;
  if (!put_faces(p, touches) || !check_layers(p) || (!mixed && !find_whole(p)))
    return false;
  p->result.count = 0;
  p->any_inward = false;
  if (!put_faces(p, touches)) /* once more, without what is none */
    return false;
  state->shared_faces = count_shared(p);
  int64_t added = 0;
  vxm_status status = vxm_body_faces_build(&p->result, state, &p->rims, &added, &p->error);
  if (status != VXM_OK)
    return fail(p, status);
  state->counts[VXM_PASS_CUT_NONMANIFOLD] += added;
  *changed = true;
  bool turned;
  status = p->any_inward ? vxm_pass_orientation(state, &turned, &p->error) : VXM_OK;
  return status == VXM_OK || fail(p, status);
}

static bool find_groups(parting *p, bool *any, uint8_t **touches) {
  if (vxm_edge_groups_find(&p->groups, p->state, &p->error) != VXM_OK)
    return false;
  *touches = scratch(p, p->groups.count, sizeof **touches);
  p->asked = *touches ? scratch(p, p->groups.count, sizeof *p->asked) : NULL;
  if (!p->asked || vxm_group_rims_find(&p->rims, &p->groups, p->state, &p->error) != VXM_OK ||
      !mark_touching(p, *touches))
    return false;
  for (size_t g = 0; g < p->groups.count; g++) {
    const vxm_edge_group *group = &p->groups.groups[g];
    p->asked[g] = group->balanced && !group->manifold;
    *any = *any || p->asked[g] || (*touches)[g];
  }
  return true;
}

/** Whether it is plain that there is nothing to divide, as in most meshes: no patch touches another. That
 * costs a tenth of looking at the groups. */
static vxm_status is_apart(vxm_repair_state *state, bool *apart, vxm_error *error) {
  *apart = false;
  vxm_status status = vxm_repair_state_patches(state, error);
  return status == VXM_OK && state->has_patches
             ? vxm_patches_are_apart(apart, &state->patches, state->soup, error)
             : status;
}

/** Tells what is known to those who take the soup next; patches that are apart are its components. */
static void hand_on(vxm_repair_state *state) {
  vxm_patches *patches = &state->patches;
  state->soup->component_count = patches->count;
  state->soup->is_closed = patches->is_closed;
  if (patches->count > 1) {
    state->soup->components = patches->of_face;
    patches->of_face = NULL;
  }
  vxm_patches_destroy(patches);
  state->has_patches = false;
}

/** Takes apart what touches with its rims, if patches are not apart, or are only as they touch so. */
static bool part_touching(parting *p, bool *apart, bool *changed) {
  if (*apart && p->state->edges.against == 0)
    return true;
  vxm_status status = vxm_part_flush_bodies(p->state, changed, &p->error);
  return status == VXM_OK && (!*changed || is_apart(p->state, apart, &p->error) == VXM_OK);
}

/** Sheets that hang on bodies would make these open. There are none where no edge has more than two sides. */
static bool cut_sheets(parting *p, bool *changed) {
  vxm_repair_state *state = p->state;
  int64_t added = 0;
  if (!state->has_patches && vxm_cut_hanging_sheets(state, &added, &p->error) != VXM_OK)
    return false;
  state->counts[VXM_PASS_CUT_NONMANIFOLD] += added;
  *changed = *changed || added > 0;
  return true;
}

static vxm_status part(vxm_repair_state *state, bool mixed, bool *changed, vxm_error *error) {
  *changed = false;
  if (state->soup->face_count == 0)
    return VXM_OK;
  parting p = {.state = state, .soup = state->soup, .error = VXM_ERROR_INIT};
  uint8_t *touches = NULL;
  bool any = false, apart;
  bool done = mixed || (is_apart(state, &apart, &p.error) == VXM_OK && part_touching(&p, &apart, changed));
  if (done && !mixed && apart) {
    hand_on(state);
    return VXM_OK;
  }
  done = done && (mixed || cut_sheets(&p, changed)) && vxm_repair_state_edges(state, &p.error) == VXM_OK &&
         find_groups(&p, &any, &touches);
  for (size_t g = 0; done && mixed && g < p.groups.count; g++)
    touches[g] = 0;
  if (done && any)
    done = divide(&p, touches, mixed, changed);
  vxm_free(state->context, p.result.faces);
  vxm_group_rims_destroy(&p.rims, state->context);
  vxm_free(state->context, p.whole);
  vxm_free(state->context, p.failed);
  vxm_free(state->context, p.layers.cut);
  vxm_free(state->context, p.layers.known);
  vxm_free(state->context, p.layers.front);
  vxm_free(state->context, p.layers.patch);
  vxm_free(state->context, p.copies);
  vxm_free(state->context, p.asked);
  vxm_free(state->context, touches);
  vxm_edge_groups_destroy(&p.groups, state->context);
  if (!done)
    vxm_error_pass(error, &p.error);
  return done ? VXM_OK : p.error.code;
}

vxm_status vxm_pass_bodies(vxm_repair_state *state, bool *changed, vxm_error *error) {
  return part(state, false, changed, error);
}

vxm_status vxm_pass_mixed_bodies(vxm_repair_state *state, bool *changed, vxm_error *error) {
  return part(state, true, changed, error);
}
