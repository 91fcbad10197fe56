/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts/triangle_set.h"
#include "base/box.h"
#include "mesh/quad_diagonal.h"
#include "mesh/triangulate.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/** What is needed while triangles are made. */
typedef struct builder {
  vxm_triangle_set *triangles;
  const vxm_soup *soup;
  size_t *next;       /**< per part: where the next triangle goes, or how many there are */
  uint32_t (*cut)[3]; /**< the triangles of all faces of more than four corners, one after another */
  size_t cut_next;    /**< of them: the first one of the next such face */
  vxm_error error;    /**< of the last allocation that failed */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->triangles->context, count, size, &b->error);
}

/** The same, not zeroed: for what is written as a whole. */
static void *allocate_raw(builder *b, size_t count, size_t size) {
  return vxm_alloc(b->triangles->context, count, size, &b->error);
}

/* ---- Cutting polygons into triangles ---- */

/** How many triangles the faces have that are cut before they are counted. */
static size_t count_cut(const vxm_soup *soup) {
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
    count += n > 4 ? n - 2 : 0;
  }
  return count;
}

/** Faces of more than four corners, which take more work than to be cut twice. */
static vxm_status cut_large(builder *b) {
  const vxm_soup *soup = b->soup;
  size_t count = count_cut(soup), at = 0;
  vxm_status status = VXM_OK;
  if (count == 0)
    return VXM_OK;
  b->cut = allocate_raw(b, count, sizeof *b->cut);
  if (!b->cut)
    return b->error.code;
  vxm_triangulator triangulator;
  vxm_triangulator_open(&triangulator, b->triangles->context);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n), *triangles;
    status = vxm_check_cancelled_at(f, b->triangles->context, &b->error);
    if (n <= 4 || status != VXM_OK)
      continue;
    status = vxm_triangulate(&triangulator, soup->positions, corner, n, &triangles, &b->error);
    if (status == VXM_OK)
      memcpy(b->cut + at, triangles, (n - 2) * sizeof *b->cut);
    at += n - 2;
  }
  vxm_triangulator_close(&triangulator);
  return status;
}

/** A triangle with two equal corners covers nothing. */
static bool has_three_corners(uint32_t p, uint32_t q, uint32_t r) {
  return p != q && q != r && r != p;
}

/** Counts a triangle of its part (no triangles yet) or puts it in place. */
static inline void add(builder *b, uint32_t part, uint32_t p, uint32_t q, uint32_t r) {
  size_t at = b->next[part]++;
  if (!b->triangles->corners)
    return;
  uint32_t *corner = b->triangles->corners[at];
  corner[0] = p;
  corner[1] = q;
  corner[2] = r;
  b->triangles->part[at] = part;
}

/** The same of one that may have two equal corners. */
static inline void add_face(builder *b, uint32_t part, uint32_t p, uint32_t q, uint32_t r) {
  if (has_three_corners(p, q, r))
    add(b, part, p, q, r);
}

static inline void cut_quad(builder *b, uint32_t part, const uint32_t corner[4]) {
  uint32_t v = corner[0], w = corner[1], x = corner[2], y = corner[3];
  bool differ = has_three_corners(v, w, x) && has_three_corners(x, y, v) && w != y;
  if (differ && !b->triangles->corners) { /* two, whichever they are */
    b->next[part] += 2;
    return;
  }
  const double *at[4];
  for (int k = 0; k < 4; k++)
    at[k] = vxm_position(b->soup, corner[k]);
  size_t k = vxm_quad_diagonal(at);
  add_face(b, part, corner[k], corner[k + 1], corner[k + 2]);
  add_face(b, part, corner[k], corner[k + 2], corner[(k + 3) % 4]);
}

static inline void cut_face(builder *b, size_t face) {
  const vxm_split *split = &b->triangles->split;
  size_t n;
  const uint32_t *corner = vxm_face(b->soup, face, &n);
  uint32_t part = split->part[split->component[face]];
  size_t first = b->next[part];
  if (n == 3)
    add_face(b, part, corner[0], corner[1], corner[2]);
  else if (n == 4)
    cut_quad(b, part, corner);
  for (size_t t = 0; n > 4 && t + 2 < n; t++, b->cut_next++)
    add_face(b, part, b->cut[b->cut_next][0], b->cut[b->cut_next][1], b->cut[b->cut_next][2]);
  if (b->triangles->lone && split->lone[split->component[face]])
    memset(b->triangles->lone + first, 1, b->next[part] - first);
}

static bool add_triangles(builder *b) {
  b->cut_next = 0;
  for (size_t f = 0; f < b->soup->face_count; f++) {
    if (vxm_check_cancelled_at(f, b->triangles->context, &b->error) != VXM_OK)
      return false;
    cut_face(b, f);
  }
  return true;
}

