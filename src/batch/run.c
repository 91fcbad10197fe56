/* SPDX-License-Identifier: BSD-3-Clause */
/** Giving out work and waiting for it. */
#include "batch/run.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

bool batch_break(run *r) {
  r->is_broken = true;
  return false;
}

bool batch_run_stops(const run *r) {
  return r->is_broken || batch_signal();
}

/* ---- Waiting ---- */

static void occupy(run *r, batch_slot *slot) {
  if (!slot->is_hashing)
    r->manifest->items[slot->items[0]].is_in_flight = true;
  slot->is_used = true;
  r->in_flight++;
}

static void release(run *r, batch_slot *slot) {
  if (!slot->is_hashing)
    r->manifest->items[slot->items[0]].is_in_flight = false;
  slot->is_used = false;
  r->in_flight--;
}

/** It is no sign against a mesh, but it had better be alone from now on. */
static bool note_loss(run *r, batch_item *item) {
  item->aborted = item->aborted > 0 ? item->aborted : 1;
  return batch_journal_add(
      &r->journal, json_pack("{s:s, s:o}", "event", "lost", "item", batch_json_string(item->id)), r->error);
}

/** Someone has ended the zygote, and its children with it. What they were at is begun anew, later and alone.
 */
static void replace_zygote(run *r) {
  enum { LOSSES_MAX = 100 };
  batch_zygote_end(&r->zygote);
  for (int s = 0; s < BATCH_JOBS_MAX; s++) {
    batch_slot *slot = &r->slots[s];
    if (!slot->is_used)
      continue;
    if (!slot->is_hashing && !note_loss(r, &r->manifest->items[slot->items[0]]))
      batch_break(r);
    release(r, slot);
  }
  if (++r->losses > LOSSES_MAX)
    batch_break((batch_fail(r->error,
                            "the process that starts others was ended again and again: the machine may have "
                            "too little memory for so many (-j)"),
                 r));
  else if (!batch_zygote_start(&r->zygote, r->settings->work, r->settings->payload, r->error))
    batch_break(r);
}

/** There is no room for a process: others have to end first. */
static void take_refusal(run *r, const batch_slot *slot) {
  enum { REFUSALS_MAX = 300 };
  struct timespec pause = {.tv_nsec = 100000000};
  nanosleep(&pause, NULL);
  if (!slot->is_hashing && !note_loss(r, &r->manifest->items[slot->items[0]]))
    batch_break(r);
  else if (++r->refusals > REFUSALS_MAX) {
    batch_fail(r->error,
               "the system starts no processes: see its limits on processes and open files (ulimit -u, -n)");
    batch_break(r);
  }
}

static void take_endings(run *r) {
  batch_ending ending;
  int got = 0;
  while (r->in_flight > 0 && (got = batch_zygote_receive(&r->zygote, &ending, r->ending)) > 0) {
    batch_slot *slot = ending.ticket < BATCH_JOBS_MAX ? &r->slots[ending.ticket] : NULL;
    if (!slot || !slot->is_used)
      continue;
    release(r, slot);
    if (ending.reason != BATCH_REASON_NO_FORK) {
      r->losses = r->refusals = 0;
      batch_take_ending(r, slot, &ending);
      continue;
    }
    take_refusal(r, slot);
  }
  if (got < 0)
    replace_zygote(r);
}

static void wait_a_while(run *r, int waits_for, bool is_late) {
  struct pollfd polled[2] = {{.fd = r->zygote.channel, .events = POLLIN},
                             {.fd = waits_for, .events = POLLIN}};
  if (poll(polled, 2, is_late ? 100 : 200) < 0)
    return;
  if (polled[0].revents)
    take_endings(r);
}

/* ---- Giving out ---- */

static batch_slot *free_slot(run *r) {
  for (int s = 0; s < BATCH_JOBS_MAX; s++)
    if (!r->slots[s].is_used)
      return &r->slots[s];
  return NULL;
}

static bool is_folder(const char *path) {
  struct stat info;
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
    return true;
  errno = ENOTDIR;
  return false;
}

/** Whether a failure is of one name, and the next may go well. */
static bool is_of_its_name(int reason) {
  return reason == ENAMETOOLONG || reason == ENOTDIR || reason == ELOOP || reason == EILSEQ ||
         reason == EINVAL;
}

bool batch_make_folders(run *r, const char *name) {
  static char last[4096];
  char path[4096];
  const char *root = r->settings->output, *end = strrchr(name, '/');
  int length = end ? snprintf(path, sizeof path, "%s/%.*s", root, (int)(end - name), name) : 0;
  if (length < 0 || (size_t)length >= sizeof path) {
    errno = ENAMETOOLONG;
    return batch_fail_errno(r->error, "%s: cannot make its folder", name);
  }
  if (!end || strcmp(path, last) == 0)
    return true;
  for (char *slash = path + strlen(root); slash;) {
    slash = strchr(slash + 1, '/');
    if (slash)
      *slash = '\0';
    if (mkdir(path, 0777) != 0 && (errno != EEXIST || !is_folder(path)))
      return batch_fail_errno(r->error, "%s: cannot make the folder", path);
    if (slash)
      *slash = '/';
  }
  strcpy(last, path);
  return true;
}

static bool note_start(run *r, const batch_item *item, bool is_alone) {
  json_t *record = json_pack("{s:s, s:o, s:i}", "event", "start", "item", batch_json_string(item->id),
                             "attempt", item->attempts + 1);
  if (is_alone && record)
    json_object_set_new(record, "alone", json_true());
  return batch_journal_add(&r->journal, record, r->error);
}

