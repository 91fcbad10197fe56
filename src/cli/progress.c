/* SPDX-License-Identifier: BSD-3-Clause */
/** Progress on standard error, and signals that cancel the work so that no half-made file is left. */
#include "cli/cli.h"

#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static volatile sig_atomic_t caught;

/** When the first signal came, in milliseconds and not 0; any thread may be the one that takes a signal. */
static atomic_llong caught_at;

/** A later signal ends the program at once, should the work not come to its next report. Signals that come
 * together (a terminal's and a parent's, for one) are one request, for which nothing is to be left behind. */
static void on_signal(int number) {
  enum { TOGETHER_MS = 500 };
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  long long now = 1 + 1000 * (long long)time.tv_sec + time.tv_nsec / 1000000, first = 0;
  if (atomic_compare_exchange_strong(&caught_at, &first, now))
    caught = number;
  else if (now - first >= TOGETHER_MS) {
    signal(number, SIG_DFL);
    raise(number);
  }
}

int cli_signal(void) {
  return caught;
}

void cli_set_signal(int number) {
  caught = number;
}

static void draw(cli_run *cli, double fraction) {
  enum { WIDTH = 30, REDRAW_MS = 100 };
  double now = cli_clock();
  if (cli->drawn > 0 && now - cli->drawn < REDRAW_MS)
    return;
  cli->drawn = now;
  if (fraction < 0 || fraction > 1)
    fraction = fraction < 0 ? 0 : 1;
  int filled = (int)(fraction * WIDTH);
  fprintf(stderr, "\r%-20s [", cli->phase);
  for (int i = 0; i < WIDTH; i++)
    fputc(i < filled ? '#' : ' ', stderr);
  fprintf(stderr, "] %3d %%\033[K", (int)(fraction * 100));
  fflush(stderr);
}

bool cli_progress(cli_run *cli, const char *phase, double fraction) {
  if (caught)
    return true;
  if (strcmp(cli->progress, "never") == 0)
    return false;
  bool terminal = isatty(STDERR_FILENO);
  bool begins = strncmp(cli->phase, phase, sizeof cli->phase - 1) != 0;
  if (begins)
    snprintf(cli->phase, sizeof cli->phase, "%s", phase);
  if (terminal)
    draw(cli, fraction);
  else if (begins) /* --progress always into a file: each phase once */
    fprintf(stderr, "voxmend: %s\n", cli->phase);
  return false;
}

static int on_progress(const char *phase, double fraction, void *payload) {
  return cli_progress(payload, phase, fraction);
}

void cli_progress_clear(cli_run *cli) {
  if (cli->drawn > 0)
    fprintf(stderr, "\r\033[K");
  cli->drawn = 0;
}

void cli_progress_init(cli_run *cli) {
  if (strcmp(cli->progress, "auto") == 0 && (cli->quiet || !isatty(STDERR_FILENO)))
    cli->progress = "never";
  cli->limits.progress = on_progress;
  cli->limits.payload = cli;
  struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART}, before;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  if (sigaction(SIGHUP, NULL, &before) == 0 &&
      before.sa_handler != SIG_IGN) /* else nohup has asked to go on */
    sigaction(SIGHUP, &action, NULL);
}
