/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the choice of the reader, UTF-16 included. */
#include "fuzz_mesh.h"

const char fuzz_corpus[] = "any";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_mesh(NULL, data, size);
  return 0;
}
