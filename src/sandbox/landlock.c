/* SPDX-License-Identifier: BSD-3-Clause */
/* By its system calls: the headers of Debian 12 know only the first of its versions. */
#include "sandbox/landlock.h"

#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The numbers are those of every architecture. */
enum { CREATE_RULESET = 444, RESTRICT_SELF = 446, ASK_VERSION = 1 };

/** Grew by a field with the fourth and with the sixth version. */
typedef struct ruleset {
  uint64_t files, ports, scopes;
} ruleset;

int vxm_landlock_version(void) {
  long version = syscall(CREATE_RULESET, NULL, 0, ASK_VERSION);
  return version > 0 ? (int)version : 0;
}

/** Every kind of access that a version can deny; a version refuses kinds that it does not know. */
static ruleset deny_all(int version) {
  enum { FILES = 13, REFER = 13, TRUNCATE = 14, DEVICES = 15 };
  ruleset all = {.files = (UINT64_C(1) << FILES) - 1};
  if (version >= 2)
    all.files |= UINT64_C(1) << REFER;
  if (version >= 3)
    all.files |= UINT64_C(1) << TRUNCATE;
  if (version >= 4)
    all.ports = 3; /* bind and connect of TCP */
  if (version >= 5)
    all.files |= UINT64_C(1) << DEVICES;
  if (version >= 6)
    all.scopes = 3; /* abstract sockets, signals */
  return all;
}

bool vxm_landlock(void) {
  int version = vxm_landlock_version();
  if (version == 0)
    return true;
  ruleset all = deny_all(version);
  size_t size = version >= 6 ? sizeof all : version >= 4 ? 2 * sizeof(uint64_t) : sizeof(uint64_t);
  int rules = (int)syscall(CREATE_RULESET, &all, size, 0);
  if (rules < 0)
    return false;
  bool is_done = syscall(RESTRICT_SELF, rules, 0) == 0;
  close(rules);
  return is_done;
}
