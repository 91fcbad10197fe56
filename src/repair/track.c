/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/track.h"

#include "mesh/components.h"
#include "mesh/part_state.h"
#include "mesh/weld.h"
#include "repair/crossings.h"

#include <inttypes.h>
#include <math.h>

static const uint32_t NO_PART = UINT32_MAX;

struct vxm_track {
  vxm_context *context;
  const vxm_soup *in;
  size_t part_count;
  uint32_t *face_part;     /**< per face of `in` */
  uint32_t *vertex_part;   /**< per vertex of `in`, or NO_PART */
  uint32_t *into;          /**< per vertex of `in`: the one that it was merged into, or itself */
  double *settled, *later; /**< per part: largest distance until vertices lost their numbers, and since */
  int64_t *flipped;        /**< per part */
  uint8_t *left;           /**< per part: not united */
};

static bool allocate(vxm_track *track, vxm_error *error) {
  const vxm_soup *in = track->in;
  track->face_part = vxm_alloc(track->context, in->face_count, sizeof *track->face_part, error);
  if (track->face_part)
    track->vertex_part = vxm_alloc(track->context, in->vertex_count, sizeof *track->vertex_part, error);
  if (track->vertex_part)
    track->into = vxm_alloc(track->context, in->vertex_count, sizeof *track->into, error);
  return track->into != NULL;
}

static bool allocate_parts(vxm_track *track, vxm_error *error) {
  track->settled = vxm_calloc(track->context, track->part_count, sizeof *track->settled, error);
  if (track->settled)
    track->later = vxm_calloc(track->context, track->part_count, sizeof *track->later, error);
  if (track->later)
    track->flipped = vxm_calloc(track->context, track->part_count, sizeof *track->flipped, error);
  if (track->flipped)
    track->left = vxm_calloc(track->context, track->part_count, sizeof *track->left, error);
  return track->left != NULL;
}

static void label(vxm_track *track, vxm_soup *copy) {
  const vxm_soup *in = track->in;
  for (size_t v = 0; v < in->vertex_count; v++) {
    track->vertex_part[v] = NO_PART;
    track->into[v] = (uint32_t)v;
  }
  for (size_t f = 0; f < in->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(in, f, &count);
    copy->face_parts[f] = track->face_part[f];
    for (size_t i = 0; i < count; i++)
      track->vertex_part[corner[i]] = track->face_part[f];
  }
}

static vxm_status find_parts(vxm_track *track, vxm_error *error) {
  const vxm_soup *in = track->in;
  /* `into` serves as the map of the weld until it gets its own content. */
  vxm_status status =
      vxm_weld_exact(track->context, in->positions, in->vertex_count, track->into, NULL, error);
  if (status != VXM_OK)
    return status;
  return vxm_components(track->context, in, track->into, track->face_part, &track->part_count, error);
}

vxm_status vxm_track_create(vxm_track **out, vxm_soup *copy, const vxm_soup *in, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_track *track = vxm_calloc(in->context, 1, sizeof *track, &local);
  *out = NULL;
  if (track) {
    track->context = in->context;
    track->in = in;
    if (allocate(track, &local) && find_parts(track, &local) == VXM_OK && allocate_parts(track, &local))
      copy->face_parts = vxm_alloc(track->context, in->face_count, sizeof *copy->face_parts, &local);
  }
  if (local.code != VXM_OK) {
    vxm_track_destroy(track);
    if (error)
      *error = local;
    return local.code;
  }
  label(track, copy);
  *out = track;
  return VXM_OK;
}

void vxm_track_destroy(vxm_track *track) {
  if (!track)
    return;
  vxm_free(track->context, track->left);
  vxm_free(track->context, track->flipped);
  vxm_free(track->context, track->later);
  vxm_free(track->context, track->settled);
  vxm_free(track->context, track->into);
  vxm_free(track->context, track->vertex_part);
  vxm_free(track->context, track->face_part);
  vxm_free(track->context, track);
}

void vxm_track_merge(vxm_track *track, const uint32_t *map) {
  for (size_t v = 0; v < track->in->vertex_count; v++)
    track->into[v] = map[track->into[v]];
}

void vxm_track_turn(vxm_track *track, uint32_t part) {
  track->flipped[part]++;
}

bool vxm_track_leave(vxm_track *track, uint32_t part) {
  bool known = track->left[part] != 0;
  track->left[part] = 1;
  return !known;
}

