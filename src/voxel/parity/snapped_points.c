/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/snapped_points.h"
#include "base/threads.h"
#include "voxel/parity/kernels.h"

#include <stdatomic.h>
#include <string.h>

enum { SLICE_POINTS = 8192 };

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* ---- Narrow points ---- */

double vxm_snapped_points_scale(const vxm_snapped_points *placed, int axis) {
  return (double)placed->lattice.unit / placed->lattice.space.voxel_size[axis];
}

/** The last cell along an axis: all centres lie before it. */
static int32_t last_cell(const vxm_lattice *lattice, int axis) {
  return (int32_t)vxm_min(lattice->space.dims[axis], (INT64_C(1) << VXM_CELL_BITS) - 1);
}

/** The cell of a narrow point. */
static uint64_t cell_of(const vxm_snapped_points *placed, const int32_t at[3]) {
  uint64_t cells = 0;
  for (int a = 0; a < 3; a++) {
    int64_t cell = vxm_lattice_first(&placed->lattice, at[a]), last = last_cell(&placed->lattice, a);
    cells |= (uint64_t)vxm_min(vxm_max(cell, 0), last) << (VXM_CELL_BITS * a);
  }
  return cells;
}

typedef struct place_job {
  vxm_snapped_points *placed;
  const vxm_vertex_transform *motion;
  const vxm_kernels *kernels;
  vxm_affine affine;
  size_t slices;
  atomic_bool beyond; /**< a point does not fit */
} place_job;

static vxm_affine affine_of(const vxm_snapped_points *placed, const vxm_vertex_transform *motion) {
  vxm_affine affine = {.bits = placed->lattice.bits,
                       .noise = motion->noise,
                       .noise_size = motion->noise_size,
                       .offset = motion->offset};
  for (int r = 0; r < 3; r++) {
    for (int c = 0; c < 4; c++)
      affine.column[c][r] = motion->matrix[4 * r + c];
    affine.origin[r] = placed->lattice.space.origin[r];
    affine.scale[r] = vxm_snapped_points_scale(placed, r);
    affine.cells[r] = last_cell(&placed->lattice, r);
  }
  return affine;
}

static void place_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  place_job *job = payload;
  const vxm_vertex_transform *motion = job->motion;
  size_t begin = vxm_slice_begin(motion->count, job->slices, slice),
         end = vxm_slice_begin(motion->count, job->slices, slice + 1);
  if (!job->kernels->place(job->placed->narrow + begin, job->placed->cells + begin, motion->from[begin],
                           motion->entry ? motion->entry + begin : NULL, end - begin, &job->affine))
    atomic_store_explicit(&job->beyond, true, memory_order_relaxed);
}

/** Whether all points fit. */
static bool place_narrow(vxm_snapped_points *placed, const vxm_vertex_transform *motion) {
  place_job job = {.placed = placed,
                   .motion = motion,
                   .kernels = vxm_kernels_get(),
                   .affine = affine_of(placed, motion),
                   .slices = 1 + motion->count / SLICE_POINTS};
  atomic_init(&job.beyond, false);
  vxm_parallel(placed->context, job.slices, place_slice, &job);
  return !atomic_load(&job.beyond);
}

typedef struct take_job {
  vxm_snapped_points *placed;
  size_t count, slices;
  atomic_bool beyond;
} take_job;

static void take_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  take_job *job = payload;
  vxm_snapped_points *placed = job->placed;
  int32_t misfit = 0;
  size_t end = vxm_slice_begin(job->count, job->slices, slice + 1);
  for (size_t p = vxm_slice_begin(job->count, job->slices, slice); p < end; p++) {
    placed->cells[p] = cell_of(placed, placed->narrow[p]);
    misfit |= placed->narrow[p][3];
  }
  if (misfit)
    atomic_store_explicit(&job->beyond, true, memory_order_relaxed);
}

bool vxm_snapped_points_take(vxm_snapped_points *placed, const vxm_triangle_set *triangles) {
  take_job job = {
      .placed = placed, .count = triangles->first_apex, .slices = 1 + triangles->first_apex / SLICE_POINTS};
  atomic_init(&job.beyond, false);
  vxm_parallel(placed->context, job.slices, take_slice, &job);
  return !atomic_load(&job.beyond);
}

/* ---- Wide points ---- */

static vxm_status refuse(const vxm_triangle_set *triangles, size_t point, const double from[3],
                         vxm_error *error) {
  uint32_t vertex = triangles->vertex[point];
  if (vertex < triangles->soup->vertex_count)
    return vxm_lattice_refuse(vertex, from, error);
  return vxm_fail(error, VXM_ERROR_RANGE, "a hole lies too many voxels outside the grid");
}

/** Places all points in 64 bits. */
static vxm_status place_wide(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                             const vxm_vertex_transform *motion, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  placed->wide = vxm_calloc(placed->context, triangles->point_count, sizeof *placed->wide, &local);
  vxm_status status = local.code;
  for (size_t p = 0; status == VXM_OK && p < triangles->first_apex; p++) {
    double at[1][3];
    vxm_vertex_transform_range(at, motion, p, p + 1);
    if (!vxm_lattice_place(&placed->lattice, at[0], &placed->wide[p]))
      status = refuse(triangles, p, motion->from[p], &local);
  }
  if (status != VXM_OK) {
    vxm_free(placed->context, placed->wide);
    placed->wide = NULL;
    vxm_error_pass(error, &local);
  }
  return status;
}

