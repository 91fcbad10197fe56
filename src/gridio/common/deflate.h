/* SPDX-License-Identifier: BSD-3-Clause */
/** Bytes through zlib, into an output and out of a file in memory. Without zlib each of these refuses. */
#ifndef VXM_GRIDIO_COMMON_DEFLATE_H
#define VXM_GRIDIO_COMMON_DEFLATE_H

#include "base/output.h"

/** What zlib writes around the bytes. */
typedef enum vxm_deflate_frame { VXM_DEFLATE_ZLIB, VXM_DEFLATE_GZIP } vxm_deflate_frame;

/** Bytes that become smaller on their way into an output. */
typedef struct vxm_deflater vxm_deflater;

/** @return VXM_OK; VXM_ERROR_UNAVAILABLE without zlib; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_deflate_check(const char *path, vxm_error *error);
vxm_status vxm_deflater_create(vxm_deflater **out, vxm_context *context, vxm_output *output,
                               vxm_deflate_frame frame, vxm_error *error);
void vxm_deflater_write(vxm_deflater *deflater, const void *data, size_t size);
/** Writes what is left. */
void vxm_deflater_end(vxm_deflater *deflater);
/** NULL is allowed. */
void vxm_deflater_destroy(vxm_deflater *deflater);
/** Memory that one takes, about. */
#define VXM_DEFLATE_BYTES (UINT64_C(270) << 10)

/** The largest block that is compressed at once. */
enum { VXM_DEFLATE_BLOCK_MAX = 1 << 30 };
/** Room for a block of `size` bytes that does not get smaller. */
size_t vxm_deflate_bound(size_t size);
/**
 * Compresses a block with zlib's frame, into vxm_deflate_bound(data_size) bytes; *size is how many they
 * became. Thread-safe.
 */
vxm_status vxm_deflate_block(vxm_context *context, void *out, size_t *size, const void *data,
                             size_t data_size, vxm_error *error);

/** Whether a file begins as gzip's do. */
static inline bool vxm_is_gzip(const vxm_input *input) {
  return input->size >= 2 && input->data[0] == 0x1f && input->data[1] == 0x8b;
}

/** Compressed bytes of a file, from an offset on; of a gzip file all its members. */
typedef struct vxm_inflater vxm_inflater;

/** @param input outlives it */
vxm_status vxm_inflater_create(vxm_inflater **out, const vxm_input *input, size_t offset, vxm_error *error);
/** The next `size` bytes; VXM_ERROR_FORMAT with the offset if there are fewer, or what is there is damaged.
 */
vxm_status vxm_inflater_read(vxm_inflater *inflater, void *to, size_t size, vxm_error *error);
/** Up to `room` bytes; *out is how many. Fewer are the end. */
vxm_status vxm_inflater_some(vxm_inflater *inflater, void *to, size_t room, size_t *out, vxm_error *error);
/** NULL is allowed. */
void vxm_inflater_destroy(vxm_inflater *inflater);

/** Deflate makes at most so many bytes of one: sizes that a file claims are checked against it. */
enum { VXM_INFLATE_RATIO_MAX = 1032 };

#endif
