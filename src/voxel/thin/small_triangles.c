/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles of a fine mesh: nearly all lie in two cells along each axis at most, and have a voxel set in
 * their middle. */
#include "voxel/parity/kernels.h"
#include "voxel/thin/meetings.h"
#include "voxel/thin/sieve_kernels.h"

/* Numbers of cells side by side in a word, as vxm_snapped_points has them, are compared all three at once:
   the highest bit of each is free. */

static const uint64_t ones = VXM_SIEVE_ONES;

/** The highest bit of each number of `a` that is not below that of `b`. */
static inline uint64_t not_below(uint64_t a, uint64_t b) {
  const uint64_t guards = ones << (VXM_CELL_BITS - 1);
  return ((a | guards) - b) & guards;
}

/** All lower bits of the numbers whose highest bit is set. */
static inline uint64_t spread(uint64_t guards) {
  return guards - (guards >> (VXM_CELL_BITS - 1));
}

static inline uint64_t least(uint64_t a, uint64_t b) {
  uint64_t mask = spread(not_below(a, b));
  return (b & mask) | (a & ~mask);
}

static inline uint64_t most(uint64_t a, uint64_t b) {
  uint64_t mask = spread(not_below(a, b));
  return (a & mask) | (b & ~mask);
}

/** Numbers of cells of which all voxels around are in the view. */
typedef struct bounds {
  uint64_t first, last;
} bounds;

static bounds bounds_of(const vxm_view *view) {
  bounds b = {0, 0};
  for (int a = 0; a < 3; a++) {
    b.first |= (uint64_t)(view->begin[a] + 1) << (VXM_CELL_BITS * a);
    b.last |= (uint64_t)(view->end[a] - 1) << (VXM_CELL_BITS * a);
  }
  return b;
}

/** The bit of the voxel that lies behind a cell along all axes. */
static inline int64_t bit_behind(const vxm_view *view, uint64_t cell) {
  const uint64_t mask = vxm_cell_mask(0);
  return view->origin + (int64_t)(cell & mask) * view->step[0] +
         (int64_t)(cell >> VXM_CELL_BITS & mask) * view->step[1] +
         (int64_t)(cell >> 2 * VXM_CELL_BITS) * view->step[2];
}

/** The box of cells in which a triangle's corners lie. */
typedef struct cell_box {
  uint64_t low;
  unsigned two; /**< the axes along which it has two cells: 1 for x, 2 for y, 4 for z */
  bool is_near; /**< it has no more along any, and the voxels around them are in the view */
} cell_box;

static inline cell_box box_of(const bounds *b, uint64_t p, uint64_t q, uint64_t r) {
  const uint64_t guards = ones << (VXM_CELL_BITS - 1);
  uint64_t low = least(least(p, q), r), length = most(most(p, q), r) - low;
  bool is_near = !(length & ~ones) & ((not_below(low, b->first) & not_below(b->last, low)) == guards);
  return (cell_box){
      low, (unsigned)(length | length >> (VXM_CELL_BITS - 1) | length >> 2 * (VXM_CELL_BITS - 1)) & 7,
      is_near};
}

/* In the middle of a box are the voxels between its two cells along each axis, and along an axis with one
   cell those on both sides of it. They are ends of every link, square and cube inside the box, so that where
   one is set whatever a triangle meets in its box has a voxel. */

/** Whether a voxel in the middle of a box that is near is set. */
static inline bool has_middle(const vxm_view *view, cell_box box) {
  int64_t bit = bit_behind(view, box.low);
  for (unsigned v = 0; v < 8; v++)
    if (!(v & box.two) &&
        vxm_view_bit_set(view, bit - (v & 1 ? view->step[0] : 0) - (v & 2 ? view->step[1] : 0) -
                                   (v & 4 ? view->step[2] : 0)))
      return true;
  return false;
}

/* Triangles are looked at together, so that those with nothing to do cost little. */

/** The triangles from *begin on that may meet something without a voxel; *begin becomes the first that was
 * not looked at. */
static size_t keep_unsure(uint32_t kept[VXM_SIEVE_BATCH], const vxm_thin_job *job, const bounds *b,
                          size_t *begin, size_t end) {
  const uint64_t *cells = job->placed->cells;
  const vxm_view *view = &job->view;
  size_t count = 0, t = *begin;
  for (; t < end && count < VXM_SIEVE_BATCH; t++) {
    const uint32_t *corner = job->corners[t];
    cell_box box = box_of(b, cells[corner[0]], cells[corner[1]], cells[corner[2]]);
    kept[count] = (uint32_t)t;
    count += !(box.is_near && has_middle(view, box));
  }
  *begin = t;
  return count;
}

/** The box of cells of a triangle that is two long at most. */
typedef struct small {
  int64_t corner[3][3]; /**< steps from the centre that lies between its two cells along each axis */
  int64_t low[3];       /**< the number of the first cell, and of that voxel */
  unsigned beyond[3];   /**< per axis: the corners in the second cell, a bit for each */
} small;

