/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/face_set_sides.h"

#include "mesh/geometry.h"
#include "mesh/point_in_mesh.h"
#include "mesh/sort.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/** Of the longest side of the box: faces that a ray meets nearer than this are taken to lie at its origin. */
static const double AT_FACE = 1e-9;

enum { SAMPLES = 32 /**< faces of a group that are asked what is around it, beside those of its sets */ };

typedef struct asking {
  const vxm_repair_state *state;
  const vxm_edge_groups *groups;
  double scale;
  size_t *begin;               /**< per group: where its faces begin in `faces`; one more */
  size_t *faces;               /**< those that count, by group */
  size_t *sorted;              /**< those of groups that are balanced, then the others */
  vxm_point_in_mesh all, open; /**< of these */
  bool alone;                  /**< there is nothing to count around a group */
} asking;

typedef struct keyed_set {
  size_t group;
  vxm_face_set_side set;
} keyed_set;

static int by_group_then_face(const void *a, const void *b) {
  const keyed_set *p = a, *q = b;
  return vxm_compare_pairs(p->group, p->set.face, q->group, q->set.face);
}

/** Puts the faces of groups that are balanced, or of those that are not, behind `sorted`. */
static vxm_point_in_mesh gather(const asking *a, bool balanced, size_t *sorted) {
  size_t count = 0;
  for (size_t g = 0; g < a->groups->count; g++)
    for (size_t i = a->begin[g]; i < a->begin[g + 1] && a->groups->groups[g].balanced == balanced; i++)
      sorted[count++] = a->faces[i];
  return (vxm_point_in_mesh){.soup = a->state->soup, .faces = sorted, .face_count = count, .scale = a->scale};
}

/** What may be around a group: all that are balanced, and if `open`, the others as well. */
static void list_surroundings(asking *a, bool open) {
  a->all = gather(a, true, a->sorted);
  vxm_point_in_mesh_find_box(&a->all);
  if (open) {
    a->open = gather(a, false, a->sorted + a->all.face_count);
    vxm_point_in_mesh_find_box(&a->open);
  }
}

/** Of the corner that a place is near. */
static const double NEAR = 0.8;

/** A point of a triangle from the first corner: polygons need not be plane, and rays meet these. The middle
 * of the largest one; other places are near its corners, and near those of the next. */
