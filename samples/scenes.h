/* SPDX-License-Identifier: BSD-3-Clause */
/** A stool of named parts, as files that hold scenes rather than one mesh: what importers of such files meet.
 */
#ifndef VXM_SAMPLES_SCENES_H
#define VXM_SAMPLES_SCENES_H

#include <stdbool.h>
#include <stdio.h>

/** The stool in millimetres, z upward: a seat on four round legs. The GLB has it in metres, y upward. */
enum {
  STOOL_WIDTH = 400,
  STOOL_DEPTH = 300,
  STOOL_SEAT = 30,
  STOOL_LEG = 420,
  STOOL_RADIUS = 15,
  STOOL_LEGS = 4
};
/** Corners of a leg in the GLB, where it is a prism. */
enum { STOOL_CORNERS = 16 };

/**
 * Binary glTF: nodes "seat" (material "oak") and four times "leg" (material "steel", one mesh for all), each
 * with its own transform below a root that turns them; one leg is mirrored, one is turned.
 */
bool scene_write_glb(FILE *file);

/** STEP (AP214): an assembly of the products "seat", a block, and "leg", a cylinder used four times. */
bool scene_write_step(FILE *file);

#endif
