/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/near.h"

#include "base/hash.h"
#include "mesh/soup.h"

#include <math.h>
#include <string.h>

/* Members are sorted into cubic cells 8 tolerances wide, so that the ball about a vertex meets two cells on
   average and eight at most, and only their vertices need be looked at. */
enum { CELL_TOLERANCES = 8, CROWD = 64 };

typedef struct box {
  double low[3], high[3];
} box;

typedef struct cell {
  double at[3];   /**< whole numbers; doubles, as they may be beyond 64 bits */
  uint32_t first; /**< one of its members; `next` leads to the others */
  uint32_t count;
  box around;
} cell;

typedef struct search {
  vxm_context *context;
  const double *positions;
  const uint8_t *roles;
  size_t count;
  double tolerance, width;
  uint32_t *parent; /**< union-find over vertices; the root is the lowest */
  uint32_t *next;   /**< next member of the same cell, or VXM_NO_VERTEX */
  cell *cells;
  size_t cell_count, cell_capacity;
  uint32_t *table; /**< number of a cell + 1, or 0 */
  size_t mask;
  uint8_t *blocked; /**< vertices linked to an obstacle */
} search;

/* ---- Distances, as multiples of the tolerance so that squares neither overflow nor vanish ---- */

static bool length_within(double x, double y, double z, double tolerance) {
  x /= tolerance;
  y /= tolerance;
  z /= tolerance;
  return x * x + y * y + z * z <= 1.0;
}

static bool points_near(const double *p, const double *q, double tolerance) {
  return length_within(p[0] - q[0], p[1] - q[1], p[2] - q[2], tolerance);
}

static bool box_within(const box *b, double tolerance) {
  return length_within(b->high[0] - b->low[0], b->high[1] - b->low[1], b->high[2] - b->low[2], tolerance);
}

static bool point_near_box(const double *p, const box *b, double tolerance) {
  double away[3];
  for (int axis = 0; axis < 3; axis++) {
    double below = b->low[axis] - p[axis], above = p[axis] - b->high[axis];
    away[axis] = below > 0 ? below : above > 0 ? above : 0;
  }
  return length_within(away[0], away[1], away[2], tolerance);
}

static void box_include(box *b, const double *p) {
  for (int axis = 0; axis < 3; axis++) {
    b->low[axis] = p[axis] < b->low[axis] ? p[axis] : b->low[axis];
    b->high[axis] = p[axis] > b->high[axis] ? p[axis] : b->high[axis];
  }
}

static box box_of_point(const double *p) {
  return (box){{p[0], p[1], p[2]}, {p[0], p[1], p[2]}};
}

/* ---- Union-find ---- */

static uint32_t find_root(uint32_t *parent, uint32_t v) {
  while (parent[v] != v) {
    parent[v] = parent[parent[v]];
    v = parent[v];
  }
  return v;
}

static void link_vertices(uint32_t *parent, uint32_t u, uint32_t v) {
  u = find_root(parent, u);
  v = find_root(parent, v);
  if (u < v)
    parent[v] = u;
  else
    parent[u] = v;
}

/* ---- Cells ---- */

static uint64_t hash_cell(const double at[3]) {
  uint64_t hash = 0;
  for (int axis = 0; axis < 3; axis++) {
    uint64_t bits;
    double plain = at[axis] + 0.0;
    memcpy(&bits, &plain, sizeof bits);
    hash = vxm_hash_word(hash, bits);
  }
  return hash;
}

/** Slot of a cell in the table, or the free slot where it belongs. */
static size_t find_slot(const search *s, const double at[3]) {
  size_t slot = (size_t)hash_cell(at) & s->mask;
  for (; s->table[slot] != 0; slot = (slot + 1) & s->mask) {
    const double *other = s->cells[s->table[slot] - 1].at;
    if (other[0] == at[0] && other[1] == at[1] && other[2] == at[2])
      break;
  }
  return slot;
}

static vxm_status add_member(search *s, uint32_t v, vxm_error *error) {
  const double *p = s->positions + 3 * (size_t)v;
  double at[3] = {floor(p[0] / s->width), floor(p[1] / s->width), floor(p[2] / s->width)};
  size_t slot = find_slot(s, at);
  if (s->table[slot] == 0) {
    vxm_status status = vxm_grow(s->context, (void **)&s->cells, &s->cell_capacity, s->cell_count + 1,
                                 sizeof *s->cells, error);
    if (status != VXM_OK)
      return status;
    s->cells[s->cell_count++] = (cell){{at[0], at[1], at[2]}, VXM_NO_VERTEX, 0, box_of_point(p)};
    s->table[slot] = (uint32_t)s->cell_count;
  }
  cell *c = &s->cells[s->table[slot] - 1];
  s->next[v] = c->first;
  c->first = v;
  c->count++;
  box_include(&c->around, p);
  return VXM_OK;
}

