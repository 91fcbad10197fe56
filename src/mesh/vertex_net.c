/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/vertex_net.h"

#include "mesh/position_hash.h"
#include "mesh/soup.h"

#include <float.h>
#include <math.h>

/* Vertices that stay are kept in lists by cells of a grid. As they are farther apart than the tolerance, a
   cell holds a bounded number of them. A cell is wide enough that the ball about a vertex meets two along an
   axis at most, also where numbers are rounded. */
enum { CELL_TOLERANCES = 4 };

typedef struct net {
  const double *positions;
  double tolerance, columns_per_unit;
  size_t mask;
  uint32_t *lists; /**< by hash: the last that stays there, or VXM_NO_VERTEX */
  uint32_t *next;  /**< of a vertex that stays */
} net;

typedef struct nearest {
  uint32_t vertex; /**< or VXM_NO_VERTEX */
  double square;   /**< of the distance, in tolerances */
} nearest;

/** So far out that nothing but the same number is within the tolerance, the number itself serves. */
static double column_of(const net *n, double at) {
  double column = at * n->columns_per_unit;
  return fabs(column) < 0x1p53 ? floor(column) : at;
}

static size_t slot_of(const net *n, const double column[3]) {
  return (size_t)vxm_position_hash(column[0], column[1], column[2]) & n->mask;
}

/** Of the distance of two vertices, in tolerances, so that it neither overflows nor vanishes. */
static double square_between(const net *n, uint32_t u, uint32_t v) {
  const double *p = n->positions + 3 * (size_t)u, *q = n->positions + 3 * (size_t)v;
  double x = (p[0] - q[0]) / n->tolerance, y = (p[1] - q[1]) / n->tolerance, z = (p[2] - q[2]) / n->tolerance;
  return x * x + y * y + z * z;
}

/** Looks at those in a list. Cells that share it are looked at twice, which changes nothing. */
static void look(const net *n, size_t slot, uint32_t v, nearest *found) {
  for (uint32_t u = n->lists[slot]; u != VXM_NO_VERTEX; u = n->next[u]) {
    double square = square_between(n, u, v);
    if (square <= 1.0 && (square < found->square || (square == found->square && u < found->vertex)))
      *found = (nearest){u, square};
  }
}

/** The nearest within the tolerance of those that stay. */
static nearest find_nearest(const net *n, uint32_t v) {
  const double *p = n->positions + 3 * (size_t)v;
  double columns[2][3];
  for (int axis = 0; axis < 3; axis++) {
    columns[0][axis] = column_of(n, p[axis] - n->tolerance);
    columns[1][axis] = column_of(n, p[axis] + n->tolerance);
  }
  nearest found = {VXM_NO_VERTEX, INFINITY};
  for (int i = 0; i < 8; i++) {
    double cell[3];
    bool again = false;
    for (int axis = 0; axis < 3; axis++) {
      int far = i >> axis & 1;
      again |= far && columns[0][axis] == columns[1][axis];
      cell[axis] = columns[far][axis];
    }
    if (!again)
      look(n, slot_of(n, cell), v, &found);
  }
  return found;
}

static void let_stay(net *n, uint32_t v) {
  const double *p = n->positions + 3 * (size_t)v;
  size_t slot = slot_of(n, (double[3]){column_of(n, p[0]), column_of(n, p[1]), column_of(n, p[2])});
  n->next[v] = n->lists[slot];
  n->lists[slot] = v;
}

/** Chooses those that stay; then the others go to the nearest, which may come after them. */
static vxm_status spread(net *n, vxm_context *context, size_t count, const uint8_t *members, uint32_t *map,
                         vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t v = 0; v < count && status == VXM_OK; v++) {
    status = vxm_check_cancelled_at(v, context, error);
    if (!members[v] || map[v] != v)
      continue;
    map[v] = find_nearest(n, (uint32_t)v).vertex;
    if (map[v] == VXM_NO_VERTEX) {
      map[v] = (uint32_t)v;
      let_stay(n, (uint32_t)v);
    }
  }
  for (size_t v = 0; v < count && status == VXM_OK; v++) {
    status = vxm_check_cancelled_at(v, context, error);
    /* of what was merged before this is the vertex it went to, as no other is near to it */
    if (members[v] && map[v] != v)
      map[v] = find_nearest(n, (uint32_t)v).vertex;
  }
  return status;
}

vxm_status vxm_vertex_net(vxm_context *context, const double *positions, size_t count, const uint8_t *members,
                          double tolerance, uint32_t *map, vxm_error *error) {
  if (!(tolerance > 0))
    return VXM_OK;
  net n = {.positions = positions, .tolerance = tolerance};
  n.columns_per_unit = fmin(1 / (CELL_TOLERANCES * tolerance), DBL_MAX);
  size_t slots = 16;
  while (slots < count)
    slots *= 2;
  n.mask = slots - 1;
  vxm_error local = VXM_ERROR_INIT;
  n.lists = vxm_alloc(context, slots, sizeof *n.lists, &local);
  n.next = n.lists ? vxm_alloc(context, count, sizeof *n.next, &local) : NULL;
  vxm_status status = local.code;
  for (size_t i = 0; i < slots && n.next; i++)
    n.lists[i] = VXM_NO_VERTEX;
  if (n.next)
    status = spread(&n, context, count, members, map, &local);
  vxm_free(context, n.next);
  vxm_free(context, n.lists);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
