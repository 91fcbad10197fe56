/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/near_vertices.h"

#include "base/box.h"
#include "base/threads.h"
#include "mesh/position_hash.h"
#include "mesh/radix_partition.h"
#include "mesh/soup.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Space is cut into cubic cells 8 tolerances wide. A member lives in one cell and visits the others that the
   ball about it meets, half of a cell on average; an obstacle visits all that its ball meets. Vertices near
   each other then meet in the cell of one of them. Cells are known by a hash alone: two cells of the same
   hash are one list of vertices, whose distances are looked at all the same. */
enum { CELL_TOLERANCES = 8, CROWD = 64 };

/** A record is (31 bits of the hash of a cell, whether the vertex lives there, vertex). */
enum { LIVES_SHIFT = 32, HASH_SHIFT = 33 };

typedef struct box {
  double low[3], high[3];
} box;

/* Of an obstacle in the middle of nowhere that is found out with less: the box of the members is cut into
   coarse zones, and those that come near a member are marked. */
enum { ZONES_BITS = 6, ZONES = 1 << ZONES_BITS /**< along an axis */ };

typedef struct zones {
  double low[3], per_unit[3]; /**< column = (position - low) * per_unit */
  _Atomic uint64_t *marks;    /**< a bit per zone, x in a word; NULL = there are none, and all is near */
} zones;

typedef struct search {
  const double *positions;
  const uint8_t *roles;
  size_t count, slices;
  double tolerance;
  double columns_per_unit;  /**< 1 / width of a cell */
  _Atomic uint32_t *parent; /**< union-find over vertices; the root is the lowest */
  _Atomic uint8_t *blocked; /**< vertices near an obstacle */
  _Atomic uint64_t *homes;  /**< bits that tell which cells may have members, by hash */
  unsigned homes_shift;
  zones zones;
  unsigned bucket_shift;
  vxm_radix_partition buckets;
  uint32_t *scratch; /**< per worker: a hash table, then the links of the lists */
  size_t table_size;
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

/* ---- Union-find without locks: a root is hooked below a lower one, so the last root is the lowest ---- */

static uint32_t find_root(const search *s, uint32_t v) {
  uint32_t parent = atomic_load_explicit(&s->parent[v], memory_order_relaxed);
  while (parent != v) {
    uint32_t above = atomic_load_explicit(&s->parent[parent], memory_order_relaxed);
    /* whoever writes here writes a vertex nearer to the root */
    if (above != parent)
      atomic_store_explicit(&s->parent[v], above, memory_order_relaxed);
    v = parent;
    parent = above;
  }
  return v;
}

static void link_vertices(const search *s, uint32_t u, uint32_t v) {
  for (;;) {
    u = find_root(s, u);
    v = find_root(s, v);
    if (u == v)
      return;
    uint32_t high = u > v ? u : v, low = u > v ? v : u;
    uint32_t expected = high;
    if (atomic_compare_exchange_strong_explicit(&s->parent[high], &expected, low, memory_order_relaxed,
                                                memory_order_relaxed))
      return;
  }
}

/* ---- Cells ---- */

/** floor, without a call on processors that the build does not take for granted to have it. */
static double whole_below(double x) {
  if (!(fabs(x) < 0x1p52))
    return x;
  double toward_zero = (double)(int64_t)x;
  return toward_zero > x ? toward_zero - 1 : toward_zero;
}

/** The columns, per axis, that the ball about a point meets, and the one of the point. */
typedef struct columns {
  double low[3], high[3], home[3];
} columns;

/**
 * Rounding is monotonic, so that what is at most the tolerance away along an axis is in column low or high;
 * those are the same or neighbours.
 */
static inline columns columns_of(const search *s, const double *p) {
  columns c;
  for (int axis = 0; axis < 3; axis++) {
    c.low[axis] = whole_below((p[axis] - s->tolerance) * s->columns_per_unit);
    c.high[axis] = whole_below((p[axis] + s->tolerance) * s->columns_per_unit);
    c.home[axis] = c.low[axis] == c.high[axis] ? c.low[axis] : whole_below(p[axis] * s->columns_per_unit);
  }
  return c;
}

static uint64_t hash_home(const columns *c) {
  return vxm_position_hash(c->home[0], c->home[1], c->home[2]);
}

/** Hashes of all cells that the ball meets. */
static int hash_visited(const columns *c, uint64_t hashes[8]) {
  int count = 0;
  for (int i = 0; i < 8; i++) {
    double at[3];
    bool again = false;
    for (int axis = 0; axis < 3; axis++) {
      bool far = i >> axis & 1;
      again |= far && c->low[axis] == c->high[axis];
      at[axis] = far ? c->high[axis] : c->low[axis];
    }
    if (!again)
      hashes[count++] = vxm_position_hash(at[0], at[1], at[2]);
  }
  return count;
}

static bool meets_one_cell(const columns *c) {
  return c->low[0] == c->high[0] && c->low[1] == c->high[1] && c->low[2] == c->high[2];
}

static uint64_t record_of(uint64_t hash, bool lives, size_t v) {
  return hash << HASH_SHIFT | (uint64_t)lives << LIVES_SHIFT | v;
}

static bool may_have_members(const search *s, uint64_t hash) {
  uint64_t bit = hash >> s->homes_shift;
  return atomic_load_explicit(&s->homes[bit / 64], memory_order_relaxed) >> bit % 64 & 1;
}

/** The zone along an axis; the outermost ones reach on without end. */
static size_t zone_of(const zones *z, double at, int axis) {
  double column = (at - z->low[axis]) * z->per_unit[axis];
  return column > 0 ? column < ZONES - 1 ? (size_t)column : ZONES - 1 : 0;
}

/** How far from a member an obstacle may be that blocks it: beside the box around those of its cell. */
static double reach_of(const search *s) {
  return (CELL_TOLERANCES + 2) * s->tolerance;
}

/** Marks the zones about a member. */
static void mark_zones(const search *s, const double *p) {
  double reach = reach_of(s);
  size_t low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = zone_of(&s->zones, p[axis] - reach, axis);
    high[axis] = zone_of(&s->zones, p[axis] + reach, axis);
  }
  uint64_t row = UINT64_MAX >> (63 - (high[0] - low[0])) << low[0];
  for (size_t z = low[2]; z <= high[2]; z++)
    for (size_t y = low[1]; y <= high[1]; y++)
      atomic_fetch_or_explicit(&s->zones.marks[z << ZONES_BITS | y], row, memory_order_relaxed);
}

