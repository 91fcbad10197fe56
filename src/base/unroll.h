/* SPDX-License-Identifier: BSD-3-Clause */
/** Unrolling of short loops, which GCC leaves as they are at -O2; clang decides well by itself. */
#ifndef VXM_BASE_UNROLL_H
#define VXM_BASE_UNROLL_H

#if defined(__clang__)
#define VXM_UNROLL(count)
#else
#define VXM_PRAGMA(text) _Pragma(#text)
/** Before a loop: that many rounds at once. */
#define VXM_UNROLL(count) VXM_PRAGMA(GCC unroll count)
#endif

#endif
