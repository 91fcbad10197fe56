/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/lost_parts.h"

#include "base/hash.h"
#include "mesh/components.h"
#include "mesh/edges.h"
#include "mesh/unit_scale.h"
#include "mesh/weld.h"
#include "repair/state/line_spans.h"

#include <math.h>

enum {
  PARTS_ASKED = 1 << 15,
  CELLS_MAX = 256,
  /* Of thousands of plates every line may meet all: beyond either, every second line is left out. */
  CROSSINGS_MAX = 1 << 20, /**< crossings of lines with triangles that are kept */
  TESTS_MAX = 1 << 27,     /**< tests of a triangle with a line */
  ASK_TESTS = 1 << 18      /**< between two questions whether to go on */
};

/** Of what a part enclosed: with no more than this gone it is not lost. */
static const double LOST = 0.01;

/** Of the longest side of the bounds: what is not thicker is between faces that lie on each other. */
static const double NO_DEPTH = 1e-7;

/** A line along the axis that is asked, through the box of a part. */
typedef struct line {
  double at[2];
  uint32_t part;
} line;

typedef struct asking {
  vxm_context *context;
  const vxm_soup *before, *after;
  const uint32_t *part_before;
  uint8_t *open; /**< per part of `before` */
  uint32_t *part_after;
  size_t parts, per_side; /**< lines through a part: per_side x per_side along each axis */
  double *box;            /**< per part: x0 y0 z0 x1 y1 z1 */
  double bounds[6], no_depth;
  int axis, u, v;
  line *lines;
  size_t line_count;
  size_t step;             /**< of the lines only those whose number it divides are asked */
  size_t *first_line;      /**< per part of `before`, or SIZE_MAX */
  size_t *begin, *in_cell; /**< lines by cell */
  size_t cells;            /**< along each side */
  size_t tests, ask_after;
  vxm_line_crossings of_before, of_after;
  vxm_spans covered;     /**< on one line, by parts of `after` */
  double *inside, *gone; /**< per part, twice: length by winding and by parity */
  vxm_lost_parts *out;
  vxm_error error;
} asking;

/* ---- Parts and lines ---- */

/** Which parts have an edge with an odd number of sides: those enclose nothing for sure. */
static vxm_status find_open(const vxm_soup *soup, const uint32_t *map, const uint32_t *part, uint8_t *open,
                            vxm_error *error) {
  vxm_edges edges;
  vxm_status status = vxm_edges_build(&edges, soup->context, soup, map, error);
  uint32_t *part_at =
      status == VXM_OK ? vxm_alloc(soup->context, soup->vertex_count, sizeof *part_at, error) : NULL;
  if (part_at) {
    for (size_t f = 0; f < soup->face_count; f++)
      for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
        part_at[map[soup->indices[c]]] = part[f];
    for (size_t e = 0; e < edges.count; e++)
      if (vxm_edge_is_odd(&edges.edges[e]))
        open[part_at[edges.edges[e].a]] = 1;
  } else if (status == VXM_OK)
    status = error->code;
  vxm_free(soup->context, part_at);
  vxm_edges_destroy(&edges);
  return status;
}

/** @param[out] open per part, owned by the caller; NULL = it is not asked for */
static vxm_status find_parts(const vxm_soup *soup, uint32_t *part, size_t *count, uint8_t **open,
                             vxm_error *error) {
  uint32_t *map = vxm_alloc(soup->context, soup->vertex_count, sizeof *map, error);
  if (!map)
    return error->code;
  vxm_status status = vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, error);
  if (status == VXM_OK)
    status = vxm_components(soup->context, soup, map, part, count, error);
  if (status == VXM_OK && open) {
    *open = vxm_calloc(soup->context, *count, sizeof **open, error);
    status = *open ? find_open(soup, map, part, *open, error) : error->code;
  }
  vxm_free(soup->context, map);
  return status;
}

