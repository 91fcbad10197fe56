/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/surface_tree.h"
#include "base/box.h"
#include "base/neon.h"
#include "mesh/spatial_sort.h"
#include "voxel/closest/closest_point.h"

#include <math.h>
#include <string.h>
#ifdef __SSE__
#include <immintrin.h>
#endif

enum { LEAF = VXM_SPATIAL_SORT_LEAF, DEPTH_MAX = 40, LANES = 4 };

typedef struct box {
  double low[3], high[3];
} box;

/** A disc in the plane of a triangle that covers it. */
typedef struct disc {
  double middle[3], normal[3], radius;
} disc;

/** Triangles in spatial order; a leaf is a run of LEAF of them. Node n has the children 2 n and 2 n + 1, and
 * the leaves are the nodes from leaf_count on, which is a power of 2. */
struct vxm_surface_tree {
  vxm_context *context;
  size_t count, leaf_count;
  vxm_closest_triangle *triangles;
  disc *discs;
  uint32_t *numbers; /**< of the triangles, as their owner has them */
  box *boxes;
};

/** A box may be nearer than it is computed by as much. */
static const double box_slack = 1 - 1e-12;

static size_t leaves_for(size_t count) {
  size_t leaves = 1;
  while (leaves * LEAF < count)
    leaves *= 2;
  return leaves;
}

uint64_t vxm_surface_tree_bytes(size_t count) {
  return (uint64_t)count *
             (sizeof(vxm_closest_triangle) + sizeof(disc) + sizeof(uint32_t) + sizeof(vxm_spatial_point)) +
         2 * (uint64_t)leaves_for(count) * sizeof(box) + 4096;
}

/* ---- Making it ---- */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** How far the farthest corner is from a point. */
static double radius_at(const vxm_closest_triangle *triangle, const double p[3]) {
  double most = 0;
  for (int c = 0; c < 3; c++) {
    const double *q = triangle->at[c], off[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    most = fmax(most, dot(off, off));
  }
  return sqrt(most);
}

/** Around the centroid, or the middle of an edge: whichever gives the smallest. */
static disc disc_of(const vxm_closest_triangle *t) {
  disc d = {.radius = INFINITY};
  double edge[2][3];
  for (int c = 0; c < 4; c++) {
    double p[3];
    for (int a = 0; a < 3; a++)
      p[a] =
          c < 3 ? t->at[c][a] / 2 + t->at[(c + 1) % 3][a] / 2 : (t->at[0][a] + t->at[1][a] + t->at[2][a]) / 3;
    const double radius = radius_at(t, p);
    if (!(radius < d.radius))
      continue;
    d.radius = radius;
    memcpy(d.middle, p, sizeof p);
  }
  for (int e = 0; e < 2; e++)
    for (int a = 0; a < 3; a++)
      edge[e][a] = t->at[e + 1][a] - t->at[0][a];
  const double cross[3] = {edge[0][1] * edge[1][2] - edge[0][2] * edge[1][1],
                           edge[0][2] * edge[1][0] - edge[0][0] * edge[1][2],
                           edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]},
               length = sqrt(dot(cross, cross));
  /* The normal of a needle has no digits left. */
  bool is_sound = !t->is_thin && length > 1e-6 * sqrt(dot(edge[0], edge[0])) * sqrt(dot(edge[1], edge[1]));
  for (int a = 0; a < 3 && is_sound; a++)
    d.normal[a] = cross[a] / length;
  return d;
}

static void make_leaf(vxm_surface_tree *tree, size_t leaf) {
  box *b = &tree->boxes[tree->leaf_count + leaf];
  vxm_box_empty(b->low, b->high);
  for (size_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < tree->count; i++)
    for (int c = 0; c < 3; c++)
      vxm_box_include(b->low, b->high, tree->triangles[i].at[c]);
}

static void make_boxes(vxm_surface_tree *tree) {
  for (size_t leaf = 0; leaf < tree->leaf_count; leaf++)
    make_leaf(tree, leaf);
  for (size_t n = tree->leaf_count - 1; n > 0; n--) {
    const box *child = &tree->boxes[2 * n + 1];
    tree->boxes[n] = tree->boxes[2 * n];
    vxm_box_join(tree->boxes[n].low, tree->boxes[n].high, child->low, child->high);
  }
}

