/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/touching_rims.h"

#include "mesh/boundary_loops.h"
#include "repair/state/flat_fold.h"

/** What is known of a patch, looking as most of its area does. */
typedef struct rimmed {
  bool has_rim;
  double area, turned_area, volume;
  vxm_vec3 vector_area;
  const double *apex; /**< the first end in space of folds at it, about which its volume is; NULL = none */
} rimmed;

/* ---- Folds ---- */

vxm_status vxm_flat_folds_find(uint8_t *fold, bool *any, const vxm_repair_state *state,
                               const size_t (*pair)[2], double scale, vxm_error *error) {
  enum { FORWARD = 2, BACKWARD = 3 }; /* of an edge's first side, until the second one is seen */
  const vxm_soup *soup = state->soup;
  *any = false;
  vxm_error local = VXM_ERROR_INIT;
  vxm_vec3 *areas = vxm_face_areas(state->context, soup, scale, &local);
  for (size_t f = 0; areas && f < soup->face_count; f++) {
    if (vxm_check_cancelled_at(f, state->context, &local) != VXM_OK)
      break;
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      size_t e = state->edges.sides[c];
      if (e == VXM_NO_EDGE || state->edges.edges[e].count != 2 || pair[e][0] == pair[e][1] ||
          pair[e][1] == SIZE_MAX)
        continue;
      const vxm_edge *edge = &state->edges.edges[e];
      vxm_edge_side own = {(uint32_t)e, soup->indices[c] == edge->a, f};
      if (fold[e] == 0) {
        fold[e] = own.forward ? FORWARD : BACKWARD;
        continue;
      }
      vxm_edge_side first = {(uint32_t)e, fold[e] == FORWARD, pair[e][0]};
      fold[e] = vxm_is_flat_fold(soup, edge, &first, &own, areas, scale);
      *any = *any || fold[e];
    }
  }
  vxm_free(state->context, areas);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/* ---- Which of them join ---- */

static bool looks_back(const vxm_rimmed_patches *p, const rimmed *patch, size_t face) {
  const rimmed *own = &patch[p->label[face]];
  return p->turn[face] != (2 * own->turned_area > own->area);
}

static void put_apex(rimmed *patch, const vxm_soup *soup, const vxm_edge *edge) {
  const double *ends[2] = {vxm_position(soup, edge->a), vxm_position(soup, edge->b)};
  for (int i = 0; i < 2; i++)
    if (!patch->apex || vxm_lies_before(ends[i], patch->apex))
      patch->apex = ends[i];
}

static void measure(rimmed *patch, const vxm_rimmed_patches *p, const uint8_t *fold, double scale) {
  const vxm_soup *soup = p->state->soup;
  const vxm_edges *edges = &p->state->edges;
  for (size_t f = 0; f < soup->face_count; f++) {
    rimmed *own = &patch[p->label[f]];
    double area = vxm_vec3_length(vxm_face_area(soup, f, scale));
    own->area += area;
    own->turned_area += p->turn[f] ? area : 0;
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      size_t e = edges->sides[c];
      own->has_rim |= e != VXM_NO_EDGE && vxm_edge_is_odd(&edges->edges[e]);
      if (e != VXM_NO_EDGE && fold[e])
        put_apex(own, soup, &edges->edges[e]);
    }
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    rimmed *own = &patch[p->label[f]];
    if (!own->apex)
      continue;
    vxm_vec3 area;
    double cone = vxm_face_cone(&area, soup, f, own->apex, scale);
    if (looks_back(p, patch, f)) {
      area = (vxm_vec3){-area.x, -area.y, -area.z};
      cone = -cone;
    }
    own->vector_area = vxm_vec3_sum(own->vector_area, area);
    own->volume += cone;
  }
}

/** Whether a patch bounds a volume: sheets go with what they are folded upon. */
static bool is_solid(const rimmed *patch) {
  const double volume_min = 1e-6; /* of an area, each in units of the model's size */
  return vxm_vec3_length(patch->vector_area) < VXM_SHEET_PART * patch->area &&
         fabs(patch->volume) > volume_min * patch->area;
}

/** Whether what lies on each other at a fold is two bodies. Patches without a rim may be one that has no
 * volume there, unless they lie side by side rather than back to back. */
static bool are_two(const vxm_rimmed_patches *p, const rimmed *patch, size_t edge) {
  const size_t *face = p->pair[edge];
  const rimmed *one = &patch[p->label[face[0]]], *other = &patch[p->label[face[1]]];
  bool same_way = (p->state->edges.edges[edge].forward != 1) ==
                  (looks_back(p, patch, face[0]) == looks_back(p, patch, face[1]));
  return is_solid(one) && is_solid(other) &&
         (one->has_rim || other->has_rim || (one != other && same_way && one->volume * other->volume > 0));
}

vxm_status vxm_touching_rims_keep(uint8_t *fold, bool *any, const vxm_rimmed_patches *p, double scale,
                                  vxm_error *error) {
  *any = false;
  vxm_status status = VXM_OK;
  rimmed *patch = vxm_repair_state_scratch(p->state, p->count, sizeof *patch, &status, error);
  if (!patch)
    return status;
  measure(patch, p, fold, scale);
  for (size_t e = 0; e < p->state->edges.count; e++) {
    if (!fold[e])
      continue;
    fold[e] = are_two(p, patch, e);
    *any = *any || !fold[e];
  }
  vxm_free(p->state->context, patch);
  return VXM_OK;
}
