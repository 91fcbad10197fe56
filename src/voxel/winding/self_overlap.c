/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/self_overlap.h"
#include "mesh/disjoint_sets.h"
#include "voxel/winding/probe_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  LINES_MOST = VXM_PROBE_MOST * VXM_PROBE_MOST,
  CROSSINGS_MOST = 1 << 16, /**< with more there are fewer lines */
  INSERTED_MOST = 32        /**< crossings of a line that are sorted by insertion */
};

/** Of the length inside: what is less is not worth the time, or comes of rounding. */
static const double noticed = 1e-5;
/** Of the same: what is left hollow, or filled, is worth a word if it is more. */
static const double told = 0.002;

typedef struct crossing {
  double at; /**< along the line */
  uint32_t line;
  int32_t sign;
} crossing;

typedef struct finder {
  const vxm_triangle_set *triangles;
  vxm_probe_places places[3]; /**< along each axis */
  vxm_probe_cell *cells;      /**< of each point */
  crossing *crossings;
  size_t count, capacity;
  crossing *sorted; /**< by line */
  size_t sorted_capacity, closed_capacity, part_capacity;
  int along; /**< the axis of the lines */
  uint32_t line_count;
  uint32_t ends[LINES_MOST + 1];
  bool contradicted; /**< some lines are entered more or less often than left */
  /* Of the others: */
  double length;              /**< wound around at all */
  double inside;              /**< length times number */
  double twice_out, twice_in; /**< lengths wound 2, 4, ... and -2, -4, ... times */
  double odd_out, odd_in;     /**< lengths wound 1, 3, ... and -1, -3, ... times */
  vxm_error error;
} finder;

/* ---- Which lines ---- */

static inline const double *position(const finder *f, uint32_t point) {
  return f->triangles->positions[point];
}

/** The points of a part. */
typedef struct points {
  uint32_t begin, end;
} points;

/** Points are numbered as triangles use them, part by part, and no two parts share one: the first of a part
 * is a corner of its first triangle. */
static points points_of(const vxm_triangle_set *triangles, size_t part) {
  size_t begin = triangles->parts[part].begin, end = triangles->parts[part].end;
  return (points){triangles->corners[begin][0], end < triangles->triangle_count
                                                    ? triangles->corners[end][0]
                                                    : (uint32_t)triangles->first_apex};
}

/** Lays lines; false if the points have no extent that could be told. Of the axes behind that of the lines
 * the first one is along rows of them, the second one across. */
static bool lay_lines(finder *f, points range, int even) {
  if (!vxm_probe_lines_lay(&f->along, f->places, f->cells + range.begin,
                           (const double(*)[3])f->triangles->positions + range.begin, range.end - range.begin,
                           even))
    return false;
  f->line_count = (uint32_t)(f->places[(f->along + 1) % 3].count * f->places[(f->along + 2) % 3].count);
  return true;
}

/* ---- Crossings ---- */

/** The axes of lines: along them, along a row of them, and across rows. */
typedef struct line_axes {
  int along, row, across;
} line_axes;

/** Where a side comes to a row of lines. */
typedef struct side_place {
  double along, row;
  int columns; /**< lines of the row before it */
} side_place;

static double clamped(double share) {
  return share < 0 ? 0 : share > 1 ? 1 : share;
}

/** The same whichever way the side runs. */
static side_place place_on(const vxm_probe_places *columns, line_axes axes, const double *p, const double *q,
                           double at) {
  const double *low = p[axes.across] < q[axes.across] ? p : q, *high = low == p ? q : p;
  double share = clamped((at - low[axes.across]) / (high[axes.across] - low[axes.across]));
  double row = low[axes.row] + share * (high[axes.row] - low[axes.row]);
  double least = p[axes.row] < q[axes.row] ? p[axes.row] : q[axes.row];
  double most = p[axes.row] < q[axes.row] ? q[axes.row] : p[axes.row];
  row = row < least ? least : row > most ? most : row;
  return (side_place){low[axes.along] + share * (high[axes.along] - low[axes.along]), row,
                      vxm_probe_below(columns, row)};
}

/** @param first the line of the row that lies first */
static bool add_row(finder *f, const vxm_probe_places *columns, uint32_t first, const side_place *from,
                    const side_place *to, int sign) {
  size_t more = (size_t)(to->columns - from->columns);
  if (vxm_grow(f->triangles->context, (void **)&f->crossings, &f->capacity, f->count + more,
               sizeof *f->crossings, &f->error) != VXM_OK)
    return false;
  for (int c = from->columns; c < to->columns; c++) {
    double share = clamped((columns->at[c] - from->row) / (to->row - from->row));
    f->crossings[f->count++] =
        (crossing){from->along + share * (to->along - from->along), first + (uint32_t)c, sign};
  }
  return true;
}