static vxm_status fill(vxm_surface_tree *tree, vxm_spatial_point *spots, vxm_surface_corners_fn corners,
                       const void *payload, vxm_error *error) {
  double at[3][3];
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < tree->count && status == VXM_OK; i++) {
    corners(at, i, payload);
    spots[i].index = (uint32_t)i;
    for (int a = 0; a < 3; a++)
      spots[i].at[a] = (float)(at[0][a] + at[1][a] + at[2][a]);
    status = vxm_check_cancelled_at(i, tree->context, error);
  }
  if (status == VXM_OK)
    status = vxm_spatial_sort(spots, tree->count, tree->context, error);
  for (size_t i = 0; i < tree->count && status == VXM_OK; i++) {
    corners(at, spots[i].index, payload);
    vxm_closest_triangle_make(&tree->triangles[i], (const double(*)[3])at);
    tree->discs[i] = disc_of(&tree->triangles[i]);
    tree->numbers[i] = spots[i].index;
    status = vxm_check_cancelled_at(i, tree->context, error);
  }
  if (status == VXM_OK)
    make_boxes(tree);
  return status;
}

vxm_status vxm_surface_tree_create(vxm_surface_tree **out, vxm_context *context, size_t count,
                                   vxm_surface_corners_fn corners, const void *payload, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_spatial_point *spots = NULL;
  vxm_surface_tree *tree = vxm_calloc(context, 1, sizeof *tree, &local);
  *out = NULL;
  if (tree) {
    tree->context = context;
    tree->count = count;
    tree->leaf_count = leaves_for(count);
    tree->triangles = vxm_alloc(context, count, sizeof *tree->triangles, &local);
    tree->discs = vxm_alloc(context, count, sizeof *tree->discs, &local);
    tree->numbers = vxm_alloc(context, count, sizeof *tree->numbers, &local);
    tree->boxes = vxm_alloc(context, 2 * tree->leaf_count, sizeof *tree->boxes, &local);
    spots = vxm_alloc(context, count, sizeof *spots, &local);
  }
  if (local.code == VXM_OK)
    fill(tree, spots, corners, payload, &local);
  vxm_free(context, spots);
  if (local.code == VXM_OK)
    *out = tree;
  else {
    vxm_surface_tree_destroy(tree);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_surface_tree_destroy(vxm_surface_tree *tree) {
  if (!tree)
    return;
  vxm_free(tree->context, tree->boxes);
  vxm_free(tree->context, tree->numbers);
  vxm_free(tree->context, tree->discs);
  vxm_free(tree->context, tree->triangles);
  vxm_free(tree->context, tree);
}

/* ---- Searching ---- */

typedef struct search {
  const vxm_surface_tree *tree;
  const double *p;
  double square, reach; /**< of the hit; and what may be as near by the digits that count */
  double digits;
  vxm_surface_hit hit;
} search;

/** One that has found nothing yet. */
static search begin_search(const vxm_surface_tree *tree, const double p[3]) {
  return (search){.tree = tree,
                  .p = p,
                  .square = INFINITY,
                  .reach = INFINITY,
                  .digits = INFINITY,
                  .hit = {.triangle = UINT32_MAX}};
}

/** More than what the digits that count leave of a squared distance. */
static const double digits_slack = 1 + 1e-6;

/** The digits that count, rounded, so that walls upon each other are equally near whatever their corners are
 * rounded to. */
static double digits_of(double square) {
  const uint64_t low = UINT64_C(1) << 29;
  uint64_t bits;
  memcpy(&bits, &square, sizeof bits);
  bits = (bits + low / 2) & ~(low - 1);
  memcpy(&square, &bits, sizeof square);
  return square;
}

/** Of the sine of an angle: what tells two ways of facing apart. */
static const double facing_steps = 0x1p20;

/** How squarely a triangle faces a point or is turned away from it, and of equals those more that are turned
 * away. */
static int64_t facing_of(const disc *d, const double p[3], const double foot[3], double square) {
  const double off[3] = {p[0] - foot[0], p[1] - foot[1], p[2] - foot[2]}, height = dot(d->normal, off);
  if (!(square > 0) || isinf(square))
    return 0;
  return 2 * (int64_t)fmin(rint(fabs(height) / sqrt(square) * facing_steps), facing_steps) + (height < 0);
}

static double to_box(const box *b, const double p[3]) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    double below = b->low[a] - p[a], above = p[a] - b->high[a];
    double off = below > above ? below : above;
    off = off > 0 ? off : 0;
    square += off * off;
  }
  return square * box_slack;
}

static int64_t facing_at(const search *s, uint32_t place, const double foot[3], double square) {
  return facing_of(&s->tree->discs[place], s->p, foot, square);
}

/** Whether a triangle that is as near by the digits that count goes before the one that was found so far. */
static bool goes_first(const search *s, double square, uint32_t place, const double foot[3]) {
  uint32_t number = s->tree->numbers[place];
  int64_t facing = facing_at(s, place, foot, square);
  int64_t other = facing_at(s, s->hit.place, s->hit.foot, s->square);
  if (facing != other)
    return facing > other;
  return square != s->square ? square < s->square : number < s->hit.triangle;
}