static bool is_near_members(const search *s, const double *p) {
  const zones *z = &s->zones;
  if (!z->marks)
    return true;
  size_t row = zone_of(z, p[2], 2) << ZONES_BITS | zone_of(z, p[1], 1);
  return atomic_load_explicit(&z->marks[row], memory_order_relaxed) >> zone_of(z, p[0], 0) & 1;
}

static void emit_vertices(size_t begin, size_t end, vxm_sink *sink, void *payload) {
  const search *s = payload;
  for (size_t v = begin; v < end; v++) {
    if (s->roles[v] == VXM_NEAR_ABSENT)
      continue;
    bool member = s->roles[v] == VXM_NEAR_MEMBER;
    if (!member && !is_near_members(s, s->positions + 3 * v))
      continue;
    columns c = columns_of(s, s->positions + 3 * v);
    uint64_t home = hash_home(&c), hashes[8];
    if (member)
      vxm_sink_put(sink, (size_t)(home >> s->bucket_shift), record_of(home, true, v));
    if (member && meets_one_cell(&c))
      continue;
    int count = hash_visited(&c, hashes);
    for (int i = 0; i < count; i++)
      /* of two members that may visit each other, one visit is enough */
      if ((!member || hashes[i] < home) && may_have_members(s, hashes[i]))
        vxm_sink_put(sink, (size_t)(hashes[i] >> s->bucket_shift), record_of(hashes[i], false, v));
  }
}

static void start_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  search *s = payload;
  size_t end = vxm_slice_begin(s->count, s->slices, slice + 1);
  for (size_t v = vxm_slice_begin(s->count, s->slices, slice); v < end; v++) {
    atomic_store_explicit(&s->parent[v], (uint32_t)v, memory_order_relaxed);
    if (s->roles[v] != VXM_NEAR_MEMBER)
      continue;
    columns c = columns_of(s, s->positions + 3 * v);
    uint64_t bit = hash_home(&c) >> s->homes_shift, mask = UINT64_C(1) << bit % 64;
    if (!(atomic_load_explicit(&s->homes[bit / 64], memory_order_relaxed) & mask))
      atomic_fetch_or_explicit(&s->homes[bit / 64], mask, memory_order_relaxed);
    if (s->zones.marks)
      mark_zones(s, s->positions + 3 * v);
  }
}

/* ---- Linking within a cell ---- */

/** The records of a bucket in lists by cell: links are places in the bucket + 1, or 0. */
typedef struct cells {
  const uint64_t *records;
  uint32_t *table, *next;
  size_t count, mask;
} cells;

static uint32_t vertex_of(uint64_t record) {
  return (uint32_t)record;
}

