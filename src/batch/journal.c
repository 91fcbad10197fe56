/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/journal.h"
#include "batch/digest.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/** A line begins so, with 16 digits for the dots. */
static const char before_sum[] = "{\"sum\":\"", after_sum[] = "\",";
enum { SUM = 16, HEAD = sizeof before_sum - 1 + SUM + sizeof after_sum - 1 };
static const double SYNC_MS = 5000;

/** The sum of what stands behind the head. */
static void sum_of(char out[SUM + 1], const char *rest, size_t length) {
  char digest[BATCH_DIGEST];
  batch_digest(digest, rest, length);
  memcpy(out, digest, SUM);
  out[SUM] = '\0';
}

static bool is_whole(const char *line, size_t length) {
  char sum[SUM + 1];
  if (length <= HEAD || memcmp(line, before_sum, sizeof before_sum - 1) != 0)
    return false;
  sum_of(sum, line + HEAD, length - HEAD);
  return memcmp(line + sizeof before_sum - 1, sum, SUM) == 0;
}

/* ---- Reading ---- */

/** @param[out] whole where the last whole line ends */
static bool read_lines(FILE *file, batch_record *each, void *payload, int64_t *damaged, off_t *whole) {
  char *line = NULL;
  size_t room = 0;
  ssize_t length;
  int64_t bad = 0, bad_since = 0;
  off_t at = 0;
  bool good = true;
  while (good && (length = getline(&line, &room, file)) > 0) {
    at += length;
    bool ends = line[length - 1] == '\n';
    if (!ends || !is_whole(line, (size_t)length - 1)) {
      bad_since++;
      continue;
    }
    bad += bad_since; /* those at the very end were being written */
    bad_since = 0;
    *whole = at;
    json_t *record = each ? json_loadb(line, (size_t)length - 1, 0, NULL) : NULL;
    good = !each || (record && each(record, payload));
    json_decref(record);
  }
  free(line);
  if (damaged)
    *damaged = bad;
  return good && !ferror(file);
}

bool batch_journal_read(const char *path, batch_record *each, void *payload, int64_t *damaged,
                        batch_error *error) {
  FILE *file = fopen(path, "re");
  off_t whole = 0;
  if (!file)
    return batch_fail_errno(error, "%s: cannot read the journal", path);
  bool good = read_lines(file, each, payload, damaged, &whole);
  if (!good)
    batch_fail_errno(error, "%s: cannot take a record", path);
  fclose(file);
  return good;
}

/* ---- Writing ---- */

/** Where a file system knows no locks the journal does without: two writers would both be right, and slow. */
static bool take_lock(const batch_journal *journal, batch_error *error) {
  while (flock(journal->descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK)
      return batch_fail(error, "%s: another batch is at work there; wait for it, or end it", journal->path);
    if (errno != EINTR)
      return true;
  }
  return true;
}

static bool cut_torn_line(const batch_journal *journal, batch_error *error) {
  int copy = fcntl(journal->descriptor, F_DUPFD_CLOEXEC, 0);
  FILE *file = copy >= 0 ? fdopen(copy, "r") : NULL;
  off_t whole = 0;
  bool good = file && fseeko(file, 0, SEEK_SET) == 0 && read_lines(file, NULL, NULL, NULL, &whole) &&
              ftruncate(journal->descriptor, whole) == 0;
  if (file)
    fclose(file);
  return good || batch_fail_errno(error, "%s: cannot go on with the journal", journal->path);
}

bool batch_journal_open(batch_journal *out, const char *path, int folder, batch_error *error) {
  *out = (batch_journal){.path = path, .folder = folder, .synced_ms = batch_clock_ms()};
  out->descriptor = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (out->descriptor < 0)
    return batch_fail_errno(error, "%s: cannot open the journal", path);
  if (take_lock(out, error) && cut_torn_line(out, error))
    return true;
  close(out->descriptor);
  out->descriptor = -1;
  return false;
}

/** "{...}" with the sum put in front, as a line to be freed. */
static char *line_of(const json_t *record, size_t *length) {
  char *text = json_dumps(record, JSON_COMPACT), *line = NULL, sum[SUM + 1];
  if (!text)
    return NULL;
  size_t rest = strlen(text + 1);
  sum_of(sum, text + 1, rest);
  int used = asprintf(&line, "%s%s%s%s\n", before_sum, sum, after_sum, text + 1);
  free(text);
  *length = used < 0 ? 0 : (size_t)used;
  return used < 0 ? NULL : line;
}

bool batch_journal_add(batch_journal *journal, json_t *record, batch_error *error) {
  size_t length = 0;
  char *line = record ? line_of(record, &length) : NULL;
  json_decref(record);
  if (!line)
    return batch_fail(error, "out of memory for the journal: free some");
  off_t before = lseek(journal->descriptor, 0, SEEK_END);
  bool good = batch_write_all(journal->descriptor, line, length);
  if (!good) {
    batch_fail_errno(error, "%s: cannot write", journal->path);
    if (before < 0 ||
        ftruncate(journal->descriptor, before) != 0) { /* then the next that opens it cuts the line off */
    }
  }
  free(line);
  journal->is_dirty = true;
  return good && (batch_clock_ms() - journal->synced_ms < SYNC_MS || batch_journal_sync(journal, error));
}

/** The outputs first: what the journal tells of is there, even when the machine loses its power. */
bool batch_journal_sync(batch_journal *journal, batch_error *error) {
  journal->synced_ms = batch_clock_ms();
  if (!journal->is_dirty)
    return true;
  journal->is_dirty = false;
  if (syncfs(journal->folder) == 0 && fdatasync(journal->descriptor) == 0)
    return true;
  return batch_fail_errno(error, "%s: cannot write", journal->path);
}

void batch_journal_close(batch_journal *journal) {
  if (journal->descriptor >= 0)
    close(journal->descriptor);
  journal->descriptor = -1;
}
