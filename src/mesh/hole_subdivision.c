/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/hole_triangulation.h"

#include "mesh/geometry.h"

#include <string.h>

/* A long rim is cut in two by a chord that is short against the walk between its ends, until the parts are
   short. Such a chord may run outside of a plane hole; then some triangle lies the wrong way round. */

enum {
  PART = 200,  /**< edges of a part that is not cut further */
  SAMPLES = 64 /**< places of a part between which chords are tried */
};

static const double PART_LEAST = 0.125; /**< of the edges, on either side of a cut */
static const double FLAT = 1e-6;        /**< distance from a plane, by the size, of what lies in it */

typedef struct cutting {
  const vxm_rim *rim;
  uint32_t (*triangles)[3];
  size_t done;
  uint32_t *loops; /**< the parts that wait, one behind the other, and room to cut the last one */
  size_t *lengths; /**< of these */
  size_t depth;    /**< parts that wait */
  double *along;   /**< scratch */
} cutting;

static vxm_vec3 between(const vxm_rim *rim, uint32_t p, uint32_t q) {
  return vxm_vec3_between(rim->points[p], rim->points[q], 1);
}

/* ---- Cutting ---- */

/** Finds where to cut a part: from i to j. */
static bool find_cut(const cutting *c, const uint32_t *loop, size_t count, size_t cut[2]) {
  double best = INFINITY, *along = c->along;
  size_t least = (size_t)(PART_LEAST * (double)count);
  along[0] = 0;
  for (size_t i = 0; i < count; i++)
    along[i + 1] = along[i] + vxm_vec3_length(between(c->rim, loop[(i + 1) % count], loop[i]));
  for (size_t p = 0; p < SAMPLES; p++)
    for (size_t q = p + 1; q < SAMPLES; q++) {
      size_t i = p * count / SAMPLES, j = q * count / SAMPLES;
      double walk = along[j] - along[i], around = along[count] - walk;
      double ratio = vxm_vec3_length(between(c->rim, loop[i], loop[j])) / (walk < around ? walk : around);
      if (j - i < least || count - (j - i) < least || !(ratio < best) ||
          c->rim->is_edge(loop[i], loop[j], c->rim->payload))
        continue;
      best = ratio;
      cut[0] = i;
      cut[1] = j;
    }
  return isfinite(best);
}

/** Puts the two parts of the last loop in its place. */
static void split(cutting *c, uint32_t *loop, size_t count, const size_t cut[2]) {
  size_t inner = cut[1] - cut[0] + 1, outer = count - inner + 2;
  uint32_t *spare = loop + count;
  memcpy(spare, loop + cut[0], inner * sizeof *loop);
  memcpy(spare + inner, loop + cut[1], (count - cut[1]) * sizeof *loop);
  memcpy(spare + inner + (count - cut[1]), loop, (cut[0] + 1) * sizeof *loop);
  memmove(loop, spare, (count + 2) * sizeof *loop);
  c->lengths[c->depth - 1] = inner;
  c->lengths[c->depth++] = outer;
}

static vxm_status cut_and_fill(cutting *c, bool *filled, vxm_error *error) {
  size_t top = 0;
  *filled = true;
  while (c->depth > 0 && *filled) {
    size_t count = c->lengths[c->depth - 1], cut[2] = {0, 0};
    if (count > PART && find_cut(c, c->loops + top, count, cut)) {
      split(c, c->loops + top, count, cut);
      top += c->lengths[c->depth - 2];
      continue;
    }
    if (count > VXM_RIM_WHOLE)
      *filled = false;
    vxm_status status = VXM_OK;
    if (*filled)
      status = vxm_hole_subdivide(c->triangles + c->done, filled, c->rim, c->loops + top, count, error);
    if (status != VXM_OK)
      return status;
    c->done += count - 2;
    if (--c->depth > 0)
      top -= c->lengths[c->depth - 1];
  }
  return VXM_OK;
}

/** Parts that wait at most: a cut leaves at least an eighth on either side, so that each is at most seven
 * eighths of what it was cut from. */
enum { DEPTH_MAX = 256 };