static bool lives(uint64_t record) {
  return record >> LIVES_SHIFT & 1;
}

/** A member is linked to u; an obstacle blocks it. */
static void meet(const search *s, uint32_t v, uint32_t u) {
  if (s->roles[v] == VXM_NEAR_OBSTACLE)
    atomic_store_explicit(&s->blocked[u], 1, memory_order_relaxed);
  else
    link_vertices(s, u, v);
}

/** Links all who live in a crowded cell, and who visits it and comes near the box around them. */
static void link_crowd(const search *s, const cells *c, uint32_t list) {
  box around;
  uint32_t first = VXM_NO_VERTEX;
  vxm_box_empty(around.low, around.high);
  for (uint32_t i = list; i != 0; i = c->next[i - 1])
    if (lives(c->records[i - 1])) {
      uint32_t v = vertex_of(c->records[i - 1]);
      first = first == VXM_NO_VERTEX ? v : first;
      link_vertices(s, first, v);
      vxm_box_include(around.low, around.high, s->positions + 3 * (size_t)v);
    }
  for (uint32_t i = list; i != 0; i = c->next[i - 1]) {
    uint32_t v = vertex_of(c->records[i - 1]);
    if (!lives(c->records[i - 1]) && point_near_box(s->positions + 3 * (size_t)v, &around, s->tolerance))
      meet(s, v, first);
  }
}

static void link_cell(const search *s, const cells *c, uint32_t list) {
  uint32_t residents[CROWD];
  size_t count = 0;
  for (uint32_t i = list; i != 0; i = c->next[i - 1])
    if (lives(c->records[i - 1])) {
      if (count == CROWD) {
        link_crowd(s, c, list);
        return;
      }
      residents[count++] = vertex_of(c->records[i - 1]);
    }
  for (uint32_t i = list; i != 0; i = c->next[i - 1]) {
    uint32_t v = vertex_of(c->records[i - 1]);
    bool resident = lives(c->records[i - 1]);
    for (size_t r = 0; r < count; r++)
      if ((!resident || residents[r] < v) &&
          points_near(s->positions + 3 * (size_t)v, s->positions + 3 * (size_t)residents[r], s->tolerance))
        meet(s, v, residents[r]);
  }
}

static void link_bucket(size_t bucket, int worker, void *payload) {
  const search *s = payload;
  cells c = {.records = s->buckets.records + s->buckets.begin[bucket]};
  c.count = s->buckets.begin[bucket + 1] - s->buckets.begin[bucket];
  c.table = s->scratch + (size_t)worker * (s->table_size + s->buckets.largest);
  c.next = c.table + s->table_size;
  c.mask = vxm_hash_slots(c.count) - 1;
  memset(c.table, 0, (c.mask + 1) * sizeof *c.table);
  for (size_t i = 0; i < c.count; i++) {
    __builtin_prefetch(s->positions + 3 * (size_t)vertex_of(c.records[i]));
    size_t slot = (size_t)(c.records[i] >> HASH_SHIFT) & c.mask;
    while (c.table[slot] != 0 && c.records[c.table[slot] - 1] >> HASH_SHIFT != c.records[i] >> HASH_SHIFT)
      slot = (slot + 1) & c.mask;
    c.next[i] = c.table[slot];
    c.table[slot] = (uint32_t)i + 1;
  }
  for (size_t slot = 0; slot <= c.mask; slot++)
    if (c.table[slot] != 0 && c.next[c.table[slot] - 1] != 0)
      link_cell(s, &c, c.table[slot]);
}

/* ---- Judging the groups ---- */

/** Gives every group of several members its box, and maps the members of those that are small enough. */
static vxm_status map_groups(search *s, vxm_context *context, uint32_t *map, vxm_error *error) {
  uint32_t *number = vxm_alloc(context, s->count, sizeof *number, error);
  if (!number)
    return error->code;
  size_t groups = 0;
  for (size_t v = 0; v < s->count; v++) {
    uint32_t root = find_root(s, (uint32_t)v);
    map[v] = root;
    number[v] = VXM_NO_VERTEX;
    /* a root comes before the members below it */
    if (root != v && number[root] == VXM_NO_VERTEX)
      number[root] = (uint32_t)groups++;
    if (root != v && atomic_load_explicit(&s->blocked[v], memory_order_relaxed))
      atomic_store_explicit(&s->blocked[root], 1, memory_order_relaxed);
  }
  box *boxes = vxm_alloc(context, groups, sizeof *boxes, error);
  if (!boxes) {
    vxm_free(context, number);
    return error->code;
  }
  for (size_t g = 0; g < groups; g++)
    vxm_box_empty(boxes[g].low, boxes[g].high);
  for (size_t v = 0; v < s->count; v++)
    if (number[map[v]] != VXM_NO_VERTEX) {
      box *b = &boxes[number[map[v]]];
      vxm_box_include(b->low, b->high, s->positions + 3 * v);
    }
  for (size_t v = 0; v < s->count; v++)
    if (map[v] != v && (atomic_load_explicit(&s->blocked[map[v]], memory_order_relaxed) ||
                        !box_within(&boxes[number[map[v]]], s->tolerance)))
      map[v] = (uint32_t)v;
  vxm_free(context, boxes);
  vxm_free(context, number);
  return VXM_OK;
}

