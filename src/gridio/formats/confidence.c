/* SPDX-License-Identifier: BSD-3-Clause */
/** The confidence of a grid as a .npy file. */
#include "gridio/formats/confidence.h"
#include "gridio/common/format.h"
#include "gridio/common/sidecar.h"
#include "gridio/formats/npy_header.h"

vxm_status vxm_gridio_confidence(const vxm_grid *grid, const char *path, vxm_error *error) {
  if (!vxm_text_equal_nocase(vxm_path_extension(path), "npy"))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: the confidence is written as .npy only", path);
  if (!grid->confidence)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "the grid was made without confidence; ask for it when voxelizing");
  vxm_output *output;
  vxm_status status = vxm_output_open(&output, grid->context, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_output_expect(output, vxm_space_voxels(&grid->space), error);
  if (status != VXM_OK) {
    vxm_output_abort(output);
    return status;
  }
  /* The bytes lie with x fastest, which numpy calls Fortran order: it indexes them [x][y][z] all the same. */
  const int64_t *dims = grid->space.dims;
  vxm_npy_header_write(output, "|u1", true, dims);
  for (int64_t k = 0; k < dims[2]; k++)
    vxm_output_write(output, grid->confidence + k * dims[0] * dims[1], (size_t)(dims[0] * dims[1]));
  static const vxm_sidecar_text text = {"voxmend npy", "x fastest, then y, then z", NULL};
  const vxm_about about = {.is_declared = true, .kind = VXM_FIELD_CONFIDENCE};
  vxm_output *sidecar;
  status = vxm_sidecar_open(&sidecar, grid->context, &grid->space, path, &text, &about, error);
  if (status == VXM_OK)
    return vxm_output_commit_both(output, sidecar, error);
  vxm_output_abort(output);
  return status;
}
