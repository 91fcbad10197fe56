/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_tree.h"
#include "base/threads.h"
#include "base/unroll.h"
#include "mesh/sort.h"

#include <math.h>
#include <string.h>

/* Before the short loops over axes, which compilers leave as they are at -O2. */
#define UNROLL VXM_UNROLL(16)

enum { MORTON_BITS = 10 /**< per axis; with the triangle's number below, a sort key fits 64 bits */ };

static const double by_sphere = 0.079577471545947673; /* 1 / 4 pi */

/** Sums about `centre`: of vector areas A, and what harmonic expansions see of their products with one and
 * two offsets x: the mean of A_i x_j + A_j x_i, xx yy zz xy xz yz, and of A_i x_j x_k + A_j x_i x_k + A_k x_i
 * x_j, in the order of `triple`. */
typedef struct sums {
  double centre[3], area[3], first[6], second[10];
  double size, radius, low[3], high[3];
} sums;

static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
/** Where a pair is. */
static const int pair_at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
static const struct triple {
  int i, j, k, times; /**< that it occurs in a sum over all i, j and k */
} triple[10] = {{0, 0, 0, 1}, {0, 0, 1, 3}, {0, 1, 1, 3}, {1, 1, 1, 1}, {0, 0, 2, 3},
                {0, 1, 2, 6}, {1, 1, 2, 3}, {0, 2, 2, 3}, {1, 2, 2, 3}, {2, 2, 2, 1}};

/** The node of the keys begin..end-1; those below it follow each other from `below` on: its children, all
 * below the first, all below the second. */
typedef struct branch {
  size_t begin, end, node, below;
} branch;

/** A branch that one thread builds. */
typedef struct branch_task {
  branch at;
  sums made;
} branch_task;

typedef struct builder {
  vxm_winding_tree *out;
  const uint32_t (*corners)[3];
  bool mirrored;  /**< corners b and c of each triangle change places */
  uint64_t *keys; /**< Morton number << 32 | triangle, of one class after the other */
  double step;    /**< voxels of a lattice step */
  branch_task *tasks;
  size_t task_count, task_capacity, task_next;
  vxm_error error;
} builder;

static void points_of(const builder *b, size_t triangle, uint32_t out[3]) {
  const uint32_t *corner = b->corners[triangle];
  out[0] = corner[0];
  out[1 + b->mirrored] = corner[1];
  out[2 - b->mirrored] = corner[2];
}

/** The corners of a triangle on the lattice. */
static void corners_of(const builder *b, size_t triangle, vxm_point out[3]) {
  uint32_t point[3];
  points_of(b, triangle, point);
  for (int k = 0; k < 3; k++)
    out[k] = vxm_snapped_points_at(b->out->placed, point[k]);
}

/* ---- Moments ---- */

static double length_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/** Adds to the sums over triples the products of pairs and one more factor, each with each. */
static inline __attribute__((always_inline)) void add_products(double out[10], const double pairs[6],
                                                               const double by[3]) {
  UNROLL
  for (int t = 0; t < 10; t++) {
    int i = triple[t].i, j = triple[t].j, k = triple[t].k;
    out[t] += pairs[pair_at[i][j]] * by[k] + pairs[pair_at[i][k]] * by[j] + pairs[pair_at[j][k]] * by[i];
  }
}

/** Moves sums to another centre and adds them to `to`. */
static void add_moved(sums *to, const sums *from) {
  double s[3], between[6];
  for (int a = 0; a < 3; a++) {
    s[a] = from->centre[a] - to->centre[a];
    to->area[a] += from->area[a];
  }
  UNROLL
  for (int p = 0; p < 6; p++) {
    int i = pair[p][0], j = pair[p][1];
    double moved = from->area[i] * s[j] + from->area[j] * s[i];
    between[p] = from->first[p] + 0.5 * moved;
    to->first[p] += from->first[p] + moved;
  }
  UNROLL
  for (int t = 0; t < 10; t++)
    to->second[t] += from->second[t];
  add_products(to->second, between, s);
}

