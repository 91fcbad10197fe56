/* SPDX-License-Identifier: BSD-3-Clause */
/** SHA-256 of what is in memory and in files, as hexadecimal text. */
#ifndef VXM_BATCH_DIGEST_H
#define VXM_BATCH_DIGEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BATCH_DIGEST = 65 }; /**< bytes of its text, with the zero */

void batch_digest(char out[BATCH_DIGEST], const void *data, size_t size);
/** Of a file, and how long it is. False with errno set if it cannot be read. */
bool batch_digest_file(char out[BATCH_DIGEST], uint64_t *bytes, const char *path);
/** The same of an open file, from its beginning; its position stays. */
bool batch_digest_open(char out[BATCH_DIGEST], uint64_t *bytes, int descriptor);

#endif
