/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make variants for training: they check arguments and call down. */
#include "api/api_options.h"
#include "augment/sampler.h"
#include "augment/unpack_bits.h"
#include "base/sized.h"
#include "mesh/rotation.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { RESOLUTION = 64, RESOLUTION_MOST = 4096, NOISE = 1 << 16, NOISE_MOST = 1 << 24 };

static vxm_status check_rotations(const vxm_sampler_options *options, vxm_error *error) {
  for (int a = 0; a < 3; a++)
    if (!isfinite(options->axis[a]))
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: the axis is not finite");
  if (options->rotation != VXM_ROTATION_LIST)
    return VXM_OK;
  if (!options->rotations || options->rotation_count < 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: a list of rotations is asked for, but not given");
  if (options->rotation_count > (int64_t)(PTRDIFF_MAX / (9 * sizeof *options->rotations)))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: %" PRId64 " rotations are more than memory can hold",
                    options->rotation_count);
  for (int64_t r = 0; r < options->rotation_count; r++)
    if (!vxm_is_rotation(options->rotations + 9 * r))
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "sampler: matrix %" PRId64 " of the list is no rotation: " VXM_ROTATION_TEXT, r);
  return VXM_OK;
}

static bool is_part(double value) {
  return value >= 0 && value <= 1;
}

static vxm_status check(const vxm_sampler_options *options, vxm_error *error) {
  if (options->resolution < 1 || options->pad < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: resolution and pad cannot be negative");
  if (options->resolution > RESOLUTION_MOST)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "sampler: %" PRId64 " voxels along an axis; at most %d can be made", options->resolution,
                    RESOLUTION_MOST);
  if (options->coverage != 0 && options->coverage != 2 && options->coverage != 4 && options->coverage != 8)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: coverage %d is none of 0, 2, 4 and 8",
                    options->coverage);
  if (options->coverage > 0 && options->resolution * options->coverage > RESOLUTION_MOST)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "sampler: %" PRId64 " voxels of %d sub-voxels along an axis; at most %d of these can be "
                    "made",
                    options->resolution, options->coverage, RESOLUTION_MOST);
  if (options->coverage > 0 && options->voxelize->mode != VXM_MODE_SOLID)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: only solids fill shares of voxels");
  if ((unsigned)options->rotation > VXM_ROTATION_LIST)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: rotation %d is unknown", (int)options->rotation);
  if ((unsigned)options->displacement > VXM_DISPLACEMENT_NORMAL)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: displacement %d is unknown",
                    (int)options->displacement);
  if (!(options->scale >= 0 && options->scale < 1))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: scale %g is not from 0 to below 1", options->scale);
  if (!is_part(options->displace) || !is_part(options->translate))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: displace %g or translate %g is not from 0 to 1",
                    options->displace, options->translate);
  if (options->mirror > 7)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: mirror %u names other axes than x, y and z",
                    options->mirror);
  if (options->noise > NOISE_MOST)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: %" PRIu32 " displacements; at most %d can be kept",
                    options->noise, NOISE_MOST);
  if (options->fill && options->rotation != VXM_ROTATION_NONE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "sampler: a model whose longest side fills the grid cannot be rotated within it");
  return check_rotations(options, error);
}

/** Pad and displacement must leave a model its room. */
static vxm_status check_room(const vxm_sampler_options *options, vxm_error *error) {
  vxm_pose_rules rules = {.options = *options,
                          .reach = vxm_noise_reach(options->displacement, options->displace)};
  double room = vxm_pose_room(&rules);
  if (room * (double)options->resolution >= 1)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT,
                  "sampler: a pad of %" PRId64
                  " voxels and displacements of up to %g of the width on each side "
                  "leave no room in %" PRId64 " voxels",
                  options->pad, rules.reach, options->resolution);
}

vxm_status vxm_sampler_create(vxm_sampler **out, vxm_context *context, const vxm_sampler_options *options,
                              vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: the output argument is NULL");
  *out = NULL;
  vxm_sampler_options chosen = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options voxelize;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "sampler", error);
  if (status == VXM_OK)
    status = vxm_choose_voxelize_options(&voxelize, chosen.voxelize, error);
  if (status != VXM_OK)
    return status;
  if (voxelize.confidence)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: variants have no confidence");
  chosen.voxelize = &voxelize;
  if (chosen.resolution == 0)
    chosen.resolution = RESOLUTION;
  if (chosen.noise == 0)
    chosen.noise = NOISE;
  status = check(&chosen, error);
  if (status == VXM_OK)
    status = check_room(&chosen, error);
  return status == VXM_OK ? vxm_sampler_make(out, context, &chosen, error) : status;
}

