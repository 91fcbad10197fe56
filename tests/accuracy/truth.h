/* SPDX-License-Identifier: BSD-3-Clause */
/** What should come out: solids of undamaged bodies, and the room inside them. */
#ifndef ACCURACY_TRUTH_H
#define ACCURACY_TRUTH_H

#include "bodies.h"

/** The space in which a body is measured: a cube of `resolution` voxels with one empty voxel around the body.
 */
vxm_space truth_space(vxm_context *context, const shape *body, int64_t resolution);

/**
 * The solid of a closed body: parity along z of every component, and what the body winds around twice.
 * Closing and votes have no part in it, and orientation adds no more than that, so that none of them makes
 * its own truth.
 */
vxm_grid *truth_solid(vxm_context *context, const shape *body, const vxm_space *space);

void truth_unite(vxm_grid *into, const vxm_grid *other);
void truth_subtract(vxm_grid *from, const vxm_grid *other);

/**
 * The largest cube inside a solid, drawn in by more than a voxel on each side, in model units; false if the
 * solid is too thin to hold one of three voxels.
 */
bool truth_room(const vxm_grid *solid, double low[3], double high[3]);

#endif
