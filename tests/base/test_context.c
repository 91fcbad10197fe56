/* SPDX-License-Identifier: BSD-3-Clause */
/** Contexts: memory under a limit, parallel loops, progress. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "base/bits.h"
#include "base/context.h"
#include "base/context_struct.h"
#include "base/rng.h"
#include "base/threads.h"

#include <stdatomic.h>

static vxm_context *new_context(int threads, uint64_t limit) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = limit;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  return context;
}

/* ---- Asking whether to go on ---- */

typedef struct asking {
  int calls, stop_at;
  double fraction;
  char phase[32];
} asking;

static int answer(const char *phase, double fraction, void *payload) {
  asking *a = payload;
  a->fraction = fraction;
  strncpy(a->phase, phase, sizeof a->phase - 1);
  return ++a->calls >= a->stop_at;
}

static vxm_context *asking_context(int threads, asking *a) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.progress = answer;
  options.payload = a;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  return context;
}

static void questions_repeat_what_was_told(void **state) {
  (void)state;
  asking a = {.stop_at = 4};
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = asking_context(1, &a);
  assert_int_equal(vxm_progress(context, "weighing", 0.25, &error), VXM_OK);
  for (int i = 0; i < 1000; i++) /* too soon after it */
    assert_int_equal(vxm_check_cancelled(context, &error), VXM_OK);
  assert_true(a.calls < 4);
  context->ask_ms = 0;
  a.calls = 1;
  assert_int_equal(vxm_check_cancelled(context, &error), VXM_OK);
  assert_int_equal(vxm_check_cancelled_at(VXM_CANCEL_STEPS - 1, context, &error), VXM_OK);
  assert_int_equal(a.calls, 2);
  assert_string_equal(a.phase, "weighing");
  assert_true(a.fraction == 0.25);
  assert_int_equal(vxm_check_cancelled_at(VXM_CANCEL_STEPS, context, &error), VXM_OK);
  assert_int_equal(vxm_check_cancelled(context, &error), VXM_ERROR_CANCELLED);
  assert_string_equal(error.text, "cancelled while weighing");
  vxm_context_destroy(context);
}

typedef struct counted {
  atomic_size_t done;
  vxm_context *asks;
  bool inside; /**< tasks ask too, until they are told to stop */
  bool slow;
} counted;

static void count_task(size_t task, int worker, void *payload) {
  (void)task, (void)worker;
  counted *c = payload;
  while (c->inside && vxm_check_cancelled(c->asks, NULL) == VXM_OK)
    ;
  if (c->slow) /* so that the thread that asks gets its turns before all is done, whatever else the machine
                  does */
    nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
  atomic_fetch_add(&c->done, 1);
}

static void loops_end_when_told_to(void **state) {
  (void)state;
  enum { TASKS = 5000 };
  for (int threads = 1; threads <= 3; threads++)
    for (int inside = 0; inside < 2; inside++) {
      asking a = {.stop_at = 20};
      vxm_error error = VXM_ERROR_INIT;
      vxm_context *context = asking_context(threads, &a), *child;
      context->ask_ms = 0;
      assert_int_equal(vxm_context_child(&child, context, true, &error), VXM_OK);
      counted c = {.asks = child, .inside = inside, .slow = !inside}; /* a child asks as its parent does */
      assert_int_equal(vxm_parallel_cancellable(context, TASKS, count_task, &c, &error), VXM_ERROR_CANCELLED);
      assert_true(atomic_load(&c.done) < TASKS);
      a.stop_at = INT32_MAX; /* which the next loop knows nothing of */
      c = (counted){.asks = child};
      assert_int_equal(vxm_parallel_cancellable(context, TASKS, count_task, &c, &error), VXM_OK);
      assert_int_equal(atomic_load(&c.done), TASKS);
      vxm_context_destroy(child);
      vxm_context_destroy(context);
    }
}

/* ---- Memory ---- */

static void assert_aligned(const void *block) {
  assert_int_equal((uintptr_t)block % 64, 0);
}

