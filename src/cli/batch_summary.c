/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch: the summary and the pages that are left once all is done, and what they ask of commands. */
#include "batch/summary.h"
#include "cli/batch.h"

#include <stdlib.h>
#include <string.h>

static char *command_line(const batch_item *item, const char *stage, void *payload) {
  return batch_command_line(item, stage, payload);
}

/** The grid, or else the repaired mesh. */
static char *viewed(const batch_item *item, void *payload) {
  const batch_maker *maker = payload;
  batch_error error;
  json_t *job = batch_make_job(item, 0, payload, &error);
  const json_t *outputs = json_object_get(job, "outputs");
  char *name = NULL;
  for (size_t o = 0; !name && o < json_array_size(outputs); o++) {
    const char *output = json_string_value(json_array_get(outputs, o));
    bool is_grid = maker->given->no_grid || cli_is_extension(output, maker->given->format);
    static const char *const unseen[] = {"png", "json", "vox", "variants", NULL};
    if (is_grid && cli_read_choice(batch_extension(output), unseen) < 0)
      name = strdup(output);
  }
  json_decref(job);
  return name;
}

static bool draw(const batch_item *item, const char *path, const char *picture, void *payload) {
  static const char *const usual[] = {"--size=192x144", "--quiet", "--progress=never", "--threads=1"};
  const batch_maker *maker = payload;
  batch_words words = {0};
  if (batch_signal())
    return false;
  bool good = batch_words_add(&words, "view") && batch_words_add(&words, "-o") &&
              batch_words_add(&words, "%s", picture) && batch_add_up(&words, maker->given, item);
  for (size_t u = 0; u < sizeof usual / sizeof *usual; u++)
    good = good && batch_words_add(&words, "%s", usual[u]);
  good = good && batch_words_add(&words, "%s", path) && batch_run_command(words.words, -1, 20) == CLI_DONE;
  batch_words_free(&words);
  return good;
}

/** Whether the summary.json that is there, which is written last, is this one already. */
static bool is_up_to_date(const char *output, const json_t *summary) {
  char *path = NULL;
  json_t *there = asprintf(&path, "%s/summary.json", output) >= 0 ? json_load_file(path, 0, NULL) : NULL;
  bool same = there && json_equal(json_object_get(there, "counts"), json_object_get(summary, "counts")) &&
              json_equal(json_object_get(there, "output_bytes"), json_object_get(summary, "output_bytes")) &&
              json_equal(json_object_get(there, "records"), json_object_get(summary, "records"));
  json_decref(there);
  free(path);
  return same;
}

bool batch_tell(json_t **summary, const batch_maker *maker, batch_error *error) {
  batch_state state;
  batch_summary_hooks hooks = {(int)maker->given->pictures, command_line, viewed, draw,
                               (void *)(uintptr_t)maker};
  if (!batch_state_read(&state, maker->output, error))
    return false;
  *summary = batch_summary_json(&state);
  bool good = state.complete < state.shards || is_up_to_date(maker->output, *summary) ||
              batch_summary_write(&state, maker->output, &hooks, error);
  batch_state_free(&state);
  return good;
}
