/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/provenance.h"

#include "base/exact_math.h"
#include "mesh/components.h"
#include "mesh/part_census.h"
#include "mesh/weld.h"
#include "repair/state/self_intersections.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const uint32_t NO_PART = UINT32_MAX;
/** Of the squared diagonal of a part: with no more area it is nothing that could be lost. */
static const double NO_AREA = 1e-12;

/** What becomes of a part, at one time. */
typedef struct known_part {
  double moved;
  bool left, dropped;
} known_part;

struct vxm_provenance {
  vxm_context *context;
  const vxm_soup *in;
  size_t part_count;
  uint32_t *face_part; /**< per face of `in` */
  double *reference;   /**< per part: its volume, to compare with; or NULL */
  double *moved;       /**< per part: no vertex was moved farther, by all stages together */
  double *most;        /**< per part, scratch: largest distance in a stage */
  int64_t *flipped;    /**< per part */
  bool *dropped;       /**< per part: it was to be */
  bool *left;          /**< per part: it was to be united and was not */
  known_part *known;   /**< per part, or NULL: what to go back to */
  /* The present stage: as long as it lasts, vertices keep their numbers. */
  size_t vertex_count;
  double *from;          /**< per vertex: where it began */
  uint32_t *vertex_part; /**< or NO_PART */
  uint32_t *into;        /**< the vertex that it was merged into, or itself */
};

static void free_stage(vxm_provenance *track) {
  vxm_free(track->context, track->into);
  vxm_free(track->context, track->vertex_part);
  vxm_free(track->context, track->from);
  track->into = track->vertex_part = NULL;
  track->from = NULL;
  track->vertex_count = 0;
}

static bool allocate_parts(vxm_provenance *track, vxm_error *error) {
  track->moved = vxm_calloc(track->context, track->part_count, sizeof *track->moved, error);
  if (track->moved)
    track->most = vxm_calloc(track->context, track->part_count, sizeof *track->most, error);
  if (track->most)
    track->flipped = vxm_calloc(track->context, track->part_count, sizeof *track->flipped, error);
  if (track->flipped)
    track->dropped = vxm_calloc(track->context, track->part_count, sizeof *track->dropped, error);
  if (track->dropped)
    track->left = vxm_calloc(track->context, track->part_count, sizeof *track->left, error);
  return track->left != NULL;
}

vxm_status vxm_provenance_start(vxm_provenance *track, const vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t count = soup->vertex_count;
  free_stage(track);
  if (!soup->face_parts) /* a wrap has no parts */
    return VXM_OK;
  track->from = vxm_alloc(track->context, count, 3 * sizeof *track->from, &local);
  if (track->from)
    track->vertex_part = vxm_alloc(track->context, count, sizeof *track->vertex_part, &local);
  if (track->vertex_part)
    track->into = vxm_alloc(track->context, count, sizeof *track->into, &local);
  if (!track->into) {
    free_stage(track);
    vxm_error_pass(error, &local);
    return local.code;
  }
  track->vertex_count = count;
  if (count > 0)
    memcpy(track->from, soup->positions, 3 * count * sizeof *track->from);
  for (size_t v = 0; v < count; v++) {
    track->vertex_part[v] = NO_PART;
    track->into[v] = (uint32_t)v;
  }
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_ask_at(f, track->context, error);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      track->vertex_part[soup->indices[c]] = soup->face_parts[f];
  }
  return status;
}

