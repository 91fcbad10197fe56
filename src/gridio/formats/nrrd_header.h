/* SPDX-License-Identifier: BSD-3-Clause */
/** The header of a .nrrd file: lines of text with the type, the sizes and the transform; the values behind
 * it.
 */
#ifndef VXM_GRIDIO_FORMATS_NRRD_HEADER_H
#define VXM_GRIDIO_FORMATS_NRRD_HEADER_H

#include "base/output.h"
#include "gridio/common/values.h"

typedef struct vxm_nrrd_header {
  char kind;       /**< 'i' signed, 'u' unsigned, 'f' floating */
  size_t size;     /**< bytes of a value: 1, 2, 4 or 8 */
  bool big_endian; /**< of values longer than a byte */
  bool gzip;       /**< the values are compressed */
  int channels;    /**< 4 if the fastest axis is that of a colour, else 1 */
  vxm_space space; /**< not checked */
  vxm_about about; /**< destroyed by the caller, also after a failure */
  size_t sizes_offset, data;
} vxm_nrrd_header;

bool vxm_nrrd_sniff(const vxm_input *input);
/** VXM_ERROR_FORMAT with the offset of what is wrong, or of what voxmend cannot take as a grid. */
vxm_status vxm_nrrd_header_read(vxm_nrrd_header *out, const vxm_input *input, vxm_warnings *warnings,
                                vxm_error *error);

/** A field of NRRD that says nothing of the values, and the key of the pair that carries it along. */
typedef struct vxm_nrrd_carried {
  const char *field, *key;
} vxm_nrrd_carried;

enum { VXM_NRRD_CARRIED = 3 };
/** The first is the name of the space. */
extern const vxm_nrrd_carried vxm_nrrd_carried_fields[VXM_NRRD_CARRIED];

/** Keys of what voxmend adds: the minimum corner bit for bit, and what the values stand for. */
#define VXM_NRRD_ORIGIN_KEY "voxmend_origin"
#define VXM_NRRD_VALUES_KEY "voxmend_values"

/** What a header to be written says of the values. */
typedef struct vxm_nrrd_values {
  const char *what; /**< a comment */
  vxm_scalar scalar;
  int channels;           /**< 4 of colours, else 1 */
  const vxm_about *about; /**< NULL = nothing more */
} vxm_nrrd_values;

/**
 * Writes the header, an empty line last. The values follow raw, x fastest, then y, then z. 16-bit floats are
 * none of NRRD's types.
 */
void vxm_nrrd_header_write(vxm_output *output, const vxm_nrrd_values *values, const vxm_space *space);

#endif