/** Which side of the centre line along the third axis a section's end lies on: of the plane between the cells
 * along `axis`, on the side from one corner to another. Exact: the numbers are below 2^22 and 2^36. On the
 * line, the perturbation decides as in sections.c. */
static inline bool is_beyond(const small *s, int from, int to, int axis, int other) {
  const int64_t *p = s->corner[from], *q = s->corner[to];
  int64_t rise = q[axis] - p[axis], across = q[other] - p[other], sign = rise >> 63;
  int64_t at = (p[other] * rise - p[axis] * across) * (INT64_C(1) << 24) + (other > axis ? across : 0);
  return (at ^ sign) - sign > 0;
}

static void put_section(const vxm_link_frame *frames, const small *s, const int64_t lowest[3], int axis,
                        int lone) {
  const vxm_thin_job *job = frames[0].job;
  double unit = (double)job->placed->lattice.unit;
  double offsets[2][3] = {{0}, {0}};
  for (int i = 0; i < 2; i++) {
    const int64_t *p = s->corner[lone], *q = s->corner[(lone + 1 + i) % 3];
    double part = (double)-p[axis] / (double)(q[axis] - p[axis]);
    int span = 0;
    for (int a = 0; a < 3; a++)
      if (a != axis)
        offsets[i][span++] =
            ((double)p[a] + (double)(q[a] - p[a]) * part) / unit + (double)(s->low[a] - lowest[a]) - 0.5;
  }
  vxm_meetings_put(frames[0].meetings, &job->view, VXM_DUAL_SQUARE + axis, lowest,
                   (const double(*)[3])offsets, 2);
}

/** Looks at the square in which the section across an axis lies. If it lies in several it crosses the line of
 * centres in the middle: returns the axis of that, else -1. */
static inline int meet_section(const vxm_link_frame *frames, const small *s, int axis) {
  /* the corner that is alone on its side of the plane, by the bits of those beyond */
  static const uint8_t alone[8] = {0, 0, 1, 2, 2, 1, 0, 0};
  const vxm_view *view = &frames[0].job->view;
  int lone = alone[s->beyond[axis]], p = lone == 2 ? 0 : lone + 1, q = lone == 0 ? 2 : lone - 1;
  int64_t lowest[3], bit = view->origin + s->low[axis] * view->step[axis];
  lowest[axis] = s->low[axis];
  for (int i = 1; i <= 2; i++) {
    int a = axis + i < 3 ? axis + i : axis + i - 3;
    bool all = s->beyond[a] == 7, some = (s->beyond[a] != 0) & !all;
    bool beyond = all | (some & is_beyond(s, lone, p, axis, a));
    if (beyond != (all | (some & is_beyond(s, lone, q, axis, a))))
      return 3 - axis - a;
    lowest[a] = s->low[a] - !beyond;
    bit += lowest[a] * view->step[a];
  }
  int64_t u = view->step[axis == 2 ? 0 : axis + 1], v = view->step[axis == 0 ? 2 : axis - 1];
  int filled = (int)vxm_view_bit_set(view, bit) | (int)vxm_view_bit_set(view, bit + u) |
               (int)vxm_view_bit_set(view, bit + v) | (int)vxm_view_bit_set(view, bit + u + v);
  if (!filled)
    put_section(frames, s, lowest, axis, lone);
  return -1;
}

/** The normal of a small triangle, and how high its plane lies over the middle: `volume` / normal along each
 * axis. Both are twice and six times those, below 2^37 and 2^55. */
typedef struct small_plane {
  int64_t normal[3], volume;
} small_plane;

static inline small_plane plane_of(const small *s) {
  const int64_t *a = s->corner[0], *b = s->corner[1], *c = s->corner[2];
  small_plane plane = {.volume = 0};
  for (int w = 0; w < 3; w++) {
    int u = w == 2 ? 0 : w + 1, v = w == 0 ? 2 : w - 1;
    plane.normal[w] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    plane.volume += a[w] * plane.normal[w];
  }
  return plane;
}

/**
 * How far behind the middle of a link a triangle crosses it, as vxm_meet_links has it to the last bit.
 *
 * @param to the upper end of the link
 */
static inline double offset_of(const vxm_lattice *lattice, const small *s, const small_plane *plane, int axis,
                               int64_t to) {
  const int64_t *n = plane->normal, unit = lattice->unit, sign = n[axis] < 0 ? -1 : 1;
  bool beyond = (n[0] != 0 ? n[0] : n[1] != 0 ? n[1] : n[2]) * sign > 0;
  int64_t at = s->corner[0][axis] + vxm_lattice_centre(lattice, s->low[axis]), size = sign * n[axis];
  int64_t up = unit / 2 - (at & (unit - 1)), base = (at >> lattice->bits) + 1;
  int64_t across = sign * plane->volume - size * (s->corner[0][axis] + up) - beyond;
  double voxels = (double)across * (1.0 / (double)(size * unit));
  return voxels - (double)(to - base) - 0.5;
}

