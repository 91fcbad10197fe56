/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Values of a file that lie x fastest, then y, then z, of one of our types: what readers of such formats
 * share. The axes of the file may be those of the grid in another order, or run the other way.
 */
#ifndef VXM_GRIDIO_COMMON_RASTER_H
#define VXM_GRIDIO_COMMON_RASTER_H

#include "gridio/common/format.h"

typedef struct vxm_raster {
  vxm_space space; /**< of the grid */
  vxm_scalar scalar;
  int channels;    /**< of the field: 4 of colours, else 1 */
  int stored;      /**< numbers of a voxel in the file: 3 = colours without opacity, which is full */
  bool is_swapped; /**< the bytes are those of the other byte order */
  int axis[3];     /**< of the grid, for each axis of the file */
  bool is_flipped[3];
  /** Values are number * slope + intercept. */
  bool is_scaled;
  double slope, intercept;
} vxm_raster;

/** Bytes of all values in the file. The space has been checked. */
uint64_t vxm_raster_bytes(const vxm_raster *raster);
/** One as most are: axes as they are, native bytes, nothing scaled. */
vxm_raster vxm_raster_plain(const vxm_space *space, vxm_scalar scalar, int channels);

/** Fills the slices of a file, from `begin` on, one after another. */
typedef vxm_status (*vxm_raster_source)(void *payload, void *slice, size_t size, vxm_error *error);

/**
 * Makes a field of the values.
 *
 * @param about what the file says of them; it is taken over
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, and what the source returns
 */
vxm_status vxm_raster_read(vxm_field **out, const vxm_raster *raster, vxm_context *context, vxm_about *about,
                           vxm_raster_source source, void *payload, vxm_error *error);

/** Bits of a field that was read, by a rule; the field's warnings go along. VXM_ERROR_NUMBERS */
vxm_status vxm_raster_bits(vxm_grid **out, const vxm_field *field, vxm_bits_rule rule, const char *file,
                           vxm_error *error);
/** The same of a file, whose numbers a format reads. */
vxm_status vxm_raster_bits_of_file(vxm_grid **out,
                                   vxm_status (*read_field)(vxm_field **out, const vxm_input *input,
                                                            vxm_error *error),
                                   const vxm_input *input, vxm_bits_rule rule, vxm_error *error);

#endif