static void limit_is_kept(void **state) {
  (void)state;
  enum { LIMIT = 1 << 20 };
  vxm_context *context = new_context(1, LIMIT);
  vxm_error error = VXM_ERROR_INIT;
  assert_null(vxm_alloc(context, LIMIT, 1, &error));
  assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
  assert_true(strlen(error.text) > 10);
  /* an error is not asked for */
  assert_null(vxm_alloc(context, LIMIT, 2, NULL));

  void *blocks[64];
  size_t count = 0;
  while (count < 64 && (blocks[count] = vxm_alloc(context, 100, 1000, &error)))
    assert_aligned(blocks[count++]);
  assert_int_equal(count, LIMIT / 100000);
  assert_true(vxm_context_peak_bytes(context) <= LIMIT);
  assert_true(vxm_context_peak_bytes(context) >= count * 100000);
  size_t left = vxm_memory_left(context);
  assert_true(left < 100000);
  assert_int_equal(vxm_memory_check(context, left, "this", &error), VXM_OK);
  assert_int_equal(vxm_memory_check(context, left + 1, "this", &error), VXM_ERROR_MEMORY_LIMIT);
  assert_non_null(strstr(error.text, "this needs"));
  /* a block that cannot grow stays as it was */
  memset(blocks[0], 7, 100000);
  assert_null(vxm_realloc(context, blocks[0], 900000, 1, &error));
  assert_int_equal(((unsigned char *)blocks[0])[99999], 7);
  while (count > 0)
    vxm_free(context, blocks[--count]);
  assert_int_equal(vxm_memory_left(context), LIMIT);
  vxm_free(context, NULL);
  /* what a library takes counts as well */
  assert_int_equal(vxm_memory_take(context, LIMIT + 1, &error), VXM_ERROR_MEMORY_LIMIT);
  assert_int_equal(vxm_memory_left(context), LIMIT);
  assert_int_equal(vxm_memory_take(context, LIMIT, &error), VXM_OK);
  assert_int_equal(vxm_memory_left(context), 0);
  assert_null(vxm_alloc(context, 1, 1, &error));
  vxm_memory_give(context, LIMIT);
  assert_int_equal(vxm_memory_left(context), LIMIT);
  vxm_context_destroy(context);

  context = new_context(1, 0);
  assert_true(vxm_memory_left(context) == SIZE_MAX);
  assert_null(vxm_alloc(context, SIZE_MAX / 2, 3, &error));
  assert_int_equal(error.code, VXM_ERROR_RANGE);
  vxm_context_destroy(context);
}

static void blocks_keep_content_and_alignment(void **state) {
  (void)state;
  vxm_context *context = new_context(1, 0);
  vxm_rng rng = {3};
  for (int round = 0; round < 50; round++) {
    size_t size = (size_t)vxm_rng_below(&rng, 3000);
    unsigned char *block = round % 2 ? vxm_calloc(context, size, 1, NULL) : vxm_alloc(context, size, 1, NULL);
    assert_non_null(block);
    assert_aligned(block);
    for (size_t i = 0; i < size; i++) {
      assert_true(round % 2 == 0 || block[i] == 0);
      block[i] = (unsigned char)(i * 31 + 5);
    }
    for (int step = 0; step < 20; step++) {
      size_t now = (size_t)vxm_rng_below(&rng, step % 4 ? 5000 : 400000), kept = now < size ? now : size;
      block = vxm_realloc(context, block, now, 1, NULL);
      assert_non_null(block);
      assert_aligned(block);
      for (size_t i = 0; i < kept; i++)
        assert_int_equal(block[i], (unsigned char)(i * 31 + 5));
      for (size_t i = kept; i < now; i++)
        block[i] = (unsigned char)(i * 31 + 5);
      size = now;
    }
    vxm_free(context, block);
  }
  uint32_t *array = NULL;
  size_t capacity = 0;
  for (uint32_t i = 0; i < 10000; i++) {
    assert_int_equal(vxm_grow(context, (void **)&array, &capacity, i + 1, sizeof *array, NULL), VXM_OK);
    assert_true(capacity > i && capacity <= 2 * (size_t)i + 16);
    array[i] = i;
  }
  for (uint32_t i = 0; i < 10000; i++)
    assert_int_equal(array[i], i);
  vxm_free(context, array);
  vxm_context_destroy(context);
}

