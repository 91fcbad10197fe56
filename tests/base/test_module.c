/* SPDX-License-Identifier: BSD-3-Clause */
/** A module of this build is opened, and none of another, whatever their versions say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "config.h"

#include "base/module.h"

static char folder[] = "/tmp/voxmend-module.XXXXXX";

/** The module with every `from` replaced by `to`, which is as long. */
static void copy_module(const char *path, const char *from, const char *to) {
  const char *build = getenv("BUILDDIR");
  char source[4096];
  snprintf(source, sizeof source, "%s/.libs/voxmend-nothing.so", build ? build : ".");
  FILE *in = fopen(source, "rb"), *out = fopen(path, "wb");
  if (!in)
    skip();
  assert_non_null(out);
  static char bytes[1 << 20];
  size_t size = fread(bytes, 1, sizeof bytes, in), length = strlen(from), found = 0;
  assert_true(size > 0 && size < sizeof bytes);
  for (size_t i = 0; i + length <= size; i++)
    if (memcmp(bytes + i, from, length) == 0) {
      memcpy(bytes + i, to, length);
      found++;
    }
  assert_true(found > 0);
  assert_int_equal(fwrite(bytes, 1, size, out), size);
  fclose(in);
  fclose(out);
}

static void check(const char *from, const char *to, vxm_status wanted) {
  static int number;
  char path[64];
  vxm_error error = VXM_ERROR_INIT;
  const vxm_module *module = NULL;
  snprintf(path, sizeof path, "%s/voxmend-%d.so", folder, number++);
  copy_module(path, from, to);
  vxm_status status = vxm_module_load(&module, path, "this test", &error);
  if (status != wanted)
    fail_msg("%s", error.text);
  assert_int_equal(module != NULL, wanted == VXM_OK);
  assert_null(strchr(error.text, '\n'));
  if (wanted != VXM_OK) {
    assert_non_null(strstr(error.text, VXM_BUILD));
    assert_non_null(strstr(error.text, path));
  }
  unlink(path);
}

static void test_builds(void **state) {
  (void)state;
  char other[] = VXM_BUILD;
  size_t last = strlen(other) - 1;
  assert_int_equal(strlen(VXM_BUILD_HASH), 16);
  check(VXM_BUILD, VXM_BUILD, VXM_OK);
  other[last] = other[last] == '0' ? '1' : '0';
  check(VXM_BUILD, other, VXM_ERROR_UNAVAILABLE);
  check("vxm_module_table", "vxm_another_name", VXM_ERROR_UNAVAILABLE);
}

static int set_up(void **state) {
  (void)state;
  return mkdtemp(folder) ? 0 : 1;
}

static int tear_down(void **state) {
  (void)state;
  return rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_builds)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
