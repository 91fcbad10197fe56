/* SPDX-License-Identifier: BSD-3-Clause */
/** Files that appear only when complete, inputs, and messages of one printable line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/output.h"
#include "base/warnings.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct place {
  vxm_context *context;
  char folder[64];
  char path[128];
} place;

static int make_place(void **state) {
  static place p;
  snprintf(p.folder, sizeof p.folder, "/tmp/voxmend-file-XXXXXX");
  if (!mkdtemp(p.folder) || vxm_context_create(&p.context, NULL, NULL) != VXM_OK)
    return 1;
  snprintf(p.path, sizeof p.path, "%s/out.bin", p.folder);
  *state = &p;
  return 0;
}

static int drop_place(void **state) {
  place *p = *state;
  unlink(p->path);
  vxm_context_destroy(p->context);
  return rmdir(p->folder);
}

static int files_in(const char *folder) {
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(directory));)
    count += entry->d_name[0] != '.';
  closedir(directory);
  return count;
}

static void assert_holds(const place *p, const char *data, size_t size) {
  vxm_input input;
  assert_int_equal(vxm_input_open(&input, p->context, p->path, NULL), VXM_OK);
  assert_int_equal(input.size, size);
  if (size > 0)
    assert_memory_equal(input.data, data, size);
  vxm_input_close(&input);
}

static void appears_when_complete(void **state) {
  place *p = *state;
  enum { SIZE = 300000 };
  char *data = malloc(SIZE);
  assert_non_null(data);
  for (size_t i = 0; i < SIZE; i++)
    data[i] = (char)(i * 7 / 3);
  static const size_t pieces[] = {1, 100, 5000, 65536, 100000, SIZE};
  for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
    unlink(p->path);
    vxm_output *output;
    assert_int_equal(vxm_output_open(&output, p->context, p->path, NULL), VXM_OK);
    for (size_t at = 0; at < SIZE;) {
      size_t piece = pieces[i] < SIZE - at ? pieces[i] : SIZE - at;
      if (piece <= 4096 && at % 2) {
        memcpy(vxm_output_reserve(output, piece), data + at, piece);
        vxm_output_advance(output, piece);
      } else
        vxm_output_write(output, data + at, piece);
      at += piece;
    }
    assert_false(vxm_output_failed(output));
    assert_int_equal(access(p->path, F_OK), -1);
    assert_true(files_in(p->folder) <= 1); /* none where the file system has files without names */
    assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
    assert_int_equal(files_in(p->folder), 1);
    assert_holds(p, data, SIZE);
  }
  free(data);
}

/** Bytes within the buffer, beyond it, and across; what follows goes to the end. */
static void patches(void **state) {
  place *p = *state;
  enum { SIZE = 200000 };
  char *data = calloc(SIZE, 1);
  assert_non_null(data);
  for (int last = 0; last < 2; last++) { /* patched on the way, or at the end */
    vxm_output *output;
    assert_int_equal(vxm_output_open(&output, p->context, p->path, NULL), VXM_OK);
    assert_true(vxm_output_can_patch(output));
    memset(data, 'a', SIZE);
    vxm_output_write(output, data, SIZE - 10);
    if (last)
      vxm_output_write(output, data, 10);
    static const size_t places[] = {0, 100, 65530, SIZE - 14};
    for (int i = 0; i < 4; i++) {
      vxm_output_patch(output, places[i], "wxyz", 4);
      memcpy(data + places[i], "wxyz", 4);
    }
    if (!last)
      vxm_output_write(output, "aaaaaaaaaa", 10);
    assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
    assert_holds(p, data, SIZE);
  }
  free(data);
  vxm_output *output;
  assert_int_equal(vxm_output_open(&output, p->context, "/dev/null", NULL), VXM_OK);
  assert_false(vxm_output_can_patch(output));
  vxm_output_abort(output);
}

static void abort_leaves_what_was_there(void **state) {
  place *p = *state;
  vxm_output *output;
  assert_int_equal(vxm_output_open(&output, p->context, p->path, NULL), VXM_OK);
  vxm_output_printf(output, "%s %d\n", "first", 1);
  assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
  assert_int_equal(vxm_output_open(&output, p->context, p->path, NULL), VXM_OK);
  vxm_output_printf(output, "second\n");
  vxm_output_abort(output);
  vxm_output_abort(NULL);
  assert_holds(p, "first 1\n", 8);
  assert_int_equal(files_in(p->folder), 1);
  /* an empty file is a file */
  assert_int_equal(vxm_output_open(&output, p->context, p->path, NULL), VXM_OK);
  assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
  assert_holds(p, "", 0);
}

static void failure_leaves_nothing(void **state) {
  place *p = *state;
  unlink(p->path);
  vxm_error error = VXM_ERROR_INIT;
  vxm_output *output;
  char missing[160];
  snprintf(missing, sizeof missing, "%s/none/out.bin", p->folder);
  assert_int_equal(vxm_output_open(&output, p->context, missing, &error), VXM_ERROR_IO);
  assert_null(output);
  assert_non_null(strstr(error.text, missing));
  assert_int_equal(vxm_output_open(&output, p->context, p->folder, &error), VXM_ERROR_IO);

  /* a full disk, by a limit on the size of files */
  struct rlimit old, small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  small = old;
  small.rlim_cur = 100000;
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(vxm_output_open(&output, p->context, p->path, &error), VXM_OK);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  for (int i = 0; i < 300; i++)
    vxm_output_printf(output, "%01000d", i);
  bool failed = vxm_output_failed(output);
  vxm_status status = vxm_output_commit(output, &error);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
  signal(SIGXFSZ, handler);
  assert_true(failed);
  assert_int_equal(status, VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "cannot write"));
  assert_int_equal(files_in(p->folder), 0);
}

