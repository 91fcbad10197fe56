/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/inward_faces.h"

#include "mesh/components.h"
#include "mesh/containment.h"
#include "mesh/geometry.h"
#include "mesh/nonfinite.h"

/** Of its area: a closed component has a vector area of nothing but rounding. */
static const double ROUNDING = 1e-6;

typedef struct component {
  double area;
  vxm_vec3 vector_area;
  bool inward;
} component;

typedef struct sorting {
  const vxm_soup *soup;
  vxm_unit_scale frame;
  uint32_t *label; /**< per face: its component */
  size_t count;
  component *components;
  uint8_t *closed; /**< per component */
  double volume;   /**< of all faces, about the middle of the mesh */
  vxm_error error;
} sorting;

static bool measure(sorting *s) {
  for (size_t f = 0; f < s->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(s->soup, f, &count);
    if (vxm_check_cancelled_at(f, s->soup->context, &s->error) != VXM_OK)
      return false;
    if (count < 3 || !vxm_face_is_finite(s->soup, corner, count))
      continue;
    component *c = &s->components[s->label[f]];
    vxm_vec3 area;
    s->volume += vxm_face_cone(&area, s->soup, f, s->frame.centre, s->frame.scale);
    c->area += vxm_vec3_length(area);
    c->vector_area = vxm_vec3_sum(c->vector_area, area);
  }
  for (size_t i = 0; i < s->count; i++) {
    const component *c = &s->components[i];
    s->closed[i] = c->area > 0 && vxm_vec3_length(c->vector_area) <= ROUNDING * c->area;
  }
  return true;
}

/** Whether a component came inside out, or the body that it is a void of. What has no volume goes with what
 * is around it. */
static bool is_inward(const sorting *s, const vxm_containment *containment, size_t number) {
  if (!s->closed[number])
    return s->volume < 0;
  while (containment->volume[number] == 0 && containment->parent[number] != VXM_NO_COMPONENT)
    number = containment->parent[number];
  if (containment->body[number] != VXM_NO_COMPONENT)
    number = containment->body[number];
  return containment->volume[number] < 0;
}

static bool mark(sorting *s, uint8_t *inward) {
  vxm_containment containment = {0};
  if (vxm_containment_build(&containment, s->soup, s->label, s->count, s->closed, &s->error) != VXM_OK)
    return false;
  for (size_t i = 0; i < s->count; i++)
    s->components[i].inward = is_inward(s, &containment, i);
  for (size_t f = 0; f < s->soup->face_count; f++)
    inward[f] = s->components[s->label[f]].inward;
  vxm_containment_destroy(&containment);
  return true;
}

vxm_status vxm_inward_faces(uint8_t *inward, const vxm_soup *soup, vxm_error *error) {
  vxm_context *context = soup->context;
  sorting s = {.soup = soup, .error = VXM_ERROR_INIT};
  vxm_extent extent;
  bool done = vxm_extent_find(&extent, context, soup, &s.error) == VXM_OK;
  if (done) {
    s.frame = vxm_unit_scale_of(extent.bounds);
    s.label = vxm_alloc(context, soup->face_count, sizeof *s.label, &s.error);
  }
  done = s.label && vxm_components(context, soup, NULL, s.label, &s.count, &s.error) == VXM_OK;
  if (done)
    s.components = vxm_calloc(context, s.count, sizeof *s.components, &s.error);
  if (s.components)
    s.closed = vxm_calloc(context, s.count, sizeof *s.closed, &s.error);
  done = s.closed && measure(&s) && mark(&s, inward);
  vxm_free(context, s.closed);
  vxm_free(context, s.components);
  vxm_free(context, s.label);
  if (!done)
    vxm_error_pass(error, &s.error);
  return done ? VXM_OK : s.error.code;
}
