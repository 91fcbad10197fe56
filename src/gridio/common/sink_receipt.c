/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/sink_receipt.h"

static void take_bits(void *payload, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  vxm_sink_fill_bits(&((vxm_sink_receipt *)payload)->filling, at, bits);
}

static void take_numbers(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  vxm_sink_fill_numbers(&((vxm_sink_receipt *)payload)->filling, at, numbers);
}

static void take_cube(void *payload, const int64_t at[3], int64_t side, float number) {
  vxm_sink_fill_cube(&((vxm_sink_receipt *)payload)->filling, at, side, number);
}

vxm_status vxm_sink_receive(vxm_sink_receipt *r, const vxm_module_need *need, const char *hint,
                            vxm_error *error) {
  const vxm_input *input = r->input;
  const vxm_reader_request request = {
      .data = input->data, .size = input->size, .name = input->name, .hint = hint};
  r->sink.bits = take_bits;
  r->sink.numbers = take_numbers;
  r->sink.cube = take_cube;
  r->sink.payload = r;
  r->fault = (vxm_error)VXM_ERROR_INIT;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_reader_process_grid(&r->sink, &r->warnings, input->context, need, &request, &local);
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, &local);
  if (status != VXM_OK) {
    vxm_error_pass(error, &local);
    vxm_grid_destroy(r->filling.grid);
    vxm_field_destroy(r->filling.field);
    vxm_free(input->context, r->pieces.list);
    r->filling = (vxm_sink_filling){.grid = NULL};
  }
  return status;
}

void vxm_sink_take_box(vxm_space *space, vxm_sink_receipt *r, const vxm_sink_extent *extent) {
  for (int a = 0; a < 3; a++) {
    r->filling.low[a] = extent->low[a];
    space->dims[a] = extent->high[a] - extent->low[a] + 1;
    space->voxel_size[a] = r->grid.voxel_size[a];
  }
}

vxm_status vxm_sink_begin_bits(vxm_sink_receipt *r, const vxm_space *space, vxm_error *error) {
  vxm_context *context = r->input->context;
  if (!r->wants_octree)
    return vxm_grid_create(&r->filling.grid, context, space, error);
  r->pieces = (vxm_octree_pieces){.context = context, .space = *space, .error = &r->fault};
  r->filling.pieces = &r->pieces;
  return VXM_OK;
}

vxm_status vxm_sink_end_octree(vxm_sparse **out, vxm_sink_receipt *r, vxm_error *error) {
  vxm_status status = vxm_octree_pieces_end(out, &r->pieces);
  if (status == VXM_OK)
    (*out)->warnings = r->warnings;
  else
    vxm_error_pass(error, &r->fault);
  return status;
}
