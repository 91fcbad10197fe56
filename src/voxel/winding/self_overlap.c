/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/self_overlap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  LINES_EVEN = 12,             /**< along y, and along z: evenly spaced ones at most, */
  LINES_MOST = 2 * LINES_EVEN, /**< and as many again where the points of a part are */
  SAMPLES = 64,                /**< points that tell where these are */
  CELLS = 256,                 /**< of a part's width, in which lines are looked up */
  CROSSINGS_MOST = 1 << 16,    /**< with more there are fewer lines */
  INSERTED_MOST = 32           /**< crossings of a line that are sorted by insertion */
};

/** Of the length inside: what is less is not worth the time, or comes of rounding. */
static const double noticed = 1e-5;
/** Of the same: what is left hollow is worth a word if it is more. */
static const double told = 0.002;
/** Where a line lies between two places: corners rarely lie there. */
static const double between = 0.4371;

/** Where lines along x lie along y, or along z. */
typedef struct line_places {
  double low, cells_per_unit;
  double at[LINES_MOST + 2]; /**< in order, and NaN, which nothing reaches, behind */
  int count;
  uint8_t first[CELLS]; /**< of each cell: lines in those before */
} line_places;

/** How many lines lie below a point. */
typedef struct line_cell {
  uint8_t along[2];
} line_cell;

typedef struct crossing {
  double x;
  uint32_t line;
  int32_t sign;
} crossing;

typedef struct finder {
  const vxm_triangle_set *triangles;
  line_places lines[2]; /**< along y, along z */
  line_cell *cells;     /**< of each point */
  crossing *crossings;
  size_t count, capacity;
  crossing *sorted; /**< by line */
  size_t sorted_capacity, closed_capacity, part_capacity;
  uint32_t ends[LINES_MOST * LINES_MOST + 1];
  bool contradicted; /**< some lines are entered more or less often than left */
  /* Of the others: */
  double length;              /**< wound around at all */
  double inside;              /**< length times number */
  double twice_out, twice_in; /**< lengths wound 2, 4, ... and -2, -4, ... times */
  vxm_error error;
} finder;

/* ---- Which lines ---- */

static inline const double *position(const finder *f, uint32_t point) {
  return f->triangles->positions[point];
}

static inline int cell_of(const line_places *l, double at) {
  double cell = (at - l->low) * l->cells_per_unit;
  return cell > 0 ? cell < CELLS ? (int)cell : CELLS - 1 : 0;
}

/** How many lines lie at a coordinate or below. Every comparison of a coordinate with lines goes through
 * this, so that triangles that share an edge agree. */