/**
 * Keeps the links without a voxel that a triangle crosses on the lines of centres in the middle of its box, a
 * bit for each: one end is the voxel in the middle, which is not set. False, and nothing is kept, where it is
 * not known which links these are.
 */
static bool keep_links(vxm_link_frame *frames, const small *s, unsigned lines) {
  const vxm_thin_job *job = frames[0].job;
  const small_plane plane = plane_of(s);
  int64_t lower[3][3];
  unsigned empty = 0;
  for (int axis = 0; axis < 3; axis++) {
    if (!(lines >> axis & 1))
      continue;
    if (s->beyond[axis] == 0 || s->beyond[axis] == 7 || plane.volume == 0 || plane.normal[axis] == 0)
      return false;
    bool above = (plane.volume > 0) == (plane.normal[axis] > 0);
    int64_t other[3] = {s->low[0], s->low[1], s->low[2]};
    for (int a = 0; a < 3; a++)
      lower[axis][a] = s->low[a] - (a == axis && !above);
    other[axis] += above ? 1 : -1;
    empty |= (unsigned)!vxm_view_bit_set(&job->view, vxm_view_bit(&job->view, other)) << axis;
  }
  if (empty == 0)
    return true;
  vxm_link_surface surface = {.is_measured = false};
  for (int a = 0; a < 3; a++)
    surface.size[a] = (double)(plane.normal[a] < 0 ? -plane.normal[a] : plane.normal[a]);
  for (int axis = 0; axis < 3; axis++) {
    if (!(empty >> axis & 1))
      continue;
    frames[axis].surface = &surface;
    vxm_keep_link(&frames[axis], lower[axis],
                  offset_of(&job->placed->lattice, s, &plane, axis, lower[axis][axis] + 1));
  }
  return true;
}

/** What a triangle without a voxel in its middle meets; false if its box of cells is too long, or at the
 * border. */
static bool meet_small(vxm_link_frame *frames, size_t triangle, uint64_t differ) {
  const vxm_thin_job *job = frames[0].job;
  const vxm_view *view = &job->view;
  const uint32_t *corner = job->corners[triangle];
  small s;
  for (int a = 0; a < 3; a++) {
    int64_t cell[3], low, high;
    for (int k = 0; k < 3; k++)
      cell[k] = (int64_t)(job->placed->cells[corner[k]] >> (VXM_CELL_BITS * a) & vxm_cell_mask(0));
    low = vxm_min(vxm_min(cell[0], cell[1]), cell[2]);
    high = vxm_max(vxm_max(cell[0], cell[1]), cell[2]);
    if (high - low > 1 || low <= view->begin[a] || high >= view->end[a] || low + 1 >= view->end[a])
      return false;
    s.low[a] = low;
    s.beyond[a] = 0;
    for (int k = 0; k < 3; k++) {
      s.corner[k][a] = job->placed->narrow[corner[k]][a] - vxm_lattice_centre(&job->placed->lattice, low);
      s.beyond[a] |= (unsigned)(cell[k] > low) << k;
    }
  }
  unsigned lines = 0; /* in the middle that the triangle crosses */
  for (int axis = 0; axis < 3; axis++)
    if (differ & vxm_cell_mask(axis)) {
      int line = meet_section(frames, &s, axis);
      lines |= line >= 0 ? 1U << line : 0;
    }
  /* Of two lines that a section crosses the one told is such that the other sections tell all others. */
  if (lines != 0 && !keep_links(frames, &s, lines))
    vxm_meet_links(frames, triangle, differ, NULL);
  return true;
}

static void meet_one(vxm_link_frame *frames, size_t triangle) {
  const vxm_thin_job *job = frames[0].job;
  const vxm_triangle_set *triangles = job->triangles;
  const uint32_t *corner = job->corners[triangle];
  const uint64_t *cells = job->placed->cells;
  if (vxm_role_of(triangles, triangle) != VXM_ROLE_FACE)
    return;
  uint64_t differ = (cells[corner[0]] ^ cells[corner[1]]) | (cells[corner[0]] ^ cells[corner[2]]);
  if (differ == 0) {
    vxm_meet_cube(frames[0].meetings, job, triangle);
    return;
  }
  if (meet_small(frames, triangle, differ))
    return;
  vxm_meet_sections(frames, triangle, differ);
}

void vxm_meet_by_cells(vxm_link_frame *frames, size_t begin, size_t end) {
  bounds b = bounds_of(&frames[0].job->view);
  vxm_sieve sieve;
  bool sifted = vxm_sieve_of(&sieve, frames[0].job);
  while (begin < end) {
    uint32_t kept[VXM_SIEVE_BATCH + 16];
    size_t count = sifted ? vxm_sieve_kernels_of(NULL)->sift(&sieve, kept, &begin, end)
                          : keep_unsure(kept, frames[0].job, &b, &begin, end);
    for (size_t k = 0; k < count; k++)
      meet_one(frames, kept[k]);
  }
}