/** The caps of all loops; their own points are numbered behind the soup's vertices in both numberings. */
static bool add_caps(builder *b) {
  const vxm_split *split = &b->triangles->split;
  for (size_t l = 0; split->cap_begin && l < split->loops.count; l++)
    for (size_t t = split->cap_begin[l]; t < split->cap_begin[l + 1]; t++) {
      const uint32_t *v = split->caps.triangles[t];
      add(b, split->loop_part[l], v[0], v[1], v[2]);
    }
  return true;
}

/** The triangles from the apex of a part to its odd edges. */
static bool add_cones(builder *b) {
  const vxm_split *split = &b->triangles->split;
  const vxm_boundary_loops *loops = &split->loops;
  for (size_t l = 0; l < loops->count; l++) {
    uint32_t part = split->loop_part[l];
    for (size_t s = loops->begin[l]; s < loops->begin[l + 1]; s++) {
      const vxm_edge *edge = &split->edges.edges[loops->edge[s]];
      add(b, part, edge->a, edge->b, vxm_apex_of(b->triangles, part));
    }
  }
  return true;
}

/** The same three walks twice: the first time they count, the second time they put triangles in place. */
static vxm_status make_triangles(builder *b) {
  static bool (*const walk[3])(builder *) = {add_triangles, add_caps, add_cones};
  vxm_triangle_set *triangles = b->triangles;
  size_t part_count = triangles->split.part_count;
  b->next = allocate(b, part_count, sizeof *b->next);
  triangles->parts = allocate(b, part_count, sizeof *triangles->parts);
  if (!triangles->parts || !b->next || cut_large(b) != VXM_OK)
    return b->error.code;
  for (int w = 0; w < 3; w++) {
    if (!walk[w](b))
      return b->error.code;
    for (size_t p = 0; p < part_count; p++)
      *(w == 0   ? &triangles->parts[p].caps
        : w == 1 ? &triangles->parts[p].cones
                 : &triangles->parts[p].end) = b->next[p];
  }
  size_t total = 0;
  for (size_t p = 0; p < part_count; p++) {
    vxm_part *part = &triangles->parts[p];
    part->begin = total;
    part->caps += total;
    part->cones += total;
    part->end += total;
    total = part->end;
    b->next[p] = part->begin;
  }
  if (total > UINT32_MAX)
    return vxm_fail(&b->error, VXM_ERROR_RANGE, "%zu triangles are too many to number; split the mesh",
                    total);
  triangles->triangle_count = total;
  triangles->part = allocate_raw(b, total, sizeof *triangles->part);
  triangles->corners = allocate_raw(b, total, sizeof *triangles->corners);
  if (!triangles->corners || !triangles->part)
    return b->error.code;
  if (triangles->split.lone && !(triangles->lone = allocate(b, total, sizeof *triangles->lone)))
    return b->error.code;
  for (int w = 0; w < 3; w++)
    if (!walk[w](b))
      return b->error.code;
  return VXM_OK;
}

/* ---- Points ---- */

/** The numbers before points are counted: the soup's vertices, the caps' own points, an apex for each part.
 */
static vxm_status number_points(builder *b, vxm_error *error) {
  vxm_triangle_set *triangles = b->triangles;
  triangles->first_apex = b->soup->vertex_count + triangles->split.caps.point_count;
  triangles->point_count = triangles->first_apex + triangles->split.part_count;
  if (triangles->point_count > VXM_VERTICES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "too many vertices, parts and holes to number; split the mesh");
  return VXM_OK;
}

static const double *position_of(const builder *b, uint32_t vertex) {
  size_t count = b->soup->vertex_count;
  return vertex < count ? vxm_position(b->soup, vertex) : b->triangles->split.caps.points[vertex - count];
}

/** Numbers points anew, as triangles have them one after another; false if it was cancelled. `vertex` has
 * room for one more than there are. */
static bool renumber(builder *b, uint32_t *number, uint32_t *vertex, size_t *points) {
  vxm_triangle_set *triangles = b->triangles;
  enum { AHEAD = 16 }; /* triangles, whose vertices lie here and there */
  const uint32_t none = UINT32_MAX;
  size_t count = 0, first_apex = triangles->first_apex;
  memset(number, 0xff, first_apex * sizeof *number); /* none */
  for (size_t f = 0; f < triangles->triangle_count; f++) {
    if (vxm_check_cancelled_at(f, triangles->context, &b->error) != VXM_OK)
      return false;
    for (int k = 0; k < 3 && f + AHEAD < triangles->triangle_count; k++)
      if (triangles->corners[f + AHEAD][k] < first_apex)
        __builtin_prefetch(&number[triangles->corners[f + AHEAD][k]], 1);
    for (int k = 0; k < 3; k++) {
      uint32_t *corner = &triangles->corners[f][k];
      if (*corner >= first_apex)
        continue;
      /* without a branch on whether it is new, as nobody can tell */
      uint32_t old = *corner, known = number[old];
      bool is_new = known == none;
      vertex[count] = old;
      *corner = number[old] = is_new ? (uint32_t)count : known;
      count += is_new;
    }
  }
  *points = count;
  return true;
}

