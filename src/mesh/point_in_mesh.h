/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether points lie inside a set of faces, and how often it winds round them, by crossings of lines along
 * the axes. */
#ifndef VXM_MESH_POINT_IN_MESH_H
#define VXM_MESH_POINT_IN_MESH_H

#include "mesh/soup.h"

/** Fan triangles over the cells of a grid on the plane across an axis. */
typedef struct vxm_point_in_mesh_bins {
  bool built;
  size_t cells[2];
  double per_unit[2]; /**< cells per unit of scaled length */
  size_t *begin;      /**< cells[0] * cells[1] + 1 */
  struct vxm_point_in_mesh_triangle {
    uint32_t v[3];
    bool reversed; /**< the face has the corners in the other order */
  } * triangles;
} vxm_point_in_mesh_bins;

/** A set of faces and what was binned of it so far. The caller keeps the soup and the list alive. */
typedef struct vxm_point_in_mesh {
  const vxm_soup *soup;
  const size_t *faces;
  size_t face_count;
  double scale;  /**< of all positions, see vxm_unit_scale */
  double box[6]; /**< x0 y0 z0 x1 y1 z1 of the faces, scaled */
  vxm_point_in_mesh_bins bins[3];
  size_t tests;  /**< of triangles with lines so far */
  int8_t closed; /**< 1 = is closed, -1 = is open, 0 = not asked so far */
} vxm_point_in_mesh;

/** Whether every edge has an even number of the faces. The first call takes time linear in their corners. */
vxm_status vxm_point_in_mesh_is_closed(vxm_point_in_mesh *inside, bool *result, vxm_error *error);
/** Finds the box of the faces; before anything is asked. */
void vxm_point_in_mesh_find_box(vxm_point_in_mesh *inside);

/**
 * Sends rays from a point both ways along an axis.
 *
 * @param point  scaled
 * @param[out] votes how many of the two rays cross the faces an odd number of times: 0 to 2
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * A line through an edge between faces crosses one of them or both or none, so that the number stays even or
 * odd as it should. The first call along an axis sorts the faces into cells, in time linear in their corners.
 */
vxm_status vxm_point_in_mesh_vote(vxm_point_in_mesh *inside, const double point[3], int axis, int *votes,
                                  vxm_error *error);
/**
 * As vxm_point_in_mesh_vote, with the turn of the faces counted: how often they wind round a point, as rays
 * up and down the axis tell it. The two are equal for faces that balance along every edge (as many sides run
 * along it one way as the other); for outward faces of a body they are 1 within it.
 *
 * @param gap         scaled; faces that the line meets nearer to the point than this are passed over
 * @param[out] above  just above the point and those faces
 * @param[out] below  just below them
 */
vxm_status vxm_point_in_mesh_winding(vxm_point_in_mesh *inside, const double point[3], int axis, double gap,
                                     int *above, int *below, vxm_error *error);
/** As vxm_point_in_mesh_vote, and 2 where both rays tell that the faces wind round the point, though they
 * cross an even number of them, as where a body lies in itself. */
vxm_status vxm_point_in_mesh_surrounds(vxm_point_in_mesh *inside, const double point[3], int axis, int *votes,
                                       vxm_error *error);
/**
 * Whether a point lies on a face, or no farther than `gap` from its plane in its box.
 *
 * @param point, gap scaled
 */
vxm_status vxm_point_in_mesh_on_face(vxm_point_in_mesh *inside, const double point[3], double gap,
                                     bool *result, vxm_error *error);
/**
 * How far to go along an axis from a point on a face to be as deep within as one can: half of the way to the
 * next face, on the side where as many are crossed as there are to leave.
 *
 * @param point, gap  scaled; faces that are nearer than the gap are passed over
 * @param[out] height signed; 0 if neither side or both lie within
 */
vxm_status vxm_point_in_mesh_into(vxm_point_in_mesh *inside, const double point[3], int axis, double gap,
                                  double *height, vxm_error *error);
/** Frees the bins. */
void vxm_point_in_mesh_release(vxm_point_in_mesh *inside);

#endif
