/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of repair: they check arguments and call down. */
#include "base/sized.h"
#include "repair/defects.h"
#include "repair/repair.h"
#include "repair/verify.h"

#include <inttypes.h>
#include <string.h>

/** A census that the caller may want. */
static void give_census(vxm_census *out, const vxm_census *made) {
  VXM_RESULT_WRITE(out, made);
}

typedef enum repair_purpose { FOR_ITSELF, TO_VOXELIZE, TO_VOXELIZE_IN_PLACE } repair_purpose;

static vxm_status run_for(repair_purpose purpose, vxm_mesh **out, vxm_repair_report *report,
                          const vxm_mesh *mesh, const vxm_repair_options *options, vxm_error *error) {
  switch (purpose) {
  case TO_VOXELIZE:
    return vxm_repair_prepare(out, report, mesh, options, error);
  case TO_VOXELIZE_IN_PLACE:
    return vxm_repair_prepare_owned(out, report, (vxm_mesh *)mesh, options, error);
  default:
    return vxm_repair_run(out, report, mesh, options, error);
  }
}

static vxm_status run(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                      const vxm_repair_options *options, repair_purpose purpose, vxm_error *error) {
  vxm_census before = {0}, after = {0};
  vxm_census *to_before = report && VXM_RESULT_HAS(report, before) ? report->before : NULL;
  vxm_census *to_after = report && VXM_RESULT_HAS(report, after) ? report->after : NULL;
  vxm_repair_report made = {.before = to_before ? &before : NULL, .after = to_after ? &after : NULL};
  vxm_repair_options chosen;
  if (out)
    *out = NULL;
  vxm_status status = VXM_OK;
  if (!out || !mesh)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: an argument is NULL");
  if (status == VXM_OK)
    status = vxm_repair_check(&chosen, options, error);
  if (status == VXM_OK)
    status = run_for(purpose, out, report ? &made : NULL, mesh, &chosen, error);
  else if (purpose == TO_VOXELIZE_IN_PLACE)
    vxm_soup_destroy((vxm_mesh *)mesh);
  if (status != VXM_OK) {
    made = (vxm_repair_report){0};
    before = after = (vxm_census){0};
  }
  made.before = to_before;
  made.after = to_after;
  VXM_RESULT_WRITE(report, &made);
  give_census(to_before, &before);
  give_census(to_after, &after);
  return status;
}

vxm_status vxm_mesh_repair(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                           const vxm_repair_options *options, vxm_error *error) {
  return run(out, report, mesh, options, FOR_ITSELF, error);
}

vxm_status vxm_mesh_prepare(vxm_mesh **out, vxm_repair_report *report, const vxm_mesh *mesh,
                            const vxm_repair_options *options, vxm_error *error) {
  return run(out, report, mesh, options, TO_VOXELIZE, error);
}

vxm_status vxm_mesh_prepare_in_place(vxm_mesh **mesh, vxm_repair_report *report,
                                     const vxm_repair_options *options, vxm_error *error) {
  vxm_mesh *given = mesh ? *mesh : NULL;
  return run(mesh, report, given, options, TO_VOXELIZE_IN_PLACE, error);
}

int64_t vxm_mesh_part_change_count(const vxm_mesh *repaired) {
  return repaired ? (int64_t)repaired->part_count : 0;
}

const vxm_part_change *vxm_mesh_part_change(const vxm_mesh *repaired, int64_t index) {
  return index >= 0 && index < vxm_mesh_part_change_count(repaired) ? &repaired->part_changes[index] : NULL;
}

static vxm_status check_both(vxm_repair_options *repair, const vxm_repair_options *given,
                             vxm_mesh_write_options *write, const vxm_mesh_write_options *given_write,
                             vxm_error *error) {
  *write = (vxm_mesh_write_options)VXM_MESH_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(write, given_write, "verify", error);
  return status == VXM_OK ? vxm_repair_check(repair, given, error) : status;
}

vxm_status vxm_mesh_verify(vxm_verification *out, const vxm_mesh *mesh, const vxm_repair_options *options,
                           vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "verify: an argument is NULL");
  vxm_repair_options repair;
  vxm_mesh_write_options write;
  vxm_status status = check_both(&repair, options, &write, NULL, error);
  vxm_verification found = {0};
  if (status == VXM_OK)
    status = vxm_verify(&found, mesh, &repair, error);
  VXM_RESULT_WRITE(out, &found);
  return status;
}

vxm_status vxm_mesh_write_verified(vxm_verification *out, const vxm_mesh *mesh, const char *path,
                                   const vxm_mesh_write_options *write, const vxm_repair_options *repair,
                                   bool best_effort, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "mesh: an argument is NULL");
  vxm_repair_options chosen;
  vxm_mesh_write_options chosen_write;
  vxm_status status = check_both(&chosen, repair, &chosen_write, write, error);
  if (status != VXM_OK)
    return status;
  vxm_verification found = {0};
  status = vxm_write_verified(&found, mesh, path, &chosen_write, &chosen, best_effort, error);
  VXM_RESULT_WRITE(out, &found);
  return status;
}

vxm_status vxm_mesh_defects(vxm_defects **out, const vxm_mesh *mesh, int64_t max_count, bool intersections,
                            vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !mesh || max_count < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "defects: an argument is NULL, or a number of %" PRId64,
                    max_count);
  return vxm_defects_find(out, mesh, (size_t)max_count, intersections, error);
}

int64_t vxm_defects_count(const vxm_defects *defects) {
  return defects ? (int64_t)defects->count : 0;
}

const vxm_defect *vxm_defects_item(const vxm_defects *defects, int64_t index) {
  return index >= 0 && index < vxm_defects_count(defects) ? &defects->items[index] : NULL;
}

int64_t vxm_defects_total(const vxm_defects *defects, vxm_defect_kind kind) {
  return defects && kind >= 0 && kind < VXM_DEFECT_KINDS ? defects->totals[kind] : 0;
}

vxm_status vxm_defects_write(const vxm_defects *defects, const vxm_mesh *mesh, const char *path,
                             vxm_error *error) {
  if (!defects || !mesh || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "defects: an argument is NULL");
  if (defects->vertex_count != mesh->vertex_count || defects->face_count != mesh->face_count)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "defects: they are of another mesh");
  return vxm_defects_paint(defects, mesh, path, error);
}
