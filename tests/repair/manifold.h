/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether a soup is a manifold, by looking at everything; and soups that are none. */
#ifndef VXM_TESTS_MANIFOLD_H
#define VXM_TESTS_MANIFOLD_H

#include "../mesh/soups.h"

#include "mesh/weld.h"

typedef struct brute_side {
  uint32_t from, to;
  size_t face;
} brute_side;

static inline int compare_brute_sides(const void *a, const void *b) {
  const brute_side *p = a, *q = b;
  uint32_t pl = p->from < p->to ? p->from : p->to, ph = p->from < p->to ? p->to : p->from;
  uint32_t ql = q->from < q->to ? q->from : q->to, qh = q->from < q->to ? q->to : q->from;
  if (pl != ql)
    return pl < ql ? -1 : 1;
  if (ph != qh)
    return ph < qh ? -1 : 1;
  return p->from != q->from ? (p->from < q->from ? -1 : 1) : (p->face > q->face) - (p->face < q->face);
}

/** All sides, those along an edge together. */
static inline brute_side *list_brute_sides(const vxm_soup *soup) {
  brute_side *sides = malloc((soup->corner_count + 1) * sizeof *sides);
  assert_non_null(sides);
  size_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++)
      sides[count++] = (brute_side){corner[c], corner[(c + 1) % n], f};
  }
  qsort(sides, count, sizeof *sides, compare_brute_sides);
  return sides;
}

typedef struct brute_report {
  bool manifold;
  int64_t boundary_edges;
  int64_t unpaired; /**< over all edges, by how many the sides in one direction outnumber the others */
  int64_t complex_edges;
  int64_t complex_vertices;
} brute_report;

static inline int compare_ends(const void *a, const void *b) {
  const uint32_t *p = a, *q = b;
  return p[0] != q[0] ? (p[0] < q[0] ? -1 : 1) : (p[1] > q[1]) - (p[1] < q[1]);
}

/** Whether walks over edges at the vertex reach all its faces from the first. */
static inline bool has_one_umbrella(const vxm_soup *soup, uint32_t vertex, const size_t *faces,
                                    size_t count) {
  uint32_t(*ends)[2] = malloc((2 * count + 1) * sizeof *ends),
  *reached = malloc((count + 1) * sizeof *reached);
  assert_true(ends && reached);
  for (size_t i = 0; i < count; i++) {
    size_t n, at = 0;
    const uint32_t *corner = vxm_face(soup, faces[i], &n);
    while (corner[at] != vertex)
      at++;
    ends[2 * i][0] = corner[(at + n - 1) % n];
    ends[2 * i + 1][0] = corner[(at + 1) % n];
    ends[2 * i][1] = ends[2 * i + 1][1] = (uint32_t)i;
    reached[i] = (uint32_t)i;
  }
  qsort(ends, 2 * count, sizeof *ends, compare_ends);
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t k = 1; k < 2 * count; k++) {
      uint32_t *p = &reached[ends[k - 1][1]], *q = &reached[ends[k][1]];
      if (ends[k - 1][0] == ends[k][0] && *p != *q) {
        *p = *q = *p < *q ? *p : *q;
        changed = true;
      }
    }
  }
  bool all = true;
  for (size_t i = 0; i < count; i++)
    all = all && reached[i] == 0;
  free(reached);
  free(ends);
  return all;
}

/** Faces have at least three corners, all different. */
static inline brute_report look_brute(const vxm_soup *soup) {
  brute_report report = {.manifold = true};
  brute_side *sides = list_brute_sides(soup);
  for (size_t i = 0, j = 0; i < soup->corner_count; i = j) {
    int64_t forward = 0, backward = 0;
    for (j = i; j < soup->corner_count && (sides[j].from == sides[i].from ? sides[j].to == sides[i].to
                                                                          : sides[j].from == sides[i].to &&
                                                                                sides[j].to == sides[i].from);
         j++)
      *(sides[j].from < sides[j].to ? &forward : &backward) += 1;
    report.boundary_edges += forward + backward == 1;
    report.unpaired += forward > backward ? forward - backward : backward - forward;
    report.complex_edges += forward > 1 || backward > 1;
  }
  free(sides);
  size_t *begin = calloc(soup->vertex_count + 2, sizeof *begin),
         *faces = malloc((soup->corner_count + 1) * 8);
  assert_true(begin && faces);
  for (size_t c = 0; c < soup->corner_count; c++)
    begin[soup->indices[c] + 2]++;
  for (size_t v = 0; v < soup->vertex_count; v++)
    begin[v + 2] += begin[v + 1];
  for (size_t f = 0; f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      faces[begin[soup->indices[c] + 1]++] = f;
  for (uint32_t v = 0; v < soup->vertex_count; v++)
    report.complex_vertices += !has_one_umbrella(soup, v, faces + begin[v], begin[v + 1] - begin[v]);
  free(faces);
  free(begin);
  report.manifold = report.complex_edges == 0 && report.complex_vertices == 0;
  return report;
}

static inline double volume_of(const vxm_soup *soup) {
  double sum = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t i = 2; i < n; i++) {
      const double *a = vxm_position(soup, corner[0]), *b = vxm_position(soup, corner[i - 1]);
      const double *c = vxm_position(soup, corner[i]);
      sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
             a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
  }
  return sum / 6;
}

