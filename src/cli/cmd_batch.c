/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch: whole datasets. */
#include "batch/outputs.h"
#include "batch/plan.h"
#include "batch/tally.h"
#include "cli/batch.h"
#include "cli/voxelize.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysinfo.h>
#include <unistd.h>

static int fail(cli_run *cli, const batch_error *error) {
  return cli_fail_text(cli, "%s", error->text);
}

/* ---- Limits ---- */

/** Memory of the machine, or of the container that this is in. */
static uint64_t memory_bytes(void) {
  struct sysinfo info;
  uint64_t bytes = sysinfo(&info) == 0 ? (uint64_t)info.totalram * info.mem_unit : UINT64_C(4) << 30;
  unsigned long long limit = 0;
  FILE *file = fopen("/sys/fs/cgroup/memory.max", "re");
  if (file && fscanf(file, "%llu", &limit) == 1 && limit > 0 && limit < bytes)
    bytes = limit;
  if (file)
    fclose(file);
  return bytes;
}

static batch_limits limits_of(const cli_run *cli, const batch_request *given) {
  uint64_t share = memory_bytes() / 5 * 4 / (uint64_t)given->jobs;
  return (batch_limits){.seconds = given->time_limit,
                        .memory = cli->limits.memory_limit ? cli->limits.memory_limit : share,
                        .file_bytes = given->file_limit};
}

/* ---- Inputs ---- */

static bool make_folder(const char *path, batch_error *error) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST)
    return true;
  return batch_fail_errno(error, "%s: cannot make the folder", path);
}

/* ---- A run ---- */

static void summarize(const cli_run *cli, const batch_request *given, const batch_manifest *manifest,
                      const batch_tally *tally, bool has_all) {
  char counts[320], time[40];
  double seconds = (batch_clock_ms() - tally->started_ms) / 1000;
  if (!cli_summary(cli))
    return;
  cli_row(cli, "meshes", "%" PRId64 "%s", tally->total, given->shards > 1 ? " of this shard" : "");
  if (manifest->passed_over > 0)
    cli_row(cli, "passed over", "%" PRId64 " files that are no meshes:%s", manifest->passed_over,
            manifest->note);
  cli_row(cli, "result", "%s", batch_counts_text(counts, tally->counts));
  if (tally->counts[BATCH_DEGRADED] > 0)
    cli_row(cli, "degraded", "made all the same, with warnings: open meshes, lost parts and the like; %s",
            has_all ? "the page tells each" : "'voxmend batch status' counts them");
  if (tally->done_before > 0)
    cli_row(cli, "before", "%" PRId64 " of them in a run before", tally->done_before);
  if (tally->fresh > 0)
    cli_row(cli, "time", "%s, %.3g meshes a second, %" PRId64 " at a time",
            batch_duration_text(time, seconds), (double)tally->fresh / (seconds > 0.001 ? seconds : 0.001),
            given->jobs);
  int64_t bad = tally->total - tally->counts[BATCH_OK] - tally->counts[BATCH_DEGRADED] -
                tally->counts[BATCH_DUPLICATE] - tally->counts[BATCH_PENDING];
  if (has_all && bad > 0)
    cli_row(cli, "failures", "%s/failures.tsv, with a command for each that repeats it", given->output);
  if (has_all)
    cli_row(cli, "page", "%s/index.html", given->output);
}