static void devices_are_written_to(void **state) {
  place *p = *state;
  vxm_output *output;
  assert_int_equal(vxm_output_open(&output, p->context, "/dev/null", NULL), VXM_OK);
  vxm_output_write(output, "x", 1);
  assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
  struct stat info;
  assert_int_equal(stat("/dev/null", &info), 0);
  assert_true(S_ISCHR(info.st_mode));
}

static void inputs(void **state) {
  place *p = *state;
  vxm_error error = VXM_ERROR_INIT;
  vxm_input input;
  assert_int_equal(vxm_input_open(&input, p->context, p->path, &error), VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "out.bin"));
  assert_string_equal(error.file, p->path);
  vxm_input_close(&input);
  assert_int_equal(vxm_input_open(&input, p->context, p->folder, &error), VXM_ERROR_IO);
  vxm_input_close(&input);

  /* standard input from a pipe */
  int ends[2], old = dup(STDIN_FILENO);
  assert_int_equal(pipe(ends), 0);
  assert_int_equal(write(ends[1], "hello", 5), 5);
  close(ends[1]);
  dup2(ends[0], STDIN_FILENO);
  close(ends[0]);
  assert_int_equal(vxm_input_open(&input, p->context, "-", &error), VXM_OK);
  dup2(old, STDIN_FILENO);
  close(old);
  assert_int_equal(input.size, 5);
  assert_memory_equal(input.data, "hello", 5);
  assert_string_equal(input.name, "<stdin>");
  vxm_input_close(&input);
}

static void names(void **state) {
  (void)state;
  assert_string_equal(vxm_path_extension("a/b.c/mesh.OBJ"), "OBJ");
  assert_string_equal(vxm_path_extension("a.b/mesh"), "");
  assert_string_equal(vxm_path_extension("mesh."), "");
  assert_true(vxm_text_equal_nocase("StL", "sTl"));
  assert_false(vxm_text_equal_nocase("stl", "stl2"));
  assert_false(vxm_text_equal_nocase("stl", "ply"));
}

static void assert_one_printable_line(const char *text, size_t room) {
  size_t length = strnlen(text, room);
  assert_true(length < room);
  for (size_t i = 0; i < length; i++)
    assert_true((unsigned char)text[i] >= 0x20 && text[i] != 0x7f);
}

static void messages(void **state) {
  (void)state;
  vxm_error error = VXM_ERROR_INIT;
  char noise[2000];
  for (size_t i = 0; i + 1 < sizeof noise; i++)
    noise[i] = (char)(i % 255 + 1);
  noise[sizeof noise - 1] = '\0';
  assert_int_equal(vxm_fail(&error, VXM_ERROR_FORMAT, "bad word '%s'", noise), VXM_ERROR_FORMAT);
  assert_one_printable_line(error.text, sizeof error.text);
  assert_int_equal(strncmp(error.text, "bad word '???", 13), 0);

  vxm_place at = {noise, 12, -1, 5};
  assert_int_equal(vxm_fail_at(&error, VXM_ERROR_RANGE, at, "%s", noise), VXM_ERROR_RANGE);
  assert_one_printable_line(error.text, sizeof error.text);
  assert_true(error.line == 12 && error.offset == -1 && error.element == 5);
  assert_int_equal(strlen(error.file), sizeof error.file - 1);

  vxm_fail_at(&error, VXM_ERROR_FORMAT, (vxm_place){"a.off", 7, -1, -1}, "two of %d", 3);
  assert_string_equal(error.text, "a.off:7: two of 3");
  vxm_fail_at(&error, VXM_ERROR_FORMAT, (vxm_place){"a.stl", 0, 84, -1}, "cut off");
  assert_string_equal(error.text, "a.stl: byte 84: cut off");
  errno = ENOENT;
  vxm_fail_errno(&error, "a.ply", "cannot open");
  assert_string_equal(error.text, "a.ply: cannot open: No such file or directory");
  assert_int_equal(vxm_fail(NULL, VXM_ERROR_EMPTY, "nothing"), VXM_ERROR_EMPTY);

  static vxm_warnings warnings;
  for (int i = 0; i < VXM_WARNINGS_MAX + 3; i++)
    vxm_warn(&warnings, "warning %d: %s", i, noise);
  assert_int_equal(warnings.count, VXM_WARNINGS_MAX);
  for (int i = 0; i < warnings.count; i++)
    assert_one_printable_line(warnings.text[i], VXM_WARNING_LENGTH);
  assert_string_equal(vxm_status_name(VXM_OK), "ok");
  assert_string_equal(vxm_status_name(VXM_ERROR_CANCELLED), "cancelled");
  assert_string_equal(vxm_version(), "1.0.0");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(appears_when_complete),
      cmocka_unit_test(patches),
      cmocka_unit_test(abort_leaves_what_was_there),
      cmocka_unit_test(failure_leaves_nothing),
      cmocka_unit_test(devices_are_written_to),
      cmocka_unit_test(inputs),
      cmocka_unit_test(names),
      cmocka_unit_test(messages),
  };
  return cmocka_run_group_tests(tests, make_place, drop_place);
}
