/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * voxmend-unpack ARCHIVE MOST: hands over the meshes of an archive (batch/archive.h). It is a program of its
 * own, as libarchive brings so many libraries with it that the others would start later for it.
 */
#include "batch/descriptor.h"
#include "batch/unpack.h"

#include <archive.h>
#include <archive_entry.h>
#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

static bool send_over(int channel, const batch_unpacked *head, int descriptor) {
  struct iovec part = {(void *)(uintptr_t)head, sizeof *head};
  struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
  batch_descriptor_room room;
  batch_descriptor_attach(&message, &room, descriptor);
  ssize_t sent;
  do
    sent = sendmsg(channel, &message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent >= 0;
}

/** Copies the bytes of a member into a file in memory; -1 and a problem where they cannot be had. */
static int take_bytes(struct archive *archive, batch_unpacked *head, uint64_t most) {
  int file = memfd_create("voxmend-member", MFD_CLOEXEC);
  const void *block;
  size_t size;
  la_int64_t offset;
  int got = ARCHIVE_OK;
  head->bytes = 0;
  while (file >= 0 && (got = archive_read_data_block(archive, &block, &size, &offset)) == ARCHIVE_OK) {
    uint64_t end = offset < 0 ? UINT64_MAX : (uint64_t)offset + size;
    if (end > most) {
      snprintf(head->problem, sizeof head->problem,
               "it unpacks to more than the %" PRIu64 " bytes that it may take: see --memlimit", most);
      break;
    }
    if (pwrite(file, block, size, offset) != (ssize_t)size) {
      snprintf(head->problem, sizeof head->problem, "cannot unpack it: %s", strerror(errno));
      break;
    }
    head->bytes = end > head->bytes ? end : head->bytes;
  }
  if (file >= 0 && got < ARCHIVE_WARN)
    snprintf(head->problem, sizeof head->problem, "cannot unpack it: %s", archive_error_string(archive));
  if (file < 0)
    snprintf(head->problem, sizeof head->problem, "cannot unpack it: %s", strerror(errno));
  if (file >= 0 && head->problem[0]) {
    close(file);
    return -1;
  }
  return file;
}

/** So few members are in memory at a time: waits until one more has been taken. */
static bool wait_for_taker(int channel) {
  enum { AHEAD = 2 };
  static int ahead;
  char word;
  ssize_t got = 1;
  if (++ahead <= AHEAD)
    return true;
  ahead--;
  do
    got = recv(channel, &word, 1, 0);
  while (got < 0 && errno == EINTR);
  return got == 1;
}

static void take_name(char out[BATCH_MEMBER_MAX], const char *name) {
  strcpy(out, name && strlen(name) < BATCH_MEMBER_MAX ? name : "a name that cannot be read");
}

static batch_member_kind kind_of(struct archive_entry *entry) {
  return archive_entry_hardlink(entry)               ? BATCH_MEMBER_LINK
         : archive_entry_filetype(entry) == AE_IFREG ? BATCH_MEMBER_FILE
                                                     : BATCH_MEMBER_OTHER;
}

/** Of links and the like it is told that they are there; their bytes are another member's, or none. */
static bool hand_over(struct archive *archive, struct archive_entry *entry, int64_t place, uint64_t most,
                      int channel) {
  static batch_unpacked head;
  head = (batch_unpacked){.place = place, .kind = kind_of(entry)};
  bool is_folder = head.kind == BATCH_MEMBER_OTHER && archive_entry_filetype(entry) == AE_IFDIR;
  if (is_folder || (most > 0 && head.kind != BATCH_MEMBER_FILE))
    return true;
  take_name(head.name, archive_entry_pathname(entry));
  if (head.kind == BATCH_MEMBER_LINK)
    take_name(head.target, archive_entry_hardlink(entry));
  head.bytes = archive_entry_size_is_set(entry) && archive_entry_size(entry) > 0
                   ? (uint64_t)archive_entry_size(entry)
                   : 0;
  if (!wait_for_taker(channel))
    return false;
  int bytes = most > 0 ? take_bytes(archive, &head, most) : -1;
  bool good = send_over(channel, &head, bytes);
  if (bytes >= 0)
    close(bytes);
  return good;
}

static void unpack(const char *path, uint64_t most, int channel) {
  enum { BLOCK = 1 << 16 };
  batch_unpacked end = {.is_end = true};
  struct archive *archive = archive_read_new();
  struct archive_entry *entry;
  int got = ARCHIVE_FATAL;
  if (archive) {
    archive_read_support_filter_all(archive);
    archive_read_support_format_tar(archive);
    archive_read_support_format_zip(archive);
    archive_read_support_format_7zip(archive);
    got = archive_read_open_filename(archive, path, BLOCK);
  }
  if (got == ARCHIVE_OK)
    for (int64_t place = 0;
         (got = archive_read_next_header(archive, &entry)) >= ARCHIVE_WARN && got != ARCHIVE_EOF; place++)
      if (!hand_over(archive, entry, place, most, channel))
        return;
  if (got != ARCHIVE_EOF)
    snprintf(end.problem, sizeof end.problem, "the archive is damaged: %s",
             archive && archive_error_string(archive) ? archive_error_string(archive) : "out of memory");
  send_over(channel, &end, -1);
  archive_read_free(archive);
}

int main(int argc, char **argv) {
  uint64_t most = 0;
  setlocale(LC_CTYPE, "C.UTF-8"); /* of names of members */
  if (argc != 3 || sscanf(argv[2], "%" SCNu64, &most) != 1)
    return 2;
  unpack(argv[1], most, BATCH_UNPACK_CHANNEL);
  return 0;
}
