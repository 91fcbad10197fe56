/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/reader_process.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/size_text.h"
#include "sandbox/blocked_syscall.h"
#include "sandbox/wire_format.h"

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

/** What the reading process may take, for so many bytes of files. */
typedef struct allowance {
  uint64_t memory, memory_max, seconds;
} allowance;

/** A time on the clock is for a machine that has much else to do. */
enum { CLOCK_PER_COMPUTING = 4 };

/** How much finer than usual the triangles are to be. */
static double fineness(const vxm_reader_request *request) {
  bool is_finer = request->deflection > 0 && request->deflection < VXM_DEFLECTION_DEFAULT;
  return is_finer ? VXM_DEFLECTION_DEFAULT / request->deflection : 1.0;
}

/** The machine's memory, of which a quarter is left to others. */
static double machine_bytes(void) {
  double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 4 * 3;
  return bytes > 0 ? bytes : 1e15;
}

/**
 * Libraries take 20 to 60 bytes for each of a sound file, up to 1000 where it is packed or asks for
 * subdivision, and all there are for some that are damaged. Of time they get a minute, and one more for every
 * MiB.
 */
static allowance allow(const vxm_context *context, const vxm_reader_request *request, uint64_t size) {
  enum { BASE = 512 << 20, RATE = 256, MINUTE = 60, PIECE = 1 << 20 };
  size_t left = vxm_memory_left(context);
  double finer = fineness(request), machine = machine_bytes(), bytes = (BASE + (double)size * RATE) * finer;
  double seconds = MINUTE * (1.0 + (double)size / PIECE) * finer;
  allowance result = {.memory = (uint64_t)(bytes < machine ? bytes : machine),
                      .memory_max = (uint64_t)machine,
                      .seconds = seconds < 1e6 ? (uint64_t)seconds : 1000000};
  if (left < SIZE_MAX)
    result.memory = result.memory_max = left / 2;
  return result;
}

/* ---- The conversation ---- */

typedef struct conversation {
  vxm_context *context;
  const vxm_reader_request *request;
  vxm_references *references; /**< NULL for a grid */
  bool has_look;              /**< an appearance is wanted */
  uint64_t size;              /**< of the file and all that it got */
  allowance allowed;
} conversation;

static void set_clock(vxm_process *reader, const allowance *allowed) {
  reader->limit_ms = 1000.0 * CLOCK_PER_COMPUTING * (double)allowed->seconds;
}

static vxm_status start(vxm_process *reader, const char *program, const char *module, const conversation *c,
                        vxm_error *error) {
  char parent[24], deflection[24], memory[24], memory_max[24], seconds[24];
  uint64_t bits; /* the same text in every locale */
  memcpy(&bits, &c->request->deflection, sizeof bits);
  snprintf(parent, sizeof parent, "%ld", (long)getpid());
  snprintf(deflection, sizeof deflection, "%" PRIu64, bits);
  snprintf(memory, sizeof memory, "%" PRIu64, c->allowed.memory);
  snprintf(memory_max, sizeof memory_max, "%" PRIu64, c->allowed.memory_max);
  snprintf(seconds, sizeof seconds, "%" PRIu64, c->allowed.seconds);
  const char *arguments[VXM_READER_ARGS + 1] = {
      [VXM_READER_ARG_PROGRAM] = "voxmend-reader",
      [VXM_READER_ARG_MODULE] = module,
      [VXM_READER_ARG_PARENT] = parent,
      [VXM_READER_ARG_NAME] = c->request->name,
      [VXM_READER_ARG_HINT] = c->request->hint,
      [VXM_READER_ARG_DEFLECTION] = deflection,
      [VXM_READER_ARG_LOOK] = c->has_look ? "1" : "0",
      [VXM_READER_ARG_MEMORY] = memory,
      [VXM_READER_ARG_MEMORY_MAX] = memory_max,
      [VXM_READER_ARG_SECONDS] = seconds,
  };
  /* posix_spawn takes writable strings for history's sake, and leaves them alone. */
  vxm_status status =
      vxm_process_start(reader, c->context, "reading", program, (char *const *)(uintptr_t)arguments, error);
  if (status == VXM_OK)
    set_clock(reader, &c->allowed);
  return status;
}

