/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of carvers: they check arguments and call down. */
#include "base/sized.h"
#include "carve/carver.h"

vxm_status vxm_carver_create(vxm_carver **out, vxm_grid *grid, const vxm_mesh *tool, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !grid || !tool)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: an argument is NULL");
  vxm_stock stock = vxm_stock_of_grid(grid);
  return vxm_carver_make(out, grid->context, &stock, tool, error);
}

vxm_status vxm_carver_create_sparse(vxm_carver **out, const vxm_sparse *sparse, const vxm_mesh *tool,
                                    vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !sparse || !tool)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: an argument is NULL");
  vxm_stock stock = vxm_stock_of_sparse(sparse->context, sparse);
  return vxm_carver_make(out, sparse->context, &stock, tool, error);
}

/** Tells what was removed since vxm_stock_begin. */
static void tell(vxm_carve_report *report, const vxm_stock *stock) {
  vxm_carve_report made = {.removed = stock->removed};
  for (int a = 0; a < 3 && made.removed > 0; a++) {
    made.begin[a] = stock->low[a];
    made.end[a] = stock->high[a] + 1;
  }
  VXM_RESULT_WRITE(report, &made);
}

static vxm_status step(vxm_carve_report *report, vxm_carver *carver, const double pose[12], bool moves,
                       vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!carver || !pose)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: an argument is NULL");
  vxm_tool_pose to;
  vxm_status status = vxm_tool_pose_read(&to, pose, error);
  if (status != VXM_OK)
    return status;
  vxm_stock_begin(&carver->stock, error);
  status = moves && carver->is_placed ? vxm_carver_sweep(carver, &to, error)
                                      : vxm_carver_stamp(carver, &to, error);
  carver->stock.error = NULL; /* it is the caller's */
  if (status == VXM_OK)
    tell(report, &carver->stock);
  return status;
}

vxm_status vxm_carver_place(vxm_carve_report *report, vxm_carver *carver, const double pose[12],
                            vxm_error *error) {
  return step(report, carver, pose, false, error);
}

vxm_status vxm_carver_move(vxm_carve_report *report, vxm_carver *carver, const double pose[12],
                           vxm_error *error) {
  return step(report, carver, pose, true, error);
}

vxm_status vxm_carver_sparse(vxm_sparse **out, const vxm_carver *carver, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !carver)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: an argument is NULL");
  if (!carver->stock.sparse)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: it cuts a grid, not an octree");
  return vxm_stock_octree(out, &carver->stock, error);
}
