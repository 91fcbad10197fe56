/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding.h"
#include "base/threads.h"
#include "mesh/sort.h"

#include <math.h>
#include <string.h>

enum {
  LEAF_SIZE = 8,    /**< triangles of a leaf, at most */
  MORTON_BITS = 10, /**< per axis; with the triangle's number below, a sort key fits 64 bits */
  STACK_SIZE = 128  /**< the tree is less than 64 deep, and a node leaves one more behind */
};

/** A node is far if its centre is at least this many of its radii, and the brick's, away. */
static const double far_ratio = 2.0;
/** Distance of a brick's corner voxels from its centre: 1.5 sqrt 3. */
static const double brick_radius = 2.598076211353316;

typedef struct node {
  double centre[3];
  double radius;
  float area[3];   /**< sum of the vector areas */
  float moment[6]; /**< sum of area_i offset_j: xx, yy, zz, then xy + yx, xz + zx, yz + zy */
} node;

/** A complete binary tree: node n has the children 2 n and 2 n + 1, and leaf l is node leaf_count + l. */
struct vxm_winding {
  vxm_context *context;
  const vxm_winding_triangle *triangles;
  size_t count, leaf_count;
  node *nodes;
};

/* ---- Building ---- */

static void centre_of(const vxm_winding_triangle *t, double c[3]) {
  for (int a = 0; a < 3; a++)
    c[a] = (t->corner[0][a] + t->corner[1][a] + t->corner[2][a]) / 3;
}

static void vector_area_of(const vxm_winding_triangle *t, double n[3]) {
  double u[3], v[3];
  for (int a = 0; a < 3; a++) {
    u[a] = t->corner[1][a] - t->corner[0][a];
    v[a] = t->corner[2][a] - t->corner[0][a];
  }
  for (int a = 0; a < 3; a++)
    n[a] = (u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3]) / 2;
}

static double squared_distance(const double p[3], const double q[3]) {
  return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
}

/** Spreads the low ten bits to every third place. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

/** Sorts the triangles along a Morton curve through their centres. */
static vxm_status sort_triangles(vxm_context *context, vxm_winding_triangle *triangles, size_t count,
                                 vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  uint64_t *keys = vxm_alloc(context, count, 2 * sizeof *keys, &local);
  vxm_winding_triangle *copy = keys ? vxm_alloc(context, count, sizeof *copy, &local) : NULL;
  if (!copy) {
    vxm_free(context, keys);
    vxm_error_pass(error, &local);
    return local.code;
  }
  double low[3] = {INFINITY, INFINITY, INFINITY}, side = 0;
  for (size_t t = 0; t < count; t++) {
    double c[3];
    centre_of(&triangles[t], c);
    for (int a = 0; a < 3; a++)
      low[a] = fmin(low[a], c[a]);
  }
  for (size_t t = 0; t < count; t++) {
    double c[3];
    centre_of(&triangles[t], c);
    for (int a = 0; a < 3; a++)
      side = fmax(side, c[a] - low[a]);
  }
  double cells = side > 0 ? ((1 << MORTON_BITS) - 1) / side : 0;
  for (size_t t = 0; t < count; t++) {
    double c[3];
    centre_of(&triangles[t], c);
    uint64_t key = 0;
    for (int a = 0; a < 3; a++)
      key |= spread((uint64_t)((c[a] - low[a]) * cells)) << a;
    keys[t] = key << 32 | t;
  }
  vxm_sort_keys(keys, keys + count, count);
  memcpy(copy, triangles, count * sizeof *copy);
  for (size_t t = 0; t < count; t++)
    triangles[t] = copy[keys[t] & UINT32_MAX];
  vxm_free(context, copy);
  vxm_free(context, keys);
  return VXM_OK;
}

