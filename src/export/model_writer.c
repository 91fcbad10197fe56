/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/model_writer.h"
#include "base/clock.h"
#include "grid/count_hash.h"
#include "gridio/common/grid_writer.h"
#include "gridio/gridio.h"
#include "voxel/model/memory_need.h"
#include "voxel/model/model_report.h"
#include "voxel/model/voxelize.h"

#include <string.h>

/** Words of a window that are made at once though more would fit: 256 MiB; larger ones gain nothing. */
static const uint64_t window_bytes_max = UINT64_C(1) << 28;

/** How a file is made: its layout, and how many slices at once. */
typedef struct plan {
  vxm_grid_writer_plan file;
  vxm_window shape; /**< of all slices, without words */
  int64_t slices;   /**< of a window */
  uint64_t memory;
} plan;

/** Where the confidence or a mesh is wanted the grid is made as one window. */
static bool needs_whole(const vxm_model *model, const plan *p) {
  return !p->file.streams || model->options.confidence;
}

static uint64_t saturating_sum(uint64_t a, uint64_t b) {
  return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

/** Slices that fit `left` bytes, and what they take. */
static int64_t slices_in(const plan *p, const vxm_model *model, const vxm_space *space, uint64_t left,
                         bool worst, uint64_t *memory) {
  vxm_memory_need need = vxm_model_memory_need(model, space, &p->shape, worst, false);
  uint64_t slice = p->shape.slice_words * sizeof(uint64_t), each = slice * (uint64_t)need.windows;
  uint64_t fixed = saturating_sum(need.fixed, p->file.bytes);
  uint64_t room = left > fixed ? (left - fixed) / each : 0, most = window_bytes_max / slice;
  int64_t slices = (int64_t)(room < most ? room : most);
  slices -= slices > 4 ? slices % 4 : 0; /* whole bricks */
  slices = vxm_min(vxm_max(slices, 1), p->shape.slow_dim);
  *memory = saturating_sum(fixed, (uint64_t)slices * each);
  return slices;
}

/** As many slices as fit beside all else. */
static vxm_status plan_windows(plan *p, const vxm_model *model, const vxm_space *space, vxm_error *error) {
  uint64_t left = vxm_memory_left(model->context), worst_memory;
  /* What the caller takes meanwhile is not ours to know: a sixteenth is left free. */
  left = left == SIZE_MAX ? UINT64_MAX : left - left / 16;
  p->slices = slices_in(p, model, space, left, false, &p->memory);
  int64_t worst = slices_in(p, model, space, left, true, &worst_memory);
  if (worst > p->slices || (worst == p->slices && worst_memory < p->memory)) {
    p->slices = worst;
    p->memory = worst_memory;
  }
  return vxm_memory_check(model->context, p->memory, "voxelizing slice by slice", error);
}

static void plan_whole(plan *p, const vxm_model *model, const vxm_space *space) {
  uint64_t least = UINT64_MAX;
  for (int worst = 0; worst < 2; worst++) {
    vxm_memory_need need = vxm_model_memory_need(model, space, &p->shape, worst, false);
    uint64_t memory =
        saturating_sum(need.fixed + p->file.gather_bytes, (uint64_t)need.windows * vxm_space_bytes(space));
    least = memory < least ? memory : least;
  }
  p->slices = p->shape.slow_dim;
  p->memory = least;
}

static vxm_status make_plan(plan *p, const vxm_model *model, const vxm_space *space, const char *path,
                            const char *format, vxm_error *error) {
  vxm_status status = vxm_space_check(space, error);
  if (status == VXM_OK)
    status = vxm_grid_writer_plan_of(&p->file, space, path, format, error);
  if (status != VXM_OK)
    return status;
  vxm_layout grid = VXM_LAYOUT_GRID;
  bool whole = needs_whole(model, p);
  p->shape = vxm_window_of(space, whole ? grid : p->file.layout, 0, 0);
  if (!whole)
    return plan_windows(p, model, space, error);
  plan_whole(p, model, space);
  return vxm_memory_check(model->context, p->memory, "voxelizing", error);
}

vxm_status vxm_model_writer_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                     const char *path, const char *format, vxm_error *error) {
  plan p;
  vxm_status status = make_plan(&p, model, space, path, format, error);
  if (status != VXM_OK)
    return status;
  *out = (vxm_estimate){.grid_bytes = vxm_space_bytes(space),
                        .memory_bytes = p.memory,
                        .passes = (p.shape.slow_dim + p.slices - 1) / p.slices};
  return VXM_OK;
}