/** Puts the first vertex of each position in the place of the others, as a reader that welds does. */
static inline void weld_positions(vxm_soup *soup) {
  uint32_t *map = malloc((soup->vertex_count + 1) * sizeof *map);
  assert_non_null(map);
  assert_int_equal(vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, NULL),
                   VXM_OK);
  for (size_t c = 0; c < soup->corner_count; c++)
    soup->indices[c] = map[soup->indices[c]];
  free(map);
}

/* ---- Soups ---- */

/** The faces between the full cells of an n x n x n block and the others, on vertices that cells share. */
static inline vxm_soup *cell_surface(vxm_context *context, unsigned n, const uint8_t *full) {
  vxm_soup *soup = new_soup(context);
  unsigned row = n + 1;
  for (unsigned v = 0; v < row * row * row; v++)
    add_vertex(soup, v % row, v / row % row, v / (row * row));
  for (unsigned cell = 0; cell < n * n * n; cell++)
    for (int side = 0; side < 6 && full[cell]; side++) {
      unsigned at[3] = {cell % n, cell / n % n, cell / (n * n)}, axis = (unsigned)side >> 1, up = side & 1;
      unsigned step[3] = {1, n, n * n}, corner_step[3] = {1, row, row * row};
      bool at_end = up ? at[axis] == n - 1 : at[axis] == 0;
      if (!at_end && full[up ? cell + step[axis] : cell - step[axis]])
        continue;
      uint32_t base = at[0] + row * at[1] + row * row * at[2] + (up ? corner_step[axis] : 0);
      uint32_t u = corner_step[(axis + 1) % 3], v = corner_step[(axis + 2) % 3];
      uint32_t corners[4] = {base, base + (up ? u : v), base + u + v, base + (up ? v : u)};
      add_face(soup, corners, 4);
    }
  return soup;
}

/** The same faces in another order, starting from other corners, some of them turned, quads perhaps cut. */
static inline vxm_soup *shuffled(const vxm_soup *soup, vxm_rng *rng, double turned, bool cut) {
  vxm_soup *out = new_soup(soup->context);
  size_t *order = malloc((soup->face_count + 1) * sizeof *order);
  assert_non_null(order);
  for (size_t v = 0; v < soup->vertex_count; v++)
    add_vertex(out, vxm_position(soup, v)[0], vxm_position(soup, v)[1], vxm_position(soup, v)[2]);
  for (size_t i = 0; i < soup->face_count; i++) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    order[i] = order[j];
    order[j] = i;
  }
  for (size_t i = 0; i < soup->face_count; i++) {
    size_t n;
    const uint32_t *face = vxm_face(soup, order[i], &n);
    uint32_t corners[64];
    assert_true(n <= 64);
    size_t first = (size_t)vxm_rng_below(rng, n);
    bool turn = vxm_rng_unit(rng) < turned;
    for (size_t c = 0; c < n; c++)
      corners[c] = face[turn ? (first + n - c) % n : (first + c) % n];
    if (!cut)
      add_face(out, corners, n);
    for (size_t c = 2; c < n && cut; c++)
      add_triangle(out, corners[0], corners[c - 1], corners[c]);
  }
  free(order);
  return out;
}

/** Every face on vertices of its own. */
static inline vxm_soup *unshared(const vxm_soup *soup) {
  vxm_soup *out = new_soup(soup->context);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *face = vxm_face(soup, f, &n);
    uint32_t corners[64];
    assert_true(n <= 64);
    for (size_t c = 0; c < n; c++) {
      const double *p = vxm_position(soup, face[c]);
      corners[c] = (uint32_t)out->vertex_count;
      add_vertex(out, p[0], p[1], p[2]);
    }
    add_face(out, corners, n);
  }
  return out;
}

/** Faces of three to five different corners on a few vertices; some come twice, or turned. */
static inline vxm_soup *tangle(vxm_context *context, vxm_rng *rng, size_t vertices, size_t faces,
                               unsigned lattice) {
  vxm_soup *soup = new_soup(context);
  for (size_t v = 0; v < vertices; v++)
    add_vertex(soup, (double)vxm_rng_below(rng, lattice), (double)vxm_rng_below(rng, lattice),
               (double)vxm_rng_below(rng, lattice));
  for (size_t f = 0; f < faces; f++) {
    uint32_t corners[5];
    size_t n = vxm_rng_below(rng, 3) ? 3 : 3 + (size_t)vxm_rng_below(rng, vertices < 5 ? vertices - 2 : 3);
    for (size_t i = 0; i < n;) {
      corners[i] = (uint32_t)vxm_rng_below(rng, vertices);
      size_t j = 0;
      while (corners[j] != corners[i])
        j++;
      i += j == i;
    }
    add_face(soup, corners, n);
  }
  return soup;
}

static inline size_t count_components_brute(const vxm_soup *soup) {
  uint32_t *label = malloc((soup->vertex_count + 1) * sizeof *label);
  assert_non_null(label);
  for (size_t v = 0; v < soup->vertex_count; v++)
    label[v] = UINT32_MAX;
  for (size_t c = 0; c < soup->corner_count; c++)
    label[soup->indices[c]] = soup->indices[c];
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t f = 0; f < soup->face_count; f++)
      for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
        uint32_t *p = &label[soup->indices[c]], *q = &label[soup->indices[soup->offsets[f]]];
        if (*p != *q) {
          *p = *q = *p < *q ? *p : *q;
          changed = true;
        }
      }
  }
  size_t count = 0;
  for (size_t v = 0; v < soup->vertex_count; v++)
    count += label[v] == v;
  free(label);
  return count;
}

#endif