static void find_boxes(asking *a) {
  for (size_t i = 0; i < 6 * a->parts; i++)
    a->box[i] = i % 6 < 3 ? INFINITY : -INFINITY;
  for (size_t f = 0; f < a->before->face_count; f++)
    for (uint64_t c = a->before->offsets[f]; c < a->before->offsets[f + 1]; c++) {
      const double *p = vxm_position(a->before, a->before->indices[c]);
      double *box = a->box + 6 * (size_t)a->part_before[f];
      for (int x = 0; x < 3 && vxm_is_finite(p); x++) {
        box[x] = fmin(box[x], p[x]);
        box[x + 3] = fmax(box[x + 3], p[x]);
      }
    }
  for (size_t i = 0; i < 6; i++)
    a->bounds[i] = i < 3 ? INFINITY : -INFINITY;
  for (size_t p = 0; p < a->parts; p++)
    for (int x = 0; x < 3; x++) {
      a->bounds[x] = fmin(a->bounds[x], a->box[6 * p + (size_t)x]);
      a->bounds[x + 3] = fmax(a->bounds[x + 3], a->box[6 * p + (size_t)x + 3]);
    }
}

/** A number of 0 to 1 without a pattern, the same on every run: lines are to miss edges. */
static double scatter(uint64_t key) {
  return (double)(vxm_mix(key) >> 11) * 0x1p-53;
}

static void place_lines(asking *a) {
  size_t every = a->parts / PARTS_ASKED + 1; /* parts, of which one is asked */
  a->line_count = 0;
  a->step = 1;
  for (size_t p = 0; p < a->parts; p++)
    a->first_line[p] = SIZE_MAX;
  for (size_t p = 0; p < a->parts; p += every) {
    const double *box = a->box + 6 * p;
    a->first_line[p] = !a->open[p] && box[a->u] <= box[a->u + 3] ? a->line_count : SIZE_MAX;
    for (size_t i = 0; i < a->per_side * a->per_side && a->first_line[p] != SIZE_MAX; i++) {
      uint64_t key = (p * 3 + (uint64_t)a->axis) << 16 | i << 1;
      double x = ((double)(i % a->per_side) + scatter(key)) / (double)a->per_side;
      double y = ((double)(i / a->per_side) + scatter(key + 1)) / (double)a->per_side;
      a->lines[a->line_count++] =
          (line){{box[a->u] + x * (box[a->u + 3] - box[a->u]), box[a->v] + y * (box[a->v + 3] - box[a->v])},
                 (uint32_t)p};
    }
  }
}

/** @param box of a part, or of all */
static size_t cell_along(const double *box, size_t cells, int axis, double x) {
  double side = box[axis + 3] - box[axis];
  double cell = side > 0 ? (x - box[axis]) / side * (double)cells : 0;
  return cell > 0 ? (cell < (double)(cells - 1) ? (size_t)cell : cells - 1) : 0;
}

static void sort_lines(asking *a) {
  size_t cells = a->cells * a->cells;
  for (size_t c = 0; c <= cells; c++)
    a->begin[c] = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t l = 0; l < a->line_count; l += a->step) {
      size_t cell = cell_along(a->bounds, a->cells, a->v, a->lines[l].at[1]) * a->cells +
                    cell_along(a->bounds, a->cells, a->u, a->lines[l].at[0]);
      if (pass == 0)
        a->begin[cell + 1]++;
      else
        a->in_cell[a->begin[cell]++] = l;
    }
    for (size_t c = 0; c < cells && pass == 0; c++)
      a->begin[c + 1] += a->begin[c];
  }
  for (size_t c = cells; c > 0; c--)
    a->begin[c] = a->begin[c - 1];
  a->begin[0] = 0;
}

/* ---- Crossings ---- */

/** Whether an edge crosses the ray from the point along u, half open along v, from the lower to the higher
 * vertex so that faces agree on it. */
static bool edge_crosses(const asking *a, const vxm_soup *soup, uint32_t p, uint32_t q, const double at[2]) {
  const double *low = vxm_position(soup, p < q ? p : q), *high = vxm_position(soup, p < q ? q : p);
  double lv = low[a->v] - at[1], hv = high[a->v] - at[1];
  if ((lv > 0) == (hv > 0))
    return false;
  double turn = (low[a->u] - at[0]) * hv - (high[a->u] - at[0]) * lv;
  return hv > lv ? turn > 0 : turn < 0;
}

