/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/pid_namespace.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/sched.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/** By its number, which is that of every architecture: the C libraries before 2.34 do not have the call. */
static void close_all_between(unsigned first, unsigned last) {
  enum { CLOSE_RANGE = 436 };
  syscall(CLOSE_RANGE, first, last, 0);
}

/* ---- Whether there are namespaces ---- */

static bool write_file(const char *path, const char *text) {
  int file = open(path, O_WRONLY | O_CLOEXEC);
  bool good = file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text);
  if (file >= 0)
    close(file);
  return good;
}

/** Enters a user namespace in which we are who we were, with the right to make PID namespaces. */
static bool enter_user_namespace(void) {
  char users[64], groups[64];
  snprintf(users, sizeof users, "%ld %ld 1", (long)geteuid(), (long)geteuid());
  snprintf(groups, sizeof groups, "%ld %ld 1", (long)getegid(), (long)getegid());
  return unshare(CLONE_NEWUSER) == 0 && write_file("/proc/self/setgroups", "deny") &&
         write_file("/proc/self/uid_map", users) && write_file("/proc/self/gid_map", groups);
}

/** As fork, but the child is the first process of a new PID namespace; -1 where that cannot be. */
static pid_t fork_namespace(void) {
  struct clone_args how = {.flags = CLONE_NEWPID, .exit_signal = SIGCHLD};
  return (pid_t)syscall(SYS_clone3, &how, sizeof how);
}

static bool has_ended_well(pid_t id) {
  int status;
  while (id > 0 && waitpid(id, &status, 0) < 0)
    if (errno != EINTR)
      return false;
  return id > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static bool can_fork_namespace(void) {
  pid_t id = fork_namespace();
  if (id == 0)
    _exit(0);
  return has_ended_well(id);
}

/** In a child, as what cannot be finished would be left half done. */
static bool can_enter_user_namespace(void) {
  pid_t id = fork();
  if (id == 0)
    _exit(enter_user_namespace() && can_fork_namespace() ? 0 : 1);
  return has_ended_well(id);
}

bool batch_pid_namespaces_open(void) {
  return can_fork_namespace() ||
         (can_enter_user_namespace() && enter_user_namespace() && can_fork_namespace());
}

/* ---- The first process of a namespace ---- */

static void say(int end, const void *data, size_t size) {
  while (send(end, data, size, MSG_NOSIGNAL) < 0 && errno == EINTR) {
  }
}

static bool hear(int end, void *data, size_t size) {
  ssize_t got;
  do
    got = recv(end, data, size, 0);
  while (got < 0 && errno == EINTR);
  return got == (ssize_t)size;
}

/** Waits for the one that works; all that is left to it in between is collected. */
static void wait_for(pid_t worker, int end) {
  for (;;) {
    int status;
    pid_t id = waitpid(-1, &status, 0);
    if (id == worker) {
      say(end, &status, sizeof status);
      return;
    }
    if (id < 0 && errno != EINTR)
      return;
  }
}

/**
 * Returns in the process that is to work. The parent is in another namespace, where its number is not seen
 * from here. So it is told when its end would be ours, and has to answer, which it can no longer if it has
 * gone before.
 */
static void be_first(int end) {
  char word;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);
  say(end, "", 1);
  if (!hear(end, &word, 1))
    _exit(1);
  pid_t worker = fork();
  if (worker == 0) {
    close(end);
    return;
  }
  for (int stream = 0; stream < 3; stream++) /* who waits for the end of these is not to wait for us */
    close(stream);
  close_all_between(3, (unsigned)end - 1);
  close_all_between((unsigned)end + 1, ~0U);
  if (worker > 0)
    wait_for(worker, end);
  _exit(1);
}

pid_t batch_namespace_fork(bool has_namespaces, int *status) {
  int ends[2];
  *status = -1;
  if (!has_namespaces)
    return fork();
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return -1;
  pid_t id = fork_namespace();
  if (id == 0) {
    close(ends[0]);
    be_first(ends[1]);
    return 0;
  }
  close(ends[1]);
  if (id < 0) {
    close(ends[0]);
    return -1;
  }
  char word;
  if (hear(ends[0], &word, 1))
    say(ends[0], "", 1);
  *status = ends[0];
  return id;
}

bool batch_namespace_status(int status, int *wait_status) {
  int found;
  if (status < 0 || recv(status, &found, sizeof found, MSG_DONTWAIT) != (ssize_t)sizeof found)
    return false;
  *wait_status = found;
  return true;
}
