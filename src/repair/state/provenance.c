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

static void free_stage(vxm_provenance *provenance) {
  vxm_free(provenance->context, provenance->into);
  vxm_free(provenance->context, provenance->vertex_part);
  vxm_free(provenance->context, provenance->from);
  provenance->into = provenance->vertex_part = NULL;
  provenance->from = NULL;
  provenance->vertex_count = 0;
}

static bool allocate_parts(vxm_provenance *provenance, vxm_error *error) {
  provenance->moved =
      vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->moved, error);
  if (provenance->moved)
    provenance->most =
        vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->most, error);
  if (provenance->most)
    provenance->flipped =
        vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->flipped, error);
  if (provenance->flipped)
    provenance->dropped =
        vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->dropped, error);
  if (provenance->dropped)
    provenance->left =
        vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->left, error);
  return provenance->left != NULL;
}

vxm_status vxm_provenance_start(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t count = soup->vertex_count;
  free_stage(provenance);
  if (!soup->face_parts) /* a wrap has no parts */
    return VXM_OK;
  provenance->from = vxm_alloc(provenance->context, count, 3 * sizeof *provenance->from, &local);
  if (provenance->from)
    provenance->vertex_part = vxm_alloc(provenance->context, count, sizeof *provenance->vertex_part, &local);
  if (provenance->vertex_part)
    provenance->into = vxm_alloc(provenance->context, count, sizeof *provenance->into, &local);
  if (!provenance->into) {
    free_stage(provenance);
    vxm_error_pass(error, &local);
    return local.code;
  }
  provenance->vertex_count = count;
  if (count > 0)
    memcpy(provenance->from, soup->positions, 3 * count * sizeof *provenance->from);
  for (size_t v = 0; v < count; v++) {
    provenance->vertex_part[v] = NO_PART;
    provenance->into[v] = (uint32_t)v;
  }
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    status = vxm_check_cancelled_at(f, provenance->context, error);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      provenance->vertex_part[soup->indices[c]] = soup->face_parts[f];
  }
  return status;
}

