/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/syscall_filter.h"

#include <stddef.h>

#include "config.h"

#ifdef HAVE_SECCOMP

#include <errno.h>
#include <fcntl.h>
#include <seccomp.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "sandbox/wire_format.h"

/* What computing takes. Whatever the libraries open, ask or start at their first use they have done before
 * (vxm_reader.prepare). Threads that they have started by then, as log4cplus does below OpenVDB, get the
 * filter too, perhaps before they have run. */
static const int allowed[] = {
    /* the channel; libraries print to where nobody listens */
    SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(readv), SCMP_SYS(writev), SCMP_SYS(close),
    /* memory; mmap and mprotect below */
    SCMP_SYS(brk), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise),
    /* clocks and randomness */
    SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres), SCMP_SYS(clock_nanosleep), SCMP_SYS(nanosleep),
    SCMP_SYS(gettimeofday), SCMP_SYS(time), SCMP_SYS(times), SCMP_SYS(getrandom), SCMP_SYS(sysinfo),
    /* itself: signals of its own, such as that of abort(), and its end */
    SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(futex), SCMP_SYS(sched_yield), SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(sigreturn), SCMP_SYS(sigaltstack),
    SCMP_SYS(restart_syscall), SCMP_SYS(exit), SCMP_SYS(exit_group),
    /* a thread's first calls, which name places in its own memory */
    SCMP_SYS(rseq), SCMP_SYS(set_robust_list)};

static int channel_of_handler;

/** Tells which call it was, and ends. */
static void stop(int signal, siginfo_t *info, void *context) {
  (void)signal;
  (void)context;
  vxm_wire_send_attempt(channel_of_handler, info->si_syscall);
  syscall(SYS_exit_group, 1);
}

/** mmap and mprotect: never to execute, and to share with nobody. */
static int allow_memory(scmp_filter_ctx filter) {
  const struct scmp_arg_cmp plain = SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0);
#if defined(__s390x__) /* mmap takes the address of its arguments, where a filter cannot look */
  int failure = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 0);
#else
  const struct scmp_arg_cmp own = SCMP_A3(SCMP_CMP_MASKED_EQ, MAP_SHARED, 0);
  int failure = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 2, plain, own);
#endif
  if (failure == 0)
    failure = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1, plain);
  return failure;
}

/** A stream asks what it is connected to when it is first printed to, and does without an answer. */
static int refuse_quietly(scmp_filter_ctx filter) {
  const struct scmp_arg_cmp by_descriptor = SCMP_A3(SCMP_CMP_MASKED_EQ, AT_EMPTY_PATH, AT_EMPTY_PATH);
  int failure = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EBADF), SCMP_SYS(fstat), 0);
  if (failure == 0)
    failure = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EBADF), SCMP_SYS(newfstatat), 1, by_descriptor);
  return failure;
}

static int allow_all(scmp_filter_ctx filter) {
  for (size_t a = 0; a < sizeof allowed / sizeof *allowed; a++) {
    int failure = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[a], 0);
    if (failure != 0)
      return failure;
  }
  /* A signal to itself, of which abort() is made. */
  const struct scmp_arg_cmp self = {.arg = 0, .op = SCMP_CMP_EQ, .datum_a = (scmp_datum_t)getpid()};
  int failure = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, self);
  if (failure == 0)
    failure = allow_memory(filter);
  return failure == 0 ? refuse_quietly(filter) : failure;
}

const char *vxm_syscall_filter(int channel) {
  struct sigaction action = {.sa_sigaction = stop, .sa_flags = SA_SIGINFO | SA_NODEFER};
  channel_of_handler = channel;
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_TRAP);
  if (filter == NULL)
    return "the library makes no filter";
  int failure = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
  if (failure == 0)
    failure = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
  if (failure == 0)
    failure = allow_all(filter);
  if (failure == 0 && sigaction(SIGSYS, &action, NULL) != 0)
    failure = -errno;
  if (failure == 0)
    failure = seccomp_load(filter);
  /* The filter's memory is left to it: freeing it is one more call that could want something. */
  return failure == 0 ? NULL : strerror(-failure);
}

#else

const char *vxm_syscall_filter(int channel) {
  (void)channel;
  return NULL;
}

#endif
