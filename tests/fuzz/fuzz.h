/* SPDX-License-Identifier: BSD-3-Clause */
/** What the fuzz targets share: a table of them, and what each does with any bytes. */
#ifndef VXM_TESTS_FUZZ_H
#define VXM_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Hands the bytes to a reader, and aborts if that breaks a promise. */
typedef void fuzz_function(const char *name, const uint8_t *data, size_t size);

typedef struct fuzz_target {
  const char *name; /**< also of its seeds in corpus/ and of its dictionary */
  fuzz_function *run;
  bool is_slow;       /**< each run starts a process */
  const char *module; /**< without which it is skipped; NULL = none */
} fuzz_target;

/** NULL if there is none of this name. */
const fuzz_target *fuzz_find(const char *name);
/** The i-th target, from 0 on; NULL behind the last. */
const fuzz_target *fuzz_at(size_t index);

/** Aborts unless a promise holds. */
void fuzz_require(bool holds, const char *what);

/* A function for each kind of reader; `name` is the target's. */
fuzz_function fuzz_mesh, fuzz_foreign, fuzz_grid, fuzz_raw, fuzz_sidecar, fuzz_wire;

#endif
