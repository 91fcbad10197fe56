/* SPDX-License-Identifier: BSD-3-Clause */
/** The zygote: forks, waits, keeps the time, and tells how each child ended. */
#include "batch/zygote_loop.h"
#include "batch/descriptor.h"
#include "batch/pid_namespace.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CHILDREN_MAX = 1024, FLOOD_BYTES = 16 << 20, STRAY_MS = 20 };

/** A pipe of a child and what came out of it. */
typedef struct stream {
  int descriptor; /**< -1 = at its end */
  char *text;
  size_t size, capacity; /**< capacity: what is kept; more is dropped */
  uint64_t dropped;
} stream;

typedef struct child {
  pid_t id;
  uint64_t ticket;
  double started_ms, deadline_ms; /**< deadline 0 = none */
  batch_reason reason;
  int status; /**< of batch_namespace_fork */
  stream message, result;
} child;

typedef struct zygote {
  int channel, signals;
  batch_work *work;
  void *payload;
  bool has_namespaces; /**< each child gets one for its PIDs */
  child children[CHILDREN_MAX];
  int count;
  bool has_strays; /**< processes that children left behind are being ended */
  char request[sizeof(batch_zygote_request) + BATCH_REQUEST_MAX + 1];
} zygote;

/* ---- Streams ---- */

static bool open_stream(stream *s, size_t room, int *writer) {
  int ends[2];
  *s = (stream){.descriptor = -1, .text = malloc(room), .capacity = room};
  if (!s->text || pipe2(ends, O_CLOEXEC) != 0)
    return false;
  s->descriptor = ends[0];
  *writer = ends[1];
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return true;
}

static void close_stream(stream *s) {
  if (s->descriptor >= 0)
    close(s->descriptor);
  free(s->text);
  *s = (stream){.descriptor = -1};
}

/** Takes what there is; what is beyond the room is dropped. Not for ever: others wait, too. */
static void read_stream(stream *s) {
  char scrap[4096];
  for (int i = 0; i < 64 && s->descriptor >= 0; i++) {
    bool keeps = s->size < s->capacity;
    ssize_t got =
        read(s->descriptor, keeps ? s->text + s->size : scrap, keeps ? s->capacity - s->size : sizeof scrap);
    if (got > 0 && keeps)
      s->size += (size_t)got;
    else if (got > 0)
      s->dropped += (uint64_t)got;
    else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
      close(s->descriptor);
      s->descriptor = -1;
    } else if (errno == EAGAIN)
      return;
  }
}

/* ---- Children ---- */

static void send_reply(const zygote *z, const batch_ending *ending, const stream *message,
                       const stream *result) {
  static const char zero[1];
  batch_zygote_reply reply = {
      .ending = *ending, .message_bytes = message->size + 1, .result_bytes = result->size + 1};
  struct iovec parts[5] = {{&reply, sizeof reply},
                           {message->text, message->size},
                           {(void *)(uintptr_t)zero, 1},
                           {result->text, result->size},
                           {(void *)(uintptr_t)zero, 1}};
  struct msghdr head = {.msg_iov = parts, .msg_iovlen = 5};
  while (sendmsg(z->channel, &head, MSG_NOSIGNAL) < 0 && errno == EINTR) {
  }
}

/** Processes of its group go with it; those that have left the group become ours, and are found later. */
static void end_child(child *c, batch_reason reason) {
  if (c->reason == BATCH_REASON_ENDED)
    c->reason = reason;
  kill(-c->id, SIGKILL);
  kill(c->id, SIGKILL);
}

static double milliseconds(struct timeval t) {
  return (double)t.tv_sec * 1e3 + (double)t.tv_usec * 1e-3;
}

