/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/machine_memory.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <unistd.h>

/** The limit of the control group that is the root here, as it is in a container; UINT64_MAX if it has none.
 */
static uint64_t group_limit(void) {
  uint64_t limit = UINT64_MAX;
  FILE *file = fopen("/sys/fs/cgroup/memory.max", "re");
  if (!file)
    return UINT64_MAX;
  if (fscanf(file, "%" SCNu64, &limit) != 1 || limit == 0) /* "max" */
    limit = UINT64_MAX;
  fclose(file);
  return limit;
}

uint64_t vxm_machine_memory(void) {
  static _Atomic uint64_t known;
  uint64_t bytes = atomic_load_explicit(&known, memory_order_relaxed);
  if (bytes)
    return bytes;
  long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  uint64_t limit = group_limit();
  bytes = pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : UINT64_MAX;
  bytes = bytes < limit ? bytes : limit;
  atomic_store_explicit(&known, bytes, memory_order_relaxed);
  return bytes;
}