/** More to read is more to hold and to compute. */
static void allow_more(conversation *c, vxm_process *reader, uint64_t size) {
  c->size += size;
  allowance more = allow(c->context, c->request, c->size);
  if (more.memory > c->allowed.memory) {
    vxm_process_allow(reader, more.memory - c->allowed.memory, more.seconds - c->allowed.seconds);
    c->allowed = more;
    set_clock(reader, &c->allowed);
  }
}

/** Sends as many bytes as were announced, whatever happens to the file meanwhile. */
static vxm_status send_file(vxm_process *reader, int file, uint64_t size, vxm_error *error) {
  char piece[65536];
  vxm_status status = vxm_wire_send_size(reader, size, error);
  while (size > 0 && status == VXM_OK) {
    size_t wanted = size < sizeof piece ? (size_t)size : sizeof piece;
    ssize_t got = read(file, piece, wanted);
    if (got <= 0)
      memset(piece, 0, wanted);
    else
      wanted = (size_t)got;
    status = vxm_process_send(reader, piece, wanted, error);
    size -= wanted;
  }
  return status;
}

static vxm_status answer(void *payload, vxm_process *reader, const char *name, vxm_error *error) {
  conversation *c = payload;
  uint64_t size, largest = c->allowed.memory_max > c->size ? c->allowed.memory_max - c->size : 0;
  int file = vxm_reference_open(c->references, name, largest, &size);
  if (file < 0)
    return vxm_wire_send_size(reader, VXM_WIRE_REFUSED, error);
  allow_more(c, reader, size);
  vxm_status status = send_file(reader, file, size, error);
  close(file);
  return status;
}

/* ---- The end ---- */

static vxm_status explain_attempt(int64_t call, vxm_place place, vxm_error *error) {
  char what[80];
  vxm_blocked_syscall_describe(what, sizeof what, call);
  return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "the reader was stopped: it tried to %s", what);
}

static vxm_status explain_time(uint64_t seconds, const char *of, const conversation *c, vxm_place place,
                               vxm_error *error) {
  return vxm_fail_at(
      error, VXM_ERROR_RANGE, place, "reading took more than %" PRIu64 " s%s: the file is %s", seconds, of,
      c->request->deflection > 0 ? "damaged, or needs a larger deflection" : "probably damaged");
}