static bool note_crossing(asking *a, vxm_line_crossings *list, const vxm_soup *soup, const uint32_t v[3],
                          size_t l, uint32_t part) {
  const double *at = a->lines[l].at;
  bool covers = false;
  for (int c = 0; c < 3; c++)
    covers ^= edge_crosses(a, soup, v[c], v[(c + 1) % 3], at);
  if (!covers)
    return true;
  double weight = 0, sum = 0;
  for (int c = 0; c < 3; c++) {
    const double *p = vxm_position(soup, v[(c + 1) % 3]), *q = vxm_position(soup, v[(c + 2) % 3]);
    double part_weight = (p[a->u] - at[0]) * (q[a->v] - at[1]) - (p[a->v] - at[1]) * (q[a->u] - at[0]);
    weight += part_weight;
    sum += part_weight * vxm_position(soup, v[c])[a->axis];
  }
  double height = weight != 0 ? sum / weight : vxm_position(soup, v[0])[a->axis];
  const vxm_crossing crossing = {l, part, weight > 0 ? 1 : -1, height};
  return vxm_line_crossings_add(list, a->context, &crossing, &a->error) == VXM_OK;
}

/** Where a triangle lies across the axis; false if it has a corner that is not finite. */
static bool find_bounds(const asking *a, const vxm_soup *soup, const uint32_t v[3], double low[2],
                        double high[2]) {
  low[0] = low[1] = INFINITY;
  high[0] = high[1] = -INFINITY;
  for (int c = 0; c < 3; c++) {
    const double *p = vxm_position(soup, v[c]);
    if (!vxm_is_finite(p))
      return false;
    low[0] = fmin(low[0], p[a->u]), high[0] = fmax(high[0], p[a->u]);
    low[1] = fmin(low[1], p[a->v]), high[1] = fmax(high[1], p[a->v]);
  }
  return true;
}

/** Crosses a triangle of `before` with the lines through its own part: place_lines has put one into each
 * square of the box. */
static bool cross_before(asking *a, const uint32_t v[3], uint32_t part) {
  double low[2], high[2];
  const double *box = a->box + 6 * (size_t)part;
  if (a->first_line[part] == SIZE_MAX || !find_bounds(a, a->before, v, low, high))
    return true;
  size_t left = cell_along(box, a->per_side, a->u, low[0]),
         right = cell_along(box, a->per_side, a->u, high[0]);
  size_t top = cell_along(box, a->per_side, a->v, high[1]);
  for (size_t j = cell_along(box, a->per_side, a->v, low[1]); j <= top; j++)
    for (size_t i = left; i <= right; i++) {
      size_t l = a->first_line[part] + j * a->per_side + i;
      a->tests++;
      if (l % a->step == 0 && !note_crossing(a, &a->of_before, a->before, v, l, part))
        return false;
    }
  return true;
}

/** Crosses a triangle of `after` with all lines. */
static bool cross_after(asking *a, const uint32_t v[3], uint32_t part) {
  double low[2], high[2];
  if (!find_bounds(a, a->after, v, low, high))
    return true;
  size_t left = cell_along(a->bounds, a->cells, a->u, low[0]);
  size_t right = cell_along(a->bounds, a->cells, a->u, high[0]);
  size_t top = cell_along(a->bounds, a->cells, a->v, high[1]);
  for (size_t j = cell_along(a->bounds, a->cells, a->v, low[1]); j <= top; j++) {
    size_t begin = a->begin[j * a->cells + left], end = a->begin[j * a->cells + right + 1];
    a->tests += end - begin + 1;
    for (size_t i = begin; i < end; i++)
      if (!note_crossing(a, &a->of_after, a->after, v, a->in_cell[i], part))
        return false;
  }
  return true;
}