static void fill_node(node *out, const vxm_winding_triangle *triangles, size_t count) {
  double weight = 0, area[3] = {0, 0, 0}, moment[3][3] = {{0}}, reach = 0;
  for (size_t t = 0; t < count; t++) {
    double n[3], c[3];
    vector_area_of(&triangles[t], n);
    centre_of(&triangles[t], c);
    double a = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    weight += a;
    for (int k = 0; k < 3; k++) {
      out->centre[k] += a * c[k];
      area[k] += n[k];
    }
  }
  if (weight > 0)
    for (int k = 0; k < 3; k++)
      out->centre[k] /= weight;
  else
    centre_of(&triangles[0], out->centre);
  for (size_t t = 0; t < count; t++) {
    double n[3], c[3];
    vector_area_of(&triangles[t], n);
    centre_of(&triangles[t], c);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        moment[i][j] += n[i] * (c[j] - out->centre[j]);
    for (int k = 0; k < 3; k++)
      reach = fmax(reach, squared_distance(triangles[t].corner[k], out->centre));
  }
  out->radius = sqrt(reach);
  for (int k = 0; k < 3; k++) {
    out->area[k] = (float)area[k];
    out->moment[k] = (float)moment[k][k];
  }
  out->moment[3] = (float)(moment[0][1] + moment[1][0]);
  out->moment[4] = (float)(moment[0][2] + moment[2][0]);
  out->moment[5] = (float)(moment[1][2] + moment[2][1]);
}

static size_t leaf_begin(const vxm_winding *w, size_t leaf) {
  return vxm_slice_begin(w->count, w->leaf_count, leaf);
}

static void fill_node_task(size_t task, int worker, void *payload) {
  (void)worker;
  vxm_winding *w = payload;
  size_t first = task + 1, last = task + 1; /* leaves below node task + 1 */
  while (first < w->leaf_count) {
    first = 2 * first;
    last = 2 * last + 1;
  }
  size_t begin = leaf_begin(w, first - w->leaf_count), end = leaf_begin(w, last + 1 - w->leaf_count);
  if (begin < end)
    fill_node(&w->nodes[task + 1], w->triangles + begin, end - begin);
}

vxm_status vxm_winding_create(vxm_winding **out, vxm_context *context, vxm_winding_triangle *triangles,
                              size_t count, vxm_error *error) {
  *out = NULL;
  if (count > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu triangles are too many for winding numbers; split the mesh",
                    count);
  vxm_error local = VXM_ERROR_INIT;
  vxm_winding *w = vxm_calloc(context, 1, sizeof *w, &local);
  if (w) {
    *w = (vxm_winding){.context = context, .triangles = triangles, .count = count, .leaf_count = 1};
    while (w->leaf_count * LEAF_SIZE < count)
      w->leaf_count *= 2;
    w->nodes = vxm_calloc(context, 2 * w->leaf_count, sizeof *w->nodes, &local);
  }
  if (w && w->nodes && sort_triangles(context, triangles, count, &local) == VXM_OK &&
      vxm_parallel_asked(context, 2 * w->leaf_count - 1, fill_node_task, w, &local) == VXM_OK) {
    *out = w;
    return VXM_OK;
  }
  if (w)
    vxm_winding_destroy(w);
  vxm_error_pass(error, &local);
  return local.code;
}

void vxm_winding_destroy(vxm_winding *winding) {
  if (!winding)
    return;
  vxm_free(winding->context, winding->nodes);
  vxm_free(winding->context, winding);
}

/* ---- Asking ---- */

/** The 64 centres relative to the middle of the brick, and the solid angles gathered so far. */
typedef struct brick {
  double middle[3];
  float x[VXM_BRICK], y[VXM_BRICK], z[VXM_BRICK], angle[VXM_BRICK];
} brick;

/* The loops over a brick are compiled for several vector widths. Each voxel's arithmetic is the same in all
   of them (no fused or approximate operations), so the bits are too. */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VECTOR_CLONES
#endif