/** Crossings of a triangle: where its projection along the lines winds around one, with the sign of that. */
static bool add_triangle(finder *f, const uint32_t k[3]) {
  /* The corner that lies alone on its side of a row, by which corners lie above. */
  static const uint8_t alone[8] = {0, 0, 1, 2, 2, 1, 0, 0};
  const line_axes axes = {f->along, (f->along + 1) % 3, (f->along + 2) % 3};
  const vxm_probe_places *columns = &f->places[axes.row], *rows = &f->places[axes.across];
  int below[3], first = rows->count, end = 0;
  for (int i = 0; i < 3; i++) {
    below[i] = vxm_probe_along(f->cells[k[i]], axes.across);
    first = below[i] < first ? below[i] : first;
    end = below[i] > end ? below[i] : end;
  }
  for (int row = first; row < end; row++) {
    double at = rows->at[row];
    int above = (below[0] > row) | (below[1] > row) << 1 | (below[2] > row) << 2, i = alone[above];
    const double *tip = position(f, k[i]);
    side_place to = place_on(columns, axes, tip, position(f, k[i < 2 ? i + 1 : 0]), at);
    side_place from = place_on(columns, axes, tip, position(f, k[i > 0 ? i - 1 : 2]), at);
    int sign = below[i] > row ? 1 : -1; /* of a row that is entered at `from` and left at `to` */
    uint32_t line = (uint32_t)(row * columns->count);
    if (to.columns == from.columns)
      continue;
    if (!(to.columns > from.columns ? add_row(f, columns, line, &from, &to, sign)
                                    : add_row(f, columns, line, &to, &from, -sign)))
      return false;
  }
  return true;
}

static inline uint32_t places_between(const finder *f, const uint32_t k[3]) {
  return vxm_probe_between(f->cells[k[0]], f->cells[k[1]], f->cells[k[2]]);
}

/** Those of triangles begin..end-1, until they are more than CROSSINGS_MOST. */
static vxm_status find_crossings(finder *f, size_t begin, size_t end) {
  enum { AT_ONCE = 1024 };
  uint32_t(*corners)[3] = f->triangles->corners;
  f->count = 0;
  for (size_t first = begin; first < end && f->count <= CROSSINGS_MOST; first += AT_ONCE) {
    size_t wanted[AT_ONCE], count = 0, last = first + AT_ONCE < end ? first + AT_ONCE : end;
    for (size_t t = first; t < last; t++) { /* without a branch, as nobody can tell beforehand */
      uint32_t between = places_between(f, corners[t]);
      wanted[count] = t;
      count += (between & (between - 1)) != 0; /* both axes */
    }
    if (vxm_check_cancelled(f->triangles->context, &f->error) != VXM_OK)
      return f->error.code;
    for (size_t i = 0; i < count; i++)
      if (!add_triangle(f, corners[wanted[i]]))
        return f->error.code;
  }
  return VXM_OK;
}

/* ---- Along the lines ---- */

static vxm_status sort_by_line(finder *f) {
  size_t line_count = f->line_count;
  vxm_status status = vxm_renew(f->triangles->context, (void **)&f->sorted, &f->sorted_capacity, f->count,
                                sizeof *f->sorted, &f->error);
  if (status != VXM_OK)
    return status;
  memset(f->ends, 0, (line_count + 1) * sizeof *f->ends);
  for (size_t i = 0; i < f->count; i++)
    f->ends[f->crossings[i].line + 1]++;
  for (size_t line = 0; line < line_count; line++)
    f->ends[line + 1] += f->ends[line];
  for (size_t i = 0; i < f->count; i++) /* moves the beginning of each line to its end */
    f->sorted[f->ends[f->crossings[i].line]++] = f->crossings[i];
  return VXM_OK;
}

static int compare(const void *a, const void *b) {
  const crossing *p = a, *q = b;
  return (p->at > q->at) - (p->at < q->at);
}

static void sort_along(crossing *at, size_t count) {
  if (count > INSERTED_MOST) {
    qsort(at, count, sizeof *at, compare);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    crossing moved = at[i];
    size_t to = i;
    for (; to > 0 && at[to - 1].at > moved.at; to--)
      at[to] = at[to - 1];
    at[to] = moved;
  }
}

static int sum_of_signs(const crossing *at, size_t count) {
  int sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += at[i].sign;
  return sum;
}

