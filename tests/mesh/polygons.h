/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons in whole numbers that do not cross themselves, though many touch themselves. */
#ifndef TEST_MESHIO_POLYGONS_H
#define TEST_MESHIO_POLYGONS_H

#include "base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { FLAT_MAX = 4096 };

typedef struct flat {
  size_t n;
  int64_t at[FLAT_MAX][2];
} flat;

static inline void flat_add(flat *f, int64_t x, int64_t y) {
  assert_true(f->n < FLAT_MAX);
  f->at[f->n][0] = x;
  f->at[f->n++][1] = y;
}

/** Twice the area of a triangle: positive if it turns left. */
static inline int64_t flat_turn(const int64_t a[2], const int64_t b[2], const int64_t c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/** Twice the area of a polygon. */
static inline int64_t flat_area(const flat *f) {
  int64_t sum = 0;
  for (size_t i = 1; i + 1 < f->n; i++)
    sum += flat_turn(f->at[0], f->at[i], f->at[i + 1]);
  return sum;
}

static inline void flat_reverse(flat *f) {
  for (size_t i = 0, j = f->n - 1; i < j; i++, j--)
    for (int c = 0; c < 2; c++) {
      int64_t kept = f->at[i][c];
      f->at[i][c] = f->at[j][c];
      f->at[j][c] = kept;
    }
}

/* ---- Smooth shapes ---- */

/** Every corner is seen from the middle. */
static inline void flat_star(flat *f, size_t n, int64_t size, vxm_rng *rng) {
  f->n = 0;
  for (size_t k = 0; k < n; k++) {
    double angle = 2.0 * 3.141592653589793 * (double)k / (double)n;
    double radius = (double)size * (0.1 + 0.9 * vxm_rng_unit(rng));
    flat_add(f, llround(radius * cos(angle)), llround(radius * sin(angle)));
  }
}

static inline void flat_comb(flat *f, int teeth, int64_t tall) {
  f->n = 0;
  flat_add(f, 0, -1);
  flat_add(f, 2 * teeth, -1);
  for (int k = 2 * teeth; k >= 0; k--)
    flat_add(f, k, k % 2 ? 0 : tall);
}

/** A strip wound up; `n` corners on each of its sides. */
static inline void flat_spiral(flat *f, size_t n, double size) {
  f->n = 0;
  for (size_t side = 0; side < 2; side++)
    for (size_t i = 0; i < n; i++) {
      size_t k = side ? n - 1 - i : i;
      double angle = 0.2 * (double)k, radius = size * (1 + 0.1 * angle - (side ? 0.3 : 0));
      flat_add(f, llround(radius * cos(angle)), llround(radius * sin(angle)));
    }
}

/* ---- Random tours ---- */

static inline bool flat_between(const int64_t a[2], const int64_t b[2], const int64_t p[2]) {
  for (int c = 0; c < 2; c++)
    if ((p[c] < a[c] && p[c] < b[c]) || (p[c] > a[c] && p[c] > b[c]))
      return false;
  return true;
}

/** Whether two closed segments meet. */
static inline bool flat_meet(const int64_t a[2], const int64_t b[2], const int64_t c[2], const int64_t d[2]) {
  int64_t s = flat_turn(a, b, c), t = flat_turn(a, b, d), u = flat_turn(c, d, a), v = flat_turn(c, d, b);
  if (((s > 0 && t < 0) || (s < 0 && t > 0)) && ((u > 0 && v < 0) || (u < 0 && v > 0)))
    return true;
  return (s == 0 && flat_between(a, b, c)) || (t == 0 && flat_between(a, b, d)) ||
         (u == 0 && flat_between(c, d, a)) || (v == 0 && flat_between(c, d, b));
}

/** A tour through random points from which crossings are taken until there is none; false if that takes long.
 */
static inline bool flat_tour(flat *f, size_t n, int64_t size, vxm_rng *rng) {
  f->n = 0;
  for (size_t i = 0; i < n; i++)
    flat_add(f, (int64_t)vxm_rng_below(rng, (uint64_t)size), (int64_t)vxm_rng_below(rng, (uint64_t)size));
  for (int round = 0; round < 300; round++) {
    bool is_simple = true;
    for (size_t i = 0; i < n; i++)
      for (size_t j = i + 2; j < n; j++) {
        if ((i == 0 && j == n - 1) || !flat_meet(f->at[i], f->at[i + 1], f->at[j], f->at[(j + 1) % n]))
          continue;
        is_simple = false;
        for (size_t a = i + 1, b = j; a < b; a++, b--)
          for (int c = 0; c < 2; c++) {
            int64_t kept = f->at[a][c];
            f->at[a][c] = f->at[b][c];
            f->at[b][c] = kept;
          }
      }
    if (is_simple)
      return flat_area(f) != 0;
  }
  return false;
}

/* ---- Heaps of cells, with holes ---- */

enum { FLAT_SIDE = 12, FLAT_NODES = FLAT_SIDE + 1 };

/** Cells of a square lattice, of which the rim is to become one polygon. */
typedef struct heap {
  bool cell[FLAT_SIDE][FLAT_SIDE];
  bool is_used[FLAT_NODES][FLAT_NODES][4]; /**< the edge from a node in a direction has been taken */
  bool is_met[FLAT_NODES][FLAT_NODES];     /**< the polygon comes by a node */
} heap;

static const int flat_step[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

static inline bool heap_has(const heap *h, int64_t x, int64_t y) {
  return x >= 0 && y >= 0 && x < FLAT_SIDE && y < FLAT_SIDE && h->cell[y][x];
}

/** The cells beside the edge from a node along an axis (0 to 3: right, up, left, down). */
static inline void heap_sides(const heap *h, const int64_t at[2], int way, bool *left, bool *right) {
  static const int to_left[4][2] = {{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
  static const int to_right[4][2] = {{0, -1}, {0, 0}, {-1, 0}, {-1, -1}};
  *left = heap_has(h, at[0] + to_left[way][0], at[1] + to_left[way][1]);
  *right = heap_has(h, at[0] + to_right[way][0], at[1] + to_right[way][1]);
}

static inline void heap_grow(heap *h, size_t cells, vxm_rng *rng) {
  memset(h, 0, sizeof *h);
  h->cell[FLAT_SIDE / 2][FLAT_SIDE / 2] = true;
  for (size_t count = 1; count < cells;) {
    int64_t x = (int64_t)vxm_rng_below(rng, FLAT_SIDE), y = (int64_t)vxm_rng_below(rng, FLAT_SIDE);
    int beside =
        heap_has(h, x + 1, y) + heap_has(h, x - 1, y) + heap_has(h, x, y + 1) + heap_has(h, x, y - 1);
    if (h->cell[y][x] || beside == 0 || (beside > 1 && vxm_rng_below(rng, 3)))
      continue;
    h->cell[y][x] = true;
    count++;
  }
}

/** Follows the rim, cells to the left, from an edge to the right on; where two cells touch at a node, either
 * way. */
static inline void heap_trace(flat *f, heap *h, int64_t x, int64_t y, vxm_rng *rng) {
  static const int turns[2][3] = {{3, 0, 1}, {1, 0, 3}};
  int64_t at[2] = {x, y};
  f->n = 0;
  for (int way = 0; way >= 0;) {
    h->is_used[at[1]][at[0]][way] = true;
    flat_add(f, at[0], at[1]);
    for (int c = 0; c < 2; c++)
      at[c] += flat_step[2 * way][c];
    const int *turn = turns[vxm_rng_below(rng, 2)], last = way;
    way = -1;
    for (int t = 0; t < 3 && way < 0; t++) {
      int next = (last + turn[t]) % 4;
      bool left, right;
      heap_sides(h, at, next, &left, &right);
      if (left && !right && !h->is_used[at[1]][at[0]][next])
        way = next;
    }
  }
}

/** One of eight directions, or -1 between a corner and itself. */
static inline int flat_way(const int64_t from[2], const int64_t to[2]) {
  for (int w = 0; w < 8; w++)
    if ((to[0] > from[0]) - (to[0] < from[0]) == flat_step[w][0] &&
        (to[1] > from[1]) - (to[1] < from[1]) == flat_step[w][1])
      return w;
  return -1;
}

/** Whether a direction leads from corner i into the polygon. */
static inline bool flat_leads_in(const flat *f, size_t i, int way) {
  int next = flat_way(f->at[i], f->at[(i + 1) % f->n]),
      last = flat_way(f->at[i], f->at[(i + f->n - 1) % f->n]);
  int wedge = (last - next + 8) % 8;
  wedge = wedge == 0 ? 8 : wedge;
  int turn = (way - next + 8) % 8;
  return turn > 0 && turn < wedge;
}

static inline void flat_insert(flat *f, size_t place, const int64_t (*corners)[2], size_t count) {
  assert_true(f->n + count <= FLAT_MAX);
  memmove(f->at[place + count], f->at[place], (f->n - place) * sizeof *f->at);
  memcpy(f->at[place], corners, count * sizeof *f->at);
  f->n += count;
}

/** Joins a hole to the rim: there along `path`, round the hole, and back. */
static inline void heap_join(flat *f, const flat *hole, const int64_t (*path)[2], size_t steps) {
  static int64_t detour[FLAT_MAX][2];
  const int64_t *from = path[0], *to = path[steps];
  size_t count = 0, i = 0, j = 0;
  while (memcmp(f->at[i], from, sizeof *f->at) || !flat_leads_in(f, i, flat_way(from, path[1])))
    i++;
  while (memcmp(hole->at[j], to, sizeof *f->at) || !flat_leads_in(hole, j, flat_way(to, path[steps - 1])))
    j++;
  for (size_t k = 1; k < steps; k++, count++)
    memcpy(detour[count], path[k], sizeof *detour);
  for (size_t k = 0; k <= hole->n; k++, count++)
    memcpy(detour[count], hole->at[(j + k) % hole->n], sizeof *detour);
  for (size_t k = steps; k-- > 1; count++)
    memcpy(detour[count], path[k], sizeof *detour);
  memcpy(detour[count++], from, sizeof *detour);
  flat_insert(f, i + 1, (const int64_t(*)[2])detour, count);
}

/** Looks for the shortest way along edges between cells from the polygon to another rim; returns its steps.
 */
static inline size_t heap_way(int64_t path[][2], const heap *h, bool goal[FLAT_NODES][FLAT_NODES]) {
  static int64_t queue[FLAT_NODES * FLAT_NODES][2];
  static int back[FLAT_NODES][FLAT_NODES];
  size_t begin = 0, end = 0;
  memset(back, -1, sizeof back);
  for (int64_t y = 0; y < FLAT_NODES; y++)
    for (int64_t x = 0; x < FLAT_NODES; x++)
      if (h->is_met[y][x]) {
        queue[end][0] = x;
        queue[end++][1] = y;
        back[y][x] = 4;
      }
  for (; begin < end; begin++) {
    const int64_t *at = queue[begin];
    for (int way = 0; way < 4; way++) {
      bool left, right;
      heap_sides(h, at, way, &left, &right);
      int64_t x = at[0] + flat_step[2 * way][0], y = at[1] + flat_step[2 * way][1];
      if (!left || !right || back[y][x] >= 0)
        continue;
      back[y][x] = way;
      queue[end][0] = x;
      queue[end++][1] = y;
      if (!goal[y][x])
        continue;
      size_t steps = 0;
      for (int64_t p[2] = {x, y};; steps++) {
        memcpy(path[steps], p, sizeof p);
        int from = back[p[1]][p[0]];
        if (from == 4)
          break;
        p[0] -= flat_step[2 * from][0];
        p[1] -= flat_step[2 * from][1];
      }
      for (size_t a = 0, b = steps; a < b; a++, b--)
        for (int c = 0; c < 2; c++) {
          int64_t kept = path[a][c];
          path[a][c] = path[b][c];
          path[b][c] = kept;
        }
      return steps;
    }
  }
  return 0;
}

static inline void heap_mark(bool met[FLAT_NODES][FLAT_NODES], const flat *f) {
  for (size_t i = 0; i < f->n; i++)
    met[f->at[i][1]][f->at[i][0]] = true;
}

/** All rims of the heap as one polygon; false if two of them touch where no way is left between them. */
static inline bool heap_outline(flat *f, heap *h, vxm_rng *rng) {
  static flat rims[FLAT_SIDE * FLAT_SIDE];
  static int64_t path[FLAT_NODES * FLAT_NODES][2];
  size_t count = 0;
  for (int64_t y = 0; y < FLAT_NODES; y++)
    for (int64_t x = 0; x < FLAT_NODES; x++) {
      const int64_t at[2] = {x, y};
      bool left, right;
      heap_sides(h, at, 0, &left, &right);
      if (left && !right && !h->is_used[y][x][0])
        heap_trace(&rims[count++], h, x, y, rng);
    }
  *f = rims[0];
  heap_mark(h->is_met, f);
  while (count > 1) {
    bool goal[FLAT_NODES][FLAT_NODES] = {{false}};
    for (size_t r = 1; r < count; r++)
      heap_mark(goal, &rims[r]);
    size_t steps = heap_way(path, h, goal), r = 1, i = 0;
    if (steps == 0)
      return false;
    int way = flat_way(path[steps], path[steps - 1]);
    for (; r < count; r++) {
      for (i = 0; i < rims[r].n; i++)
        if (memcmp(rims[r].at[i], path[steps], sizeof path[steps]) == 0 && flat_leads_in(&rims[r], i, way))
          break;
      if (i < rims[r].n)
        break;
    }
    heap_join(f, &rims[r], (const int64_t(*)[2])path, steps);
    rims[r] = rims[--count];
    heap_mark(h->is_met, f);
  }
  return true;
}

/** Doubles all lengths, to make room for spikes to the middles of cells, and sets some. */
static inline void flat_spikes(flat *f, size_t count, vxm_rng *rng) {
  for (size_t i = 0; i < f->n; i++)
    for (int c = 0; c < 2; c++)
      f->at[i][c] *= 2;
  for (size_t s = 0; s < count; s++) {
    size_t i = (size_t)vxm_rng_below(rng, f->n);
    int way = 1 + 2 * (int)vxm_rng_below(rng, 4);
    bool is_free = true; /* outside of all that come by here */
    for (size_t k = 0; k < f->n; k++) {
      bool is_here = memcmp(f->at[k], f->at[i], sizeof *f->at) == 0;
      bool is_along = is_here && (flat_way(f->at[k], f->at[(k + 1) % f->n]) == way ||
                                  flat_way(f->at[k], f->at[(k + f->n - 1) % f->n]) == way);
      if (is_along ||
          (f->at[k][0] == f->at[i][0] + flat_step[way][0] && f->at[k][1] == f->at[i][1] + flat_step[way][1]))
        way = -1;
      if (way < 0)
        break;
      is_free = is_free && !(is_here && flat_leads_in(f, k, way));
    }
    if (way < 0 || !(is_free || flat_leads_in(f, i, way)))
      continue;
    const int64_t detour[2][2] = {{f->at[i][0] + flat_step[way][0], f->at[i][1] + flat_step[way][1]},
                                  {f->at[i][0], f->at[i][1]}};
    flat_insert(f, i + 1, detour, 2);
  }
}

/** Takes out corners in line, and doubles others, by chance. */
static inline void flat_thin_out(flat *f, vxm_rng *rng) {
  for (size_t i = 0; i < f->n && f->n > 6; i++) {
    size_t a = (i + f->n - 1) % f->n, c = (i + 1) % f->n;
    int before = flat_way(f->at[a], f->at[i]), after = flat_way(f->at[i], f->at[c]);
    if (before >= 0 && before == after && vxm_rng_below(rng, 2)) {
      memmove(f->at[i], f->at[i + 1], (f->n - i - 1) * sizeof *f->at);
      f->n--;
    }
  }
}

static inline void flat_repeat(flat *f, size_t count, vxm_rng *rng) {
  for (size_t s = 0; s < count; s++) {
    size_t i = (size_t)vxm_rng_below(rng, f->n);
    const int64_t again[1][2] = {{f->at[i][0], f->at[i][1]}};
    flat_insert(f, i, again, 1);
  }
}

/** The outline of a heap of cells, joined to those of its holes; with spikes, corners in line and repeated
 * ones, and edges that run there and back. */
static inline bool flat_cells(flat *f, vxm_rng *rng) {
  static heap h;
  heap_grow(&h, 2 + (size_t)vxm_rng_below(rng, 90), rng);
  if (!heap_outline(f, &h, rng))
    return false;
  flat_spikes(f, (size_t)vxm_rng_below(rng, 8), rng);
  if (vxm_rng_below(rng, 2))
    flat_thin_out(f, rng);
  flat_repeat(f, (size_t)vxm_rng_below(rng, 4), rng);
  return true;
}

/** Shears and turns a polygon by whole numbers; areas keep their signs or all change them. */
static inline void flat_map(flat *f, vxm_rng *rng) {
  static const int64_t maps[8][4] = {{1, 0, 0, 1},  {0, -1, 1, 0}, {2, 1, 1, 1}, {1, 3, 0, 1},
                                     {3, -2, 1, 5}, {1, 1, -1, 1}, {0, 1, 1, 0}, {-7, 2, 3, 1}};
  const int64_t *m = maps[vxm_rng_below(rng, 8)];
  for (size_t i = 0; i < f->n; i++) {
    int64_t x = f->at[i][0], y = f->at[i][1];
    f->at[i][0] = m[0] * x + m[1] * y;
    f->at[i][1] = m[2] * x + m[3] * y;
  }
}

/** One of the above, or false. */
static inline bool flat_random(flat *f, vxm_rng *rng, int kind) {
  bool is_made = true;
  if (kind % 8 == 0)
    flat_star(f, 4 + (size_t)vxm_rng_below(rng, 40), 1000 + (int64_t)vxm_rng_below(rng, 1000), rng);
  else if (kind % 8 == 1)
    flat_comb(f, 1 + (int)vxm_rng_below(rng, 20), 1 + (int64_t)vxm_rng_below(rng, 30));
  else if (kind % 8 == 2)
    is_made = flat_tour(f, 4 + (size_t)vxm_rng_below(rng, 30), 60, rng);
  else if (kind % 8 == 3)
    is_made = flat_tour(f, 4 + (size_t)vxm_rng_below(rng, 30), 1000, rng);
  else
    is_made = flat_cells(f, rng);
  return is_made && flat_area(f) != 0;
}

#endif
