/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of voxels that stay on a device: they check arguments and call down. */
#include "augment/sampler.h"
#include "base/sized.h"
#include "voxel/model/model_device_voxels.h"

static vxm_status check_format(vxm_voxel_format format, vxm_error *error) {
  if ((unsigned)format <= VXM_VOXEL_FORMAT_FLOAT32)
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: format %d is unknown", (int)format);
}

vxm_status vxm_model_voxelize_device(vxm_device_voxels **out, vxm_model *model, const vxm_space *space,
                                     const double transform[12], vxm_voxel_format format, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: an argument is NULL");
  vxm_status status = check_format(format, error);
  if (status == VXM_OK)
    status = vxm_space_check(space, error);
  return status == VXM_OK ? vxm_voxelize_on_device(out, model, space, transform, format, error) : status;
}

vxm_status vxm_sampler_batch_device(vxm_device_voxels **out, vxm_sampler *sampler,
                                    const vxm_variant *variants, size_t count, vxm_voxel_format format,
                                    vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !sampler || !variants)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: an argument is NULL");
  if (count == 0 || count > PTRDIFF_MAX / sizeof *variants)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: %zu variants cannot be made", count);
  vxm_status status = check_format(format, error);
  return status == VXM_OK ? vxm_sampler_keep(out, sampler, variants, count, format, error) : status;
}

vxm_status vxm_device_voxels_describe(vxm_device_info *out, const vxm_device_voxels *voxels,
                                      vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !voxels)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: an argument is NULL");
  VXM_RESULT_WRITE(out, &voxels->info);
  return VXM_OK;
}

vxm_status vxm_device_voxels_dlpack(struct DLManagedTensor **out, vxm_device_voxels *voxels,
                                    vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !voxels)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxels on a device: an argument is NULL");
  if (voxels->info.kind != VXM_DEVICE_OPENCL)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "voxels in a texture of OpenGL are no DLPack tensor");
  return vxm_device_voxels_share(out, voxels, error);
}

void vxm_device_voxels_destroy(vxm_device_voxels *voxels) {
  vxm_device_voxels_drop(voxels);
}