static void look_at(search *s, uint32_t place) {
  double foot[3], square = vxm_closest_point(&s->tree->triangles[place], s->p, foot);
  if (square > s->reach)
    return;
  double digits = digits_of(square);
  if (digits > s->digits ||
      (digits == s->digits && s->hit.triangle != UINT32_MAX && !goes_first(s, square, place, foot)))
    return;
  s->square = square;
  s->reach = square * digits_slack;
  s->digits = digits;
  s->hit = (vxm_surface_hit){.triangle = s->tree->numbers[place], .place = place};
  memcpy(s->hit.foot, foot, sizeof foot);
}

static void look_at_leaf(search *s, size_t leaf) {
  for (size_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < s->tree->count; i++)
    look_at(s, (uint32_t)i);
}

vxm_surface_hit vxm_surface_tree_nearest(const vxm_surface_tree *tree, const double p[3], uint32_t near) {
  struct {
    size_t node;
    double square;
  } stack[DEPTH_MAX];
  search s = begin_search(tree, p);
  int depth = 0;
  look_at(&s, near < tree->count ? near : 0);
  stack[depth].node = 1;
  stack[depth++].square = to_box(&tree->boxes[1], p);
  while (depth > 0) {
    size_t node = stack[--depth].node;
    if (stack[depth].square > s.reach)
      continue;
    if (node >= tree->leaf_count) {
      look_at_leaf(&s, node - tree->leaf_count);
      continue;
    }
    double left = to_box(&tree->boxes[2 * node], p), right = to_box(&tree->boxes[2 * node + 1], p);
    bool is_left_first = left <= right;
    /* The farther one waits below the nearer one. */
    stack[depth].node = 2 * node + is_left_first;
    stack[depth++].square = is_left_first ? right : left;
    stack[depth].node = 2 * node + !is_left_first;
    stack[depth++].square = is_left_first ? left : right;
  }
  return s.hit;
}

/* ---- Points that lie close together ---- */

typedef float lanes __attribute__((vector_size(LANES * sizeof(float))));
typedef int32_t lane_mask __attribute__((vector_size(LANES * sizeof(float))));

/** What lies farther from the centre, in its scale, or is larger is looked at always. */
static const double disc_far = 4;
/** More than what floats within that lose in a squared distance, some 2e-5. */
static const float square_slack = 1e-4F;
/** Coordinates of which the last digits matter leave no room for that. */
static const double centre_far = 1e5;

/** The squared distance of a point, from the middle, to a disc. */
static double to_disc(const disc *d, const double off[3]) {
  const double height = dot(d->normal, off),
               flat = sqrt(fmax(dot(off, off) - height * height, 0)) - d->radius;
  return height * height + (flat > 0 ? flat * flat : 0);
}

/** Adds a triangle whose disc comes within the reach; false if there is no room. */
static bool add_candidate(vxm_surface_candidates *out, uint32_t place, double reach) {
  const disc *d = &out->tree->discs[place];
  const double off[3] = {out->centre[0] - d->middle[0], out->centre[1] - d->middle[1],
                         out->centre[2] - d->middle[2]};
  bool is_near = dot(off, off) <= disc_far * disc_far * reach * reach && d->radius <= disc_far * reach;
  if (is_near && to_disc(d, off) > reach * reach * (1 + 1e-9))
    return true;
  if (out->count == VXM_CANDIDATES_MAX)
    return false;
  for (int a = 0; a < 3; a++) {
    out->at[a][out->count] = is_near ? (float)(-off[a] * out->scale) : 0;
    out->normal[a][out->count] = is_near ? (float)d->normal[a] : 0;
  }
  out->radius[out->count] = is_near ? (float)(d->radius * out->scale) : 1e9F;
  out->places[out->count++] = place;
  return true;
}

/** Adds the triangles of a leaf. */
static bool add_leaf(vxm_surface_candidates *out, size_t leaf, double reach) {
  for (size_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < out->tree->count; i++)
    if (!add_candidate(out, (uint32_t)i, reach))
      return false;
  return true;
}

/** Lanes behind the last candidate are those of no triangle: far away, and of no size. */
static void fill_lanes(vxm_surface_candidates *out) {
  for (size_t i = out->count; i % LANES != 0; i++) {
    for (int a = 0; a < 3; a++) {
      out->at[a][i] = 1e9F;
      out->normal[a][i] = 0;
    }
    out->radius[i] = 0;
  }
}

/** Begins a ball of which the nearest to its centre is known, and tells how far it reaches; 0 if floats
 * cannot. */