static int finish(cli_run *cli, const batch_maker *maker, const batch_manifest *manifest,
                  const batch_tally *tally, batch_outcome outcome, batch_error *error) {
  const batch_request *given = maker->given;
  if (outcome == BATCH_BROKEN)
    return fail(cli, error);
  json_t *summary = NULL;
  if (outcome == BATCH_COMPLETE && !batch_tell(&summary, maker, error)) {
    json_decref(summary);
    return fail(cli, error);
  }
  summarize(cli, given, manifest, tally,
            json_equal(json_object_get(summary, "shards"), json_object_get(summary, "complete_shards")));
  if (outcome == BATCH_INTERRUPTED) {
    json_decref(summary);
    fprintf(stderr, "voxmend: interrupted: %" PRId64 " of %" PRId64 " are left; the same command goes on\n",
            tally->counts[BATCH_PENDING], tally->total);
    cli_set_signal(abs(batch_signal()));
    return CLI_FAILED;
  }
  int64_t bad = 0;
  for (int s = BATCH_UNREADABLE; s < BATCH_STATUSES; s++)
    bad += tally->counts[s];
  if (bad > 0)
    cli->warning_count++; /* for --strict */
  return cli_finish(cli, summary ? summary : json_object());
}

static batch_settings settings_of(const cli_run *cli, batch_maker *maker, batch_zygote *zygote) {
  const batch_request *given = maker->given;
  bool is_auto = strcmp(cli->progress, "auto") == 0;
  batch_settings settings = {.output = given->output,
                             .shard = (int)given->shard,
                             .shards = (int)given->shards,
                             .jobs = (int)given->jobs,
                             .limits = limits_of(cli, given),
                             .alone_memory = cli->limits.memory_limit ? 0 : memory_bytes() / 5 * 4,
                             .job = batch_make_job,
                             .work = batch_do_job,
                             .zygote = zygote,
                             .payload = maker,
                             .shows_progress = isatty(STDERR_FILENO),
                             .is_quiet =
                                 cli->quiet || strcmp(cli->progress, "never") == 0 || (is_auto && cli->json)};
  memcpy(settings.retry, given->retry, sizeof settings.retry);
  return settings;
}

static int run_batch(cli_run *cli, batch_maker *maker, batch_zygote *zygote, batch_manifest *manifest) {
  const batch_request *given = maker->given;
  batch_settings settings = settings_of(cli, maker, zygote);
  batch_error error;
  batch_tally tally;
  if (given->dry_run)
    return batch_dry_run(cli, manifest, &settings, maker);
  json_t *plan = batch_make_settings(given);
  bool good = batch_outputs_check(manifest, &settings, &error) && make_folder(given->output, &error) &&
              batch_plan_freeze(manifest, plan, &settings, &error);
  json_decref(plan);
  if (!good)
    return fail(cli, &error);
  batch_outcome outcome = batch_run(&tally, manifest, &settings, &error);
  return finish(cli, maker, manifest, &tally, outcome, &error);
}

