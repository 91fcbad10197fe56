/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octomap_read.h"
#include "gridio/common/sink_receipt.h"
#include "gridio/formats/octomap.h"

#include <math.h>
#include <string.h>

static const char first_line[] = "# Octomap OcTree binary file";

bool vxm_octomap_sniff(const vxm_input *input) {
  const size_t length = sizeof first_line - 1;
  return input->size >= length && memcmp(input->data, first_line, length) == 0;
}

/* ---- The space ---- */

static vxm_status take_text(void *payload, const char *key, size_t key_size, const char *value,
                            size_t value_size, vxm_error *error) {
  (void)payload, (void)key, (void)key_size, (void)value, (void)value_size, (void)error;
  return VXM_OK;
}

static vxm_status take_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  vxm_sink_receipt *r = payload;
  r->grid = *grid;
  for (int a = 0; a < 3; a++)
    if (!(grid->voxel_size[a] > 0) || !isfinite(grid->voxel_size[a]) || !isfinite(grid->first[a]) ||
        grid->is_numbers)
      return vxm_fail_byte(error, r->input, grid->at, "the size of its voxels is no number");
  return VXM_OK;
}

/** Whether all that is occupied lies in a space, and has its voxels. */
static bool has_all(const vxm_space *space, int64_t low[3], const vxm_sink_grid *grid,
                    const vxm_sink_extent *extent) {
  for (int a = 0; a < 3; a++)
    if (fabs(space->voxel_size[a] - grid->voxel_size[a]) > 1e-9 * grid->voxel_size[a])
      return false;
  if (!vxm_octomap_place(low, space))
    return false;
  for (int a = 0; a < 3 && !extent->is_empty; a++)
    if (extent->low[a] < low[a] || extent->high[a] >= low[a] + space->dims[a])
      return false;
  return true;
}

/** The space that is told beside the file, if one is and it is of this map. */
static vxm_status find_beside(bool *found, vxm_space *space, vxm_sink_receipt *r,
                              const vxm_sink_extent *extent, vxm_error *error) {
  const vxm_input *input = r->input;
  vxm_error why = VXM_ERROR_INIT;
  bool is_file = input->mapping || strcmp(input->name, "<stdin>") != 0;
  *found = false;
  if (!is_file || !vxm_sidecar_exists(input->name))
    return VXM_OK;
  vxm_status status = vxm_sidecar_read(space, NULL, input->context, input->name, VXM_OCTOMAP_JSON, &why);
  if (vxm_is_memory(status))
    return vxm_fail(error, status, "%s", why.text);
  if (status != VXM_OK)
    vxm_warn(&r->warnings, "the grid is taken to end where its voxels do: %s", why.text);
  else if (!has_all(space, r->filling.low, &r->grid, extent))
    vxm_warn(&r->warnings,
             "the grid is taken to end where its voxels do: the .json beside the file is of another");
  else
    *found = true;
  return VXM_OK;
}

static vxm_status find_space(vxm_space *space, vxm_sink_receipt *r, const vxm_sink_extent *extent,
                             vxm_error *error) {
  const vxm_sink_grid *grid = &r->grid;
  bool found;
  vxm_status status = find_beside(&found, space, r, extent, error);
  if (status != VXM_OK || found)
    return status;
  if (extent->is_empty)
    return vxm_fail_byte(error, r->input, grid->at, "no voxel of the map is occupied, so it has no size");
  vxm_sink_take_box(space, r, extent);
  for (int a = 0; a < 3; a++)
    space->origin[a] = (double)extent->low[a] * grid->voxel_size[a];
  return vxm_space_check_file(space, r->input, (size_t)grid->at, error);
}

static vxm_status take_extent(void *payload, const vxm_sink_extent *extent, vxm_error *error) {
  vxm_sink_receipt *r = payload;
  vxm_space space;
  vxm_status status = find_space(&space, r, extent, error);
  if (status != VXM_OK)
    return status;
  r->sink.is_full = r->rule == VXM_BITS_NONE; /* the space was all */
  return vxm_sink_begin_bits(r, &space, error);
}

/* ---- A file ---- */

static vxm_status receive(vxm_sink_receipt *r, vxm_error *error) {
  r->sink = (vxm_voxel_sink){.text = take_text, .grid = take_grid, .extent = take_extent};
  if (!vxm_octomap_sniff(r->input))
    return vxm_fail_byte(error, r->input, 0, "not a .bt file: it does not begin with \"%s\"", first_line);
  return vxm_sink_receive(r, &vxm_octomap_need, "bt", error);
}

vxm_status vxm_octomap_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_sink_receipt r = {.input = input, .rule = rule};
  vxm_status status = receive(&r, error);
  *out = r.filling.grid;
  if (status == VXM_OK)
    (*out)->warnings = r.warnings;
  return status;
}

vxm_status vxm_octomap_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  vxm_sink_receipt r = {.input = input, .rule = VXM_BITS_STORED, .wants_octree = true};
  *out = NULL;
  vxm_status status = receive(&r, error);
  return status == VXM_OK ? vxm_sink_end_octree(out, &r, error) : status;
}
