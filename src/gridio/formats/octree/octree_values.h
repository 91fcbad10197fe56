/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .octree of numbers, labels or colours. The octree is that of the voxels whose value is not the background;
 * behind its index stand the values of these, block after block (octree_blocks.h). doc/formats.md has every
 * byte.
 *
 * Of a brick, node or cube in which all such voxels have one value: 1 and the value; of another 0, and then
 * the values of a brick's voxels, or what is within each child, in Morton order. The form is canonical.
 */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_VALUES_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_VALUES_H

#include "grid/node_values.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/octree/octree_blocks.h"

enum {
  VXM_OCTREE_VALUES_HEADER = 56, /**< bytes: kind 16, type 8, channels 8, background 8, blocks 8, 0 */
  VXM_OCTREE_BACKGROUND = 32,    /**< where it stands in that */
  VXM_OCTREE_VALUE_BYTES = 8     /**< of a value at most */
};

/** Copies a value between the machine's byte order and the file's, which is little-endian. */
static inline void vxm_octree_copy_value(unsigned char *out, const unsigned char *value, size_t bytes,
                                         int channels) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  for (size_t b = 0; b < bytes && channels == 1; b++)
    out[b] = value[bytes - 1 - b];
  if (channels == 1)
    return;
#endif
  (void)channels;
  memcpy(out, value, bytes);
}

/* ---- Writing ---- */

/** Writes values slice by slice, along z. */
extern const vxm_values_writer_kind vxm_octree_values;
/** Instead of slices: makes all values of an open file of this kind in nodes. */
vxm_status vxm_octree_values_make(vxm_values_writer *writer, const vxm_node_maker *maker, vxm_error *error);

/** What encodes nodes of 16 x 16 x 16 voxels, and then all. */
typedef struct vxm_octree_encoder vxm_octree_encoder;

/** @param spec what is written; used later, too */
vxm_status vxm_octree_encoder_create(vxm_octree_encoder **out, vxm_context *context, const vxm_space *space,
                                     const vxm_values_spec *spec, vxm_error *error);
void vxm_octree_encoder_destroy(vxm_octree_encoder *encoder);
/** Takes slices begin..end-1 along z, x fastest: whole strips (VXM_STRIP_VOXELS), or up to the end. */
vxm_status vxm_octree_encoder_put(vxm_octree_encoder *encoder, const unsigned char *values, int64_t begin,
                                  int64_t end, vxm_error *error);
/** Takes all values from a maker; instead of slices. */
vxm_status vxm_octree_encoder_make(vxm_octree_encoder *encoder, const vxm_node_maker *maker,
                                   vxm_error *error);
/** Writes the file. A failed write is told when the output is committed. */
vxm_status vxm_octree_encoder_end(vxm_octree_encoder *encoder, vxm_output *output, vxm_error *error);

/* ---- Reading ---- */

/** Reads the header of the values of a file whose index has been read, and checks it. */
vxm_status vxm_octree_values_open(vxm_sparse_file *file, vxm_error *error);
/** VXM_ERROR_NUMBERS of a file that has values. */
vxm_status vxm_octree_file_need_bits(const vxm_sparse_file *file, vxm_error *error);
/** Called for what stands for the values of a node of level 0, or of a higher one that has one value. */
typedef void (*vxm_octree_found_fn)(int level, const int64_t at[3], const unsigned char *data, void *payload);
/** Checks all values of a file, and calls in Morton order. @param tree of the whole file */
vxm_status vxm_octree_values_visit(const vxm_sparse_file *file, const vxm_sparse *tree,
                                   vxm_octree_found_fn found, void *payload, vxm_error *error);
/** The values of a box of voxels, which has been checked, of a file that has some. */
vxm_status vxm_octree_values_load(vxm_field **out, const vxm_sparse_file *file, const int64_t begin[3],
                                  const int64_t end[3], vxm_error *error);

#endif
