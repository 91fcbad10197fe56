/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bit_transpose.h"
#include "gridio/common/format.h"

#include <inttypes.h>

/** More than a vxm_output takes, its buffer included. */
enum { OUTPUT_BYTES = 72 << 10 };

static vxm_status check(const vxm_grid_format *format, const vxm_space *space, const char *path,
                        vxm_error *error) {
  if (!format)
    return VXM_ERROR_ARGUMENT;
  if (!format->slices || !format->slices->check)
    return VXM_OK;
  return format->slices->check(space, path, error);
}

vxm_status vxm_grid_writer_plan_of(vxm_grid_writer_plan *out, const vxm_space *space, const char *path,
                                   const char *format, vxm_error *error) {
  *out = (vxm_grid_writer_plan){0};
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status != VXM_OK || !found->slices)
    return status;
  const vxm_grid_writer_kind *kind = found->slices;
  out->streams = true;
  out->layout = kind->layout;
  out->bytes = sizeof(vxm_grid_writer) + kind->state_bytes(space) +
               (kind->sidecar ? 2 : 1) * (uint64_t)OUTPUT_BYTES +
               (kind->held_bytes ? kind->held_bytes(space) : 0);
  if (!vxm_layout_is_grid(kind->layout))
    out->gather_bytes = vxm_bit_transpose_bytes(space, kind->layout);
  return VXM_OK;
}

static void slices_free(vxm_grid_writer *slices) {
  vxm_context *context = slices->context;
  if (slices->is_begun && slices->format->slices->drop)
    slices->format->slices->drop(slices);
  vxm_free(context, slices->state);
  vxm_free(context, slices);
  vxm_context_release(context);
}

void vxm_grid_writer_abort(vxm_grid_writer *slices) {
  if (!slices)
    return;
  vxm_output_abort(slices->sidecar);
  vxm_output_abort(slices->output);
  slices_free(slices);
}

/** Allocates all that the writer holds, but for the outputs. */
static vxm_status create(vxm_grid_writer **out, vxm_context *context, const vxm_grid_format *format,
                         const vxm_space *space, vxm_error *error) {
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  vxm_grid_writer *slices = vxm_calloc(owner, 1, sizeof *slices, &local);
  if (!slices) {
    vxm_context_release(owner);
    vxm_error_pass(error, &local);
    return local.code;
  }
  slices->context = owner;
  slices->format = format;
  slices->space = *space;
  slices->length = space->dims[format->slices->layout.slow];
  slices->state = vxm_alloc(owner, format->slices->state_bytes(space), 1, &local);
  if (!slices->state) {
    slices_free(slices);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = slices;
  return VXM_OK;
}

vxm_status vxm_grid_writer_open(vxm_grid_writer **out, vxm_context *context, const vxm_space *space,
                                const char *path, const char *format, vxm_error *error) {
  *out = NULL;
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status == VXM_OK && !found->slices)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "the surface as .%s needs the whole grid", found->name);
  vxm_grid_writer *slices = NULL;
  if (status == VXM_OK)
    status = create(&slices, context, found, space, error);
  if (status == VXM_OK)
    status = vxm_output_open(&slices->output, context, path, error);
  if (status == VXM_OK && found->slices->file_bytes)
    status = vxm_output_expect(slices->output, found->slices->file_bytes(space), error);
  if (status == VXM_OK && found->slices->sidecar)
    status = vxm_sidecar_open(&slices->sidecar, context, space, path, found->slices->sidecar, NULL, error);
  if (status == VXM_OK) {
    slices->is_begun = true;
    status = found->slices->begin(slices, error);
  }
  if (status != VXM_OK) {
    vxm_grid_writer_abort(slices);
    return status;
  }
  *out = slices;
  return VXM_OK;
}

vxm_layout vxm_grid_writer_layout(const vxm_grid_writer *slices) {
  return slices->format->slices->layout;
}

void vxm_grid_writer_report(vxm_grid_writer *slices) {
  slices->report = true;
}

vxm_status vxm_grid_writer_step(vxm_grid_writer *slices, double slices_done, vxm_error *error) {
  if (vxm_output_failed(slices->output)) {
    vxm_output *output = slices->output;
    slices->output = NULL;
    return vxm_output_commit(output, error); /* which tells the reason */
  }
  return slices->report
             ? vxm_progress(slices->context, "writing", slices_done / (double)slices->length, error)
             : VXM_OK;
}

vxm_status vxm_grid_writer_put(vxm_grid_writer *slices, const vxm_window *window, vxm_error *error) {
  if (!vxm_layouts_equal(window->layout, vxm_grid_writer_layout(slices)) || window->begin != slices->next ||
      window->end > window->slow_dim)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: %" PRId64 " is the next, not %" PRId64, slices->next,
                    window->begin);
  vxm_status status = slices->format->slices->put(slices, window, error);
  slices->next = window->end;
  return status;
}

vxm_status vxm_grid_writer_commit(vxm_grid_writer *slices, vxm_error *error) {
  int64_t all = slices->space.dims[vxm_grid_writer_layout(slices).slow];
  vxm_status status = VXM_OK;
  if (slices->next != all)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: only %" PRId64 " of %" PRId64 " are there",
                      slices->next, all);
  slices->report = true;
  if (status == VXM_OK)
    status = slices->format->slices->end(slices, error);
  if (status == VXM_OK) {
    status = vxm_output_commit_both(slices->output, slices->sidecar, error);
    slices->output = slices->sidecar = NULL;
  }
  vxm_grid_writer_abort(slices);
  return status;
}
