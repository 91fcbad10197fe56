/* SPDX-License-Identifier: BSD-3-Clause */
/** .octree as a grid format: slices become an octree before they are written. */
#include "grid/octree_build.h"
#include "gridio/common/format.h"
#include "gridio/formats/octree_file.h"

#include <string.h>

/* ---- Reading ---- */

/** The mapping stays with the input. */
static vxm_status open_borrowed(vxm_sparse_file **out, const vxm_input *input, vxm_error *error) {
  vxm_input borrowed = *input;
  borrowed.mapping = borrowed.block = NULL;
  return vxm_octree_file_open(out, &borrowed, error);
}

static vxm_status read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(out, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  vxm_sparse_file_close(file);
  return status;
}

static vxm_status read_grid(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_sparse *sparse = NULL;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK)
    status = vxm_grid_create(out, input->context, &file->space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = vxm_octree_file_load(&sparse, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  if (sparse) {
    vxm_window window = vxm_window_of_grid(*out);
    vxm_octree_fill(sparse, &window);
  }
  vxm_sparse_destroy(sparse);
  vxm_sparse_file_close(file);
  if (status != VXM_OK) {
    vxm_grid_destroy(*out);
    *out = NULL;
  }
  return status;
}

/* ---- Writing ---- */

static vxm_status write_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  vxm_output *output;
  vxm_status status = vxm_output_open(&output, sparse->context, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_octree_file_put(output, sparse, error);
  if (status == VXM_OK)
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

/** An octree in the making, and the slices that do not make a strip yet, whose words follow. */
typedef struct state {
  vxm_octree_builder builder;
  vxm_window kept; /**< slices begin to end */
} state;

static size_t state_bytes(const vxm_space *space) {
  vxm_window slice = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, 0);
  return sizeof(state) + VXM_STRIP_VOXELS * slice.slice_words * sizeof *slice.words;
}

/** What an octree takes cannot be known before: that of a body as large as its box, whose surface has half as
 * many bricks again as its sides, once in the making and once made. */
static uint64_t held_bytes(const vxm_space *space) {
  double b[3], bytes = 2 * 9.5; /* of a brick, with its share of nodes */
  for (int a = 0; a < 3; a++)
    b[a] = (double)((space->dims[a] + 3) / 4);
  double surface = 3 * (b[0] * b[1] + b[1] * b[2] + b[2] * b[0]), all = b[0] * b[1] * b[2];
  return (uint64_t)(bytes * (surface < all ? surface : all));
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
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
static vxm_status put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
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

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  state *s = writer->state;
  vxm_sparse *sparse;
  vxm_status status = vxm_octree_builder_end(&sparse, &s->builder, error);
  if (status == VXM_OK)
    status = vxm_octree_file_put(writer->output, sparse, error);
  vxm_sparse_destroy(sparse);
  return status;
}

static void drop(vxm_grid_writer *writer) {
  state *s = writer->state;
  vxm_octree_builder_destroy(&s->builder);
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .drop = drop,
    .held_bytes = held_bytes,
};

const vxm_grid_format vxm_format_octree = {
    .name = "octree",
    .holds = VXM_HOLDS_BITS,
    .sniff = vxm_octree_sniff,
    .read = read_grid,
    .read_sparse = read_sparse,
    .writer = &writer_kind,
    .write_sparse = write_sparse,
};
