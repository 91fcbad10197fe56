/* SPDX-License-Identifier: BSD-3-Clause */
/** Whole files in, and names of files. */
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
/** The same for a file of which little is looked at: the rest is not read. */
vxm_status vxm_input_open_in_parts(vxm_input *out, vxm_context *context, const char *path, vxm_error *error);
/** The bytes of an open descriptor, which stays open; `name`, for messages, must outlive the input. */
vxm_status vxm_input_take(vxm_input *out, vxm_context *context, const char *name, int descriptor,
                          vxm_error *error);
void vxm_input_close(vxm_input *input);

/** The part of a path behind its last '.', or "" ("a.b/c" has none). */
const char *vxm_path_extension(const char *path);
/** ASCII comparison without case. */
bool vxm_text_equal_nocase(const char *a, const char *b);

#ifdef __cplusplus
}
#endif
#endif
