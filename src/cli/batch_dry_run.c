/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch --dry-run: what a batch will take, by some of its meshes. */
#include "batch/outputs.h"
#include "batch/plan.h"
#include "batch/summary.h"
#include "batch/tally.h"
#include "cli/batch.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** Leaves so many, evenly from the first to the last. */
static void keep_sample(batch_manifest *manifest, int64_t sample) {
  int64_t count = manifest->count;
  if (sample >= count)
    return;
  batch_manifest dropped = {.items = malloc((size_t)count * sizeof *manifest->items)};
  if (!dropped.items) /* then all are made */
    return;
  int64_t kept = 0;
  for (int64_t i = 0; i < count; i++)
    if (kept < sample && i == kept * count / sample)
      manifest->items[kept++] = manifest->items[i];
    else
      dropped.items[dropped.count++] = manifest->items[i];
  manifest->count = kept;
  batch_manifest_free(&dropped);
}

/** What the sample says about all. */
static json_t *estimate(const cli_run *cli, const batch_state *state, const batch_tally *tally, int64_t all,
                        int64_t jobs) {
  const double block = 4096;
  double bytes = 0, seconds = (batch_clock_ms() - tally->started_ms) / 1000;
  double share = (double)all / (double)(state->manifest.count > 0 ? state->manifest.count : 1);
  uint64_t peak = 0;
  char time[40], disk[24], memory[24], counts[320];
  for (int64_t i = 0; i < state->manifest.count; i++) {
    const batch_end *end = &state->ends[i];
    bytes += (double)end->output_bytes + (end->output_bytes > 0 ? block / 2 : 0);
    peak = end->peak_bytes > peak ? end->peak_bytes : peak;
  }
  if (cli_summary(cli)) {
    cli_row(cli, "sample", "%" PRId64 " of %" PRId64 " meshes: %s", state->manifest.count, all,
            batch_counts_text(counts, tally->counts));
    cli_row(cli, "time", "about %s, %" PRId64 " at a time", batch_duration_text(time, seconds * share), jobs);
    cli_row(cli, "disk", "about %s", cli_bytes_text(disk, (uint64_t)(bytes * share)));
    cli_row(cli, "memory", "up to %s for a mesh of the sample", cli_bytes_text(memory, peak));
  }
  return json_pack("{s:I, s:I, s:f, s:f, s:I, s:o}", "meshes", (json_int_t)all, "sample",
                   (json_int_t)state->manifest.count, "seconds", seconds * share, "disk_bytes", bytes * share,
                   "peak_bytes", (json_int_t)peak, "counts", batch_counts_json(tally->counts));
}

int batch_dry_run(cli_run *cli, batch_manifest *manifest, const batch_settings *settings,
                  batch_maker *maker) {
  batch_error error;
  batch_tally tally;
  batch_state state;
  const char *parent = getenv("TMPDIR");
  char *folder = NULL;
  int64_t all = manifest->count;
  if (asprintf(&folder, "%s/voxmend-XXXXXX", parent && *parent ? parent : "/tmp") < 0)
    return cli_fail_text(cli, "out of memory: free some");
  if (!mkdtemp(folder)) {
    int status = cli_fail_text(cli, "%s: cannot make a folder: %s", folder, strerror(errno));
    free(folder);
    return status;
  }
  keep_sample(manifest, maker->given->sample);
  batch_settings sampled = *settings;
  sampled.output = maker->output = folder;
  sampled.shard = 0;
  sampled.shards = 1;
  json_t *plan = batch_make_settings(maker->given), *report = NULL;
  bool good = batch_plan_freeze(manifest, plan, &sampled, &error);
  json_decref(plan);
  batch_outcome outcome = good ? batch_run(&tally, manifest, &sampled, &error) : BATCH_BROKEN;
  if (outcome == BATCH_COMPLETE && batch_state_read(&state, folder, &error)) {
    report = estimate(cli, &state, &tally, all, maker->given->jobs);
    batch_state_free(&state);
  }
  batch_folder_remove(folder);
  free(folder);
  if (outcome == BATCH_INTERRUPTED) {
    cli_set_signal(abs(batch_signal()));
    return cli_fail_text(cli, "interrupted");
  }
  return report ? cli_finish(cli, report) : cli_fail_text(cli, "%s", error.text);
}