/**
 * Occupies the slot and sends what its child is to do. Where the zygote has gone this cannot be told from one
 * that goes a moment later: it is found out when its endings are waited for. False if it is too long to be
 * sent.
 */
static bool send_request(run *r, batch_slot *slot, json_t *job, int input, const batch_limits *limits) {
  char *text = job ? json_dumps(job, JSON_COMPACT) : NULL;
  bool fits = text && strlen(text) < BATCH_REQUEST_MAX;
  json_decref(job);
  if (fits)
    occupy(r, slot);
  while (fits && slot->is_used && /* until it is sent, or its zygote is lost while we wait for room */
         !batch_zygote_send(&r->zygote, (uint64_t)(slot - r->slots), text, input, limits))
    wait_a_while(r, -1, false);
  free(text);
  return fits;
}

bool batch_give_out(run *r, int64_t index, int input, bool is_alone) {
  batch_item *item = &r->manifest->items[index];
  batch_slot *slot = free_slot(r);
  batch_limits limits = r->settings->limits;
  if (is_alone && r->settings->alone_memory)
    limits.memory = r->settings->alone_memory;
  json_t *job = r->settings->job(item, limits.memory, r->settings->payload, r->error);
  if (item->is_misnamed) {
    json_decref(job);
    return batch_end_item(
        r, index, BATCH_UNREADABLE,
        json_pack("{s:s, s:s}", "stage", "read", "message", "its name is not in UTF-8: give it another"));
  }
  if (!slot || !job) { /* its own options are at fault: that ends it, and not the batch */
    json_decref(job);
    return batch_end_item(
        r, index, BATCH_FAILED,
        json_pack("{s:s, s:o}", "stage", "options", "message", batch_json_string(r->error->text)));
  }
  if (!batch_make_folders(r, item->output)) {
    int reason = errno;
    json_decref(job);
    return is_of_its_name(reason) ? batch_end_item(r, index, BATCH_FAILED,
                                                   json_pack("{s:s, s:o}", "stage", "write", "message",
                                                             batch_json_string(r->error->text)))
                                  : batch_break(r);
  }
  if (!note_start(r, item, is_alone)) {
    json_decref(job);
    return batch_break(r);
  }
  *slot = (batch_slot){.is_alone = is_alone, .items = {index}, .count = 1};
  if (!send_request(r, slot, job, input, &limits))
    return batch_end_item(
        r, index, BATCH_FAILED,
        json_pack("{s:s, s:s}", "stage", "start", "message", "its names and options are too long together"));
  return true;
}

/** Where it is too long to be sent they are not told to be duplicates. */
bool batch_give_hashes(run *r, const int64_t *items, int count) {
  batch_slot *slot = free_slot(r);
  json_t *job = json_object(), *paths = json_array(), *options = json_array();
  for (int i = 0; i < count; i++) {
    const batch_item *item = &r->manifest->items[items[i]];
    json_array_append_new(paths, batch_json_string(item->path));
    json_array_append_new(options, batch_json_string(item->options ? item->options : ""));
  }
  json_object_set_new(job, "hash", paths);
  json_object_set_new(job, "options", options);
  *slot = (batch_slot){.is_hashing = true, .count = count};
  memcpy(slot->items, items, (size_t)count * sizeof *items);
  return send_request(r, slot, job, -1, &r->settings->limits);
}

/* ---- A source ---- */

/** Memory that is left, as a share of all; the kernel's own estimate. 1 where it is not known. */
static double memory_left(void) {
  unsigned long long total = 0, available = 0;
  char line[128];
  FILE *file = fopen("/proc/meminfo", "re");
  while (file && fgets(line, sizeof line, file) && !available)
    if (sscanf(line, "MemTotal: %llu", &total) != 1)
      (void)sscanf(line, "MemAvailable: %llu", &available);
  if (file)
    fclose(file);
  return total && available ? (double)available / (double)total : 1;
}

/** Whether there is memory for one more; others at work will give theirs back. */
static bool has_room(run *r) {
  const double least = 0.05, look_again_ms = 50;
  double now = batch_clock_ms();
  if (r->in_flight == 0)
    return true;
  if (now - r->memory_seen_ms > look_again_ms) {
    r->memory_left = memory_left();
    r->memory_seen_ms = now;
  }
  return r->memory_left > least;
}

/** A second signal does not wait for those at work. */
static void stop_at_once(run *r) {
  batch_zygote_end(&r->zygote);
  r->in_flight = 0;
}

void batch_run_source(run *r, batch_source *source, void *payload, int jobs, const int *waits_for) {
  batch_turn turn = BATCH_GIVEN_OUT;
  while (turn != BATCH_NOTHING_LEFT || r->in_flight > 0) {
    bool stops = batch_run_stops(r);
    while (!stops && turn != BATCH_NOTHING_LEFT && r->in_flight < jobs) {
      turn = has_room(r) ? source(r, payload) : BATCH_LATER;
      stops = batch_run_stops(r);
      if (turn == BATCH_LATER)
        break;
    }
    if (batch_signal() < 0) {
      stop_at_once(r);
      return;
    }
    if (stops && r->in_flight == 0)
      return;
    bool waits = turn == BATCH_LATER && waits_for;
    if (r->in_flight > 0 || waits)
      wait_a_while(r, waits ? *waits_for : -1, turn == BATCH_LATER);
    batch_progress(r->tally, r->settings, r->in_flight);
  }
}
