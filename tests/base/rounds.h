/* SPDX-License-Identifier: BSD-3-Clause */
/** How many random cases a test tries. */
#ifndef TEST_BASE_ROUNDS_H
#define TEST_BASE_ROUNDS_H

/** A quarter under a sanitizer, which looks at how the cases are computed: what comes out of them is told by
 * the build without one, which tries them all. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ROUNDS(n) (((n) + 3) / 4)
#else
#define ROUNDS(n) (n)
#endif

#endif
