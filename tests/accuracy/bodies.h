/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Closed bodies made without a file, a body of loose panels, and the way between shapes and meshes.
 * What cannot be made ends the program.
 */
#ifndef ACCURACY_BODIES_H
#define ACCURACY_BODIES_H

#include "shapes.h"
#include "voxmend.h"

/** Number of own bodies, and what they are called. */
enum { BODY_COUNT = 3 };
extern const char *const body_names[BODY_COUNT];
/** One of them: triangles, closed, wound outward. Two bodies are one component, "two parts" are two that
 * overlap. */
shape body_make(int index);

/** How the six panels of a box are made. */
typedef enum panels {
  PANELS_JOINED, /**< eight shared vertices: the closed box that is meant */
  PANELS_LOOSE,  /**< every panel has its own vertices and its own number of cells along its rim */
  PANELS_TURNED  /**< the same, every panel turned in or out at random */
} panels;
/** A rotated box; the seed chooses its proportions, its rotation and the panels that are turned. */
shape body_panels(panels kind, uint64_t seed);

/** The triangles of a mesh. */
shape shape_of_mesh(const vxm_mesh *mesh);
vxm_mesh *mesh_of_shape(vxm_context *context, const shape *from);

/** Ends the program with the message of a failed call. */
void require(vxm_status status, const vxm_error *error);

#endif
