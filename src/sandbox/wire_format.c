/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/wire_format.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "sandbox/wire_appearance.h"
#include "sandbox/wire_message.h"

/** Ahead of the arrays of a soup, which follow in the order of these counts. */
typedef struct soup_counts {
  uint64_t vertices, faces, corners;
  uint64_t tags, tag_bytes; /**< each name ends with a zero byte */
  uint64_t warnings;
} soup_counts;

/* ---- Sending ---- */

bool vxm_wire_send_progress(int channel, double fraction) {
  return vxm_message_send_kind(channel, VXM_MESSAGE_PROGRESS) &&
         vxm_message_send(channel, &fraction, sizeof fraction);
}

bool vxm_wire_send_failure(int channel, const vxm_error *error) {
  return vxm_message_send_kind(channel, VXM_MESSAGE_FAILURE) &&
         vxm_message_send(channel, error, sizeof *error);
}

bool vxm_wire_send_warning(int channel, const char *text) {
  char line[VXM_WARNING_LENGTH] = "";
  strncpy(line, text, sizeof line - 1);
  return vxm_message_send_kind(channel, VXM_MESSAGE_WARNING) && vxm_message_send(channel, line, sizeof line);
}

bool vxm_wire_send_attempt(int channel, int64_t call) {
  return vxm_message_send_kind(channel, VXM_MESSAGE_ATTEMPT) && vxm_message_send(channel, &call, sizeof call);
}

bool vxm_wire_get(int channel, void *data, size_t size) {
  char *at = data;
  while (size > 0) {
    ssize_t got = read(channel, at, size);
    if (got < 0 && errno == EINTR)
      continue;
    if (got <= 0)
      return false;
    at += got;
    size -= (size_t)got;
  }
  return true;
}

bool vxm_wire_ask(int channel, const char *name) {
  uint64_t length = strlen(name);
  return vxm_message_send_kind(channel, VXM_MESSAGE_REFERENCE) &&
         vxm_message_send(channel, &length, sizeof length) && vxm_message_send(channel, name, length);
}

bool vxm_wire_send_soup(int channel, const vxm_soup *soup) {
  soup_counts counts = {.vertices = soup->vertex_count,
                        .faces = soup->face_count,
                        .corners = soup->corner_count,
                        .tags = soup->tag_count,
                        .warnings = (uint64_t)soup->warnings.count};
  for (size_t t = 0; t < soup->tag_count; t++)
    counts.tag_bytes += strlen(soup->tags[t]) + 1;
  if (!vxm_message_send_kind(channel, VXM_MESSAGE_SOUP) ||
      !vxm_message_send(channel, &counts, sizeof counts) ||
      !vxm_message_send(channel, soup->positions, 3 * soup->vertex_count * sizeof *soup->positions) ||
      !vxm_message_send(channel, soup->offsets, (soup->face_count + 1) * sizeof *soup->offsets) ||
      !vxm_message_send(channel, soup->indices, soup->corner_count * sizeof *soup->indices))
    return false;
  if (soup->tag_count > 0 &&
      !vxm_message_send(channel, soup->face_tags, soup->face_count * sizeof *soup->face_tags))
    return false;
  for (size_t t = 0; t < soup->tag_count; t++)
    if (!vxm_message_send(channel, soup->tags[t], strlen(soup->tags[t]) + 1))
      return false;
  if (!vxm_message_send(channel, soup->warnings.text, counts.warnings * sizeof *soup->warnings.text))
    return false;
  return !soup->appearance || vxm_wire_send_appearance(channel, soup->appearance);
}

/* ---- Receiving ---- */

vxm_status vxm_wire_send_size(vxm_process *receiver, uint64_t size, vxm_error *error) {
  return vxm_process_send(receiver, &size, sizeof size, error);
}

static vxm_status receive_failure(vxm_process *sender, vxm_error *error) {
  vxm_error sent = VXM_ERROR_INIT;
  vxm_status status = vxm_process_receive(sender, &sent, sizeof sent, error);
  if (status != VXM_OK)
    return status;
  vxm_message_sanitize(sent.text, sizeof sent.text);
  vxm_message_sanitize(sent.file, sizeof sent.file);
  if (sent.code <= VXM_OK || sent.code > VXM_ERROR_CANCELLED || !sent.text[0])
    return vxm_message_damaged(error);
  vxm_error_pass(error, &sent);
  return sent.code;
}

