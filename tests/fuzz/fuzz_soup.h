/* SPDX-License-Identifier: BSD-3-Clause */
/** What must hold of what readers give. */
#ifndef VXM_TESTS_FUZZ_SOUP_H
#define VXM_TESTS_FUZZ_SOUP_H

#include "mesh/soup.h"

/** Of one thread; it may hold `rate` bytes for each of the file, and some besides. */
vxm_context *fuzz_context(size_t size, uint64_t rate, uint64_t besides);
/** Aborts unless indices are in range and warnings are one line. */
void fuzz_check_soup(const vxm_soup *soup);
/** Aborts unless a failure is described by one line. */
void fuzz_check_error(const vxm_error *error, vxm_status status);

#endif
