/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A tool along its path. Where it moves without turning each of its faces sweeps a prism; what the tool has
 * been in before is cut already, and whatever it newly comes to one of its faces has to pass. Where it turns,
 * the step is halved until no point moves by more than half a voxel through the turn; in each part the
 * corners of faces go straight ahead, and what a face sweeps is three tetrahedra.
 */
#include "carve/carver.h"

#include <math.h>
#include <string.h>

/** How far a point may go in one part of a turn, voxels. */
static const double turn_voxels = 0.5;

vxm_status vxm_carver_steps(int64_t out[3], const vxm_carver *carver, const vxm_tool_pose *pose,
                            vxm_error *error) {
  vxm_point point;
  if (!vxm_lattice_place(&carver->lattice, pose->place, &point))
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "carver: the tool at (%g, %g, %g) lies too many voxels outside the grid", pose->place[0],
                    pose->place[1], pose->place[2]);
  memcpy(out, point.at, sizeof point.at);
  return VXM_OK;
}

void vxm_carver_turn(const vxm_carver *carver, vxm_turned_points *out, const vxm_tool_pose *pose) {
  const double(*positions)[3] = (const double(*)[3])carver->model->analysis.triangles.positions;
  double rotation[9], scale[3];
  vxm_tool_pose_rotation(rotation, pose);
  for (int a = 0; a < 3; a++) {
    scale[a] = (double)carver->lattice.unit / carver->lattice.space.voxel_size[a];
    out->low[a] = INT64_MAX;
    out->high[a] = INT64_MIN;
  }
  for (size_t p = 0; p < carver->point_count; p++)
    for (int a = 0; a < 3; a++) {
      const double *row = rotation + (ptrdiff_t)3 * a, *at = positions[p];
      int64_t step = (int64_t)llrint((row[0] * at[0] + row[1] * at[1] + row[2] * at[2]) * scale[a]);
      out->at[p].at[a] = step;
      out->low[a] = vxm_min(out->low[a], step);
      out->high[a] = vxm_max(out->high[a], step);
    }
}

/** Has `from` hold the points as they are turned in a pose. */
static void turn_from(vxm_carver *carver, const vxm_tool_pose *pose) {
  if (memcmp(carver->from_pose.turn, pose->turn, sizeof pose->turn) != 0)
    vxm_carver_turn(carver, &carver->from, pose);
  carver->from_pose = *pose;
}

/* ---- Straight ahead ---- */

/** Whether voxels can be cut where a tool moves from one place to another. */
static bool meets_stock(const vxm_carver *carver, const vxm_turned_points *points, const int64_t from[3],
                        const int64_t to[3]) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = points->low[a] + vxm_min(from[a], to[a]);
    high[a] = points->high[a] + vxm_max(from[a], to[a]);
  }
  vxm_voxel_box box = vxm_voxel_box_of(&carver->lattice, low, high);
  return !vxm_voxel_box_is_empty(&box);
}

static void sweep_piece(vxm_carver *carver, const int64_t from[3], const int64_t to[3]) {
  const vxm_point *points = carver->from.at;
  if (!meets_stock(carver, &carver->from, from, to))
    return;
  int64_t motion[3], back[3], ahead[3];
  for (int a = 0; a < 3; a++) {
    motion[a] = to[a] - from[a];
    back[a] = vxm_min(from[a], to[a]);
    ahead[a] = vxm_max(from[a], to[a]);
  }
  for (size_t t = 0; t < carver->triangle_count; t++) {
    const uint32_t *c = carver->triangles[t];
    const int64_t *p = points[c[0]].at, *q = points[c[1]].at, *r = points[c[2]].at;
    int64_t low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = vxm_min(p[a], vxm_min(q[a], r[a])) + back[a];
      high[a] = vxm_max(p[a], vxm_max(q[a], r[a])) + ahead[a];
    }
    vxm_voxel_box box = vxm_voxel_box_of(&carver->lattice, low, high);
    if (vxm_voxel_box_is_empty(&box) || vxm_stock_is_clear(&carver->stock, box.first, box.last))
      continue;
    vxm_point corners[3];
    for (int a = 0; a < 3; a++) {
      corners[0].at[a] = p[a] + from[a];
      corners[1].at[a] = q[a] + from[a];
      corners[2].at[a] = r[a] + from[a];
    }
    vxm_convex_cut_prism(&carver->stock, &carver->lattice, corners, motion, &box);
  }
}

/** The pieces of a straight path that can meet the stock are among these; none if first > last. */
static void find_pieces(const vxm_carver *carver, const int64_t from[3], const int64_t to[3], int64_t pieces,
                        int64_t *first, int64_t *last) {
  double begin = 0, end = 1;
  for (int a = 0; a < 3; a++) { /* the tool meets the stock from when its front has come to it ... */
    double motion = (double)(to[a] - from[a]),
           dim = (double)(carver->lattice.space.dims[a] * carver->lattice.unit),
           low = (double)(carver->from.low[a] + from[a]), high = (double)(carver->from.high[a] + from[a]);
    if (motion == 0)
      continue;
    begin = fmax(begin, motion > 0 ? -high / motion : (dim - low) / motion);
    end = fmin(end, motion > 0 ? (dim - low) / motion : -high / motion); /* ... until its back has left it */
  }
  *first = (int64_t)fmax(1, floor(fmin(begin, 1) * (double)pieces) - 1);
  *last = (int64_t)fmin((double)pieces, ceil(fmax(end, 0) * (double)pieces) + 1);
}

/** After so many of the pieces of a path. */
static void place_after(int64_t out[3], const int64_t from[3], const int64_t to[3], int64_t piece,
                        int64_t pieces) {
  for (int a = 0; a < 3; a++)
    out[a] = from[a] + (int64_t)((vxm_int128)(to[a] - from[a]) * piece / pieces);
}