/* ---- Apexes ---- */

static void set_apex(vxm_snapped_points *placed, uint32_t apex, const int64_t at[3]) {
  for (int a = 0; a < 3; a++)
    placed->narrow[apex][a] = (int32_t)at[a];
  placed->narrow[apex][3] = 0;
  placed->cells[apex] = cell_of(placed, placed->narrow[apex]);
}

static void place_apex(vxm_snapped_points *placed, const vxm_triangle_set *triangles, size_t part) {
  const vxm_part *p = &triangles->parts[part];
  vxm_int128 sum[3] = {0, 0, 0};
  vxm_int128 corners = 3 * (vxm_int128)(p->caps - p->begin);
  for (size_t f = p->begin; f < p->caps; f++)
    for (int c = 0; c < 3; c++) {
      vxm_point q = vxm_snapped_points_at(placed, triangles->corners[f][c]);
      for (int a = 0; a < 3; a++)
        sum[a] += q.at[a];
    }
  uint32_t apex = vxm_apex_of(triangles, part);
  vxm_point mean = {{0, 0, 0}};
  for (int a = 0; a < 3 && corners > 0; a++)
    mean.at[a] = (int64_t)(sum[a] / corners);
  if (placed->wide)
    placed->wide[apex] = mean;
  else
    set_apex(placed, apex, mean.at);
}

/* ---- All of it ---- */

static vxm_status reserve(vxm_snapped_points *placed, size_t count, vxm_error *error) {
  if (placed->capacity >= count)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(placed->context, placed->narrow);
  vxm_free(placed->context, placed->cells);
  placed->narrow = vxm_alloc(placed->context, count, sizeof *placed->narrow, &local);
  placed->cells = vxm_alloc(placed->context, count, sizeof *placed->cells, &local);
  placed->capacity = placed->narrow && placed->cells ? count : 0;
  if (placed->capacity == 0)
    vxm_error_pass(error, &local);
  return local.code;
}

/** At most, once the points have moved: an edge of length a is at most a stretch + reach long. */
static vxm_edge_lengths moved_lengths(vxm_edge_lengths own, double stretch, double reach) {
  return (vxm_edge_lengths){own.count, own.sum * stretch + own.count * reach,
                            own.squared * stretch * stretch + 2 * own.sum * stretch * reach +
                                own.count * reach * reach};
}

vxm_status vxm_snapped_points_begin(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                    const vxm_lattice *lattice, const vxm_vertex_transform *motion,
                                    vxm_error *error) {
  static atomic_uint_fast64_t last_serial;
  placed->serial = atomic_fetch_add(&last_serial, 1) + 1;
  placed->lattice = *lattice;
  for (int s = 0; s < VXM_LENGTHS_SETS; s++)
    placed->lengths[s] = motion->stretch == 0
                             ? triangles->lengths[s]
                             : moved_lengths(triangles->lengths[s], motion->stretch, motion->reach);
  memcpy(placed->transform, identity, sizeof identity);
  vxm_free(placed->context, placed->wide);
  placed->wide = NULL;
  return reserve(placed, triangles->point_count, error);
}

void vxm_snapped_points_apexes(vxm_snapped_points *placed, const vxm_triangle_set *triangles, bool apexes) {
  for (size_t p = 0; p < triangles->split.part_count; p++)
    if (apexes)
      place_apex(placed, triangles, p);
    else if (!placed->wide) /* cones are looked at, if only to be left out */
      set_apex(placed, vxm_apex_of(triangles, p), (const int64_t[3]){0, 0, 0});
}

vxm_status vxm_snapped_points_move(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                   const vxm_lattice *lattice, const vxm_vertex_transform *motion,
                                   bool apexes, vxm_error *error) {
  vxm_status status = vxm_snapped_points_begin(placed, triangles, lattice, motion, error);
  if (status == VXM_OK && !place_narrow(placed, motion))
    status = place_wide(placed, triangles, motion, error);
  if (status == VXM_OK)
    vxm_snapped_points_apexes(placed, triangles, apexes);
  return status;
}

vxm_status vxm_snapped_points_set(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                  const vxm_lattice *lattice, const double transform[12], bool apexes,
                                  vxm_error *error) {
  vxm_vertex_transform motion = {.from = (const double(*)[3])triangles->positions,
                                 .count = triangles->first_apex,
                                 .matrix = transform ? transform : identity};
  vxm_status status = vxm_snapped_points_move(placed, triangles, lattice, &motion, apexes, error);
  memcpy(placed->transform, motion.matrix, sizeof identity);
  return status;
}

void vxm_snapped_points_destroy(vxm_snapped_points *placed) {
  vxm_free(placed->context, placed->wide);
  vxm_free(placed->context, placed->narrow);
  vxm_free(placed->context, placed->cells);
  *placed = (vxm_snapped_points){.context = placed->context};
}
