/* SPDX-License-Identifier: BSD-3-Clause */
/** The stages of a run, one after another. */
#include "batch/changes.h"
#include "batch/plan.h"
#include "batch/run.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- Signals ---- */

static volatile sig_atomic_t caught, caught_again;

static void on_signal(int number) {
  caught_again = caught != 0;
  caught = number;
}

int batch_signal(void) {
  return caught_again ? -caught : caught;
}

static void watch_signals(void) {
  struct sigaction action = {.sa_handler = on_signal}, before; /* no SA_RESTART: waiting ends */
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  if (sigaction(SIGHUP, NULL, &before) == 0 &&
      before.sa_handler != SIG_IGN) /* else nohup has asked to go on */
    sigaction(SIGHUP, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
}

/* ---- Files ---- */

static bool is_waiting(const run *r, int64_t i) {
  const batch_item *item = &r->manifest->items[i];
  return item->status == BATCH_PENDING && !item->is_in_flight && !r->needs_more[i];
}

static batch_turn next_file(run *r, void *payload) {
  int64_t *next = payload;
  for (; *next < r->manifest->count; (*next)++) {
    const batch_item *item = &r->manifest->items[*next];
    if (!is_waiting(r, *next) || item->member || item->original >= 0 || item->aborted > 0)
      continue;
    batch_give_out(r, (*next)++, -1, false);
    return BATCH_GIVEN_OUT;
  }
  return BATCH_NOTHING_LEFT;
}

/* ---- Members of archives ---- */

typedef struct unpacking {
  const char *path;
  batch_unpacker unpacker;
  batch_wanted *members; /**< of that archive */
  int64_t count, left;
  bool has_later; /**< hard links to a member that another has: they come when it is read again */
  int losses;     /**< how often its process was ended by others */
  bool is_alone;
} unpacking;

static int by_place(const void *a, const void *b) {
  const batch_wanted *x = a, *y = b;
  if (x->place != y->place)
    return x->place < y->place ? -1 : 1;
  return (x->item > y->item) - (x->item < y->item);
}

void batch_wanted_sort(batch_wanted *members, int64_t count) {
  if (count > 0)
    qsort(members, (size_t)count, sizeof *members, by_place);
}

int64_t batch_wanted_find(const batch_wanted *members, int64_t count, int64_t place) {
  int64_t low = 0, high = count;
  while (low < high) {
    int64_t middle = low + (high - low) / 2;
    if (members[middle].place < place)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bool end_badly(run *r, int64_t item, const char *text) {
  return batch_end_item(r, item, BATCH_UNREADABLE,
                        json_pack("{s:s, s:o}", "stage", "unpack", "message", batch_json_string(text)));
}

static void take_member(run *r, unpacking *u, const batch_member *member) {
  int64_t w = batch_wanted_find(u->members, u->count, member->place);
  for (bool is_given = false; w < u->count && u->members[w].place == member->place; w++) {
    int64_t item = u->members[w].item;
    if (!is_waiting(r, item))
      continue;
    if (is_given) {
      u->has_later = true; /* a descriptor has one position, and so one reader */
      continue;
    }
    u->left--;
    if (member->descriptor < 0)
      end_badly(r, item, member->problem);
    else
      is_given = batch_give_out(r, item, member->descriptor, u->is_alone);
  }
  if (member->descriptor >= 0)
    close(member->descriptor);
}

uint64_t batch_member_room(const batch_settings *settings) {
  return settings->limits.memory ? settings->limits.memory : UINT64_C(1) << 36;
}

/** Someone has ended the process that reads the archive: another begins at its front. */
static bool restart(run *r, unpacking *u) {
  batch_unpacker_end(&u->unpacker);
  u->left = 0;
  u->has_later = false;
  for (int64_t m = 0; m < u->count; m++)
    u->left += is_waiting(r, u->members[m].item);
  return batch_unpacker_start(&u->unpacker, u->path, batch_member_room(r->settings), r->error);
}

static batch_turn next_member(run *r, void *payload) {
  enum { LOSSES_MAX = 5 };
  unpacking *u = payload;
  batch_member member;
  batch_error problem = {"it is no longer in the archive"};
  struct pollfd polled = {.fd = u->unpacker.channel, .events = POLLIN};
  if (u->left == 0)
    return BATCH_NOTHING_LEFT;
  if (poll(&polled, 1, 0) == 0)
    return BATCH_LATER;
  int got = batch_unpacker_next(&u->unpacker, &member, &problem);
  if (got > 0) {
    take_member(r, u, &member);
    return BATCH_GIVEN_OUT;
  }
  if (got == -2 && ++u->losses < LOSSES_MAX && restart(r, u))
    return BATCH_GIVEN_OUT;
  if (got == 0 && u->has_later && restart(r, u))
    return BATCH_GIVEN_OUT;
  for (int64_t m = 0; m < u->count && !r->is_broken; m++) /* it ended, well or not, before all were found */
    if (is_waiting(r, u->members[m].item))
      end_badly(r, u->members[m].item, problem.text);
  return BATCH_NOTHING_LEFT;
}

/** Works at the listed items, all of one archive. */
static void run_archive(run *r, unpacking *u, int jobs) {
  u->left = u->count;
  u->losses = 0;
  u->has_later = false;
  if (u->count == 0 || batch_run_stops(r))
    return;
  if (!batch_unpacker_start(&u->unpacker, u->path, batch_member_room(r->settings), r->error)) {
    batch_break(r);
    return;
  }
  batch_run_source(r, next_member, u, jobs, &u->unpacker.channel);
  batch_unpacker_end(&u->unpacker);
}

/** From an item on that is in an archive: collects those of the same archive that are wanted; returns how far
 * it got. */
static int64_t collect_members(const run *r, unpacking *u, int64_t from,
                               bool (*wanted)(const run *r, int64_t i)) {
  u->path = r->manifest->items[from].path;
  u->count = 0;
  int64_t i = from;
  for (; i < r->manifest->count; i++) {
    const batch_item *item = &r->manifest->items[i];
    if (!item->member || strcmp(item->path, u->path) != 0)
      break; /* ids of an archive's members begin with its own: they stand together */
    if (wanted(r, i))
      u->members[u->count++] = (batch_wanted){item->place, i};
  }
  batch_wanted_sort(u->members, u->count);
  return i;
}

static bool is_wanted_member(const run *r, int64_t i) {
  return is_waiting(r, i) && r->manifest->items[i].original < 0 && r->manifest->items[i].aborted == 0;
}

static bool is_wanted_alone(const run *r, int64_t i) {
  const batch_item *item = &r->manifest->items[i];
  return item->status == BATCH_PENDING && !item->is_in_flight && item->original < 0;
}

static void run_archives(run *r, bool (*wanted)(const run *r, int64_t i), int jobs, bool is_alone) {
  unpacking u = {.is_alone = is_alone,
                 .members = malloc((size_t)(r->manifest->count + 1) * sizeof(batch_wanted))};
  if (!u.members)
    batch_break((batch_fail(r->error, "out of memory: free some"), r));
  for (int64_t i = 0; i < r->manifest->count && !batch_run_stops(r);)
    if (r->manifest->items[i].member) {
      i = collect_members(r, &u, i, wanted);
      if (is_alone)
        for (int64_t m = 0; m < u.count; m++)
          r->needs_more[u.members[m].item] = false;
      run_archive(r, &u, jobs);
    } else
      i++;
  free(u.members);
}

/* ---- Alone ---- */

/** How often something may be begun and not end, alone, until it is not begun any more. */
enum { ABORTS_MAX = 8 };

static bool quarantine(run *r, int64_t i) {
  if (r->manifest->items[i].aborted < ABORTS_MAX)
    return false;
  batch_end_item(r, i, BATCH_QUARANTINED,
                 json_pack("{s:s}", "message",
                           "the run ended again and again while this one was at work, alone; "
                           "--retry quarantined tries it again"));
  return true;
}

static int level_of(const batch_item *item) {
  return item->aborted < ABORTS_MAX ? item->aborted : ABORTS_MAX;
}

/** Those first that were begun least often. */
typedef struct lonely {
  int64_t next;
  int aborted; /**< only those with so many */
} lonely;

static batch_turn next_alone(run *r, void *payload) {
  lonely *l = payload;
  int64_t *next = &l->next;
  for (; *next < r->manifest->count; (*next)++) {
    if (!is_wanted_alone(r, *next) || level_of(&r->manifest->items[*next]) != l->aborted ||
        r->manifest->items[*next].member || quarantine(r, *next))
      continue;
    if (r->is_broken)
      return BATCH_NOTHING_LEFT;
    r->needs_more[*next] = false;
    batch_give_out(r, (*next)++, -1, true);
    return BATCH_GIVEN_OUT;
  }
  return BATCH_NOTHING_LEFT;
}

/** More than once, as one that is alone may lose its zygote, too. */
static void run_alone(run *r) {
  for (int round = 0; round < ABORTS_MAX && r->tally->counts[BATCH_PENDING] > 0 && !batch_run_stops(r);
       round++) {
    for (int aborted = 0; aborted <= ABORTS_MAX; aborted++) {
      lonely l = {0, aborted};
      batch_run_source(r, next_alone, &l, 1, NULL);
    }
    for (int64_t i = 0; i < r->manifest->count && !r->is_broken; i++)
      if (r->manifest->items[i].member && is_wanted_alone(r, i))
        quarantine(r, i);
    run_archives(r, is_wanted_alone, 1, true);
  }
}

/* ---- A run ---- */

static void count_all(batch_tally *tally, const batch_manifest *manifest) {
  *tally = (batch_tally){.total = manifest->count, .started_ms = batch_clock_ms()};
  for (int64_t i = 0; i < manifest->count; i++)
    tally->counts[manifest->items[i].status]++;
  tally->done_before = tally->total - tally->counts[BATCH_PENDING];
}

static void run_stages(run *r) {
  int64_t next = 0;
  batch_find_duplicates(r);
  if (!batch_run_stops(r))
    batch_run_source(r, next_file, &next, r->settings->jobs, NULL);
  run_archives(r, is_wanted_member, r->settings->jobs, false);
  if (!batch_run_stops(r))
    batch_link_duplicates(r);
  run_alone(r);
  if (!batch_run_stops(r)) /* of those that ran alone */
    batch_link_duplicates(r);
  run_alone(r); /* where the file system has no links */
}

static bool prepare(run *r, const char *journal) {
  size_t count = (size_t)r->manifest->count + 1;
  r->contents = calloc(count, sizeof *r->contents);
  r->needs_more = calloc(count, sizeof *r->needs_more);
  r->slots = calloc(BATCH_JOBS_MAX, sizeof *r->slots);
  r->ending = malloc(BATCH_ENDING_BYTES);
  if (!r->contents || !r->needs_more || !r->slots || !r->ending)
    return batch_fail(r->error, "out of memory: free some");
  return batch_replay(r->manifest, r->contents, r->settings, journal, r->error) &&
         batch_changes_beside(r->manifest, r->settings, r->error);
}

static bool note_run(run *r, const char *event) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  json_t *record = json_pack("{s:s, s:o, s:I, s:i, s:I}", "event", event, "host", batch_json_string(host),
                             "process", (json_int_t)getpid(), "jobs", r->settings->jobs, "pending",
                             (json_int_t)r->tally->counts[BATCH_PENDING]);
  return batch_journal_add(&r->journal, record, r->error) && batch_journal_sync(&r->journal, r->error);
}

static batch_outcome outcome_of(const run *r) {
  return r->is_broken                           ? BATCH_BROKEN
         : r->tally->counts[BATCH_PENDING] == 0 ? BATCH_COMPLETE
                                                : BATCH_INTERRUPTED;
}

static void work(run *r, const char *journal, int folder) {
  watch_signals();
  if (!batch_journal_open(&r->journal, journal, folder, r->error)) {
    batch_break(r);
    return;
  }
  if (!prepare(r, journal))
    batch_break(r);
  count_all(r->tally, r->manifest);
  if (!r->is_broken && !note_run(r, "begin"))
    batch_break(r);
  if (!r->is_broken)
    run_stages(r);
  batch_progress_clear(r->settings);
  if (!r->is_broken && !note_run(r, outcome_of(r) == BATCH_COMPLETE ? "complete" : "stop"))
    batch_break(r);
}

batch_outcome batch_run(batch_tally *tally, batch_manifest *manifest, const batch_settings *settings,
                        batch_error *error) {
  run r = {.settings = settings,
           .manifest = manifest,
           .tally = tally,
           .error = error,
           .journal = {.descriptor = -1},
           .zygote = *settings->zygote};
  char *journal = batch_journal_path(settings->output, settings->shard, settings->shards);
  int folder = open(settings->output, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  *tally = (batch_tally){0};
  batch_manifest_keep_shard(manifest, settings->shard, settings->shards);
  if (journal && folder >= 0)
    work(&r, journal, folder);
  else
    batch_break((batch_fail_errno(error, "%s: cannot open the folder", settings->output), &r));
  batch_zygote_end(&r.zygote);
  *settings->zygote = r.zygote;
  batch_journal_close(&r.journal);
  if (folder >= 0)
    close(folder);
  free(journal);
  free(r.contents);
  free(r.needs_more);
  free(r.slots);
  free(r.ending);
  return outcome_of(&r);
}