static vxm_status fill_cells(search *s, vxm_error *error) {
  size_t members = 0;
  for (size_t v = 0; v < s->count; v++)
    members += s->roles[v] == VXM_NEAR_MEMBER;
  size_t slots = 16;
  while (slots < 2 * members)
    slots *= 2;
  s->mask = slots - 1;
  vxm_error local = VXM_ERROR_INIT;
  s->table = vxm_calloc(s->context, slots, sizeof *s->table, &local);
  if (s->table)
    s->next = vxm_alloc(s->context, s->count, sizeof *s->next, &local);
  if (s->next)
    s->blocked = vxm_calloc(s->context, s->count, sizeof *s->blocked, &local);
  vxm_status status = s->blocked ? VXM_OK : local.code;
  for (size_t v = 0; v < s->count && status == VXM_OK; v++) {
    s->parent[v] = (uint32_t)v;
    if (s->roles[v] == VXM_NEAR_MEMBER)
      status = add_member(s, (uint32_t)v, &local);
  }
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

/* ---- Linking ---- */

/** A member is linked to u; an obstacle blocks it. */
static void meet(search *s, uint32_t v, uint32_t u) {
  if (s->roles[v] == VXM_NEAR_OBSTACLE)
    s->blocked[u] = 1;
  else
    link_vertices(s->parent, u, v);
}

static void meet_cell(search *s, uint32_t v, const cell *c) {
  const double *p = s->positions + 3 * (size_t)v;
  if (c->count > CROWD) {
    if (point_near_box(p, &c->around, s->tolerance))
      meet(s, v, c->first);
    return;
  }
  for (uint32_t u = c->first; u != VXM_NO_VERTEX; u = s->next[u])
    if (u != v && points_near(p, s->positions + 3 * (size_t)u, s->tolerance))
      meet(s, v, u);
}

/**
 * Looks at all cells that the ball about a vertex may meet. Rounding is monotonic, so that a member at most
 * the tolerance away along an axis is in a cell between the two found here; those are the same or neighbours.
 */
static void meet_around(search *s, uint32_t v) {
  const double *p = s->positions + 3 * (size_t)v;
  double range[3][2];
  for (int axis = 0; axis < 3; axis++) {
    range[axis][0] = floor((p[axis] - s->tolerance) / s->width);
    range[axis][1] = floor((p[axis] + s->tolerance) / s->width);
  }
  for (int i = 0; i < 8; i++) {
    double at[3];
    bool seen = false;
    for (int axis = 0; axis < 3; axis++) {
      int side = i >> axis & 1;
      seen |= side == 1 && range[axis][0] == range[axis][1];
      at[axis] = range[axis][side];
    }
    size_t slot = seen ? 0 : find_slot(s, at);
    if (!seen && s->table[slot] != 0)
      meet_cell(s, v, &s->cells[s->table[slot] - 1]);
  }
}

static void link_all(search *s) {
  for (size_t i = 0; i < s->cell_count; i++) {
    const cell *c = &s->cells[i];
    for (uint32_t v = c->first; c->count > CROWD && v != VXM_NO_VERTEX; v = s->next[v])
      link_vertices(s->parent, c->first, v);
  }
  for (size_t v = 0; v < s->count; v++)
    if (s->roles[v] != VXM_NEAR_ABSENT)
      meet_around(s, (uint32_t)v);
}

/* ---- Judging the groups ---- */

/** Gives every group of several members its box, and maps the members of those that are small enough. */
static vxm_status map_groups(search *s, uint32_t *map, vxm_error *error) {
  /* the cells have done their work: their lists become the numbers of the groups */
  uint32_t *number = s->next;
  size_t groups = 0;
  for (size_t v = 0; v < s->count; v++)
    number[v] = VXM_NO_VERTEX;
  for (size_t v = 0; v < s->count; v++) {
    uint32_t root = find_root(s->parent, (uint32_t)v);
    map[v] = root;
    if (root != v && number[root] == VXM_NO_VERTEX)
      number[root] = (uint32_t)groups++;
    s->blocked[root] |= s->blocked[v];
  }
  vxm_error local = VXM_ERROR_INIT;
  box *boxes = vxm_alloc(s->context, groups, sizeof *boxes, &local);
  if (!boxes) {
    if (error)
      *error = local;
    return local.code;
  }
  for (size_t v = 0; v < s->count; v++)
    if (map[v] == v && number[v] != VXM_NO_VERTEX)
      boxes[number[v]] = box_of_point(s->positions + 3 * v);
  for (size_t v = 0; v < s->count; v++)
    if (map[v] != v)
      box_include(&boxes[number[map[v]]], s->positions + 3 * v);
  for (size_t v = 0; v < s->count; v++)
    if (map[v] != v && (s->blocked[map[v]] || !box_within(&boxes[number[map[v]]], s->tolerance)))
      map[v] = (uint32_t)v;
  vxm_free(s->context, boxes);
  return VXM_OK;
}

vxm_status vxm_weld_near(vxm_context *context, const double *positions, size_t count, const uint8_t *roles,
                         double tolerance, uint32_t *map, vxm_error *error) {
  search s = {.context = context, .positions = positions, .roles = roles, .count = count};
  s.tolerance = tolerance;
  s.width = CELL_TOLERANCES * tolerance;
  if (!(tolerance > 0)) {
    for (size_t v = 0; v < count; v++)
      map[v] = (uint32_t)v;
    return VXM_OK;
  }
  vxm_error local = VXM_ERROR_INIT;
  s.parent = vxm_alloc(context, count, sizeof *s.parent, &local);
  vxm_status status = s.parent ? fill_cells(&s, &local) : local.code;
  if (status == VXM_OK) {
    link_all(&s);
    status = map_groups(&s, map, &local);
  }
  vxm_free(context, s.blocked);
  vxm_free(context, s.next);
  vxm_free(context, s.table);
  vxm_free(context, s.cells);
  vxm_free(context, s.parent);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}
