/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/components.h"
#include "mesh/containment.h"
#include "mesh/geometry.h"
#include "repair/state/repair_state.h"

typedef struct part {
  int64_t faces;
  double area, volume; /**< in the frame */
  bool open;           /**< an edge has an odd number of its faces */
  bool goes;
  const double *origin; /**< one of its corners: what is small loses nothing far from the middle */
} part;

typedef struct dropping {
  vxm_repair_state *state;
  double scale;
  uint32_t *label; /**< per face */
  size_t part_count;
  part *parts;
  uint32_t *at; /**< per vertex: its part, if it has faces */
} dropping;

static void measure(dropping *d) {
  const vxm_soup *soup = d->state->soup;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    part *p = &d->parts[d->label[f]];
    p->faces++;
    if (count == 0)
      continue;
    if (!p->origin)
      p->origin = vxm_position(soup, corner[0]);
    vxm_vec3 area;
    p->volume += vxm_face_cone(&area, soup, f, p->origin, d->scale);
    p->area += vxm_vec3_length(area);
    for (size_t i = 0; i < count; i++)
      d->at[corner[i]] = d->label[f];
  }
  for (size_t e = 0; e < d->state->edges.count; e++)
    if (vxm_edge_is_odd(&d->state->edges.edges[e]))
      d->parts[d->at[d->state->edges.edges[e].a]].open = true;
}

/** The one with the largest area, of equal ones the first. */
static size_t largest_part(const dropping *d) {
  size_t largest = 0;
  for (size_t p = 1; p < d->part_count; p++)
    if (d->parts[p].area > d->parts[largest].area)
      largest = p;
  return largest;
}

static bool is_small(const dropping *d, const part *p) {
  const vxm_repair_options *options = &d->state->options;
  double cube = d->scale * d->scale * d->scale; /* a power of two */
  return p->faces < options->drop_faces || (!p->open && fabs(p->volume) < options->drop_volume * cube);
}

static bool is_cavity(const part *p) {
  return !p->open && p->volume < 0;
}

/** A cavity in a body that stays is no crumb: without it the body would be another one. */
static vxm_status keep_cavities(dropping *d, vxm_error *error) {
  bool any = false;
  for (size_t p = 0; p < d->part_count && !any; p++)
    any = d->parts[p].goes && is_cavity(&d->parts[p]);
  if (!any)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_containment within;
  uint8_t *solid = vxm_repair_state_scratch(d->state, d->part_count, sizeof *solid, &status, error);
  if (!solid)
    return status;
  for (size_t p = 0; p < d->part_count; p++)
    solid[p] = !d->parts[p].open;
  status = vxm_containment_build(&within, d->state->soup, d->label, d->part_count, solid, error);
  vxm_free(d->state->context, solid);
  for (size_t p = 0; p < d->part_count && status == VXM_OK; p++) {
    uint32_t around = (uint32_t)p;
    while (around != VXM_NO_COMPONENT && d->parts[around].goes && is_cavity(&d->parts[around]))
      around = within.body[around] != VXM_NO_COMPONENT ? within.body[around] : within.parent[around];
    if (is_cavity(&d->parts[p]) && around != VXM_NO_COMPONENT)
      d->parts[p].goes = d->parts[around].goes;
  }
  if (status == VXM_OK)
    vxm_containment_destroy(&within);
  return status;
}

static vxm_status drop(dropping *d, bool *changed, vxm_error *error) {
  vxm_repair_state *state = d->state;
  size_t faces = state->soup->face_count, largest = largest_part(d);
  for (size_t p = 0; p < d->part_count; p++)
    d->parts[p].goes = p != largest && is_small(d, &d->parts[p]);
  vxm_status status = keep_cavities(d, error);
  if (status != VXM_OK)
    return status;
  uint8_t *remove = vxm_repair_state_scratch(state, faces, sizeof *remove, &status, error);
  if (!remove)
    return status;
  for (size_t f = 0; f < faces; f++)
    remove[f] = d->parts[d->label[f]].goes;
  for (size_t f = 0; f < faces && state->provenance && state->soup->face_parts; f++)
    if (remove[f])
      vxm_provenance_drop(state->provenance, state->soup->face_parts[f]);
  int64_t count = vxm_repair_state_remove_faces(state, remove);
  state->counts[VXM_PASS_SMALL_COMPONENTS] += count;
  *changed = count > 0;
  vxm_free(state->context, remove);
  return VXM_OK;
}

/**
 * Removes the components that are smaller than the options say: by faces, or, if they are closed, by volume.
 * The one with the largest area always stays, and cavities, closed ones that look inward, with what they are
 * in.
 */
vxm_status vxm_pass_small_components(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (state->options.drop_faces <= 0 && !(state->options.drop_volume > 0))
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  dropping d = {.state = state, .scale = vxm_unit_scale_of(extent.bounds).scale};
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status == VXM_OK)
    d.label = vxm_repair_state_scratch(state, state->soup->face_count, sizeof *d.label, &status, error);
  if (status == VXM_OK)
    status = vxm_components(state->context, state->soup, NULL, d.label, &d.part_count, error);
  if (status == VXM_OK)
    d.parts = vxm_repair_state_scratch(state, d.part_count, sizeof *d.parts, &status, error);
  if (status == VXM_OK)
    d.at = vxm_repair_state_scratch(state, state->soup->vertex_count, sizeof *d.at, &status, error);
  if (status == VXM_OK && d.part_count > 1) {
    measure(&d);
    status = drop(&d, changed, error);
  }
  vxm_free(state->context, d.at);
  vxm_free(state->context, d.parts);
  vxm_free(state->context, d.label);
  return status;
}
