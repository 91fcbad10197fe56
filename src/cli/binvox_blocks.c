/* SPDX-License-Identifier: BSD-3-Clause */
/** -mb: the blocks of a schematic by the materials of the faces that touch them, "blockid_35" for one. */
#include "cli/binvox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCKS = 256 };

/** The number in "GROUP/blockid_NUMBER", or 0. */
static unsigned char block_of(const char *tag) {
  static const char before[] = "blockid_";
  const char *slash = strchr(tag, '/'), *material = slash ? slash + 1 : "";
  int64_t id;
  if (strncmp(material, before, sizeof before - 1) != 0 ||
      !cli_read_integer(&id, material + sizeof before - 1, 1, BLOCKS - 1))
    return 0;
  return (unsigned char)id;
}

/** The block of each face; NULL where memory is lacking. To be freed. */
static unsigned char *blocks_of_faces(cli_run *cli, const binvox_request *given, const vxm_mesh *mesh) {
  int64_t faces = vxm_mesh_face_count(mesh), tags = vxm_mesh_tag_count(mesh), without = 0;
  const uint32_t *tag = vxm_mesh_face_tags(mesh);
  unsigned char *ids = calloc((size_t)faces + 1, 1), *of_tags = calloc((size_t)tags + 1, 1);
  for (int64_t t = 0; of_tags && t < tags; t++)
    of_tags[t] = block_of(vxm_mesh_tag_name(mesh, t));
  for (int64_t f = 0; ids && of_tags && f < faces; f++) {
    ids[f] = tag ? of_tags[tag[f]] : 0;
    without += ids[f] == 0;
  }
  if (!of_tags) {
    free(ids);
    ids = NULL;
  }
  free(of_tags);
  if (ids && without > 0)
    cli_warn(cli, "%s: %lld faces have no material called blockid_1 to blockid_255; their blocks are %lld",
             given->model, (long long)without, (long long)given->block);
  return ids;
}

/** The faces of one block alone; what fails is in cli->error. */
static vxm_status part_of(cli_run *cli, vxm_mesh **out, const vxm_mesh *mesh, const unsigned char *ids,
                          int id) {
  int64_t faces = vxm_mesh_face_count(mesh), used = 0, count = 0;
  const uint64_t *offsets = vxm_mesh_offsets(mesh);
  const uint32_t *indices = vxm_mesh_indices(mesh);
  int64_t *starts = malloc(((size_t)faces + 1) * sizeof *starts);
  uint32_t *corners = malloc(((size_t)offsets[faces] + 1) * sizeof *corners);
  vxm_status status = VXM_ERROR_MEMORY;
  if (starts && corners) {
    for (int64_t f = 0; f < faces; f++)
      if (ids[f] == id) {
        size_t length = (size_t)(offsets[f + 1] - offsets[f]);
        memcpy(corners + used, indices + offsets[f], length * sizeof *corners);
        starts[count++] = used;
        used += (int64_t)length;
      }
    starts[count] = used;
    vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
    arrays.vertices = vxm_mesh_vertices(mesh);
    arrays.vertex_count = vxm_mesh_vertex_count(mesh);
    arrays.offsets = starts;
    arrays.index_scalar = VXM_UINT32;
    arrays.indices = corners;
    arrays.index_count = used;
    arrays.face_count = count;
    status = vxm_mesh_create(out, cli->context, &arrays, &cli->error);
  } else {
    cli->error.code = VXM_ERROR_MEMORY;
    snprintf(cli->error.text, sizeof cli->error.text, "out of memory for the blocks: free some, or lower -d");
  }
  free(corners);
  free(starts);
  return status;
}

static void mark(binvox_blocks *out, const vxm_grid *grid, int id) {
  const int64_t *dims = out->space.dims;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++)
        if (vxm_grid_get(grid, i, j, k))
          out->ids[(k * dims[1] + j) * dims[0] + i] = (unsigned char)id;
}

/** Marks the voxels that the faces of a block touch. */
static vxm_status add_block(cli_run *cli, binvox_blocks *out, const vxm_mesh *mesh, const unsigned char *ids,
                            int id) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  vxm_mesh *part = NULL;
  vxm_model *model = NULL;
  vxm_grid *grid = NULL;
  vxm_status status = part_of(cli, &part, mesh, ids, id);
  if (status == VXM_OK)
    status = vxm_model_create(&model, part, &options, &cli->error);
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, cli->context, &out->space, &cli->error);
  if (status == VXM_OK)
    status = vxm_model_voxelize(grid, NULL, model, NULL, &cli->error);
  if (status == VXM_OK)
    mark(out, grid, id);
  vxm_grid_destroy(grid);
  vxm_model_destroy(model);
  vxm_mesh_destroy(part);
  return status;
}

int binvox_blocks_make(cli_run *cli, const binvox_request *given, binvox_blocks *out, const vxm_mesh *mesh,
                       const vxm_space *space) {
  size_t count = (size_t)space->dims[0] * (size_t)space->dims[1] * (size_t)space->dims[2]; /* to 2^60 */
  bool is_used[BLOCKS] = {false};
  unsigned char *ids = blocks_of_faces(cli, given, mesh);
  *out = (binvox_blocks){.space = *space, .ids = calloc(count, 1)};
  int status =
      ids && out->ids ? CLI_DONE : cli_fail_text(cli, "out of memory for the blocks: free some, or lower -d");
  for (int64_t f = 0; status == CLI_DONE && f < vxm_mesh_face_count(mesh); f++)
    is_used[ids[f]] = true;
  for (int id = 1; status == CLI_DONE && id < BLOCKS; id++)
    if (is_used[id] && add_block(cli, out, mesh, ids, id) != VXM_OK)
      status = cli_fail(cli);
  free(ids);
  if (status != CLI_DONE)
    binvox_blocks_free(out);
  return status;
}

void binvox_blocks_free(binvox_blocks *blocks) {
  free(blocks->ids);
  blocks->ids = NULL;
}

unsigned char binvox_block_at(const binvox_blocks *blocks, const vxm_space *space, const int64_t at[3]) {
  int64_t first[3], side = (int64_t)lround(space->voxel_size[0] / blocks->space.voxel_size[0]);
  const int64_t *dims = blocks->space.dims;
  for (int axis = 0; axis < 3; axis++)
    first[axis] = at[axis] * side + (int64_t)lround((space->origin[axis] - blocks->space.origin[axis]) /
                                                    blocks->space.voxel_size[axis]);
  unsigned char id = 0;
  for (int64_t k = first[2]; k < first[2] + side && k < dims[2]; k++)
    for (int64_t j = first[1]; j < first[1] + side && j < dims[1]; j++)
      for (int64_t i = first[0]; i < first[0] + side && i < dims[0]; i++) {
        unsigned char own = blocks->ids[(k * dims[1] + j) * dims[0] + i];
        id = own > id ? own : id;
      }
  return id;
}
