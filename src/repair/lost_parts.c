/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/lost_parts.h"

#include "base/hash.h"
#include "mesh/components.h"
#include "mesh/edges.h"
#include "mesh/frame.h"
#include "mesh/weld.h"

#include <math.h>
#include <stdlib.h>

enum { PARTS_ASKED = 1 << 15, CELLS_MAX = 256 };

/** Of what a part enclosed: with no more than this gone it is not lost. */
static const double LOST = 0.01;

/** Of the longest side of the bounds: what is not thicker is between faces that lie on each other. */
static const double NO_DEPTH = 1e-7;

/** A line along the axis that is asked, through the box of a part. */
typedef struct line {
  double at[2];
  uint32_t part;
} line;

typedef struct crossing {
  size_t line;
  uint32_t part;
  int turn; /**< -1 where the line enters, 1 where it leaves */
  double height;
} crossing;

typedef struct crossings {
  crossing *items;
  size_t count, room;
} crossings;

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
  size_t *begin, *in_cell; /**< lines by cell */
  size_t cells;            /**< along each side */
  crossings of_before, of_after;
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
  size_t step = a->parts / PARTS_ASKED + 1;
  a->line_count = 0;
  for (size_t p = 0; p < a->parts; p += step) {
    const double *box = a->box + 6 * p;
    for (size_t i = 0; i < a->per_side * a->per_side && !a->open[p] && box[a->u] <= box[a->u + 3]; i++) {
      uint64_t key = (p * 3 + (uint64_t)a->axis) << 16 | i << 1;
      double x = ((double)(i % a->per_side) + scatter(key)) / (double)a->per_side;
      double y = ((double)(i / a->per_side) + scatter(key + 1)) / (double)a->per_side;
      a->lines[a->line_count++] =
          (line){{box[a->u] + x * (box[a->u + 3] - box[a->u]), box[a->v] + y * (box[a->v + 3] - box[a->v])},
                 (uint32_t)p};
    }
  }
}

static size_t cell_along(const asking *a, int axis, double x) {
  double side = a->bounds[axis + 3] - a->bounds[axis];
  double cell = side > 0 ? (x - a->bounds[axis]) / side * (double)a->cells : 0;
  return cell > 0 ? (cell < (double)(a->cells - 1) ? (size_t)cell : a->cells - 1) : 0;
}

static void sort_lines(asking *a) {
  size_t cells = a->cells * a->cells;
  for (size_t c = 0; c <= cells; c++)
    a->begin[c] = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t l = 0; l < a->line_count; l++) {
      size_t cell =
          cell_along(a, a->v, a->lines[l].at[1]) * a->cells + cell_along(a, a->u, a->lines[l].at[0]);
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

static bool note_crossing(asking *a, crossings *list, const vxm_soup *soup, const uint32_t v[3], size_t l,
                          uint32_t part) {
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
  if (list->count == list->room) {
    void *block = list->items;
    if (vxm_grow(a->context, &block, &list->room, list->count + 1, sizeof *list->items, &a->error) != VXM_OK)
      return false;
    list->items = block;
  }
  double height = weight != 0 ? sum / weight : vxm_position(soup, v[0])[a->axis];
  list->items[list->count++] = (crossing){l, part, weight > 0 ? 1 : -1, height};
  return true;
}

/** @param own faces tell only of the lines through their own part */
static bool cross_triangle(asking *a, crossings *list, const vxm_soup *soup, const uint32_t v[3],
                           uint32_t part, bool own) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int c = 0; c < 3; c++) {
    const double *p = vxm_position(soup, v[c]);
    if (!vxm_is_finite(p))
      return true;
    low[0] = fmin(low[0], p[a->u]), high[0] = fmax(high[0], p[a->u]);
    low[1] = fmin(low[1], p[a->v]), high[1] = fmax(high[1], p[a->v]);
  }
  size_t left = cell_along(a, a->u, low[0]), right = cell_along(a, a->u, high[0]);
  size_t top = cell_along(a, a->v, high[1]);
  for (size_t j = cell_along(a, a->v, low[1]); j <= top; j++)
    for (size_t i = a->begin[j * a->cells + left]; i < a->begin[j * a->cells + right + 1]; i++) {
      size_t l = a->in_cell[i];
      if ((!own || a->lines[l].part == part) && !note_crossing(a, list, soup, v, l, part))
        return false;
    }
  return true;
}

static bool cross_soup(asking *a, crossings *list, const vxm_soup *soup, const uint32_t *parts, bool own) {
  list->count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t c = 2; c < count; c++)
      if (!cross_triangle(a, list, soup, (uint32_t[]){corner[0], corner[c - 1], corner[c]}, parts[f], own))
        return false;
  }
  return true;
}

static int by_line_part_height(const void *a, const void *b) {
  const crossing *p = a, *q = b;
  if (p->line != q->line)
    return p->line < q->line ? -1 : 1;
  if (p->part != q->part)
    return p->part < q->part ? -1 : 1;
  return p->height < q->height ? -1 : p->height > q->height;
}

