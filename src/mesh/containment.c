/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/containment.h"

#include "base/box.h"
#include "mesh/box_tree.h"
#include "mesh/face_points.h"
#include "mesh/geometry.h"
#include "mesh/nonfinite.h"
#include "mesh/point_in_mesh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cavity may touch the skin around it where the skin reaches farthest, and then have its box in common with
   it; and its faces may lie on those of the skin. Once vertices that touch have been moved apart, or rounded,
   it even reaches out by as much. */

/** Of the model's diagonal, and in units in the last place of its largest number as a 32-bit float, but not
 * above MOST of the diagonal: how far what is within may reach out. */
static const double LEEWAY = 1e-4, LEEWAY_UNITS = 16, LEEWAY_MOST = 1.0 / 64;

/** Bits of the sizes of boxes, and of volumes, where those of one body are told to be larger than those of
 * another in spite of that. */
enum { SIZE_BITS = 10, VOLUME_BITS = 3 };

/** Points on a component to see whether all of it lies in another one; few, once many were taken in all. */
enum { POINTS = 512, POINTS_FEW = 64, POINTS_IN_ALL = 1 << 18 };

/** Such a part of them may lie outside: there faces are missing. */
static const double OUTSIDE_MAX = 1.0 / 1024;

/** Two that lie on each other, with volumes that differ by less than that, may be one that was drawn twice.
 */
static const double SMALLER = 0.9;

typedef struct body {
  double box[6];  /**< scaled; low above high if no corner is finite */
  double size;    /**< volume of the box */
  double volume;  /**< without a sign */
  double rank[3]; /**< what tells which one is larger: both, rounded, and the size */
  size_t first;   /**< of its faces in `faces` */
  uint32_t component;
} body;

typedef struct builder {
  const vxm_soup *soup;
  const uint32_t *labels;
  const uint8_t *solid;
  vxm_context *context;
  vxm_error error;
  size_t count;
  vxm_unit_scale frame;
  double bounds[6];     /**< scaled */
  double leeway;        /**< scaled: how far a box may reach out of that around it */
  const double *volume; /**< per component, signed */
  body *bodies;         /**< per component, and one more that ends the last one's faces */
  size_t *faces;        /**< grouped by component */
  uint32_t *order;      /**< solid components by increasing box */
  size_t order_count;
  double (*boxes)[6];         /**< in that order */
  vxm_box_tree around;        /**< of them */
  vxm_point_in_mesh **inside; /**< per component, NULL until asked */
  uint64_t points;            /**< that were taken by measure_outside so far */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

static bool is_solid(const builder *b, size_t component) {
  return (!b->solid || b->solid[component]) && b->bodies[component].box[0] <= b->bodies[component].box[3];
}

/* ---- Boxes, faces and volumes ---- */

/** Faces of one component mostly follow one another: the end of those that begin with `face`, or of as many
 * of them as are worked on without asking whether to go on. */
static size_t end_of_run(const builder *b, size_t face) {
  size_t end = face + 1, most = (face / VXM_CANCEL_STEPS + 1) * VXM_CANCEL_STEPS;
  while (end < b->soup->face_count && end < most && b->labels[end] == b->labels[face])
    end++;
  return end;
}

/** Boxes in model units, and how many faces each component has. */
static bool measure_bodies(builder *b) {
  for (size_t i = 0; i < b->count; i++) {
    vxm_box_empty(b->bodies[i].box, b->bodies[i].box + 3);
    b->bodies[i].component = (uint32_t)i;
  }
  for (size_t f = 0, end; f < b->soup->face_count; f = end) {
    end = end_of_run(b, f);
    if (vxm_check_cancelled_at(f, b->context, &b->error) != VXM_OK)
      return false;
    double box[6];
    memcpy(box, b->bodies[b->labels[f]].box, sizeof box);
    for (uint64_t c = b->soup->offsets[f]; c < b->soup->offsets[end]; c++) {
      const double *p = vxm_position(b->soup, b->soup->indices[c]);
      if (vxm_is_finite(p))
        vxm_box_include(box, box + 3, p);
    }
    memcpy(b->bodies[b->labels[f]].box, box, sizeof box);
    b->bodies[b->labels[f] + 1].first += end - f;
  }
  vxm_box_empty(b->bounds, b->bounds + 3);
  for (size_t i = 0; i < b->count; i++) {
    b->bodies[i + 1].first += b->bodies[i].first;
    vxm_box_join(b->bounds, b->bounds + 3, b->bodies[i].box, b->bodies[i].box + 3);
  }
  return true;
}

static void choose_leeway(builder *b) {
  double largest = 0, diagonal = b->frame.diagonal;
  for (int a = 0; a < 6; a++)
    largest = fmax(largest, fabs(b->bounds[a]));
  b->leeway = fmin(LEEWAY * diagonal + LEEWAY_UNITS * (double)FLT_EPSILON * largest, LEEWAY_MOST * diagonal);
}

static void scale_boxes(builder *b) {
  static const double nowhere[6] = {0};
  bool somewhere = b->bounds[0] <= b->bounds[3];
  b->frame = vxm_unit_scale_of(somewhere ? b->bounds : nowhere);
  for (int a = 0; a < 6; a++)
    b->bounds[a] = somewhere ? b->bounds[a] * b->frame.scale : 0;
  choose_leeway(b);
  for (size_t i = 0; i < b->count; i++) {
    double *box = b->bodies[i].box;
    for (int a = 0; a < 6; a++)
      box[a] *= b->frame.scale;
    b->bodies[i].size = (box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2]);
  }
}

