/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/slabs.h"

enum {
  SLABS_PER_THREAD = 4 /**< so that threads end at about the same time */
};

vxm_workspace vxm_workspace_of(vxm_context *context) {
  return (vxm_workspace){.context = context, .bins = {.context = context}, .crossings = {.context = context}};
}

void vxm_workspace_destroy(vxm_workspace *workspace) {
  vxm_crossing_bins_destroy(&workspace->bins);
  vxm_raster_schedule_destroy(&workspace->crossings);
  vxm_free(workspace->context, workspace->scratch);
  *workspace = (vxm_workspace){.context = workspace->context};
}

vxm_status vxm_workspace_scratch(vxm_workspace *workspace, size_t words, vxm_error *error) {
  if (words <= workspace->scratch_words)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_free(workspace->context, workspace->scratch);
  workspace->scratch = vxm_try_calloc(workspace->context, words, sizeof *workspace->scratch, &status, error);
  workspace->scratch_words = workspace->scratch ? words : 0;
  return status;
}

vxm_slabs vxm_slabs_of(int64_t layers, size_t layer_words, int threads) {
  int64_t shares = threads > 1 ? (int64_t)threads * SLABS_PER_THREAD : 1;
  int shift = 0;
  while ((layer_words << (shift + 1)) <= VXM_SLAB_WORDS && (shares << (shift + 1)) <= layers)
    shift++;
  /* A single thread may take all layers as one slab. */
  while (threads == 1 && (layer_words << shift) * 2 <= VXM_SLAB_WORDS && (INT64_C(1) << shift) < layers)
    shift++;
  int64_t thickness = INT64_C(1) << shift;
  return (vxm_slabs){layers, shift, (size_t)((layers + thickness - 1) >> shift), layer_words << shift};
}

vxm_columns vxm_columns_of(const vxm_window *window, int axis) {
  const vxm_layout *l = &window->layout;
  vxm_columns columns = {.w = axis, .keep_before = true};
  columns.u = axis == l->fast ? l->middle : l->fast;
  columns.v = axis == l->slow ? l->middle : l->slow;
  columns.slab_axis = columns.v;
  columns.end[l->fast] = window->fast_dim;
  columns.end[l->middle] = window->middle_dim;
  columns.begin[l->slow] = window->begin;
  columns.end[l->slow] = window->end;
  columns.step[l->fast] = 1;
  columns.step[l->middle] = 64 * window->row_words;
  columns.step[l->slow] = 64 * window->slice_words;
  return columns;
}
