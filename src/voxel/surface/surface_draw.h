/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Drawing the voxels of one triangle, exactly.
 *
 * A voxel with centre c belongs to the surface of a triangle where, after Schwarz & Seidel 2010, all of these
 * hold (n is the normal, u the width of a voxel, and everything is closed: equality belongs to it):
 *
 *   box     the voxel meets the triangle's bounding box
 *   plane   |n . (c - v)| <= u / 2 R(n)
 *   edges   in each of the three projections and for each edge, with m its normal that points inward,
 *           m . (c - v) >= -u / 2 R(m)
 *
 * For the conservative surface (section 3.1) R is the sum of the absolute components: u / 2 R(m) is how far a
 * voxel reaches along m, and the tests together say whether the closed voxel meets the triangle. For the thin
 * surface (section 3.4) R is the largest absolute component, which is the reach of the octahedron whose six
 * corners are the middles of the voxel's faces.
 *
 * Thin separates: a step between two 6-neighbours that crosses the triangle at a point q has one of the two
 * centres within u / 2 of q along an axis a. Then n . (c - q) is n_a times at most u / 2, the same holds for
 * every edge normal, and q is in the plane, inside of all edges and in the box: that voxel passes all tests.
 * Being closed, they need no rule for ties: a centre on the triangle, and both voxels beside a border on the
 * triangle, belong to it. Since the largest component is at most the sum, thin is part of conservative.
 *
 * The tests themselves stand in shaders/rules.h. Here they are solved for the voxels of a row.
 */
#ifndef VXM_VOXEL_SURFACE_SURFACE_DRAW_H
#define VXM_VOXEL_SURFACE_SURFACE_DRAW_H

#include "base/task_progress.h"
#include "grid/window.h"
#include "voxel/lattice/lattice.h"
#include "voxel/surface/surface.h"

/** Axes are numbered by their role in the window: 0 the bits run along, 1 the rows, 2 the slices. */
enum { VXM_FAST, VXM_MIDDLE, VXM_SLOW };

/** Voxels begin..end-1 by role. */
typedef struct vxm_surface_box {
  int64_t begin[3], end[3];
} vxm_surface_box;

/** The bounding box of a triangle. */
typedef struct vxm_surface_bounds {
  vxm_surface_box box; /**< the voxels, also outside the grid, whose closed extents meet it */
  int64_t longest;     /**< its longest side in lattice steps */
} vxm_surface_bounds;

/** Voxels begin..end-1 of a row or rows of a slice; none if end <= begin. */
typedef struct vxm_surface_span {
  int32_t begin, end;
} vxm_surface_span;

enum {
  VXM_SURFACE_SLICES = 64,  /**< most slices of a tile, and worked on together */
  VXM_SURFACE_LANES = 8,    /**< most rows worked on together */
  VXM_SURFACE_AT_ONCE = 512 /**< triangles that are best drawn in one call */
};

/** How a window is cut into tiles. */
typedef struct vxm_surface_cut {
  int row_bits, slice_bits; /**< a tile has 2^row_bits rows of 2^slice_bits slices */
  size_t across;            /**< tiles side by side in a band of slices */
} vxm_surface_cut;

/**
 * The tiles that a triangle's box meets: the number of the first one times VXM_SURFACE_PLACE_MOST and how
 * many bands of slices less one, times VXM_SURFACE_PLACE_MOST and how many tiles in each less one. There are
 * far fewer than 2^28 tiles, which would be terabytes.
 */
#define VXM_SURFACE_PLACE_MOST 4
#define VXM_SURFACE_PLACE_LARGE (UINT32_MAX - 1) /* that is more bands, or more tiles in each */
#define VXM_SURFACE_PLACE_NONE UINT32_MAX        /* it is beyond the window */

typedef struct vxm_surface_build vxm_surface_build;

/** What one task draws with. */
typedef struct vxm_surface_pen {
  const vxm_surface *surface;
  const vxm_window *window;
  const vxm_lattice *lattice;
  vxm_surface_kind kind;
  int64_t narrow_max;   /**< differences of corners up to this are exact in surface_i64.inc, */
  int64_t lane_max;     /**< and up to this in surface_some.inc */
  int64_t four_max;     /**< and in surface_few.inc for boxes of up to four voxels, */
  int64_t two_max;      /**< and of up to two */
  vxm_surface_box tile; /**< of the window */
  uint64_t *words;      /**< the tile's rows, window->row_words each; slices lie slice_words apart */
  size_t slice_words;
  vxm_surface_span *rows;      /**< room for one for each row of the tile */
  double *row_begin, *row_end; /**< the same, and for 2 VXM_SURFACE_LANES more */
  const vxm_surface_build *build;
} vxm_surface_pen;

/** The loops that draw a triangle of ordinary size, built for several processors from surface_i64.inc; all
 * give the same bits. */
struct vxm_surface_build {
  /** `box` is what the triangle and the tile have in common; `thin` is an axis along which the triangle meets
   * one voxel only, by which alone the box decides nothing else, or -1. Returns the rows looked at. */
  size_t (*draw)(const vxm_surface_pen *pen, const vxm_point *const v[3], const vxm_surface_box *box,
                 int thin);
  /** Draws triangles begin..end-1 of a list, or of the surface (NULL), whose points are narrow. Returns about
   * how many rows it looked at. The tile has fewer than 2^31 words. */
  size_t (*draw_narrow)(const vxm_surface_pen *pen, const uint32_t *list, size_t begin, size_t end);
  /** Writes the places in a window, which is the pen's tile, of triangles begin..end-1 of the surface, whose
   * points are narrow. */
  void (*place_narrow)(const vxm_surface_pen *pen, const vxm_surface_cut *cut, uint32_t *out, size_t begin,
                       size_t end);
  /** to = from, past the caches, and from = 0. */
  void (*put)(uint64_t *to, uint64_t *from, size_t count);
  /** to |= from, and from = 0. */
  void (*join)(uint64_t *to, uint64_t *from, size_t count);
};

