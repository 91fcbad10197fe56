/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .zarr: a folder with an array of Zarr's storage format 2 (zarr-specs, "Zarr storage specification version
 * 2"): .zarray says what it is, .zattrs what we and others add, and each chunk is a file, "0.3.1". The
 * attributes are those that .h5 has: "origin", "voxel_size", "kind", "axes", and of labels "label_names" and
 * "label_voxels".
 */
#ifndef VXM_GRIDIO_FORMATS_ZARR_H
#define VXM_GRIDIO_FORMATS_ZARR_H

#include "gridio/common/format.h"

enum { VXM_ZARR_RANK_MAX = 4, VXM_ZARR_KEY_MAX = 96 };

/** An array: its axes are those of the file, in its order. */
typedef struct vxm_zarr_array {
  int rank; /**< 3, or 4 of colours, which come last */
  int64_t shape[VXM_ZARR_RANK_MAX], chunk[VXM_ZARR_RANK_MAX];
  vxm_scalar scalar;
  bool is_bool, is_swapped;
  bool is_packed;        /**< its chunks are compressed */
  bool is_fortran;       /**< the first axis of a chunk is the fastest */
  char separator;        /**< between the numbers of a chunk's name */
  unsigned char fill[8]; /**< a value that is not there, as the field has it */
  vxm_space space;
  unsigned known_place; /**< what the attributes say of it: VXM_PLACE_ORIGIN, VXM_PLACE_SIZE */
  int axis[3];          /**< of the grid, for each of the first three */
  bool has_odd_axes;
  vxm_about about;
} vxm_zarr_array;

/** Values of a chunk, which lie in the file whole also where the array ends. */
static inline size_t vxm_zarr_chunk_values(const vxm_zarr_array *array) {
  size_t count = 1;
  for (int a = 0; a < array->rank; a++)
    count *= (size_t)array->chunk[a];
  return count;
}

/** Chunks along an axis. */
static inline int64_t vxm_zarr_chunks(const vxm_zarr_array *array, int axis) {
  return (array->shape[axis] - 1) / array->chunk[axis] + 1;
}

/** The name of a chunk. */
void vxm_zarr_key(char out[VXM_ZARR_KEY_MAX], const vxm_zarr_array *array, const int64_t *chunk);

/**
 * Reads what the folder says of its array, and checks it.
 *
 * @param folder its descriptor
 * @param input  its name and context
 * @return VXM_OK, then and after a failure `about` is to be destroyed; VXM_ERROR_FORMAT,
 *         VXM_ERROR_RANGE, VXM_ERROR_IO, VXM_ERROR_MEMORY
 */
vxm_status vxm_zarr_read_metadata(vxm_zarr_array *out, int folder, const vxm_input *input, vxm_error *error);

/** The texts of .zarray and .zattrs, to be freed; NULL without memory. `kind` is the attribute. */
char *vxm_zarr_array_text(const vxm_zarr_array *array);
char *vxm_zarr_attributes_text(const vxm_zarr_array *array, const char *kind, const vxm_about *about);

/** A folder with an array or group in it. */
bool vxm_zarr_sniff(const vxm_input *input);
vxm_status vxm_zarr_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
vxm_status vxm_zarr_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);

#endif
