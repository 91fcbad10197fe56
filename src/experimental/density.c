/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Sramek and Kaufman 1999, alias-free voxelization, of surfaces: an object is a density over space that falls
 * linearly with the distance from it and is 0 beyond a radius, 1.8 voxels by their study of filters; the
 * volume holds samples of it at the centres, of all triangles the largest. It takes no care of the inside.
 *
 * Where bits are wanted, voxels of a density of a half and more are set. With their radius that is within 0.9
 * voxels of the surface: more than half of a voxel's diagonal, so that none that the surface touches is
 * missed.
 */
#include "experimental/baseline.h"
#include "voxel/closest/closest_point.h"

#include <math.h>
#include <string.h>

typedef struct work {
  const vxm_baseline_job *job;
  double radius;
  uint8_t *density;
} work;

/** Splats one triangle, in units of voxels. */
static void draw(const work *w, const double at[3][3]) {
  const int64_t *dims = w->job->grid->space.dims;
  int64_t first[3], end[3];
  vxm_closest_triangle triangle;
  vxm_closest_triangle_make(&triangle, at);
  for (int a = 0; a < 3; a++) {
    double low = fmin(fmin(at[0][a], at[1][a]), at[2][a]), high = fmax(fmax(at[0][a], at[1][a]), at[2][a]);
    first[a] = (int64_t)fmin(fmax(ceil(low - w->radius - 0.5), 0), (double)dims[a]);
    end[a] = (int64_t)fmin(floor(high + w->radius - 0.5) + 1, (double)dims[a]);
  }
  for (int64_t k = first[2]; k < end[2]; k++)
    for (int64_t j = first[1]; j < end[1]; j++)
      for (int64_t i = first[0]; i < end[0]; i++) {
        const double centre[3] = {(double)i + 0.5, (double)j + 0.5, (double)k + 0.5};
        double foot[3], share = 1 - sqrt(vxm_closest_point(&triangle, centre, foot)) / w->radius;
        uint8_t *density = &w->density[(k * dims[1] + j) * dims[0] + i];
        uint8_t value = share > 0 ? (uint8_t)lrint(255 * share) : 0;
        w->job->report->tests++;
        *density = value > *density ? value : *density;
      }
}

static vxm_status draw_all(const work *w, vxm_error *error) {
  const vxm_surface *surface = w->job->surface;
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < surface->triangle_count && status == VXM_OK; t++) {
    vxm_point p[3];
    double at[3][3];
    vxm_baseline_triangle(p, w->job, t);
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        at[c][a] = (double)p[c].at[a] / (double)surface->lattice.unit;
    draw(w, (const double(*)[3])at);
    status = vxm_check_cancelled_at(64 * t, w->job->context, error);
  }
  return status;
}

static void set_bits(const work *w) {
  const int64_t *dims = w->job->grid->space.dims;
  const uint8_t *density = w->density;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++)
        if (*density++ > 127)
          vxm_baseline_set(w->job->grid, (const int64_t[]){i, j, k});
}

vxm_status vxm_baseline_density(const vxm_baseline_job *job, vxm_error *error) {
  const int64_t *dims = job->grid->space.dims;
  size_t voxels = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2]; /* the grid has a bit of each */
  work w = {job, job->options->radius > 0 ? job->options->radius : 1.8, job->options->density};
  uint8_t *own = w.density ? NULL : vxm_baseline_block(job, voxels, 1, error);
  if (!w.density && !own)
    return error->code;
  w.density = own ? own : w.density;
  memset(w.density, 0, voxels);
  vxm_status status = draw_all(&w, error);
  if (status == VXM_OK)
    set_bits(&w);
  vxm_free(job->context, own);
  return status;
}