/** A pen for a whole window, but for its words and the room for rows. */
vxm_surface_pen vxm_surface_pen_of(const vxm_surface *surface, const vxm_window *window,
                                   vxm_surface_kind kind);

/** Row `middle` of slice `slow` of the tile, by their numbers in the grid. */
static inline uint64_t *vxm_surface_row(const vxm_surface_pen *pen, int64_t middle, int64_t slow) {
  return pen->words + (size_t)(slow - pen->tile.begin[VXM_SLOW]) * pen->slice_words +
         (size_t)(middle - pen->tile.begin[VXM_MIDDLE]) * pen->window->row_words;
}

/** All builds that run on this processor, best last. */
size_t vxm_surface_builds(const vxm_surface_build *out[3]);
/** The best of them, or the one forced. */
const vxm_surface_build *vxm_surface_best(void);
/** Makes vxm_surface_best return this one; NULL = the best again. For tests, while nothing is drawn. */
void vxm_surface_force(const vxm_surface_build *build);

/** As a build's draw, for any triangle. */
size_t vxm_surface_draw_wide(const vxm_surface_pen *pen, const vxm_point *const v[3], vxm_surface_box box);

/* Triangles come in no order that a processor could learn, so these do without branches. */
static inline int64_t vxm_surface_lower(int64_t a, int64_t b) {
  return b ^ ((a ^ b) & -(int64_t)(a < b));
}

static inline int64_t vxm_surface_upper(int64_t a, int64_t b) {
  return a ^ ((a ^ b) & -(int64_t)(a < b));
}

static inline void vxm_surface_bound_role(vxm_surface_bounds *bounds, const vxm_lattice *lattice, int role,
                                          int64_t a, int64_t b, int64_t c) {
  int64_t low = vxm_surface_lower(vxm_surface_lower(a, b), c);
  int64_t high = vxm_surface_upper(vxm_surface_upper(a, b), c);
  bounds->box.begin[role] = vxm_first_touched_64(low, lattice->unit, lattice->bits);
  bounds->box.end[role] = vxm_end_touched_64(high, lattice->bits);
  bounds->longest = vxm_surface_upper(bounds->longest, high - low);
}

static inline vxm_surface_bounds vxm_surface_bounds_of(const vxm_lattice *lattice, vxm_layout layout,
                                                       const vxm_point *const v[3]) {
  const int f = layout.fast, m = layout.middle, s = layout.slow;
  vxm_surface_bounds bounds;
  bounds.longest = 0;
  vxm_surface_bound_role(&bounds, lattice, VXM_FAST, v[0]->at[f], v[1]->at[f], v[2]->at[f]);
  vxm_surface_bound_role(&bounds, lattice, VXM_MIDDLE, v[0]->at[m], v[1]->at[m], v[2]->at[m]);
  vxm_surface_bound_role(&bounds, lattice, VXM_SLOW, v[0]->at[s], v[1]->at[s], v[2]->at[s]);
  return bounds;
}

static inline bool vxm_surface_meet_role(vxm_surface_box *box, const vxm_surface_box *other, int role) {
  box->begin[role] = vxm_surface_upper(box->begin[role], other->begin[role]);
  box->end[role] = vxm_surface_lower(box->end[role], other->end[role]);
  return box->begin[role] < box->end[role];
}

/** Narrows a box to what it shares with another; whether anything is left. */
static inline bool vxm_surface_meet(vxm_surface_box *box, const vxm_surface_box *other) {
  bool fast = vxm_surface_meet_role(box, other, VXM_FAST);
  bool middle = vxm_surface_meet_role(box, other, VXM_MIDDLE);
  bool slow = vxm_surface_meet_role(box, other, VXM_SLOW);
  return fast && middle && slow;
}

/** Sets the triangle's voxels within the tile; returns about how many rows it looked at. */
size_t vxm_surface_draw(const vxm_surface_pen *pen, const vxm_point *const v[3]);

/** The corners of a triangle, of which `copies` holds the points. */
static inline void vxm_surface_corners(const vxm_surface *surface, size_t triangle, const vxm_point *v[3],
                                       vxm_point copies[3]) {
  const uint32_t *corner = surface->corners + 3 * triangle;
  for (int c = 0; c < 3; c++) {
    copies[c] = vxm_surface_at(surface, corner[c]);
    v[c] = &copies[c];
  }
}

/** Draws triangles begin..end-1 of a list, or of the surface (NULL); false if the work is to stop. */
bool vxm_surface_draw_some(const vxm_surface_pen *pen, const uint32_t *list, size_t begin, size_t end,
                           vxm_task_progress *progress, int worker);

/** What bounds the rows of a triangle in a range of slices: a middle + c slow + b >= 0. */
typedef struct vxm_surface_shadow {
  int count;
  struct {
    vxm_int128 a, c, b;
  } line[5];
  int64_t origin[3];
} vxm_surface_shadow;

/** The triangle seen along the bits, and of that what the plane leaves between voxels 0 and fast_dim - 1. */
void vxm_surface_shadow_of(vxm_surface_shadow *shadow, const vxm_surface_pen *pen,
                           const vxm_point *const v[3]);
/** Narrows rows [*begin, *end) to those that the triangle may have in slices s_begin..s_end-1, s_begin <
 * s_end. */
void vxm_surface_shadow_rows(const vxm_surface_shadow *shadow, int64_t s_begin, int64_t s_end, int64_t *begin,
                             int64_t *end);

#endif
