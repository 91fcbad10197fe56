/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/face_set_sides.h"

#include "mesh/geometry.h"
#include "mesh/point_in_mesh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/** Of the longest side of the box: faces that a ray meets nearer than this are taken to lie at its origin. */
static const double AT_FACE = 1e-9;

typedef struct asking {
  const vxm_repair_state *state;
  const vxm_edge_groups *groups;
  double scale;
  size_t *begin; /**< per group: where its faces begin in `faces`; one more */
  size_t *faces; /**< those that count, by group */
} asking;

typedef struct keyed_set {
  size_t group;
  vxm_face_set_side set;
} keyed_set;

static int by_group_then_face(const void *a, const void *b) {
  const keyed_set *p = a, *q = b;
  if (p->group != q->group)
    return p->group < q->group ? -1 : 1;
  return p->set.face < q->set.face ? -1 : p->set.face > q->set.face;
}

static void list_faces(asking *a, const uint8_t *bound) {
  size_t faces = a->state->soup->face_count;
  for (size_t f = 0; f < faces; f++)
    a->begin[a->groups->of_face[f] + 1] += bound[f];
  for (size_t g = 0; g < a->groups->count; g++)
    a->begin[g + 1] += a->begin[g];
  for (size_t f = 0; f < faces; f++)
    if (bound[f])
      a->faces[a->begin[a->groups->of_face[f]]++] = f;
  for (size_t g = a->groups->count; g > 0; g--)
    a->begin[g] = a->begin[g - 1];
  a->begin[0] = 0;
}

static void find_box(vxm_point_in_mesh *inside) {
  for (int a = 0; a < 3; a++) {
    inside->box[a] = INFINITY;
    inside->box[a + 3] = -INFINITY;
  }
  for (size_t i = 0; i < inside->face_count; i++) {
    size_t count;
    const uint32_t *corner = vxm_face(inside->soup, inside->faces[i], &count);
    for (size_t c = 0; c < count; c++)
      for (int a = 0; a < 3; a++) {
        double x = vxm_position(inside->soup, corner[c])[a] * inside->scale;
        inside->box[a] = fmin(inside->box[a], x);
        inside->box[a + 3] = fmax(inside->box[a + 3], x);
      }
  }
}

/** The middle of the largest triangle from the first corner: polygons need not be plane, and rays meet these.
 */
static void find_middle(const asking *a, size_t face, double middle[3]) {
  size_t count, best = 2;
  const uint32_t *corner = vxm_face(a->state->soup, face, &count);
  double most = -1;
  for (size_t c = 2; c < count; c++) {
    const uint32_t triangle[3] = {corner[0], corner[c - 1], corner[c]};
    double area = vxm_vec3_length(vxm_polygon_area(a->state->soup->positions, triangle, 3, a->scale));
    if (area > most) {
      most = area;
      best = c;
    }
  }
  for (int x = 0; x < 3; x++)
    middle[x] = (vxm_position(a->state->soup, corner[0])[x] * a->scale +
                 vxm_position(a->state->soup, corner[best - 1])[x] * a->scale +
                 vxm_position(a->state->soup, corner[best])[x] * a->scale) /
                3;
}

static vxm_status ask(vxm_face_set_side *set, const asking *a, vxm_point_in_mesh *inside, bool balanced,
                      double gap, vxm_error *error) {
  size_t count;
  const uint32_t *corner = vxm_face(a->state->soup, set->face, &count);
  vxm_vec3 normal = vxm_polygon_area(a->state->soup->positions, corner, count, a->scale);
  const double along[3] = {normal.x, normal.y, normal.z};
  double middle[3];
  int in = 0, dominant = 0;
  find_middle(a, set->face, middle);
  for (int axis = 0; axis < 3; axis++)
    dominant = fabs(along[axis]) > fabs(along[dominant]) ? axis : dominant;
  for (int axis = 0; axis < 3; axis++) {
    int above, below, votes = 0;
    if (!set->asks_within && axis != dominant)
      continue;
    vxm_status status = vxm_point_in_mesh_winding(inside, middle, axis, gap, &above, &below, error);
    if (status == VXM_OK && set->asks_within && !balanced)
      status = vxm_point_in_mesh_vote(inside, middle, axis, &votes, error);
    if (status != VXM_OK)
      return status;
    in += balanced ? (above != 0) + (below != 0) : votes;
    if (axis == dominant) {
      set->front = along[axis] > 0 ? above : below;
      set->back = along[axis] > 0 ? below : above;
    }
  }
  set->within = set->asks_within && in > 3;
  return VXM_OK;
}

static vxm_status ask_group(keyed_set *sets, size_t count, const asking *a, vxm_error *error) {
  size_t group = sets[0].group;
  vxm_point_in_mesh inside = {.soup = a->state->soup,
                              .faces = a->faces + a->begin[group],
                              .face_count = a->begin[group + 1] - a->begin[group],
                              .scale = a->scale};
  if (inside.face_count == 0)
    return VXM_OK;
  find_box(&inside);
  double side = 0, far = 0;
  for (int x = 0; x < 3; x++) {
    side = fmax(side, inside.box[x + 3] - inside.box[x]);
    far = fmax(far, fmax(fabs(inside.box[x]), fabs(inside.box[x + 3])));
  }
  double gap = AT_FACE * side + 16 * DBL_EPSILON * far;
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < count && status == VXM_OK; i++)
    status = ask(&sets[i].set, a, &inside, a->groups->groups[group].balanced, gap, error);
  vxm_point_in_mesh_release(&inside);
  return status;
}

static vxm_status ask_all(keyed_set *sets, size_t count, const asking *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t i = 0, j; i < count && status == VXM_OK; i = j) {
    for (j = i; j < count && sets[j].group == sets[i].group;)
      j++;
    status = ask_group(sets + i, j - i, a, error);
  }
  return status;
}

vxm_status vxm_face_set_sides_find(vxm_face_set_side *sets, size_t count, vxm_repair_state *state,
                                   const vxm_edge_groups *groups, const uint8_t *bound, vxm_error *error) {
  if (count == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  asking a = {.state = state, .groups = groups, .scale = vxm_unit_scale_of(extent.bounds).scale};
  keyed_set *keyed = vxm_repair_state_scratch(state, count, sizeof *keyed, &status, error);
  if (keyed)
    a.begin = vxm_repair_state_scratch(state, groups->count + 1, sizeof *a.begin, &status, error);
  if (a.begin)
    a.faces = vxm_repair_state_scratch(state, state->soup->face_count, sizeof *a.faces, &status, error);
  if (a.faces) {
    list_faces(&a, bound);
    for (size_t i = 0; i < count; i++)
      keyed[i] = (keyed_set){groups->of_face[sets[i].face], sets[i]};
    qsort(keyed, count, sizeof *keyed, by_group_then_face);
    status = ask_all(keyed, count, &a, error);
    for (size_t i = 0; i < count; i++)
      sets[i] = keyed[i].set;
  }
  vxm_free(state->context, a.faces);
  vxm_free(state->context, a.begin);
  vxm_free(state->context, keyed);
  return status;
}