static void references_keep_a_context(void **state) {
  (void)state;
  vxm_context *context = new_context(2, 0), *same, *fresh;
  assert_int_equal(vxm_context_acquire(&same, context, NULL), VXM_OK);
  assert_ptr_equal(same, context);
  vxm_context_destroy(context);
  void *block = vxm_alloc(same, 10, 10, NULL);
  assert_non_null(block);
  vxm_free(same, block);
  vxm_context_release(same);
  assert_int_equal(vxm_context_acquire(&fresh, NULL, NULL), VXM_OK);
  assert_true(vxm_context_threads(fresh) >= 1);
  vxm_context_release(fresh);
  vxm_context_destroy(NULL);
}

static void bad_options(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  vxm_context *context;
  vxm_error error = VXM_ERROR_INIT;
  options.size = 2;
  assert_int_equal(vxm_context_create(&context, &options, &error), VXM_ERROR_ARGUMENT);
  assert_null(context);
  options.size = sizeof options;
  options.threads = -1;
  assert_int_equal(vxm_context_create(&context, &options, &error), VXM_ERROR_ARGUMENT);
  options.threads = 100000;
  assert_int_equal(vxm_context_create(&context, &options, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_context_create(NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
}

/** Work that is done again and again takes the blocks it had. */
static void children_keep_what_is_freed(void **state) {
  (void)state;
  vxm_context *parent = new_context(2, 1 << 20), *child;
  for (int alone = 0; alone < 2; alone++) {
    assert_int_equal(vxm_context_child(&child, parent, alone, NULL), VXM_OK);
    assert_int_equal(vxm_context_threads(child), alone ? 1 : 2);
    unsigned char *large = vxm_alloc(child, 300000, 1, NULL), *small = vxm_alloc(child, 1000, 1, NULL);
    assert_true(large && small);
    memset(large, 255, 300000);
    memset(small, 255, 1000);
    size_t left = vxm_memory_left(parent);
    vxm_free(child, large);
    vxm_free(child, small);
    assert_int_equal(vxm_memory_left(parent), left); /* which counts as in use */
    /* the least block that is large enough, and zero where that is asked for */
    unsigned char *again = vxm_calloc(child, 250, 4, NULL);
    assert_ptr_equal(again, small);
    for (int i = 0; i < 1000; i++)
      assert_int_equal(again[i], 0);
    assert_ptr_equal(vxm_realloc(child, again, 900, 1, NULL), small);
    again[899] = 77;
    again = vxm_realloc(child, again, 200000, 1, NULL);
    assert_ptr_equal(again, large);
    assert_int_equal(again[899], 77);
    /* what is kept gives way before a limit is in the way */
    vxm_free(child, again);
    void *most = vxm_alloc(child, 900000, 1, NULL);
    assert_non_null(most);
    assert_null(vxm_alloc(child, 900000, 1, NULL));
    vxm_free(child, most);
    vxm_context_release(child);
    assert_int_equal(vxm_memory_left(parent), 1 << 20); /* and nothing is kept for ever */
  }
  vxm_context_destroy(parent);
}

/* ---- Parallel loops ---- */

enum { TASKS = 500, INNER = 40 };

typedef struct loops {
  vxm_context *context;
  int threads;
  atomic_int runs[TASKS];
  atomic_int inner_runs[TASKS];
  atomic_bool busy[256];
  atomic_bool wrong_worker; /**< tests may fail in the main thread only */
} loops;

static void inner_task(size_t task, int worker, void *payload) {
  (void)task;
  (void)worker;
  atomic_fetch_add((atomic_int *)payload, 1);
}

static void outer_task(size_t task, int worker, void *payload) {
  loops *l = payload;
  if (worker < 0 || worker >= l->threads || atomic_exchange(&l->busy[worker], true))
    atomic_store(&l->wrong_worker, true);
  atomic_fetch_add(&l->runs[task], 1);
  if (task % 7 == 0)
    vxm_parallel(l->context, INNER, inner_task, &l->inner_runs[task]);
  atomic_store(&l->busy[worker], false);
}

static void every_task_runs_once(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7, 16};
  for (size_t i = 0; i < sizeof threads / sizeof *threads; i++)
    for (size_t count = 0; count <= TASKS; count = count * 3 + 1) {
      static loops l;
      memset(&l, 0, sizeof l);
      l.context = new_context(threads[i], 0);
      l.threads = threads[i];
      for (int round = 1; round <= 3; round++)
        vxm_parallel(l.context, count, outer_task, &l);
      for (size_t task = 0; task < TASKS; task++) {
        assert_int_equal(l.runs[task], task < count ? 3 : 0);
        assert_int_equal(l.inner_runs[task], task < count && task % 7 == 0 ? 3 * INNER : 0);
      }
      assert_false(l.wrong_worker);
      vxm_context_destroy(l.context);
    }
}

static void slices_cover(void **state) {
  (void)state;
  for (size_t total = 0; total < 40; total++)
    for (size_t slices = 1; slices < 12; slices++) {
      assert_int_equal(vxm_slice_begin(total, slices, 0), 0);
      assert_int_equal(vxm_slice_begin(total, slices, slices), total);
      for (size_t s = 0; s < slices; s++) {
        size_t size = vxm_slice_begin(total, slices, s + 1) - vxm_slice_begin(total, slices, s);
        assert_true(size == total / slices || size == total / slices + 1);
      }
    }
}

/* ---- Progress ---- */

static int stop_at_half(const char *phase, double fraction, void *payload) {
  assert_string_equal(phase, "counting");
  ++*(int *)payload;
  return fraction >= 0.5;
}

static void progress_cancels(void **state) {
  (void)state;
  int calls = 0;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = stop_at_half;
  options.payload = &calls;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_progress(context, "counting", 0.25, &error), VXM_OK);
  assert_int_equal(vxm_progress(context, "counting", 0.75, &error), VXM_ERROR_CANCELLED);
  assert_int_equal(error.code, VXM_ERROR_CANCELLED);
  assert_int_equal(calls, 2);
  vxm_context_destroy(context);
}

static int note(const char *phase, double fraction, void *payload) {
  (void)phase;
  *(double *)payload = fraction;
  return 0;
}

static void progress_has_parts(void **state) {
  (void)state;
  double told = -1;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = note;
  options.payload = &told;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  vxm_progress_part whole = vxm_progress_enter(0.5, 1);
  assert_int_equal(vxm_progress(context, "counting", 0, NULL), VXM_OK);
  assert_true(told == 0.5);
  vxm_progress_part half = vxm_progress_enter(0.5, 0.75);
  assert_int_equal(vxm_progress(context, "counting", 1, NULL), VXM_OK);
  assert_true(told == 0.875);
  vxm_progress_leave(half);
  assert_int_equal(vxm_progress(context, "counting", 0.5, NULL), VXM_OK);
  assert_true(told == 0.75);
  vxm_progress_leave(whole);
  assert_int_equal(vxm_progress(context, "counting", 0.5, NULL), VXM_OK);
  assert_true(told == 0.5);
  vxm_context_destroy(context);
}

/* ---- Bits ---- */

static void bits(void **state) {
  (void)state;
  vxm_rng rng = {11};
  for (int round = 0; round < 1000; round++) {
    uint64_t word = vxm_rng_next(&rng), prefix = 0, parity = 0;
    for (unsigned i = 0; i < 64; i++) {
      parity ^= word >> i & 1;
      prefix |= parity << i;
    }
    assert_true(vxm_prefix_xor(word) == prefix);
    assert_int_equal(vxm_popcount(word), __builtin_popcountll(word));
    uint64_t turned = vxm_transpose8(word);
    for (unsigned i = 0; i < 64; i++)
      assert_int_equal(turned >> i & 1, word >> (8 * (i % 8) + i / 8) & 1);
    double unit = vxm_rng_unit(&rng);
    assert_true(unit >= 0 && unit < 1);
  }
  assert_true(vxm_low_bits(0) == 0 && vxm_low_bits(1) == 1 && vxm_low_bits(64) == UINT64_MAX);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(questions_repeat_what_was_told),
      cmocka_unit_test(loops_end_when_told_to),
      cmocka_unit_test(limit_is_kept),
      cmocka_unit_test(blocks_keep_content_and_alignment),
      cmocka_unit_test(references_keep_a_context),
      cmocka_unit_test(bad_options),
      cmocka_unit_test(children_keep_what_is_freed),
      cmocka_unit_test(every_task_runs_once),
      cmocka_unit_test(slices_cover),
      cmocka_unit_test(progress_cancels),
      cmocka_unit_test(progress_has_parts),
      cmocka_unit_test(bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
