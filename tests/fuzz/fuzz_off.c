/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the reader of OFF. */
#include "fuzz_mesh.h"

const char fuzz_corpus[] = "off";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_mesh(vxm_off_read, data, size);
  return 0;
}
