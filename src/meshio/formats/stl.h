/* SPDX-License-Identifier: BSD-3-Clause */
/** What the two readers of STL share: where a binary file has its facets. */
#ifndef VXM_MESHIO_FORMATS_STL_H
#define VXM_MESHIO_FORMATS_STL_H

#include "meshio/common/tokenizer.h"

/** 80 bytes of text, a 32-bit count, then 50 bytes for each facet: normal, three corners, two spare bytes. */
enum { VXM_STL_COUNT_AT = 80, VXM_STL_FACETS_AT = 84, VXM_STL_FACET = 50 };

/** How many facets a file of at least 84 bytes announces. */
uint64_t vxm_stl_announced(const unsigned char *data);

/**
 * Whether a file is binary STL, whatever its header and its count say. Its size is 84 + 50 n and the count is
 * n, or its facets look like facets, which neither text nor another format brings about.
 */
bool vxm_stl_is_binary(const unsigned char *data, size_t size);

/** Bytes that a text never has: control codes other than blanks and line ends. */
size_t vxm_control_bytes(const unsigned char *data, size_t size);

vxm_status vxm_stl_read_text(vxm_tokenizer *scan, vxm_error *error);

#endif
