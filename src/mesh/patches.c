/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/patches.h"

#include "mesh/face_adjacency.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/** A walk over the faces from one to those across its sides. */
typedef struct walk {
  const vxm_soup *soup;
  const uint32_t *adjacent;
  uint32_t *label; /**< per face: its patch, or NONE */
  uint32_t *queue; /**< faces that have a label; room for one more than there are faces */
  bool may_repeat;
} walk;

/** Fetches what will be needed soon, which may lie here and there. */
static inline void look_ahead(const walk *w, uint64_t corner) {
  if (w->adjacent[corner] != NONE)
    __builtin_prefetch(w->label + w->adjacent[corner], 1);
}

/** Gives the faces across the sides of a face its label, and puts those that had none into the queue: without
 * a branch, as nobody can tell which these are. Says how long the queue is then. */
static inline size_t visit(walk *w, uint32_t face, size_t queued) {
  uint32_t label = w->label[face], other = NONE;
  bool same = true;
  for (uint64_t c = w->soup->offsets[face]; c < w->soup->offsets[face + 1]; c++) {
    uint32_t next = w->adjacent[c];
    if (next == NONE)
      continue;
    same &= (next < face) & ((other == NONE) | (next == other));
    other = next;
    w->queue[queued] = next;
    queued += w->label[next] == NONE;
    w->label[next] = label;
  }
  w->may_repeat |= same && other != NONE;
  return queued;
}

/** Labels what edges connect with a face. */
static vxm_status visit_patch(walk *w, uint32_t first, uint32_t label, vxm_error *error) {
  enum { AHEAD = 8 };
  vxm_status status = VXM_OK;
  w->label[first] = label;
  w->queue[0] = first;
  for (size_t at = 0, queued = 1; at < queued && status == VXM_OK; at++) {
    if (at + AHEAD < queued)
      look_ahead(w, w->soup->offsets[w->queue[at + AHEAD]]);
    queued = visit(w, w->queue[at], queued);
    status = vxm_check_cancelled_at(at + 1, w->soup->context, error);
  }
  return status;
}

/** Patches are numbered in the order of their first faces, as each is walked over from there. */
static vxm_status visit_all(vxm_patches *out, const vxm_soup *soup, const uint32_t *adjacent,
                            vxm_error *error) {
  vxm_status status = VXM_OK;
  walk w = {.soup = soup, .adjacent = adjacent, .label = out->of_face};
  w.queue = vxm_alloc(out->context, soup->face_count + 1, sizeof *w.queue, error);
  if (!w.queue)
    return error->code;
  memset(w.label, 0xff, soup->face_count * sizeof *w.label); /* NONE */
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    if (w.label[f] == NONE)
      status = visit_patch(&w, (uint32_t)f, (uint32_t)out->count++, error);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(f, out->context, error);
  }
  vxm_free(out->context, w.queue);
  out->may_repeat = w.may_repeat;
  return status;
}

/** What lies across the sides along edges, in a soup with edges of one side, across which lies the face
 * itself, or whose two run the same way. */
static vxm_status find_adjacent(uint32_t **adjacent, const vxm_soup *soup, const vxm_edges *edges,
                                vxm_error *error) {
  vxm_context *context = soup->context;
  const uint32_t *sides = edges->sides;
  *adjacent = vxm_alloc(context, soup->corner_count, sizeof **adjacent, error);
  uint32_t *both = *adjacent ? vxm_calloc(context, edges->count, sizeof *both, error) : NULL;
  if (!both)
    return error->code;
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      if (sides[c] != VXM_NO_EDGE && edges->edges[sides[c]].count == 2)
        both[sides[c]] ^= (uint32_t)f; /* the number of the one and that of the other */
    status = vxm_check_cancelled_at(f, context, error);
  }
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      (*adjacent)[c] = sides[c] != VXM_NO_EDGE ? both[sides[c]] ^ (uint32_t)f : VXM_NO_ADJACENT;
    status = vxm_check_cancelled_at(f, context, error);
  }
  vxm_free(context, both);
  return status;
}

static vxm_status build(vxm_patches *out, const vxm_soup *soup, const vxm_edges *edges, vxm_error *error) {
  if (soup->face_count >= UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu faces are too many to number; split the mesh",
                    soup->face_count);
  uint32_t *adjacent = NULL;
  vxm_status status = VXM_OK;
  out->is_closed = edges->open == 0;
  out->of_face = vxm_alloc(out->context, soup->face_count, sizeof *out->of_face, error);
  if (!out->of_face)
    return error->code;
  if (!edges->adjacent)
    status = find_adjacent(&adjacent, soup, edges, error);
  if (status == VXM_OK)
    status = visit_all(out, soup, edges->adjacent ? edges->adjacent : adjacent, error);
  vxm_free(out->context, adjacent);
  return status;
}

vxm_status vxm_patches_build(vxm_patches *out, const vxm_soup *soup, const vxm_edges *edges,
                             vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *out = (vxm_patches){.context = soup->context};
  vxm_status status = build(out, soup, edges, &local);
  if (status != VXM_OK) {
    vxm_patches_destroy(out);
    vxm_error_pass(error, &local);
  }
  return status;
}

void vxm_patches_destroy(vxm_patches *patches) {
  if (!patches->context)
    return;
  vxm_free(patches->context, patches->of_face);
  *patches = (vxm_patches){0};
}

vxm_status vxm_patches_are_apart(bool *apart, const vxm_patches *patches, const vxm_soup *soup,
                                 vxm_error *error) {
  *apart = true;
  if (patches->count < 2)
    return VXM_OK;
  vxm_status status = VXM_OK;
  uint32_t *at = vxm_try_alloc(soup->context, soup->vertex_count, sizeof *at, &status, error);
  if (!at)
    return status;
  memset(at, 0xff, soup->vertex_count * sizeof *at); /* NONE */
  for (size_t f = 0; f < soup->face_count && *apart; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      uint32_t *patch = &at[soup->indices[c]];
      *apart = *apart && (*patch == NONE || *patch == patches->of_face[f]);
      *patch = patches->of_face[f];
    }
  vxm_free(soup->context, at);
  return VXM_OK;
}
