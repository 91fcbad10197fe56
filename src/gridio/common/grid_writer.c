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
  if (!format->writer || !format->writer->check)
    return VXM_OK;
  return format->writer->check(space, path, error);
}

vxm_status vxm_grid_writer_plan_of(vxm_grid_writer_plan *out, const vxm_space *space, const char *path,
                                   const char *format, vxm_error *error) {
  *out = (vxm_grid_writer_plan){0};
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status != VXM_OK || !found->writer)
    return status;
  const vxm_grid_writer_kind *kind = found->writer;
  out->streams = true;
  out->layout = kind->layout;
  out->bytes = sizeof(vxm_grid_writer) + kind->state_bytes(space) +
               (kind->sidecar ? 2 : 1) * (uint64_t)OUTPUT_BYTES +
               (kind->held_bytes ? kind->held_bytes(space) : 0);
  if (!vxm_layout_is_grid(kind->layout))
    out->gather_bytes = vxm_bit_transpose_bytes(space, kind->layout);
  return VXM_OK;
}

static void slices_free(vxm_grid_writer *writer) {
  vxm_context *context = writer->context;
  if (writer->is_begun && writer->format->writer->drop)
    writer->format->writer->drop(writer);
  vxm_free(context, writer->state);
  vxm_free(context, writer);
  vxm_context_release(context);
}

void vxm_grid_writer_abort(vxm_grid_writer *writer) {
  if (!writer)
    return;
  vxm_output_abort(writer->sidecar);
  vxm_output_abort(writer->output);
  slices_free(writer);
}

/** Allocates all that the writer holds, but for the outputs. */
static vxm_status create(vxm_grid_writer **out, vxm_context *context, const vxm_grid_format *format,
                         const vxm_space *space, vxm_error *error) {
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  vxm_grid_writer *writer = vxm_calloc(owner, 1, sizeof *writer, &local);
  if (!writer) {
    vxm_context_release(owner);
    vxm_error_pass(error, &local);
    return local.code;
  }
  writer->context = owner;
  writer->format = format;
  writer->space = *space;
  writer->length = space->dims[format->writer->layout.slow];
  writer->state = vxm_alloc(owner, format->writer->state_bytes(space), 1, &local);
  if (!writer->state) {
    slices_free(writer);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = writer;
  return VXM_OK;
}

vxm_status vxm_grid_writer_open(vxm_grid_writer **out, vxm_context *context, const vxm_space *space,
                                const char *path, const char *format, vxm_error *error) {
  *out = NULL;
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status == VXM_OK && !found->writer)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "the surface as .%s needs the whole grid", found->name);
  vxm_grid_writer *writer = NULL;
  if (status == VXM_OK)
    status = create(&writer, context, found, space, error);
  if (status == VXM_OK)
    status = vxm_output_open(&writer->output, context, path, error);
  if (status == VXM_OK && found->writer->file_bytes)
    status = vxm_output_expect(writer->output, found->writer->file_bytes(space), error);
  if (status == VXM_OK && found->writer->sidecar)
    status = vxm_sidecar_open(&writer->sidecar, context, space, path, found->writer->sidecar, NULL, error);
  if (status == VXM_OK) {
    writer->is_begun = true;
    status = found->writer->begin(writer, error);
  }
  if (status != VXM_OK) {
    vxm_grid_writer_abort(writer);
    return status;
  }
  *out = writer;
  return VXM_OK;
}

vxm_layout vxm_grid_writer_layout(const vxm_grid_writer *writer) {
  return writer->format->writer->layout;
}

void vxm_grid_writer_report(vxm_grid_writer *writer) {
  writer->report = true;
}

vxm_status vxm_grid_writer_step(vxm_grid_writer *writer, double slices_done, vxm_error *error) {
  if (vxm_output_failed(writer->output)) {
    vxm_output *output = writer->output;
    writer->output = NULL;
    return vxm_output_commit(output, error); /* which tells the reason */
  }
  return writer->report
             ? vxm_progress(writer->context, "writing", slices_done / (double)writer->length, error)
             : VXM_OK;
}

vxm_status vxm_grid_writer_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  if (!vxm_layouts_equal(window->layout, vxm_grid_writer_layout(writer)) || window->begin != writer->next ||
      window->end > window->slow_dim)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: %" PRId64 " is the next, not %" PRId64, writer->next,
                    window->begin);
  vxm_status status = writer->format->writer->put(writer, window, error);
  writer->next = window->end;
  return status;
}

vxm_status vxm_grid_writer_commit(vxm_grid_writer *writer, vxm_error *error) {
  int64_t all = writer->space.dims[vxm_grid_writer_layout(writer).slow];
  vxm_status status = VXM_OK;
  if (writer->next != all)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: only %" PRId64 " of %" PRId64 " are there",
                      writer->next, all);
  writer->report = true;
  if (status == VXM_OK)
    status = writer->format->writer->end(writer, error);
  if (status == VXM_OK) {
    status = vxm_output_commit_both(writer->output, writer->sidecar, error);
    writer->output = writer->sidecar = NULL;
  }
  vxm_grid_writer_abort(writer);
  return status;
}