static sums sums_of_triangle(const double p[3][3]) {
  sums out = {.radius = 0};
  for (int a = 0; a < 3; a++) {
    out.centre[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
    out.low[a] = fmin(fmin(p[0][a], p[1][a]), p[2][a]);
    out.high[a] = fmax(fmax(p[0][a], p[1][a]), p[2][a]);
  }
  for (int a = 0; a < 3; a++) {
    int u = (a + 1) % 3, v = (a + 2) % 3;
    out.area[a] = ((p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u])) / 2;
  }
  out.size = length_of(out.area);
  double offsets[6] = {0}; /* the mean of x_j x_k over a triangle is a twelfth of its corners' sum */
  for (int c = 0; c < 3; c++) {
    double from[3] = {p[c][0] - out.centre[0], p[c][1] - out.centre[1], p[c][2] - out.centre[2]};
    out.radius = fmax(out.radius, length_of(from));
    UNROLL
    for (int i = 0; i < 6; i++)
      offsets[i] += from[pair[i][0]] * from[pair[i][1]] * (1.0 / 12);
  }
  add_products(out.second, offsets, out.area);
  return out;
}

static sums join(const sums *left, const sums *right) {
  sums out = {.size = left->size + right->size};
  double weight = out.size > 0 ? left->size / out.size : 0.5, corner[3], to_left[3], to_right[3];
  for (int a = 0; a < 3; a++) {
    out.centre[a] = left->centre[a] * weight + right->centre[a] * (1 - weight);
    out.low[a] = fmin(left->low[a], right->low[a]);
    out.high[a] = fmax(left->high[a], right->high[a]);
    corner[a] = fmax(out.high[a] - out.centre[a], out.centre[a] - out.low[a]);
    to_left[a] = left->centre[a] - out.centre[a];
    to_right[a] = right->centre[a] - out.centre[a];
  }
  out.radius =
      fmin(length_of(corner), fmax(length_of(to_left) + left->radius, length_of(to_right) + right->radius));
  add_moved(&out, left);
  add_moved(&out, right);
  return out;
}

static void store(vxm_winding_tree *out, size_t node, const sums *of) {
  vxm_winding_node *n = &out->nodes[node];
  vxm_winding_moments *m = &out->moments[node];
  int exponent;
  frexp(fmax(of->radius, 1), &exponent);
  double scale = ldexp(1, -exponent), square = by_sphere * scale * scale, cube = square * scale;
  m->scale = (float)scale;
  n->radius = (float)of->radius;
  n->area = (float)(by_sphere * of->size);
  for (int a = 0; a < 3; a++) {
    n->centre[a] = of->centre[a];
    m->area[a] = (float)(square * of->area[a]);
  }
  double third = (of->first[0] + of->first[1] + of->first[2]) / 3;
  for (int i = 0; i < 3; i++) {
    m->first[i] = (float)(-1.5 * cube * (of->first[i] - third));
    m->first[3 + i] = (float)(-3 * cube * of->first[3 + i]);
  }
  const double *s = of->second, trace[3] = {s[0] + s[2] + s[7], s[1] + s[3] + s[8], s[4] + s[6] + s[9]};
  UNROLL
  for (int t = 0; t < 10; t++) {
    int i = triple[t].i, j = triple[t].j, k = triple[t].k;
    double traces = ((i == j) * trace[k] + (i == k) * trace[j] + (j == k) * trace[i]) * 0.2;
    m->second[t] = (float)(2.5 * cube * scale * triple[t].times * (s[t] - traces));
  }
}

/* ---- Trees ---- */

/** Where the keys begin..end-1 part: by the highest bit of their Morton numbers that differs, or in halves.
 */