static bool list_faces(builder *b) {
  size_t *next = allocate(b, b->count, sizeof *next);
  b->faces = allocate(b, b->soup->face_count, sizeof *b->faces);
  bool done = next && b->faces;
  for (size_t i = 0; done && i < b->count; i++)
    next[i] = b->bodies[i].first;
  for (size_t f = 0; done && f < b->soup->face_count; f++)
    b->faces[next[b->labels[f]]++] = f;
  vxm_free(b->context, next);
  return done;
}

/** Adds the cones from the middle of a box to the faces from `face` to `end`. */
static double add_cones(const builder *b, size_t face, size_t end, double volume) {
  const double *box = b->bodies[b->labels[face]].box, scale = b->frame.scale;
  const double middle[3] = {(box[0] + box[3]) / 2, (box[1] + box[4]) / 2, (box[2] + box[5]) / 2};
  for (size_t f = face; f < end; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(b->soup, f, &count);
    if (count < 3 || !vxm_face_is_finite(b->soup, corner, count))
      continue;
    const double *p = vxm_position(b->soup, corner[0]);
    vxm_vec3 first = {p[0] * scale - middle[0], p[1] * scale - middle[1], p[2] * scale - middle[2]};
    volume += vxm_polygon_cone(first, vxm_polygon_area(b->soup->positions, corner, count, scale));
  }
  return volume;
}

static bool sum_volumes(builder *b, double *volume) {
  double scale = b->frame.scale;
  for (size_t f = 0, end; f < b->soup->face_count; f = end) {
    end = end_of_run(b, f);
    if (vxm_check_cancelled_at(f, b->context, &b->error) != VXM_OK)
      return false;
    volume[b->labels[f]] = add_cones(b, f, end, volume[b->labels[f]]);
  }
  for (size_t i = 0; i < b->count; i++) {
    b->bodies[i].volume = fabs(volume[i]);
    volume[i] = volume[i] / scale / scale / scale;
  }
  return true;
}

/* ---- Candidates: solid components by increasing box ---- */

/** Rounds to so many bits, so that what should be the same is, but for few numbers. */
static double rounded(double x, int bits) {
  int exponent = 0;
  double part = frexp(x, &exponent);
  return ldexp(rint(ldexp(part, bits)), exponent - bits);
}

static void rank(body *b) {
  b->rank[0] = rounded(b->size, SIZE_BITS);
  b->rank[1] = rounded(b->volume, VOLUME_BITS);
  b->rank[2] = b->size;
}

static bool is_smaller(const body *a, const body *b) {
  for (int i = 0; i < 2; i++)
    if (a->rank[i] != b->rank[i])
      return a->rank[i] < b->rank[i];
  return a->rank[2] < b->rank[2];
}

static int smaller_first(const void *p, const void *q) {
  const body *a = p, *b = q;
  if (is_smaller(a, b) || is_smaller(b, a))
    return is_smaller(a, b) ? -1 : 1;
  return a->component < b->component ? -1 : a->component > b->component;
}