/** A long path in pieces, as the boxes of prisms askew have far more voxels than they. */
static void sweep_straight(vxm_carver *carver, const int64_t from[3], const int64_t to[3]) {
  int64_t longest = 0, first, last, at[3], next[3];
  for (int a = 0; a < 3; a++)
    longest = vxm_max(longest, to[a] > from[a] ? to[a] - from[a] : from[a] - to[a]);
  if (longest == 0 || !meets_stock(carver, &carver->from, from, to))
    return;
  int64_t pieces = (longest + carver->piece - 1) / carver->piece;
  find_pieces(carver, from, to, pieces, &first, &last);
  for (int64_t i = first; i <= last; i++) {
    place_after(at, from, to, i - 1, pieces);
    place_after(next, from, to, i, pieces);
    sweep_piece(carver, at, next);
  }
}

/* ---- Turning ---- */

/** What a triangle sweeps whose corners move from three points to three others. */
static void sweep_triangle(vxm_carver *carver, const vxm_point from[3], const vxm_point to[3]) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = vxm_min(from[0].at[a], to[0].at[a]);
    high[a] = vxm_max(from[0].at[a], to[0].at[a]);
    for (int c = 1; c < 3; c++) {
      low[a] = vxm_min(low[a], vxm_min(from[c].at[a], to[c].at[a]));
      high[a] = vxm_max(high[a], vxm_max(from[c].at[a], to[c].at[a]));
    }
  }
  vxm_voxel_box box = vxm_voxel_box_of(&carver->lattice, low, high);
  if (vxm_voxel_box_is_empty(&box) || vxm_stock_is_clear(&carver->stock, box.first, box.last))
    return;
  const vxm_point tetrahedra[3][4] = {
      {from[0], from[1], from[2], to[2]}, {from[0], from[1], to[1], to[2]}, {from[0], to[0], to[1], to[2]}};
  for (int t = 0; t < 3; t++)
    vxm_convex_cut_tetrahedron(&carver->stock, &carver->lattice, tetrahedra[t], &box);
}

static void sweep_part(vxm_carver *carver, const vxm_tool_pose *to, const int64_t from_place[3],
                       const int64_t to_place[3]) {
  vxm_carver_turn(carver, &carver->to, to);
  for (size_t t = 0; t < carver->triangle_count; t++) {
    vxm_point from_corners[3], to_corners[3];
    for (int c = 0; c < 3; c++) {
      uint32_t p = carver->triangles[t][c];
      for (int a = 0; a < 3; a++) {
        from_corners[c].at[a] = carver->from.at[p].at[a] + from_place[a];
        to_corners[c].at[a] = carver->to.at[p].at[a] + to_place[a];
      }
    }
    sweep_triangle(carver, from_corners, to_corners);
  }
  vxm_turned_points turned = carver->from;
  carver->from = carver->to;
  carver->to = turned;
  carver->from_pose = *to;
}

/** Whether the tool, however it is turned, can meet the stock between two places. */
static bool may_meet_stock(const vxm_carver *carver, const int64_t from[3], const int64_t to[3]) {
  const vxm_lattice *lattice = &carver->lattice;
  const double *size = lattice->space.voxel_size;
  double least = fmin(size[0], fmin(size[1], size[2]));
  for (int a = 0; a < 3; a++) {
    int64_t reach = (int64_t)(carver->reach * least / size[a] * (double)lattice->unit) + 2;
    if (vxm_max(from[a], to[a]) + reach < 0 ||
        vxm_min(from[a], to[a]) - reach > lattice->space.dims[a] * lattice->unit)
      return false;
  }
  return true;
}

static vxm_status sweep_turn(vxm_carver *carver, const vxm_tool_pose *from, const vxm_tool_pose *to,
                             vxm_error *error) {
  int64_t from_place[3], to_place[3];
  vxm_status status = vxm_carver_steps(from_place, carver, from, error);
  if (status == VXM_OK)
    status = vxm_carver_steps(to_place, carver, to, error);
  if (status != VXM_OK || !may_meet_stock(carver, from_place, to_place))
    return status;
  bool is_short = vxm_tool_pose_angle(from, to) * carver->reach <= turn_voxels;
  for (int a = 0; a < 3; a++)
    is_short &= to_place[a] - from_place[a] <= carver->piece && from_place[a] - to_place[a] <= carver->piece;
  if (is_short) {
    turn_from(carver, from);
    sweep_part(carver, to, from_place, to_place);
    return carver->stock.status;
  }
  vxm_tool_pose middle;
  vxm_tool_pose_middle(&middle, from, to);
  status = sweep_turn(carver, from, &middle, error);
  return status == VXM_OK ? sweep_turn(carver, &middle, to, error) : status;
}

vxm_status vxm_carver_sweep(vxm_carver *carver, const vxm_tool_pose *pose, vxm_error *error) {
  vxm_tool_pose to = *pose;
  int64_t from_place[3], to_place[3];
  vxm_tool_pose_approach(&to, &carver->pose);
  vxm_status status = vxm_carver_steps(from_place, carver, &carver->pose, error);
  if (status == VXM_OK)
    status = vxm_carver_steps(to_place, carver, &to, error);
  if (status != VXM_OK)
    return status;
  if (memcmp(carver->pose.turn, to.turn, sizeof to.turn) == 0) {
    turn_from(carver, &to);
    sweep_straight(carver, from_place, to_place);
    status = carver->stock.status;
  } else
    status = sweep_turn(carver, &carver->pose, &to, error);
  if (status == VXM_OK)
    carver->pose = to;
  return status;
}
