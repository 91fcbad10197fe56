/* SPDX-License-Identifier: BSD-3-Clause */
/** .npy: an array [x][y][z] of numpy. It holds no transform: that goes into a JSON file beside it. */
#include "gridio/byte_rows.h"
#include "gridio/elements.h"
#include "gridio/format.h"
#include "gridio/npy_header.h"
#include "gridio/sidecar.h"

#include <inttypes.h>
#include <string.h>

static const vxm_sidecar_text description = {"voxmend npy", "z fastest, then y, then x", NULL};

/* ---- Reading ---- */

/** C order: z fastest and x slowest, through planes. */
static vxm_status read_c_order(vxm_grid *grid, const unsigned char *data, vxm_element element,
                               vxm_error *error) {
  vxm_planes planes;
  vxm_status status =
      vxm_planes_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Z_FAST, error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    size_t count = vxm_planes_in(grid, w);
    vxm_elements_to_planes(&planes, count, data, element);
    data += count * planes.rows * planes.length * element.size;
    vxm_planes_scatter(&planes, grid, w);
    status = vxm_progress(grid->context, "reading", (double)(w + 1) / (double)grid->row_words, error);
  }
  vxm_planes_destroy(&planes);
  return status;
}

/** The transform from the JSON, if there is one and it is of this array. */
static void find_space(vxm_space *space, const vxm_input *input, vxm_notes *notes) {
  for (int a = 0; a < 3; a++) {
    space->origin[a] = 0;
    space->voxel_size[a] = 1;
  }
  bool is_file = input->mapping || strcmp(input->name, "<stdin>") != 0;
  if (!is_file || !vxm_sidecar_exists(input->name)) {
    vxm_note(notes, "no .json beside the array: origin 0 0 0 and voxel size 1 are taken");
    return;
  }
  vxm_space beside;
  vxm_error why = VXM_ERROR_INIT;
  if (vxm_sidecar_read(&beside, input->context, input->name, description.format, &why) != VXM_OK)
    vxm_note(notes, "origin 0 0 0 and voxel size 1 are taken: %s", why.text);
  else if (memcmp(beside.dims, space->dims, sizeof space->dims) != 0)
    vxm_note(notes, "origin 0 0 0 and voxel size 1 are taken: the .json beside the array has other dims");
  else
    *space = beside;
}

static vxm_status check_length(const vxm_npy_header *h, const vxm_space *space, const vxm_input *input,
                               vxm_notes *notes, vxm_error *error) {
  uint64_t voxels = vxm_space_voxels(space), there = input->size - h->data;
  if (there / h->size < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: it has %" PRIu64 " of %" PRIu64 " elements", there / h->size,
                         voxels);
  if (there > voxels * h->size)
    vxm_note(notes, "%" PRIu64 " bytes behind the array are ignored", there - voxels * h->size);
  return VXM_OK;
}

static vxm_status read_npy(vxm_grid **out, const vxm_input *input, vxm_error *error) {
  vxm_npy_header h;
  vxm_notes notes = {0};
  vxm_space space;
  vxm_status status = vxm_npy_header_read(&h, input, error);
  if (status != VXM_OK)
    return status;
  memcpy(space.dims, h.shape, sizeof space.dims);
  find_space(&space, input, &notes);
  status = vxm_space_check_file(&space, input, h.shape_offset, error);
  if (status == VXM_OK)
    status = check_length(&h, &space, input, &notes, error);
  vxm_grid *grid = NULL;
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &space, error);
  vxm_element element = vxm_element_of(h.kind, h.size, h.big_endian);
  if (status == VXM_OK)
    status = (h.fortran ? vxm_elements_to_grid : read_c_order)(grid, input->data + h.data, element, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->notes = notes;
  *out = grid;
  return VXM_OK;
}

/* ---- Writing ---- */

static size_t state_bytes(const vxm_space *space) {
  return vxm_byte_rows_bytes(space, (vxm_layout)VXM_PLANE_Z_FAST);
}

static vxm_status begin(vxm_slices *slices, vxm_error *error) {
  (void)error;
  vxm_npy_header_write(slices->output, "|b1", false, slices->space.dims);
  return VXM_OK;
}

static vxm_status end(vxm_slices *slices, vxm_error *error) {
  (void)slices;
  (void)error;
  return VXM_OK;
}

static const vxm_slices_kind slices_kind = {
    .layout = VXM_PLANE_Z_FAST,
    .sidecar = &description,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_byte_rows_put,
    .end = end,
    .file_bytes = vxm_space_voxels,
};

const vxm_grid_format vxm_format_npy = {"npy", vxm_npy_sniff, read_npy, &slices_kind, NULL};
