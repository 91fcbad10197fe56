/* SPDX-License-Identifier: BSD-3-Clause */
/** What VTK's two formats of images share: voxels are cells of the image, and their values one array of it.
 */
#ifndef VXM_GRIDIO_FORMATS_VTK_IMAGE_H
#define VXM_GRIDIO_FORMATS_VTK_IMAGE_H

#include "gridio/common/raster.h"
#include "gridio/common/values_writer.h"

/** What an image says of its values. */
typedef struct vxm_vtk_image {
  int64_t points[3]; /**< along the axes; cells are one less */
  double origin[3];  /**< of the first point */
  double spacing[3];
  bool is_points; /**< values are those of points, which are the centres of voxels */
  vxm_scalar scalar;
  int components;
  char name[64]; /**< of the array, cut */
} vxm_vtk_image;

/** A name that a format has for a type; lists end with NULL. */
typedef struct vxm_vtk_type {
  const char *name;
  vxm_scalar scalar;
} vxm_vtk_type;

/** The type of a name; false if no type of a list has it. */
bool vxm_vtk_type_find(vxm_scalar *out, const vxm_vtk_type *types, const char *name);
/** The first name of a type; "" if a list has none. */
const char *vxm_vtk_type_name(const vxm_vtk_type *types, vxm_scalar scalar);

/** The name of the array of values, which tells their kind. */
const char *vxm_vtk_array_name(const vxm_values_spec *values);
/** Makes a raster of an image, and of the array's name what the values are. @param at for messages */
vxm_status vxm_vtk_raster(vxm_raster *out, vxm_about *about, const vxm_vtk_image *image,
                          const vxm_input *input, size_t at, vxm_error *error);

/** Values that lie in a file as they are. */
typedef struct vxm_vtk_source {
  const unsigned char *at;
} vxm_vtk_source;

vxm_status vxm_vtk_take(void *payload, void *slice, size_t size, vxm_error *error);

#endif