static size_t split(const uint64_t *keys, size_t begin, size_t end) {
  uint64_t differ = (keys[begin] ^ keys[end - 1]) >> 32;
  if (differ == 0)
    return begin + (end - begin) / 2;
  int bit = 63 - __builtin_clzll(differ) + 32;
  size_t low = begin, high = end - 1; /* the first with that bit */
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (keys[middle] >> bit & 1)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

static branch child_of(const branch *of, size_t middle, bool second) {
  size_t first_below = 2 * (middle - of->begin) - 2;
  return second ? (branch){middle, of->end, of->below + 1, of->below + 2 + first_below}
                : (branch){of->begin, middle, of->below, of->below + 2};
}

/** A branch of at most this many triangles is a task of its own. */
enum { TASK_TRIANGLES = 2048 };

/** Lists the branches that are tasks. */
static vxm_status list_tasks(builder *b, branch at) {
  if (at.end - at.begin <= TASK_TRIANGLES) {
    vxm_status status = vxm_grow(b->out->context, (void **)&b->tasks, &b->task_capacity, b->task_count + 1,
                                 sizeof *b->tasks, &b->error);
    if (status == VXM_OK)
      b->tasks[b->task_count++].at = at;
    return status;
  }
  size_t middle = split(b->keys, at.begin, at.end);
  vxm_status status = list_tasks(b, child_of(&at, middle, false));
  return status == VXM_OK ? list_tasks(b, child_of(&at, middle, true)) : status;
}

static sums build_leaf(builder *b, branch at) {
  vxm_winding_tree *out = b->out;
  vxm_point corner[3];
  vxm_winding_triangle *triangle = &out->triangles[at.begin];
  double(*p)[3] = triangle->corner;
  corners_of(b, b->keys[at.begin] & UINT32_MAX, corner);
  points_of(b, b->keys[at.begin] & UINT32_MAX, triangle->point);
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      p[k][a] = (double)corner[k].at[a] * b->step;
  out->nodes[at.node].next = (uint32_t)at.begin;
  out->nodes[at.node].is_leaf = true;
  sums of = sums_of_triangle((const double(*)[3])p);
  for (int k = 0; k < 3; k++) {
    double edge[3] = {p[k][0] - p[(k + 1) % 3][0], p[k][1] - p[(k + 1) % 3][1], p[k][2] - p[(k + 1) % 3][2]};
    triangle->length[k] = (float)(edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]);
    triangle->normal[k] = (float)(2 * of.area[k]);
  }
  return of;
}

/** At most 30 + 32 nodes deep. */
static sums build(builder *b, branch at) {
  vxm_winding_tree *out = b->out;
  sums of;
  if (at.end - at.begin == 1)
    of = build_leaf(b, at);
  else {
    size_t middle = split(b->keys, at.begin, at.end);
    sums left = build(b, child_of(&at, middle, false)), right = build(b, child_of(&at, middle, true));
    out->nodes[at.node].next = (uint32_t)at.below;
    out->nodes[at.node].is_leaf = false;
    of = join(&left, &right);
  }
  store(out, at.node, &of);
  return of;
}

static void build_task(size_t task, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  b->tasks[task].made = build(b, b->tasks[task].at);
}

/** The nodes above those of tasks, which come in the order in which they were listed. */
static sums join_tasks(builder *b, branch at) {
  if (at.end - at.begin <= TASK_TRIANGLES)
    return b->tasks[b->task_next++].made;
  vxm_winding_node *node = &b->out->nodes[at.node];
  size_t middle = split(b->keys, at.begin, at.end);
  sums left = join_tasks(b, child_of(&at, middle, false)), right = join_tasks(b, child_of(&at, middle, true));
  sums of = join(&left, &right);
  node->next = (uint32_t)at.below;
  node->is_leaf = false;
  store(b->out, at.node, &of);
  return of;
}

/** A tree for each class. */
static vxm_status build_trees(builder *b, const size_t begin[VXM_WINDING_CLASSES + 1]) {
  vxm_winding_tree *out = b->out;
  branch roots[VXM_WINDING_CLASSES];
  vxm_status status = VXM_OK;
  for (int c = 0; c < VXM_WINDING_CLASSES && status == VXM_OK; c++) {
    size_t count = begin[c + 1] - begin[c];
    if (count == 0)
      continue;
    roots[out->root_count] = (branch){begin[c], begin[c + 1], out->node_count, out->node_count + 1};
    out->roots[out->root_count] = (uint32_t)out->node_count;
    out->node_count += 2 * count - 1;
    status = list_tasks(b, roots[out->root_count++]);
  }
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(out->context, b->task_count, build_task, b, &b->error);
  for (size_t r = 0; r < out->root_count && status == VXM_OK; r++)
    join_tasks(b, roots[r]);
  return status;
}

