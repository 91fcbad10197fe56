/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * All targets as one program of libFuzzer. Which of them it is, its own name tells, "fuzz_npy", or else the
 * variable FUZZ_TARGET: a service that wants a program for each gets copies.
 */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const fuzz_target *target;

int LLVMFuzzerInitialize(int *argc, char ***argv) {
  static const char prefix[] = "fuzz_";
  (void)argc;
  const char *slash = strrchr(**argv, '/'), *own = slash ? slash + 1 : **argv;
  const char *asked = getenv("FUZZ_TARGET");
  if (strncmp(own, prefix, sizeof prefix - 1) == 0)
    target = fuzz_find(own + sizeof prefix - 1);
  else if (asked)
    target = fuzz_find(asked);
  if (target)
    return 0;
  fprintf(stderr, "FUZZ_TARGET has to be one of");
  for (size_t t = 0; fuzz_at(t); t++)
    fprintf(stderr, " %s", fuzz_at(t)->name);
  fprintf(stderr, "\n");
  exit(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  target->run(target->name, data, size);
  return 0;
}