/** Lays zones over the members, where these are few and come near few zones. */
static vxm_status lay_zones(search *s, size_t members, vxm_context *context, vxm_error *error) {
  enum { FEW_OF = 4, NEAR = 2 };
  box around;
  vxm_box_empty(around.low, around.high);
  for (size_t v = 0; v < s->count; v++)
    if (s->roles[v] == VXM_NEAR_MEMBER)
      vxm_box_include(around.low, around.high, s->positions + 3 * v);
  bool some = members > 0 && members < s->count / FEW_OF;
  for (int axis = 0; axis < 3; axis++) {
    double length = around.high[axis] - around.low[axis];
    s->zones.low[axis] = around.low[axis];
    s->zones.per_unit[axis] = length > 0 ? ZONES / length : 0;
    some = some && isfinite(length) && reach_of(s) * s->zones.per_unit[axis] < NEAR;
  }
  if (some)
    s->zones.marks = vxm_calloc(context, (size_t)1 << 2 * ZONES_BITS, sizeof *s->zones.marks, error);
  return some && !s->zones.marks ? error->code : VXM_OK;
}

static vxm_status fill_cells(search *s, vxm_context *context, vxm_error *error) {
  size_t members = 0, bits = 1024;
  for (size_t v = 0; v < s->count; v++)
    members += s->roles[v] == VXM_NEAR_MEMBER;
  while (bits < 8 * members)
    bits *= 2;
  s->homes_shift = 64 - (unsigned)__builtin_ctzll(bits);
  s->parent = vxm_alloc(context, s->count, sizeof *s->parent, error);
  if (s->parent)
    s->blocked = vxm_calloc(context, s->count, sizeof *s->blocked, error);
  if (s->blocked)
    s->homes = vxm_calloc(context, bits / 64, sizeof *s->homes, error);
  if (!s->homes)
    return error->code;
  s->slices = s->count / 16384 + 1;
  vxm_status status = lay_zones(s, members, context, error);
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(context, s->slices, start_slice, s, error);
  if (status != VXM_OK)
    return status;
  size_t bucket_count = vxm_radix_partition_advise(2 * members);
  s->bucket_shift = 64 - (unsigned)__builtin_ctzll(bucket_count);
  return vxm_radix_partition_fill(&s->buckets, context, s->count, bucket_count, emit_vertices, s, error);
}

static vxm_status link_all(search *s, vxm_context *context, vxm_error *error) {
  s->table_size = vxm_hash_slots(s->buckets.largest);
  size_t workers = (size_t)vxm_context_threads(context);
  s->scratch = vxm_alloc(context, workers * (s->table_size + s->buckets.largest), sizeof *s->scratch, error);
  if (!s->scratch)
    return error->code;
  return vxm_parallel_cancellable(context, s->buckets.count, link_bucket, s, error);
}

vxm_status vxm_near_vertices_group(vxm_context *context, const double *positions, size_t count,
                                   const uint8_t *roles, double tolerance, uint32_t *map, vxm_error *error) {
  if (!(tolerance > 0)) {
    for (size_t v = 0; v < count; v++)
      map[v] = (uint32_t)v;
    return VXM_OK;
  }
  search s = {.positions = positions, .roles = roles, .count = count, .tolerance = tolerance};
  s.columns_per_unit = fmin(1 / (CELL_TOLERANCES * tolerance), DBL_MAX);
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = fill_cells(&s, context, &local);
  if (status == VXM_OK)
    status = link_all(&s, context, &local);
  vxm_free(context, s.scratch);
  vxm_radix_partition_destroy(&s.buckets);
  if (status == VXM_OK)
    status = map_groups(&s, context, map, &local);
  vxm_free(context, s.zones.marks);
  vxm_free(context, s.homes);
  vxm_free(context, s.blocked);
  vxm_free(context, s.parent);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
