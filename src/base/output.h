/* SPDX-License-Identifier: BSD-3-Clause */
/** Files that are written, and appear only when they are complete. */
#ifndef VXM_BASE_OUTPUT_H
#define VXM_BASE_OUTPUT_H

#include "base/file.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * A buffered output. What is written has no name, or a temporary one in the folder of `path`, before
 * vxm_output_commit (base/atomic_file.h); "-" goes to standard output. A failed write is remembered and
 * reported by commit.
 */
typedef struct vxm_output vxm_output;

vxm_status vxm_output_open(vxm_output **out, vxm_context *context, const char *path, vxm_error *error);
/** As vxm_output_open, for an output that can be read back; what goes to standard output or a device waits in
 * a file without a name until it is committed. */
vxm_status vxm_output_open_readable(vxm_output **out, vxm_context *context, const char *path,
                                    vxm_error *error);
/**
 * Says that at least `bytes` will be written, before the first of them: asks whether there is room, and takes
 * it where the file system can.
 *
 * @return VXM_OK; VXM_ERROR_IO if the disk has less free, or files may not become so large. Then only
 *         vxm_output_abort is allowed.
 */
vxm_status vxm_output_expect(vxm_output *output, uint64_t bytes, vxm_error *error);
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
/**
 * Completes the file and gives it its name, or keeps it until vxm_context_publish_files; frees the output
 * either way. Nothing is left behind on failure, and what the file would have replaced is still there.
 */
vxm_status vxm_output_commit(vxm_output *output, vxm_error *error);
/** The same for two files, of which none appears without the other; `second` may be NULL. */
vxm_status vxm_output_commit_both(vxm_output *first, vxm_output *second, vxm_error *error);
struct vxm_file_transaction_file;
/** Completes a file, and adds it to a list of files that get their names together
 * (base/file_transaction.h). Frees the output either way. */
vxm_status vxm_output_keep(vxm_output *output, struct vxm_file_transaction_file **list, vxm_error *error);
/** The same for a file of the library's own, which never waits for others. */
vxm_status vxm_output_commit_now(vxm_output *output, vxm_error *error);
/** Drops the output: no file is left. NULL is allowed. */
void vxm_output_abort(vxm_output *output);

#ifdef __cplusplus
}
#endif
#endif
