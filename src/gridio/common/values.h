/* SPDX-License-Identifier: BSD-3-Clause */
/** A field: the numbers, labels or colours of a file, one for each voxel. A vxm_field of the public header.
 */
#ifndef VXM_GRIDIO_COMMON_VALUES_H
#define VXM_GRIDIO_COMMON_VALUES_H

#include "base/file.h"
#include "base/scalar.h"
#include "base/warnings.h"
#include "grid/bitgrid.h"
#include "gridio/common/metadata.h"
#include "gridio/common/scalar_type.h"
#include "voxel/parts/face_labels.h"

#include <string.h>

/** What a file says of its values beside their type. */
typedef struct vxm_about {
  bool is_declared;      /**< it says what they are */
  vxm_field_kind kind;   /**< VXM_FIELD_NUMBERS if it does not */
  vxm_label_table table; /**< count 0 = none */
  vxm_metadata pairs;
  bool starved; /**< the table, or the file beside the values, found no memory */
} vxm_about;

/** How a field is shown by formats that leave a choice. */
typedef struct vxm_style {
  const char *blocks; /**< names of Minecraft's blocks between commas, NULL = the format's own; not owned */
  int up; /**< axis that becomes the y of formats in which y points up: 0 = z, 1 = x, 2 = y, 3 = z */
} vxm_style;

struct vxm_field {
  vxm_context *context; /**< one reference held */
  vxm_space space;
  vxm_scalar scalar;
  int channels;
  unsigned char *values; /**< [x][y][z][channels] in C order, in the byte order of the machine */
  vxm_about about;
  vxm_style style; /**< set for the time of writing */
  vxm_warnings warnings;
};

/** Makes a field whose values are still to be filled. The space has been checked. */
vxm_status vxm_field_make(vxm_field **out, vxm_context *context, const vxm_space *space, vxm_field_kind kind,
                          vxm_scalar scalar, vxm_error *error);
/** The same with zeros, which take no memory before they are written to. */
vxm_status vxm_field_make_zeros(vxm_field **out, vxm_context *context, const vxm_space *space,
                                vxm_field_kind kind, vxm_scalar scalar, vxm_error *error);

/** Ends the making: *out is the field if `status` is VXM_OK, and what is said of its values found memory;
 * else it is destroyed. */
static inline vxm_status vxm_field_hand_over(vxm_field **out, vxm_field *field, vxm_status status,
                                             vxm_error *error) {
  if (status == VXM_OK && (field->about.starved || field->about.pairs.starved))
    status = vxm_fail(error, VXM_ERROR_MEMORY, "out of memory for what the file says of its values");
  *out = status == VXM_OK ? field : NULL;
  if (status != VXM_OK)
    vxm_field_destroy(field);
  return status;
}

static inline size_t vxm_field_count(const vxm_field *field) {
  return (size_t)field->space.dims[0] * (size_t)field->space.dims[1] * (size_t)field->space.dims[2];
}

/** Bytes of all numbers of a voxel. */
static inline size_t vxm_field_voxel_bytes(const vxm_field *field) {
  return vxm_scalar_bytes(field->scalar) * (size_t)field->channels;
}

static inline bool vxm_scalar_is_float(vxm_scalar scalar) {
  return scalar == VXM_FLOAT64 || scalar == VXM_FLOAT32 || scalar == VXM_FLOAT16;
}

/** @param kind 'i' signed, 'u' unsigned, 'f' floating; size 1, 2, 4 or 8 bytes, and 2 or more of 'f' */
vxm_scalar vxm_scalar_of(char kind, size_t size);
/** By the name that vxm_scalar_name or vxm_field_kind_name gives; false if there is none. */
bool vxm_scalar_find(vxm_scalar *out, const char *name);
bool vxm_field_kind_find(vxm_field_kind *out, const char *name);
/** Takes what a file calls its values, which may be NULL; a name that is none, or "numbers", says nothing. */
void vxm_about_name(vxm_about *about, const char *name);

void vxm_about_destroy(vxm_about *about);
/** Whether values of which this is said may be bits by a rule. Distances and confidences mean something else
 * by 0 and 1, and what was declared is not meant as bits. */
bool vxm_about_may_be_bits(const vxm_about *about, vxm_bits_rule rule);
/** Gives a field what is said of it, and takes that over. The kind counts only if it goes with the type. */
void vxm_field_describe(vxm_field *field, vxm_about *about);
/** Add a label to the table of a field, or a pair of texts. @return VXM_OK; VXM_ERROR_MEMORY; VXM_ERROR_RANGE
 * beyond what a field carries of pairs */
vxm_status vxm_field_put_label(vxm_field *field, const char *name, int64_t voxels, vxm_error *error);
vxm_status vxm_field_put_pair(vxm_field *field, const char *key, const char *value, vxm_error *error);
/** Adds an entry to a table of labels; false without memory. */
bool vxm_label_table_add(vxm_label_table *table, vxm_context *context, const char *name, int64_t voxels);

/** The number of a voxel of whole numbers that were found to be 0 to 65535. */
static inline uint16_t vxm_field_label(const vxm_field *field, size_t voxel) {
  size_t size = vxm_scalar_bytes(field->scalar);
  const unsigned char *at = field->values + voxel * size;
  if (size == 1)
    return *at;
  uint16_t low; /* of the bytes, those that are not 0 */
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  at += size - 2;
#endif
  memcpy(&low, at, sizeof low);
  return low;
}

/** Numbers of voxels begin to begin + count - 1 as doubles, which hold all but large ones of 64 bits exactly;
 * of colours their opacity. */
void vxm_field_doubles(double *out, const vxm_field *field, size_t begin, size_t count);

/** VXM_ERROR_NUMBERS of a file, which says how bits are made of them. @param what such as "float32" */
vxm_status vxm_fail_numbers(vxm_error *error, const char *file, const char *what);

/** A grid of a field that is bits in another type; VXM_ERROR_NUMBERS of the file if it is not. */
vxm_status vxm_field_to_bits(vxm_grid **out, const vxm_field *field, const char *file, vxm_error *error);
/** Whether a 32-bit float is each number exactly. */
bool vxm_field_is_float_exactly(const vxm_field *field);
/** Makes floats those of a type again, if each is one exactly; else it leaves them as they are. */
vxm_status vxm_field_narrow(vxm_field *field, vxm_scalar scalar, vxm_error *error);

/* ---- Between the order of a file and that of a field ---- */

/**
 * Puts numbers that lie x fastest, then y, then z, into their places: slices begin to end - 1 across z.
 *
 * @param is_swapped their bytes are those of the other byte order
 */
void vxm_field_put_slices(vxm_field *field, const unsigned char *data, int64_t begin, int64_t end,
                          bool is_swapped);
/** Puts all numbers, which lie as in the field, but perhaps in the other byte order. */
void vxm_field_put_all(vxm_field *field, const unsigned char *data, bool is_swapped);
/** Takes slices across z out, x fastest, then y. */
void vxm_field_take_slices(unsigned char *out, const vxm_field *field, int64_t begin, int64_t end);
/** Sets a field to bits: 0 and 1. It is of VXM_UINT8. */
void vxm_field_put_grid(vxm_field *field, const vxm_grid *grid);

#endif
