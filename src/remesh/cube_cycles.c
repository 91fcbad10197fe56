/* SPDX-License-Identifier: BSD-3-Clause */
#include "remesh/cube_cycles.h"

#include <string.h>

/** The link between two corners that differ in one coordinate. */
static int link_between(int p, int q) {
  int axis = (p ^ q) == 1 ? 0 : (p ^ q) == 2 ? 1 : 2, low = p & q;
  return 4 * axis + (low >> (axis + 1) % 3 & 1) + 2 * (low >> (axis + 2) % 3 & 1);
}

/** For each crossed link those that it is joined with, in the two faces at it. */
typedef struct joined {
  int8_t other[VXM_CUBE_LINKS][2];
  uint8_t count[VXM_CUBE_LINKS];
} joined;

static void join(joined *j, int p, int q) {
  j->other[p][j->count[p]++] = (int8_t)q;
  j->other[q][j->count[q]++] = (int8_t)p;
}

/** Joins the crossed links of a face, whose corners are given in a ring. @return whether it has four */
static bool join_in_face(joined *j, const int ring[4], unsigned set) {
  int crossed[4], count = 0;
  for (int i = 0; i < 4; i++)
    if ((set >> ring[i] & 1) != (set >> ring[(i + 1) % 4] & 1))
      crossed[count++] = link_between(ring[i], ring[(i + 1) % 4]);
  if (count == 2)
    join(j, crossed[0], crossed[1]);
  if (count == 4) { /* link i is between corners i and i + 1 */
    int first = set >> ring[0] & 1 ? 0 : 1;
    for (int i = first; i < 4; i += 2)
      join(j, crossed[(i + 3) % 4], crossed[i]);
  }
  return count == 4;
}

static void ring_of_face(int ring[4], int face) {
  int axis = face / 2, side = (face & 1) << axis, b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
  ring[0] = side;
  ring[1] = side | b;
  ring[2] = side | b | c;
  ring[3] = side | c;
}

static void number_cycles(vxm_cube_cycles *out, const joined *j) {
  memset(out->cycle, VXM_NO_CYCLE, sizeof out->cycle);
  for (int start = 0; start < VXM_CUBE_LINKS; start++) {
    if (j->count[start] == 0 || out->cycle[start] != VXM_NO_CYCLE)
      continue;
    for (int at = start, next; at >= 0; at = next) {
      out->cycle[at] = out->count;
      next = -1;
      for (int k = 0; k < 2; k++)
        if (out->cycle[j->other[at][k]] == VXM_NO_CYCLE)
          next = j->other[at][k];
    }
    out->count++;
  }
}

void vxm_cube_cycles_find(vxm_cube_cycles out[VXM_CUBE_CONFIGURATIONS]) {
  for (unsigned set = 0; set < VXM_CUBE_CONFIGURATIONS; set++) {
    joined j = {.count = {0}};
    bool four[6];
    int ring[4];
    for (int face = 0; face < 6; face++) {
      ring_of_face(ring, face);
      four[face] = join_in_face(&j, ring, set);
    }
    out[set] = (vxm_cube_cycles){.count = 0};
    number_cycles(&out[set], &j);
    for (int face = 0; face < 6; face++) {
      ring_of_face(ring, face);
      out[set].meets_itself |= four[face] && out[set].cycle[link_between(ring[0], ring[1])] ==
                                                 out[set].cycle[link_between(ring[2], ring[3])];
    }
  }
}
