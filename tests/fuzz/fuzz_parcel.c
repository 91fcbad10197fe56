/* SPDX-License-Identifier: BSD-3-Clause */
/** Any bytes as what a reading process sends back: it may have been taken over by the file that it read. */
#include "fuzz.h"
#include "fuzz_soup.h"

#include "meshio/external/wire_format.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { MOST = 1 << 16 };

/** Bytes that the soup may take for each that is sent: none is believed before it has come. */
enum { RATE = 64, BESIDES = 1 << 20 };

/** Files are not to be had. */
static vxm_status refuse(void *payload, vxm_process *reader, const char *name, vxm_error *error) {
  (void)payload;
  (void)reader;
  (void)error;
  fuzz_require(strlen(name) <= VXM_WIRE_NAME_MAX, "a name has its length");
  return VXM_OK;
}

void fuzz_parcel(const char *name, const uint8_t *data, size_t size) {
  (void)name;
  int ends[2];
  if (size > MOST) /* more than a socket holds without a reader */
    return;
  fuzz_require(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0, "there are sockets");
  fuzz_require(send(ends[1], data, size, MSG_DONTWAIT) == (ssize_t)size || size == 0,
               "a socket holds the bytes");
  close(ends[1]);
  vxm_context *context = fuzz_context(size, RATE, BESIDES);
  vxm_process sender = {.channel = ends[0], .context = context, .phase = "reading"};
  vxm_wire_listener listener = {.answer = refuse};
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  fuzz_require(vxm_soup_create(&soup, context, "", &error) == VXM_OK, "a soup can be made");
  vxm_status status = vxm_wire_receive(soup, &sender, &listener, &error);
  if (status == VXM_OK)
    fuzz_check_soup(soup);
  else if (status != VXM_ERROR_IO) /* then the caller knows what became of the process */
    fuzz_check_error(&error, status);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
  close(ends[0]);
}
