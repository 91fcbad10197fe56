/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/lattice_fans.h"

#include <string.h>

static bool is_set(unsigned set, int axis, bool far, int other, bool far_other, bool far_third) {
  int third = 3 - axis - other;
  return set >> ((unsigned)far << axis | (unsigned)far_other << other | (unsigned)far_third << third) & 1;
}

bool vxm_lattice_edge_pinched(unsigned set, int along, bool far) {
  int b = along == 0 ? 1 : 0;
  bool nn = is_set(set, along, far, b, false, false), nf = is_set(set, along, far, b, false, true);
  bool fn = is_set(set, along, far, b, true, false), ff = is_set(set, along, far, b, true, true);
  return nn == ff && nf == fn && nn != nf;
}

/** Faces that hang together so far have the same number. */
static void join(uint8_t number[VXM_LATTICE_FACES], unsigned face, unsigned other) {
  uint8_t from = number[other], to = number[face];
  for (unsigned f = 0; f < VXM_LATTICE_FACES; f++)
    if (number[f] == from)
      number[f] = to;
}

/** Joins the faces that follow each other over the edge from the point along an axis. */
static void join_edge(uint8_t number[VXM_LATTICE_FACES], const bool *exposed, unsigned set, int along,
                      bool far) {
  int b = along == 0 ? 1 : 0, c = 3 - along - b;
  unsigned first = VXM_LATTICE_FACES;
  if (vxm_lattice_edge_pinched(set, along, far)) {
    for (int q = 0; q < 4; q++)
      if (is_set(set, along, far, b, q & 1, q >> 1))
        join(number, vxm_lattice_face_at(b, along, far, q >> 1), vxm_lattice_face_at(c, along, far, q & 1));
    return;
  }
  for (int q = 0; q < 4; q++) {
    unsigned face = vxm_lattice_face_at(q < 2 ? b : c, along, far, q & 1);
    if (!exposed[face])
      continue;
    if (first < VXM_LATTICE_FACES)
      join(number, first, face);
    first = face;
  }
}

/** Adds, for each edge of four faces at the point, the way into the voxels that touch in it to the sums of
 * their fans; `pinched` are the fans that have such edges. */
static void add_pinched(const vxm_lattice_fans *fans, unsigned set, int sum[VXM_LATTICE_FANS_MAX][3],
                        bool *pinched) {
  for (int along = 0; along < 3; along++)
    for (int far = 0; far < 2; far++) {
      int b = along == 0 ? 1 : 0, c = 3 - along - b;
      for (int q = 0; q < 4 && vxm_lattice_edge_pinched(set, along, far); q++) {
        if (!is_set(set, along, far, b, q & 1, q >> 1))
          continue;
        unsigned fan = fans->fan[set][vxm_lattice_face_at(b, along, far, q >> 1)];
        pinched[fan] = true;
        sum[fan][b] += q & 1 ? 1 : -1;
        sum[fan][c] += q >> 1 ? 1 : -1;
      }
    }
}

static void fill_case(vxm_lattice_fans *out, unsigned set) {
  bool exposed[VXM_LATTICE_FACES];
  int inward[VXM_LATTICE_FACES]; /* along the axis that the face is across */
  uint8_t number[VXM_LATTICE_FACES];
  int sum[VXM_LATTICE_FANS_MAX][3] = {{0}}, edge_sum[VXM_LATTICE_FANS_MAX][3] = {{0}};
  bool pinched[VXM_LATTICE_FANS_MAX] = {false};
  for (int axis = 0; axis < 3; axis++)
    for (int q = 0; q < 4; q++) {
      int u = axis == 0 ? 1 : 0;
      unsigned face = vxm_lattice_face(axis, q & 1, q >> 1);
      bool low = is_set(set, axis, false, u, q & 1, q >> 1), high = is_set(set, axis, true, u, q & 1, q >> 1);
      exposed[face] = low != high;
      inward[face] = high ? 1 : -1;
      number[face] = (uint8_t)face;
    }
  for (int along = 0; along < 3; along++)
    for (int far = 0; far < 2; far++)
      join_edge(number, exposed, set, along, far);
  for (unsigned f = 0; f < VXM_LATTICE_FACES; f++) {
    if (!exposed[f])
      continue;
    unsigned fan = out->count[set];
    for (unsigned g = 0; g < f; g++)
      if (exposed[g] && number[g] == number[f])
        fan = out->fan[set][g];
    out->count[set] = (uint8_t)(fan < out->count[set] ? out->count[set] : fan + 1);
    out->fan[set][f] = (uint8_t)fan;
    sum[fan][f / 4] += inward[f];
  }
  add_pinched(out, set, edge_sum, pinched);
  for (int fan = 0; fan < VXM_LATTICE_FANS_MAX; fan++)
    for (int a = 0; a < 3; a++) {
      /* two holes that touch in a corner alone part where either is made smaller */
      int inward_way = __builtin_popcount(set) == 6 ? -sum[fan][a] : sum[fan][a];
      int way = pinched[fan] ? edge_sum[fan][a] : inward_way;
      out->toward[set][fan][a] = (int8_t)((way > 0) - (way < 0));
    }
}

void vxm_lattice_fans_fill(vxm_lattice_fans *out) {
  memset(out, 0, sizeof *out);
  for (unsigned set = 0; set < VXM_LATTICE_CASES; set++)
    fill_case(out, set);
}
