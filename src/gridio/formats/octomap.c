/* SPDX-License-Identifier: BSD-3-Clause */
/** .bt: set voxels as occupied leaves of OctoMap, whose tree is made of our octree's pieces. */
#include "gridio/formats/octomap.h"
#include "gridio/common/format.h"
#include "gridio/formats/octomap_read.h"
#include "gridio/formats/octree/octree_slices.h"

#include <math.h>

const vxm_module_need vxm_octomap_need = {"octomap", "liboctomap-dev", "reading and writing .bt files"};

/** The JSON has the exact place: hardly any grid lies on OctoMap's lattice. */
static const vxm_sidecar_text description = {VXM_OCTOMAP_JSON, "an octree", NULL};

/* ---- The place ---- */

bool vxm_octomap_place(int64_t out[3], const vxm_space *space) {
  const double half = VXM_OCTOMAP_HALF;
  for (int a = 0; a < 3; a++) {
    double first = nearbyint(space->origin[a] / space->voxel_size[a]);
    if (!(first >= -half && first + (double)space->dims[a] <= half))
      return false;
    out[a] = (int64_t)first;
  }
  return true;
}

static vxm_status find_place(int64_t first[3], const vxm_space *space, vxm_error *error) {
  const double *size = space->voxel_size;
  if (fabs(size[1] - size[0]) > 1e-9 * size[0] || fabs(size[2] - size[0]) > 1e-9 * size[0])
    return vxm_fail(
        error, VXM_ERROR_ARGUMENT,
        "OctoMap holds only voxels that are cubes, these are %g x %g x %g; use .npy, .raw or .vdb", size[0],
        size[1], size[2]);
  if (!vxm_octomap_place(first, space))
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "OctoMap holds only voxels less than %d of them from the origin along each axis; this "
                    "grid goes farther; use .octree or .vdb",
                    VXM_OCTOMAP_HALF);
  return VXM_OK;
}

static vxm_status open_module(const vxm_octomap_functions **out, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_open(&module, &vxm_octomap_need, error);
  if (status == VXM_OK)
    *out = module->functions;
  return status;
}

static vxm_status check(const vxm_space *space, const char *path, vxm_error *error) {
  (void)path;
  const vxm_octomap_functions *functions;
  int64_t first[3];
  vxm_status status = find_place(first, space, error);
  return status == VXM_OK ? open_module(&functions, error) : status;
}

/* ---- Octrees ---- */

/** A map in the making. */
typedef struct drawing {
  const vxm_octomap_functions *functions;
  vxm_octomap *map;
  const vxm_sparse *sparse;
  size_t bricks; /**< seen */
  vxm_status status;
  vxm_error *error;
} drawing;

static void put_piece(const vxm_sparse_piece *piece, void *payload) {
  enum { BRICKS_PER_REPORT = 1 << 16 };
  drawing *d = payload;
  if (d->status == VXM_OK)
    d->status = d->functions->put(d->map, piece, d->error);
  if (piece->bits != ~UINT64_C(0) && ++d->bricks % BRICKS_PER_REPORT == 0 && d->status == VXM_OK)
    d->status = vxm_progress(d->sparse->context, "writing",
                             (double)d->bricks / (double)d->sparse->brick_count, d->error);
}

static vxm_status put_octree(vxm_output *output, const vxm_sparse *sparse, vxm_error *error) {
  int64_t first[3];
  drawing d = {.sparse = sparse, .error = error};
  vxm_status status = find_place(first, &sparse->space, error);
  if (status == VXM_OK)
    status = open_module(&d.functions, error);
  if (status == VXM_OK)
    status = d.functions->create(&d.map, sparse->context, sparse->space.voxel_size[0], first, error);
  if (status != VXM_OK)
    return status;
  vxm_octree_walk_layers(sparse, 2, 0, sparse->space.dims[2], put_piece, &d);
  if (d.status == VXM_OK)
    d.status = d.functions->write(d.map, output, error);
  d.functions->destroy(d.map);
  return d.status;
}

/** File and JSON are there together, or neither is. */
static vxm_status write_files(vxm_output *output, const vxm_sparse *sparse, const char *path,
                              vxm_error *error) {
  vxm_output *beside = NULL;
  vxm_status status = put_octree(output, sparse, error);
  if (status == VXM_OK)
    status = vxm_sidecar_open(&beside, sparse->context, &sparse->space, path, &description, NULL, error);
  if (status == VXM_OK)
    return vxm_output_commit_both(output, beside, error);
  vxm_output_abort(output);
  return status;
}

static vxm_status write_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  vxm_output *output;
  vxm_status status = check(&sparse->space, path, error);
  if (status == VXM_OK)
    status = vxm_output_open(&output, sparse->context, path, error);
  return status == VXM_OK ? write_files(output, sparse, path, error) : status;
}

/* ---- Slices ---- */

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  vxm_sparse *sparse;
  vxm_status status = vxm_octree_slices_end(&sparse, writer, error);
  if (status == VXM_OK)
    status = put_octree(writer->output, sparse, error);
  vxm_sparse_destroy(sparse);
  return status;
}

/** Of our octree, and of OctoMap's, which has a node of some 64 bytes where ours has 2 voxels of a surface.
 */
static uint64_t held_bytes(const vxm_space *space) {
  return 8 * vxm_octree_slices_held_bytes(space);
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .sidecar = &description,
    .check = check,
    .state_bytes = vxm_octree_slices_state_bytes,
    .begin = vxm_octree_slices_begin,
    .put = vxm_octree_slices_put,
    .end = end,
    .drop = vxm_octree_slices_drop,
    .held_bytes = held_bytes,
};

const vxm_grid_format vxm_format_bt = {
    .name = "bt",
    .holds = VXM_HOLDS_BITS,
    .sniff = vxm_octomap_sniff,
    .read = vxm_octomap_read,
    .read_sparse = vxm_octomap_read_sparse,
    .writer = &writer_kind,
    .write_sparse = write_sparse,
};
