/* SPDX-License-Identifier: BSD-3-Clause */
/** Opening beneath a folder, by the kernel and step by step; folders that the environment names. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/folders.h"
#include "base/open_beneath.h"

static char folder[] = "/tmp/voxmend-beneath-XXXXXX";

static int make_folder(void **state) {
  (void)state;
  char command[600];
  if (!mkdtemp(folder))
    return -1;
  snprintf(command, sizeof command,
           "cd %s && mkdir -p in/a/b loose && chmod 0777 loose && echo x >in/file && echo y >in/a/b/deep && "
           "echo z >outside && mkfifo in/fifo && ln -s file in/link && ln -s ../outside in/up && "
           "ln -s /etc/passwd in/absolute && ln -s a in/folder && ln -s .. in/parent && "
           "ln -s /proc/self/fd/0 in/magic && ln -s loop in/loop && ln -s /dev/zero in/device",
           folder);
  return system(command);
}

static int remove_folder(void **state) {
  (void)state;
  char command[200];
  snprintf(command, sizeof command, "rm -r %s", folder);
  return system(command);
}

/** 0 if it opens, else errno. */
static int result_of(int within, const char *name, vxm_beneath how) {
  int descriptor = vxm_regular_open(within, name, how);
  if (descriptor < 0)
    return errno;
  assert_true((fcntl(descriptor, F_GETFD) & FD_CLOEXEC) != 0);
  close(descriptor);
  return 0;
}

static void test_names(void **state) {
  (void)state;
  static const struct {
    const char *name;
    int kernel, steps; /* -1 = some failure */
  } cases[] = {
      {"file", 0, 0},
      {"a/b/deep", 0, 0},
      {"a//b///deep", 0, 0},
      {"./file", 0, 0},
      {"link", 0, ELOOP}, /* a link that stays within */
      {"folder/b/deep", 0, -1},
      {"a/../file", 0, EXDEV},
      {"", ENOENT, ENOENT},
      {"nothing", ENOENT, ENOENT},
      {"file/", -1, -1},
      {"file/x", ENOTDIR, ENOTDIR},
      {"..", EXDEV, EXDEV},
      {"../outside", EXDEV, EXDEV},
      {"a/../../outside", EXDEV, EXDEV},
      {"up", EXDEV, ELOOP},
      {"parent/outside", EXDEV, -1},
      {"absolute", EXDEV, ELOOP},
      {"device", EXDEV, ELOOP},
      {"magic", -1, ELOOP},
      {"loop", ELOOP, ELOOP},
      {"/etc/passwd", EXDEV, EXDEV},
      {"//etc/passwd", EXDEV, EXDEV},
      {"/proc/self/environ", EXDEV, EXDEV},
      {"file:///etc/passwd", ENOENT, ENOENT},
      {"fifo", ENOTSUP, ENOTSUP}, /* and nobody waits */
      {"a", ENOTSUP, ENOTSUP},
      {".", ENOTSUP, ENOTSUP},
  };
  char path[300], longer[600];
  snprintf(path, sizeof path, "%s/in/file", folder);
  int within = vxm_folder_open(path);
  assert_true(within >= 0);
  alarm(20);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    int kernel = result_of(within, cases[c].name, VXM_BENEATH);
    int steps = result_of(within, cases[c].name, VXM_BENEATH_STEPS);
    if (cases[c].kernel < 0 ? kernel == 0 : kernel != cases[c].kernel)
      fail_msg("\"%s\": %s", cases[c].name, strerror(kernel));
    if (cases[c].steps < 0 ? steps == 0 : steps != cases[c].steps)
      fail_msg("\"%s\" step by step: %s", cases[c].name, strerror(steps));
  }
  memset(longer, 'x', sizeof longer - 1);
  longer[sizeof longer - 1] = '\0';
  assert_int_equal(result_of(within, longer, VXM_BENEATH), ENAMETOOLONG);
  assert_int_equal(result_of(within, longer, VXM_BENEATH_STEPS), ENAMETOOLONG);
  assert_int_equal(result_of(within, "../outside", VXM_BENEATH_NOT), 0);
  assert_int_equal(result_of(within, "/etc/passwd", VXM_BENEATH_NOT), 0);
  assert_int_equal(result_of(within, "fifo", VXM_BENEATH_NOT), ENOTSUP);
  assert_int_equal(result_of(within, "device", VXM_BENEATH_NOT), ENOTSUP);
  alarm(0);
  close(within);
}

/** Steps close what they open on the way. */
static void test_descriptors(void **state) {
  (void)state;
  char path[300];
  snprintf(path, sizeof path, "%s/in/", folder);
  int within = vxm_folder_open(path), next = dup(within);
  close(next);
  for (int i = 0; i < 50; i++) {
    assert_int_equal(result_of(within, "a/b/deep", VXM_BENEATH_STEPS), 0);
    assert_int_not_equal(result_of(within, "a/b/nothing", VXM_BENEATH_STEPS), 0);
    assert_int_not_equal(result_of(within, "a/../../x", VXM_BENEATH_STEPS), 0);
    assert_int_not_equal(result_of(within, "a/b", VXM_BENEATH_STEPS), 0);
    assert_int_not_equal(result_of(within, "folder/b", VXM_BENEATH), 0);
  }
  int after = dup(within);
  assert_int_equal(after, next);
  close(after);
  close(within);
}

static void test_temporary(void **state) {
  (void)state;
  char path[300];
  unsetenv("TMPDIR");
  assert_string_equal(vxm_folder_temporary(), "/tmp");
  setenv("TMPDIR", "", 1);
  assert_string_equal(vxm_folder_temporary(), "/tmp");
  setenv("TMPDIR", "relative", 1);
  assert_null(vxm_folder_temporary());
  assert_int_equal(errno, EINVAL);
  snprintf(path, sizeof path, "%s/nothing", folder);
  setenv("TMPDIR", path, 1);
  assert_null(vxm_folder_temporary());
  assert_int_equal(errno, ENOENT);
  snprintf(path, sizeof path, "%s/loose", folder); /* where everybody may remove everything */
  setenv("TMPDIR", path, 1);
  assert_null(vxm_folder_temporary());
  assert_int_equal(errno, EPERM);
  assert_int_equal(chmod(path, 01777), 0);
  assert_string_equal(vxm_folder_temporary(), path);
  setenv("TMPDIR", folder, 1);
  assert_string_equal(vxm_folder_temporary(), folder);
  unsetenv("TMPDIR");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_names), cmocka_unit_test(test_descriptors),
                                     cmocka_unit_test(test_temporary)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
