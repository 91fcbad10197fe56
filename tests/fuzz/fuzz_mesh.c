/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz_mesh.h"

#include "meshio/meshio.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*
 * Bytes that a reader may hold for each byte of the file, and besides. OBJ sets the rate: a line "usemtl a"
 * and a face of seven bytes make a tag that repeats a long group's name.
 */
enum { RATE = 64, BESIDES = 1 << 16 };

static void require(bool holds, const char *what) {
  if (holds)
    return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

static void check_soup(const vxm_soup *soup) {
  require(soup->offsets[0] == 0, "offsets begin at 0");
  for (size_t f = 0; f < soup->face_count; f++)
    require(soup->offsets[f + 1] >= soup->offsets[f] + 3, "faces have three corners or more");
  require(soup->offsets[soup->face_count] == soup->corner_count, "offsets end at the number of corners");
  for (size_t c = 0; c < soup->corner_count; c++)
    require(soup->indices[c] < soup->vertex_count, "indices name vertices");
  require((soup->face_tags != NULL) == (soup->tag_count > 0), "tags go with their names");
  for (size_t f = 0; soup->face_tags && f < soup->face_count; f++)
    require(soup->face_tags[f] < soup->tag_count, "tags have names");
  for (int n = 0; n < soup->notes.count; n++)
    require(soup->notes.text[n][0] && !strchr(soup->notes.text[n], '\n'), "notes are one line");
}

void fuzz_mesh(fuzz_reader *reader, const uint8_t *data, size_t size) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 1;
  options.memory_limit = (uint64_t)size * RATE + BESIDES;
  vxm_context *context;
  vxm_soup *soup = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status;
  require(vxm_context_create(&context, &options, &error) == VXM_OK, "a context can be made");
  if (reader) {
    require(vxm_soup_create(&soup, context, "", &error) == VXM_OK, "a soup can be made");
    status = reader(soup, data, size, "fuzz", &error);
  } else
    status = vxm_meshio_read(&soup, context, data, size, "fuzz", &error);
  require(status != VXM_ERROR_MEMORY_LIMIT, "memory stays in proportion to the size");
  if (status == VXM_OK) {
    check_soup(soup);
    /* The polygons met here are a good test of splitting them. */
    vxm_status written = vxm_meshio_write(soup, "/dev/null", "stl", false, &error);
    require(written == VXM_OK || written == VXM_ERROR_RANGE || written == VXM_ERROR_MEMORY_LIMIT,
            "STL is written");
  } else {
    require(error.code == status, "the error has the status");
    require(error.text[0] && !strchr(error.text, '\n'), "a failure is one line");
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}