static bool order_bodies(builder *b) {
  body *sorted = allocate(b, b->count, sizeof *sorted);
  b->order = allocate(b, b->count, sizeof *b->order);
  if (sorted && b->order) {
    for (size_t i = 0; i < b->count; i++) {
      rank(&b->bodies[i]);
      if (is_solid(b, i))
        sorted[b->order_count++] = b->bodies[i];
    }
    qsort(sorted, b->order_count, sizeof *sorted, smaller_first);
    for (size_t i = 0; i < b->order_count; i++)
      b->order[i] = sorted[i].component;
  }
  vxm_free(b->context, sorted);
  return b->order != NULL && sorted != NULL;
}

static bool list_candidates(builder *b) {
  b->boxes = allocate(b, b->order_count, sizeof *b->boxes);
  for (size_t i = 0; b->boxes && i < b->order_count; i++)
    memcpy(b->boxes[i], b->bodies[b->order[i]].box, sizeof *b->boxes);
  return b->boxes && vxm_box_tree_build(&b->around, b->context, (const double(*)[6])b->boxes, b->order_count,
                                        &b->error) == VXM_OK;
}

/* ---- Containment ---- */

static vxm_face_list faces_of(const builder *b, uint32_t component) {
  size_t first = b->bodies[component].first;
  return (vxm_face_list){.soup = b->soup,
                         .faces = b->faces + first,
                         .count = b->bodies[component + 1].first - first,
                         .scale = b->frame.scale};
}

static vxm_point_in_mesh *inside_of(builder *b, uint32_t component) {
  vxm_point_in_mesh *inside = b->inside[component];
  if (!inside)
    inside = b->inside[component] = allocate(b, 1, sizeof *inside);
  if (inside && !inside->soup) {
    vxm_face_list list = faces_of(b, component);
    *inside = (vxm_point_in_mesh){
        .soup = b->soup, .faces = list.faces, .face_count = list.count, .scale = b->frame.scale};
    memcpy(inside->box, b->bodies[component].box, sizeof inside->box);
  }
  return inside;
}

/** Where a sample of the inner one lies on faces of the outer one rays go wrong: then it is moved into the
 * inner one. */
static vxm_status clear_sample(builder *b, uint32_t outer, uint32_t inner, vxm_face_sample *s) {
  if (!(b->bodies[inner].volume < SMALLER * b->bodies[outer].volume))
    return VXM_OK;
  bool on_face = false;
  double height = 0;
  vxm_status status = vxm_point_in_mesh_on_face(b->inside[outer], s->point, b->leeway, &on_face, &b->error);
  if (status != VXM_OK || !on_face)
    return status;
  vxm_point_in_mesh *own = inside_of(b, inner);
  if (!own)
    return b->error.code;
  status = vxm_point_in_mesh_into(own, s->point, s->axis, b->leeway, &height, &b->error);
  s->point[s->axis] += height;
  return status;
}

