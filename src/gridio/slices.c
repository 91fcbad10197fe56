/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/format.h"
#include "gridio/gridio.h"
#include "gridio/planes.h"
#include "meshio/meshio.h"

#include <inttypes.h>

/** More than a vxm_output takes, its buffer included. */
enum { OUTPUT_BYTES = 72 << 10 };

static const vxm_layout grid_layout = VXM_LAYOUT_GRID;

static bool same_layout(vxm_layout a, vxm_layout b) {
  return a.fast == b.fast && a.middle == b.middle && a.slow == b.slow;
}

static vxm_status check(const vxm_grid_format *format, const vxm_space *space, const char *path,
                        vxm_error *error) {
  if (!format)
    return VXM_ERROR_ARGUMENT;
  if (!format->slices || !format->slices->check)
    return VXM_OK;
  return format->slices->check(space, path, error);
}

vxm_status vxm_slices_plan_of(vxm_slices_plan *out, const vxm_space *space, const char *path,
                              const char *format, vxm_error *error) {
  *out = (vxm_slices_plan){0};
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status != VXM_OK || !found->slices)
    return status;
  const vxm_slices_kind *kind = found->slices;
  out->streams = true;
  out->layout = kind->layout;
  out->bytes = sizeof(vxm_slices) + kind->state_bytes(space) +
               (kind->sidecar ? 2 : 1) * (uint64_t)OUTPUT_BYTES +
               (kind->held_bytes ? kind->held_bytes(space) : 0);
  if (!same_layout(kind->layout, grid_layout))
    out->gather_bytes = vxm_planes_bytes(space, kind->layout);
  return VXM_OK;
}

static void slices_free(vxm_slices *slices) {
  vxm_context *context = slices->context;
  if (slices->is_begun && slices->format->slices->drop)
    slices->format->slices->drop(slices);
  vxm_free(context, slices->state);
  vxm_free(context, slices);
  vxm_context_release(context);
}

void vxm_slices_abort(vxm_slices *slices) {
  if (!slices)
    return;
  vxm_output_abort(slices->sidecar);
  vxm_output_abort(slices->output);
  slices_free(slices);
}

/** Allocates all that the writer holds, but for the outputs. */
static vxm_status create(vxm_slices **out, vxm_context *context, const vxm_grid_format *format,
                         const vxm_space *space, vxm_error *error) {
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  vxm_slices *slices = vxm_calloc(owner, 1, sizeof *slices, &local);
  if (!slices) {
    vxm_context_release(owner);
    if (error)
      *error = local;
    return local.code;
  }
  slices->context = owner;
  slices->format = format;
  slices->space = *space;
  slices->length = space->dims[format->slices->layout.slow];
  slices->state = vxm_alloc(owner, format->slices->state_bytes(space), 1, &local);
  if (!slices->state) {
    slices_free(slices);
    if (error)
      *error = local;
    return local.code;
  }
  *out = slices;
  return VXM_OK;
}

vxm_status vxm_slices_open(vxm_slices **out, vxm_context *context, const vxm_space *space, const char *path,
                           const char *format, vxm_error *error) {
  *out = NULL;
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  vxm_status status = check(found, space, path, error);
  if (status == VXM_OK && !found->slices)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "the surface as .%s needs the whole grid", found->name);
  vxm_slices *slices = NULL;
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
    vxm_slices_abort(slices);
    return status;
  }
  *out = slices;
  return VXM_OK;
}

vxm_layout vxm_slices_layout(const vxm_slices *slices) {
  return slices->format->slices->layout;
}

void vxm_slices_report(vxm_slices *slices) {
  slices->report = true;
}

vxm_status vxm_slices_step(vxm_slices *slices, double slices_done, vxm_error *error) {
  if (vxm_output_failed(slices->output)) {
    vxm_output *output = slices->output;
    slices->output = NULL;
    return vxm_output_commit(output, error); /* which tells the reason */
  }
  return slices->report
             ? vxm_progress(slices->context, "writing", slices_done / (double)slices->length, error)
             : VXM_OK;
}

vxm_status vxm_slices_put(vxm_slices *slices, const vxm_window *window, vxm_error *error) {
  if (!same_layout(window->layout, vxm_slices_layout(slices)) || window->begin != slices->next ||
      window->end > window->slow_dim)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "slices: %" PRId64 " is the next, not %" PRId64, slices->next,
                    window->begin);
  vxm_status status = slices->format->slices->put(slices, window, error);
  slices->next = window->end;
  return status;
}

vxm_status vxm_slices_commit(vxm_slices *slices, vxm_error *error) {
  int64_t all = slices->space.dims[vxm_slices_layout(slices).slow];
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
  vxm_slices_abort(slices);
  return status;
}

/* ---- Whole grids ---- */

/** Word columns of the grid, each of which is up to 64 slices of a file that varies x slowest. */
static vxm_status put_planes(vxm_slices *slices, const vxm_grid *grid, vxm_error *error) {
  vxm_planes planes;
  vxm_status status =
      vxm_planes_create(&planes, grid->context, &grid->space, vxm_slices_layout(slices), error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    vxm_planes_gather(&planes, grid, w, NULL);
    vxm_window window = vxm_planes_window(&planes, grid, w);
    status = vxm_slices_put(slices, &window, error);
  }
  vxm_planes_destroy(&planes);
  return status;
}

static vxm_status write_slices(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  vxm_slices *slices;
  vxm_status status = vxm_slices_open(&slices, grid->context, &grid->space, path, format, error);
  if (status != VXM_OK)
    return status;
  vxm_slices_report(slices);
  if (same_layout(vxm_slices_layout(slices), grid_layout)) {
    vxm_window window = vxm_window_of_grid(grid);
    status = vxm_slices_put(slices, &window, error);
  } else
    status = put_planes(slices, grid, error);
  if (status == VXM_OK)
    return vxm_slices_commit(slices, error);
  vxm_slices_abort(slices);
  return status;
}

static vxm_status write_surface(const vxm_grid *grid, const char *path, const char *format,
                                vxm_error *error) {
  vxm_soup *surface;
  vxm_status status = vxm_gridio_surface_mesh(&surface, grid, error);
  if (status != VXM_OK)
    return status;
  status = vxm_meshio_write(surface, path, format, false, error);
  vxm_soup_destroy(surface);
  return status;
}

vxm_status vxm_gridio_write(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  if (!found)
    return VXM_ERROR_ARGUMENT;
  return (found->slices ? write_slices : write_surface)(grid, path, found->name, error);
}