static void keep_lines(vxm_line_crossings *list, size_t step) {
  size_t kept = 0;
  for (size_t i = 0; i < list->count; i++)
    if (list->items[i].line % step == 0)
      list->items[kept++] = list->items[i];
  list->count = kept;
}

/** Leaves out every second line where they tell more than is needed; asks whether to go on. */
static bool thin(asking *a) {
  if (a->tests >= a->ask_after) {
    a->ask_after = a->tests + ASK_TESTS;
    if (vxm_check_cancelled(a->context, &a->error) != VXM_OK)
      return false;
  }
  if (a->step >= a->line_count ||
      (a->tests <= TESTS_MAX && a->of_before.count <= CROSSINGS_MAX && a->of_after.count <= CROSSINGS_MAX))
    return true;
  a->step *= 2;
  keep_lines(&a->of_before, a->step);
  keep_lines(&a->of_after, a->step);
  sort_lines(a);
  a->tests = a->ask_after = 0;
  return true;
}

static bool cross_soup(asking *a, const vxm_soup *soup, const uint32_t *parts,
                       bool (*cross)(asking *a, const uint32_t v[3], uint32_t part)) {
  a->tests = a->ask_after = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t c = 2; c < count; c++) {
      a->tests++;
      if (!cross(a, (uint32_t[]){corner[0], corner[c - 1], corner[c]}, parts[f]) || !thin(a))
        return false;
    }
  }
  return true;
}

/* ---- Comparing ---- */

static bool is_clear(const vxm_crossing *begin, const vxm_crossing *end) {
  for (const vxm_crossing *c = begin; c < end;) {
    vxm_stretch s = vxm_stretch_next(c, end);
    if (!s.winds && !s.alternates)
      return false;
    c = s.end;
  }
  return true;
}

static void compare_line(asking *a, vxm_stretch before) {
  uint32_t part = before.begin->part;
  size_t next = 0;
  int winding = 0;
  for (const vxm_crossing *k = before.begin; k + 1 < before.end; k++) {
    double low = k->height, high = k[1].height;
    winding += k->turn;
    const bool inside[2] = {before.winds && winding != 0, before.alternates && (k - before.begin) % 2 == 0};
    if ((!inside[0] && !inside[1]) || !(high - low > a->no_depth))
      continue;
    double left = high - low - vxm_spans_cover(&a->covered, &next, low, high);
    for (int kind = 0; kind < 2; kind++) {
      a->inside[2 * part + (size_t)kind] += inside[kind] ? high - low : 0;
      a->gone[2 * part + (size_t)kind] += inside[kind] ? left : 0;
    }
  }
}

static bool compare(asking *a) {
  static const vxm_crossing none;
  const vxm_crossing *b = a->of_before.count > 0 ? a->of_before.items : &none,
                     *b_end = b + a->of_before.count;
  const vxm_crossing *c = a->of_after.count > 0 ? a->of_after.items : &none, *c_end = c + a->of_after.count;
  while (b < b_end) {
    vxm_stretch s = vxm_stretch_next(b, b_end);
    while (c < c_end && c->line < b->line)
      c++;
    const vxm_crossing *end = c;
    while (end < c_end && end->line == b->line)
      end++;
    if (vxm_check_cancelled(a->context, &a->error) != VXM_OK)
      return false;
    if (is_clear(c, end)) {
      if (vxm_spans_find(&a->covered, a->context, c, end, &a->error) != VXM_OK)
        return false;
      compare_line(a, s);
    }
    b = s.end;
  }
  return true;
}

static bool ask_axis(asking *a, int axis) {
  a->axis = axis;
  a->u = (axis + 1) % 3;
  a->v = (axis + 2) % 3;
  a->of_before.count = a->of_after.count = 0;
  place_lines(a);
  sort_lines(a);
  if (!cross_soup(a, a->before, a->part_before, cross_before) ||
      !cross_soup(a, a->after, a->part_after, cross_after))
    return false;
  vxm_line_crossings_sort(&a->of_before);
  vxm_line_crossings_sort(&a->of_after);
  return compare(a);
}

/* ---- All of it ---- */

