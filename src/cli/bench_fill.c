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
  bench_fill *fill;
  pthread_t thread;
  sem_t start;
  size_t begin, end; /**< its share */
} bench_worker;

struct bench_fill {
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
  const bench_fill *fill = worker->fill;
  memset(fill->block + worker->begin, fill->value, worker->end - worker->begin);
}

static void *work(void *payload) {
  bench_worker *worker = payload;
  for (;;) {
    wait_for(&worker->start);
    if (worker->fill->quit)
      return NULL;
    fill_share(worker);
    sem_post(&worker->fill->done);
  }
}

void bench_fill_run(bench_fill *fill) {
  fill->value = (fill->value + 1) & 0xff;
  for (int i = 1; i < fill->count; i++)
    sem_post(&fill->workers[i].start);
  fill_share(&fill->workers[0]);
  for (int i = 1; i < fill->count; i++)
    wait_for(&fill->done);
}

void bench_fill_destroy(bench_fill *fill) {
  if (!fill)
    return;
  fill->quit = true;
  for (int i = 1; i < fill->count; i++) {
    sem_post(&fill->workers[i].start);
    pthread_join(fill->workers[i].thread, NULL);
    sem_destroy(&fill->workers[i].start);
  }
  sem_destroy(&fill->done);
  free(fill->block);
  free(fill);
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
static void start_workers(bench_fill *fill, size_t bytes, int wanted) {
  for (fill->count = 1; fill->count < wanted; fill->count++) {
    bench_worker *worker = &fill->workers[fill->count];
    worker->fill = fill;
    sem_init(&worker->start, 0, 0);
    if (pthread_create(&worker->thread, NULL, work, worker) == 0)
      continue;
    sem_destroy(&worker->start);
    break;
  }
  size_t count = (size_t)fill->count, share = (bytes / count + LINE - 1) / LINE * LINE, begin = 0;
  for (size_t i = 0; i < count; i++, begin += share) {
    fill->workers[i].begin = begin < bytes ? begin : bytes;
    fill->workers[i].end = i + 1 < count && begin + share < bytes ? begin + share : bytes;
  }
}

vxm_status bench_fill_create(bench_fill **out, cli_run *cli, uint64_t bytes, int threads) {
  *out = NULL;
  if (cli->limits.memory_limit > 0 && bytes > cli->limits.memory_limit)
    return fail(cli, VXM_ERROR_MEMORY_LIMIT, bytes,
                "beyond the memory limit; raise it (--memlimit) or lower the resolution (-r)");
  uint64_t shares = bytes / SHARE_LEAST;
  int wanted = shares < (uint64_t)threads ? (int)(shares > 0 ? shares : 1) : threads;
  bench_fill *fill = calloc(1, sizeof *fill + (size_t)wanted * sizeof fill->workers[0]);
  if (!fill)
    return fail(cli, VXM_ERROR_MEMORY, bytes, "out of memory; lower the resolution or free some memory");
  fill->block = make_block(bytes);
  if (!fill->block) {
    free(fill);
    return fail(cli, VXM_ERROR_MEMORY, bytes, "out of memory; lower the resolution or free some memory");
  }
  sem_init(&fill->done, 0, 0);
  fill->workers[0].fill = fill;
  start_workers(fill, bytes, wanted);
  *out = fill;
  return VXM_OK;
}