static inline uint8_t lines_below(const line_places *l, double at) {
  int count = l->first[cell_of(l, at)];
  count += l->at[count] <= at; /* few cells have a second one, so that the loop is rarely gone through */
  while (l->at[count] <= at)
    count++;
  return (uint8_t)count;
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

static int compare_places(const void *a, const void *b) {
  const double *p = a, *q = b;
  return (*p > *q) - (*p < *q);
}

/** Puts lines between the points of a part, most where most points are. */
static void add_lines_by_points(line_places *l, const finder *f, points range, int axis, int count) {
  double sample[SAMPLES];
  uint32_t all = range.end - range.begin, samples = all < SAMPLES ? all : SAMPLES;
  for (uint32_t i = 0; i < samples; i++)
    sample[i] = position(f, range.begin + (uint32_t)((uint64_t)all * i / samples))[1 + axis];
  qsort(sample, samples, sizeof *sample, compare_places);
  for (int i = 0; i < count; i++) {
    uint32_t at = (uint32_t)(((uint64_t)2 * (unsigned)i + 1) * samples / (2 * (unsigned)count)),
             next = at + 1;
    while (next < samples && sample[next] == sample[at])
      next++;
    if (next < samples)
      l->at[l->count++] = sample[at] + between * (sample[next] - sample[at]);
  }
}

/** Lays lines along an axis; false if the points have no extent that could be told. */
static bool lay_lines_along(line_places *l, const finder *f, points range, int axis, int count) {
  double low = INFINITY, high = -INFINITY;
  for (uint32_t p = range.begin; p < range.end; p++) {
    double at = position(f, p)[1 + axis];
    low = at < low ? at : low;
    high = at > high ? at : high;
  }
  double step = (high - low) / count;
  *l = (line_places){.low = low, .cells_per_unit = CELLS / (high - low)};
  if (!isnormal(step) || !isnormal(l->cells_per_unit))
    return false;
  for (int i = 0; i < count; i++)
    l->at[l->count++] = low + (i + between) * step;
  add_lines_by_points(l, f, range, axis, count);
  qsort(l->at, (size_t)l->count, sizeof *l->at, compare_places);
  l->at[l->count] = l->at[l->count + 1] = NAN;
  for (int i = 0; i < l->count; i++)
    for (int c = cell_of(l, l->at[i]) + 1; c < CELLS; c++)
      l->first[c]++;
  return true;
}

static bool lay_lines(finder *f, points range, int count) {
  for (int a = 0; a < 2; a++)
    if (!lay_lines_along(&f->lines[a], f, range, a, count))
      return false;
  for (uint32_t p = range.begin; p < range.end; p++)
    for (int a = 0; a < 2; a++)
      f->cells[p].along[a] = lines_below(&f->lines[a], position(f, p)[1 + a]);
  return true;
}

/* ---- Crossings ---- */

/** Where a side comes to a row of lines. */
typedef struct side_place {
  double x, y;
  int columns; /**< lines of the row below y */
} side_place;

/** The same whichever way the side runs; y is between those of its ends. */
static side_place place_on(const line_places *l, const double *p, const double *q, double z) {
  const double *low = p[2] < q[2] ? p : q, *high = low == p ? q : p;
  double share = (z - low[2]) / (high[2] - low[2]), y = low[1] + share * (high[1] - low[1]);
  double least = p[1] < q[1] ? p[1] : q[1], most = p[1] < q[1] ? q[1] : p[1];
  y = y < least ? least : y > most ? most : y;
  return (side_place){low[0] + share * (high[0] - low[0]), y, lines_below(l, y)};
}

static bool add_row(finder *f, int row, const side_place *from, const side_place *to, int sign) {
  const line_places *along_y = &f->lines[0];
  size_t more = (size_t)(to->columns - from->columns);
  if (vxm_grow(f->triangles->context, (void **)&f->crossings, &f->capacity, f->count + more,
               sizeof *f->crossings, &f->error) != VXM_OK)
    return false;
  double slope = (to->x - from->x) / (to->y - from->y);
  for (int c = from->columns; c < to->columns; c++) {
    f->crossings[f->count++] =
        (crossing){from->x + (along_y->at[c] - from->y) * slope, (uint32_t)(row * along_y->count + c), sign};
  }
  return true;
}

/** Crossings of a triangle: where its projection along x winds around a line, with the sign of that. */
static bool add_triangle(finder *f, const uint32_t k[3]) {
  /* The corner that lies alone on its side of a row, by which corners lie above. */
  static const uint8_t alone[8] = {0, 0, 1, 2, 2, 1, 0, 0};
  int below[3], first = f->lines[1].count, end = 0;
  for (int i = 0; i < 3; i++) {
    below[i] = f->cells[k[i]].along[1];
    first = below[i] < first ? below[i] : first;
    end = below[i] > end ? below[i] : end;
  }
  for (int row = first; row < end; row++) {
    double z = f->lines[1].at[row];
    int above = (below[0] > row) | (below[1] > row) << 1 | (below[2] > row) << 2, i = alone[above];
    const double *tip = position(f, k[i]);
    side_place to = place_on(&f->lines[0], tip, position(f, k[i < 2 ? i + 1 : 0]), z);
    side_place from = place_on(&f->lines[0], tip, position(f, k[i > 0 ? i - 1 : 2]), z);
    int sign = below[i] > row ? 1 : -1; /* of a row that is entered at `from` and left at `to` */
    if (to.columns == from.columns)
      continue;
    if (!(to.columns > from.columns ? add_row(f, row, &from, &to, sign) : add_row(f, row, &to, &from, -sign)))
      return false;
  }
  return true;
}

/** Whether lines lie between the corners of a triangle both along y and along z: told without a branch, as
 * nobody can tell beforehand. */
static inline bool has_lines(const line_cell *cells, const uint32_t k[3]) {
  line_cell a = cells[k[0]], b = cells[k[1]], c = cells[k[2]];
  int along_y = (a.along[0] ^ b.along[0]) | (a.along[0] ^ c.along[0]);
  int along_z = (a.along[1] ^ b.along[1]) | (a.along[1] ^ c.along[1]);
  return (along_y != 0) & (along_z != 0);
}

/** Those of triangles begin..end-1, until they are more than CROSSINGS_MOST. */
static vxm_status find_crossings(finder *f, size_t begin, size_t end) {
  enum { AT_ONCE = 1024 };
  uint32_t(*corners)[3] = f->triangles->corners;
  f->count = 0;
  for (size_t first = begin; first < end && f->count <= CROSSINGS_MOST; first += AT_ONCE) {
    size_t wanted[AT_ONCE], count = 0, last = first + AT_ONCE < end ? first + AT_ONCE : end;
    for (size_t t = first; t < last; t++) {
      wanted[count] = t;
      count += has_lines(f->cells, corners[t]);
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
  size_t line_count = (size_t)f->lines[0].count * (size_t)f->lines[1].count;
  vxm_status status = vxm_renew(f->triangles->context, (void **)&f->sorted, &f->sorted_capacity, f->count,
                                sizeof *f->sorted, &f->error);
  if (status != VXM_OK)
    return status;
  memset(f->ends, 0, sizeof f->ends);
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
  return (p->x > q->x) - (p->x < q->x);
}

static void sort_along(crossing *at, size_t count) {
  if (count > INSERTED_MOST) {
    qsort(at, count, sizeof *at, compare);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    crossing moved = at[i];
    size_t to = i;
    for (; to > 0 && at[to - 1].x > moved.x; to--)
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

/** Adds up one line. */
static void follow(finder *f, const crossing *at, size_t count) {
  if (sum_of_signs(at, count) != 0) {
    f->contradicted = true;
    return;
  }
  int wound = 0;
  for (size_t i = 0; i < count; i++) {
    double length = wound ? at[i].x - at[i - 1].x : 0;
    f->length += length;
    f->inside += wound * length;
    if (wound % 2 == 0)
      *(wound > 0 ? &f->twice_out : &f->twice_in) += length;
    wound += at[i].sign;
  }
}

static void follow_all(finder *f) {
  size_t line_count = (size_t)f->lines[0].count * (size_t)f->lines[1].count, begin = 0;
  f->contradicted = false;
  f->length = f->inside = f->twice_out = f->twice_in = 0;
  for (size_t line = 0; line < line_count; line++) {
    size_t count = f->ends[line] - begin;
    sort_along(f->sorted + begin, count);
    follow(f, f->sorted + begin, count);
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
  int count = (int)fmin(sqrt((double)(end - begin)) / 4 + 3, LINES_EVEN);
  vxm_status status = VXM_OK;
  do {
    if (!lay_lines(f, range, count))
      return VXM_OK;
    status = find_crossings(f, begin, end);
    count /= 2;
  } while (status == VXM_OK && f->count > CROSSINGS_MOST && count > 0);
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
  return status;
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