/** The apexes, once it is known how many points lie before them. */
static void renumber_apexes(vxm_triangle_set *triangles, size_t count) {
  for (size_t p = 0; p < triangles->split.part_count; p++)
    for (size_t f = triangles->parts[p].cones; f < triangles->parts[p].end; f++)
      triangles->corners[f][2] = (uint32_t)(count + p);
  triangles->first_apex = count;
  triangles->point_count = count + triangles->split.part_count;
}

static vxm_status gather_points(builder *b) {
  vxm_triangle_set *triangles = b->triangles;
  size_t count = 0;
  uint32_t *number = allocate_raw(b, triangles->first_apex, sizeof *number);
  triangles->vertex = allocate_raw(b, triangles->first_apex + 1, sizeof *triangles->vertex);
  bool done = number && triangles->vertex && renumber(b, number, triangles->vertex, &count);
  vxm_free(triangles->context, number);
  if (!done)
    return b->error.code;
  renumber_apexes(triangles, count);
  triangles->positions = allocate_raw(b, triangles->first_apex, sizeof *triangles->positions);
  if (!triangles->positions)
    return b->error.code;
  for (size_t p = 0; p < triangles->first_apex; p++) {
    if (vxm_check_cancelled_at(p, triangles->context, &b->error) != VXM_OK)
      return b->error.code;
    memcpy(triangles->positions[p], position_of(b, triangles->vertex[p]), sizeof triangles->positions[p]);
  }
  return VXM_OK;
}

/* ---- Sizes ---- */

static inline double squared_distance(const double *p, const double *q) {
  double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
  return x * x + y * y + z * z;
}

static inline double larger(double most, double x) {
  return x > most ? x : most;
}

/** Of positions that may be no numbers. */
static void find_box(vxm_triangle_set *triangles) {
  vxm_box_empty(triangles->low, triangles->high);
  for (size_t p = 0; p < triangles->first_apex; p++)
    vxm_box_include(triangles->low, triangles->high, triangles->positions[p]);
}

/** Sums up how long triangles are. A cone reaches from its edge to somewhere among the triangles. */
static vxm_status measure(vxm_triangle_set *triangles, vxm_error *error) {
  vxm_edge_lengths faces = {0}, *cones = &triangles->lengths[VXM_LENGTHS_CONES];
  find_box(triangles);
  for (size_t f = 0; f < triangles->triangle_count; f++) {
    const uint32_t *corner = triangles->corners[f];
    vxm_status status = vxm_check_cancelled_at(f, triangles->context, error);
    if (status != VXM_OK)
      return status;
    if (corner[2] >= triangles->first_apex) {
      cones->count++;
      continue;
    }
    const double *p = triangles->positions[corner[0]], *q = triangles->positions[corner[1]],
                 *r = triangles->positions[corner[2]];
    double squared = larger(0, squared_distance(p, q)); /* what is no number is left out */
    squared = larger(squared, squared_distance(q, r));
    squared = larger(squared, squared_distance(r, p));
    faces.count++;
    faces.sum += sqrt(squared);
    faces.squared += squared;
  }
  triangles->lengths[VXM_LENGTHS_FACES] = faces;
  if (cones->count > 0) {
    double diagonal = squared_distance(triangles->low, triangles->high);
    cones->sum = cones->count * sqrt(diagonal);
    cones->squared = cones->count * diagonal;
  }
  return VXM_OK;
}

vxm_status vxm_triangle_set_create(vxm_triangle_set *out, const vxm_soup *soup, vxm_split_rule rule,
                                   vxm_error *error) {
  static atomic_uint_fast64_t last_serial;
  *out = (vxm_triangle_set){.context = soup->context, .soup = soup, .split = {.context = soup->context}};
  out->serial = atomic_fetch_add(&last_serial, 1) + 1;
  builder b = {.triangles = out, .soup = soup, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_split_create(&out->split, soup, rule, &local);
  if (status == VXM_OK)
    status = number_points(&b, &local);
  if (status == VXM_OK)
    status = make_triangles(&b);
  if (status == VXM_OK)
    status = gather_points(&b);
  vxm_free(out->context, b.next);
  vxm_free(out->context, b.cut);
  if (status == VXM_OK)
    status = measure(out, &local);
  if (status == VXM_OK)
    vxm_split_trim(&out->split);
  else
    vxm_error_pass(error, local.code != VXM_OK ? &local : &b.error);
  return status;
}

void vxm_triangle_set_destroy(vxm_triangle_set *triangles) {
  vxm_split_destroy(&triangles->split);
  vxm_free(triangles->context, triangles->positions);
  vxm_free(triangles->context, triangles->vertex);
  vxm_free(triangles->context, triangles->parts);
  vxm_free(triangles->context, triangles->part);
  vxm_free(triangles->context, triangles->lone);
  vxm_free(triangles->context, triangles->corners);
  *triangles = (vxm_triangle_set){.context = triangles->context, .split = {.context = triangles->context}};
}