static vxm_status find_parts(vxm_provenance *track, vxm_error *error) {
  const vxm_soup *in = track->in;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *map = vxm_alloc(track->context, in->vertex_count, sizeof *map, &local);
  vxm_status status =
      map ? vxm_weld_exact(track->context, in->positions, in->vertex_count, map, NULL, &local) : local.code;
  if (status == VXM_OK)
    status = vxm_components(track->context, in, map, track->face_part, &track->part_count, &local);
  vxm_free(track->context, map);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_provenance_create(vxm_provenance **out, vxm_soup *copy, const vxm_soup *in, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_provenance *track = vxm_calloc(in->context, 1, sizeof *track, &local);
  *out = NULL;
  if (track) {
    track->context = in->context;
    track->in = in;
    track->face_part = vxm_alloc(track->context, in->face_count, sizeof *track->face_part, &local);
    if (track->face_part && find_parts(track, &local) == VXM_OK && allocate_parts(track, &local))
      copy->face_parts = vxm_alloc(track->context, in->face_count, sizeof *copy->face_parts, &local);
  }
  if (local.code == VXM_OK) {
    if (in->face_count > 0)
      memcpy(copy->face_parts, track->face_part, in->face_count * sizeof *copy->face_parts);
    vxm_provenance_start(track, copy, &local);
  }
  if (local.code != VXM_OK) {
    vxm_provenance_destroy(track);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = track;
  return VXM_OK;
}

void vxm_provenance_destroy(vxm_provenance *track) {
  if (!track)
    return;
  free_stage(track);
  vxm_free(track->context, track->known);
  vxm_free(track->context, track->left);
  vxm_free(track->context, track->dropped);
  vxm_free(track->context, track->flipped);
  vxm_free(track->context, track->most);
  vxm_free(track->context, track->moved);
  vxm_free(track->context, track->reference);
  vxm_free(track->context, track->face_part);
  vxm_free(track->context, track);
}

void vxm_provenance_merge(vxm_provenance *track, const uint32_t *map) {
  for (size_t v = 0; v < track->vertex_count; v++)
    track->into[v] = map[track->into[v]];
}

void vxm_provenance_turn(vxm_provenance *track, uint32_t part) {
  track->flipped[part]++;
}

size_t vxm_provenance_part_count(const vxm_provenance *track) {
  return track->part_count;
}

bool vxm_provenance_leave(vxm_provenance *track, uint32_t part) {
  bool known = track->left[part];
  track->left[part] = true;
  return !known;
}

void vxm_provenance_forget_left(vxm_provenance *track) {
  for (size_t i = 0; i < track->part_count; i++)
    track->left[i] = false;
}

vxm_status vxm_provenance_remember(vxm_provenance *track, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(track->context, track->known);
  track->known = vxm_alloc(track->context, track->part_count, sizeof *track->known, &local);
  for (size_t i = 0; track->known && i < track->part_count; i++)
    track->known[i] = (known_part){track->moved[i], track->left[i], track->dropped[i]};
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

void vxm_provenance_recall(vxm_provenance *track) {
  for (size_t i = 0; i < track->part_count; i++) {
    track->moved[i] = track->known[i].moved;
    track->left[i] = track->known[i].left;
    track->dropped[i] = track->known[i].dropped;
  }
  free_stage(track);
}

void vxm_provenance_drop(vxm_provenance *track, uint32_t part) {
  track->dropped[part] = true;
}

vxm_status vxm_provenance_settle(vxm_provenance *track, const vxm_soup *soup, vxm_error *error) {
  for (size_t i = 0; i < track->part_count; i++)
    track->most[i] = 0;
  for (size_t v = 0; v < track->vertex_count; v++) {
    const double *from = track->from + 3 * v, *to = vxm_position(soup, track->into[v]);
    vxm_status status = vxm_ask_at(v, track->context, error);
    if (status != VXM_OK)
      return status;
    double distance = vxm_length3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    uint32_t part = track->vertex_part[v];
    if (part != NO_PART && isfinite(distance))
      track->most[part] = fmax(track->most[part], distance);
  }
  for (size_t i = 0; i < track->part_count; i++)
    track->moved[i] += track->most[i];
  free_stage(track);
  return VXM_OK;
}

/* ---- The account ---- */

static double diagonal_of(const double bounds[6]) {
  return vxm_length3(bounds[3] - bounds[0], bounds[4] - bounds[1], bounds[5] - bounds[2]);
}

/** A part without volume to speak of, whose faces have all gone for that. */
static bool was_nothing(const vxm_part_state *before) {
  double diagonal = diagonal_of(before->bounds);
  return !(before->area > NO_AREA * diagonal * diagonal);
}

/** By how much a part has changed, as a fraction: the larger of volume and bounds. */
static double change_of(const vxm_provenance *track, const vxm_soup *soup, size_t i) {
  const vxm_part_state *before = soup->part_changes[i].before, *after = soup->part_changes[i].after;
  double diagonal = diagonal_of(before->bounds), most = 0;
  if (after->faces == 0)
    return before->faces == 0 || track->dropped[i] || was_nothing(before) ? 0 : 1;
  for (int a = 0; a < 6 && diagonal > 0; a++)
    most = fmax(most, fabs(after->bounds[a] - before->bounds[a]) / diagonal);
  /* Turning a part over changes the sign of its volume, which is what orientation is for. */
  double volume = fabs(track->reference[i]), difference = fabs(fabs(after->volume) - volume);
  if (before->closed && !isfinite(difference))
    return INFINITY;
  if (before->closed && volume > 0)
    most = fmax(most, difference / volume);
  return most;
}

static vxm_status check(const vxm_provenance *track, const vxm_soup *soup, double max_change,
                        vxm_error *error) {
  for (size_t i = 0; i < soup->part_count; i++) {
    const vxm_part_change *part = &soup->part_changes[i];
    double change = change_of(track, soup, i);
    if (!(change > max_change))
      continue;
    if (part->after->faces == 0)
      return vxm_fail(error, VXM_ERROR_UNREACHED,
                      "the repair leaves nothing of part %zu (%" PRId64
                      " faces); leave out --max-change, or ask for less",
                      i, part->before->faces);
    if (!isfinite(change))
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "the volume or bounds of part %zu (%" PRId64
                      " faces) are beyond the range of numbers, so that --max-change cannot hold them; scale "
                      "the mesh down",
                      i, part->before->faces);
    return vxm_fail(
        error, VXM_ERROR_UNREACHED,
        "the repair changes the volume or bounds of part %zu (%" PRId64
        " faces) by %.3g %%, more than the %.3g %% allowed; allow more (--max-change), or ask for less",
        i, part->before->faces, 100 * change, 100 * max_change);
  }
  return VXM_OK;
}

/**
 * Which volume a part had. Where all is in order it is told before; where faces were repeated, or turned
 * against each other, what has come of that, at the positions from before.
 */
vxm_status vxm_provenance_refer(vxm_provenance *track, const vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *before = vxm_alloc(track->context, track->part_count, sizeof *before, &local);
  vxm_part_state *now = before ? vxm_alloc(track->context, track->part_count, sizeof *now, &local) : NULL;
  if (now)
    track->reference = vxm_calloc(track->context, track->part_count, sizeof *track->reference, &local);
  vxm_soup as_it_was = *soup;
  as_it_was.positions = track->from;
  vxm_status status =
      track->reference && track->from
          ? vxm_part_census_all(before, track->part_count, track->in, track->face_part, &local)
          : local.code;
  if (status == VXM_OK)
    status = vxm_part_census_all(now, track->part_count, &as_it_was, soup->face_parts, &local);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++) {
    bool in_order = before[i].nonmanifold_edges == 0 && before[i].inconsistent_edges == 0;
    track->reference[i] = in_order || now[i].faces == 0 ? before[i].volume : now[i].volume;
  }
  vxm_free(track->context, now);
  vxm_free(track->context, before);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status measure(vxm_provenance *track, vxm_soup *soup, vxm_error *error) {
  vxm_part_state *before = soup->part_states, *after = before + track->part_count;
  vxm_status status = vxm_part_census_all(before, track->part_count, track->in, track->face_part, error);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++) {
    after[i] = (vxm_part_state){.size = sizeof *after, .self_intersections = -1};
    soup->part_changes[i] = (vxm_part_change){.size = sizeof *soup->part_changes,
                                              .before = &before[i],
                                              .flipped = track->flipped[i],
                                              .max_displacement = track->moved[i],
                                              .tag = UINT32_MAX,
                                              .after = &after[i],
                                              .union_failed = track->left[i]};
  }
  for (size_t f = track->in->face_count; status == VXM_OK && track->in->face_tags && f-- > 0;)
    soup->part_changes[track->face_part[f]].tag = track->in->face_tags[f];
  if (status != VXM_OK || !soup->face_parts) /* a wrap has no parts */
    return status;
  return vxm_part_census_all(after, track->part_count, soup, soup->face_parts, error);
}

vxm_status vxm_provenance_finish(vxm_provenance *track, vxm_soup *soup, double max_change, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  soup->part_states = vxm_alloc(track->context, 2 * track->part_count, sizeof *soup->part_states, &local);
  if (soup->part_states)
    soup->part_changes = vxm_alloc(track->context, track->part_count, sizeof *soup->part_changes, &local);
  vxm_status status = soup->part_changes ? measure(track, soup, &local) : local.code;
  soup->part_count = status == VXM_OK ? track->part_count : 0;
  if (status == VXM_OK && max_change > 0)
    status = check(track, soup, max_change, &local);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_provenance_count_crossings(vxm_provenance *track, vxm_soup *soup, int64_t totals[2],
                                          vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *states = vxm_calloc(track->context, track->part_count, sizeof *states, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_self_intersections_count(&totals[0], states, track->part_count, track->face_part, track->in,
                                          &local);
  for (size_t i = 0; status == VXM_OK && i < track->part_count; i++)
    soup->part_states[i].self_intersections = states[i].self_intersections;
  bool parts = soup->face_parts != NULL;
  if (status == VXM_OK)
    status = vxm_self_intersections_count(&totals[1], parts ? states : NULL, track->part_count,
                                          soup->face_parts, soup, &local);
  for (size_t i = 0; status == VXM_OK && parts && i < track->part_count; i++)
    soup->part_states[track->part_count + i].self_intersections = states[i].self_intersections;
  vxm_free(track->context, states);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