/** Spreads the low ten bits to every third place. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

/** By the longest side of its box: below 2 voxels, 4, 8, ... */
static int class_of(const vxm_point p[3], int64_t unit) {
  int64_t longest = 0;
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]);
    int64_t high = vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]);
    longest = vxm_max(longest, high - low);
  }
  int class = 0;
  for (int64_t limit = 2 * unit; longest >= limit && class < VXM_WINDING_CLASSES - 1; limit *= 2)
    class ++;
  return class;
}

/** Three times the middle of a triangle, and its class. */
static int look_at(const builder *b, size_t triangle, int64_t middle[3]) {
  vxm_point p[3];
  corners_of(b, triangle, p);
  for (int a = 0; a < 3; a++)
    middle[a] = p[0].at[a] + p[1].at[a] + p[2].at[a];
  return class_of(p, b->out->placed->lattice.unit);
}

/** Sorts the triangles of each class along a Morton curve. */
static void sort_triangles(builder *b, uint64_t *scratch, size_t begin[VXM_WINDING_CLASSES + 1]) {
  const vxm_winding_tree *tree = b->out;
  int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {INT64_MIN, INT64_MIN, INT64_MIN}, side = 1;
  size_t at[VXM_WINDING_CLASSES + 1] = {0};
  int64_t middle[3];
  for (size_t t = 0; t < tree->count; t++) {
    at[look_at(b, t, middle) + 1]++;
    for (int a = 0; a < 3; a++) {
      low[a] = vxm_min(low[a], middle[a]);
      high[a] = vxm_max(high[a], middle[a]);
    }
  }
  for (int a = 0; a < 3; a++)
    side = vxm_max(side, high[a] - low[a]);
  for (int c = 0; c < VXM_WINDING_CLASSES; c++)
    at[c + 1] += at[c];
  memcpy(begin, at, sizeof at);
  double scale = ((1 << MORTON_BITS) - 1) / (double)side;
  for (size_t t = 0; t < tree->count; t++) {
    int class = look_at(b, t, middle);
    uint64_t key = 0;
    for (int a = 0; a < 3; a++)
      key |= spread((uint64_t)((double)(middle[a] - low[a]) * scale)) << a;
    b->keys[at[class]++] = key << 32 | t;
  }
  for (int c = 0; c < VXM_WINDING_CLASSES; c++)
    vxm_sort_keys(b->keys + begin[c], scratch, begin[c + 1] - begin[c]);
}

vxm_status vxm_winding_tree_create(vxm_winding_tree *out, vxm_context *context, const uint32_t (*corners)[3],
                                   size_t count, const vxm_snapped_points *placed, bool mirrored,
                                   vxm_error *error) {
  *out = (vxm_winding_tree){.context = context, .placed = placed, .count = count};
  if (count > UINT32_MAX / 2)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu triangles are too many for winding numbers; split the mesh",
                    count);
  builder b = {.out = out,
               .corners = corners,
               .mirrored = mirrored,
               .step = 1.0 / (double)placed->lattice.unit,
               .error = VXM_ERROR_INIT};
  size_t begin[VXM_WINDING_CLASSES + 1];
  b.keys = vxm_alloc(context, count, 2 * sizeof *b.keys, &b.error);
  out->nodes = b.keys ? vxm_alloc(context, 2 * count, sizeof *out->nodes, &b.error) : NULL;
  out->moments = out->nodes ? vxm_alloc(context, 2 * count, sizeof *out->moments, &b.error) : NULL;
  out->triangles = out->moments ? vxm_alloc(context, count, sizeof *out->triangles, &b.error) : NULL;
  vxm_status status = b.error.code;
  if (status == VXM_OK && count > 0) {
    sort_triangles(&b, b.keys + count, begin);
    status = build_trees(&b, begin);
  }
  vxm_free(context, b.tasks);
  vxm_free(context, b.keys);
  if (status == VXM_OK)
    return VXM_OK;
  vxm_winding_tree_destroy(out);
  vxm_error_pass(error, &b.error);
  return status;
}

void vxm_winding_tree_destroy(vxm_winding_tree *tree) {
  vxm_free(tree->context, tree->triangles);
  vxm_free(tree->context, tree->moments);
  vxm_free(tree->context, tree->nodes);
  *tree = (vxm_winding_tree){.context = tree->context};
}
