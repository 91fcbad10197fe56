/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octree/octree_slices.h"
#include "grid/octree_build.h"

#include <string.h>

/** An octree in the making, and the slices that do not make a strip yet, whose words follow. */
typedef struct state {
  vxm_octree_builder builder;
  vxm_window kept; /**< slices begin to end */
} state;

size_t vxm_octree_slices_state_bytes(const vxm_space *space) {
  vxm_window slice = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, 0);
  return sizeof(state) + VXM_STRIP_VOXELS * slice.slice_words * sizeof *slice.words;
}

/** What an octree takes cannot be known before: that of a body as large as its box, whose surface has half as
 * many bricks again as its sides, once in the making and once made. */
uint64_t vxm_octree_slices_held_bytes(const vxm_space *space) {
  double b[3], bytes = 2 * 9.5; /* of a brick, with its share of nodes */
  for (int a = 0; a < 3; a++)
    b[a] = (double)((space->dims[a] + 3) / 4);
  double surface = 3 * (b[0] * b[1] + b[1] * b[2] + b[2] * b[0]), all = b[0] * b[1] * b[2];
  return (uint64_t)(bytes * (surface < all ? surface : all));
}

vxm_status vxm_octree_slices_begin(vxm_grid_writer *writer, vxm_error *error) {
  state *s = writer->state;
  *s = (state){.kept = vxm_window_of(&writer->space, (vxm_layout)VXM_LAYOUT_GRID, 0, 0)};
  s->kept.words = (uint64_t *)(void *)(s + 1);
  return vxm_octree_builder_create(&s->builder, writer->context, &writer->space, error);
}

static void keep(state *s, const vxm_window *window, int64_t slice) {
  vxm_window *kept = &s->kept;
  memcpy(vxm_window_row(kept, 0, slice), vxm_window_row(window, 0, slice),
         kept->slice_words * sizeof *kept->words);
  kept->end = slice + 1;
  if (kept->end % VXM_STRIP_VOXELS != 0 && kept->end != kept->slow_dim)
    return;
  vxm_octree_builder_add(&s->builder, kept);
  kept->begin = kept->end;
}

/** Whole strips of a window from a slice on, which begins one. */
static int64_t add_strips(state *s, const vxm_window *window, int64_t slice) {
  vxm_window strips = *window;
  strips.begin = slice;
  strips.words = vxm_window_row(window, 0, slice);
  if (window->end != window->slow_dim)
    strips.end -= (window->end - slice) % VXM_STRIP_VOXELS;
  vxm_octree_builder_add(&s->builder, &strips);
  s->kept.begin = s->kept.end = strips.end;
  return strips.end;
}

/** Whole strips come from the window, others by way of the slices that are kept. */
vxm_status vxm_octree_slices_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  state *s = writer->state;
  for (int64_t slice = window->begin; slice < window->end;) {
    bool is_whole = window->end - slice >= VXM_STRIP_VOXELS || window->end == window->slow_dim;
    if (slice % VXM_STRIP_VOXELS == 0 && is_whole)
      slice = add_strips(s, window, slice);
    else
      keep(s, window, slice++);
  }
  vxm_status status = vxm_octree_builder_check(&s->builder, error);
  return status == VXM_OK ? vxm_grid_writer_step(writer, (double)window->end, error) : status;
}

vxm_status vxm_octree_slices_end(vxm_sparse **out, vxm_grid_writer *writer, vxm_error *error) {
  state *s = writer->state;
  return vxm_octree_builder_end(out, &s->builder, error);
}

void vxm_octree_slices_drop(vxm_grid_writer *writer) {
  state *s = writer->state;
  vxm_octree_builder_destroy(&s->builder);
}
