/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bit_transpose.h"
#include "gridio/common/byte_rows.h"
#include "gridio/common/values_writer.h"

#include <inttypes.h>

/** More than a vxm_output takes, its buffer included. */
enum { OUTPUT_BYTES = 72 << 10 };

/** Bits as numbers, for formats that know only those. */
static const vxm_about about_bits = {.is_declared = false};
static const vxm_values_spec bits = {
    .scalar = VXM_UINT8, .channels = 1, .about = &about_bits, .is_bits = true};

static vxm_status check(const vxm_grid_format *format, const vxm_space *space, const char *path,
                        vxm_error *error) {
  if (!format)
    return VXM_ERROR_ARGUMENT;
  if (format->writer)
    return format->writer->check ? format->writer->check(space, path, error) : VXM_OK;
  if (vxm_grid_format_streams(format) && format->values->check)
    return format->values->check(space, &bits, path, error);
  return VXM_OK;
}

static vxm_layout layout_of(const vxm_grid_format *format) {
  return format->writer ? format->writer->layout : format->values->layout;
}

/** What the writer holds beside itself and its files. */
static uint64_t held_bytes(const vxm_grid_format *format, const vxm_space *space) {
  const vxm_grid_writer_kind *kind = format->writer;
  if (!kind)
    return vxm_values_writer_bytes(format->values, space, &bits) +
           vxm_byte_rows_values_bytes(format->values, space);
  return kind->state_bytes(space) + (kind->sidecar ? 2 : 1) * (uint64_t)OUTPUT_BYTES +
         (kind->held_bytes ? kind->held_bytes(space) : 0);
}

vxm_status vxm_grid_writer_plan_of(vxm_grid_writer_plan *out, const vxm_space *space, const char *path,
                                   const char *format, vxm_error *error) {
  *out = (vxm_grid_writer_plan){0};
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status != VXM_OK || found->is_surface)
    return status;
  if (!vxm_grid_format_streams(found)) {
    out->gather_bytes = vxm_space_voxels(space); /* of a field of bytes */
    return VXM_OK;
  }
  out->streams = true;
  out->layout = layout_of(found);
  out->bytes = sizeof(vxm_grid_writer) + held_bytes(found, space);
  if (!vxm_layout_is_grid(out->layout))
    out->gather_bytes = vxm_bit_transpose_bytes(space, out->layout);
  return VXM_OK;
}

static void slices_free(vxm_grid_writer *writer) {
  vxm_context *context = writer->context;
  if (writer->is_begun && writer->format->writer->drop)
    writer->format->writer->drop(writer);
  if (writer->values)
    vxm_values_writer_abort(writer->values);
  vxm_free(context, writer->values);
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
  vxm_layout layout = layout_of(format);
  writer->length = space->dims[layout.slow];
  writer->state = vxm_alloc(owner,
                            format->writer ? format->writer->state_bytes(space)
                                           : vxm_byte_rows_values_bytes(format->values, space),
                            1, &local);
  if (writer->state && !format->writer)
    writer->values = vxm_calloc(owner, 1, sizeof *writer->values, &local);
  if (local.code != VXM_OK) {
    slices_free(writer);
    vxm_error_pass(error, &local);
    return local.code;
  }
  *out = writer;
  return VXM_OK;
}

static vxm_status begin(vxm_grid_writer *writer, const vxm_grid_writer_kind *kind, const char *path,
                        vxm_error *error) {
  const vxm_space *space = &writer->space;
  vxm_status status = vxm_output_open(&writer->output, writer->context, path, error);
  if (status == VXM_OK && kind->file_bytes)
    status = vxm_output_expect(writer->output, kind->file_bytes(space), error);
  if (status == VXM_OK && kind->sidecar)
    status = vxm_sidecar_open(&writer->sidecar, writer->context, space, path, kind->sidecar, NULL, error);
  if (status != VXM_OK)
    return status;
  writer->is_begun = true;
  return kind->begin(writer, error);
}

vxm_status vxm_grid_writer_open(vxm_grid_writer **out, vxm_context *context, const vxm_space *space,
                                const char *path, const char *format, vxm_error *error) {
  *out = NULL;
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status == VXM_OK && !vxm_grid_format_streams(found))
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "%s.%s needs the whole grid",
                      found->is_surface ? "the surface as " : "", found->name);
  vxm_grid_writer *writer = NULL;
  if (status == VXM_OK)
    status = create(&writer, context, found, space, error);
  if (status == VXM_OK)
    status = found->writer
                 ? begin(writer, found->writer, path, error)
                 : vxm_values_writer_open(writer->values, found->values, context, space, &bits, path, error);
  if (status != VXM_OK) {
    vxm_grid_writer_abort(writer);
    return status;
  }
  *out = writer;
  return VXM_OK;
}

vxm_layout vxm_grid_writer_layout(const vxm_grid_writer *writer) {
  return layout_of(writer->format);
}

void vxm_grid_writer_report(vxm_grid_writer *writer) {
  writer->report = true;
}

vxm_status vxm_grid_writer_step(vxm_grid_writer *writer, double slices_done, vxm_error *error) {
  if (writer->output && vxm_output_failed(writer->output)) {
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
  vxm_status status = writer->values ? vxm_byte_rows_put_values(writer, window, error)
                                     : writer->format->writer->put(writer, window, error);
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
  if (status == VXM_OK && writer->values)
    status = vxm_values_writer_commit(writer->values, error);
  else if (status == VXM_OK && writer->format->writer->end)
    status = writer->format->writer->end(writer, error);
  if (status == VXM_OK && writer->output) {
    status = vxm_output_commit_both(writer->output, writer->sidecar, error);
    writer->output = writer->sidecar = NULL;
  }
  vxm_grid_writer_abort(writer);
  return status;
}
