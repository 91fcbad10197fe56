/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vtk_image.h"

#include <math.h>
#include <string.h>

static const char bits_name[] = "solid";

bool vxm_vtk_type_find(vxm_scalar *out, const vxm_vtk_type *types, const char *name) {
  for (; types->name; types++)
    if (strcmp(name, types->name) == 0) {
      *out = types->scalar;
      return true;
    }
  return false;
}

const char *vxm_vtk_type_name(const vxm_vtk_type *types, vxm_scalar scalar) {
  for (; types->name; types++)
    if (types->scalar == scalar)
      return types->name;
  return "";
}

const char *vxm_vtk_array_name(const vxm_values_spec *values) {
  return values->is_bits ? bits_name : vxm_field_kind_name(values->about->kind);
}

vxm_status vxm_vtk_raster(vxm_raster *out, vxm_about *about, const vxm_vtk_image *image,
                          const vxm_input *input, size_t at, vxm_error *error) {
  vxm_space space;
  vxm_field_kind kind;
  if (image->components != 1 && image->components != 3 && image->components != 4)
    return vxm_fail_byte(error, input, at, "its values have %d components, not 1, or 3 or 4 of colours",
                         image->components);
  if (image->components > 1 && image->scalar != VXM_UINT8)
    return vxm_fail_byte(error, input, at, "its values are vectors, not numbers or colours of bytes");
  for (int a = 0; a < 3; a++) {
    bool is_size = image->spacing[a] > 0 && isfinite(image->spacing[a]);
    if (!is_size || !isfinite(image->origin[a]))
      return vxm_fail_byte(error, input, at, "the place or size of its voxels is no number");
    space.dims[a] = image->points[a] - (image->is_points ? 0 : 1);
    space.voxel_size[a] = image->spacing[a];
    space.origin[a] = image->origin[a] - (image->is_points ? image->spacing[a] / 2 : 0);
  }
  vxm_status status = vxm_space_check_file(&space, input, at, error);
  if (status != VXM_OK)
    return status;
  *out = vxm_raster_plain(&space, image->scalar, image->components > 1 ? 4 : 1);
  out->stored = image->components;
  *about = (vxm_about){.is_declared = false};
  if (image->components > 1)
    *about = (vxm_about){.is_declared = true, .kind = VXM_FIELD_COLORS};
  else if (vxm_field_kind_find(&kind, image->name) && kind != VXM_FIELD_COLORS && kind != VXM_FIELD_NUMBERS)
    *about = (vxm_about){.is_declared = true, .kind = kind};
  return VXM_OK;
}

vxm_status vxm_vtk_take(void *payload, void *slice, size_t size, vxm_error *error) {
  (void)error;
  vxm_vtk_source *source = payload;
  memcpy(slice, source->at, size);
  source->at += size;
  return VXM_OK;
}
