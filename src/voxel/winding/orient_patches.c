/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/orient_patches.h"

#include <math.h>

/** Voxels from a triangle at which the grid is asked, and how far. */
static const double probe_steps[] = {0.5, 1.0, 1.5};
enum { PROBES = sizeof probe_steps / sizeof *probe_steps };
/** Where on a triangle: its middle and near its corners, as weights of the corners. */
static const double probe_weights[4][3] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.7, 0.15, 0.15}, {0.15, 0.7, 0.15}, {0.15, 0.15, 0.7}};
/** What a probe counts if the voters disagree at one of its ends. */
static const double doubtful = 0.3;
/** Evidence below this part of the patch's area says nothing. A little less than 0.05, which is what some
 * whole numbers of probes sum up to: rounding must not decide about them. */
static const double evidence_min = 0.05 - 1e-9;

/** A triangle in voxel units. */
typedef struct voxel_triangle {
  double corner[3][3];
} voxel_triangle;

/** One side of a triangle, linked to the next one at the same lower vertex. */
typedef struct side {
  uint32_t high, triangle, next;
  bool forward; /**< runs from the lower to the higher vertex */
} side;

typedef struct builder {
  vxm_facings *out;
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  bool leave_untold;
  uint32_t *triangle; /**< of every triangle */
  uint32_t (*neighbour)[3];
  uint8_t *against; /**< bit k: neighbour k runs along the common edge in the same direction */
  uint8_t *neighbour_count;
  uint8_t *turn; /**< of every triangle: makes it consistent within its patch */
  uint32_t *patch;
  vxm_error error;
} builder;

static const uint32_t none = UINT32_MAX;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->out->context, count, size, &b->error);
}

/* ---- Patches ---- */

static void link_triangles(builder *b, const side *p, const side *q) {
  uint8_t same = p->forward == q->forward;
  uint32_t s = p->triangle, t = q->triangle;
  b->against[s] |= (uint8_t)(same << b->neighbour_count[s]);
  b->neighbour[s][b->neighbour_count[s]++] = t;
  b->against[t] |= (uint8_t)(same << b->neighbour_count[t]);
  b->neighbour[t][b->neighbour_count[t]++] = s;
}

/** Links the two triangles at every edge that has exactly two; sides[3 t + k] is side k of triangle t. */
static void link_at_vertex(builder *b, const side *sides, uint32_t first) {
  for (uint32_t s = first; s != none; s = sides[s].next) {
    uint32_t other = none, count = 1;
    for (uint32_t r = first; r != none; r = sides[r].next)
      if (r != s && sides[r].high == sides[s].high) {
        other = r;
        count++;
      }
    if (count == 2 && s < other && sides[s].triangle != sides[other].triangle)
      link_triangles(b, &sides[s], &sides[other]);
  }
}

enum {
  VALENCE_MAX = 256 /**< beyond, a vertex joins no triangles: comparing its sides would be quadratic */
};

static bool find_neighbours(builder *b) {
  size_t n = b->out->count;
  uint32_t *first = allocate(b, b->triangles->first_apex, sizeof *first);
  uint32_t *valence = allocate(b, b->triangles->first_apex, sizeof *valence);
  side *sides = allocate(b, n, 3 * sizeof *sides);
  bool done = first && valence && sides;
  if (done) {
    for (size_t v = 0; v < b->triangles->first_apex; v++)
      first[v] = none;
    for (size_t t = 0; t < n; t++)
      for (size_t k = 0; k < 3; k++) {
        const uint32_t *corner = b->triangles->corners[b->triangle[t]];
        uint32_t p = corner[k], q = corner[(k + 1) % 3], low = p < q ? p : q;
        sides[3 * t + k] = (side){p < q ? q : p, (uint32_t)t, first[low], p < q};
        first[low] = (uint32_t)(3 * t + k);
        valence[low]++;
      }
    for (size_t v = 0; v < b->triangles->first_apex; v++)
      if (valence[v] <= VALENCE_MAX)
        link_at_vertex(b, sides, first[v]);
  }
  vxm_free(b->out->context, sides);
  vxm_free(b->out->context, valence);
  vxm_free(b->out->context, first);
  return done;
}