static vxm_status receive_arrays(vxm_soup *soup, vxm_process *sender, const soup_counts *counts,
                                 vxm_error *error) {
  vxm_status status =
      vxm_soup_reserve(soup, (size_t)counts->vertices, (size_t)counts->faces, (size_t)counts->corners, error);
  if (status == VXM_OK)
    status = vxm_process_receive(sender, soup->positions,
                                 3 * (size_t)counts->vertices * sizeof *soup->positions, error);
  if (status == VXM_OK)
    status = vxm_process_receive(sender, soup->offsets, ((size_t)counts->faces + 1) * sizeof *soup->offsets,
                                 error);
  if (status == VXM_OK)
    status =
        vxm_process_receive(sender, soup->indices, (size_t)counts->corners * sizeof *soup->indices, error);
  if (status != VXM_OK)
    return status;
  bool good = soup->offsets[0] == 0 && soup->offsets[counts->faces] == counts->corners;
  for (uint64_t f = 0; f < counts->faces; f++)
    good &= soup->offsets[f] <= soup->offsets[f + 1] && soup->offsets[f + 1] - soup->offsets[f] >= 3;
  for (uint64_t c = 0; c < counts->corners; c++)
    good &= soup->indices[c] < counts->vertices;
  if (!good) {
    soup->offsets[0] = 0;
    return vxm_message_damaged(error);
  }
  soup->vertex_count = (size_t)counts->vertices;
  soup->face_count = (size_t)counts->faces;
  soup->corner_count = (size_t)counts->corners;
  return VXM_OK;
}

/** Adds the names in a block of `size` bytes, the last of which is zero. */
static vxm_status take_names(vxm_soup *soup, const char *names, const soup_counts *counts, vxm_error *error) {
  vxm_status status = VXM_OK;
  const char *end = names + counts->tag_bytes;
  for (uint64_t t = 0; t < counts->tags && status == VXM_OK; t++) {
    if (names == end)
      return vxm_message_damaged(error);
    size_t length = strlen(names);
    uint32_t tag;
    status = vxm_soup_add_tag(soup, names, length, &tag, error);
    names += length + 1;
  }
  return status == VXM_OK && names != end ? vxm_message_damaged(error) : status;
}

static vxm_status receive_tags(vxm_soup *soup, vxm_process *sender, const soup_counts *counts,
                               vxm_error *error) {
  if (counts->tags == 0)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  soup->face_tags = vxm_alloc(soup->context, (size_t)counts->faces, sizeof *soup->face_tags, &local);
  char *names = vxm_alloc(soup->context, (size_t)counts->tag_bytes, 1, &local);
  vxm_status status = soup->face_tags && names ? VXM_OK : local.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  if (status == VXM_OK)
    status =
        vxm_process_receive(sender, soup->face_tags, (size_t)counts->faces * sizeof *soup->face_tags, error);
  if (status == VXM_OK)
    status = vxm_process_receive(sender, names, (size_t)counts->tag_bytes, error);
  bool good = status == VXM_OK && counts->tag_bytes >= counts->tags && names[counts->tag_bytes - 1] == '\0';
  for (uint64_t f = 0; good && f < counts->faces; f++)
    good = soup->face_tags[f] < counts->tags;
  if (status == VXM_OK)
    status = good ? take_names(soup, names, counts, error) : vxm_message_damaged(error);
  vxm_free(soup->context, names);
  return status;
}

static vxm_status receive_soup(vxm_soup *soup, vxm_process *sender, vxm_error *error) {
  soup_counts counts;
  vxm_status status = vxm_process_receive(sender, &counts, sizeof counts, error);
  if (status != VXM_OK)
    return status;
  /* What no memory holds is not asked for either, so that products of sizes stay in range. */
  const uint64_t most = UINT64_C(1) << 40;
  if (counts.vertices > VXM_VERTICES_MAX || counts.faces > most || counts.corners > most ||
      counts.tags > UINT32_MAX || counts.tag_bytes > most || counts.warnings > VXM_WARNINGS_MAX)
    return vxm_message_damaged(error);
  status = receive_arrays(soup, sender, &counts, error);
  if (status == VXM_OK)
    status = receive_tags(soup, sender, &counts, error);
  if (status == VXM_OK)
    status = vxm_process_receive(sender, soup->warnings.text,
                                 (size_t)counts.warnings * sizeof *soup->warnings.text, error);
  for (uint64_t n = 0; status == VXM_OK && n < counts.warnings; n++)
    if (soup->warnings.text[n][0])
      vxm_message_sanitize(soup->warnings.text[n], sizeof soup->warnings.text[n]);
    else
      status = vxm_message_damaged(error);
  if (status == VXM_OK)
    soup->warnings.count = (int)counts.warnings;
  if (status == VXM_OK && soup->appearance)
    status = vxm_wire_receive_appearance(soup, sender, error);
  return status;
}

