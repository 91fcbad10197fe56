/* SPDX-License-Identifier: BSD-3-Clause */
/** The program's side: starting the zygote, and the messages that go over. */
#include "batch/descriptor.h"
#include "batch/zygote_loop.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/** What the program has open is not for it: whoever inherits the journal holds its lock, and may outlive us.
 */
static void close_all_but(int channel) {
  enum { FIRST = 3 };
  if (channel > FIRST)
    close_range(FIRST, (unsigned)channel - 1, 0);
  close_range((unsigned)channel + 1, ~0U, 0);
}

bool batch_zygote_start(batch_zygote *out, batch_work *work, void *payload, batch_error *error) {
  int ends[2];
  *out = (batch_zygote){.channel = -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return batch_fail_errno(error, "cannot open a channel to a process");
  for (int e = 0; e < 2; e++) { /* a whole message has to fit */
    int bytes = 2 * BATCH_ENDING_BYTES;
    setsockopt(ends[e], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  pid_t parent = getpid(), id = fork();
  if (id == 0) {
    close_all_but(ends[1]);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent)
      batch_zygote_loop(ends[1], work, payload);
    _exit(0);
  }
  close(ends[1]);
  if (id < 0) {
    close(ends[0]);
    return batch_fail_errno(error, "cannot start a process");
  }
  *out = (batch_zygote){id, ends[0]};
  return true;
}

bool batch_zygote_send(batch_zygote *zygote, uint64_t ticket, const char *request, int input,
                       const batch_limits *limits) {
  size_t length = strlen(request);
  batch_zygote_request head = {ticket, *limits, length};
  struct iovec parts[2] = {{&head, sizeof head}, {(void *)(uintptr_t)request, length}};
  struct msghdr message = {.msg_iov = parts, .msg_iovlen = 2};
  batch_descriptor_room room;
  batch_descriptor_attach(&message, &room, input);
  ssize_t sent;
  do
    sent = sendmsg(zygote->channel, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  while (sent < 0 && errno == EINTR);
  return sent >= 0 || errno != EAGAIN;
}

int batch_zygote_receive(batch_zygote *zygote, batch_ending *out, char buffer[BATCH_ENDING_BYTES]) {
  batch_zygote_reply reply;
  struct iovec parts[2] = {{&reply, sizeof reply}, {buffer, BATCH_ENDING_BYTES - 1}};
  struct msghdr message = {.msg_iov = parts, .msg_iovlen = 2};
  ssize_t got = recvmsg(zygote->channel, &message, MSG_DONTWAIT);
  if (got < 0 && (errno == EAGAIN || errno == EINTR))
    return 0;
  if (got < (ssize_t)sizeof reply || (size_t)got != sizeof reply + reply.message_bytes + reply.result_bytes)
    return -1;
  buffer[got - (ssize_t)sizeof reply] = '\0';
  *out = reply.ending;
  out->message = buffer; /* each ends with a zero of its own */
  out->result = buffer + reply.message_bytes;
  return 1;
}

void batch_zygote_end(batch_zygote *zygote) {
  if (zygote->channel >= 0)
    close(zygote->channel); /* it ends its children, and what they have left behind, when it sees that */
  while (zygote->id > 0 && waitpid(zygote->id, NULL, 0) < 0 && errno == EINTR) {
  }
  *zygote = (batch_zygote){.channel = -1};
}