/** What became of a program that has gone without an answer. */
static vxm_status explain_end(int status, const conversation *c, bool is_late, int64_t attempt,
                              vxm_error *error) {
  vxm_place place = {c->request->name, 0, -1, -1};
  uint64_t seconds = c->allowed.seconds;
  if (attempt >= 0)
    return explain_attempt(attempt, place, error);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) /* it could not tell which call */
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place,
                       "the reader was stopped: it tried to do what a reader may not");
  if (is_late)
    return explain_time(seconds * CLOCK_PER_COMPUTING, "", c, place, error);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return explain_time(seconds, " of computing", c, place, error);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return vxm_fail_at(error, VXM_ERROR_MEMORY, place,
                       "the system ended the program that reads it, probably for want of memory");
  if (WIFSIGNALED(status))
    return vxm_fail_at(
        error, VXM_ERROR_FORMAT, place,
        "the library that reads .%.32s files crashed (signal %d): the file is probably damaged",
        c->request->hint, WTERMSIG(status));
  return vxm_fail_at(error, VXM_ERROR_UNAVAILABLE, place,
                     "the program voxmend-reader ended without an answer (status %d): is it of this version?",
                     WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

/** What the reader could not do may have a reason that only we know. */
static vxm_status explain_failure(vxm_status status, const conversation *c, vxm_error *error) {
  vxm_place place = {c->request->name, 0, -1, -1};
  if (status == VXM_ERROR_MEMORY) /* a lack of memory is that of our limit, as good as always */
    return vxm_fail_at(
        error, VXM_ERROR_MEMORY_LIMIT, place,
        "reading takes more than %.0f MiB: the file is damaged, or the memory limit must allow "
        "more (half of it is for reading)",
        (double)c->allowed.memory / (1 << 20));
  if (status == VXM_ERROR_FORMAT && c->references && c->references->refused > 0)
    return vxm_fail_at(error, status, place, "it cannot be read: %s", c->references->first);
  return status;
}

static void add_warnings(vxm_warnings *to, const vxm_warnings *from) {
  for (int n = 0; n < from->count; n++)
    vxm_warn(to, "%s", from->text[n]);
}

static vxm_status converse(vxm_process *reader, conversation *c, vxm_wire_listener *listener,
                           vxm_error *error) {
  vxm_status status = vxm_wire_send_size(reader, c->size, error);
  if (status == VXM_OK)
    status = vxm_process_send(reader, c->request->data, c->request->size, error);
  /* A reader that is gone may have left the reason. */
  if (status == VXM_OK || (status == VXM_ERROR_IO && !vxm_process_is_late(reader)))
    status = vxm_wire_receive(reader, listener, error);
  bool is_late = vxm_process_is_late(reader);
  int end = vxm_process_end(reader);
  if (status != VXM_OK && listener->has_failed)
    return explain_failure(status, c, error);
  return status == VXM_ERROR_IO ? explain_end(end, c, is_late, listener->attempt, error) : status;
}

static vxm_status run_reader(conversation *c, vxm_wire_listener *listener, const vxm_module_need *need,
                             vxm_error *error) {
  char module[VXM_MODULE_PATH_MAX], program[VXM_MODULE_PATH_MAX];
  vxm_process reader;
  c->size = c->request->size;
  c->allowed = allow(c->context, c->request, c->size);
  vxm_status status = vxm_module_find(module, need, error);
  if (status == VXM_OK)
    status = find_program(program, module, error);
  if (status == VXM_OK)
    status = start(&reader, program, module, c, error);
  return status == VXM_OK ? converse(&reader, c, listener, error) : status;
}

vxm_status vxm_reader_process_mesh(vxm_soup *soup, const vxm_module_need *need,
                                   const vxm_reader_request *request, vxm_references *references,
                                   vxm_error *error) {
  conversation c = {.context = soup->context,
                    .request = request,
                    .references = references,
                    .has_look = soup->appearance != NULL};
  vxm_wire_listener listener = {.soup = soup, .answer = answer, .payload = &c};
  vxm_status status = run_reader(&c, &listener, need, error);
  if (status != VXM_OK)
    return status;
  /* What was refused comes first: there is room for so many lines only. */
  vxm_warnings said = soup->warnings;
  soup->warnings = references->warnings;
  add_warnings(&soup->warnings, &listener.warnings);
  add_warnings(&soup->warnings, &said);
  return VXM_OK;
}

vxm_status vxm_reader_process_picture(vxm_soup **made, vxm_context *context, const char *purpose,
                                      const vxm_reader_request *request, vxm_error *error) {
  const vxm_module_need need = {"images", "libpng-dev libjpeg-dev", purpose};
  vxm_references none = VXM_REFERENCES_NONE;
  none.allowed = VXM_EXTERNAL_NONE;
  *made = NULL;
  vxm_status status = vxm_soup_create(made, context, "", error);
  if (status == VXM_OK)
    status = vxm_appearance_create(&(*made)->appearance, context, error);
  if (status == VXM_OK)
    status = vxm_reader_process_mesh(*made, &need, request, &none, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(*made);
    *made = NULL;
  }
  return status;
}

vxm_status vxm_reader_process_grid(vxm_voxel_sink *sink, vxm_warnings *warnings, vxm_context *context,
                                   const vxm_module_need *need, const vxm_reader_request *request,
                                   vxm_error *error) {
  conversation c = {.context = context, .request = request};
  vxm_wire_listener listener = {.sink = sink};
  vxm_status status = run_reader(&c, &listener, need, error);
  if (status == VXM_OK)
    add_warnings(warnings, &listener.warnings);
  return status;
}