/** As many open files as the system lets us have: each child takes two pipes and a socket. */
static void allow_descriptors(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
    return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

static int run_inputs(cli_run *cli, const batch_request *given, batch_maker *maker) {
  batch_error error;
  batch_manifest manifest;
  batch_zygote zygote;
  const char **extensions = cli_mesh_extensions();
  batch_inputs inputs = {cli->arguments, cli->argument_count, extensions, given->output};
  int status = CLI_FAILED;
  allow_descriptors();
  if (!extensions || !batch_zygote_start(&zygote, batch_do_job, maker, &error))
    return fail(cli, &error);
  bool good = batch_inputs_read(&manifest, &inputs, &error);
  if (good && *manifest.warning)
    cli_warn(cli, "%s", manifest.warning);
  if (good)
    status = run_batch(cli, maker, &zygote, &manifest);
  else
    status = fail(cli, &error);
  batch_zygote_end(&zygote);
  batch_manifest_free(&manifest);
  cli_mesh_extensions_free(extensions);
  return status;
}

/* ---- What has become of it ---- */

static bool is_check(const char *word) {
  static const char *const checks[] = {"status", "verify", "export", NULL};
  return cli_read_choice(word, checks) >= 0;
}

static int check(cli_run *cli, const batch_request *given) {
  const char *word = cli->arguments[0], *folder = cli->arguments[1];
  bool is_export = *word == 'e';
  if (given->of_run)
    return cli_usage(cli, "--%s is for making a batch, not for 'voxmend batch %s'", given->of_run, word),
           cli->status;
  if (!is_export && (given->output || given->to || given->export_options.count > 0))
    return cli_usage(cli, "'voxmend batch %s' takes a folder alone; -o, --to and the like are for export",
                     word),
           cli->status;
  if (is_export)
    return batch_export_command(cli, folder, given);
  if (!cli_start(cli))
    return CLI_FAILED;
  return *word == 's' ? batch_status_command(cli, folder) : batch_verify_command(cli, folder);
}

/** Runs the batch, or tells of one, as the command line says. */
static int run_or_check(cli_run *cli, batch_request *given) {
  if (cli->argument_count == 2 && is_check(cli->arguments[0]))
    return check(cli, given);
  if (given->to || given->export_options.count > 0)
    return cli_usage(cli, "%s goes with 'voxmend batch export DIR'",
                     given->to ? "--to" : given->export_options.words[0]),
           cli->status;
  if (cli->argument_count == 0)
    return cli_usage(cli, "no input is named: folders, meshes, lists or archives"), cli->status;
  if (!given->output && given->dry_run)
    given->output = "/nonexistent"; /* nothing is written there */
  if (!given->output)
    return cli_usage(cli, "-o DIR is missing"), cli->status;
  batch_maker maker = {.given = given, .output = given->output};
  if (batch_try_options(cli, &maker) == CLI_STOP)
    return cli->status;
  uint64_t each = cli->limits.memory_limit;
  cli->limits.memory_limit = 0; /* of a mesh, not of this program */
  bool started = cli_start(cli);
  cli->limits.memory_limit = each;
  return started ? run_inputs(cli, given, &maker) : CLI_FAILED;
}

static int run(cli_run *cli) {
  batch_request given = {.format = "binvox",
                         .threads = 1,
                         .shards = 1,
                         .time_limit = 300,
                         .file_limit = UINT64_C(64) << 30,
                         .pictures = 48};
  int status = batch_read_arguments(cli, &given) == CLI_STOP ? cli->status : run_or_check(cli, &given);
  batch_words_free(&given.grid_options);
  batch_words_free(&given.export_options);
  return status;
}

const cli_command cli_command_batch = {
    .name = "batch",
    .arguments = "INPUT... -o DIR [OPTION]...",
    .summary = "voxelize a whole dataset, each mesh in a process of its own",
    .notes =
        "INPUT is a folder, a mesh, a pattern in quotes, a list of paths (.txt), a table (.csv, .tsv: path,\n"
        "and any of id, class, split, options) or an archive (.tar, .tar.gz, .zip, .7z). Paths in a list or\n"
        "table begin in its folder. What crashes, hangs or takes all memory costs that mesh alone. When a\n"
        "run is ended, by whatever, the same command goes on with it. At the end DIR has index.html,\n"
        "failures.tsv and summary.json. A mesh is ok, degraded (made, with warnings, which index.html\n"
        "tells: look at those with much contested), duplicate, unreadable, failed, timeout, oom (out of\n"
        "memory), crash or quarantined (the run went down with it).\n\n"
        "  voxmend batch status DIR    what has become of its meshes, also while it runs\n"
        "  voxmend batch verify DIR    whether all outputs are there, with the bytes that were written\n"
        "  voxmend batch export DIR --to sqlite|parquet|webdataset|zarr -o PATH [OPTION]...\n\n"
        "Examples:\n"
        "  voxmend batch ModelNet40/ -o grids/ -r 64\n"
        "  voxmend batch ModelNet40.zip -o grids/ -r 64 --format npy -j 8 --time-limit 60\n"
        "  voxmend batch scans/ -o fixed/ --no-grid --repair \"--level closed --format ply\"\n"
        "  voxmend batch meshes.csv -o grids/ -r 64 --shard slurm/100\n"
        "  voxmend batch export grids/ --to webdataset -o tars/ --shuffle 1",
    .options = batch_options,
    .others = voxelize_options,
    .others_of = "voxelize",
    .others_refused = batch_refused,
    .many = true,
    .folders = true,
    .run = run,
};
