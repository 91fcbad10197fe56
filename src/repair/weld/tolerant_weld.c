/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

#include "mesh/geometry.h"
#include "mesh/near_vertices.h"
#include "mesh/sort.h"
#include "mesh/vertex_net.h"
#include "repair/weld/net_merge.h"
#include "repair/weld/rejoin_jittered.h"

#include <string.h>

/** The crack width is at most this part of the edges at a merged vertex, so that no face collapses. */
static const double EDGE_PART = 0.25;

/* ---- With a given tolerance: all vertices ---- */

/** Groups that are near each other and far from all others first, whatever the order of vertices; then what
 * is left, as whoever gives a tolerance wants no two vertices within it. */
static vxm_status weld_all(vxm_repair_state *state, uint32_t *map, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  double tolerance = state->options.weld_tolerance;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  /* a mark of use is the role of a member */
  _Static_assert(VXM_NEAR_MEMBER == 1, "marks serve as roles");
  vxm_status status = vxm_near_vertices_group(state->context, soup->positions, soup->vertex_count,
                                              state->used, tolerance, map, error);
  return status == VXM_OK ? vxm_vertex_net(state->context, soup->positions, soup->vertex_count, state->used,
                                           tolerance, map, error)
                          : status;
}

/* ---- Automatic: cracks ---- */

/** Members are the vertices of boundary edges; all other used vertices, and those with a short edge, are
 * obstacles. */
static void give_roles(const vxm_repair_state *state, double tolerance, uint8_t *roles) {
  const vxm_edges *edges = &state->edges;
  for (size_t v = 0; v < state->soup->vertex_count; v++)
    roles[v] = state->used[v] ? VXM_NEAR_OBSTACLE : VXM_NEAR_ABSENT;
  for (size_t e = 0; e < edges->count; e++)
    if (edges->edges[e].count == 1)
      roles[edges->edges[e].a] = roles[edges->edges[e].b] = VXM_NEAR_MEMBER;
  double scale = 1 / tolerance;
  for (size_t e = 0; e < edges->count; e++) {
    const vxm_edge *edge = &edges->edges[e];
    if (roles[edge->a] != VXM_NEAR_MEMBER && roles[edge->b] != VXM_NEAR_MEMBER)
      continue;
    vxm_vec3 along =
        vxm_vec3_between(vxm_position(state->soup, edge->a), vxm_position(state->soup, edge->b), scale);
    if (vxm_vec3_length(along) * EDGE_PART < 1)
      roles[edge->a] = roles[edge->b] = VXM_NEAR_OBSTACLE;
  }
}

/**
 * Keeps only merges that close something: the groups at the two ends of an edge in which at least two
 * boundary edges would come together. Both ends are kept together, so that what is kept does close.
 */
static void keep_closing(const vxm_repair_state *state, uint32_t *map, uint64_t *keys, uint8_t *keep) {
  const vxm_edges *edges = &state->edges;
  size_t count = 0;
  for (size_t e = 0; e < edges->count; e++)
    if (edges->edges[e].count == 1)
      keys[count++] = vxm_edge_key(map[edges->edges[e].a], map[edges->edges[e].b]);
  vxm_sort_keys(keys, keys + count, count);
  for (size_t i = 1; i < count; i++)
    if (keys[i] == keys[i - 1])
      keep[keys[i] >> 32] = keep[(uint32_t)keys[i]] = 1;
  for (size_t v = 0; v < state->soup->vertex_count; v++)
    if (!keep[map[v]])
      map[v] = (uint32_t)v;
}

