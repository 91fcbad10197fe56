/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * voxmend-reader: reads one mesh file through a module, for a process that must outlive it (apart.h). The
 * file comes over standard input, which is a socket, and the soup goes back over it.
 */
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <signal.h>
#include <stdio.h>

#include "base/file.h"
#include "base/size_text.h"
#include "meshio/apart.h"
#include "meshio/parcel.h"

enum { CHANNEL = STDIN_FILENO, WRONG_CALL = 2, GONE = 1 };

static int tell(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)payload;
  return !vxm_parcel_send_progress(CHANNEL, fraction);
}

/** Bytes of private writable memory, of which the limit is one; 0 if they are not known. */
static rlim_t held_bytes(void) {
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file == NULL)
    return 0;
  if (fscanf(file, "%*s %*s %*s %*s %*s %lu", &pages) != 1)
    pages = 0;
  fclose(file);
  return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

static void limit(unsigned resource, rlim_t value) {
  struct rlimit both;
  if (getrlimit(resource, &both) != 0)
    return;
  if (value < both.rlim_cur) {
    both.rlim_cur = value;
    setrlimit(resource, &both);
  }
}

/** No file but the channel, no core dump, and an end together with the process that asked. */
static void settle_down(void) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  closefrom(STDERR_FILENO + 1);
  limit(RLIMIT_CORE, 0);
}

static vxm_status read_file(vxm_soup *soup, const vxm_module *module, char **arguments, vxm_error *error) {
  vxm_input input;
  vxm_status status = vxm_input_open(&input, soup->context, "-", error);
  if (status != VXM_OK)
    return status;
  vxm_reader_request request = {.data = input.data,
                                .size = input.size,
                                .name = arguments[VXM_APART_NAME],
                                .is_beside = strcmp(arguments[VXM_APART_BESIDE], "1") == 0,
                                .hint = arguments[VXM_APART_HINT],
                                .deflection = strtod(arguments[VXM_APART_DEFLECTION], NULL)};
  const vxm_reader *reader = module->functions;
  status = reader->read(soup, &request, error);
  vxm_input_close(&input);
  return status;
}

/** A lack of memory is that of our limit, as good as always. */
static vxm_status explain_memory(char **arguments, vxm_error *error) {
  double bytes = strtod(arguments[VXM_APART_MEMORY], NULL);
  return vxm_fail_at(error, VXM_ERROR_MEMORY_LIMIT, (vxm_place){arguments[VXM_APART_NAME], 0, -1, -1},
                     "reading takes more than %s: the file is damaged, or the memory limit must allow "
                     "more (half of it is for reading)",
                     vxm_size_text_of((uint64_t)bytes).text);
}

static vxm_status serve(vxm_soup *soup, char **arguments, vxm_error *error) {
  const vxm_module *module;
  vxm_status status = vxm_module_load(&module, arguments[VXM_APART_MODULE], "reading this file", error);
  if (status != VXM_OK)
    return status;
  limit(RLIMIT_CPU, strtoull(arguments[VXM_APART_SECONDS], NULL, 10));
  /* Only what is held from now on counts: libraries bring some megabytes with them. */
  limit(RLIMIT_DATA, held_bytes() + strtoull(arguments[VXM_APART_MEMORY], NULL, 10));
  status = read_file(soup, module, arguments, error);
  return status == VXM_ERROR_MEMORY ? explain_memory(arguments, error) : status;
}

int main(int argc, char **argv) {
  if (argc != VXM_APART_ARGUMENTS)
    return WRONG_CALL;
  settle_down();
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 1;
  options.progress = tell;
  vxm_context *context = NULL;
  vxm_soup *soup = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_context_create(&context, &options, &error);
  if (status == VXM_OK)
    status = vxm_soup_create(&soup, context, "", &error);
  if (status == VXM_OK)
    status = serve(soup, argv, &error);
  bool sent =
      status == VXM_OK ? vxm_parcel_send_soup(CHANNEL, soup) : vxm_parcel_send_failure(CHANNEL, &error);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
  return sent ? 0 : GONE;
}
