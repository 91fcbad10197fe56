/* SPDX-License-Identifier: BSD-3-Clause */
/** A tool that cuts what it moves through. A vxm_carver of the public header. */
#ifndef VXM_CARVE_CARVER_H
#define VXM_CARVE_CARVER_H

#include "carve/convex.h"
#include "carve/motion.h"
#include "voxel/model/model_instance.h"
#include "voxmend/carve.h"

/** Points of the tool, turned, in lattice steps from its origin. */
typedef struct vxm_turned_points {
  vxm_point *at;
  int64_t low[3], high[3];
} vxm_turned_points;

struct vxm_carver {
  vxm_context *context; /**< one reference held */
  vxm_stock stock;
  vxm_lattice lattice; /**< of the stock's space */
  vxm_model *model;    /**< the tool: its faces, and the caps of its holes */
  vxm_model_instance instance;
  uint32_t (*triangles)[3]; /**< each with its corners in the order of their positions */
  size_t triangle_count, point_count;
  double reach;       /**< how far from its origin the tool reaches, voxels */
  int64_t piece;      /**< a straight path is cut piece by piece, each at most so many steps long */
  double (*moved)[3]; /**< the points in a window */
  uint64_t *words;    /**< of that window */
  size_t word_capacity;
  vxm_turned_points from, to;
  vxm_tool_pose from_pose; /**< whose points `from` has; where the tool is unless it is nowhere */
  vxm_tool_pose pose;
  bool is_placed;
};

/** Makes a carver of a stock that has no tiles yet. @return as vxm_carver_create */
vxm_status vxm_carver_make(vxm_carver **out, vxm_context *context, const vxm_stock *stock,
                           const vxm_soup *tool, vxm_error *error);
/** Where the tool's origin is, in lattice steps. @return VXM_OK; VXM_ERROR_RANGE if it is too far away */
vxm_status vxm_carver_steps(int64_t out[3], const vxm_carver *carver, const vxm_tool_pose *pose,
                            vxm_error *error);
/** Turns the points of the tool. */
void vxm_carver_turn(const vxm_carver *carver, vxm_turned_points *out, const vxm_tool_pose *pose);
/** See vxm_carver_place; the stock says what was removed. */
vxm_status vxm_carver_stamp(vxm_carver *carver, const vxm_tool_pose *pose, vxm_error *error);
/** See vxm_carver_move. */
vxm_status vxm_carver_sweep(vxm_carver *carver, const vxm_tool_pose *pose, vxm_error *error);

#endif
