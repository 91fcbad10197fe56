/* SPDX-License-Identifier: BSD-3-Clause */
#include "experimental/baseline.h"

#include <string.h>

typedef vxm_status (*method)(const vxm_baseline_job *job, vxm_error *error);

static const method methods[] = {
    [VXM_BASELINE_FANG_CHEN] = vxm_baseline_axes,     [VXM_BASELINE_CHEN_TU] = vxm_baseline_axes,
    [VXM_BASELINE_TETRA_LISTED] = vxm_baseline_tetra, [VXM_BASELINE_TETRA_FULL] = vxm_baseline_tetra,
    [VXM_BASELINE_TETRA_ANEW] = vxm_baseline_tetra,   [VXM_BASELINE_TETRA_LAYERS] = vxm_baseline_tetra,
    [VXM_BASELINE_DENSITY] = vxm_baseline_density,    [VXM_BASELINE_SIMPLE] = vxm_baseline_boxes,
    [VXM_BASELINE_SPECIALIZED] = vxm_baseline_boxes,  [VXM_BASELINE_SORTED] = vxm_baseline_boxes,
    [VXM_BASELINE_ZHANG] = vxm_baseline_zhang,        [VXM_BASELINE_EISEMANN] = vxm_baseline_eisemann,
};

/** The methods have 64-bit products of three differences. */
static vxm_status check_triangles(const vxm_baseline_job *job, vxm_error *error) {
  size_t count = job->surface->triangle_count;
  if (count == 0)
    return vxm_fail(error, VXM_ERROR_EMPTY, "baseline: the mesh has no face of three different corners");
  for (size_t t = 0; t < count; t++) {
    vxm_point p[3];
    vxm_baseline_triangle(p, job, t);
    for (int a = 0; a < 3; a++) {
      int64_t low = vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]);
      int64_t high = vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]);
      if (high - low > VXM_LATTICE_NARROW)
        return vxm_fail(error, VXM_ERROR_RANGE,
                        "baseline: a triangle is %lld voxels long, which the products of 64 bits that a "
                        "baseline has do not hold; choose larger voxels",
                        (long long)((high - low) >> job->surface->lattice.bits));
    }
  }
  return VXM_OK;
}

static vxm_status fill(vxm_grid *grid, vxm_baseline_report *report, const vxm_surface *surface,
                       const vxm_baseline_options *options, vxm_error *error) {
  vxm_baseline_job job = {grid->context, grid, surface, options, report};
  memset(grid->words, 0, grid->word_count * sizeof *grid->words);
  report->triangles = (int64_t)surface->triangle_count;
  vxm_status status = check_triangles(&job, error);
  return status == VXM_OK ? methods[options->method](&job, error) : status;
}

vxm_status vxm_baseline_run(vxm_grid *grid, vxm_baseline_report *report, const vxm_soup *soup,
                            const vxm_baseline_options *options, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT; /* methods tell what failed by it */
  vxm_surface *surface = NULL;
  vxm_lattice lattice = vxm_lattice_of(&grid->space);
  double start = vxm_clock_ms();
  vxm_status status = vxm_surface_create(&surface, soup, &lattice, NULL, &local);
  if (status == VXM_OK)
    status = fill(grid, report, surface, options, &local);
  report->fill_ms = vxm_clock_ms() - start - report->setup_ms;
  vxm_surface_destroy(surface);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