static vxm_status fill_by_cuts(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_context *context = rim->context;
  cutting c = {.rim = rim, .triangles = triangles, .depth = 1};
  size_t room = rim->count + 2 * DEPTH_MAX;
  c.loops = vxm_alloc(context, 2 * room, sizeof *c.loops, &local);
  c.lengths = c.loops ? vxm_alloc(context, DEPTH_MAX, sizeof *c.lengths, &local) : NULL;
  c.along = c.lengths ? vxm_alloc(context, room, sizeof *c.along, &local) : NULL;
  vxm_status status = local.code;
  if (c.along) {
    for (size_t i = 0; i < rim->count; i++)
      c.loops[i] = (uint32_t)i;
    c.lengths[0] = rim->count;
    status = cut_and_fill(&c, filled, &local);
  }
  vxm_free(context, c.along);
  vxm_free(context, c.lengths);
  vxm_free(context, c.loops);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- Judging ---- */

static vxm_vec3 triangle_area(const vxm_rim *rim, const uint32_t *t) {
  vxm_vec3 cross = vxm_vec3_cross(between(rim, t[1], t[0]), between(rim, t[2], t[0]));
  return (vxm_vec3){0.5 * cross.x, 0.5 * cross.y, 0.5 * cross.z};
}

static vxm_vec3 sum_of_areas(const vxm_rim *rim) {
  vxm_vec3 sum = {0, 0, 0};
  for (uint32_t i = 1; i + 1 < rim->count; i++) {
    vxm_vec3 area = triangle_area(rim, (const uint32_t[3]){0, i, i + 1});
    sum = vxm_vec3_sum(sum, area);
  }
  return sum;
}

/** Whether all triangles face the way their sum does: then those over a plane hole cover it once. */
static bool none_turned(const vxm_rim *rim, const uint32_t (*triangles)[3]) {
  vxm_vec3 sum = sum_of_areas(rim);
  for (size_t t = 0; t + 2 < rim->count; t++)
    if (!(vxm_vec3_dot(triangle_area(rim, triangles[t]), sum) > 0))
      return false;
  return true;
}

/** Whether the rim lies in a plane, by the best one through its first point. */
static bool is_flat(const vxm_rim *rim, vxm_vec3 normal) {
  double size = vxm_vec3_length(normal), far = 0, off = 0;
  for (uint32_t i = 1; i < rim->count; i++) {
    vxm_vec3 d = between(rim, i, 0);
    far = fmax(far, vxm_vec3_length(d));
    off = fmax(off, fabs(vxm_vec3_dot(d, normal)) / size);
  }
  return off <= FLAT * far;
}

/* ---- Ears ---- */

enum { EARS_MAX = 20000 /**< edges of a rim, as the work grows with their square */ };

/** Shape (the area by the square of the longest side) that an ear has to have at first, and at last. */
static const double SHAPE_FIRST = 0.3, SHAPE_LAST = 1e-12;

typedef struct clipping {
  const vxm_rim *rim;
  double (*plane)[2]; /**< the rim seen against its vector area, turning left */
  uint32_t *before, *after;
  uint32_t (*triangles)[3];
  size_t done;
} clipping;

/** Twice the area of the triangle, positive if it turns left. */
static double turn(const clipping *c, uint32_t i, uint32_t j, uint32_t k) {
  const double *p = c->plane[i], *q = c->plane[j], *r = c->plane[k];
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

static void project(clipping *c) {
  vxm_vec3 sum = sum_of_areas(c->rim);
  double size = vxm_vec3_length(sum);
  vxm_vec3 n = {sum.x / size, sum.y / size, sum.z / size};
  bool is_x = fabs(n.x) < 0.6;
  vxm_vec3 u = vxm_vec3_cross(n, (vxm_vec3){is_x, !is_x, 0});
  size = vxm_vec3_length(u);
  u = (vxm_vec3){u.x / size, u.y / size, u.z / size};
  vxm_vec3 v = vxm_vec3_cross(n, u);
  for (size_t i = 0; i < c->rim->count; i++) {
    const double *p = c->rim->points[i];
    c->plane[i][0] = u.x * p[0] + u.y * p[1] + u.z * p[2];
    c->plane[i][1] = v.x * p[0] + v.y * p[1] + v.z * p[2];
  }
}

static bool is_inside(const clipping *c, const uint32_t *t, uint32_t k) {
  return turn(c, t[0], t[1], k) >= 0 && turn(c, t[1], t[2], k) >= 0 && turn(c, t[2], t[0], k) >= 0;
}

static bool is_ear(const clipping *c, uint32_t i, double shape) {
  const uint32_t t[3] = {c->before[i], i, c->after[i]};
  double area = 0.5 * turn(c, t[0], t[1], t[2]), longest = 0;
  for (int s = 0; s < 3; s++) {
    double length = vxm_vec3_length(between(c->rim, t[s], t[(s + 1) % 3]));
    longest = length > longest ? length : longest;
  }
  bool is_last = c->after[t[2]] == t[0];
  if (!(area > c->rim->no_area) || !(area > shape * longest * longest) ||
      (!is_last && c->rim->is_edge(t[0], t[2], c->rim->payload)))
    return false;
  for (uint32_t k = c->after[t[2]]; k != t[0]; k = c->after[k])
    if (is_inside(c, t, k))
      return false;
  return true;
}

/** Clips well-shaped ears as long as there are any, then worse ones. */
static vxm_status clip(clipping *c, bool *filled, vxm_error *error) {
  uint32_t n = (uint32_t)c->rim->count, i = 0, since = 0;
  for (uint32_t k = 0; k < n; k++) {
    c->before[k] = k > 0 ? k - 1 : n - 1;
    c->after[k] = k + 1 < n ? k + 1 : 0;
  }
  for (double shape = SHAPE_FIRST; c->done + 2 < n && shape > SHAPE_LAST;) {
    if (since == 0) {
      vxm_status status = vxm_progress(c->rim->context, "filling holes", c->rim->fraction, error);
      if (status != VXM_OK)
        return status;
    }
    if (!is_ear(c, i, shape)) {
      i = c->after[i];
      if (++since + c->done >= n) {
        since = 0;
        shape *= 0.25;
      }
      continue;
    }
    uint32_t before = c->before[i], after = c->after[i];
    memcpy(c->triangles[c->done++], (const uint32_t[3]){before, i, after}, sizeof *c->triangles);
    c->after[before] = after;
    c->before[after] = before;
    since = 0;
    i = c->after[after]; /* one further, so that the ears do not all end at one vertex */
  }
  *filled = c->done + 2 == n;
  return VXM_OK;
}

/** Clips ears; what there is stays if that does not fill the rim. */
static vxm_status try_ears(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_context *context = rim->context;
  clipping c = {.rim = rim};
  bool clipped = false;
  c.plane = vxm_alloc(context, rim->count, sizeof *c.plane, &local);
  c.before = c.plane ? vxm_alloc(context, rim->count, sizeof *c.before, &local) : NULL;
  c.after = c.before ? vxm_alloc(context, rim->count, sizeof *c.after, &local) : NULL;
  c.triangles = c.after ? vxm_alloc(context, rim->count - 2, sizeof *c.triangles, &local) : NULL;
  vxm_status status = local.code;
  if (c.triangles) {
    project(&c);
    status = clip(&c, &clipped, &local);
    if (clipped) {
      memcpy(triangles, c.triangles, c.done * sizeof *triangles);
      *filled = true;
    }
  }
  vxm_free(context, c.triangles);
  vxm_free(context, c.after);
  vxm_free(context, c.before);
  vxm_free(context, c.plane);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- All of it ---- */

static vxm_status fill_whole(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim, vxm_error *error) {
  uint32_t loop[VXM_RIM_WHOLE];
  for (size_t i = 0; i < rim->count; i++)
    loop[i] = (uint32_t)i;
  return vxm_hole_subdivide(triangles, filled, rim, loop, rim->count, error);
}

static vxm_status fill_any(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim, vxm_error *error) {
  if (rim->count <= VXM_RIM_WHOLE)
    return fill_whole(triangles, filled, rim, error);
  vxm_status status = fill_by_cuts(triangles, filled, rim, error);
  if (status != VXM_OK || (*filled && none_turned(rim, (const uint32_t(*)[3])triangles)))
    return status;
  if (rim->count > EARS_MAX) {
    *filled = *filled && !is_flat(rim, sum_of_areas(rim));
    return VXM_OK;
  }
  return try_ears(triangles, filled, rim, error);
}

vxm_status vxm_hole_triangulate(uint32_t (*triangles)[3], bool *filled, const vxm_rim *rim,
                                vxm_error *error) {
  *filled = false;
  vxm_status status = fill_any(triangles, filled, rim, error);
  if (status != VXM_OK || *filled)
    return status;
  vxm_rim any = *rim;
  any.no_area = -1;
  return fill_any(triangles, filled, &any, error);
}