static void find_point(const asking *a, size_t face, int place, double point[3]) {
  size_t count, best = 2;
  const uint32_t *corner = vxm_face(a->state->soup, face, &count);
  double most = -1, weight[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  for (size_t c = 2; c < count; c++) {
    const uint32_t triangle[3] = {corner[0], corner[c - 1], corner[c]};
    double area = vxm_vec3_length(vxm_polygon_area(a->state->soup->positions, triangle, 3, a->scale));
    if (area > most) {
      most = area;
      best = c;
    }
  }
  if (place >= VXM_FACE_PLACES / 2)
    best = best + 1 < count ? best + 1 : 2;
  for (int c = 0; c < 3 && place % 4 > 0; c++)
    weight[c] = c == place % 4 - 1 ? NEAR : (1 - NEAR) / 2;
  for (int x = 0; x < 3; x++) {
    double p = vxm_position(a->state->soup, corner[0])[x] * a->scale;
    double q = vxm_position(a->state->soup, corner[best - 1])[x] * a->scale;
    double r = vxm_position(a->state->soup, corner[best])[x] * a->scale;
    double mean = place % 4 > 0 ? weight[0] * p + weight[1] * q + weight[2] * r : (p + q + r) / 3;
    point[x] = vxm_between_three(mean, p, q, r);
  }
}

/** Of the scaled coordinates of a set: nearer than this a face is taken to lie at the origin of a ray. */
static double gap_of(const vxm_point_in_mesh *inside) {
  double side = 0, far = 0;
  for (int x = 0; x < 3; x++) {
    side = fmax(side, inside->box[x + 3] - inside->box[x]);
    far = fmax(far, fmax(fabs(inside->box[x]), fabs(inside->box[x + 3])));
  }
  return AT_FACE * side + 16 * DBL_EPSILON * far;
}

/** Where a ray begins, and along which axis; the normal of the face, too. */
static int find_origin(const asking *a, size_t face, int place, double normal[3], double origin[3]) {
  size_t count;
  int dominant = 0;
  const uint32_t *corner = vxm_face(a->state->soup, face, &count);
  vxm_vec3 area = vxm_polygon_area(a->state->soup->positions, corner, count, a->scale);
  normal[0] = area.x;
  normal[1] = area.y;
  normal[2] = area.z;
  find_point(a, face, place, origin);
  for (int axis = 1; axis < 3; axis++)
    dominant = fabs(normal[axis]) > fabs(normal[dominant]) ? axis : dominant;
  return dominant;
}

/** @param around how often other groups wind round all of this one */
static vxm_status ask(vxm_face_set_side *set, const asking *a, vxm_point_in_mesh *inside, bool balanced,
                      int around, double gap, vxm_error *error) {
  double along[3], middle[3];
  int in = 0, in_all = 0, dominant = find_origin(a, set->face, set->place, along, middle);
  for (int axis = 0; axis < 3; axis++) {
    int above = 0, below = 0, votes = 0;
    if (!set->asks_within && axis != dominant)
      continue;
    vxm_status status = inside->face_count > 0
                            ? vxm_point_in_mesh_winding(inside, middle, axis, gap, &above, &below, error)
                            : VXM_OK;
    if (status == VXM_OK && set->asks_within && !balanced)
      status = vxm_point_in_mesh_vote(inside, middle, axis, &votes, error);
    if (status != VXM_OK)
      return status;
    in += balanced ? (above != 0) + (below != 0) : votes;
    above += around;
    below += around;
    in_all += (above != 0) + (below != 0);
    if (axis == dominant) {
      set->front = along[axis] > 0 ? above : below;
      set->back = along[axis] > 0 ? below : above;
    }
  }
  set->within = set->asks_within && (in > 3 || (around != 0 && in_all > 3));
  return VXM_OK;
}

/* ---- What is around a group ---- */

static vxm_status is_in_open(asking *a, const double point[3], int *in, vxm_error *error) {
  int votes = 0, more;
  vxm_status status = VXM_OK;
  for (int axis = 0; axis < 3 && status == VXM_OK && a->open.face_count > 0; axis++) {
    status = vxm_point_in_mesh_vote(&a->open, point, axis, &more, error);
    votes += more;
  }
  *in = votes > 3;
  return status;
}

/** How often other groups wind round the points before a face and behind it. */
static vxm_status look_around(int around[2], asking *a, vxm_point_in_mesh *own, size_t face,
                              vxm_error *error) {
  double normal[3], middle[3], gap = gap_of(&a->all);
  int all[2] = {0, 0}, less[2] = {0, 0}, in = 0, axis = find_origin(a, face, 0, normal, middle);
  vxm_status status = is_in_open(a, middle, &in, error);
  if (status == VXM_OK)
    status = vxm_point_in_mesh_winding(&a->all, middle, axis, gap, &all[0], &all[1], error);
  if (status == VXM_OK && own->face_count > 0)
    status = vxm_point_in_mesh_winding(own, middle, axis, gap, &less[0], &less[1], error);
  for (int side = 0; side < 2; side++)
    around[side] = all[side] - less[side] + in;
  return status;
}

/** How often other groups wind round this one, if that is the same all over it, as far as the faces of its
 * sets and some others tell; else 0. Where the first one tells that nothing is asked further. */
static vxm_status find_around(const keyed_set *sets, size_t count, asking *a, vxm_point_in_mesh *own,
                              int *around, vxm_error *error) {
  size_t step = own->face_count / SAMPLES + 1, more = (own->face_count + step - 1) / step;
  int beside[2];
  *around = 0;
  if (a->alone || !a->groups->groups[sets[0].group].balanced)
    return VXM_OK;
  for (size_t i = 0; i < count + more; i++) {
    size_t face = i < count ? sets[i].set.face : own->faces[(i - count) * step];
    vxm_status status = look_around(beside, a, own, face, error);
    if (status != VXM_OK)
      return status;
    if (i == 0)
      *around = beside[0];
    if (*around == 0 || beside[0] != *around || beside[1] != *around) {
      *around = 0;
      break;
    }
  }
  return VXM_OK;
}

/* ---- All of it ---- */

static vxm_status ask_group(keyed_set *sets, size_t count, asking *a, vxm_error *error) {
  size_t group = sets[0].group;
  int around;
  vxm_point_in_mesh inside = {.soup = a->state->soup,
                              .faces = a->faces + a->begin[group],
                              .face_count = a->begin[group + 1] - a->begin[group],
                              .scale = a->scale};
  vxm_point_in_mesh_find_box(&inside);
  vxm_status status = find_around(sets, count, a, &inside, &around, error);
  for (size_t i = 0; i < count && status == VXM_OK && around == 0 && !a->alone; i++)
    if (sets[i].set.asks_around)
      status = look_around(sets[i].set.around, a, &inside, sets[i].set.face, error);
  if (inside.face_count == 0 && around == 0)
    return status;
  double gap = gap_of(&inside);
  for (size_t i = 0; i < count && status == VXM_OK; i++)
    status = ask(&sets[i].set, a, &inside, a->groups->groups[group].balanced, around, gap, error);
  vxm_point_in_mesh_release(&inside);
  return status;
}

static vxm_status ask_all(keyed_set *sets, size_t count, asking *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t i = 0, j; i < count && status == VXM_OK; i = j) {
    for (j = i; j < count && sets[j].group == sets[i].group;)
      j++;
    status = ask_group(sets + i, j - i, a, error);
  }
  return status;
}