/** Area . d / d^3 and its first correction, with d from the voxel to the node's centre. */
VECTOR_CLONES static void add_far_node(brick *b, const node *n) {
  float cx = (float)(n->centre[0] - b->middle[0]), cy = (float)(n->centre[1] - b->middle[1]),
        cz = (float)(n->centre[2] - b->middle[2]);
  float ax = n->area[0], ay = n->area[1], az = n->area[2];
  float xx = n->moment[0], yy = n->moment[1], zz = n->moment[2];
  float xy = n->moment[3], xz = n->moment[4], yz = n->moment[5], trace = xx + yy + zz;
  for (int v = 0; v < VXM_BRICK; v++) {
    float dx = cx - b->x[v], dy = cy - b->y[v], dz = cz - b->z[v];
    float inverse = 1.0F / sqrtf(dx * dx + dy * dy + dz * dz), square = inverse * inverse;
    float bent = dx * (xx * dx + xy * dy + xz * dz) + dy * (yy * dy + yz * dz) + dz * (zz * dz);
    b->angle[v] += square * inverse * (ax * dx + ay * dy + az * dz + trace - 3.0F * square * bent);
  }
}

/** atan2; the polynomial for the first octant was fitted for this file, its largest error is 2.5e-7. */
static inline float angle_of(float y, float x) {
  float ay = fabsf(y), ax = fabsf(x);
  float large = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
  float t = large > 0.0F ? small / large : 0.0F, s = t * t;
  float p = 0.006811793F;
  p = p * s - 0.03360422F;
  p = p * s + 0.07962367F;
  p = p * s - 0.13233342F;
  p = p * s + 0.19807816F;
  p = p * s - 0.33317368F;
  p = (p * s + 0.99999611F) * t;
  p = ay > ax ? 1.57079633F - p : p;
  p = x < 0.0F ? 3.14159265F - p : p;
  return y < 0.0F ? -p : p;
}

/** tan(angle / 2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|), from the voxel. */
VECTOR_CLONES static void add_triangle(brick *out, const vxm_winding_triangle *t) {
  float corner[3][3];
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      corner[k][a] = (float)(t->corner[k][a] - out->middle[a]);
  for (int v = 0; v < VXM_BRICK; v++) {
    float x = out->x[v], y = out->y[v], z = out->z[v];
    float ax = corner[0][0] - x, ay = corner[0][1] - y, az = corner[0][2] - z;
    float bx = corner[1][0] - x, by = corner[1][1] - y, bz = corner[1][2] - z;
    float cx = corner[2][0] - x, cy = corner[2][1] - y, cz = corner[2][2] - z;
    float a = sqrtf(ax * ax + ay * ay + az * az), b = sqrtf(bx * bx + by * by + bz * bz),
          c = sqrtf(cx * cx + cy * cy + cz * cz);
    float volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    float ab = ax * bx + ay * by + az * bz, bc = bx * cx + by * cy + bz * cz,
          ca = cx * ax + cy * ay + cz * az;
    out->angle[v] += 2.0F * angle_of(volume, a * b * c + ab * c + bc * a + ca * b);
  }
}

void vxm_winding_brick(const vxm_winding *winding, int64_t i, int64_t j, int64_t k, float value[VXM_BRICK]) {
  brick b = {.middle = {(double)i + 2, (double)j + 2, (double)k + 2}};
  for (int v = 0; v < VXM_BRICK; v++) {
    b.x[v] = (float)(v & 3) - 1.5F;
    b.y[v] = (float)(v >> 2 & 3) - 1.5F;
    b.z[v] = (float)(v >> 4) - 1.5F;
  }
  size_t stack[STACK_SIZE], top = 0;
  if (winding->count > 0)
    stack[top++] = 1;
  while (top > 0) {
    size_t at = stack[--top];
    const node *n = &winding->nodes[at];
    double reach = far_ratio * n->radius + brick_radius;
    if (squared_distance(n->centre, b.middle) > reach * reach) {
      add_far_node(&b, n);
      continue;
    }
    if (at < winding->leaf_count) {
      stack[top++] = 2 * at + 1;
      stack[top++] = 2 * at;
      continue;
    }
    size_t end = leaf_begin(winding, at - winding->leaf_count + 1);
    for (size_t t = leaf_begin(winding, at - winding->leaf_count); t < end; t++)
      add_triangle(&b, &winding->triangles[t]);
  }
  for (int v = 0; v < VXM_BRICK; v++)
    value[v] = b.angle[v] * 0.0795774715F; /* 1 / 4 pi */
}
