/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/archive.h"
#include "batch/descriptor.h"
#include "batch/unpack.h"
#include "config.h"
#include "module_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static bool ends_with(const char *name, const char *end) {
  size_t a = strlen(name), b = strlen(end);
  return a > b && strcasecmp(name + a - b, end) == 0;
}

bool batch_is_archive(const char *name) {
  static const char *const ends[] = {".tar",  ".tar.gz",  ".tgz",  ".tar.xz", ".txz", ".tar.bz2",
                                     ".tbz2", ".tar.zst", ".tzst", ".zip",    ".7z"};
  for (size_t e = 0; e < sizeof ends / sizeof *ends; e++)
    if (ends_with(name, ends[e]))
      return true;
  return false;
}

/* ---- The process ---- */

enum { PATH_BYTES = 4096 };

/** "FOLDER/voxmend-unpack", if there is such a program. */
static bool found_in(char path[PATH_BYTES], const char *folder, size_t length) {
  int written = snprintf(path, PATH_BYTES, "%.*s/voxmend-unpack", (int)length, folder);
  return length > 0 && written > 0 && written < PATH_BYTES && access(path, X_OK) == 0;
}

/** Where modules are told to be, else beside this program, else, but for a wheel's, where they are installed.
 */
static bool find_program(char path[PATH_BYTES]) {
  const char *chosen = secure_getenv("VOXMEND_MODULES");
  char self[PATH_BYTES];
  ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  if (chosen && found_in(path, chosen, strlen(chosen)))
    return true;
  for (int above = 0; above < 2 && length > 0;
       above++) { /* libtool's programs lie a folder below the built ones */
    self[length] = '\0';
    char *slash = strrchr(self, '/');
    length = slash ? slash - self : 0;
    if (length > 0 && found_in(path, self, (size_t)length))
      return true;
  }
  return !VXM_WHEEL && found_in(path, VXM_MODULE_DIR, strlen(VXM_MODULE_DIR));
}

_Noreturn static void be_unpacker(const char *program, const char *path, uint64_t most, int channel) {
  char number[32];
  snprintf(number, sizeof number, "%" PRIu64, most);
  setpgid(0, 0); /* the terminal's signals are not for it */
  if (dup2(channel, BATCH_UNPACK_CHANNEL) >= 0) {
    if (channel == BATCH_UNPACK_CHANNEL)
      fcntl(channel, F_SETFD, 0);
    else
      close(channel);
    execl(program, "voxmend-unpack", path, number, (char *)NULL);
  }
  _exit(127);
}

bool batch_unpacker_start(batch_unpacker *out, const char *path, uint64_t most, batch_error *error) {
  int ends[2];
  char program[PATH_BYTES];
  *out = (batch_unpacker){.channel = -1};
  if (!find_program(program))
    return batch_fail(
        error, "%s: archives need the program voxmend-unpack, which is not %s; or unpack it first", path,
        VXM_WHEEL ? "in this wheel, as libarchive was not there when it was built"
                  : "installed (configure --with-archive; Debian: libarchive-dev)");
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return batch_fail_errno(error, "%s: cannot open a channel to a process", path);
  pid_t parent = getpid(), id = fork();
  if (id == 0) {
    close(ends[0]);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent)
      be_unpacker(program, path, most, ends[1]);
    _exit(0);
  }
  close(ends[1]);
  if (id < 0) {
    close(ends[0]);
    return batch_fail_errno(error, "%s: cannot start a process", path);
  }
  *out = (batch_unpacker){id, ends[0]};
  return true;
}

int batch_unpacker_next(batch_unpacker *unpacker, batch_member *out, batch_error *error) {
  static batch_unpacked head;
  batch_descriptor_room room;
  struct iovec part = {&head, sizeof head};
  struct msghdr message = {
      .msg_iov = &part, .msg_iovlen = 1, .msg_control = &room, .msg_controllen = sizeof room.bytes};
  ssize_t got;
  do
    got = recvmsg(unpacker->channel, &message, MSG_CMSG_CLOEXEC);
  while (got < 0 &&
         (errno == EINTR || errno == ECONNRESET)); /* reset: it ended before it heard us; its words stay */
  if (got != (ssize_t)sizeof head) {               /* neither a member nor word of its end */
    batch_fail(error, "the process that reads the archive was ended");
    return -2;
  }
  head.name[sizeof head.name - 1] = head.target[sizeof head.target - 1] = '\0';
  head.problem[sizeof head.problem - 1] = '\0';
  if (head.is_end && head.problem[0])
    batch_fail(error, "%s", head.problem);
  if (head.is_end)
    return head.problem[0] ? -1 : 0;
  send(unpacker->channel, "", 1, MSG_NOSIGNAL); /* the next may be unpacked */
  *out = (batch_member){.bytes = head.bytes,
                        .kind = head.kind,
                        .place = head.place,
                        .descriptor = batch_descriptor_take(&message)};
  memcpy(out->name, head.name, sizeof out->name);
  memcpy(out->target, head.target, sizeof out->target);
  memcpy(out->problem, head.problem, sizeof out->problem);
  return 1;
}

void batch_unpacker_end(batch_unpacker *unpacker) {
  if (unpacker->channel >= 0)
    close(unpacker->channel);
  if (unpacker->id > 0)
    kill(unpacker->id, SIGKILL);
  while (unpacker->id > 0 && waitpid(unpacker->id, NULL, 0) < 0 && errno == EINTR) {
  }
  *unpacker = (batch_unpacker){.channel = -1};
}