void vxm_track_settle(vxm_track *track, const vxm_soup *soup) {
  for (size_t v = 0; v < track->in->vertex_count; v++) {
    const double *from = vxm_position(track->in, v), *to = vxm_position(soup, track->into[v]);
    double distance = hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
    uint32_t part = track->vertex_part[v];
    if (part != NO_PART && isfinite(distance))
      track->settled[part] = fmax(track->settled[part], distance);
  }
}

void vxm_track_move(vxm_track *track, uint32_t part, double distance) {
  track->later[part] = fmax(track->later[part], distance);
}

/* ---- The account ---- */

static double diagonal_of(const double bounds[6]) {
  return hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
}

/** By how much a part has changed, as a fraction: the larger of volume and bounds. */
static double change_of(const vxm_part_change *part) {
  const vxm_part_state *before = &part->before, *after = &part->after;
  double diagonal = diagonal_of(before->bounds), most = 0;
  for (int i = 0; i < 6 && diagonal > 0; i++)
    most = fmax(most, fabs(after->bounds[i] - before->bounds[i]) / diagonal);
  /* Turning a part over changes the sign of its volume, which is what orientation is for. */
  double volume = fabs(before->volume), difference = fabs(fabs(after->volume) - volume);
  if (before->closed && volume > 0)
    most = fmax(most, difference / volume);
  return most;
}

/** A part whose faces have all gone is no change: they had no area, or it was to be dropped. */
static vxm_status check(const vxm_soup *soup, double max_change, vxm_error *error) {
  for (size_t i = 0; i < soup->part_count; i++) {
    const vxm_part_change *part = &soup->part_changes[i];
    if (part->after.faces > 0 && change_of(part) > max_change)
      return vxm_fail(
          error, VXM_ERROR_UNREACHED,
          "the repair changes the volume or bounds of part %zu (%" PRId64
          " faces) by %.3g %%, more than the %.3g %% allowed; allow more (--max-change), or ask for less",
          i, part->before.faces, 100 * change_of(part), 100 * max_change);
  }
  return VXM_OK;
}

static vxm_status measure(vxm_track *track, vxm_soup *soup, vxm_part_state *states, vxm_error *error) {
  vxm_status status = vxm_part_states(states, track->part_count, track->in, track->face_part, error);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++)
    soup->part_changes[i] = (vxm_part_change){.before = states[i],
                                              .flipped = track->flipped[i],
                                              .moved = track->settled[i] + track->later[i],
                                              .tag = UINT32_MAX,
                                              .after = {.self_intersections = -1},
                                              .ununited = track->left[i]};
  for (size_t f = track->in->face_count; status == VXM_OK && track->in->face_tags && f-- > 0;)
    soup->part_changes[track->face_part[f]].tag = track->in->face_tags[f];
  if (status != VXM_OK || !soup->face_parts) /* a wrap has no parts */
    return status;
  status = vxm_part_states(states, track->part_count, soup, soup->face_parts, error);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++)
    soup->part_changes[i].after = states[i];
  return status;
}

vxm_status vxm_track_finish(vxm_track *track, vxm_soup *soup, double max_change, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *states = vxm_alloc(track->context, track->part_count, sizeof *states, &local);
  if (states)
    soup->part_changes = vxm_alloc(track->context, track->part_count, sizeof *soup->part_changes, &local);
  vxm_status status = soup->part_changes ? measure(track, soup, states, &local) : local.code;
  vxm_free(track->context, states);
  soup->part_count = status == VXM_OK ? track->part_count : 0;
  if (status == VXM_OK && max_change > 0)
    status = check(soup, max_change, &local);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

vxm_status vxm_track_count_crossings(vxm_track *track, vxm_soup *soup, int64_t totals[2], vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *states = vxm_calloc(track->context, track->part_count, sizeof *states, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_crossings_count(&totals[0], states, track->part_count, track->face_part, track->in, &local);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++)
    soup->part_changes[i].before.self_intersections = states[i].self_intersections;
  bool parts = soup->face_parts != NULL;
  if (status == VXM_OK)
    status = vxm_crossings_count(&totals[1], parts ? states : NULL, track->part_count, soup->face_parts, soup,
                                 &local);
  for (size_t i = 0; status == VXM_OK && parts && i < track->part_count; i++)
    soup->part_changes[i].after.self_intersections = states[i].self_intersections;
  vxm_free(track->context, states);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}