vxm_status vxm_face_set_sides_find(vxm_face_set_side *sets, size_t count, vxm_repair_state *state,
                                   const vxm_edge_groups *groups, const uint8_t *bound, bool open,
                                   vxm_error *error) {
  if (count == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  asking a = {.state = state,
              .groups = groups,
              .scale = vxm_unit_scale_of(extent.bounds).scale,
              .all = {.soup = state->soup},
              .open = {.soup = state->soup},
              .alone = groups->count < 2};
  keyed_set *keyed = vxm_repair_state_scratch(state, count, sizeof *keyed, &status, error);
  if (keyed)
    a.begin = vxm_repair_state_scratch(state, groups->count + 1, sizeof *a.begin, &status, error);
  if (a.begin)
    a.faces = vxm_repair_state_scratch(state, state->soup->face_count, sizeof *a.faces, &status, error);
  if (a.faces)
    a.sorted = vxm_repair_state_scratch(state, a.alone ? 0 : state->soup->face_count, sizeof *a.sorted,
                                        &status, error);
  if (a.sorted) {
    vxm_edge_groups_list(groups, state->soup->face_count, bound, a.begin, a.faces);
    if (!a.alone)
      list_surroundings(&a, open);
    for (size_t i = 0; i < count; i++)
      keyed[i] = (keyed_set){groups->of_face[sets[i].face], sets[i]};
    qsort(keyed, count, sizeof *keyed, by_group_then_face);
    status = ask_all(keyed, count, &a, error);
    for (size_t i = 0; i < count; i++)
      sets[i] = keyed[i].set;
    vxm_point_in_mesh_release(&a.open);
    vxm_point_in_mesh_release(&a.all);
  }
  vxm_free(state->context, a.sorted);
  vxm_free(state->context, a.faces);
  vxm_free(state->context, a.begin);
  vxm_free(state->context, keyed);
  return status;
}