/** A child has ended: its last words are taken, it is told of and forgotten. */
static void collect(zygote *z, int index, int status, const struct rusage *usage) {
  child *c = &z->children[index];
  kill(-c->id, SIGKILL);
  batch_namespace_status(c->status, &status);
  read_stream(&c->message);
  read_stream(&c->result);
  if (c->result.dropped > 0 && c->reason == BATCH_REASON_ENDED)
    c->reason = BATCH_REASON_FLOOD;
  batch_ending ending = {.ticket = c->ticket,
                         .reason = c->reason,
                         .wait_status = status,
                         .wall_ms = batch_clock_ms() - c->started_ms,
                         .cpu_ms = milliseconds(usage->ru_utime) + milliseconds(usage->ru_stime),
                         .peak_bytes = (uint64_t)usage->ru_maxrss << 10};
  send_reply(z, &ending, &c->message, &c->result);
  close_stream(&c->message);
  close_stream(&c->result);
  if (c->status >= 0)
    close(c->status);
  z->children[index] = z->children[--z->count];
}

static int find_child(const zygote *z, pid_t id) {
  for (int c = 0; c < z->count; c++)
    if (z->children[c].id == id)
      return c;
  return -1;
}

static void reap(zygote *z) {
  int status;
  struct rusage usage;
  pid_t id;
  while ((id = wait4(-1, &status, WNOHANG, &usage)) > 0) {
    int index = find_child(z, id);
    if (index >= 0) {
      z->has_strays |= !z->has_namespaces; /* it may have left some: they are ours now */
      collect(z, index, status, &usage);
    }
  }
}

/** Ends those that were left to us: all that we have but our own children. They may leave others in turn. */
static void end_strays(zygote *z) {
  z->has_strays = false;
  FILE *file = fopen("/proc/thread-self/children", "re");
  if (!file)
    return; /* a kernel without this list: their groups have been ended */
  long id;
  while (fscanf(file, "%ld", &id) == 1)
    if (find_child(z, (pid_t)id) < 0) {
      kill((pid_t)id, SIGKILL);
      z->has_strays = true;
    }
  fclose(file);
}

/* ---- Requests ---- */

static void refuse(const zygote *z, uint64_t ticket) {
  batch_ending ending = {.ticket = ticket, .reason = BATCH_REASON_NO_FORK};
  send_reply(z, &ending, &(stream){.descriptor = -1}, &(stream){.descriptor = -1});
}

_Noreturn static void be_child(zygote *z, const batch_zygote_request *head, const char *text, int input,
                               int message, int result) {
  close(z->channel);
  close(z->signals);
  for (int c = 0; c < z->count; c++) {
    close(z->children[c].message.descriptor);
    close(z->children[c].result.descriptor);
    if (z->children[c].status >= 0)
      close(z->children[c].status);
  }
  if (!batch_child_prepare(input, message, &head->limits))
    _exit(1);
  _exit(z->work(text, result, z->payload));
}

static void start_child(zygote *z, const batch_zygote_request *head, const char *text, int input) {
  child c = {.ticket = head->ticket,
             .started_ms = batch_clock_ms(),
             .status = -1,
             .message = {.descriptor = -1},
             .result = {.descriptor = -1}};
  int message = -1, result = -1;
  bool good = z->count < CHILDREN_MAX && open_stream(&c.message, BATCH_MESSAGE_MAX, &message) &&
              open_stream(&c.result, BATCH_RESULT_MAX, &result);
  pid_t own = getpid();
  c.id = good ? batch_namespace_fork(z->has_namespaces, &c.status) : -1;
  if (c.id == 0 && !z->has_namespaces && !batch_child_bind(own))
    _exit(1);
  if (c.id == 0)
    be_child(z, head, text, input, message, result);
  if (message >= 0)
    close(message);
  if (result >= 0)
    close(result);
  if (c.id < 0) {
    close_stream(&c.message);
    close_stream(&c.result);
    refuse(z, head->ticket);
    return;
  }
  setpgid(c.id, c.id); /* by whichever of us comes first */
  if (head->limits.seconds > 0)
    c.deadline_ms = c.started_ms + 1000 * head->limits.seconds;
  z->children[z->count++] = c;
}

