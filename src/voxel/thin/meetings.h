/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Where the surface meets what lies between voxel centres (voxel/thin/dual_elements.h): faces cross links,
 * sections of faces lie in squares, faces in cubes. Only meetings at which no voxel is set are kept.
 */
#ifndef VXM_VOXEL_THIN_MEETINGS_H
#define VXM_VOXEL_THIN_MEETINGS_H

#include "base/context.h"
#include "voxel/thin/octree_sieve.h"
#include "voxel/thin/thin_job.h"

#include <math.h>

/** Meetings that one thread has found. Start from {.context = ...}. */
typedef struct vxm_meetings {
  vxm_context *context;
  vxm_meeting *list;
  size_t count, capacity;
  uint32_t *in_cubes; /**< triangles in cubes without a voxel, see vxm_meet_cubes */
  size_t in_cubes_count, in_cubes_capacity;
  size_t most;       /**< of `count` and `in_cubes_count` together */
  bool is_full;      /**< there were more */
  int64_t thin_area; /**< of faces at links along the axes along which their normals are longest; in parts of
                        a square of voxels, of which a square has VXM_OFFSET_UNIT */
  vxm_error error;   /**< the first failure; nothing is put after it */
} vxm_meetings;

/** Puts a face that crosses a link into the list, `offset` voxels beyond its middle. */
void vxm_meetings_put_link(vxm_meetings *meetings, const vxm_view *view, vxm_thin_stage stage,
                           const int64_t lowest[3], int direction, double offset);
/** Puts a triangle into the list of those in cubes. */
void vxm_meetings_put_in_cube(vxm_meetings *meetings, size_t triangle);
/** Puts what lies in a square or a cube: its `count` points are so many voxels off the middle. */
void vxm_meetings_put(vxm_meetings *meetings, const vxm_view *view, int kind, const int64_t lowest[3],
                      const double (*offsets)[3], int count);

/** The normal of a triangle, as twice its area. */
typedef struct vxm_link_surface {
  double size[3];     /**< of its components */
  bool is_measured;   /**< what follows is known: few triangles want it */
  int dominant;       /**< the axis along which it is longest, the lowest of equals */
  int64_t link_share; /**< its area for each link along that axis, in parts of a square of voxels */
} vxm_link_surface;

/** The normal of a triangle: its products are exact where it matters, to tell equals, of small numbers. */
static inline vxm_link_surface vxm_link_surface_of(const vxm_point corner[3]) {
  const int64_t *from = corner[0].at, *one = corner[1].at, *two = corner[2].at;
  const double x[2] = {(double)(one[0] - from[0]), (double)(two[0] - from[0])},
               y[2] = {(double)(one[1] - from[1]), (double)(two[1] - from[1])},
               z[2] = {(double)(one[2] - from[2]), (double)(two[2] - from[2])};
  return (vxm_link_surface){.size = {fabs(y[0] * z[1] - z[0] * y[1]), fabs(z[0] * x[1] - x[0] * z[1]),
                                     fabs(x[0] * y[1] - y[0] * x[1])}};
}

static inline double vxm_link_surface_length(const vxm_link_surface *surface) {
  const double *n = surface->size;
  return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/**
 * Links of one direction: columns along its axis w in a frame that is sheared along the others. A voxel at
 * (u, v, w) has column (u - s_u w, v - s_v w), s being the steps of the direction. The shear takes voxel
 * centres to voxel centres, and lattice points to lattice points.
 */
typedef struct vxm_link_frame {
  const vxm_thin_job *job;
  vxm_meetings *meetings;
  vxm_kept_bricks *kept;     /**< of the thread, if the view is of an octree */
  vxm_link_surface *surface; /**< its own */
  int direction, u, v, w;
  int inner;  /**< see vxm_octree_sieve_search */
  bool plain; /**< along an axis: no shear */
  int64_t shear[3];
  int64_t begin[3], end[3]; /**< columns, and voxels along w that are the upper end of a link of the view */
} vxm_link_frame;

/** The frames of a job's directions, for one thread. */
void vxm_link_frames(vxm_link_frame frames[VXM_LINK_DIRECTIONS], const vxm_thin_job *job,
                     vxm_meetings *meetings);
/** A triangle, which is told in the frame, crosses the link to voxel `to` of a column, `offset` voxels beyond
 * its middle: looks at its ends. */
void vxm_meet_link(const vxm_link_frame *frame, int64_t column_u, int64_t column_v, int64_t to,
                   double offset);
/** Keeps a link along an axis, both ends of which are in the view and not set, that the triangle crosses. */
void vxm_keep_link(const vxm_link_frame *frame, const int64_t lower[3], double offset);
/** The voxel beyond the plane of a triangle in a column, and how far the plane lies behind the centre before
 * that, in parts of a voxel: exactly. */
int64_t vxm_link_voxel(const vxm_link_frame *frame, const vxm_point corner[3], int64_t column_u,
                       int64_t column_v, double *rest);
/** The links that a triangle crosses. @param differ the axes along which its corners have different cells, or
 * all (vxm_cell_mask) @param unsure NULL, or links along axes that may have no voxel, and the others have */
void vxm_meet_links(vxm_link_frame *frames, size_t triangle, uint64_t differ, const vxm_unsure_links *unsure);
/** The squares in which its sections lie, and all links that it crosses. */
void vxm_meet_sections(vxm_link_frame *frames, size_t triangle, uint64_t differ);
/** The cube in which it lies, which is looked at later; nothing if it reaches into several, as it crosses
 * squares then. */
void vxm_meet_cube(vxm_meetings *meetings, const vxm_thin_job *job, size_t triangle);
/** The cubes of triangles, once links and squares have their voxels: few have none by then. */
void vxm_meet_cubes(vxm_meetings *meetings, const vxm_thin_job *job);

/** What triangles begin..end-1 meet: links along the axes, squares and cubes. The points' cells must be
 * known. */
void vxm_meet_by_cells(vxm_link_frame *frames, size_t begin, size_t end);

#endif