static bool find_patches(builder *b) {
  size_t n = b->out->count;
  uint32_t *queue = allocate(b, n, sizeof *queue);
  if (!queue)
    return false;
  for (size_t t = 0; t < n; t++)
    b->patch[t] = none;
  for (size_t t = 0; t < n; t++) {
    if (b->patch[t] != none)
      continue;
    size_t head = 0, tail = 0;
    queue[tail++] = (uint32_t)t;
    b->patch[t] = (uint32_t)b->out->patch_count;
    while (head < tail) {
      uint32_t at = queue[head++];
      for (int k = 0; k < b->neighbour_count[at]; k++) {
        uint32_t next = b->neighbour[at][k];
        if (b->patch[next] != none)
          continue;
        b->patch[next] = (uint32_t)b->out->patch_count;
        b->turn[next] = (uint8_t)(b->turn[at] ^ (b->against[at] >> k & 1));
        queue[tail++] = next;
      }
    }
    b->out->patch_count++;
  }
  vxm_free(b->out->context, queue);
  return true;
}

/* ---- Evidence ---- */

/** Twice the vector area of a triangle; returns its length. */
static double normal_of(const voxel_triangle *t, double n[3]) {
  double u[3], v[3], sum = 0;
  for (int a = 0; a < 3; a++) {
    u[a] = t->corner[1][a] - t->corner[0][a];
    v[a] = t->corner[2][a] - t->corner[0][a];
  }
  for (int a = 0; a < 3; a++) {
    n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    sum += n[a] * n[a];
  }
  return sqrt(sum);
}

/** 1 inside, 0 outside by majority; `sure` is cleared if the voters disagree. */
static int ask(const builder *b, const uint64_t *const voters[3], const double p[3], bool *sure) {
  const int64_t *dims = b->placed->lattice.space.dims;
  for (int a = 0; a < 3; a++)
    if (!(p[a] >= 0 && p[a] < (double)dims[a]))
      return 0;
  size_t row_words = ((size_t)dims[0] + 63) / 64, x = (size_t)p[0];
  size_t word = ((size_t)p[2] * (size_t)dims[1] + (size_t)p[1]) * row_words + x / 64;
  int votes = 0;
  for (int v = 0; v < 3; v++)
    votes += (int)(voters[v][word] >> (x % 64) & 1);
  *sure &= votes == 0 || votes == 3;
  return votes >= 2;
}

/** Between -1 and 1: how much more is set behind the triangle than before it. */
static double evidence_of(const builder *b, const voxel_triangle *t, const double n[3], double length,
                          const uint64_t *const voters[3]) {
  double sum = 0;
  for (int w = 0; w < 4; w++)
    for (size_t s = 0; s < PROBES; s++) {
      double behind[3], before[3];
      for (int a = 0; a < 3; a++) {
        double at = 0, step = probe_steps[s] * n[a] / length;
        for (int k = 0; k < 3; k++)
          at += probe_weights[w][k] * t->corner[k][a];
        behind[a] = at - step;
        before[a] = at + step;
      }
      bool sure = true;
      int difference = ask(b, voters, behind, &sure) - ask(b, voters, before, &sure);
      sum += (sure ? 1 : doubtful) * difference;
    }
  return sum / (4 * PROBES);
}

/** The triangle in voxels, turned as its patch is consistent. */
static voxel_triangle triangle_of(const builder *b, size_t t) {
  voxel_triangle out;
  const uint32_t *corner = b->triangles->corners[b->triangle[t]];
  for (int k = 0; k < 3; k++) {
    vxm_point p = vxm_snapped_points_at(b->placed, corner[b->turn[t] ? (3 - k) % 3 : k]);
    for (int a = 0; a < 3; a++)
      out.corner[k][a] = (double)p.at[a] / (double)b->placed->lattice.unit;
  }
  return out;
}

/** What speaks for the way a patch faces, each in units of area. */
typedef struct opinion {
  double area, evidence, came; /**< `came`: how it came, before triangles were made consistent */
  bool lone;                   /**< it is a lone sheet, whatever the grid tells */
} opinion;

/** Twice the area, in square voxels, of a patch about which the grid can tell anything: probes reach past all
 * of a smaller one. */
static const double told_area = 2 * 4;

static bool is_told(const opinion *o) {
  return !o->lone && o->area > 0 && fabs(o->evidence) >= evidence_min * o->area;
}

