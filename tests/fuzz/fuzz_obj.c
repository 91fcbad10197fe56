/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the reader of OBJ. */
#include "fuzz_mesh.h"

const char fuzz_corpus[] = "obj";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_mesh(vxm_obj_read, data, size);
  return 0;
}