/* ---- Comparing ---- */

/** The crossings of one part with one line. */
typedef struct stretch {
  const crossing *begin, *end;
  bool winds, alternates; /**< with respect to winding, and to parity, it ends outside */
} stretch;

static stretch next_stretch(const crossing *begin, const crossing *end) {
  stretch s = {.begin = begin, .end = begin};
  int sum = 0;
  for (; s.end < end && s.end->line == begin->line && s.end->part == begin->part; s.end++)
    sum += s.end->turn;
  s.winds = sum == 0;
  s.alternates = (s.end - s.begin) % 2 == 0;
  return s;
}

/** How much of the way from `low` to `high` is inside one of the parts that the line meets; they may overlap,
 * so the way is gone along from end to end of what covers it. */
static double covered(const crossing *begin, const crossing *end, double low, double high) {
  double at = low, sum = 0;
  while (at < high) {
    double reach = at, next = high;
    for (const crossing *c = begin; c < end;) {
      stretch s = next_stretch(c, end);
      int winding = 0;
      for (const crossing *k = s.begin; k + 1 < s.end; k++) {
        winding += k->turn;
        bool inside = (s.winds && winding != 0) || (s.alternates && (k - s.begin) % 2 == 0);
        if (inside && k->height <= at && k[1].height > reach)
          reach = k[1].height;
        if (inside && k->height > at && k->height < next)
          next = k->height;
      }
      c = s.end;
    }
    sum += reach > at ? fmin(reach, high) - at : 0;
    at = reach > at ? reach : next;
  }
  return sum;
}

static bool is_clear(const crossing *begin, const crossing *end) {
  for (const crossing *c = begin; c < end;) {
    stretch s = next_stretch(c, end);
    if (!s.winds && !s.alternates)
      return false;
    c = s.end;
  }
  return true;
}

/** @param begin, end what the line meets afterwards */
static void compare_line(asking *a, stretch before, const crossing *begin, const crossing *end) {
  uint32_t part = before.begin->part;
  int winding = 0;
  for (const crossing *k = before.begin; k + 1 < before.end; k++) {
    double low = k->height, high = k[1].height;
    winding += k->turn;
    const bool inside[2] = {before.winds && winding != 0, before.alternates && (k - before.begin) % 2 == 0};
    if ((!inside[0] && !inside[1]) || !(high - low > a->no_depth))
      continue;
    double left = high - low - covered(begin, end, low, high);
    for (int kind = 0; kind < 2; kind++) {
      a->inside[2 * part + (size_t)kind] += inside[kind] ? high - low : 0;
      a->gone[2 * part + (size_t)kind] += inside[kind] ? left : 0;
    }
  }
}

static void compare(asking *a) {
  static const crossing none;
  const crossing *b = a->of_before.count > 0 ? a->of_before.items : &none, *b_end = b + a->of_before.count;
  const crossing *c = a->of_after.count > 0 ? a->of_after.items : &none, *c_end = c + a->of_after.count;
  while (b < b_end) {
    stretch s = next_stretch(b, b_end);
    while (c < c_end && c->line < b->line)
      c++;
    const crossing *end = c;
    while (end < c_end && end->line == b->line)
      end++;
    if (is_clear(c, end))
      compare_line(a, s, c, end);
    b = s.end;
  }
}

static bool ask_axis(asking *a, int axis) {
  a->axis = axis;
  a->u = (axis + 1) % 3;
  a->v = (axis + 2) % 3;
  place_lines(a);
  sort_lines(a);
  if (!cross_soup(a, &a->of_before, a->before, a->part_before, true) ||
      !cross_soup(a, &a->of_after, a->after, a->part_after, false))
    return false;
  if (a->of_before.count > 0)
    qsort(a->of_before.items, a->of_before.count, sizeof *a->of_before.items, by_line_part_height);
  if (a->of_after.count > 0)
    qsort(a->of_after.items, a->of_after.count, sizeof *a->of_after.items, by_line_part_height);
  compare(a);
  return true;
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
  a->in_cell = a->lines ? vxm_alloc(a->context, lines, sizeof *a->in_cell, &a->error) : NULL;
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
  vxm_free(a.context, a.of_after.items);
  vxm_free(a.context, a.of_before.items);
  vxm_free(a.context, a.begin);
  vxm_free(a.context, a.in_cell);
  vxm_free(a.context, a.lines);
  vxm_free(a.context, a.gone);
  vxm_free(a.context, a.inside);
  vxm_free(a.context, a.box);
  vxm_free(a.context, a.part_after);
  vxm_free(a.context, a.open);
  if (!done && error)
    *error = a.error;
  return done ? VXM_OK : a.error.code;
}

void vxm_lost_parts_free(vxm_lost_parts *lost, vxm_context *context) {
  vxm_free(context, lost->lost);
  vxm_free(context, lost->face_part);
  *lost = (vxm_lost_parts){0};
}