/** False when the other end is closed. */
static bool take_request(zygote *z) {
  batch_zygote_request head;
  batch_descriptor_room room;
  struct iovec part = {z->request, sizeof z->request - 1};
  struct msghdr message = {
      .msg_iov = &part, .msg_iovlen = 1, .msg_control = &room, .msg_controllen = sizeof room.bytes};
  ssize_t got = recvmsg(z->channel, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (got < 0 && (errno == EAGAIN || errno == EINTR))
    return true;
  if (got < (ssize_t)sizeof head)
    return false;
  int input = batch_descriptor_take(&message);
  memcpy(&head, z->request, sizeof head);
  z->request[got] = '\0';
  start_child(z, &head, z->request + sizeof head, input);
  if (input >= 0)
    close(input);
  return true;
}

/* ---- Loop ---- */

static void keep_time(zygote *z) {
  double now = batch_clock_ms();
  for (int i = 0; i < z->count; i++) {
    child *c = &z->children[i];
    if (c->deadline_ms > 0 && now >= c->deadline_ms)
      end_child(c, BATCH_REASON_TIMEOUT);
    if (c->message.dropped > FLOOD_BYTES || c->result.dropped > 0)
      end_child(c, BATCH_REASON_FLOOD);
  }
}

/** Milliseconds until the next deadline; -1 = for ever. */
static int next_wait(const zygote *z) {
  double wait = z->has_strays ? STRAY_MS : -1, now = batch_clock_ms();
  for (int c = 0; c < z->count; c++) {
    if (z->children[c].deadline_ms <= 0)
      continue;
    double left = z->children[c].reason == BATCH_REASON_TIMEOUT ? 1000 : z->children[c].deadline_ms - now;
    wait = wait < 0 || left < wait ? left : wait;
  }
  return wait < 0 ? -1 : wait > 3600000 ? 3600000 : (int)wait + 1;
}

static bool step(zygote *z) {
  static struct pollfd polled[2 + 2 * CHILDREN_MAX];
  polled[0] = (struct pollfd){.fd = z->channel, .events = POLLIN};
  polled[1] = (struct pollfd){.fd = z->signals, .events = POLLIN};
  int count = z->count;
  for (int c = 0; c < count; c++) { /* closed ones have -1, which poll passes over */
    polled[2 + 2 * c] = (struct pollfd){.fd = z->children[c].message.descriptor, .events = POLLIN};
    polled[3 + 2 * c] = (struct pollfd){.fd = z->children[c].result.descriptor, .events = POLLIN};
  }
  if (poll(polled, (nfds_t)(2 + 2 * count), next_wait(z)) < 0 && errno != EINTR)
    return false;
  for (int c = 0; c < count; c++) {
    if (polled[2 + 2 * c].revents)
      read_stream(&z->children[c].message);
    if (polled[3 + 2 * c].revents)
      read_stream(&z->children[c].result);
  }
  struct signalfd_siginfo told;
  while (read(z->signals, &told, sizeof told) > 0) {
  }
  reap(z);
  keep_time(z);
  if (z->has_strays)
    end_strays(z);
  return !polled[0].revents || take_request(z);
}

/** All children, and what they leave behind, for as long as there is something: a second at most. */
static void end_all(zygote *z) {
  double start = batch_clock_ms();
  for (int c = 0; c < z->count; c++)
    end_child(&z->children[c], BATCH_REASON_ENDED);
  while (batch_clock_ms() - start < 1000) {
    pid_t id = waitpid(-1, NULL, WNOHANG);
    if (id < 0 && errno == ECHILD)
      return;
    z->count = 0; /* from here on whoever is left is a stray */
    end_strays(z);
    struct timespec pause = {.tv_nsec = 1000000};
    nanosleep(&pause, NULL);
  }
}

void batch_zygote_loop(int channel, batch_work *work, void *payload) {
  static zygote z;
  sigset_t all, child_ended;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, NULL); /* the terminal's signals are the program's to act on */
  signal(SIGCHLD, SIG_DFL);
  sigemptyset(&child_ended);
  sigaddset(&child_ended, SIGCHLD);
  setpgid(0, 0);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  z = (zygote){
      .channel = channel, .work = work, .payload = payload, .has_namespaces = batch_pid_namespaces_open()};
  z.signals = signalfd(-1, &child_ended, SFD_NONBLOCK | SFD_CLOEXEC);
  if (z.signals < 0)
    return;
  while (step(&z)) {
  }
  end_all(&z);
}