vxm_status vxm_sampler_put(vxm_sampler *sampler, uint32_t model, const vxm_mesh *mesh, vxm_error *error) {
  if (!sampler)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: an argument is NULL");
  return vxm_sampler_set(sampler, model, mesh, error);
}

vxm_space vxm_sampler_space(const vxm_sampler *sampler) {
  return sampler ? vxm_worker_space(sampler->rules.options.resolution) : (vxm_space){.dims = {0}};
}

size_t vxm_sampler_bytes(const vxm_sampler *sampler, vxm_voxel_format voxels) {
  if (!sampler || (unsigned)voxels > VXM_VOXEL_FORMAT_FLOAT32)
    return 0;
  size_t dim = (size_t)sampler->rules.options.resolution;
  return vxm_unpack_row_bytes(voxels, sampler->rules.options.resolution) * dim * dim;
}

vxm_status vxm_sampler_pose(vxm_pose *out, const vxm_sampler *sampler, const vxm_variant *variant,
                            vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !sampler || !variant)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: an argument is NULL");
  const vxm_sampler_model *subject = vxm_sampler_find(sampler, variant->model, error);
  if (!subject)
    return VXM_ERROR_ARGUMENT;
  vxm_pose made = {.scale = {0}};
  vxm_placement placement;
  vxm_pose_draw(&placement, &sampler->rules, &subject->extent, variant);
  double voxels = (double)sampler->rules.options.resolution;
  for (int i = 0; i < 12; i++)
    made.transform[i] = placement.matrix[i] * voxels;
  for (int a = 0; a < 3; a++) {
    made.scale[a] = placement.scale[a] * voxels;
    made.shift[a] = placement.shift[a] * voxels;
  }
  memcpy(made.rotation, placement.rotation, sizeof made.rotation);
  VXM_RESULT_WRITE(out, &made);
  return VXM_OK;
}

/** Whether its voxels are set or clear. */
static vxm_status check_bits(const vxm_sampler *sampler, vxm_error *error) {
  return sampler->rules.options.coverage == 0
             ? VXM_OK
             : vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: its voxels are shares, which bits cannot hold");
}

vxm_status vxm_sampler_grid(vxm_grid *grid, vxm_sampler *sampler, const vxm_variant *variant,
                            vxm_error *error) {
  if (!grid || !sampler || !variant)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: an argument is NULL");
  vxm_status status = check_bits(sampler, error);
  if (status != VXM_OK)
    return status;
  int64_t dim = sampler->rules.options.resolution;
  for (int a = 0; a < 3; a++)
    if (grid->space.dims[a] != dim)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "sampler: the grid is not of %" PRId64 " x %" PRId64 " x %" PRId64 " voxels", dim, dim,
                      dim);
  return vxm_sampler_fill(sampler, grid, variant, error);
}

/** Of arrays that memory cannot hold no more than the beginning can be there. */
static vxm_status check_count(size_t count, size_t bytes, vxm_error *error) {
  if (count <= PTRDIFF_MAX / bytes)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: %zu variants are more than memory can hold", count);
}

vxm_status vxm_sampler_batch(void *out, vxm_sampler *sampler, const vxm_variant *variants, size_t count,
                             vxm_voxel_format voxels, vxm_error *error) {
  if (!out || !sampler || !variants)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: an argument is NULL");
  if ((unsigned)voxels > VXM_VOXEL_FORMAT_FLOAT32)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: voxels %d are unknown", (int)voxels);
  if (voxels == VXM_VOXEL_FORMAT_PACKED && check_bits(sampler, error) != VXM_OK)
    return VXM_ERROR_ARGUMENT;
  if (voxels == VXM_VOXEL_FORMAT_FLOAT32 && (uintptr_t)out % sizeof(float) != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: the memory is not aligned as floats are");
  size_t bytes = vxm_sampler_bytes(sampler, voxels);
  vxm_status status = check_count(count, bytes > sizeof *variants ? bytes : sizeof *variants, error);
  if (status != VXM_OK)
    return status;
  return vxm_sampler_write(sampler, out, variants, count, voxels, error);
}

vxm_status vxm_sampler_files(const char *const *paths, vxm_sampler *sampler, const vxm_variant *variants,
                             size_t count, const vxm_grid_write_options *options, bool *written,
                             vxm_error *error) {
  if (!paths || !sampler || !variants)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: an argument is NULL");
  vxm_grid_write_options chosen = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "grid", error);
  if (status == VXM_OK)
    status = check_bits(sampler, error);
  if (status == VXM_OK)
    status = check_count(count, sizeof *variants, error);
  if (status != VXM_OK)
    return status;
  for (size_t v = 0; v < count; v++) {
    if (written)
      written[v] = false;
    if (!paths[v])
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "sampler: the path of variant %zu is NULL", v);
  }
  return vxm_sampler_save(sampler, paths, variants, count, chosen.format, written, error);
}
