/* SPDX-License-Identifier: BSD-3-Clause */
/** Reading in a process apart: whatever the library there does, ours lives on and says what happened. */
#include "foreign_test.h"

#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "meshio/apart.h"
#include "meshio/parcel.h"

static const vxm_module_need need = {"ill", "none", "reading .ill files"};

/** Reads what makes the module do something. */
static vxm_status ask(vxm_soup **soup, vxm_context *context, const char *data, size_t size,
                      vxm_error *error) {
  vxm_reader_request request = {.data = (const unsigned char *)data,
                                .size = size,
                                .name = "dir/a.ill",
                                .is_beside = true,
                                .hint = "ill",
                                .deflection = 0.125};
  *error = (vxm_error)VXM_ERROR_INIT;
  assert_int_equal(vxm_soup_create(soup, context, "ill", NULL), VXM_OK);
  vxm_status status = vxm_read_apart(*soup, &need, &request, error);
  assert_int_equal(status, status == VXM_OK ? VXM_OK : error->code);
  if (status == VXM_OK)
    check_invariants(*soup);
  else {
    assert_true(strlen(error->text) > 0);
    assert_null(strchr(error->text, '\n'));
    vxm_soup_destroy(*soup);
    *soup = NULL;
  }
  /* Nobody is left behind. */
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
  assert_int_equal(errno, ECHILD);
  return status;
}

static void fails(const char *word, vxm_status expected, const char *part) {
  vxm_soup *soup;
  vxm_error error;
  vxm_status status = ask(&soup, NULL, word, strlen(word), &error);
  if (status != expected || !strstr(error.text, part))
    fail_msg("%s: status %d, \"%s\"; expected \"%s\"", word, status, error.text, part);
}

static void test_soup(void **state) {
  (void)state;
  static const size_t sizes[] = {1, 2, 1000, 3000000};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    char *data = calloc(sizes[i], 1);
    vxm_soup *soup;
    vxm_error error;
    if (ask(&soup, NULL, data, sizes[i], &error) != VXM_OK)
      fail_msg("%s", error.text);
    expect_counts(soup, sizes[i] + 2, sizes[i]);
    expect_vertex(soup, sizes[i], (double)sizes[i], (double)(sizes[i] % 2), 0.5);
    assert_int_equal(soup->tag_count, 2);
    assert_string_equal(soup->tags[0], "first");
    assert_string_equal(soup->tags[1], "");
    for (size_t f = 0; f < sizes[i]; f++)
      assert_int_equal(soup->face_tags[f], f % 2);
    assert_int_equal(soup->notes.count, 1);
    assert_string_equal(soup->notes.text[0], "a note?of two lines"); /* notes keep to one line */
    vxm_soup_destroy(soup);
    free(data);
  }
}

