/* SPDX-License-Identifier: BSD-3-Clause */
/** .vdb: set voxels as a tree of OpenVDB, which is written when it is complete. */
#include "gridio/common/format.h"
#include "gridio/formats/vdb/vdb_blocks.h"
#include "gridio/formats/vdb/vdb_read.h"
#include "gridio/formats/vdb/vdb_values.h"

#include <string.h>

const vxm_module_need vxm_vdb_need = {"openvdb", "libopenvdb-dev", "reading and writing .vdb files"};

vxm_status vxm_vdb_open(const vxm_vdb_functions **out, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_open(&module, &vxm_vdb_need, error);
  if (status == VXM_OK)
    *out = module->functions;
  return status;
}

static const vxm_vdb_kind solid = {VXM_VDB_BITS, "solid", 0, NULL};

vxm_status vxm_vdb_open_writer(const vxm_vdb_functions **out, const vxm_space *space, vxm_error *error) {
  vxm_status status = vxm_vdb_open(out, error);
  return status == VXM_OK ? (*out)->check(space, error) : status;
}

/* ---- Memory ---- */

static double blocks_of(const vxm_space *space, int64_t side, double blocks[3]) {
  for (int a = 0; a < 3; a++)
    blocks[a] = (double)((space->dims[a] + side - 1) / side);
  return blocks[0] * blocks[1] * blocks[2];
}

/**
 * What a tree takes cannot be known before. For a body as large as its box some half more blocks are mixed
 * than its sides have; nodes of 128 and 4096 voxels are there all over, until those that are full all over
 * become tiles.
 */
static uint64_t held_bytes(const vxm_space *space) {
  const double leaf = 192, lower = 34e3, upper = 271e3;
  double b[3], all = blocks_of(space, VXM_VDB_SIDE, b);
  double leaves = 3 * (b[0] * b[1] + b[1] * b[2] + b[2] * b[0]);
  double bytes = (leaves < all ? leaves : all) * leaf;
  bytes += blocks_of(space, 128, b) * lower + blocks_of(space, 4096, b) * upper;
  return (uint64_t)bytes;
}

/* ---- Slices ---- */

/** A tree in the making, and the slices that do not make 8 yet, whose words follow. */
typedef struct state {
  vxm_vdb_target target;
  vxm_window kept; /**< slices begin to end */
} state;

static size_t state_bytes(const vxm_space *space) {
  vxm_window slice = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, 0);
  return sizeof(state) + VXM_VDB_SIDE * slice.slice_words * sizeof *slice.words;
}

static vxm_status check(const vxm_space *space, const char *path, vxm_error *error) {
  (void)path;
  const vxm_vdb_functions *functions;
  return vxm_vdb_open_writer(&functions, space, error);
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  state *s = writer->state;
  *s = (state){.kept = vxm_window_of(&writer->space, (vxm_layout)VXM_LAYOUT_GRID, 0, 0)};
  s->kept.words = (uint64_t *)(void *)(s + 1);
  vxm_status status = vxm_vdb_open_writer(&s->target.functions, &writer->space, error);
  return status == VXM_OK
             ? s->target.functions->create(&s->target.vdb, writer->context, &solid, &writer->space, error)
             : status;
}

static vxm_status keep(state *s, const vxm_window *window, int64_t slice, vxm_error *error) {
  vxm_window *kept = &s->kept;
  memcpy(vxm_window_row(kept, 0, slice), vxm_window_row(window, 0, slice),
         kept->slice_words * sizeof *kept->words);
  kept->end = slice + 1;
  if (kept->end % VXM_VDB_SIDE != 0 && kept->end != kept->slow_dim)
    return VXM_OK;
  vxm_status status = vxm_vdb_put_slab(&s->target, kept, kept->begin, error);
  kept->begin = kept->end;
  return status;
}

/** Whole blocks come from the window, others by way of the slices that are kept. */
static vxm_status put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  state *s = writer->state;
  vxm_status status = VXM_OK;
  for (int64_t slice = window->begin; slice < window->end && status == VXM_OK;) {
    if (slice % VXM_VDB_SIDE == 0 &&
        (window->end - slice >= VXM_VDB_SIDE || window->end == window->slow_dim)) {
      status = vxm_vdb_put_slab(&s->target, window, slice, error);
      slice = vxm_min(slice + VXM_VDB_SIDE, window->end);
      s->kept.begin = s->kept.end = slice;
    } else {
      status = keep(s, window, slice, error);
      slice++;
    }
    if (status == VXM_OK)
      status = vxm_grid_writer_step(writer, (double)slice, error);
  }
  return status;
}

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  state *s = writer->state;
  vxm_status status = s->target.functions->write(s->target.vdb, writer->output, error);
  /* A failed write is told by the output. */
  return status == VXM_ERROR_IO ? vxm_grid_writer_step(writer, (double)writer->length, error) : status;
}

static void drop(vxm_grid_writer *writer) {
  state *s = writer->state;
  if (s->target.vdb)
    s->target.functions->destroy(s->target.vdb);
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .check = check,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = put,
    .end = end,
    .drop = drop,
    .held_bytes = held_bytes,
};

/* ---- Octrees ---- */

static vxm_status write_tree(const vxm_vdb_target *target, const vxm_sparse *sparse, const char *path,
                             vxm_error *error) {
  vxm_output *output;
  vxm_status status = vxm_vdb_put_octree(target, sparse, error);
  if (status == VXM_OK)
    status = vxm_output_open(&output, sparse->context, path, error);
  if (status != VXM_OK)
    return status;
  status = target->functions->write(target->vdb, output, error);
  if (status == VXM_OK || vxm_output_failed(output))
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

static vxm_status write_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  vxm_vdb_target target;
  vxm_status status = vxm_vdb_open_writer(&target.functions, &sparse->space, error);
  if (status == VXM_OK)
    status = target.functions->create(&target.vdb, sparse->context, &solid, &sparse->space, error);
  if (status != VXM_OK)
    return status;
  status = write_tree(&target, sparse, path, error);
  target.functions->destroy(target.vdb);
  return status;
}

const vxm_grid_format vxm_format_vdb = {
    .name = "vdb",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_NUMBERS | VXM_HOLDS_LABELS,
    .sniff = vxm_vdb_sniff,
    .read = vxm_vdb_read,
    .read_field = vxm_vdb_read_field,
    .read_sparse = vxm_vdb_read_sparse,
    .writer = &writer_kind,
    .write_sparse = write_sparse,
    .values = &vxm_vdb_values,
    .check_field = vxm_vdb_check_field,
    .write_field = vxm_vdb_write_field,
};
