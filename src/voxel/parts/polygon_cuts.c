/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts/polygon_cuts.h"

#include <stdbool.h>

/** A polygon, and where its next piece goes. */
typedef struct cutter {
  const uint32_t *corners;
  size_t n;
  uint32_t (*piece)[3];
  uint8_t *edges;
} cutter;

/** Covers what lies between corners first..last and the line from the last to the first: a triangle over the
 * corner in the middle, and what its two sides leave. */
static void cover(cutter *c, size_t first, size_t last) {
  size_t middle = first + (last - first) / 2;
  if (middle == first)
    return;
  cover(c, first, middle);
  bool around = first == 0 && last + 1 == c->n;
  uint32_t *piece = *c->piece++;
  piece[0] = c->corners[first];
  piece[1] = c->corners[middle];
  piece[2] = c->corners[last];
  *c->edges++ = (uint8_t)(VXM_CUT_PIECE | (middle - first == 1) | (last - middle == 1) << 1 | around << 2);
  cover(c, middle, last);
}

void vxm_cut_polygon(const uint32_t *corners, size_t n, uint32_t (*pieces)[3], uint8_t *edges) {
  cover(&(cutter){corners, n, pieces, edges}, 0, n - 1);
}