/** Adds up one line, which stands for so much of what lies around it. */
static void follow(finder *f, const crossing *at, size_t count, double weight) {
  if (sum_of_signs(at, count) != 0) {
    f->contradicted = true;
    return;
  }
  int wound = 0;
  for (size_t i = 0; i < count; i++) {
    double length = wound ? weight * (at[i].at - at[i - 1].at) : 0;
    f->length += length;
    f->inside += wound * length;
    double *kind = wound % 2 == 0 ? &f->twice_in : &f->odd_in;
    if (wound > 0)
      kind = wound % 2 == 0 ? &f->twice_out : &f->odd_out;
    *kind += length;
    wound += at[i].sign;
  }
}

static void follow_all(finder *f) {
  const vxm_probe_places *columns = &f->places[(f->along + 1) % 3], *rows = &f->places[(f->along + 2) % 3];
  size_t line = 0, begin = 0;
  f->contradicted = false;
  f->length = f->inside = f->twice_out = f->twice_in = f->odd_out = f->odd_in = 0;
  for (int row = 0; row < rows->count; row++)
    for (int column = 0; column < columns->count; column++, line++) {
      size_t count = f->ends[line] - begin;
      sort_along(f->sorted + begin, count);
      follow(f, f->sorted + begin, count, columns->width[column] * rows->width[row]);
      begin = f->ends[line];
    }
}

static double twice_of(const finder *f) {
  return f->inside < 0 ? f->twice_in : f->twice_out;
}

/** Whether the part is wound twice somewhere, and nothing speaks against it that its faces are a chain. */
static bool is_overlapping(const finder *f) {
  return !f->contradicted && twice_of(f) > noticed * fabs(f->inside);
}

/** A part of which no chain was made: whether it is wound twice somewhere, and hollow. */
static void tell_of_hollow(vxm_self_overlap *out, const finder *f, size_t part) {
  if (!(twice_of(f) > told * f->length))
    return;
  double share = twice_of(f) / f->length;
  if (out->hollow_count++ == 0 || share > out->hollow_share) {
    out->hollow_share = share;
    out->hollow_part = part;
  }
}

/** Six times the volume of the cone from a corner of a part to a triangle of it. */
static double cone_of(const finder *f, const double *tip, const uint32_t k[3]) {
  double p[3][3];
  for (int i = 0; i < 3; i++)
    for (int a = 0; a < 3; a++)
      p[i][a] = position(f, k[i])[a] - tip[a];
  return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
         p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
         p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
}

/** How many components of a part, joined by points, are wound against what most of it is wound like. */
static vxm_status count_cavities(size_t *count, finder *f, size_t begin, size_t end, points range) {
  vxm_context *context = f->triangles->context;
  uint32_t(*corners)[3] = f->triangles->corners;
  size_t point_count = range.end - range.begin;
  uint32_t *set = vxm_alloc(context, point_count, sizeof *set, &f->error);
  double *volume = vxm_calloc(context, point_count, sizeof *volume, &f->error);
  *count = 0;
  for (size_t i = 0; set && volume && i < point_count; i++)
    set[i] = (uint32_t)i;
  for (size_t t = begin; set && volume && t < end; t++)
    for (int k = 1; k < 3; k++)
      vxm_set_unite_in_order(set, corners[t][0] - range.begin, corners[t][k] - range.begin);
  for (size_t t = begin; set && volume && t < end; t++)
    volume[vxm_set_of_u32(set, corners[t][0] - range.begin)] +=
        cone_of(f, position(f, range.begin), corners[t]);
  for (size_t i = 0; set && volume && i < point_count; i++)
    *count += volume[i] * f->inside < 0;
  vxm_free(context, volume);
  vxm_free(context, set);
  return f->error.code;
}

/** A part that is wound against itself: whether that comes of cavities that overlap. */
static vxm_status tell_of_filled(vxm_self_overlap *out, finder *f, size_t part, size_t begin, size_t end) {
  double against = f->inside < 0 ? f->odd_out : f->odd_in;
  size_t cavities;
  if (f->contradicted || !(against > told * f->length))
    return VXM_OK;
  vxm_status status = count_cavities(&cavities, f, begin, end, points_of(f->triangles, part));
  double share = against / f->length;
  if (status != VXM_OK || cavities < 2)
    return status;
  if (out->filled_count++ == 0 || share > out->filled_share) {
    out->filled_share = share;
    out->filled_part = part;
  }
  return VXM_OK;
}

/* ---- The chain ---- */

