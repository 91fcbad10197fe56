/* SPDX-License-Identifier: BSD-3-Clause */
/** Files where nothing can be mapped: they are read, from their beginning. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <errno.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/output.h"

/** Takes the place of mmap for the library that is tested (ld --wrap). */
void *__wrap_mmap(void *address, size_t length, int protection, int flags, int descriptor, off_t offset);
void *__wrap_mmap(void *address, size_t length, int protection, int flags, int descriptor, off_t offset) {
  (void)address, (void)length, (void)protection, (void)flags, (void)descriptor, (void)offset;
  errno = ENODEV;
  return MAP_FAILED;
}

static void written_is_read_back(void **state) {
  (void)state;
  char path[] = "unmapped-XXXXXX";
  int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  vxm_context *context;
  vxm_output *output;
  vxm_input input;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_output_open_readable(&output, context, path, NULL), VXM_OK);
  vxm_output_write(output, "what was written", 16);
  assert_int_equal(vxm_output_read_back(&input, output, NULL), VXM_OK);
  assert_int_equal(input.size, 16);
  assert_memory_equal(input.data, "what was written", 16);
  vxm_input_close(&input);
  assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
  assert_int_equal(vxm_input_open(&input, context, path, NULL), VXM_OK);
  assert_int_equal(input.size, 16);
  vxm_input_close(&input);
  vxm_context_destroy(context);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(written_is_read_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
