/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/summary.h"
#include "batch/plan.h"
#include "batch/tally.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *batch_summary_json(const batch_state *state) {
  int64_t counts[BATCH_STATUSES];
  double wall = 0, cpu = 0;
  uint64_t in = 0, out = 0, peak = 0;
  batch_state_count(state, counts);
  for (int64_t i = 0; i < state->manifest.count; i++) {
    const batch_end *end = &state->ends[i];
    wall += (double)end->wall_ms / 1000;
    cpu += (double)end->cpu_ms / 1000;
    in += state->manifest.items[i].bytes;
    out += end->output_bytes;
    peak = end->peak_bytes > peak ? end->peak_bytes : peak;
  }
  return json_pack("{s:O*, s:O*, s:O*, s:I, s:i, s:i, s:o, s:f, s:f, s:I, s:I, s:I, s:I, s:I}", "voxmend",
                   json_object_get(state->run, "voxmend"), "began", json_object_get(state->run, "began"),
                   "settings", json_object_get(state->run, "settings"), "meshes",
                   (json_int_t)state->manifest.count, "shards", state->shards, "complete_shards",
                   state->complete, "counts", batch_counts_json(counts), "wall_s", wall, "cpu_s", cpu,
                   "input_bytes", (json_int_t)in, "output_bytes", (json_int_t)out, "largest_peak_bytes",
                   (json_int_t)peak, "records", (json_int_t)state->records, "damaged_journal_lines",
                   (json_int_t)state->damaged);
}

/* ---- failures.tsv ---- */

/** A cell has neither tabs nor ends of lines. */
static void put_cell(FILE *file, const char *text, char end) {
  for (; text && *text; text++)
    fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
  fputc(end, file);
}

static void put_failure(FILE *file, const batch_state *state, int64_t i, const batch_summary_hooks *hooks) {
  const batch_item *item = &state->manifest.items[i];
  const batch_end *end = &state->ends[i];
  char *command = hooks->command_line(item, end->stage, hooks->payload);
  put_cell(file, item->id, '\t');
  put_cell(file, batch_status_names[item->status], '\t');
  put_cell(file, end->stage, '\t');
  put_cell(file, end->message, '\t');
  put_cell(file, command, '\n');
  free(command);
}

static bool write_failures(const batch_state *state, const char *output, const batch_summary_hooks *hooks,
                           batch_error *error) {
  char *text = NULL, *path = NULL;
  size_t size = 0;
  FILE *file = open_memstream(&text, &size);
  if (!file)
    return batch_fail(error, "out of memory: free some");
  fputs("item\tstatus\tstage\tmessage\tcommand\n", file);
  for (int64_t i = 0; i < state->manifest.count; i++)
    if (!batch_is_done(state->manifest.items[i].status) && state->manifest.items[i].status != BATCH_PENDING)
      put_failure(file, state, i, hooks);
  bool good = fclose(file) == 0 && asprintf(&path, "%s/failures.tsv", output) >= 0
                  ? batch_write_file(path, text, size, error)
                  : batch_fail(error, "out of memory: free some");
  free(path);
  free(text);
  return good;
}

/* ---- All ---- */

static bool write_json(const json_t *summary, const char *output, batch_error *error) {
  char *text = json_dumps(summary, JSON_INDENT(2)), *path = NULL, *line = NULL;
  bool good = text && asprintf(&path, "%s/summary.json", output) >= 0 && asprintf(&line, "%s\n", text) >= 0
                  ? batch_write_file(path, line, strlen(line), error)
                  : batch_fail(error, "out of memory: free some");
  free(line);
  free(path);
  free(text);
  return good;
}

bool batch_summary_write(const batch_state *state, const char *output, const batch_summary_hooks *hooks,
                         batch_error *error) {
  json_t *summary = batch_summary_json(state);
  bool good = summary ? true : batch_fail(error, "out of memory: free some");
  good = good && batch_page_write(state, summary, output, hooks, error) &&
         write_failures(state, output, hooks, error) && write_json(summary, output, error);
  json_decref(summary);
  return good;
}
