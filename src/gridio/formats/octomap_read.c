/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octomap_read.h"
#include "gridio/common/format.h"
#include "gridio/common/sink_fill.h"
#include "gridio/formats/octomap.h"
#include "sandbox/reader_process.h"

#include <math.h>
#include <string.h>

static const char first_line[] = "# Octomap OcTree binary file";

bool vxm_octomap_sniff(const vxm_input *input) {
  const size_t length = sizeof first_line - 1;
  return input->size >= length && memcmp(input->data, first_line, length) == 0;
}

/** A file on its way in. */
typedef struct receipt {
  vxm_voxel_sink sink;
  const vxm_input *input;
  bool wants_octree;
  vxm_bits_rule rule;
  vxm_sink_grid grid;
  vxm_warnings warnings;
  vxm_sink_filling filling;
  vxm_octree_pieces pieces; /**< of an octree */
  vxm_error fault;          /**< of these */
} receipt;

/* ---- The space ---- */

static vxm_status take_text(void *payload, const char *key, size_t key_size, const char *value,
                            size_t value_size, vxm_error *error) {
  (void)payload, (void)key, (void)key_size, (void)value, (void)value_size, (void)error;
  return VXM_OK;
}

static vxm_status take_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  receipt *r = payload;
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
static vxm_status find_beside(bool *found, vxm_space *space, receipt *r, const vxm_sink_extent *extent,
                              vxm_error *error) {
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

static vxm_status find_space(vxm_space *space, receipt *r, const vxm_sink_extent *extent, vxm_error *error) {
  const vxm_sink_grid *grid = &r->grid;
  bool found;
  vxm_status status = find_beside(&found, space, r, extent, error);
  if (status != VXM_OK || found)
    return status;
  if (extent->is_empty)
    return vxm_fail_byte(error, r->input, grid->at, "no voxel of the map is occupied, so it has no size");
  for (int a = 0; a < 3; a++) {
    r->filling.low[a] = extent->low[a];
    space->dims[a] = extent->high[a] - extent->low[a] + 1;
    space->voxel_size[a] = grid->voxel_size[a];
    space->origin[a] = (double)extent->low[a] * grid->voxel_size[a];
  }
  return vxm_space_check_file(space, r->input, (size_t)grid->at, error);
}

static vxm_status take_extent(void *payload, const vxm_sink_extent *extent, vxm_error *error) {
  receipt *r = payload;
  vxm_space space;
  vxm_status status = find_space(&space, r, extent, error);
  if (status != VXM_OK)
    return status;
  r->sink.is_full = r->rule == VXM_BITS_NONE; /* the space was all */
  if (!r->wants_octree)
    return vxm_grid_create(&r->filling.grid, r->input->context, &space, error);
  r->pieces = (vxm_octree_pieces){.context = r->input->context, .space = space, .error = &r->fault};
  r->filling.pieces = &r->pieces;
  return VXM_OK;
}

/* ---- The voxels ---- */

static void take_bits(void *payload, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  vxm_sink_fill_bits(&((receipt *)payload)->filling, at, bits);
}

/** A sound reader sends none. */
static void take_numbers(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  (void)payload, (void)at, (void)numbers;
}

static void take_cube(void *payload, const int64_t at[3], int64_t side, float number) {
  vxm_sink_fill_cube(&((receipt *)payload)->filling, at, side, number);
}

/** Reads the file into r->filling, which holds nothing after a failure. */
static vxm_status receive(receipt *r, vxm_error *error) {
  const vxm_input *input = r->input;
  const vxm_reader_request request = {
      .data = input->data, .size = input->size, .name = input->name, .hint = "bt"};
  r->sink = (vxm_voxel_sink){take_text, take_grid, take_extent, take_bits, take_numbers,
                             take_cube, r,         NULL,        NULL,      false};
  if (!vxm_octomap_sniff(input))
    return vxm_fail_byte(error, input, 0, "not a .bt file: it does not begin with \"%s\"", first_line);
  vxm_status status =
      vxm_reader_process_grid(&r->sink, &r->warnings, input->context, &vxm_octomap_need, &request, error);
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(r->filling.grid);
    vxm_free(input->context, r->pieces.list);
    r->filling = (vxm_sink_filling){.grid = NULL};
  }
  return status;
}

vxm_status vxm_octomap_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  receipt r = {.input = input, .rule = rule};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = receive(&r, &local);
  *out = r.filling.grid;
  if (status == VXM_OK)
    (*out)->warnings = r.warnings;
  else
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_octomap_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  receipt r = {.input = input, .rule = VXM_BITS_STORED, .wants_octree = true, .fault = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = receive(&r, &local);
  if (status == VXM_OK) {
    status = vxm_octree_pieces_end(out, &r.pieces);
    local = r.fault;
  }
  if (status == VXM_OK)
    (*out)->warnings = r.warnings;
  else
    vxm_error_pass(error, &local);
  return status;
}