/** The samples that there are of the inner one; *count: how many. */
static vxm_status take_samples(builder *b, uint32_t outer, uint32_t inner,
                               vxm_face_sample samples[VXM_FACE_SAMPLES], int *count) {
  vxm_face_list list = faces_of(b, inner);
  *count = 0;
  for (int s = 0; s < VXM_FACE_SAMPLES; s++) {
    if (!vxm_face_sample_take(&list, s, &samples[*count]))
      continue;
    vxm_status status = clear_sample(b, outer, inner, &samples[(*count)++]);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

/** Whether the box of the inner one is the smaller one, and does not reach out of the other at all. */
static bool fits(const body *outer, const body *inner) {
  for (int a = 0; a < 3; a++)
    if (inner->box[a] < outer->box[a] || inner->box[a + 3] > outer->box[a + 3])
      return false;
  return inner->size < outer->size;
}

/** By a few samples; where boxes alone would say no, all of them have to agree. */
static vxm_status contains(builder *b, uint32_t outer, uint32_t inner, bool *result) {
  vxm_point_in_mesh *inside = inside_of(b, outer);
  if (!inside)
    return b->error.code;
  vxm_face_sample samples[VXM_FACE_SAMPLES];
  int count;
  vxm_status status = take_samples(b, outer, inner, samples, &count);
  bool all = !fits(&b->bodies[outer], &b->bodies[inner]);
  return status == VXM_OK ? vxm_face_samples_vote(inside, samples, count, all, result, &b->error) : status;
}

static bool is_against(const builder *b, uint32_t p, uint32_t q) {
  return (b->volume[p] < 0 && b->volume[q] > 0) || (b->volume[p] > 0 && b->volume[q] < 0);
}

/** Which part of the inner one, which may be a void, reaches out of a body that it may be a void of. */
static vxm_status measure_outside(builder *b, uint32_t outer, uint32_t inner, double *part) {
  size_t wanted = b->points < POINTS_IN_ALL ? POINTS : POINTS_FEW;
  vxm_face_list list = faces_of(b, inner);
  vxm_points_outside found = {0};
  vxm_status status = VXM_OK;
  if (is_against(b, outer, inner))
    status = vxm_face_points_outside(b->inside[outer], &list, b->leeway, wanted, &found, &b->error);
  b->points += found.points;
  *part = found.points > 0 ? (double)found.outside / (double)found.points : 0;
  return status;
}

/** First place in the order whose body is larger than the given one. */
static size_t first_larger(const builder *b, const body *than) {
  size_t begin = 0, end = b->order_count;
  while (begin < end) {
    size_t middle = begin + (end - begin) / 2;
    if (is_smaller(than, &b->bodies[b->order[middle]]))
      end = middle;
    else
      begin = middle + 1;
  }
  return begin;
}

/** Components whose box is around another one's that are looked at as its parent; of the nearest so many one
 * will do. */
enum { TRIES_MAX = 256 };

static uint32_t set_of(const builder *b, uint32_t component) {
  return b->soup->face_sets[b->faces[b->bodies[component].first]];
}

/** Begins the search for what the box of a component lies in. */
static void search_around(builder *b, uint32_t component) {
  const body *inner = &b->bodies[component];
  double box[6];
  for (int a = 0; a < 3; a++) {
    box[a] = inner->box[a] + b->leeway;
    box[a + 3] = inner->box[a + 3] - b->leeway;
  }
  vxm_box_tree_search(&b->around, box, first_larger(b, inner));
}

/**
 * Finds the components around another one, the smallest ones first.
 *
 * A void may be cut out of a body that is around all of it, and only crosses others: where there is a choice,
 * those go that it reaches out of. If it reaches out of all, of whichever set, one is left that it does so
 * least.
 *
 * @param own_set only those of the component's set come into question
 * @param most    so many of them will do
 */
static vxm_status find_around(builder *b, uint32_t component, bool own_set, uint32_t *around, size_t most,
                              size_t *count) {
  double least = INFINITY;
  uint32_t nearest = VXM_NO_COMPONENT;
  search_around(b, component);
  *count = 0;
  uint32_t next = vxm_box_tree_next(&b->around);
  for (int tries = 0, looks = 0;
       next != VXM_NO_BOX && tries < TRIES_MAX && looks < 16 * TRIES_MAX && *count < most; looks++) {
    uint32_t other = b->order[next];
    next = vxm_box_tree_next(&b->around);
    if (own_set && set_of(b, other) != set_of(b, component))
      continue;
    bool within = false, choice = looks > 0 || next != VXM_NO_BOX;
    double outside = 0;
    tries++;
    vxm_status status = contains(b, other, component, &within);
    if (status == VXM_OK && within && choice)
      status = measure_outside(b, other, component, &outside);
    if (status != VXM_OK)
      return status;
    if (within && outside <= OUTSIDE_MAX)
      around[(*count)++] = other;
    else if (within && outside < least) {
      least = outside;
      nearest = other;
    }
  }
  if (*count == 0 && nearest != VXM_NO_COMPONENT && !own_set)
    around[(*count)++] = nearest;
  return VXM_OK;
}

static bool find_parents(builder *b, uint32_t *parents) {
  size_t count;
  b->inside = allocate(b, b->count, sizeof *b->inside);
  if (!b->inside)
    return false;
  for (size_t i = 0; i < b->order_count; i++) {
    uint32_t *parent = &parents[b->order[i]];
    if (vxm_check_cancelled(b->context, &b->error) != VXM_OK ||
        (b->soup->face_sets && find_around(b, b->order[i], true, parent, 1, &count) != VXM_OK) ||
        (*parent == VXM_NO_COMPONENT && find_around(b, b->order[i], false, parent, 1, &count) != VXM_OK))
      return false;
  }
  return true;
}

/* ---- Voids ---- */

static vxm_status list_around(void *payload, uint32_t component, uint32_t **around, size_t *count,
                              vxm_error *error) {
  builder *b = payload;
  uint32_t list[2 * TRIES_MAX];
  size_t own = 0, all = 0;
  vxm_status status = vxm_check_cancelled(b->context, &b->error);
  if (status == VXM_OK && b->soup->face_sets)
    status = find_around(b, component, true, list, TRIES_MAX, &own);
  if (status == VXM_OK)
    status = find_around(b, component, false, list + own, TRIES_MAX, &all);
  *count = own + all; /* those of the own set are there twice: they are to be chosen first */
  *around = status == VXM_OK ? allocate(b, *count, sizeof **around) : NULL;
  if (!*around) {
    vxm_error_pass(error, &b->error);
    return b->error.code;
  }
  memcpy(*around, list, *count * sizeof *list);
  return VXM_OK;
}

static bool may_have_several(void *payload, uint32_t component) {
  builder *b = payload;
  search_around(b, component);
  return vxm_box_tree_next(&b->around) != VXM_NO_BOX && vxm_box_tree_next(&b->around) != VXM_NO_BOX;
}

static bool may_overlap(void *payload, uint32_t a, uint32_t b) {
  const builder *p = payload;
  const double *s = p->bodies[a].box, *t = p->bodies[b].box, touch = 2 * p->leeway;
  for (int x = 0; x < 3; x++)
    if (s[x + 3] - t[x] <= touch || t[x + 3] - s[x] <= touch)
      return false;
  return true;
}

static bool find_voids(builder *b, vxm_containment *out) {
  const vxm_void_search search = {.context = b->context,
                                  .count = b->count,
                                  .order = b->order,
                                  .order_count = b->order_count,
                                  .parent = out->parent,
                                  .volume = out->volume,
                                  .list_around = list_around,
                                  .may_have_several = may_have_several,
                                  .may_overlap = may_overlap,
                                  .payload = b};
  return vxm_voids_find(out->body, &search, &b->error) == VXM_OK;
}

/* ---- All together ---- */

static bool run(builder *b, vxm_containment *out) {
  out->parent = allocate(b, b->count, sizeof *out->parent);
  out->body = allocate(b, b->count, sizeof *out->body);
  out->volume = allocate(b, b->count, sizeof *out->volume);
  b->bodies = allocate(b, b->count + 1, sizeof *b->bodies);
  if (!out->parent || !out->body || !out->volume || !b->bodies || !measure_bodies(b))
    return false;
  b->volume = out->volume;
  scale_boxes(b);
  for (size_t i = 0; i < b->count; i++)
    out->parent[i] = out->body[i] = VXM_NO_COMPONENT;
  if (!sum_volumes(b, out->volume) || !order_bodies(b))
    return false;
  return b->order_count < 2 ||
         (list_faces(b) && list_candidates(b) && find_parents(b, out->parent) && find_voids(b, out));
}

vxm_status vxm_containment_build(vxm_containment *out, const vxm_soup *soup, const uint32_t *face_labels,
                                 size_t count, const uint8_t *solid, vxm_error *error) {
  *out = (vxm_containment){.context = soup->context, .count = count};
  builder b = {.soup = soup,
               .labels = face_labels,
               .solid = solid,
               .context = soup->context,
               .error = VXM_ERROR_INIT,
               .count = count};
  bool done = run(&b, out);
  for (size_t i = 0; b.inside && i < count; i++)
    if (b.inside[i]) {
      vxm_point_in_mesh_release(b.inside[i]);
      vxm_free(b.context, b.inside[i]);
    }
  vxm_free(b.context, b.inside);
  vxm_box_tree_destroy(&b.around);
  vxm_free(b.context, b.boxes);
  vxm_free(b.context, b.order);
  vxm_free(b.context, b.faces);
  vxm_free(b.context, b.bodies);
  if (done)
    return VXM_OK;
  vxm_containment_destroy(out);
  vxm_error_pass(error, &b.error);
  return b.error.code;
}

void vxm_containment_destroy(vxm_containment *containment) {
  if (!containment->context)
    return;
  vxm_free(containment->context, containment->volume);
  vxm_free(containment->context, containment->body);
  vxm_free(containment->context, containment->parent);
  *containment = (vxm_containment){0};
}