static vxm_status find_parts(vxm_provenance *provenance, vxm_error *error) {
  const vxm_soup *in = provenance->in;
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *map = vxm_alloc(provenance->context, in->vertex_count, sizeof *map, &local);
  vxm_status status =
      map ? vxm_weld_exact(provenance->context, in->positions, in->vertex_count, map, NULL, &local)
          : local.code;
  if (status == VXM_OK)
    status =
        vxm_components(provenance->context, in, map, provenance->face_part, &provenance->part_count, &local);
  vxm_free(provenance->context, map);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_provenance_create(vxm_provenance **out, vxm_soup *copy, const vxm_soup *in, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_provenance *provenance = vxm_calloc(in->context, 1, sizeof *provenance, &local);
  *out = NULL;
  if (provenance) {
    provenance->context = in->context;
    provenance->in = in;
    provenance->face_part =
        vxm_alloc(provenance->context, in->face_count, sizeof *provenance->face_part, &local);
    if (provenance->face_part && find_parts(provenance, &local) == VXM_OK &&
        allocate_parts(provenance, &local))
      copy->face_parts = vxm_alloc(provenance->context, in->face_count, sizeof *copy->face_parts, &local);
  }
  if (local.code == VXM_OK) {
    if (in->face_count > 0)
      memcpy(copy->face_parts, provenance->face_part, in->face_count * sizeof *copy->face_parts);
    vxm_provenance_start(provenance, copy, &local);
  }
  if (local.code != VXM_OK) {
    vxm_provenance_destroy(provenance);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = provenance;
  return VXM_OK;
}

void vxm_provenance_destroy(vxm_provenance *provenance) {
  if (!provenance)
    return;
  free_stage(provenance);
  vxm_free(provenance->context, provenance->known);
  vxm_free(provenance->context, provenance->left);
  vxm_free(provenance->context, provenance->dropped);
  vxm_free(provenance->context, provenance->flipped);
  vxm_free(provenance->context, provenance->most);
  vxm_free(provenance->context, provenance->moved);
  vxm_free(provenance->context, provenance->reference);
  vxm_free(provenance->context, provenance->face_part);
  vxm_free(provenance->context, provenance);
}

void vxm_provenance_merge(vxm_provenance *provenance, const uint32_t *map) {
  for (size_t v = 0; v < provenance->vertex_count; v++)
    provenance->into[v] = map[provenance->into[v]];
}

void vxm_provenance_turn(vxm_provenance *provenance, uint32_t part) {
  provenance->flipped[part]++;
}

size_t vxm_provenance_part_count(const vxm_provenance *provenance) {
  return provenance->part_count;
}

bool vxm_provenance_leave(vxm_provenance *provenance, uint32_t part) {
  bool known = provenance->left[part];
  provenance->left[part] = true;
  return !known;
}

void vxm_provenance_forget_left(vxm_provenance *provenance) {
  for (size_t i = 0; i < provenance->part_count; i++)
    provenance->left[i] = false;
}

vxm_status vxm_provenance_remember(vxm_provenance *provenance, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(provenance->context, provenance->known);
  provenance->known =
      vxm_alloc(provenance->context, provenance->part_count, sizeof *provenance->known, &local);
  for (size_t i = 0; provenance->known && i < provenance->part_count; i++)
    provenance->known[i] = (known_part){provenance->moved[i], provenance->left[i], provenance->dropped[i]};
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

void vxm_provenance_recall(vxm_provenance *provenance) {
  for (size_t i = 0; i < provenance->part_count; i++) {
    provenance->moved[i] = provenance->known[i].moved;
    provenance->left[i] = provenance->known[i].left;
    provenance->dropped[i] = provenance->known[i].dropped;
  }
  free_stage(provenance);
}

void vxm_provenance_drop(vxm_provenance *provenance, uint32_t part) {
  provenance->dropped[part] = true;
}

vxm_status vxm_provenance_settle(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error) {
  for (size_t i = 0; i < provenance->part_count; i++)
    provenance->most[i] = 0;
  for (size_t v = 0; v < provenance->vertex_count; v++) {
    const double *from = provenance->from + 3 * v, *to = vxm_position(soup, provenance->into[v]);
    vxm_status status = vxm_check_cancelled_at(v, provenance->context, error);
    if (status != VXM_OK)
      return status;
    double distance = vxm_length3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    uint32_t part = provenance->vertex_part[v];
    if (part != NO_PART && isfinite(distance))
      provenance->most[part] = fmax(provenance->most[part], distance);
  }
  for (size_t i = 0; i < provenance->part_count; i++)
    provenance->moved[i] += provenance->most[i];
  free_stage(provenance);
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
static double change_of(const vxm_provenance *provenance, const vxm_soup *soup, size_t i) {
  const vxm_part_state *before = soup->part_changes[i].before, *after = soup->part_changes[i].after;
  double diagonal = diagonal_of(before->bounds), most = 0;
  if (after->faces == 0)
    return before->faces == 0 || provenance->dropped[i] || was_nothing(before) ? 0 : 1;
  for (int a = 0; a < 6 && diagonal > 0; a++)
    most = fmax(most, fabs(after->bounds[a] - before->bounds[a]) / diagonal);
  /* Turning a part over changes the sign of its volume, which is what orientation is for. */
  double volume = fabs(provenance->reference[i]), difference = fabs(fabs(after->volume) - volume);
  if (before->closed && !isfinite(difference))
    return INFINITY;
  if (before->closed && volume > 0)
    most = fmax(most, difference / volume);
  return most;
}

static vxm_status check(const vxm_provenance *provenance, const vxm_soup *soup, double max_change,
                        vxm_error *error) {
  for (size_t i = 0; i < soup->part_count; i++) {
    const vxm_part_change *part = &soup->part_changes[i];
    double change = change_of(provenance, soup, i);
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
vxm_status vxm_provenance_refer(vxm_provenance *provenance, const vxm_soup *soup, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *before = vxm_alloc(provenance->context, provenance->part_count, sizeof *before, &local);
  vxm_part_state *now =
      before ? vxm_alloc(provenance->context, provenance->part_count, sizeof *now, &local) : NULL;
  if (now)
    provenance->reference =
        vxm_calloc(provenance->context, provenance->part_count, sizeof *provenance->reference, &local);
  vxm_soup as_it_was = *soup;
  as_it_was.positions = provenance->from;
  vxm_status status =
      provenance->reference && provenance->from
          ? vxm_part_census_all(before, provenance->part_count, provenance->in, provenance->face_part, &local)
          : local.code;
  if (status == VXM_OK)
    status = vxm_part_census_all(now, provenance->part_count, &as_it_was, soup->face_parts, &local);
  for (size_t i = 0; status == VXM_OK && i < provenance->part_count; i++) {
    bool in_order = before[i].nonmanifold_edges == 0 && before[i].inconsistent_edges == 0;
    provenance->reference[i] = in_order || now[i].faces == 0 ? before[i].volume : now[i].volume;
  }
  vxm_free(provenance->context, now);
  vxm_free(provenance->context, before);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status measure(vxm_provenance *provenance, vxm_soup *soup, vxm_error *error) {
  vxm_part_state *before = soup->part_states, *after = before + provenance->part_count;
  vxm_status status =
      vxm_part_census_all(before, provenance->part_count, provenance->in, provenance->face_part, error);
  for (size_t i = 0; status == VXM_OK && i < provenance->part_count; i++) {
    after[i] = (vxm_part_state){.size = sizeof *after, .self_intersections = -1};
    soup->part_changes[i] = (vxm_part_change){.size = sizeof *soup->part_changes,
                                              .before = &before[i],
                                              .flipped = provenance->flipped[i],
                                              .max_displacement = provenance->moved[i],
                                              .tag = UINT32_MAX,
                                              .after = &after[i],
                                              .union_failed = provenance->left[i]};
  }
  for (size_t f = provenance->in->face_count; status == VXM_OK && provenance->in->face_tags && f-- > 0;)
    soup->part_changes[provenance->face_part[f]].tag = provenance->in->face_tags[f];
  if (status != VXM_OK || !soup->face_parts) /* a wrap has no parts */
    return status;
  return vxm_part_census_all(after, provenance->part_count, soup, soup->face_parts, error);
}

vxm_status vxm_provenance_finish(vxm_provenance *provenance, vxm_soup *soup, double max_change,
                                 vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  soup->part_states =
      vxm_alloc(provenance->context, 2 * provenance->part_count, sizeof *soup->part_states, &local);
  if (soup->part_states)
    soup->part_changes =
        vxm_alloc(provenance->context, provenance->part_count, sizeof *soup->part_changes, &local);
  vxm_status status = soup->part_changes ? measure(provenance, soup, &local) : local.code;
  soup->part_count = status == VXM_OK ? provenance->part_count : 0;
  if (status == VXM_OK && max_change > 0)
    status = check(provenance, soup, max_change, &local);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_provenance_count_crossings(vxm_provenance *provenance, vxm_soup *soup, int64_t totals[2],
                                          vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_part_state *states = vxm_calloc(provenance->context, provenance->part_count, sizeof *states, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_self_intersections_count(&totals[0], states, provenance->part_count, provenance->face_part,
                                          provenance->in, &local);
  for (size_t i = 0; status == VXM_OK && i < provenance->part_count; i++)
    soup->part_states[i].self_intersections = states[i].self_intersections;
  bool parts = soup->face_parts != NULL;
  if (status == VXM_OK)
    status = vxm_self_intersections_count(&totals[1], parts ? states : NULL, provenance->part_count,
                                          soup->face_parts, soup, &local);
  for (size_t i = 0; status == VXM_OK && parts && i < provenance->part_count; i++)
    soup->part_states[provenance->part_count + i].self_intersections = states[i].self_intersections;
  vxm_free(provenance->context, states);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
