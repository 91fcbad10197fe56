/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Makes meshes hostile: preloaded, it does harm to the process that opens a file for reading whose name tells
 * how. "crash", "abort", "hang", "flood" (standard error without end), "memory" (takes all), "stray" (leaves
 * a process in a session of its own), "bomb" (processes that fork and leave their session, too), "kill" (as
 * the system would in want of memory).
 */
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static void flood(void) {
  static char text[1 << 16];
  memset(text, 'x', sizeof text);
  while (write(STDERR_FILENO, text, sizeof text) > 0) {
  }
}

static void take_all(void) {
  for (;;) {
    char *block = malloc(1 << 24);
    if (!block)
      _exit(1);
    memset(block, 1, 1 << 24);
  }
}

/** A process that nobody waits for. */
static void leave_stray(void) {
  if (fork() == 0) {
    setsid();
    if (fork() == 0)
      for (;;)
        pause();
    _exit(0);
  }
}

/** Some hundred processes, each in a session of its own. */
static void bomb(void) {
  for (int depth = 0; depth < 8; depth++)
    if (fork() == 0)
      setsid();
  for (;;)
    pause();
}

static void do_harm(const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  if (strncmp(name, "hostile-", 8) != 0)
    return;
  name += 8;
  if (strncmp(name, "crash", 5) == 0)
    raise(SIGSEGV);
  else if (strncmp(name, "abort", 5) == 0)
    abort();
  else if (strncmp(name, "hang", 4) == 0)
    for (;;)
      pause();
  else if (strncmp(name, "flood", 5) == 0)
    flood();
  else if (strncmp(name, "memory", 6) == 0)
    take_all();
  else if (strncmp(name, "stray", 5) == 0)
    leave_stray();
  else if (strncmp(name, "bomb", 4) == 0)
    bomb();
  else if (strncmp(name, "kill", 4) == 0)
    raise(SIGKILL);
}

/** Meshes are opened by a system call that the C library has no function for. */
long syscall(long number, ...) {
  long words[6];
  va_list arguments;
  va_start(arguments, number);
  for (int w = 0; w < 6; w++)
    words[w] = va_arg(arguments, long);
  va_end(arguments);
  if (number == SYS_openat2 && !(((const struct open_how *)words[2])->flags & O_PATH))
    do_harm((const char *)words[1]);
  long (*next)(long, ...) = (long (*)(long, ...))dlsym(RTLD_NEXT, "syscall");
  return next(number, words[0], words[1], words[2], words[3], words[4], words[5]);
}
