/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/confine.h"

#include <dirent.h>
#include <linux/capability.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "sandbox/landlock.h"
#include "sandbox/syscall_filter.h"

/* ---- Early ---- */

/** C libraries before 2.34 have no name for the system call, which has this number on every architecture, and
 * Linux before 5.9 does not have it. */
static bool close_from(unsigned first) {
  enum { CLOSE_RANGE = 436 };
  if (syscall(CLOSE_RANGE, first, ~0U, 0) == 0)
    return true;
  DIR *folder = opendir("/proc/self/fd");
  if (folder == NULL)
    return false;
  const struct dirent *entry;
  while ((entry = readdir(folder)) != NULL) {
    long descriptor = strtol(entry->d_name, NULL, 10);
    if (descriptor >= (long)first && descriptor != dirfd(folder))
      close((int)descriptor);
  }
  return closedir(folder) == 0;
}

bool vxm_confine_early(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (!VXM_IS_SANITIZED)
    prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
  /* What a library leaves in the current folder's files is not for it to find. */
  return close_from(STDERR_FILENO + 1) && chdir("/") == 0 && getppid() == parent;
}

/* ---- Limits ---- */

static void limit(unsigned resource, rlim_t value, rlim_t most) {
  struct rlimit both;
  if (getrlimit(resource, &both) != 0)
    return;
  both.rlim_max = most < both.rlim_max ? most : both.rlim_max;
  both.rlim_cur = value < both.rlim_cur ? value : both.rlim_cur;
  if (both.rlim_cur > both.rlim_max)
    both.rlim_cur = both.rlim_max;
  setrlimit(resource, &both);
}

/** Bytes of address space and of private writable memory; zeros if they are not known. */
static void held_bytes(rlim_t *all, rlim_t *writable) {
  unsigned long pages[2] = {0, 0};
  rlim_t page = (rlim_t)sysconf(_SC_PAGESIZE);
  FILE *file = fopen("/proc/self/statm", "r");
  if (file != NULL && fscanf(file, "%lu %*s %*s %*s %*s %lu", &pages[0], &pages[1]) != 2)
    pages[0] = pages[1] = 0;
  if (file != NULL)
    fclose(file);
  *all = pages[0] * page;
  *writable = pages[1] * page;
}

/** Only what is held from now on counts: libraries bring some megabytes with them. */
static void limit_memory(const vxm_confinement *c) {
  rlim_t all, writable;
  held_bytes(&all, &writable);
  limit(RLIMIT_DATA, writable + c->memory, writable + c->memory_max);
  /* Memory that is shared is no "data", and counts here. */
  if (!VXM_IS_SANITIZED && all > 0)
    limit(RLIMIT_AS, all + c->memory, all + c->memory_max);
}

static void limit_all(const vxm_confinement *c) {
  enum { MOST_SECONDS = 1000000 };
  limit_memory(c);
  limit(RLIMIT_CPU, c->seconds, MOST_SECONDS);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  limit(RLIMIT_MSGQUEUE, 0, 0);
  limit(RLIMIT_MEMLOCK, 0, 0);
  if (!VXM_IS_SANITIZED)
    limit(RLIMIT_NPROC, 0, 0);
}

/** The superuser's process is to be no more than another's. */
static void drop_capabilities(void) {
  struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
  struct __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3];
  memset(none, 0, sizeof none);
  syscall(SYS_capset, &header, none);
}

const char *vxm_confine(const vxm_confinement *confinement) {
  limit_all(confinement);
  drop_capabilities();
  if (VXM_IS_SANITIZED)
    return NULL;
  bool is_locked = vxm_landlock();
  limit(RLIMIT_NOFILE, STDERR_FILENO + 1, STDERR_FILENO + 1); /* rules of Landlock take a descriptor */
  const char *missing = vxm_syscall_filter(confinement->channel);
  return missing || is_locked ? missing : "Landlock refuses its rules";
}
