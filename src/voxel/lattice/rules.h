/* SPDX-License-Identifier: BSD-3-Clause */
/** The rules that the shaders have too, in C: with products of 64 bits, names that end in _64, and of 128. */
#ifndef VXM_VOXEL_LATTICE_RULES_H
#define VXM_VOXEL_LATTICE_RULES_H

#include "base/bits.h"

/* Inlined into loops that are built for several processors. */
#define RULE_FUNCTION static inline __attribute__((always_inline))
#define RULE_TYPE(name) typedef struct name name;
#define RULE_STEP int64_t
#define RULE_TO_WIDE(x) ((RULE_WIDE)(x))
#define RULE_ABS(x) ((x) < 0 ? -(x) : (x))
#define RULE_MAX(a, b) ((a) > (b) ? (a) : (b))

#define RULE(name) name##_64
#define RULE_WIDE int64_t
#define RULE_QUOTIENT int64_t
#include "shaders/rules.h"
#undef RULE
#undef RULE_WIDE
#undef RULE_QUOTIENT

#define RULE(name) name##_128
#define RULE_WIDE vxm_int128
#define RULE_QUOTIENT vxm_int128
#include "shaders/rules.h"
#undef RULE
#undef RULE_WIDE
#undef RULE_QUOTIENT

#undef RULE_FUNCTION
#undef RULE_TYPE
#undef RULE_STEP
#undef RULE_TO_WIDE
#undef RULE_ABS
#undef RULE_MAX

#endif
