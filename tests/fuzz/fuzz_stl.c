/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the reader of STL. */
#include "fuzz_mesh.h"

const char fuzz_corpus[] = "stl";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_mesh(vxm_stl_read, data, size);
  return 0;
}
