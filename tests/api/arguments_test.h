/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of arguments that are refused share. */
#ifndef ARGUMENTS_TEST_H
#define ARGUMENTS_TEST_H

#include "api_support.h"

/** A failure has its code, one line of text, and nothing created. */
#define REFUSED(call, expected)                                      \
  do {                                                               \
    error = (vxm_error)VXM_ERROR_INIT;                               \
    assert_int_equal(call, expected);                                \
    assert_int_equal(error.code, expected);                          \
    assert_true(error.text[0] != '\0' && !strchr(error.text, '\n')); \
  } while (0)

static vxm_error error;
static void *const junk = &error;

static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static inline vxm_mesh_arrays tetrahedron(void) {
  static const int64_t indices[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = corners;
  arrays.vertex_count = 4;
  arrays.indices = indices;
  arrays.index_count = 12;
  arrays.face_count = 4;
  return arrays;
}

#endif
