/* SPDX-License-Identifier: BSD-3-Clause */
#include "carve/convex.h"

enum { PLANES_MAX = 5 };

/** A plane's value at the box's first voxel, and by how much it grows from one voxel to the next; a voxel is
 * on the inner side where it is not negative. */
typedef struct plane {
  int64_t value, step[3];
} plane;

typedef struct body {
  plane planes[PLANES_MAX];
  int count;
  bool is_flat; /**< it has no inside */
} body;

static void cross(int64_t out[3], const int64_t a[3], const int64_t b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static int64_t dot(const int64_t a[3], const int64_t b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(int64_t out[3], const int64_t a[3], const int64_t b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[i] - b[i];
}

/**
 * Adds the plane through `on` with a normal that points inward: where sign * normal * (p - on) > 0.
 *
 * A centre on the plane is on the side to which it is moved: that of the first component that is not 0.
 */
static void add_plane(body *b, const vxm_lattice *lattice, const int64_t normal[3], int sign,
                      const int64_t on[3], const vxm_voxel_box *box) {
  plane *p = &b->planes[b->count++];
  int64_t to[3], first = 0;
  for (int a = 0; a < 3; a++) {
    to[a] = vxm_lattice_centre(lattice, box->first[a]) - on[a];
    p->step[a] = sign * normal[a] * lattice->unit;
    if (first == 0)
      first = p->step[a];
  }
  p->value = sign * dot(normal, to) - (first < 0);
  b->is_flat |= first == 0;
}

/** Narrows the voxels *low..*high of a row, counted from the first, to those on the inner side of a plane
 * with a value there. */
static inline void narrow(int64_t *low, int64_t *high, int64_t value, int64_t step) {
  if (step > 0) {
    if (value < 0)
      *low = vxm_max(*low, (-value + step - 1) / step);
  } else if (value < 0)
    *high = -1;
  else if (step < 0)
    *high = vxm_min(*high, value / -step);
}

static void cut(vxm_stock *stock, const body *b, const vxm_voxel_box *box) {
  int64_t in_slice[PLANES_MAX], at[PLANES_MAX];
  for (int p = 0; p < b->count; p++)
    in_slice[p] = b->planes[p].value;
  for (int64_t k = box->first[2]; k <= box->last[2]; k++) {
    for (int p = 0; p < b->count; p++)
      at[p] = in_slice[p];
    for (int64_t j = box->first[1]; j <= box->last[1]; j++) {
      int64_t low = 0, high = box->last[0] - box->first[0];
      for (int p = 0; p < b->count; p++)
        narrow(&low, &high, at[p], b->planes[p].step[0]);
      if (low <= high)
        vxm_stock_clear_span(stock, j, k, box->first[0] + low, box->first[0] + high + 1);
      for (int p = 0; p < b->count; p++)
        at[p] += b->planes[p].step[1];
    }
    for (int p = 0; p < b->count; p++)
      in_slice[p] += b->planes[p].step[2];
  }
}

void vxm_convex_cut_prism(vxm_stock *stock, const vxm_lattice *lattice, const vxm_point corners[3],
                          const int64_t motion[3], const vxm_voxel_box *box) {
  body b = {.count = 0};
  int64_t edges[3][3], normal[3], end[3];
  for (int e = 0; e < 3; e++)
    subtract(edges[e], corners[(e + 1) % 3].at, corners[e].at);
  cross(normal, edges[0], edges[1]);
  int64_t height = dot(normal, motion);
  if (height == 0)
    return;
  const int sign = height > 0 ? 1 : -1;
  for (int a = 0; a < 3; a++)
    end[a] = corners[0].at[a] + motion[a];
  add_plane(&b, lattice, normal, sign, corners[0].at, box);
  add_plane(&b, lattice, normal, -sign, end, box);
  for (int e = 0; e < 3;
       e++) { /* seen against the motion, inside is to the left of each edge, or to the right */
    int64_t side[3];
    cross(side, motion, edges[e]);
    add_plane(&b, lattice, side, sign, corners[e].at, box);
  }
  if (!b.is_flat)
    cut(stock, &b, box);
}

void vxm_convex_cut_tetrahedron(vxm_stock *stock, const vxm_lattice *lattice, const vxm_point corners[4],
                                const vxm_voxel_box *box) {
  body b = {.count = 0};
  for (int c = 0; c < 4; c++) { /* the plane across from each corner */
    const int64_t *on = corners[(c + 1) % 4].at;
    int64_t to_second[3], to_third[3], to_corner[3], normal[3];
    subtract(to_second, corners[(c + 2) % 4].at, on);
    subtract(to_third, corners[(c + 3) % 4].at, on);
    subtract(to_corner, corners[c].at, on);
    cross(normal, to_second, to_third);
    int64_t height = dot(normal, to_corner);
    if (height == 0)
      return;
    add_plane(&b, lattice, normal, height > 0 ? 1 : -1, on, box);
  }
  if (!b.is_flat)
    cut(stock, &b, box);
}
