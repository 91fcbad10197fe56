/* SPDX-License-Identifier: BSD-3-Clause */
/** Published methods in `voxmend bench`, on the mesh and the grid of the other phases. */
#include "cli/baseline.h"
#include "cli/bench.h"

static vxm_status begin(bench_stage *stage, vxm_baseline method, bool thin) {
  stage->baseline = (vxm_baseline_options)VXM_BASELINE_OPTIONS_INIT;
  stage->baseline.method = method;
  stage->baseline.thin = thin;
  if (stage->grid)
    return VXM_OK;
  return vxm_grid_create(&stage->grid, stage->cli->context, &stage->space, &stage->cli->error);
}

vxm_status bench_run_baseline(bench_stage *stage) {
  stage->baseline_report = (vxm_baseline_report)VXM_BASELINE_REPORT_INIT;
  return vxm_baseline_voxelize(stage->grid, &stage->baseline_report, stage->mesh, &stage->baseline,
                               &stage->cli->error);
}

void bench_tell_baseline(bench_output *out, const bench_stage *stage) {
  const int64_t *dims = stage->space.dims;
  uint64_t words = (uint64_t)vxm_grid_row_words(stage->grid) * (uint64_t)dims[1] * (uint64_t)dims[2];
  out->bytes = words * sizeof(uint64_t);
  out->voxels = vxm_grid_count(stage->grid);
  out->figures = cli_baseline_figures(&stage->baseline_report);
}

vxm_status bench_begin_fang_chen(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_FANG_CHEN, false);
}

vxm_status bench_begin_chen_tu(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_CHEN_TU, false);
}

vxm_status bench_begin_tetra_listed(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_TETRA_LISTED, false);
}

vxm_status bench_begin_tetra_full(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_TETRA_FULL, false);
}

vxm_status bench_begin_tetra_anew(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_TETRA_ANEW, false);
}

vxm_status bench_begin_tetra_layers(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_TETRA_LAYERS, false);
}

vxm_status bench_begin_density(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_DENSITY, false);
}

vxm_status bench_begin_simple(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SIMPLE, false);
}

vxm_status bench_begin_simple_thin(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SIMPLE, true);
}

vxm_status bench_begin_specialized(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SPECIALIZED, false);
}

vxm_status bench_begin_specialized_thin(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SPECIALIZED, true);
}

vxm_status bench_begin_sorted(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SORTED, false);
}

vxm_status bench_begin_sorted_thin(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_SORTED, true);
}

vxm_status bench_begin_zhang(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_ZHANG, false);
}

vxm_status bench_begin_eisemann(bench_stage *stage) {
  return begin(stage, VXM_BASELINE_EISEMANN, false);
}