static bool turn_patches(builder *b, const uint64_t *const voters[3]) {
  vxm_facings *out = b->out;
  opinion *opinions = allocate(b, out->patch_count, sizeof *opinions);
  if (!opinions)
    return false;
  for (size_t t = 0; t < out->count; t++) {
    voxel_triangle triangle = triangle_of(b, t);
    double n[3], length = normal_of(&triangle, n);
    if (!(length > 0))
      continue;
    opinion *o = &opinions[b->patch[t]];
    o->area += length;
    o->lone = b->leave_untold && b->triangles->lone && b->triangles->lone[b->triangle[t]];
    o->came += b->turn[t] ? -length : length;
    o->evidence += length * evidence_of(b, &triangle, n, length, voters);
  }
  /* the others face as they came, or the other way if most of those that are told came inside out */
  double outward = 0;
  for (size_t p = 0; p < out->patch_count; p++)
    if (is_told(&opinions[p]))
      outward += opinions[p].came * opinions[p].evidence < 0 ? -opinions[p].area : opinions[p].area;
  for (size_t t = 0; t < out->count; t++) {
    const opinion *o = &opinions[b->patch[t]];
    double facing = is_told(o) ? o->evidence : outward < 0 ? -o->came : o->came;
    bool inward = b->turn[t] ^ (facing < 0);
    bool untold = !is_told(o) && b->leave_untold && (o->area >= told_area || o->lone);
    out->facing[t] = untold ? VXM_FACING_UNTOLD : inward ? VXM_FACING_IN : VXM_FACING_OUT;
  }
  vxm_free(out->context, opinions);
  return true;
}

/* ---- All of it ---- */

static bool collect_triangles(builder *b) {
  vxm_facings *out = b->out;
  const vxm_triangle_set *triangles = b->triangles;
  for (size_t p = out->part_begin; p < out->part_end; p++)
    out->count += triangles->parts[p].caps - triangles->parts[p].begin;
  out->facing = allocate(b, out->count, sizeof *out->facing);
  b->triangle = allocate(b, out->count, sizeof *b->triangle);
  b->neighbour = allocate(b, out->count, sizeof *b->neighbour);
  b->against = allocate(b, out->count, sizeof *b->against);
  b->neighbour_count = allocate(b, out->count, sizeof *b->neighbour_count);
  b->turn = allocate(b, out->count, sizeof *b->turn);
  b->patch = allocate(b, out->count, sizeof *b->patch);
  if (!out->facing || !b->triangle || !b->neighbour || !b->against || !b->neighbour_count || !b->turn ||
      !b->patch)
    return false;
  size_t next = 0;
  for (size_t p = out->part_begin; p < out->part_end; p++)
    for (size_t f = triangles->parts[p].begin; f < triangles->parts[p].caps; f++)
      b->triangle[next++] = (uint32_t)f;
  return true;
}

vxm_status vxm_orient_patches_find(vxm_facings *out, const vxm_triangle_set *triangles,
                                   const vxm_snapped_points *placed, size_t part_begin, size_t part_end,
                                   const uint64_t *const voters[3], bool leave_untold, vxm_error *error) {
  vxm_context *context = triangles->context;
  *out = (vxm_facings){.context = context, .part_begin = part_begin, .part_end = part_end};
  builder b = {.out = out,
               .triangles = triangles,
               .placed = placed,
               .leave_untold = leave_untold,
               .error = VXM_ERROR_INIT};
  if (triangles->triangle_count > UINT32_MAX / 3)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu triangles are too many to turn outward; split the mesh",
                    triangles->triangle_count);
  bool done = collect_triangles(&b) && find_neighbours(&b) && find_patches(&b) && turn_patches(&b, voters);
  vxm_free(context, b.patch);
  vxm_free(context, b.turn);
  vxm_free(context, b.neighbour_count);
  vxm_free(context, b.against);
  vxm_free(context, b.neighbour);
  vxm_free(context, b.triangle);
  if (done)
    return VXM_OK;
  vxm_facings_destroy(out);
  vxm_error_pass(error, &b.error);
  return b.error.code;
}

void vxm_facings_destroy(vxm_facings *facings) {
  vxm_free(facings->context, facings->facing);
  *facings = (vxm_facings){.context = facings->context};
}
