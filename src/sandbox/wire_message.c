/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/wire_message.h"

#include <errno.h>
#include <unistd.h>

bool vxm_message_send(int channel, const void *data, size_t size) {
  const char *at = data;
  while (size > 0) {
    ssize_t written = write(channel, at, size);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      return false;
    at += written;
    size -= (size_t)written;
  }
  return true;
}

bool vxm_message_send_kind(int channel, vxm_message_kind kind) {
  uint64_t word = (uint64_t)kind;
  return vxm_message_send(channel, &word, sizeof word);
}

vxm_status vxm_message_damaged(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_FORMAT, "what the reading process sent is damaged");
}

void vxm_message_sanitize(char *text, size_t size) {
  text[size - 1] = '\0';
  vxm_make_printable(text);
}
