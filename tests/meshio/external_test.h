/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of foreign formats share. */
#ifndef EXTERNAL_TEST_H
#define EXTERNAL_TEST_H

#include "meshio_test.h"

#include <unistd.h>

#include "base/module.h"
#include "mesh/census.h"
#include "sandbox/reader.h"

#if defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = 1, SLOWER = 8 };
#else
enum { SANITIZED = 0, SLOWER = 1 };
#endif

/** A sanitizer takes signals for itself unless told otherwise: libraries may crash in the other process. */
static inline void leave_signals_alone(void) {
  const char *options = getenv("ASAN_OPTIONS");
  char all[1024];
  snprintf(all, sizeof all, "%s:handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0",
           options ? options : "");
  setenv("ASAN_OPTIONS", all, 1);
}

/** Reads in this process, where a sanitizer watches the module and sees what it leaves behind. */
static inline vxm_soup *read_in_process(const char *name, const char *hint, const bytes *b) {
  const vxm_module *module;
  vxm_module_need need = {name, "", ""};
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  if (vxm_module_open(&module, &need, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_true(strlen(module->library) > 0 && strlen(module->licence) > 0);
  vxm_reader_request request = {
      .data = b->data, .size = b->size, .name = "a", .hint = hint, .deflection = VXM_DEFLECTION_DEFAULT};
  const vxm_reader *reader = module->functions;
  assert_int_equal(vxm_soup_create(&soup, NULL, "", NULL), VXM_OK);
  if (reader->read(soup, &request, &error) != VXM_OK)
    fail_msg("%s", error.text);
  check_invariants(soup);
  return soup;
}

/** Bounds, volume and closedness of what was read. */
static inline void expect_body(const vxm_soup *soup, const double bounds[6], double volume,
                               double tolerance) {
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
  assert_true(census.watertight);
  assert_int_equal(census.inconsistent_edges, 0);
  for (int b = 0; b < 6; b++)
    if (!(fabs(census.bounds[b] - bounds[b]) <= tolerance))
      fail_msg("bound %d is %.9g, not %.9g", b, census.bounds[b], bounds[b]);
  if (!(fabs(census.volume - volume) <= tolerance * (1 + fabs(volume))))
    fail_msg("the volume is %.9g, not %.9g", census.volume, volume);
}

/** The names of the tags, in their order; NULL ends the list. */
static inline void expect_tags(const vxm_soup *soup, const char *const *names) {
  size_t count = 0;
  for (; names[count]; count++)
    if (count >= soup->tag_count || strcmp(soup->tags[count], names[count]) != 0)
      fail_msg("tag %zu is \"%s\", not \"%s\"", count, count < soup->tag_count ? soup->tags[count] : "(none)",
               names[count]);
  assert_int_equal(soup->tag_count, count);
}

/** What a writer of samples/scenes.h writes. */
static inline bytes scene_bytes(bool (*write)(FILE *)) {
  char *data = NULL;
  size_t size = 0;
  FILE *file = open_memstream(&data, &size);
  assert_non_null(file);
  assert_true(write(file));
  fclose(file);
  return (bytes){(unsigned char *)data, size, size};
}

/** Reads a file that may be damaged: that gives a soup or a message, within its time. */
static inline bool survives(const bytes *b, const char *name) {
  enum { SECONDS = 20 };
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  alarm(SECONDS); /* a hang ends the program, and so fails */
  vxm_status status = read_bytes(&soup, b->data, b->size, name, &error);
  alarm(0);
  if (status == VXM_OK)
    vxm_soup_destroy(soup);
  else if (status != VXM_ERROR_FORMAT && status != VXM_ERROR_MEMORY_LIMIT &&
           !(SANITIZED && status == VXM_ERROR_UNAVAILABLE)) /* a sanitizer has ended the other process */
    fail_msg("status %d: %s", status, error.text);
  return status == VXM_OK;
}

/** Cuts a file off at many places, and changes a few bytes of it many times. Returns how many were read. */
static inline int damage_many(const bytes *whole, const char *name, int times) {
  vxm_rng rng = {5};
  int read = 0;
  for (int i = 0; i < times; i++) {
    bytes cut = {0};
    bytes_add(&cut, whole->data, whole->size * (size_t)i / (size_t)times);
    read += survives(&cut, name);
    bytes_free(&cut);
    bytes flipped = {0};
    bytes_add(&flipped, whole->data, whole->size);
    for (uint64_t k = 1 + vxm_rng_below(&rng, 6); k > 0; k--)
      flipped.data[vxm_rng_below(&rng, whole->size)] ^= (unsigned char)(1 << vxm_rng_below(&rng, 8));
    read += survives(&flipped, name);
    bytes_free(&flipped);
  }
  return read;
}

#endif