static void test_failures(void **state) {
  (void)state;
  fails("fail", VXM_ERROR_FORMAT, "dir/a.ill:7: as the file wants");
  fails("hint", VXM_ERROR_RANGE, "dir/a.ill 1 ill 0.125");
  fails("crash", VXM_ERROR_FORMAT, "dir/a.ill: the library that reads .ill files crashed (signal 11)");
  fails("abort", VXM_ERROR_FORMAT, "crashed (signal 6)");
  fails("quit", VXM_ERROR_UNAVAILABLE, "ended without an answer (status 9)");
  fails("rubbish", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  fails("huge", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  fails("lies", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  vxm_soup *soup;
  vxm_error error;
  assert_int_equal(ask(&soup, NULL, "print", 5, &error), VXM_OK);
  expect_counts(soup, 7, 5);
  vxm_soup_destroy(soup);
}

static void test_missing(void **state) {
  (void)state;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  vxm_module_need other = {"nosuch", "libnosuch-dev", "reading .nosuch files"};
  vxm_reader_request request = {.name = "a", .hint = "nosuch"};
  assert_int_equal(vxm_soup_create(&soup, NULL, "", NULL), VXM_OK);
  assert_int_equal(vxm_read_apart(soup, &other, &request, &error), VXM_ERROR_UNAVAILABLE);
  assert_non_null(strstr(error.text, "reading .nosuch files needs voxmend's module \"nosuch\""));
  assert_non_null(strstr(error.text, "libnosuch-dev"));
  vxm_soup_destroy(soup);
}

static void test_memory(void **state) {
  (void)state;
  if (SANITIZED) /* which does not give memory back as the system does */
    skip();
  fails("take", VXM_ERROR_MEMORY_LIMIT, "dir/a.ill: reading takes more than 512 MiB");
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = 64 << 20;
  vxm_context *context;
  vxm_soup *soup;
  vxm_error error;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  assert_int_equal(ask(&soup, context, "take", 4, &error), VXM_ERROR_MEMORY_LIMIT);
  assert_non_null(strstr(error.text, "more than 32 MiB"));
  /* Our side keeps the limit too: this soup takes 5 MB there and as much here. */
  static char data[100000];
  for (uint64_t limit = 1 << 20; limit < 32 << 20; limit += 1 << 20) {
    vxm_context *small;
    options.memory_limit = limit;
    assert_int_equal(vxm_context_create(&small, &options, NULL), VXM_OK);
    vxm_status status = ask(&soup, small, data, sizeof data, &error);
    assert_true(vxm_context_peak_bytes(small) <= limit);
    if (status == VXM_OK)
      vxm_soup_destroy(soup);
    else
      assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
    assert_true(status == VXM_OK ? limit > 4 << 20 : limit < 24 << 20);
    vxm_context_destroy(small);
  }
  vxm_context_destroy(context);
}

typedef struct telling {
  int calls_left;
  double last;
} telling;

static int stop_later(const char *phase, double fraction, void *payload) {
  telling *told = payload;
  assert_string_equal(phase, "reading");
  told->last = fraction;
  return --told->calls_left < 0;
}

static void test_cancel(void **state) {
  (void)state;
  static const char *const words[] = {"wait", "spin"};
  for (size_t w = 0; w < 2; w++)
    for (int calls = 0; calls < 4; calls += 3) {
      telling told = {calls, 0};
      vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
      options.progress = stop_later;
      options.payload = &told;
      vxm_context *context;
      vxm_soup *soup;
      vxm_error error;
      assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
      double start = vxm_clock_ms();
      assert_int_equal(ask(&soup, context, words[w], 4, &error), VXM_ERROR_CANCELLED);
      assert_true(vxm_clock_ms() - start < 5000);
      assert_int_equal(told.calls_left, -1);
      if (calls > 0 && w == 0) /* the other side's fraction arrives */
        assert_true(told.last == 0.25 || told.last == 0.5);
      vxm_context_destroy(context);
    }
}

/** A reader that computes for ever ends by itself: its time is limited. */
static void test_time(void **state) {
  (void)state;
  char module[VXM_MODULE_PATH_MAX], program[VXM_MODULE_PATH_MAX + 32], deflection[] = "0x1p-10", one[] = "1";
  assert_int_equal(vxm_module_find(module, &need, NULL), VXM_OK);
  snprintf(program, sizeof program, "%s/voxmend-reader", getenv("BUILDDIR"));
  char name[] = "voxmend-reader", memory[] = "100000000";
  char *const arguments[VXM_APART_ARGUMENTS + 1] = {name,       module, name, one, one,
                                                    deflection, memory, one,  NULL};
  vxm_context *context;
  vxm_process reader;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_soup_create(&soup, NULL, "", NULL), VXM_OK);
  context = soup->context;
  assert_int_equal(vxm_process_start(&reader, context, "reading", program, arguments, &error), VXM_OK);
  assert_int_equal(vxm_process_send(&reader, "spin", 4, &error), VXM_OK);
  vxm_process_sent(&reader);
  assert_int_equal(vxm_parcel_receive(soup, &reader, &error), VXM_ERROR_IO);
  int end = vxm_process_end(&reader);
  assert_true(WIFSIGNALED(end) && WTERMSIG(end) == SIGXCPU);
  vxm_soup_destroy(soup);
}

static void test_no_program(void **state) {
  (void)state;
  vxm_process reader;
  vxm_context *context;
  vxm_error error = VXM_ERROR_INIT;
  char name[] = "x", *const arguments[] = {name, NULL};
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_process_start(&reader, context, "reading", "/no/such/program", arguments, &error),
                   VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "/no/such/program: cannot start"));
  vxm_context_destroy(context);
}

/** A caller that ignores the end of its children gets its soups and messages all the same. */
static void test_ignored_children(void **state) {
  (void)state;
  void (*before)(int) = signal(SIGCHLD, SIG_IGN);
  vxm_soup *soup;
  vxm_error error;
  assert_int_equal(ask(&soup, NULL, "any", 3, &error), VXM_OK);
  vxm_soup_destroy(soup);
  fails("fail", VXM_ERROR_FORMAT, "as the file wants");
  assert_int_not_equal(ask(&soup, NULL, "abort", 5, &error), VXM_OK);
  signal(SIGCHLD, before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_soup),       cmocka_unit_test(test_failures),
      cmocka_unit_test(test_missing),    cmocka_unit_test(test_memory),
      cmocka_unit_test(test_cancel),     cmocka_unit_test(test_time),
      cmocka_unit_test(test_no_program), cmocka_unit_test(test_ignored_children)};
  leave_signals_alone();
  alarm(100);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
