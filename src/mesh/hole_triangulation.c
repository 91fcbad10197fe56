/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/hole_triangulation.h"

#include "base/threads.h"
#include "mesh/geometry.h"

#include <string.h>

/* The best filling of the walk from i to k, closed by the chord from k to i, has a triangle i m k and on both
   sides of it the best fillings from i to m and from m to k. All tables are kept twice, at [i][k] and at
   [k][i], so that for all m both parts lie in a row. */

/** Cosines and, relatively, areas this near to each other are the same: otherwise rounding would choose. */
static const double SAME_BEND = 1e-7, SAME_AREA = 1e-9;

/** How good a filling is. */
typedef struct weight {
  double bend; /**< the least cosine of the angle between the normals of neighbours */
  double area;
  double length; /**< of the chords */
} weight;

static const weight IMPOSSIBLE = {-2, 0, 0};

typedef struct table {
  const vxm_rim *rim;
  const uint32_t *loop;
  size_t count;
  double (*points)[3];
  weight *weights;
  vxm_vec3 *normals; /**< of the triangle on the chord; at rim edges of the face beyond */
  uint32_t *middles; /**< the third corner of that triangle */
} table;

static bool is_better(const weight *a, const weight *b) {
  if (fabs(a->bend - b->bend) > SAME_BEND)
    return a->bend > b->bend;
  if (fabs(a->area - b->area) > SAME_AREA * (a->area + b->area))
    return a->area < b->area;
  return a->length < b->length;
}

/** The cosine between two normals; a face without a normal fits everywhere. */
static double bend_between(const vxm_vec3 *a, const vxm_vec3 *b) {
  double dot = vxm_vec3_dot(*a, *b);
  return vxm_vec3_dot(*a, *a) > 0 && vxm_vec3_dot(*b, *b) > 0 ? dot : 1;
}

static double smaller(double a, double b) {
  return b < a ? b : a;
}

static vxm_vec3 outer_normal(const table *t, size_t i) {
  uint32_t from = t->loop[i], to = t->loop[i + 1 < t->count ? i + 1 : 0];
  if (to != (from + 1 < t->rim->count ? from + 1 : 0))
    return (vxm_vec3){0, 0, 0};
  const double *n = t->rim->normals[from];
  return (vxm_vec3){n[0], n[1], n[2]};
}

static void put(table *t, size_t i, size_t k, weight w, vxm_vec3 normal, uint32_t middle) {
  for (int mirror = 0; mirror < 2; mirror++) {
    size_t cell = mirror == 0 ? i * t->count + k : k * t->count + i;
    t->weights[cell] = w;
    t->normals[cell] = normal;
    t->middles[cell] = middle;
  }
}

/** Fills in the best triangle on the chord from i to k. */
static void choose(table *t, size_t i, size_t k) {
  bool is_last = i == 0 && k + 1 == t->count;
  weight best = IMPOSSIBLE;
  vxm_vec3 best_normal = {0, 0, 0}, chord = vxm_vec3_between(t->points[k], t->points[i], 1);
  vxm_vec3 beyond = is_last ? outer_normal(t, k) : (vxm_vec3){0, 0, 0};
  uint32_t middle = 0;
  if (!is_last &&
      (!(vxm_vec3_length(chord) > 0) || t->rim->is_edge(t->loop[i], t->loop[k], t->rim->payload))) {
    put(t, i, k, best, best_normal, middle);
    return;
  }
  double length = is_last ? 0 : vxm_vec3_length(chord);
  const weight *from_i = t->weights + i * t->count, *from_k = t->weights + k * t->count;
  const vxm_vec3 *normal_i = t->normals + i * t->count, *normal_k = t->normals + k * t->count;
  for (size_t m = i + 1; m < k; m++) {
    weight w = {smaller(from_i[m].bend, from_k[m].bend), from_i[m].area + from_k[m].area,
                from_i[m].length + from_k[m].length + length};
    if (w.bend < -1.5 || w.bend < best.bend - SAME_BEND)
      continue;
    vxm_vec3 arm = vxm_vec3_between(t->points[m], t->points[i], 1), normal = vxm_vec3_cross(arm, chord);
    double doubled = vxm_vec3_length(normal);
    if (!(doubled > 2 * t->rim->no_area))
      continue;
    if (doubled > 0)
      normal = (vxm_vec3){normal.x / doubled, normal.y / doubled, normal.z / doubled};
    w.area += 0.5 * doubled;
    w.bend = smaller(w.bend, bend_between(&normal, &normal_i[m]));
    w.bend = smaller(w.bend, bend_between(&normal, &normal_k[m]));
    w.bend = smaller(w.bend, bend_between(&normal, &beyond));
    if (!is_better(&w, &best))
      continue;
    best = w;
    best_normal = normal;
    middle = (uint32_t)m;
  }
  put(t, i, k, best, best_normal, middle);
}

