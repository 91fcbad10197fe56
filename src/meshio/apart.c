/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/apart.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "meshio/parcel.h"

/* ---- The program ---- */

static bool is_program(char path[VXM_MODULE_PATH_MAX], const char *module, size_t folder) {
  int written = snprintf(path, VXM_MODULE_PATH_MAX, "%.*s/voxmend-reader", (int)folder, module);
  return written > 0 && written < VXM_MODULE_PATH_MAX && access(path, X_OK) == 0;
}

/** The program lies beside the module; where nothing is installed yet, libtool has put modules into .libs. */
static vxm_status find_program(char path[VXM_MODULE_PATH_MAX], const char *module, vxm_error *error) {
  static const char hidden[] = "/.libs";
  const char *slash = strrchr(module, '/');
  size_t folder = slash ? (size_t)(slash - module) : 0;
  if (is_program(path, module, folder))
    return VXM_OK;
  size_t length = sizeof hidden - 1;
  if (folder > length && memcmp(module + folder - length, hidden, length) == 0 &&
      is_program(path, module, folder - length))
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                  "the program voxmend-reader is not beside %s: install them together", module);
}

/* ---- Limits ---- */

/** How much finer than usual the triangles are to be. */
static double fineness(const vxm_reader_request *request) {
  return request->deflection < VXM_DEFLECTION_DEFAULT ? VXM_DEFLECTION_DEFAULT / request->deflection : 1.0;
}

/**
 * Libraries take 20 to 60 bytes for each of a sound file, up to 1000 where it is packed or asks for
 * subdivision, and all there are for some that are damaged.
 */
static uint64_t allowed_bytes(const vxm_context *context, const vxm_reader_request *request) {
  enum { BASE = 512 << 20, RATE = 256 };
  size_t left = vxm_memory_left(context);
  if (left < SIZE_MAX)
    return left / 2;
  double bytes = (BASE + (double)request->size * RATE) * fineness(request);
  double machine = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 4 * 3;
  return (uint64_t)(machine > 0 && machine < bytes ? machine : bytes < 1e15 ? bytes : 1e15);
}

/** A minute, one more for every MiB. */
static uint64_t allowed_seconds(const vxm_reader_request *request) {
  enum { MINUTE = 60, PIECE = 1 << 20 };
  double seconds = MINUTE * (1.0 + (double)request->size / PIECE) * fineness(request);
  return seconds < 1e6 ? (uint64_t)seconds : 1000000;
}

/* ---- Reading ---- */

static vxm_status start(vxm_process *reader, vxm_context *context, const char *program, const char *module,
                        const vxm_reader_request *request, vxm_error *error) {
  char deflection[40], memory[24], seconds[24];
  snprintf(deflection, sizeof deflection, "%a", request->deflection);
  snprintf(memory, sizeof memory, "%" PRIu64, allowed_bytes(context, request));
  snprintf(seconds, sizeof seconds, "%" PRIu64, allowed_seconds(request));
  const char *arguments[VXM_APART_ARGUMENTS + 1] = {
      [VXM_APART_PROGRAM] = "voxmend-reader",
      [VXM_APART_MODULE] = module,
      [VXM_APART_NAME] = request->name,
      [VXM_APART_BESIDE] = request->is_beside ? "1" : "0",
      [VXM_APART_HINT] = request->hint,
      [VXM_APART_DEFLECTION] = deflection,
      [VXM_APART_MEMORY] = memory,
      [VXM_APART_SECONDS] = seconds,
  };
  /* posix_spawn takes writable strings for history's sake, and leaves them alone. */
  return vxm_process_start(reader, context, "reading", program, (char *const *)(uintptr_t)arguments, error);
}

/** What became of a program that has gone without an answer. */
static vxm_status explain_end(int status, const vxm_reader_request *request, vxm_error *error) {
  vxm_place place = {request->name, 0, -1, -1};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return vxm_fail_at(error, VXM_ERROR_RANGE, place,
                       "reading took more than %" PRIu64
                       " s of computing: the file is damaged, or needs a larger deflection",
                       allowed_seconds(request));
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return vxm_fail_at(error, VXM_ERROR_MEMORY, place,
                       "the system ended the program that reads it, probably for want of memory");
  if (WIFSIGNALED(status))
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, place,
        "the library that reads .%.32s files crashed (signal %d): the file is probably damaged",
        request->hint, WTERMSIG(status));
  return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, place,
                     "the program voxmend-reader ended without an answer (status %d): is it of this version?",
                     WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

vxm_status vxm_read_apart(vxm_soup *soup, const vxm_module_need *need, const vxm_reader_request *request,
                          vxm_error *error) {
  char module[VXM_MODULE_PATH_MAX], program[VXM_MODULE_PATH_MAX];
  vxm_process reader;
  vxm_status status = vxm_module_find(module, need, error);
  if (status == VXM_OK)
    status = find_program(program, module, error);
  if (status == VXM_OK)
    status = start(&reader, soup->context, program, module, request, error);
  if (status != VXM_OK)
    return status;
  status = vxm_process_send(&reader, request->data, request->size, error);
  vxm_process_sent(&reader);
  /* A reader that is gone may have left the reason. */
  if (status == VXM_OK || status == VXM_ERROR_IO)
    status = vxm_parcel_receive(soup, &reader, error);
  int end = vxm_process_end(&reader);
  return status == VXM_ERROR_IO ? explain_end(end, request, error) : status;
}
