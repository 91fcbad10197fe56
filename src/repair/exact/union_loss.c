/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/exact/union_loss.h"

#include "mesh/components.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"
#include "repair/state/lost_parts.h"

typedef struct component {
  const double *origin; /**< one of its corners */
  double volume;        /**< in the frame */
} component;

static void measure(component *components, const vxm_soup *soup, const uint32_t *label, double scale) {
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    component *c = &components[label[f]];
    if (count == 0)
      continue;
    if (!c->origin)
      c->origin = vxm_position(soup, corner[0]);
    vxm_vec3 area = vxm_polygon_area(soup->positions, corner, count, scale);
    c->volume += vxm_polygon_cone(vxm_vec3_between(vxm_position(soup, corner[0]), c->origin, scale), area);
  }
}

/** Adds the faces of a soup, of several components those that look inward alone. */
static vxm_status append(vxm_soup *to, const vxm_soup *from, const uint32_t *label,
                         const component *components, vxm_error *error) {
  size_t first = to->vertex_count;
  vxm_status status =
      vxm_soup_reserve(to, first + from->vertex_count, to->face_count, to->corner_count, error);
  if (status == VXM_OK)
    status = vxm_soup_add_vertices(to, from, error);
  for (size_t f = 0; f < from->face_count && status == VXM_OK; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(from, f, &count);
    if (components && !(components[label[f]].volume < 0))
      continue;
    status = vxm_soup_add_face(to, corner, count, error);
    for (size_t c = to->corner_count - count; c < to->corner_count && status == VXM_OK; c++)
      to->indices[c] += (uint32_t)first;
  }
  return status;
}

/** What is enclosed after the union, and the cavities that were there before: these take away what they may.
 */
static vxm_status find_rest(vxm_soup *rest, const vxm_soup *before, const vxm_soup *united,
                            vxm_error *error) {
  vxm_extent extent;
  vxm_error local = VXM_ERROR_INIT;
  size_t count;
  uint32_t *label = vxm_alloc(before->context, before->face_count, sizeof *label, &local);
  vxm_status status =
      label ? vxm_components(before->context, before, NULL, label, &count, &local) : local.code;
  component *components = NULL;
  if (status == VXM_OK)
    components = vxm_calloc(before->context, count, sizeof *components, &local);
  if (components && vxm_extent_find(&extent, before->context, before, &local) == VXM_OK) {
    measure(components, before, label, vxm_unit_scale_of(extent.bounds).scale);
    if (append(rest, united, NULL, NULL, &local) == VXM_OK)
      append(rest, before, label, components, &local);
  }
  vxm_free(before->context, components);
  vxm_free(before->context, label);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_union_loss_find(int64_t *count, const vxm_soup *before, const vxm_soup *united,
                               vxm_error *error) {
  vxm_soup *rest;
  *count = 0;
  vxm_status status = vxm_soup_create(&rest, before->context, "off", error);
  if (status != VXM_OK)
    return status;
  vxm_lost_parts lost = {0};
  status = find_rest(rest, before, united, error);
  if (status == VXM_OK)
    status = vxm_lost_parts_find(&lost, before, rest, error);
  *count = status == VXM_OK ? (int64_t)lost.count : 0;
  vxm_lost_parts_free(&lost, before->context);
  vxm_soup_destroy(rest);
  return status;
}
