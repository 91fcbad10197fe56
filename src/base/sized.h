/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Public structs begin with their size, as the caller was compiled ("Sizes" in voxmend/base.h). Inside the
 * library they are whole: public functions read options and write results by these, and hand down structs of
 * their own.
 *
 * A size of 0 stands for that of version 1.0. Once a field has been added after it, that size is no longer
 * the one that is known here, and has to be written down for the struct.
 */
#ifndef VXM_BASE_SIZED_H
#define VXM_BASE_SIZED_H

#include "voxmend/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Reads a caller's options, or arrays, into the library's own struct, which holds the defaults.
 *
 * @param known bytes of the library's struct
 * @param given NULL = defaults
 * @param what  a word for the message, such as "mesh"
 */
vxm_status vxm_options_read(void *chosen, size_t known, const void *given, const char *what,
                            vxm_error *error);

/** How far apart results of a caller's array lie, by the size of the first. */
size_t vxm_result_stride(const void *first, size_t known);

/** Writes a caller's result, its size apart, as far as it goes; `out` may be NULL. NULL for `made` clears it.
 */
void vxm_result_write(void *out, const void *made, size_t known);

/* With the types compared: one pointer of another type is an error. */
#define VXM_OPTIONS_READ(chosen, given, what, error) \
  vxm_options_read((chosen), sizeof *(chosen), 1 ? (given) : (chosen), (what), (error))
#define VXM_RESULT_WRITE(out, made) vxm_result_write((out), 1 ? (made) : (out), sizeof *(made))
#define VXM_RESULT_CLEAR(out) vxm_result_write((out), NULL, sizeof *(out))
/** Whether a caller's result has a field. */
#define VXM_RESULT_HAS(out, field) \
  ((out)->size == 0 || (out)->size >= (size_t)((const char *)(&(out)->field + 1) - (const char *)(out)))

#ifdef __cplusplus
}
#endif
#endif