static vxm_status receive_progress(vxm_process *sender, vxm_error *error) {
  double fraction;
  vxm_status status = vxm_process_receive(sender, &fraction, sizeof fraction, error);
  if (status == VXM_OK && isfinite(fraction))
    sender->fraction = fraction < 0 ? 0 : fraction > 1 ? 1 : fraction;
  return status;
}

static vxm_status receive_reference(vxm_process *sender, vxm_wire_listener *listener, vxm_error *error) {
  char name[VXM_WIRE_NAME_MAX + 1];
  uint64_t length;
  vxm_status status = vxm_process_receive(sender, &length, sizeof length, error);
  if (status == VXM_OK && length > VXM_WIRE_NAME_MAX)
    status = vxm_message_damaged(error);
  if (status == VXM_OK)
    status = vxm_process_receive(sender, name, (size_t)length, error);
  if (status != VXM_OK)
    return status;
  name[length] = '\0';
  if (strlen(name) != length)
    return vxm_message_damaged(error);
  return listener->answer(listener->payload, sender, name, error);
}

static vxm_status receive_warning(vxm_process *sender, vxm_wire_listener *listener, vxm_error *error) {
  char line[VXM_WARNING_LENGTH];
  vxm_status status = vxm_process_receive(sender, line, sizeof line, error);
  if (status != VXM_OK)
    return status;
  line[sizeof line - 1] = '\0';
  if (line[0] == '\0')
    return vxm_message_damaged(error);
  vxm_warn(&listener->warnings, "%s", line);
  return VXM_OK;
}

static vxm_status receive_attempt(vxm_process *sender, vxm_wire_listener *listener, vxm_error *error) {
  int64_t call;
  vxm_status status = vxm_process_receive(sender, &call, sizeof call, error);
  if (status == VXM_OK)
    listener->attempt = call < 0 ? 0 : call;
  return status == VXM_OK ? VXM_ERROR_IO : status;
}

/** A message after which others may come. */
static vxm_status receive_between(uint64_t kind, vxm_process *sender, vxm_wire_listener *listener,
                                  vxm_wire_arrival *arrival, vxm_error *error) {
  switch (kind) {
  case VXM_MESSAGE_PROGRESS:
    return receive_progress(sender, error);
  case VXM_MESSAGE_REFERENCE:
    return listener->answer ? receive_reference(sender, listener, error) : vxm_message_damaged(error);
  case VXM_MESSAGE_WARNING:
    return receive_warning(sender, listener, error);
  default:
    return listener->sink ? vxm_wire_receive_voxels(listener->sink, arrival, kind, sender, error)
                          : vxm_message_damaged(error);
  }
}

vxm_status vxm_wire_receive(vxm_process *sender, vxm_wire_listener *listener, vxm_error *error) {
  vxm_wire_arrival arrival = {.has_grid = false};
  listener->has_failed = false;
  listener->attempt = -1;
  listener->warnings.count = 0;
  for (;;) {
    uint64_t kind;
    vxm_status status = vxm_process_receive(sender, &kind, sizeof kind, error);
    if (status != VXM_OK)
      return status;
    if (kind == VXM_MESSAGE_ATTEMPT)
      return receive_attempt(sender, listener, error);
    if (kind == VXM_MESSAGE_FAILURE) {
      listener->has_failed = true;
      return receive_failure(sender, error);
    }
    if (kind == VXM_MESSAGE_SOUP && listener->soup)
      return receive_soup(listener->soup, sender, error);
    status = receive_between(kind, sender, listener, &arrival, error);
    if (status != VXM_OK || arrival.is_whole || (listener->sink && listener->sink->is_full))
      return status;
  }
}