/** Adds a chain, of points that are numbered from the part's first one on. */
static vxm_status add_chain(vxm_self_overlap *out, finder *f, size_t part, const vxm_winding_chain *own,
                            uint32_t first_point) {
  vxm_winding_chain *all = &out->chain;
  vxm_status status = vxm_grow(all->context, (void **)&all->closed, &f->closed_capacity,
                               all->closed_count + own->closed_count, sizeof *all->closed, &f->error);
  if (status == VXM_OK)
    status = vxm_grow(all->context, (void **)&out->part, &f->part_capacity, out->part_count + 1,
                      sizeof *out->part, &f->error);
  for (size_t t = 0; t < own->closed_count && status == VXM_OK; t++)
    for (int k = 0; k < 3; k++)
      all->closed[all->closed_count + t][k] = own->closed[t][k] + first_point;
  if (status != VXM_OK)
    return status;
  all->closed_count += own->closed_count;
  out->part[out->part_count++] = part;
  return VXM_OK;
}

/** Adds triangles begin..end-1 of a part, turned outward, if they are a closed chain. */
static vxm_status add_part(vxm_self_overlap *out, finder *f, size_t part, size_t begin, size_t end) {
  vxm_context *context = f->triangles->context;
  vxm_winding_chain own;
  points range = points_of(f->triangles, part);
  size_t count = end - begin;
  uint32_t(*turned)[3] = vxm_alloc(context, count, sizeof *turned, &f->error);
  if (!turned)
    return f->error.code;
  for (size_t t = 0; t < count; t++)
    for (int k = 0; k < 3; k++)
      turned[t][k] = f->triangles->corners[begin + t][f->inside < 0 ? (3 - k) % 3 : k] - range.begin;
  vxm_status status = vxm_winding_chain_create(&own, context, (const uint32_t(*)[3])turned, count,
                                               range.end - range.begin, &f->error);
  if (status == VXM_OK && own.rest_count == 0)
    status = add_chain(out, f, part, &own, range.begin);
  vxm_winding_chain_destroy(&own);
  vxm_free(context, turned);
  return status;
}

static vxm_status look_at_part(vxm_self_overlap *out, finder *f, size_t part) {
  size_t begin = f->triangles->parts[part].begin, end = f->triangles->parts[part].cones;
  if (begin == end)
    return VXM_OK;
  points range = points_of(f->triangles, part);
  /* Of few triangles those of cavities are large, and may meet in a small place. */
  double wanted = f->triangles->split.cavity_count > 0 ? VXM_PROBE_EVEN : sqrt((double)(end - begin)) / 4 + 4;
  int even = (int)fmin(wanted, VXM_PROBE_EVEN) / 2 * 2;
  vxm_status status = VXM_OK;
  do {
    if (!lay_lines(f, range, even))
      return VXM_OK;
    status = find_crossings(f, begin, end);
    even = even / 4 * 2; /* an even number, too */
  } while (status == VXM_OK && f->count > CROSSINGS_MOST && even > 0);
  if (status != VXM_OK || f->count > CROSSINGS_MOST)
    return status;
  status = sort_by_line(f);
  if (status != VXM_OK)
    return status;
  size_t added = out->part_count;
  follow_all(f);
  if (is_overlapping(f))
    status = add_part(out, f, part, begin, end);
  if (out->part_count == added)
    tell_of_hollow(out, f, part);
  return status == VXM_OK ? tell_of_filled(out, f, part, begin, end) : status;
}

vxm_status vxm_self_overlap_find(vxm_self_overlap *out, const vxm_triangle_set *triangles, vxm_error *error) {
  vxm_context *context = triangles->context;
  *out = (vxm_self_overlap){.chain = {.context = context}};
  size_t parts = triangles->split.kind_end[VXM_PART_CAPPED];
  if (parts == 0)
    return VXM_OK;
  finder f = {.triangles = triangles, .error = VXM_ERROR_INIT};
  f.cells = vxm_alloc(context, triangles->first_apex, sizeof *f.cells, &f.error);
  vxm_status status = f.error.code;
  for (size_t p = 0; p < parts && status == VXM_OK; p++)
    status = look_at_part(out, &f, p);
  vxm_free(context, f.cells);
  vxm_free(context, f.crossings);
  vxm_free(context, f.sorted);
  if (status != VXM_OK)
    vxm_error_pass(error, &f.error);
  return status;
}

void vxm_self_overlap_destroy(vxm_self_overlap *overlap) {
  vxm_free(overlap->chain.context, overlap->part);
  vxm_winding_chain_destroy(&overlap->chain);
  *overlap = (vxm_self_overlap){.chain = {.context = overlap->chain.context}};
}
