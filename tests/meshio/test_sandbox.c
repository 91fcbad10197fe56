/* SPDX-License-Identifier: BSD-3-Clause */
/** Reading in a process apart: whatever the library there does, ours lives on and says what happened. */
#include "external_test.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/open_beneath.h"
#include "config.h"
#include "sandbox/reader_process.h"
#include "sandbox/wire_format.h"
#include "sandbox/wire_message.h"

static const vxm_module_need need = {"ill", "none", "reading .ill files"};

/** What the next mesh may refer to. */
static vxm_references references = VXM_REFERENCES_NONE;

/** Reads what makes the module do something. */
static vxm_status ask(vxm_soup **soup, vxm_context *context, const char *data, size_t size,
                      vxm_error *error) {
  vxm_reader_request request = {.data = (const unsigned char *)data,
                                .size = size,
                                .name = "dir/a.ill",
                                .hint = "ill",
                                .deflection = 0.125};
  *error = (vxm_error)VXM_ERROR_INIT;
  assert_int_equal(vxm_soup_create(soup, context, "ill", NULL), VXM_OK);
  vxm_status status = vxm_reader_process_mesh(*soup, &need, &request, &references, error);
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
  vxm_error error = VXM_ERROR_INIT;
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
    vxm_error error = VXM_ERROR_INIT;
    if (ask(&soup, NULL, data, sizes[i], &error) != VXM_OK)
      fail_msg("%s", error.text);
    expect_counts(soup, sizes[i] + 2, sizes[i]);
    expect_vertex(soup, sizes[i], (double)sizes[i], (double)(sizes[i] % 2), 0.5);
    assert_int_equal(soup->tag_count, 2);
    assert_string_equal(soup->tags[0], "first");
    assert_string_equal(soup->tags[1], "");
    for (size_t f = 0; f < sizes[i]; f++)
      assert_int_equal(soup->face_tags[f], f % 2);
    assert_int_equal(soup->warnings.count, 1);
    assert_string_equal(soup->warnings.text[0], "a warning?of two lines"); /* warnings keep to one line */
    vxm_soup_destroy(soup);
    free(data);
  }
}

