/* SPDX-License-Identifier: BSD-3-Clause */
/** What the fuzz targets share: one reader, any bytes, and what must hold after. */
#ifndef FUZZ_MESH_H
#define FUZZ_MESH_H

#include "meshio/format.h"

typedef vxm_status fuzz_reader(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                               vxm_error *error);

/**
 * Reads the bytes, by the reader that their content asks for if `reader` is NULL, and aborts if it breaks a
 * promise: indices in range, one line of text for a failure, and memory in proportion to the size.
 */
void fuzz_mesh(fuzz_reader *reader, const uint8_t *data, size_t size);

/** Each target has these two: the entry of libFuzzer, and the folder of its seeds. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
extern const char fuzz_corpus[];

#endif