static bool prepare(asking *a) {
  size_t asked = a->parts < PARTS_ASKED ? a->parts : PARTS_ASKED, faces = a->after->face_count, parts;
  a->per_side = asked <= 64 ? 8 : asked <= 4096 ? 3 : 1;
  size_t lines = 2 * asked * a->per_side * a->per_side;
  a->cells = (size_t)sqrt((double)lines / 2) + 1;
  a->cells = a->cells < CELLS_MAX ? a->cells : CELLS_MAX;
  a->part_after = vxm_alloc(a->context, faces, sizeof *a->part_after, &a->error);
  a->box = a->part_after ? vxm_alloc(a->context, a->parts, 6 * sizeof *a->box, &a->error) : NULL;
  a->inside = a->box ? vxm_calloc(a->context, a->parts, 2 * sizeof *a->inside, &a->error) : NULL;
  a->gone = a->inside ? vxm_calloc(a->context, a->parts, 2 * sizeof *a->gone, &a->error) : NULL;
  a->lines = a->gone ? vxm_alloc(a->context, lines, sizeof *a->lines, &a->error) : NULL;
  a->first_line = a->lines ? vxm_alloc(a->context, a->parts, sizeof *a->first_line, &a->error) : NULL;
  a->in_cell = a->first_line ? vxm_alloc(a->context, lines, sizeof *a->in_cell, &a->error) : NULL;
  a->begin = a->in_cell ? vxm_alloc(a->context, a->cells * a->cells + 1, sizeof *a->begin, &a->error) : NULL;
  return a->begin && find_parts(a->after, a->part_after, &parts, NULL, &a->error) == VXM_OK;
}

static void judge(asking *a) {
  for (size_t p = 0; p < a->parts; p++)
    for (size_t kind = 2 * p; kind < 2 * p + 2; kind++)
      a->out->lost[p] |= a->gone[kind] > LOST * a->inside[kind];
  for (size_t p = 0; p < a->parts; p++)
    a->out->count += a->out->lost[p];
}

static bool ask(asking *a) {
  if (!prepare(a))
    return false;
  find_boxes(a);
  for (int x = 0; x < 3; x++)
    a->no_depth = fmax(a->no_depth, NO_DEPTH * (a->bounds[x + 3] - a->bounds[x]));
  for (int axis = 0; axis < 3; axis++)
    if (!ask_axis(a, axis))
      return false;
  judge(a);
  return true;
}

vxm_status vxm_lost_parts_find(vxm_lost_parts *out, const vxm_soup *before, const vxm_soup *after,
                               vxm_error *error) {
  *out = (vxm_lost_parts){0};
  asking a = {
      .context = before->context, .before = before, .after = after, .out = out, .error = VXM_ERROR_INIT};
  out->face_part = vxm_alloc(a.context, before->face_count, sizeof *out->face_part, &a.error);
  bool done =
      out->face_part && find_parts(before, out->face_part, &out->part_count, &a.open, &a.error) == VXM_OK;
  out->lost = done ? vxm_calloc(a.context, out->part_count, sizeof *out->lost, &a.error) : NULL;
  a.part_before = out->face_part;
  a.parts = out->part_count;
  done = out->lost && (a.parts == 0 || ask(&a));
  vxm_free(a.context, a.covered.items);
  vxm_free(a.context, a.of_after.items);
  vxm_free(a.context, a.of_before.items);
  vxm_free(a.context, a.begin);
  vxm_free(a.context, a.in_cell);
  vxm_free(a.context, a.first_line);
  vxm_free(a.context, a.lines);
  vxm_free(a.context, a.gone);
  vxm_free(a.context, a.inside);
  vxm_free(a.context, a.box);
  vxm_free(a.context, a.part_after);
  vxm_free(a.context, a.open);
  if (!done)
    vxm_error_pass(error, &a.error);
  return done ? VXM_OK : a.error.code;
}

void vxm_lost_parts_destroy(vxm_lost_parts *lost, vxm_context *context) {
  vxm_free(context, lost->lost);
  vxm_free(context, lost->face_part);
  *lost = (vxm_lost_parts){0};
}
