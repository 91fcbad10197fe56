/* SPDX-License-Identifier: BSD-3-Clause */
/** Whole files in, and outputs that appear only when they are complete. */
#ifndef VXM_BASE_FILE_H
#define VXM_BASE_FILE_H

#include "base/context.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The bytes of a file, mapped or (for pipes) read; never written to. */
typedef struct vxm_input {
  const unsigned char *data;
  size_t size;
  const char *name; /**< as given; "-" is shown as "<stdin>" */
  void *mapping;    /**< what to unmap, or NULL */
  void *block;      /**< what to free, or NULL */
  vxm_context *context;
} vxm_input;

/** Opens a file; "-" is standard input. The path must outlive the input. */
vxm_status vxm_input_open(vxm_input *out, vxm_context *context, const char *path, vxm_error *error);
void vxm_input_close(vxm_input *input);

/**
 * A buffered output. It is written to a temporary file in the folder of `path`, which takes its name only in
 * vxm_output_commit; "-" goes to standard output. A failed write is remembered and reported by commit.
 */
typedef struct vxm_output vxm_output;

vxm_status vxm_output_open(vxm_output **out, vxm_context *context, const char *path, vxm_error *error);
/** As vxm_output_open, for an output that can be read back; what goes to standard output or a device waits in
 * a file without a name until it is committed. */
vxm_status vxm_output_open_readable(vxm_output **out, vxm_context *context, const char *path,
                                    vxm_error *error);
/** What was written so far; of an output opened as readable. Closed with vxm_input_close before it is
 * committed. */
vxm_status vxm_output_read_back(vxm_input *out, vxm_output *output, vxm_error *error);
void vxm_output_write(vxm_output *output, const void *data, size_t size);
void vxm_output_printf(vxm_output *output, const char *format, ...) VXM_PRINTF(2, 3);
/** A pointer to at least `room` (at most 4096) free bytes of the buffer; say with vxm_output_advance how many
 * were used. */
char *vxm_output_reserve(vxm_output *output, size_t room);
void vxm_output_advance(vxm_output *output, size_t used);
/** Whether what was written can be replaced: a file can, a pipe or device cannot. */
bool vxm_output_can_patch(const vxm_output *output);
/** Replaces `size` bytes from `offset` on, all of which have been written. */
void vxm_output_patch(vxm_output *output, uint64_t offset, const void *data, size_t size);
/** Whether an earlier write failed: long writers may stop early. */
bool vxm_output_failed(const vxm_output *output);
/** Closes and renames, and frees the output either way. Nothing is left behind on failure. */
vxm_status vxm_output_commit(vxm_output *output, vxm_error *error);
/** Drops the output: no file is left. NULL is allowed. */
void vxm_output_abort(vxm_output *output);

/** The part of a path behind its last '.', or "" ("a.b/c" has none). */
const char *vxm_path_extension(const char *path);
/** ASCII comparison without case. */
bool vxm_text_equal_nocase(const char *a, const char *b);

#ifdef __cplusplus
}
#endif
#endif
