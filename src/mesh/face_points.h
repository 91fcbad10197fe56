/* SPDX-License-Identifier: BSD-3-Clause */
/** Points on the faces of a component, and whether they lie inside another one. */
#ifndef VXM_MESH_FACE_POINTS_H
#define VXM_MESH_FACE_POINTS_H

#include "mesh/point_in_mesh.h"

enum { VXM_FACE_SAMPLES = 3 };

typedef struct vxm_face_sample {
  double point[3]; /**< scaled */
  int axis;        /**< along which its face lies least */
} vxm_face_sample;

/** Some faces of a soup. */
typedef struct vxm_face_list {
  const vxm_soup *soup;
  const size_t *faces;
  size_t count;
  double scale; /**< of all positions */
} vxm_face_list;

/** A point on one of the faces, off the lines on which edges use to lie: false if none has three corners, all
 * finite. The same if the face is reversed about its first corner: turning faces must not change what lies
 * inside what. @param number below VXM_FACE_SAMPLES */
bool vxm_face_sample_take(const vxm_face_list *list, int number, vxm_face_sample *out);

/**
 * Whether most of some points lie inside a set of faces.
 *
 * @param all they must do so by all rays, else by half of them
 *
 * The rays along z decide if they are all of one mind, but where none crosses faces that are open, as a tube
 * without ends: it does not matter along which axis that stands.
 */
vxm_status vxm_face_samples_vote(vxm_point_in_mesh *around, const vxm_face_sample *samples, int count,
                                 bool all, bool *result, vxm_error *error);

typedef struct vxm_points_outside {
  size_t points, outside;
} vxm_points_outside;

/**
 * Counts those of many points, spread over all of the faces, that lie outside a set of faces: by all rays,
 * and not on those faces.
 *
 * @param gap    scaled: how far from those a point is on them
 * @param wanted about so many points, and the corners
 *
 * It does not hang on the order of the faces nor on how they are wound, unless they are more than half of
 * what is wanted: then some are passed over.
 */
vxm_status vxm_face_points_outside(vxm_point_in_mesh *around, const vxm_face_list *list, double gap,
                                   size_t wanted, vxm_points_outside *out, vxm_error *error);

#endif
