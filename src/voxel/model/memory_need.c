/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/memory_need.h"
#include "voxel/parity/odd_lines.h"
#include "voxel/solid/orient_open.h"
#include "voxel/thin/sieve.h"
#include "voxel/thin/thin.h"

#include <math.h>

int vxm_model_windows_held(const vxm_model *model) {
  int buffers = vxm_solid_wanted(&model->options) ? vxm_buffers_wanted(&model->analysis, &model->options) : 0;
  if (model->options.confidence) /* a byte per voxel, four voters, what is contested and what closed parts
                                    fill; winding numbers */
    buffers = 8 + 6 + 2 * 6;
  return 1 + vxm_shell_wanted(&model->options) + buffers;
}

/** What deciding open parts takes beside windows: patches and trees, the grids by which they are turned, and
 * slabs along slices. */
static uint64_t decision_bytes(const vxm_model *model, const vxm_window *shape) {
  const vxm_triangle_set *triangles = &model->analysis.triangles;
  bool winding = model->options.method == VXM_METHOD_WINDING;
  size_t begin = winding ? 0 : vxm_voted_begin(&model->analysis, &model->options),
         end = triangles->split.part_count;
  uint64_t threads = (uint64_t)vxm_context_threads(model->context);
  uint64_t bins = 5 * threads * (uint64_t)(shape->slow_dim + shape->middle_dim) * sizeof(vxm_crossing_bin);
  if (vxm_overlaps_wanted(&model->analysis, &model->options))
    bins += model->analysis.self_overlap.chain.closed_count * VXM_TURNED_BYTES;
  bool one = vxm_one_voter(&model->options);
  if (begin >= end && !one)
    return bins;
  uint64_t slabs = threads * shape->row_words * (uint64_t)shape->slow_dim * sizeof(uint64_t);
  if (one || !vxm_caps_wanted(&model->options))
    return bins + slabs;
  vxm_window whole = *shape;
  whole.begin = 0;
  whole.end = whole.slow_dim;
  uint64_t lines = vxm_odd_lines_bytes(&whole, end - begin);
  uint64_t held = begin < end ? triangles->parts[end - 1].end - triangles->parts[begin].begin : 0;
  return bins + slabs + lines + held * VXM_TURNED_BYTES + VXM_ORIENT_BYTES;
}

/** What is held while thin parts are looked for: all meetings, of which there are most where all of the
 * surface is thin, and the order of triangles, or maps and short numbers of the cells of points. */
static uint64_t thin_bytes(const vxm_model *model, const vxm_space *space, const vxm_window *shape) {
  const vxm_triangle_set *triangles = &model->analysis.triangles;
  enum { AXES = 3 };
  double all = vxm_raster_schedule_bound(triangles->lengths, VXM_ROLE_FACE, space, NULL) * AXES *
               VXM_THIN_COPIES * sizeof(vxm_meeting);
  uint64_t budget = vxm_thin_budget(model->context);
  uint64_t numbers = (triangles->triangle_count + triangles->point_count) * sizeof(uint32_t);
  uint64_t words = shape->slice_words * (uint64_t)shape->slow_dim;
  if (words <= triangles->triangle_count)
    numbers += vxm_all_middle_words((size_t)words) * sizeof(uint64_t);
  return numbers + (all < (double)budget ? (uint64_t)all : budget);
}

vxm_memory_need vxm_model_memory_need(const vxm_model *model, const vxm_space *space, const vxm_window *shape,
                                      bool worst, bool centres) {
  const vxm_triangle_set *triangles = &model->analysis.triangles;
  uint64_t threads = (uint64_t)vxm_context_threads(model->context);
  uint64_t surface =
      vxm_faces_wanted(&model->options) ? vxm_surface_bytes(model->analysis.soup, (int)threads) : 0;
  if (!vxm_solid_wanted(&model->options))
    return (vxm_memory_need){surface, vxm_model_windows_held(model)};
  const vxm_engine *engine = model->options.engine;
  bool polled = vxm_voted_begin(&model->analysis, &model->options) < triangles->split.part_count;
  int voters = polled ? 4 : 1;
  const vxm_snapped_points *placed; /* its arrays have an element for each point */
  uint64_t points = triangles->point_count * (sizeof *placed->narrow + sizeof *placed->cells);
  uint64_t slab = (uint64_t)vxm_max(VXM_SLAB_WORDS, (int64_t)shape->slice_words) * sizeof(uint64_t);
  /* A slab for each voter and thread, some slices for what is carried on, and the bins themselves. */
  vxm_memory_need need = {points + surface + (5 * threads + 4) * slab + (UINT64_C(1) << 20),
                          vxm_model_windows_held(model)};
  if (engine && engine->ops) { /* its buffers, and points and triangles in them */
    enum { BUFFERS = 4, BUFFERS_OF_VOTES = 11, BYTES_PER_TRIANGLE = 32 };
    need.windows += polled ? BUFFERS_OF_VOTES : BUFFERS;
    need.fixed += triangles->triangle_count * BYTES_PER_TRIANGLE + points;
  }
  const unsigned all_roles = VXM_ROLE_FACE | VXM_ROLE_CAP | VXM_ROLE_CONE;
  /* Chunks of records are half full at worst. */
  double bound =
      2 * sizeof(uint64_t) * vxm_raster_schedule_bound(triangles->lengths, all_roles, space, NULL) * voters;
  double round = 2 * sizeof(uint64_t) * vxm_raster_schedule_round(model->context);
  if (worst) /* a bin keeps a slab of records of a part before it becomes a bitmap */
    need.windows += 2 * voters * (int)threads;
  need.fixed += decision_bytes(model, shape);
  double crossings = worst ? fmin(round, bound) : bound;
  need.fixed += crossings < 0x1p62 ? (uint64_t)crossings : UINT64_C(1) << 62;
  if (vxm_thin_separating(&model->options) && !centres) {
    /* The solid with and without what is added, with slices around; the first range is made with those behind
     * it. */
    uint64_t around = (uint64_t)vxm_thin_margin(vxm_thin_separating(&model->options)) *
                      ((uint64_t)need.windows + 2 * 2 + 1);
    need.fixed += around * shape->slice_words * sizeof(uint64_t) + thin_bytes(model, space, shape);
    need.windows += 2;
  }
  if (vxm_shell_wanted(&model->options)) /* two slices more of the solid */
    need.fixed += 2 * (uint64_t)need.windows * shape->slice_words * sizeof(uint64_t);
  return need;
}
