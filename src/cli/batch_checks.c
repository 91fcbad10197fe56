/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch status and verify: what has become of a batch. */
#include "batch/summary.h"
#include "batch/tally.h"
#include "batch/verify.h"
#include "cli/batch.h"

#include <inttypes.h>

static int fail(cli_run *cli, const batch_error *error) {
  return cli_fail_text(cli, "%s", error->text);
}

int batch_status_command(cli_run *cli, const char *folder) {
  batch_state state;
  batch_error error;
  int64_t counts[BATCH_STATUSES];
  char text[320];
  if (!batch_state_read(&state, folder, &error))
    return fail(cli, &error);
  batch_state_count(&state, counts);
  if (cli_summary(cli)) {
    cli_row(cli, "meshes", "%" PRId64 ", %" PRId64 " to be done", state.manifest.count,
            counts[BATCH_PENDING]);
    cli_row(cli, "result", "%s", batch_counts_text(text, counts));
    cli_row(cli, "shards", "%d of %d at their end", state.complete, state.shards);
  }
  if (state.damaged > 0)
    cli_warn(cli,
             "%s: %" PRId64
             " lines of its journals are damaged; what they told is done again by the next run",
             folder, state.damaged);
  json_t *summary = batch_summary_json(&state);
  batch_state_free(&state);
  return cli_finish(cli, summary);
}

static void tell(const char *line, void *payload) {
  cli_run *cli = payload;
  cli_warn(cli, "%s", line);
}

int batch_verify_command(cli_run *cli, const char *folder) {
  batch_verification found;
  batch_error error;
  if (!batch_verify(&found, folder, tell, cli, &error))
    return fail(cli, &error);
  int64_t bad = found.missing + found.changed + found.damaged;
  if (cli_summary(cli))
    cli_row(cli, "outputs",
            "%" PRId64 ": %" PRId64 " missing, %" PRId64 " changed; %" PRId64
            " damaged lines of journals, %" PRId64 " files left behind, %" PRId64 " meshes to be done",
            found.files, found.missing, found.changed, found.damaged, found.strangers, found.unfinished);
  json_t *report = json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "outputs", (json_int_t)found.files, "missing",
                             (json_int_t)found.missing, "changed", (json_int_t)found.changed,
                             "damaged_journal_lines", (json_int_t)found.damaged, "left_behind",
                             (json_int_t)found.strangers, "pending", (json_int_t)found.unfinished);
  int status = cli_finish(cli, report);
  if (status == CLI_DONE && bad > 0)
    return cli_fail_text(cli,
                         "%s: not all is as it was written; remove what has changed, and the command of the "
                         "batch makes what is missing again",
                         folder);
  return status;
}