static vxm_status weld_cracks(vxm_repair_state *state, uint32_t *map, vxm_error *error) {
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  double tolerance = VXM_CRACK_WIDTH * frame.diagonal / frame.scale;
  size_t vertices = state->soup->vertex_count;
  vxm_status status = VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  uint8_t *roles = vxm_repair_state_scratch(state, vertices, sizeof *roles, &status, &local);
  uint8_t *keep = roles ? vxm_repair_state_scratch(state, vertices, sizeof *keep, &status, &local) : NULL;
  uint64_t *keys = NULL;
  if (keep)
    keys = vxm_repair_state_scratch(state, state->edges.open, 2 * sizeof *keys, &status, &local);
  if (keys) {
    give_roles(state, tolerance, roles);
    status = vxm_near_vertices_group(state->context, state->soup->positions, vertices, roles, tolerance, map,
                                     &local);
  }
  if (status == VXM_OK)
    keep_closing(state, map, keys, keep);
  vxm_free(state->context, keys);
  vxm_free(state->context, keep);
  vxm_free(state->context, roles);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Whether there is anything that this pass could do. */
static vxm_status is_wanted(vxm_repair_state *state, bool *wanted, vxm_error *error) {
  *wanted = state->options.weld == VXM_WELD_TOLERANCE && state->options.weld_tolerance > 0;
  if (state->options.weld != VXM_WELD_AUTO)
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  *wanted = status == VXM_OK && state->edges.open > 1;
  return status;
}

/**
 * Moves every vertex that others merge into to the middle of them all: the copies of a torn vertex were moved
 * apart at random, so their mean lies nearer to where it was than any of them.
 */
static vxm_status move_to_middle(vxm_repair_state *state, const uint32_t *map, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = state->soup->vertex_count;
  uint32_t *copies = vxm_repair_state_scratch(state, vertices, sizeof *copies, &status, error);
  if (!copies)
    return status;
  double *positions = state->soup->positions;
  /* The mean grows by the difference to each copy, so that positions of any size do not overflow. */
  for (size_t v = 0; v < vertices; v++) {
    if (state->gone[v] && map[v] == v)
      continue;
    double share = 1.0 / ++copies[map[v]], *mean = positions + 3 * (size_t)map[v];
    for (size_t a = 0; a < 3 && map[v] != v; a++)
      mean[a] = vxm_repair_state_round(state, mean[a] + (positions[3 * v + a] - mean[a]) * share);
  }
  vxm_free(state->context, copies);
  vxm_repair_state_move(state);
  return VXM_OK;
}

/** Merges, if anything is to be, and if that helps; `torn`: to the middle. */
static vxm_status merge(vxm_repair_state *state, const uint32_t *map, bool torn, int64_t *count,
                        vxm_error *error) {
  bool helps = false;
  for (size_t v = 0; v < state->soup->vertex_count && !helps; v++)
    helps = map[v] != v && !state->gone[v];
  if (!helps)
    return VXM_OK;
  vxm_status status = vxm_merge_helps(&helps, state, map, error);
  if (status != VXM_OK || !helps)
    return status;
  vxm_repair_state_note_merge(state, VXM_PASS_TOLERANT_WELD, map);
  if (torn)
    status = move_to_middle(state, map, error);
  if (status == VXM_OK)
    *count = vxm_repair_state_merge(state, map);
  return status;
}

/**
 * Merges near vertices: with a given tolerance all of them, else only where that closes cracks, and where
 * there is none of the usual kind, in soups that were torn apart. As a merged group has no other vertex near
 * it, running the pass again, after others, merges new groups or none, but never adds to an old one.
 */
vxm_status vxm_pass_tolerant_weld(vxm_repair_state *state, bool *changed, vxm_error *error) {
  bool wanted;
  vxm_status status = is_wanted(state, &wanted, error);
  *changed = false;
  if (status != VXM_OK || !wanted)
    return status;
  uint32_t *map = vxm_repair_state_scratch(state, state->soup->vertex_count, sizeof *map, &status, error);
  if (!map)
    return status;
  if (state->options.weld == VXM_WELD_TOLERANCE)
    status = weld_all(state, map, error);
  else
    status = weld_cracks(state, map, error);
  int64_t count = 0;
  if (status == VXM_OK)
    status = merge(state, map, false, &count, error);
  if (status == VXM_OK && count == 0 && state->options.weld == VXM_WELD_AUTO) {
    status = vxm_rejoin_jittered(state, map, error);
    if (status == VXM_OK)
      status = merge(state, map, true, &count, error);
  }
  if (status == VXM_OK) {
    state->counts[VXM_PASS_TOLERANT_WELD] += count;
    *changed = count > 0;
  }
  vxm_free(state->context, map);
  return status;
}
