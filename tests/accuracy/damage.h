/* SPDX-License-Identifier: BSD-3-Clause */
/** Known damage, applied to a closed body by a seed, and the truth that goes with it. */
#ifndef ACCURACY_DAMAGE_H
#define ACCURACY_DAMAGE_H

#include "bodies.h"

typedef enum damage {
  DAMAGE_NONE,
  DAMAGE_DOUBLED,
  DAMAGE_FLIPPED,
  DAMAGE_REMOVED_1,
  DAMAGE_REMOVED_5,
  DAMAGE_REMOVED_20,
  DAMAGE_COPIES,
  DAMAGE_SHAKEN,
  DAMAGE_MOVED,
  DAMAGE_SHEET,
  DAMAGE_CAVITY,
  DAMAGE_HOLE,
  DAMAGE_PANELS,
  DAMAGE_PANELS_DOUBLED,
  DAMAGE_ALL,
  DAMAGE_COUNT
} damage;

/** What a damage is called in tables. */
extern const char *const damage_names[DAMAGE_COUNT];

/** A damaged mesh, and what should come of it. */
typedef struct question {
  vxm_mesh *mesh;
  vxm_mesh *oriented; /**< the same without doubled and turned faces: what is given to the winding number */
  vxm_grid *truth;    /**< in the space in which to answer */
} question;

/**
 * Damages a closed body of triangles. For the panels the body only lends its seed: each seed is another box.
 *
 * @return false if the body has no room inside for a sheet or a box; then nothing is made
 */
bool question_make(question *out, vxm_context *context, const shape *body, damage kind, int64_t resolution,
                   uint64_t seed);
void question_free(question *q);

#endif