/** The chords over so many edges, some of them. */
typedef struct layer {
  table *table;
  size_t gap;
} layer;

enum { CHORDS_PER_SLICE = 32 };

static void choose_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const layer *l = payload;
  size_t begin = slice * CHORDS_PER_SLICE, end = begin + CHORDS_PER_SLICE;
  for (size_t i = begin; i < end && i + l->gap < l->table->count; i++)
    choose(l->table, i, i + l->gap);
}

static vxm_status fill_table(table *t, vxm_error *error) {
  for (size_t i = 0; i + 1 < t->count; i++)
    put(t, i, i + 1, (weight){1, 0, 0}, outer_normal(t, i), 0);
  for (size_t gap = 2; gap < t->count; gap++) {
    layer l = {t, gap};
    vxm_parallel(t->rim->context, (t->count - gap - 1) / CHORDS_PER_SLICE + 1, choose_slice, &l);
    if (gap % 16 == 0 || gap + 1 == t->count) {
      vxm_status status = vxm_progress(t->rim->context, "filling holes", t->rim->fraction, error);
      if (status != VXM_OK)
        return status;
    }
  }
  return VXM_OK;
}

/** Walks down from the last chord; chords that wait lie behind the triangles yet to be written. */
static void list_triangles(const table *t, uint32_t (*triangles)[3]) {
  size_t done = 0, waiting = 1, room = t->count - 2;
  triangles[room - 1][0] = 0;
  triangles[room - 1][1] = (uint32_t)t->count - 1;
  while (waiting > 0) {
    uint32_t i = triangles[room - waiting][0], k = triangles[room - waiting][1];
    uint32_t m = t->middles[(size_t)i * t->count + k];
    waiting--;
    triangles[done][0] = t->loop[i];
    triangles[done][1] = t->loop[m];
    triangles[done++][2] = t->loop[k];
    const uint32_t parts[2][2] = {{i, m}, {m, k}};
    for (int p = 0; p < 2; p++)
      if (parts[p][1] - parts[p][0] > 1) {
        waiting++;
        triangles[room - waiting][0] = parts[p][0];
        triangles[room - waiting][1] = parts[p][1];
      }
  }
}

vxm_status vxm_hole_subdivide(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim,
                              const uint32_t *loop, size_t count, vxm_error *error) {
  *filled = false;
  vxm_error local = VXM_ERROR_INIT;
  vxm_context *context = rim->context;
  table t = {.rim = rim, .loop = loop, .count = count};
  size_t cells; /* a row of them if there are too many: then the product of the sizes is refused as well */
  if (__builtin_mul_overflow(count, count, &cells))
    cells = SIZE_MAX;
  t.points = vxm_alloc(context, count, sizeof *t.points, &local);
  t.weights = t.points ? vxm_alloc(context, cells, sizeof *t.weights, &local) : NULL;
  t.normals = t.weights ? vxm_alloc(context, cells, sizeof *t.normals, &local) : NULL;
  t.middles = t.normals ? vxm_alloc(context, cells, sizeof *t.middles, &local) : NULL;
  vxm_status status = local.code;
  if (t.middles) {
    for (size_t i = 0; i < count; i++)
      memcpy(t.points[i], rim->points[loop[i]], sizeof *t.points);
    status = fill_table(&t, &local);
    *filled = status == VXM_OK && t.weights[count - 1].bend > -1.5;
    if (*filled)
      list_triangles(&t, triangles);
  }
  vxm_free(context, t.middles);
  vxm_free(context, t.normals);
  vxm_free(context, t.weights);
  vxm_free(context, t.points);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
