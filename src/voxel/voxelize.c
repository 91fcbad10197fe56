/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/voxelize.h"
#include "voxel/parity.h"
#include "voxel/tetra.h"
#include "voxel/vote.h"

#include <inttypes.h>
#include <stdatomic.h>

typedef struct solid {
  vxm_grid *grid;
  vxm_lattice lattice;
  vxm_facets facets;
  atomic_uchar *touched;
  int64_t contested;
} solid;

/** The voters of open parts, in the order of vxm_vote_combine. */
enum { VOTERS = 4 };

static vxm_unite_job job_for(const solid *s, int axis, size_t part_begin, size_t part_end) {
  static const char *const phase[3] = {"voxelizing along x", "voxelizing along y", "voxelizing along z"};
  return (vxm_unite_job){.facets = &s->facets,
                         .lattice = &s->lattice,
                         .axes = vxm_axes_of(axis),
                         .part_begin = part_begin,
                         .part_end = part_end,
                         .touched = s->touched,
                         .phase = phase[axis]};
}

/** Parts that are closed mod 2 look the same to every voter, so one axis settles them. */
static vxm_status unite_closed_parts(solid *s, vxm_error *error) {
  vxm_unite_job job = job_for(s, 0, 0, s->facets.closed_count);
  return vxm_parity_unite(s->grid, &job, error);
}

static vxm_status vote_on_open_parts(solid *s, vxm_vote rule, vxm_error *error) {
  vxm_grid *voters[VOTERS] = {NULL};
  vxm_status status = VXM_OK;
  for (int v = 0; v < VOTERS && status == VXM_OK; v++) {
    status = vxm_grid_create(&voters[v], s->grid->context, &s->lattice.space, error);
    if (status != VXM_OK)
      break;
    vxm_unite_job job = job_for(s, v < 3 ? v : 0, s->facets.closed_count, s->facets.part_count);
    job.with_cones = v == 3;
    status = vxm_parity_unite(voters[v], &job, error);
  }
  if (status == VXM_OK)
    vxm_vote_combine(s->grid, voters, rule, &s->contested);
  for (int v = 0; v < VOTERS; v++)
    vxm_grid_destroy(voters[v]);
  return status;
}

static vxm_status unite_all_parts(solid *s, vxm_method method, vxm_error *error) {
  vxm_unite_job job =
      job_for(s, method == VXM_METHOD_TETRA ? 0 : (int)method - VXM_METHOD_X, 0, s->facets.part_count);
  if (method != VXM_METHOD_TETRA)
    return vxm_parity_unite(s->grid, &job, error);
  job.phase = "voxelizing tetrahedra";
  return vxm_tetra_unite(s->grid, &job, error);
}

static vxm_status fill(solid *s, const vxm_voxelize_options *options, vxm_error *error) {
  if (options->method != VXM_METHOD_VOTE)
    return unite_all_parts(s, options->method, error);
  vxm_status status = unite_closed_parts(s, error);
  if (status == VXM_OK && s->facets.closed_count < s->facets.part_count)
    status = vote_on_open_parts(s, options->vote, error);
  return status;
}

/* ---- Report and warnings ---- */

static void fill_report(vxm_voxelize_report *report, const solid *s) {
  report->parts = (int64_t)s->facets.part_count;
  report->closed_parts = (int64_t)s->facets.closed_count;
  report->contested = s->contested;
  report->voxels = vxm_grid_count(s->grid);
  report->hash = vxm_grid_hash(s->grid);
  for (size_t p = 0; p < s->facets.part_count; p++)
    report->empty_parts += !atomic_load_explicit(&s->touched[p], memory_order_relaxed);
}

static void warn(solid *s, const vxm_voxelize_report *report) {
  vxm_notes *notes = &s->grid->notes;
  if (report->voxels == 0)
    vxm_note(notes, "no voxel centre is inside: the model is open, flat or thinner than a voxel; try a "
                    "higher resolution (-r) or --vote any");
  else if (report->empty_parts > 0)
    vxm_note(notes,
             "%" PRId64 " of %" PRId64 " parts hold no voxel centre: they are thinner than a voxel or open "
             "sheets; a higher resolution (-r) may show them",
             report->empty_parts, report->parts);
  if (report->contested > 0)
    vxm_note(notes,
             "the model is open (%zu odd edges) and its voters disagree on %" PRId64
             " voxels; compare --vote any, --vote all and --parts whole",
             s->facets.odd_edge_count, report->contested);
}

/** What will be needed at once, checked before the work starts. */
static vxm_status check_memory(const solid *s, const vxm_soup *soup, const vxm_voxelize_options *options,
                               vxm_error *error) {
  bool votes = options->method == VXM_METHOD_VOTE && s->facets.closed_count < s->facets.part_count;
  uint64_t grids = votes ? 1 + VOTERS : 1, bytes;
  if (__builtin_mul_overflow(grids, vxm_space_bytes(&s->lattice.space), &bytes))
    return vxm_fail(error, VXM_ERROR_RANGE, "the grid is beyond what can be addressed; lower the resolution");
  return vxm_memory_check(soup->context, bytes, "voxelizing", error);
}

vxm_status vxm_voxelize_run(vxm_grid **out, vxm_voxelize_report *report, const vxm_soup *soup,
                            const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error) {
  *out = NULL;
  solid s = {.lattice = vxm_lattice_of(space)};
  vxm_context *context = soup->context;
  vxm_status status = vxm_facets_create(&s.facets, soup, &s.lattice, options->parts, error);
  if (status != VXM_OK)
    return status;
  if (s.facets.facet_count == 0)
    status = vxm_fail(error, VXM_ERROR_EMPTY,
                      "the mesh has no face with three different corners, so there is nothing to voxelize");
  if (status == VXM_OK)
    status = check_memory(&s, soup, options, error);
  if (status == VXM_OK)
    status = vxm_grid_create(&s.grid, context, space, error);
  if (status == VXM_OK) {
    vxm_error local = VXM_ERROR_INIT;
    s.touched = vxm_calloc(context, s.facets.part_count, sizeof *s.touched, &local);
    status = s.touched ? VXM_OK : local.code;
    if (!s.touched && error)
      *error = local;
  }
  if (status == VXM_OK)
    status = fill(&s, options, error);
  if (status == VXM_OK) {
    fill_report(report, &s);
    warn(&s, report);
    *out = s.grid;
    s.grid = NULL;
  }
  vxm_grid_destroy(s.grid);
  vxm_free(context, s.touched);
  vxm_facets_destroy(&s.facets);
  return status;
}