/* ---- Writing ---- */

typedef struct stream {
  vxm_model *model;
  vxm_model_pass *pass; /**< NULL where the grid is made as a whole */
  const plan *plan;
  const vxm_space *space;
  vxm_grid_writer *file;
  vxm_window window; /**< with room for plan->slices slices, and for one before them */
  uint64_t *before;  /**< the slice before the window */
  vxm_count_hash sum;
  double fill_ms, write_ms;
} stream;

static vxm_status do_window(stream *s, int64_t begin, vxm_error *error) {
  double start = vxm_clock_ms();
  s->window.begin = begin;
  s->window.end = vxm_min(begin + s->plan->slices, s->window.slow_dim);
  vxm_status status = vxm_model_pass_fill(s->pass, &s->window, error);
  if (status != VXM_OK)
    return status;
  vxm_count_hash_add(&s->sum, s->model->context, &s->window, s->before);
  size_t last = (size_t)(s->window.end - begin - 1) * s->window.slice_words;
  memcpy(s->before, s->window.words + last, s->window.slice_words * sizeof *s->before);
  double made = vxm_clock_ms();
  s->fill_ms += made - start;
  status = vxm_grid_writer_put(s->file, &s->window, error);
  s->write_ms += vxm_clock_ms() - made;
  return status;
}

static vxm_status write_windows(stream *s, const char *path, const char *format, vxm_error *error) {
  vxm_context *context = s->model->context;
  vxm_error local = VXM_ERROR_INIT;
  s->window = s->plan->shape;
  s->sum = vxm_count_hash_start(s->space);
  s->before = vxm_alloc(context, s->window.slice_words, sizeof *s->before, &local);
  s->window.words =
      vxm_alloc(context, s->window.slice_words * (size_t)s->plan->slices, sizeof *s->before, &local);
  vxm_status status = local.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  if (status == VXM_OK)
    status = vxm_grid_writer_open(&s->file, context, s->space, path, format, error);
  double start = vxm_clock_ms();
  if (status == VXM_OK)
    status = vxm_model_begin(&s->pass, s->model, s->space, NULL, NULL, error);
  s->fill_ms = vxm_clock_ms() - start;
  for (int64_t k = 0; k < s->window.slow_dim && status == VXM_OK; k += s->plan->slices)
    status = do_window(s, k, error);
  start = vxm_clock_ms();
  if (status == VXM_OK)
    status = vxm_grid_writer_commit(s->file, error);
  else
    vxm_grid_writer_abort(s->file);
  s->write_ms += vxm_clock_ms() - start;
  vxm_free(context, s->window.words);
  vxm_free(context, s->before);
  return status;
}

static vxm_status write_whole(stream *s, vxm_voxelize_report *report, const char *path,
                              const vxm_grid_write_options *options, vxm_error *error) {
  vxm_grid *grid;
  double start = vxm_clock_ms();
  vxm_status status = vxm_voxelize_grid(&grid, report, s->model, s->space, error);
  double made = vxm_clock_ms();
  s->fill_ms = made - start;
  if (status != VXM_OK)
    return status;
  status = vxm_gridio_write_with(grid, path, options, error);
  s->write_ms = vxm_clock_ms() - made;
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_model_writer_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  plan p;
  vxm_status status = make_plan(&p, model, space, path, options->format, error);
  if (status != VXM_OK)
    return status;
  stream s = {.model = model, .plan = &p, .space = space};
  if (needs_whole(model, &p))
    status = write_whole(&s, report, path, options, error);
  else {
    status = write_windows(&s, path, options->format, error);
    if (status == VXM_OK)
      vxm_model_report(s.pass, report, s.sum.count, s.sum.hash);
    vxm_model_close(model, s.pass);
  }
  if (status != VXM_OK)
    return status;
  report->fill_ms = s.fill_ms;
  report->write_ms = s.write_ms;
  return VXM_OK;
}
