/* SPDX-License-Identifier: BSD-3-Clause */
/** A module that does what the file tells it: everything that a foreign library may do to its process. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/module.h"
#include "config.h"
#include "meshio/reader.h"

static vxm_status make_strip(vxm_soup *soup, size_t faces, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t tag = 0;
  for (size_t v = 0; v < faces + 2 && status == VXM_OK; v++)
    status = vxm_soup_add_vertex(soup, (double)v, (double)(v % 2), 0.5, error);
  for (size_t f = 0; f < faces && status == VXM_OK; f++) {
    uint32_t corners[3] = {(uint32_t)f, (uint32_t)f + 1, (uint32_t)f + 2};
    status = vxm_soup_add_face(soup, corners, 3, error);
  }
  if (status == VXM_OK)
    status = vxm_soup_add_tag(soup, "first", 5, &tag, error);
  if (status == VXM_OK)
    status = vxm_soup_add_tag(soup, "", 0, &tag, error);
  if (status != VXM_OK)
    return status;
  soup->face_tags = vxm_alloc(soup->context, faces, sizeof *soup->face_tags, error);
  for (size_t f = 0; f < faces && soup->face_tags; f++)
    soup->face_tags[f] = (uint32_t)(f % 2);
  vxm_note(&soup->notes, "a note\nof two lines");
  return soup->face_tags ? VXM_OK : error->code;
}

/** Takes what there is, without asking much at once. */
static vxm_status take_all(vxm_soup *soup, vxm_error *error) {
  enum { PIECE = 1 << 20 };
  for (;;) {
    void *block = vxm_alloc(soup->context, PIECE, 1, error);
    if (!block)
      return error->code;
    memset(block, 1, PIECE);
  }
}

static vxm_status wait_for_ever(vxm_soup *soup, vxm_error *error) {
  for (double fraction = 0.25;; fraction = 0.5) {
    vxm_status status = vxm_progress(soup->context, "reading", fraction, error);
    if (status != VXM_OK)
      return status;
    usleep(1000);
  }
}

static void send_rubbish(void) {
  static const uint64_t kinds[] = {77, 0};
  if (write(STDIN_FILENO, kinds, sizeof kinds) < 0)
    raise(SIGABRT);
}

/** A header of a soup (see parcel.c) whose counts no memory holds, or whose arrays contradict them. */
static void send_lies(bool is_huge) {
  const uint64_t most = is_huge ? UINT64_MAX / 3 : 1;
  const uint64_t header[] = {3, most, most, is_huge ? most : 3, 0, 0, 0};
  const double corner[3] = {0, 0, 0};
  const uint64_t offsets[2] = {0, 3};
  const uint32_t indices[3] = {0, 1, 2}; /* of one vertex */
  bool sent =
      write(STDIN_FILENO, header, sizeof header) > 0 && write(STDIN_FILENO, corner, sizeof corner) > 0 &&
      write(STDIN_FILENO, offsets, sizeof offsets) > 0 && write(STDIN_FILENO, indices, sizeof indices) > 0;
  if (!sent)
    raise(SIGABRT);
}

static void print_much(void) {
  for (int i = 0; i < 100000; i++) {
    printf("chatter on standard output\n");
    fprintf(stderr, "chatter on standard error\n");
  }
  fflush(stdout);
}

static bool is_asked(const vxm_reader_request *request, const char *word) {
  return request->size >= strlen(word) && memcmp(request->data, word, strlen(word)) == 0;
}

static vxm_status obey(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  vxm_place place = {request->name, 7, -1, -1};
  if (is_asked(request, "crash"))
    raise(SIGSEGV);
  if (is_asked(request, "abort"))
    abort();
  if (is_asked(request, "quit"))
    exit(9);
  if (is_asked(request, "wait"))
    return wait_for_ever(soup, error);
  if (is_asked(request, "take"))
    return take_all(soup, error);
  if (is_asked(request, "rubbish"))
    send_rubbish();
  if (is_asked(request, "huge") || is_asked(request, "lies"))
    send_lies(is_asked(request, "huge"));
  if (is_asked(request, "print"))
    print_much();
  if (is_asked(request, "fail"))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "as the file wants");
  if (is_asked(request, "hint"))
    return vxm_fail(error, VXM_ERROR_RANGE, "%s %d %s %g", request->name, request->is_beside, request->hint,
                    request->deflection);
  while (is_asked(request, "spin"))
    ;
  return make_strip(soup, request->size, error);
}

static const vxm_reader reader = {obey};

VXM_API extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {PACKAGE_VERSION, "nothing", "BSD-3-Clause", &reader};