static void test_failures(void **state) {
  (void)state;
  fails("fail", VXM_ERROR_FORMAT, "dir/a.ill:7: as the file wants");
  fails("hint", VXM_ERROR_RANGE, "dir/a.ill ill 0.125");
  fails("crash", VXM_ERROR_FORMAT, "dir/a.ill: the library that reads .ill files crashed (signal 11)");
  fails("abort", VXM_ERROR_FORMAT, "crashed (signal 6)");
  fails("quit", VXM_ERROR_UNAVAILABLE, "ended without an answer (status 9)");
  fails("rubbish", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  fails("huge", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  fails("lies", VXM_ERROR_FORMAT, "what the reading process sent is damaged");
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(ask(&soup, NULL, "print", 5, &error), VXM_OK);
  expect_counts(soup, 7, 5);
  vxm_soup_destroy(soup);
}

static void test_sanitize(void **state) {
  (void)state;
  char text[] = {'a', '\t', '\x7f', 'b', '\xc3', '\xa4', 'c'};
  vxm_message_sanitize(text, sizeof text);
  assert_string_equal(text, "a??b\xc3\xa4");
}

static void test_missing(void **state) {
  (void)state;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  vxm_module_need other = {"nosuch", "libnosuch-dev", "reading .nosuch files"};
  vxm_reader_request request = {.name = "a", .hint = "nosuch"};
  assert_int_equal(vxm_soup_create(&soup, NULL, "", NULL), VXM_OK);
  assert_int_equal(vxm_reader_process_mesh(soup, &other, &request, &references, &error),
                   VXM_ERROR_UNAVAILABLE);
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
  vxm_error error = VXM_ERROR_INIT;
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

/** Libraries that do without memory leave something out, and others crash: both are for want of memory. */
static void test_swallowed_failures(void **state) {
  (void)state;
  static const char *const words[] = {"without m", "without c", "without r",
                                      "without a", "without p", "choke m"};
#if !defined(__GLIBC__) || defined(__SANITIZE_THREAD__)
  skip();
#endif
  if (SANITIZED)
    skip();
  for (size_t w = 0; w < sizeof words / sizeof *words; w++)
    fails(words[w], VXM_ERROR_MEMORY_LIMIT, "dir/a.ill: reading takes more than 512 MiB");
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(ask(&soup, NULL, "odd", 3, &error), VXM_OK);
  vxm_soup_destroy(soup);
}

typedef struct progress_log {
  int calls_left;
  double last;
} progress_log;

static int stop_later(const char *phase, double fraction, void *payload) {
  progress_log *told = payload;
  assert_string_equal(phase, "reading");
  told->last = fraction;
  return --told->calls_left < 0;
}

static void test_cancel(void **state) {
  (void)state;
  static const char *const words[] = {"wait", "spin"};
  for (size_t w = 0; w < 2; w++)
    for (int calls = 0; calls < 4; calls += 3) {
      progress_log told = {calls, 0};
      vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
      options.progress = stop_later;
      options.payload = &told;
      vxm_context *context;
      vxm_soup *soup;
      vxm_error error = VXM_ERROR_INIT;
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

/** A reader that computes, or waits, for ever: by itself at its limit, or by ours on the clock. */
static int run_long(const char *word, const char *seconds, double limit_ms, bool *is_late) {
  char module[VXM_MODULE_PATH_MAX], program[VXM_MODULE_PATH_MAX + 32], parent[24];
  assert_int_equal(vxm_module_find(module, &need, NULL), VXM_OK);
  snprintf(program, sizeof program, "%s/voxmend-reader", getenv("BUILDDIR"));
  snprintf(parent, sizeof parent, "%ld", (long)getpid());
  const char *arguments[VXM_READER_ARGS + 1] = {"voxmend-reader", module, parent,      "name",      "ill",
                                                "0x1p-10",        "0",    "100000000", "100000000", seconds};
  vxm_process reader;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_soup_create(&soup, NULL, "", NULL), VXM_OK);
  vxm_wire_listener listener = {.soup = soup};
  assert_int_equal(vxm_process_start(&reader, soup->context, "reading", program,
                                     (char *const *)(uintptr_t)arguments, &error),
                   VXM_OK);
  reader.limit_ms = limit_ms;
  assert_int_equal(vxm_wire_send_size(&reader, strlen(word), &error), VXM_OK);
  assert_int_equal(vxm_process_send(&reader, word, strlen(word), &error), VXM_OK);
  assert_int_equal(vxm_wire_receive(&reader, &listener, &error), VXM_ERROR_IO);
  *is_late = vxm_process_is_late(&reader);
  int end = vxm_process_end(&reader);
  vxm_soup_destroy(soup);
  return end;
}

static void test_time(void **state) {
  (void)state;
  bool is_late;
  int end = run_long("spin", "1", 0, &is_late);
  assert_true(WIFSIGNALED(end) && WTERMSIG(end) == SIGXCPU && !is_late);
  static const char *const idle[] = {"sleep", "wait"}; /* the second tells progress all the time */
  for (size_t i = 0; i < 2; i++) {
    double start = vxm_clock_ms();
    end = run_long(idle[i], "1000", 700, &is_late);
    assert_true(WIFSIGNALED(end) && WTERMSIG(end) == SIGKILL && is_late);
    assert_true(vxm_clock_ms() - start >= 700);
  }
}

/* ---- What a reader may not ---- */

#define STOPPED "dir/a.ill: the reader was stopped: it tried to "

static void test_attempts(void **state) {
  (void)state;
  static const struct {
    const char *word, *text;
  } attempts[] = {
      {"try open", "open a file"},
      {"try openat", "open a file"},
      {"try creat", "open a file"},
      {"try fopen", "open a file"},
      {"try opendir", "open a file"},
      {"try stat", "look at files"},
      {"try unlink", "change files"},
      {"try socket", "use the network"},
      {"try connect", "use the network"},
      {"try fork", "start a process"},
      {"try system", "do what a reader may not"}, /* with all signals blocked */
      {"try early thread", "open a file"},
      {"try execve", "run a program"},
      {"try kill parent", "signal another process"},
      {"try kill group", "signal another process"},
      {"try ptrace", "look into another process"},
      {"try peek", "look into another process"},
      {"try execute", "map memory that is shared or executable"},
      {"try share", "map memory that is shared or executable"},
      {"try protect", "make memory executable"},
      {"try descriptors", "make file descriptors"},
      {"try memfd", "make file descriptors"},
      {"try limits", "do what a reader may not (system call "},
      {"try setuid", "do what a reader may not (system call "},
  };
#ifndef HAVE_SECCOMP
  skip();
#endif
  if (SANITIZED)
    skip();
  static const char victim[] = "/tmp/voxmend-ill-victim";
  int file = open(victim, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  assert_true(file >= 0);
  close(file);
  for (size_t a = 0; a < sizeof attempts / sizeof *attempts; a++) {
    char text[160];
    snprintf(text, sizeof text, STOPPED "%s", attempts[a].text);
    fails(attempts[a].word, VXM_ERROR_FORMAT, text);
  }
  /* A thread takes memory first, in ways that differ between C libraries. */
  fails("try thread", VXM_ERROR_FORMAT, STOPPED);
  assert_int_equal(access("/tmp/voxmend-ill-trace", F_OK), -1);
  assert_int_equal(unlink(victim), 0);
}

static void test_surroundings(void **state) {
  (void)state;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  int open_here = open("/dev/null", O_RDONLY); /* to be inherited */
  assert_true(open_here > STDERR_FILENO);
  setenv("VOXMEND_SECRET", "secret", 1);
  assert_int_equal(ask(&soup, NULL, "look", 4, &error), VXM_ERROR_RANGE);
  assert_null(strstr(error.text, "SECRET"));
  assert_non_null(strstr(error.text, "LANG LC_ALL PATH TZ"));
  assert_null(strstr(error.text, "VOXMEND"));
  assert_non_null(strstr(error.text, "descriptors: 3")); /* the channel, and twice /dev/null */
  unsetenv("VOXMEND_SECRET");
  close(open_here);
}

/* ---- What a mesh refers to ---- */

static void make_file(const char *folder, const char *name, size_t size) {
  char path[200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  for (size_t i = 0; i < size; i++)
    fputc('x', file);
  fclose(file);
}

static void test_references(void **state) {
  (void)state;
  char folder[] = "/tmp/voxmend-test-XXXXXX", command[300];
  assert_non_null(mkdtemp(folder));
  snprintf(command, sizeof command,
           "cd %s && mkdir -p in/sub && mkfifo in/fifo && ln -s /etc/passwd in/out && ln -s sub/large "
           "in/within && "
           "ln -s ../outside in/up",
           folder);
  assert_int_equal(system(command), 0);
  make_file(folder, "in/small", 3);
  make_file(folder, "in/empty", 0);
  make_file(folder, "in/sub/large", 300000);
  make_file(folder, "outside", 10);
  snprintf(command, sizeof command, "%s/in/mesh.ill", folder);
  int within = vxm_folder_open(command);
  assert_true(within >= 0);
  static const char list[] =
      "ask small\nsub/large\nempty\nwithin\n/etc/passwd\n../outside\nup\nout\nfifo\nsub\n"
      "nothing\n/proc/self/environ\nfile:///etc/passwd\n";
  static const struct {
    vxm_external allowed;
    bool has_folder, is_inside;
    const char *got;
    uint64_t refused;
  } cases[] = {
      {VXM_EXTERNAL_FOLDER, true, true, "got 3 300000 0 300000 -1 -1 -1 -1 -1 -1 -1 -1 -1", 9},
      {VXM_EXTERNAL_FOLDER, true, false, "got -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1", 13},
      {VXM_EXTERNAL_FOLDER, false, false, "got -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1", 13},
      {VXM_EXTERNAL_NONE, true, true, "got -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 -1", 13},
      {VXM_EXTERNAL_ANY, true, true, "got 3 300000 0 300000 ", 4},
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    references = (vxm_references){.allowed = cases[c].allowed,
                                  .folder = cases[c].has_folder ? within : -1,
                                  .is_inside = cases[c].is_inside};
    fails(list, VXM_ERROR_RANGE, cases[c].got);
    assert_int_equal(references.asked, 13);
    assert_int_equal(references.refused, cases[c].refused);
    assert_true(references.warnings.count > 0 && references.warnings.count <= VXM_WARNINGS_MAX / 2);
  }
  assert_non_null(strstr(references.warnings.text[0],
                         "\"fifo\", which it refers to, was not opened: it is not a regular"));
  /* Not without end. */
  references = (vxm_references){.folder = within, .is_inside = true};
  fails("nag", VXM_ERROR_RANGE, "got 4096");
  assert_non_null(strstr(references.first, "too many files"));
  close(within);
  references = (vxm_references)VXM_REFERENCES_NONE;
  snprintf(command, sizeof command, "rm -r %s", folder);
  assert_int_equal(system(command), 0);
}

/** A module on a path that depends on the current folder is nobody's. */
static void test_relative_modules(void **state) {
  (void)state;
  char path[VXM_MODULE_PATH_MAX], *before = strdup(getenv("VOXMEND_MODULES"));
  vxm_error error = VXM_ERROR_INIT;
  char here[VXM_MODULE_PATH_MAX];
  assert_non_null(getcwd(here, sizeof here));
  assert_int_equal(chdir(before), 0);
  setenv("VOXMEND_MODULES", ".", 1);
  assert_int_equal(vxm_module_find(path, &need, &error), VXM_ERROR_UNAVAILABLE);
  assert_non_null(strstr(error.text, "absolute path, not \".\""));
  assert_int_equal(chdir(here), 0);
  setenv("VOXMEND_MODULES", before, 1);
  free(before);
  assert_int_equal(vxm_module_find(path, &need, &error), VXM_OK);
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
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(ask(&soup, NULL, "any", 3, &error), VXM_OK);
  vxm_soup_destroy(soup);
  fails("fail", VXM_ERROR_FORMAT, "as the file wants");
  assert_int_not_equal(ask(&soup, NULL, "abort", 5, &error), VXM_OK);
  signal(SIGCHLD, before);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_soup),
                                     cmocka_unit_test(test_failures),
                                     cmocka_unit_test(test_sanitize),
                                     cmocka_unit_test(test_missing),
                                     cmocka_unit_test(test_memory),
                                     cmocka_unit_test(test_cancel),
                                     cmocka_unit_test(test_time),
                                     cmocka_unit_test(test_no_program),
                                     cmocka_unit_test(test_ignored_children),
                                     cmocka_unit_test(test_attempts),
                                     cmocka_unit_test(test_surroundings),
                                     cmocka_unit_test(test_references),
                                     cmocka_unit_test(test_relative_modules),
                                     cmocka_unit_test(test_swallowed_failures)};
  leave_signals_alone();
  alarm(100);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
