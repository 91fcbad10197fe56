/* SPDX-License-Identifier: BSD-3-Clause */
/** What a child does to itself before it works: so that it can harm nobody, and ends with its parent. */
#include "batch/zygote_loop.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

static void limit(unsigned what, uint64_t value) {
  struct rlimit r;
  if (getrlimit(what, &r) != 0 || value > r.rlim_max)
    return;
  r.rlim_cur = r.rlim_max = (rlim_t)value;
  setrlimit(what, &r);
}

/** What the program holds before it begins: tables and libraries. */
static uint64_t held_bytes(void) {
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "re");
  if (file && fscanf(file, "%*s %*s %*s %*s %*s %lu", &pages) != 1)
    pages = 0;
  if (file)
    fclose(file);
  return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/** The library keeps the limit itself, and says so; this one is for what it does not see. */
static void limit_memory(uint64_t bytes) {
  const uint64_t unseen = UINT64_C(256) << 20;
#ifndef __SANITIZE_ADDRESS__
  if (bytes > 0 && bytes < UINT64_MAX / 2)
    limit(RLIMIT_DATA, bytes + unseen + held_bytes());
#else
  (void)bytes, (void)unseen, (void)held_bytes;
#endif
}

/** Where memory runs out it is the child that the kernel is to end, not who waits for it. */
static void be_first_to_go(void) {
  int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0)
    return;
  if (write(file, "800", 3) != 3) {
    /* then the kernel chooses as it thinks best */
  }
  close(file);
}

static void reset_signals(void) {
  sigset_t none;
  for (int number = 1; number < NSIG; number++)
    if (number != SIGKILL && number != SIGSTOP)
      signal(number, SIG_DFL);
  signal(SIGXFSZ, SIG_IGN); /* a write beyond the limit fails, and says so */
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
}

static bool redirect(int input, int message) {
  int null = open("/dev/null", O_RDWR | O_CLOEXEC);
  return null >= 0 && dup2(input >= 0 ? input : null, STDIN_FILENO) >= 0 && dup2(null, STDOUT_FILENO) >= 0 &&
         dup2(message, STDERR_FILENO) >= 0;
}

bool batch_child_bind(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);
  return getppid() == parent;
}

bool batch_child_prepare(int input, int message, const batch_limits *limits) {
  reset_signals();
  be_first_to_go();
  limit(RLIMIT_CORE, 0);
  limit_memory(limits->memory);
  if (limits->file_bytes > 0)
    limit(RLIMIT_FSIZE, limits->file_bytes);
  return redirect(input, message);
}
