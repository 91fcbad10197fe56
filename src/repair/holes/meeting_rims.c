/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/holes/meeting_rims.h"

#include "mesh/disjoint_sets.h"
#include "mesh/geometry.h"
#include "repair/holes/cap_plan.h"

/** The area of the patches, of faces that plain edges join, at a loop; `patch_loop` tells those counted. */
static double area_beside(const vxm_cap_plan *p, size_t loop, const uint32_t *patch, const double *patch_area,
                          size_t *patch_loop) {
  double area = 0;
  for (size_t s = p->loops.begin[loop]; s < p->loops.begin[loop + 1]; s++) {
    uint32_t beside = patch[p->edge_face[p->loops.edge[s]]];
    area += patch_loop[beside] == loop + 1 ? 0 : patch_area[beside];
    patch_loop[beside] = loop + 1;
  }
  return area;
}

/** The patch of each face is its first face. */
static void find_patches(const vxm_cap_plan *p, uint32_t *patch, double *area) {
  const vxm_soup *soup = p->soup;
  const uint32_t *sides = p->state->edges.sides;
  for (size_t f = 0; f < soup->face_count; f++)
    patch[f] = (uint32_t)f;
  for (size_t f = 0; f < soup->face_count; f++)
    for (uint64_t s = soup->offsets[f]; s < soup->offsets[f + 1]; s++)
      if (sides[s] != VXM_NO_EDGE && p->state->edges.edges[sides[s]].count == 2)
        vxm_set_unite_in_order(patch, (uint32_t)f, (uint32_t)p->edge_face[sides[s]]);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    patch[f] = patch[patch[f]]; /* faces before have theirs already */
    area[patch[f]] += vxm_vec3_length(vxm_polygon_area(soup->positions, corner, count, p->scale));
  }
}

/** Marks the vertices with several rims, 2: those of edges with more faces; those of holes alone, which fans
 * would close together else, and others would not. */
static void mark_meetings(const vxm_cap_plan *p, uint8_t *rims) {
  bool fans = p->state->options.hole_fill == VXM_HOLE_FILL_FAN;
  for (size_t l = 0; l < p->loops.count; l++)
    for (size_t s = p->loops.begin[l]; s < p->loops.begin[l + 1]; s++) {
      const vxm_edge *edge = &p->state->edges.edges[p->loops.edge[s]];
      uint8_t *at = &rims[p->loops.vertex[s]];
      if (edge->count > 1)
        rims[edge->a] = rims[edge->b] = 2;
      else if (fans)
        *at = *at ? 2 : 1;
    }
}

static bool meets_another(const vxm_cap_plan *p, size_t loop, const uint8_t *rims) {
  for (size_t s = p->loops.begin[loop]; s < p->loops.begin[loop + 1]; s++)
    if (rims[p->loops.vertex[s]] > 1)
      return true;
  return false;
}

/** Those that meet others, or themselves, at a vertex, and whose caps would not cover the faces beside. */
static bool want_meeting(vxm_cap_plan *p) {
  size_t faces = p->soup->face_count;
  uint8_t *rims = vxm_cap_plan_allocate(p, p->soup->vertex_count, sizeof *rims);
  uint32_t *patch = vxm_cap_plan_allocate(p, faces, sizeof *patch);
  double *patch_area = vxm_cap_plan_allocate(p, faces, sizeof *patch_area);
  size_t *patch_loop = vxm_cap_plan_allocate(p, faces, sizeof *patch_loop);
  bool ready = rims && patch && patch_area && patch_loop;
  if (ready) {
    mark_meetings(p, rims);
    find_patches(p, patch, patch_area);
  }
  for (size_t l = 0; ready && l < p->loops.count; l++) {
    if (vxm_cap_plan_edges(p, l) > p->most || !meets_another(p, l, rims) || !vxm_cap_plan_is_plain(p, l)) {
      vxm_cap_plan_pass(p, l);
      continue;
    }
    ready = vxm_cap_plan_add(p, l);
    p->wanted[l] =
        ready && vxm_cap_plan_area(p, l) < VXM_SHEET_PART * area_beside(p, l, patch, patch_area, patch_loop);
  }
  vxm_context *context = p->state->context;
  vxm_free(context, patch_loop);
  vxm_free(context, patch_area);
  vxm_free(context, patch);
  vxm_free(context, rims);
  return ready;
}

vxm_status vxm_fill_meeting(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error) {
  vxm_cap_plan p;
  int64_t count = vxm_cap_plan_begin(&p, state, most) && want_meeting(&p) ? vxm_cap_plan_close(&p) : -1;
  *closed = count < 0 ? 0 : count;
  return vxm_cap_plan_end(&p, count >= 0, error);
}
