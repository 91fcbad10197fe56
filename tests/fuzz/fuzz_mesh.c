/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes through the readers of meshes, and through the process that reads foreign formats. */
#include "fuzz.h"
#include "fuzz_soup.h"

#include "base/clock.h"
#include "meshio/common/format.h"
#include "meshio/external/external_formats.h"
#include "meshio/meshio.h"

#include <stdio.h>
#include <string.h>

/*
 * Bytes that a reader may hold for each byte of the file, and besides. OBJ sets the rate: a line "usemtl a"
 * and a face of seven bytes make a tag that repeats a long group's name.
 */
enum { RATE = 64, BESIDES = 1 << 16 };

typedef vxm_status reader_of_meshes(vxm_soup *soup, const unsigned char *data, size_t size, const char *name,
                                    vxm_error *error);

/** NULL = the one that the content asks for. */
static reader_of_meshes *reader_for(const char *name) {
  static const struct {
    const char *name;
    reader_of_meshes *read;
  } readers[] = {{"off", vxm_off_read}, {"obj", vxm_obj_read}, {"stl", vxm_stl_read}, {"ply", vxm_ply_read}};
  for (size_t r = 0; r < sizeof readers / sizeof *readers; r++)
    if (strcmp(name, readers[r].name) == 0)
      return readers[r].read;
  return NULL;
}

void fuzz_check_soup(const vxm_soup *soup) {
  fuzz_require(soup->offsets[0] == 0, "offsets begin at 0");
  for (size_t f = 0; f < soup->face_count; f++)
    fuzz_require(soup->offsets[f + 1] >= soup->offsets[f] + 3, "faces have three corners or more");
  fuzz_require(soup->offsets[soup->face_count] == soup->corner_count, "offsets end at the number of corners");
  for (size_t c = 0; c < soup->corner_count; c++)
    fuzz_require(soup->indices[c] < soup->vertex_count, "indices name vertices");
  fuzz_require((soup->face_tags != NULL) == (soup->tag_count > 0), "tags go with their names");
  for (size_t f = 0; soup->face_tags && f < soup->face_count; f++)
    fuzz_require(soup->face_tags[f] < soup->tag_count, "tags have names");
  for (int n = 0; n < soup->warnings.count; n++)
    fuzz_require(soup->warnings.text[n][0] && !strchr(soup->warnings.text[n], '\n'), "warnings are one line");
}

void fuzz_check_error(const vxm_error *error, vxm_status status) {
  fuzz_require(error->code == status, "the error has the status");
  fuzz_require(error->text[0] && !strchr(error->text, '\n'), "a failure is one line");
}

static vxm_context *context_of(uint64_t limit, vxm_progress_fn progress, void *payload) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 1;
  options.memory_limit = limit;
  options.progress = progress;
  options.payload = payload;
  vxm_context *context;
  fuzz_require(vxm_context_create(&context, &options, NULL) == VXM_OK, "a context can be made");
  return context;
}

vxm_context *fuzz_context(size_t size, uint64_t rate, uint64_t besides) {
  return context_of((uint64_t)size * rate + besides, NULL, NULL);
}

void fuzz_mesh(const char *name, const uint8_t *data, size_t size) {
  reader_of_meshes *reader = reader_for(name);
  if (!reader && vxm_external_format_by_content(data, size)) /* other targets' business, as most are */
    return;
  vxm_context *context = fuzz_context(size, RATE, BESIDES);
  vxm_soup *soup = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status;
  if (reader) {
    fuzz_require(vxm_soup_create(&soup, context, "", &error) == VXM_OK, "a soup can be made");
    status = reader(soup, data, size, "fuzz", &error);
  } else
    status = vxm_meshio_read(&soup, context, data, size, "fuzz", NULL, &error);
  /* A process that reads foreign formats takes more. */
  bool is_apart = !reader && strstr(error.text, "reading takes more than");
  fuzz_require(status != VXM_ERROR_MEMORY_LIMIT || is_apart, "memory stays in proportion to the size");
  if (status == VXM_OK) {
    fuzz_check_soup(soup);
    /* The polygons met here are a good test of splitting them. */
    vxm_status written = vxm_meshio_write(soup, "/dev/null", "stl", false, &error);
    fuzz_require(written == VXM_OK || written == VXM_ERROR_RANGE || written == VXM_ERROR_MEMORY_LIMIT,
                 "STL is written");
  } else
    fuzz_check_error(&error, status);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** Cancels what takes longer; payload: until when, in ms. */
static int stop_in_time(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  return vxm_clock_ms() > *(const double *)payload;
}

/** Libraries crash, hang and ask for all memory: that this process goes on, and says one line, is what
 * counts.
 */
void fuzz_foreign(const char *name, const uint8_t *data, size_t size) {
  enum { PATIENCE_MS = 5000 }; /* rather than the minute after which the library ends that process */
  double until = vxm_clock_ms() + PATIENCE_MS;
  vxm_context *context = context_of(UINT64_C(512) << 20, stop_in_time, &until);
  char file[32];
  vxm_soup *soup = NULL;
  vxm_error error = VXM_ERROR_INIT;
  snprintf(file, sizeof file, "<fuzz>.%s", name);
  vxm_status status = vxm_meshio_read(&soup, context, data, size, file, NULL, &error);
  fuzz_require((status == VXM_OK) == (soup != NULL), "a soup comes with success alone");
  if (status == VXM_OK)
    fuzz_check_soup(soup);
  else
    fuzz_check_error(&error, status);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}
