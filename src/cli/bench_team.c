/* SPDX-License-Identifier: BSD-3-Clause */
/** Filling memory by several threads: the least that writing a grid can take. */
#include "cli/bench.h"

#include <inttypes.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* A smaller share is filled before another thread has woken up to do it: fewer threads are faster then. */
enum { SHARE_LEAST = 4 << 20, LARGE_BLOCK = 4 << 20, LARGE_PAGE = 2 << 20, LINE = 64 };

typedef struct bench_worker {
  bench_team *team;
  pthread_t thread;
  sem_t start;
  size_t begin, end; /**< its share */
} bench_worker;

struct bench_team {
  unsigned char *block;
  int value; /**< to fill with; another one each time, as processors may skip stores that change nothing */
  bool quit;
  sem_t done;
  int count; /**< the first is the caller */
  bench_worker workers[];
};

static void wait_for(sem_t *semaphore) {
  while (sem_wait(semaphore) != 0)
    continue; /* only a signal ends it early */
}

static void fill_share(const bench_worker *worker) {
  const bench_team *team = worker->team;
  memset(team->block + worker->begin, team->value, worker->end - worker->begin);
}

static void *work(void *payload) {
  bench_worker *worker = payload;
  for (;;) {
    wait_for(&worker->start);
    if (worker->team->quit)
      return NULL;
    fill_share(worker);
    sem_post(&worker->team->done);
  }
}

void bench_team_fill(bench_team *team) {
  team->value = (team->value + 1) & 0xff;
  for (int i = 1; i < team->count; i++)
    sem_post(&team->workers[i].start);
  fill_share(&team->workers[0]);
  for (int i = 1; i < team->count; i++)
    wait_for(&team->done);
}

void bench_team_destroy(bench_team *team) {
  if (!team)
    return;
  team->quit = true;
  for (int i = 1; i < team->count; i++) {
    sem_post(&team->workers[i].start);
    pthread_join(team->workers[i].thread, NULL);
    sem_destroy(&team->workers[i].start);
  }
  sem_destroy(&team->done);
  free(team->block);
  free(team);
}

static vxm_status fail(cli_run *cli, vxm_status code, uint64_t bytes, const char *why) {
  char size[24];
  cli->error.code = code;
  snprintf(cli->error.text, sizeof cli->error.text, "memset of %s: %s", cli_bytes_text(size, bytes), why);
  return code;
}

/** With large pages where the system grants them, as for the library's grids. */
static unsigned char *make_block(size_t bytes) {
  void *block = NULL;
  if (posix_memalign(&block, bytes >= LARGE_BLOCK ? LARGE_PAGE : LINE, bytes) != 0)
    return NULL;
#ifdef MADV_HUGEPAGE
  if (bytes >= LARGE_BLOCK)
    (void)madvise(block, bytes, MADV_HUGEPAGE);
#endif
  return block;
}

/** Starts the threads beside the caller, as many as the system lets it have, and deals out the shares. */
static void start_workers(bench_team *team, size_t bytes, int wanted) {
  for (team->count = 1; team->count < wanted; team->count++) {
    bench_worker *worker = &team->workers[team->count];
    worker->team = team;
    sem_init(&worker->start, 0, 0);
    if (pthread_create(&worker->thread, NULL, work, worker) == 0)
      continue;
    sem_destroy(&worker->start);
    break;
  }
  size_t count = (size_t)team->count, share = (bytes / count + LINE - 1) / LINE * LINE, begin = 0;
  for (size_t i = 0; i < count; i++, begin += share) {
    team->workers[i].begin = begin < bytes ? begin : bytes;
    team->workers[i].end = i + 1 < count && begin + share < bytes ? begin + share : bytes;
  }
}

vxm_status bench_team_create(bench_team **out, cli_run *cli, uint64_t bytes, int threads) {
  *out = NULL;
  if (cli->limits.memory_limit > 0 && bytes > cli->limits.memory_limit)
    return fail(cli, VXM_ERROR_MEMORY_LIMIT, bytes,
                "beyond the memory limit; raise it (--memlimit) or lower the resolution (-r)");
  uint64_t shares = bytes / SHARE_LEAST;
  int wanted = shares < (uint64_t)threads ? (int)(shares > 0 ? shares : 1) : threads;
  bench_team *team = calloc(1, sizeof *team + (size_t)wanted * sizeof team->workers[0]);
  if (!team)
    return fail(cli, VXM_ERROR_MEMORY, bytes, "out of memory; lower the resolution or free some memory");
  team->block = make_block(bytes);
  if (!team->block) {
    free(team);
    return fail(cli, VXM_ERROR_MEMORY, bytes, "out of memory; lower the resolution or free some memory");
  }
  sem_init(&team->done, 0, 0);
  team->workers[0].team = team;
  start_workers(team, bytes, wanted);
  *out = team;
  return VXM_OK;
}
