/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/tally.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

const char *batch_counts_text(char text[320], const int64_t counts[BATCH_STATUSES]) {
  size_t used = 0;
  text[0] = '\0';
  for (int s = BATCH_PENDING + 1; s < BATCH_STATUSES; s++)
    if (counts[s] > 0)
      used += (size_t)snprintf(text + used, 320 - used, "%s%" PRId64 " %s", used ? ", " : "", counts[s],
                               batch_status_names[s]);
  return used ? text : strcpy(text, "none done");
}

json_t *batch_counts_json(const int64_t counts[BATCH_STATUSES]) {
  json_t *object = json_object();
  for (int s = 0; s < BATCH_STATUSES; s++)
    json_object_set_new(object, batch_status_names[s], json_integer(counts[s]));
  return object;
}

const char *batch_duration_text(char text[40], double seconds) {
  int64_t s = (int64_t)(seconds + 0.5);
  if (s < 120)
    snprintf(text, 40, "%" PRId64 " s", s);
  else if (s < 7200)
    snprintf(text, 40, "%" PRId64 " min %02" PRId64 " s", s / 60, s % 60);
  else
    snprintf(text, 40, "%" PRId64 " h %02" PRId64 " min", s / 3600, s % 3600 / 60);
  return text;
}

/** By what this run has done so far; -1 before anything can be told. */
static double seconds_left(const batch_tally *tally, double now) {
  double passed = (now - tally->started_ms) / 1000;
  return tally->fresh < 5 || passed <= 0
             ? -1
             : passed / (double)tally->fresh * (double)tally->counts[BATCH_PENDING];
}

void batch_progress(const batch_tally *tally, const batch_settings *settings, int in_flight) {
  const double step = settings->shows_progress ? 200 : 30000, clock = batch_clock_ms();
  static double shown;
  char counts[320], left[40];
  if (settings->is_quiet || clock - (shown > 0 ? shown : tally->started_ms) < step)
    return;
  shown = clock;
  double passed = (clock - tally->started_ms) / 1000, seconds = seconds_left(tally, clock);
  fprintf(stderr,
          settings->shows_progress ? "\r%" PRId64 "/%" PRId64 "  " : "voxmend: %" PRId64 " of %" PRId64 ": ",
          tally->total - tally->counts[BATCH_PENDING], tally->total);
  fprintf(stderr, "%s; %d at work", batch_counts_text(counts, tally->counts), in_flight);
  if (seconds >= 0)
    fprintf(stderr, ", %.3g/s, about %s left", (double)tally->fresh / (passed > 0 ? passed : 1),
            batch_duration_text(left, seconds));
  fputs(settings->shows_progress ? "\033[K" : "\n", stderr);
  fflush(stderr);
}

void batch_progress_clear(const batch_settings *settings) {
  if (settings->shows_progress && !settings->is_quiet)
    fputs("\r\033[K", stderr);
}
