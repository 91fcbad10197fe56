/* SPDX-License-Identifier: BSD-3-Clause */
/** Two rims that one strip closes: those of an outer and an inner wall. */
#ifndef VXM_REPAIR_HOLES_RIM_BANDS_H
#define VXM_REPAIR_HOLES_RIM_BANDS_H

#include "repair/state/repair_state.h"

/**
 * Joins pairs of loops of at most `most` edges by a band of triangles from one to the other, where that is
 * what lacks: the rim of a cup or the end of a tube, each with two walls. Caps would lie upon each other over
 * the mouth there. Two loops are such a pair if the band
 *  - has its sides against those of the faces at both, as those of an outer and an inner wall have them;
 *  - is flat: it lies in a plane without folds, or lies nearly so and is smaller than either cap. So it joins
 *    no two pipes with a gap between their ends, nor the upper rim of a tray to a hole in its floor;
 *  - has the faces at both loops behind it, as walls are behind their end: so it joins no cover to the box
 *    below, nor a disc to the frame around it, nor does it lay a sheet double;
 *  - makes no edge that exists already.
 * Of several pairs those with the smallest bands come first.
 *
 * @param[out] closed how many loops
 */
vxm_status vxm_fill_bands(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error);

#endif
