/* SPDX-License-Identifier: BSD-3-Clause */
/** The end of what base/build_avx2.h or base/build_avx512.h begins. */
#if defined(__clang__)
#pragma clang attribute pop
#endif
