/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * voxmend-reader: reads one file through a module, for a process that must outlive it (reader_process.h). The
 * file comes over standard input, which is a socket, and the soup or the grid goes back over it. Before it
 * looks at the file it gives up all that reading does not take (confine.h).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/context.h"
#include "sandbox/alloc_failure.h"
#include "sandbox/confine.h"
#include "sandbox/memory_name.h"
#include "sandbox/reader_process.h"
#include "sandbox/wire_format.h"

enum { CHANNEL = STDIN_FILENO, WRONG_CALL = 2, GONE = 1 };

static int tell(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)payload;
  return !vxm_wire_send_progress(CHANNEL, fraction);
}

static vxm_status cut_off(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_IO, "the process that asked has gone");
}

/** Takes so many bytes from the channel. */
static vxm_status take(unsigned char **out, vxm_context *context, uint64_t size, vxm_error *error) {
  unsigned char *data = vxm_alloc(context, (size_t)size, 1, error);
  if (data == NULL)
    return error->code;
  if (!vxm_wire_get(CHANNEL, data, (size_t)size)) {
    vxm_free(context, data);
    return cut_off(error);
  }
  *out = data;
  return VXM_OK;
}

/** Without memory for it there is nothing to do but to end: its bytes would come as an answer to something
 * else. */
static bool fetch(void *payload, vxm_context *context, const char *name, vxm_reader_file *out) {
  vxm_error *failure = payload;
  uint64_t size;
  if (failure->code != VXM_OK || strlen(name) > VXM_WIRE_NAME_MAX)
    return false;
  if (!vxm_wire_ask(CHANNEL, name) || !vxm_wire_get(CHANNEL, &size, sizeof size)) {
    cut_off(failure);
    return false;
  }
  if (size == VXM_WIRE_REFUSED || take(&out->data, context, size, failure) != VXM_OK)
    return false;
  out->size = (size_t)size;
  return true;
}

static vxm_status send_mesh(vxm_context *context, const vxm_reader *reader, const vxm_reader_request *request,
                            bool has_look, vxm_error *error) {
  vxm_soup *soup;
  vxm_status status = vxm_soup_create(&soup, context, "", error);
  if (status != VXM_OK)
    return status;
  if (has_look)
    status = vxm_appearance_create(&soup->appearance, context, error);
  if (status == VXM_OK)
    status = reader->read(soup, request, error);
  if (status == VXM_OK && has_look)
    status = vxm_appearance_settle(soup->appearance, soup->vertex_count, soup->face_count, error);
  const vxm_error *unfetched = request->payload;
  if (unfetched->code != VXM_OK) {
    *error = *unfetched;
    status = error->code;
  }
  if (status == VXM_OK && !vxm_wire_send_soup(CHANNEL, soup))
    status = cut_off(error);
  vxm_soup_destroy(soup);
  return status;
}

static vxm_status send_grid(vxm_context *context, const vxm_reader *reader, const vxm_reader_request *request,
                            vxm_error *error) {
  static vxm_wire_sender sender = {.channel = CHANNEL};
  vxm_voxel_sink sink = vxm_wire_sink(&sender);
  vxm_status status = reader->read_grid(&sink, context, request, error);
  return status == VXM_OK && !vxm_wire_send_end(&sender) ? cut_off(error) : status;
}

/** Libraries may make something of the file all the same, and leave out what there was no memory for: they
 * get no turn any more, not even at the end of the program. */
static void end_starved(void) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_fail(&error, VXM_ERROR_MEMORY, "not enough memory to read the file");
  vxm_wire_send_failure(CHANNEL, &error);
  syscall(SYS_exit_group, 0);
}

static uint64_t number(char **arguments, int which) {
  return strtoull(arguments[which], NULL, 10);
}

/** A double by its bits. */
static double real(char **arguments, int which) {
  const uint64_t bits = number(arguments, which);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static vxm_status read_file(vxm_context *context, const vxm_reader *reader, char **arguments,
                            vxm_error *error) {
  unsigned char *data;
  uint64_t size;
  vxm_error unfetched = VXM_ERROR_INIT;
  vxm_status status =
      vxm_wire_get(CHANNEL, &size, sizeof size) ? take(&data, context, size, error) : cut_off(error);
  if (status != VXM_OK)
    return status;
  vxm_memory_name(data, (size_t)size);
  vxm_reader_request request = {.data = data,
                                .size = (size_t)size,
                                .name = arguments[VXM_READER_ARG_NAME],
                                .hint = arguments[VXM_READER_ARG_HINT],
                                .deflection = real(arguments, VXM_READER_ARG_DEFLECTION),
                                .path = VXM_MEMORY_NAME,
                                .fetch = fetch,
                                .payload = &unfetched};
  bool has_look = strcmp(arguments[VXM_READER_ARG_LOOK], "1") == 0;
  status = reader->read ? send_mesh(context, reader, &request, has_look, error)
                        : send_grid(context, reader, &request, error);
  vxm_free(context, data);
  return status;
}

static vxm_status serve(vxm_context *context, char **arguments, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_load(&module, arguments[VXM_READER_ARG_MODULE], "reading this file", error);
  if (status != VXM_OK)
    return status;
  const vxm_reader *reader = module->functions;
  const vxm_confinement confinement = {.channel = CHANNEL,
                                       .memory = number(arguments, VXM_READER_ARG_MEMORY),
                                       .memory_max = number(arguments, VXM_READER_ARG_MEMORY_MAX),
                                       .seconds = number(arguments, VXM_READER_ARG_SECONDS)};
  reader->prepare();
  const char *missing = vxm_confine(&confinement);
  vxm_alloc_failure_ends(end_starved);
  if (missing) {
    vxm_warnings warnings = {.count = 0};
    vxm_warn(&warnings, "the reader could not be confined as usual: %s", missing);
    vxm_wire_send_warning(CHANNEL, warnings.text[0]);
  }
  return read_file(context, reader, arguments, error);
}

int main(int argc, char **argv) {
  if (argc != VXM_READER_ARGS)
    return WRONG_CALL;
  if (!vxm_confine_early((pid_t)number(argv, VXM_READER_ARG_PARENT)))
    return GONE;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 1;
  options.progress = tell;
  vxm_context *context = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_context_create(&context, &options, &error);
  if (status == VXM_OK)
    status = serve(context, argv, &error);
  bool sent = status == VXM_OK || vxm_wire_send_failure(CHANNEL, &error);
  vxm_context_destroy(context);
  return sent ? 0 : GONE;
}