static double begin_ball(vxm_surface_candidates *out, const vxm_surface_tree *tree, const double centre[3],
                         double radius, const vxm_surface_hit *hit) {
  const double off[3] = {hit->foot[0] - centre[0], hit->foot[1] - centre[1], hit->foot[2] - centre[2]};
  /* To a point of the ball the nearest is at most `radius` farther than to the centre, from where it is seen
   * as much farther again. */
  const double reach = (sqrt(dot(off, off)) + 2 * radius) * digits_slack;
  const double farthest = fmax(fabs(centre[0]), fmax(fabs(centre[1]), fabs(centre[2])));
  out->tree = tree;
  out->scale = 1 / reach;
  out->count = 0;
  memcpy(out->centre, centre, sizeof out->centre);
  return reach > 1e-100 && reach < 1e100 && farthest < centre_far * reach ? reach : 0;
}

bool vxm_surface_candidates_gather(vxm_surface_candidates *out, const vxm_surface_tree *tree,
                                   const double centre[3], double radius, uint32_t *near) {
  size_t stack[DEPTH_MAX];
  int depth = 0;
  const vxm_surface_hit hit = vxm_surface_tree_nearest(tree, centre, *near);
  const double reach = begin_ball(out, tree, centre, radius, &hit);
  *near = hit.place;
  if (reach == 0)
    return false;
  for (stack[depth++] = 1; depth > 0;) {
    const size_t node = stack[--depth];
    if (to_box(&tree->boxes[node], centre) > reach * reach)
      continue;
    if (node < tree->leaf_count) {
      stack[depth++] = 2 * node;
      stack[depth++] = 2 * node + 1;
    } else if (!add_leaf(out, node - tree->leaf_count, reach))
      return false;
  }
  fill_lanes(out);
  return true;
}

/** How far a search may still look, squared, in the scale of the candidates. */
static lanes reach_of(const search *s, double scale) {
  return (float)(s->reach * scale * scale) + square_slack + (lanes){0};
}

static lanes root(lanes x) {
#ifdef __SSE__
  return (lanes)_mm_sqrt_ps((__m128)x);
#elif VXM_NEON
  return (lanes)vsqrtq_f32((float32x4_t)x);
#else
  for (int lane = 0; lane < LANES; lane++)
    x[lane] = sqrtf(x[lane]);
  return x;
#endif
}

static lanes load(const float *from) {
  lanes four;
  memcpy(&four, from, sizeof four);
  return four;
}

/** A point as the candidates have it. */
static void place_point(lanes out[3], const vxm_surface_candidates *c, const double p[3]) {
  for (int a = 0; a < 3; a++)
    out[a] = (float)((p[a] - c->centre[a]) * c->scale) + (lanes){0};
}

/** Whether the discs of four candidates are, squared, no farther than `most` from a point; false if none is.
 */
static bool find_near(lane_mask *out, const vxm_surface_candidates *c, size_t group, const lanes at[3],
                      lanes most) {
  const lanes none = {0};
  const lanes x = at[0] - load(&c->at[0][group]), y = at[1] - load(&c->at[1][group]),
              z = at[2] - load(&c->at[2][group]),
              height = x * load(&c->normal[0][group]) + y * load(&c->normal[1][group]) +
                       z * load(&c->normal[2][group]),
              above = height * height, level = x * x + y * y + z * z - above,
              flat = root((lanes)((lane_mask)level & (level > none))) - load(&c->radius[group]),
              beside = (lanes)((lane_mask)flat & (flat > none));
  uint64_t halves[2];
  *out = above + beside * beside <= most;
  memcpy(halves, out, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

vxm_surface_hit vxm_surface_candidates_nearest(const vxm_surface_candidates *c, const double p[3],
                                               uint32_t near) {
  search s = begin_search(c->tree, p);
  lanes at[3];
  lane_mask is_near;
  place_point(at, c, p);
  look_at(&s, near);
  lanes most = reach_of(&s, c->scale);
  for (size_t g = 0; g < c->count; g += LANES) {
    if (!find_near(&is_near, c, g, at, most))
      continue;
    for (size_t lane = 0; lane < LANES; lane++)
      if (is_near[lane] && c->places[g + lane] != near)
        look_at(&s, c->places[g + lane]);
    most = reach_of(&s, c->scale);
  }
  return s.hit;
}

bool vxm_surface_candidates_narrow(vxm_surface_candidates *out, const vxm_surface_candidates *from,
                                   const double centre[3], double radius, uint32_t *near) {
  const vxm_surface_hit hit = vxm_surface_candidates_nearest(from, centre, *near);
  const double reach = begin_ball(out, from->tree, centre, radius, &hit);
  lanes at[3];
  lane_mask is_near;
  *near = hit.place;
  if (reach == 0)
    return false;
  place_point(at, from, centre);
  const float far = (float)(reach * from->scale);
  const lanes most = far * far + square_slack + (lanes){0};
  for (size_t g = 0; g < from->count; g += LANES)
    if (find_near(&is_near, from, g, at, most))
      for (size_t lane = 0; lane < LANES; lane++)
        if (is_near[lane])
          add_candidate(out, from->places[g + lane], reach);
  fill_lanes(out);
  return true;
}
