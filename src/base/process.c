/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

enum { TELL_MS = 50, PIECE = 1 << 20 };

/* ---- Start ---- */

static void close_both(const int ends[2]) {
  close(ends[0]);
  close(ends[1]);
}

/** A pair of sockets that is closed in other programs, and lies above the standard streams. */
static bool open_channel(int ends[2]) {
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return false;
  for (int e = 0; e < 2; e++) {
    if (ends[e] > STDERR_FILENO)
      continue;
    int higher = fcntl(ends[e], F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (higher < 0) {
      close_both(ends);
      return false;
    }
    close(ends[e]);
    ends[e] = higher;
  }
  return true;
}

static int prepare_files(posix_spawn_file_actions_t *files, int channel) {
  int failure = posix_spawn_file_actions_adddup2(files, channel, STDIN_FILENO);
  for (int f = STDOUT_FILENO; f <= STDERR_FILENO && failure == 0; f++)
    failure = posix_spawn_file_actions_addopen(files, f, "/dev/null", O_WRONLY, 0);
  return failure;
}

/** A session of its own, so that an interrupt from the terminal is the caller's to handle. */
static int prepare_signals(posix_spawnattr_t *attributes) {
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  int failure = posix_spawnattr_setflags(attributes,
                                         POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  if (failure == 0)
    failure = posix_spawnattr_setsigmask(attributes, &none);
  return failure == 0 ? posix_spawnattr_setsigdefault(attributes, &all) : failure;
}

/* Names of our variables that the program gets too, and values that it gets whatever ours are. */
static const char *const inherited[] = {
    "LD_LIBRARY_PATH",
#if defined(__SANITIZE_ADDRESS__)
    "ASAN_OPTIONS",
    "LSAN_OPTIONS",
    "UBSAN_OPTIONS",
#endif
};
static const char *const fixed[] = {"LANG=C",           "LC_ALL=C",           "PATH=/usr/bin:/bin",
                                    "TZ=UTC0",          "MALLOC_ARENA_MAX=1", "OMP_NUM_THREADS=1",
                                    "HOME=/nonexistent"};
enum {
  INHERITED = sizeof inherited / sizeof *inherited,
  FIXED = sizeof fixed / sizeof *fixed,
  VARIABLES = INHERITED + FIXED
};

static void free_environment(char **variables) {
  for (size_t v = 0; variables[v]; v++)
    free(variables[v]);
}

/** A list that NULL ends; false for want of memory. */
static bool make_environment(char *variables[VARIABLES + 1]) {
  size_t count = 0;
  memset(variables, 0, (VARIABLES + 1) * sizeof *variables);
  for (size_t f = 0; f < FIXED; f++)
    if (!(variables[count++] = strdup(fixed[f])))
      return false;
  for (size_t i = 0; i < INHERITED; i++) {
    const char *value = secure_getenv(inherited[i]);
    if (value && asprintf(&variables[count++], "%s=%s", inherited[i], value) < 0) {
      variables[count - 1] = NULL;
      return false;
    }
  }
  return true;
}

/** 0, or the errno of what failed. */
static int spawn(pid_t *id, const char *program, char *const arguments[], int channel) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  char *variables[VARIABLES + 1];
  int failure = posix_spawn_file_actions_init(&files);
  if (failure != 0)
    return failure;
  if (!make_environment(variables))
    failure = ENOMEM;
  if (failure == 0)
    failure = posix_spawnattr_init(&attributes);
  if (failure == 0) {
    failure = prepare_files(&files, channel);
    if (failure == 0)
      failure = prepare_signals(&attributes);
    if (failure == 0)
      failure = posix_spawn(id, program, &files, &attributes, arguments, variables);
    posix_spawnattr_destroy(&attributes);
  }
  free_environment(variables);
  posix_spawn_file_actions_destroy(&files);
  return failure;
}

vxm_status vxm_process_start(vxm_process *out, vxm_context *context, const char *phase, const char *program,
                             char *const arguments[], vxm_error *error) {
  int ends[2];
  double now = vxm_clock_ms();
  *out = (vxm_process){.channel = -1, .context = context, .phase = phase, .told_ms = now, .seen_ms = now};
  if (!open_channel(ends))
    return vxm_fail_errno(error, program, "cannot open a channel to it");
  int failure = spawn(&out->id, program, arguments, ends[1]);
  close(ends[1]);
  if (failure != 0) {
    close(ends[0]);
    errno = failure;
    return vxm_fail_errno(error, program, "cannot start");
  }
  out->channel = ends[0];
  return VXM_OK;
}

/* ---- Talk ---- */

bool vxm_process_is_late(const vxm_process *process) {
  return process->limit_ms > 0 && process->waited_ms > process->limit_ms;
}

/** What passes while we are stopped, or suspended, is no fault of the program. */
static void count_wait(vxm_process *process, double now) {
  enum { STEP_MS = 1000 };
  double passed = now - process->seen_ms;
  process->waited_ms += passed < STEP_MS ? passed : STEP_MS;
  process->seen_ms = now;
}

static vxm_status tell(vxm_process *process, vxm_error *error) {
  double now = vxm_clock_ms();
  count_wait(process, now);
  if (vxm_process_is_late(process))
    return VXM_ERROR_IO;
  if (now - process->told_ms < TELL_MS)
    return VXM_OK;
  process->told_ms = now;
  return vxm_progress(process->context, process->phase, process->fraction, error);
}

/** Waits until bytes can go over, in steps short enough for progress. */
static vxm_status wait_for(vxm_process *process, short event, vxm_error *error) {
  for (;;) {
    struct pollfd channel = {.fd = process->channel, .events = event};
    int ready = poll(&channel, 1, TELL_MS);
    vxm_status status = tell(process, error);
    if (status != VXM_OK || ready > 0)
      return status;
    if (ready < 0 && errno != EINTR)
      return VXM_ERROR_IO;
  }
}

static bool is_passing(int reason) {
  return reason == EINTR || reason == EAGAIN || reason == EWOULDBLOCK;
}

vxm_status vxm_process_send(vxm_process *process, const void *data, size_t size, vxm_error *error) {
  const char *at = data;
  while (size > 0) {
    vxm_status status = wait_for(process, POLLOUT, error);
    if (status != VXM_OK)
      return status;
    ssize_t sent = send(process->channel, at, size < PIECE ? size : PIECE, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && !is_passing(errno))
      return VXM_ERROR_IO;
    if (sent > 0) {
      at += sent;
      size -= (size_t)sent;
    }
  }
  return VXM_OK;
}

vxm_status vxm_process_receive(vxm_process *process, void *data, size_t size, vxm_error *error) {
  char *at = data;
  while (size > 0) {
    vxm_status status = wait_for(process, POLLIN, error);
    if (status != VXM_OK)
      return status;
    ssize_t got = recv(process->channel, at, size < PIECE ? size : PIECE, MSG_DONTWAIT);
    if (got == 0 || (got < 0 && !is_passing(errno)))
      return VXM_ERROR_IO;
    if (got > 0) {
      at += got;
      size -= (size_t)got;
    }
  }
  return VXM_OK;
}

static void raise_limit(pid_t id, unsigned resource, uint64_t more) {
  struct rlimit limits;
  if (prlimit(id, resource, NULL, &limits) != 0 || limits.rlim_cur == RLIM_INFINITY)
    return;
  rlim_t room = limits.rlim_max - limits.rlim_cur;
  limits.rlim_cur += more < room ? more : room;
  prlimit(id, resource, &limits, NULL);
}

void vxm_process_allow(const vxm_process *process, uint64_t bytes, uint64_t seconds) {
  raise_limit(process->id, RLIMIT_DATA, bytes);
  raise_limit(process->id, RLIMIT_AS, bytes);
  raise_limit(process->id, RLIMIT_CPU, seconds);
}

int vxm_process_end(vxm_process *process) {
  siginfo_t info = {.si_pid = 0};
  int status = 0;
  close(process->channel);
  /* While it is not collected its number, which is that of its group, is nobody else's. */
  if (waitid(P_PID, (id_t)process->id, &info, WEXITED | WNOHANG | WNOWAIT) != 0)
    return 0;
  kill(-process->id, SIGKILL);
  pid_t done;
  do
    done = waitpid(process->id, &status, 0);
  while (done < 0 && errno == EINTR);
  return done == process->id ? status : 0;
}
