/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/exact/union_loss.h"

#include "base/box.h"
#include "mesh/box_tree.h"
#include "mesh/components.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"
#include "repair/state/lost_parts.h"

#include <math.h>

typedef enum kind {
  KIND_BODY,
  KIND_CAVITY,
  KIND_IN_CAVITY /**< a body that may lie in a cavity, by their boxes */
} kind;

typedef struct looking {
  vxm_context *context;
  const vxm_soup *before, *united;
  uint32_t *label; /**< per face of `before` */
  size_t count;    /**< components */
  double *volume;  /**< per component, in the frame */
  double (*box)[6];
  kind *kinds;
  vxm_error error;
} looking;

static void measure(looking *l, double scale) {
  const vxm_soup *soup = l->before;
  for (size_t i = 0; i < l->count; i++)
    vxm_box_empty(l->box[i], l->box[i] + 3);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    double *box = l->box[l->label[f]];
    for (size_t c = 0; c < count; c++)
      vxm_box_include(box, box + 3, vxm_position(soup, corner[c]));
  }
  for (size_t f = 0; f < soup->face_count; f++)
    l->volume[l->label[f]] += vxm_face_cone(NULL, soup, f, l->box[l->label[f]], scale);
}

static void find_kinds(looking *l) {
  vxm_box_tree cavities;
  double(*box)[6] = vxm_alloc(l->context, l->count, sizeof *box, &l->error);
  for (size_t i = 0; box && i < l->count; i++) {
    l->kinds[i] = l->volume[i] < 0 ? KIND_CAVITY : KIND_BODY;
    for (size_t x = 0; x < 6; x++)
      box[i][x] = l->kinds[i] == KIND_CAVITY ? l->box[i][x] : x < 3 ? INFINITY : -INFINITY;
  }
  if (box && vxm_box_tree_build(&cavities, l->context, box, l->count, &l->error) == VXM_OK) {
    for (size_t i = 0; i < l->count; i++) {
      vxm_box_tree_search(&cavities, l->box[i], 0);
      if (l->kinds[i] == KIND_BODY && vxm_box_tree_next(&cavities) != VXM_NO_BOX)
        l->kinds[i] = KIND_IN_CAVITY;
    }
    vxm_box_tree_destroy(&cavities);
  }
  vxm_free(l->context, box);
}

/** Components of some kinds, bits of 1 << kind, behind the faces of another soup, which may be NULL. */
static vxm_soup *collect(looking *l, const vxm_soup *first, unsigned kinds) {
  vxm_soup *out;
  const vxm_soup *both[2] = {first, l->before};
  if (l->error.code != VXM_OK || vxm_soup_create(&out, l->context, "off", &l->error) != VXM_OK)
    return NULL;
  for (int s = first ? 0 : 1; s < 2; s++) {
    size_t before = out->vertex_count;
    vxm_soup_add_vertices(out, both[s], &l->error);
    for (size_t f = 0; f < both[s]->face_count && l->error.code == VXM_OK; f++) {
      size_t count;
      const uint32_t *corner = vxm_face(both[s], f, &count);
      if (s == 1 && !(1U << l->kinds[l->label[f]] & kinds))
        continue;
      vxm_soup_add_face(out, corner, count, &l->error);
      for (size_t c = out->corner_count - count; c < out->corner_count && l->error.code == VXM_OK; c++)
        out->indices[c] += (uint32_t)before;
    }
  }
  return out;
}

static int64_t count_lost(looking *l, const vxm_soup *before, const vxm_soup *after) {
  vxm_lost_parts lost = {0};
  if (l->error.code == VXM_OK)
    vxm_lost_parts_find(&lost, before, after, &l->error);
  int64_t count = (int64_t)lost.count;
  vxm_lost_parts_destroy(&lost, l->context);
  return count;
}

/** Cavities that were there before take away what they may of the bodies that they cut through, and nothing
 * of those that lie in them. */
static int64_t compare(looking *l) {
  bool any = false;
  for (size_t i = 0; i < l->count && l->error.code == VXM_OK; i++)
    any |= l->kinds[i] == KIND_IN_CAVITY;
  vxm_soup *rest = collect(l, l->united, 1U << KIND_CAVITY);
  vxm_soup *bodies = any ? collect(l, NULL, 1U << KIND_BODY | 1U << KIND_CAVITY) : NULL;
  vxm_soup *in_cavities = any ? collect(l, NULL, 1U << KIND_IN_CAVITY) : NULL;
  int64_t count = count_lost(l, any ? bodies : l->before, rest);
  if (any)
    count += count_lost(l, in_cavities, l->united);
  vxm_soup_destroy(in_cavities);
  vxm_soup_destroy(bodies);
  vxm_soup_destroy(rest);
  return count;
}

vxm_status vxm_union_loss_find(int64_t *count, const vxm_soup *before, const vxm_soup *united,
                               vxm_error *error) {
  looking l = {.context = before->context, .before = before, .united = united, .error = VXM_ERROR_INIT};
  vxm_extent extent;
  *count = 0;
  l.label = vxm_alloc(l.context, before->face_count, sizeof *l.label, &l.error);
  if (l.label)
    vxm_components(l.context, before, NULL, l.label, &l.count, &l.error);
  l.volume = l.error.code == VXM_OK ? vxm_calloc(l.context, l.count, sizeof *l.volume, &l.error) : NULL;
  l.box = l.volume ? vxm_alloc(l.context, l.count, sizeof *l.box, &l.error) : NULL;
  l.kinds = l.box ? vxm_alloc(l.context, l.count, sizeof *l.kinds, &l.error) : NULL;
  if (l.kinds && vxm_extent_find(&extent, l.context, before, &l.error) == VXM_OK) {
    measure(&l, vxm_unit_scale_of(extent.bounds).scale);
    find_kinds(&l);
    *count = compare(&l);
  }
  vxm_free(l.context, l.kinds);
  vxm_free(l.context, l.box);
  vxm_free(l.context, l.volume);
  vxm_free(l.context, l.label);
  if (l.error.code == VXM_OK)
    return VXM_OK;
  *count = 0;
  vxm_error_pass(error, &l.error);
  return l.error.code;
}
