/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch: its options. Those of voxelize stand beside them. */
#include "cli/batch.h"
#include "cli/voxelize.h"

#include <inttypes.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

const char *const batch_refused[] = {"confidence", "coords", "dry-run", "output", "force", NULL};

/* ---- Values ---- */

/** "timeout,oom", "all" */
static int take_retry(cli_run *cli, const cli_option *option, const char *value, void *member) {
  bool *retry = member;
  char list[256];
  if (strlen(value) >= sizeof list)
    return cli_usage(cli, "--%s '%s' is too long", option->name, value);
  strcpy(list, value);
  char *rest = list;
  for (char *word; (word = strsep(&rest, ","));) {
    batch_status status = batch_status_of(word);
    bool is_all = strcmp(word, "all") == 0;
    if (!is_all && (status == BATCH_STATUSES || status <= BATCH_OK || status == BATCH_DUPLICATE))
      return cli_usage(
          cli, "--%s '%s' is none of timeout, oom, crash, failed, unreadable, quarantined, degraded, all",
          option->name, word);
    for (int s = BATCH_DEGRADED; s < BATCH_STATUSES; s++)
      if (s != BATCH_DUPLICATE && (is_all || s == (int)status))
        retry[s] = true;
  }
  return CLI_END;
}

/** The number in an array of jobs that this one has. */
static const char *from_variable(const char *word, size_t length) {
  static const struct {
    const char *name, *variable;
  } known[] = {{"slurm", "SLURM_ARRAY_TASK_ID"},
               {"kubernetes", "JOB_COMPLETION_INDEX"},
               {"aws", "AWS_BATCH_JOB_ARRAY_INDEX"}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strlen(known[k].name) == length && strncmp(known[k].name, word, length) == 0)
      return known[k].variable;
  return NULL;
}

static int take_shard(cli_run *cli, const cli_option *option, const char *value, void *request) {
  batch_request *out = request;
  const char *slash = strchr(value, '/');
  char number[32] = "";
  size_t length = slash ? (size_t)(slash - value) : 0;
  if (!slash || length >= sizeof number || !cli_read_integer(&out->shards, slash + 1, 1, 1000000))
    return cli_usage(cli, "--%s '%s' is not I/N, such as 0/16 or slurm/16", option->name, value);
  memcpy(number, value, length);
  const char *variable = from_variable(value, length), *given = variable ? getenv(variable) : number;
  if (variable && !given)
    return cli_usage(cli, "--%s '%s': the variable %s is not set", option->name, value, variable);
  if (!cli_read_integer(&out->shard, given, 0, out->shards - 1))
    return cli_usage(cli, "--%s '%s': '%s' is not a number from 0 to %lld", option->name, value, given,
                     (long long)out->shards - 1);
  return CLI_END;
}

/** The limit of each mesh; cmd_batch.c sees to it that it does not bind this program. */
static int take_memory(cli_run *cli, const cli_option *option, const char *value, void *request) {
  (void)request;
  return cli_take_size(cli, option, value, &cli->limits.memory_limit);
}

/** All but .png, which is a file for each slice. */
static cli_formats grid_formats(void) {
  return cli_formats_without(cli_formats_with(VXM_FORMAT_BITS | VXM_FORMAT_COLORS), "png");
}

static int take_format(cli_run *cli, const cli_option *option, const char *value, void *member) {
  cli_formats formats = grid_formats();
  int choice;
  cli_take_text(cli, option, value, member);
  return cli_choose(cli, &choice, option->name, value, formats.name);
}

/* ---- Options that are handed on ---- */

/** "--name=value", or "--name" of an option that takes none. */
static int hand_on(cli_run *cli, batch_words *words, const cli_option *option, const char *value) {
  bool good = option->argument ? batch_words_add(words, "--%s=%s", option->name, value)
                               : batch_words_add(words, "--%s", option->name);
  return good ? CLI_END : cli_usage(cli, "out of memory: free some");
}

/* Those of an export go to what writes it. */

static int export_text(cli_run *cli, const cli_option *option, const char *value, void *words) {
  return hand_on(cli, words, option, value);
}

static int export_size(cli_run *cli, const cli_option *option, const char *value, void *words) {
  char number[24];
  uint64_t bytes;
  if (!cli_read_size(&bytes, value) || bytes == 0 || bytes > INT64_MAX)
    return cli_usage(cli, "--%s '%s' is not a size such as 512M or 4G", option->name, value);
  snprintf(number, sizeof number, "%" PRIu64, bytes);
  return hand_on(cli, words, option, number);
}

static int export_seed(cli_run *cli, const cli_option *option, const char *value, void *words) {
  int64_t seed;
  if (!cli_read_integer(&seed, value, 0, INT64_MAX))
    return cli_usage(cli, "--%s '%s' is not a number from 0 on", option->name, value);
  return hand_on(cli, words, option, value);
}

static int export_choice(cli_run *cli, const cli_option *option, const char *value, void *words) {
  int choice;
  if (cli_choose(cli, &choice, option->name, value, option->to.choices) == CLI_STOP)
    return CLI_STOP;
  return hand_on(cli, words, option, value);
}

/** An option of voxelize. Those that name a file are refused: each mesh would write the same. */
static int take_grid_option(cli_run *cli, batch_request *out, const cli_option *option, const char *value) {
  if (cli_is_refused(cli->command, option->name))
    return cli_usage(cli, "--%s is about one mesh; leave it out of a batch", option->name);
  return hand_on(cli, &out->grid_options, option, value);
}

/* ---- The table ---- */

static const char *const contents[] = {"bits", "files", NULL};
static const char *const zarr_formats[] = {"2", "3", NULL};

const cli_option batch_options[] = {
    {'o', "output", "DIR", "folder of what is made; its folders are those of the inputs",
     CLI_TEXT(batch_request, output)},
    {0, "format", "F",
     "of the grids: binvox, npy, raw, rle, nrrd, vdb, octree, bt, nii, nii.gz, vti, vtk,\n"
     "tif, h5, zarr, obj, ply, stl, off, glb, vox, schem or litematic [binvox]",
     CLI_VALUE(take_format, batch_request, format)},
    {0, "repair", "OPTIONS",
     "write the repaired meshes too, with these options of 'voxmend repair', such as\n"
     "\"--level closed --format ply\"",
     CLI_TEXT(batch_request, products[BATCH_REPAIRED])},
    {0, "remesh", "OPTIONS", "write meshes by 'voxmend remesh' too, with these options",
     CLI_TEXT(batch_request, products[BATCH_REMESHED])},
    {0, "augment", "OPTIONS",
     "write a folder of variants of each by 'voxmend augment' too; model numbers count from\n"
     "its --model on, in the order of names",
     CLI_TEXT(batch_request, products[BATCH_VARIANTS])},
    {0, "view", "OPTIONS", "write a picture of each grid by 'voxmend view' too",
     CLI_TEXT(batch_request, products[BATCH_PICTURE])},
    {0, "reports", NULL, "write the report of each mesh beside what is made of it, as .report.json",
     CLI_FLAG(batch_request, reports)},
    {0, "no-grid", NULL, "make no grids, only what the options above ask for",
     CLI_FLAG(batch_request, no_grid)},
    {'j', "jobs", "N", "meshes at a time [one per processor]", CLI_NUMBER(batch_request, jobs, 1, 512)},
    {0, "threads", "N", "threads for each mesh, 1 to 256 [1]", CLI_NUMBER(batch_request, threads, 1, 256)},
    {0, "time-limit", "SECONDS", "end a mesh that takes longer; 0 = never [300]",
     CLI_REAL(batch_request, time_limit, 0, 1e9, "a number of seconds")},
    {0, "memlimit", "SIZE",
     "end a mesh that takes more memory, such as 512M or 4G [four fifths of the\n"
     "memory over -j; what needs more runs once more, alone, with all of it]",
     CLI_VALUES(take_memory)},
    {0, "file-limit", "SIZE", "largest file that may be written [64G]", CLI_SIZE(batch_request, file_limit)},
    {0, "retry", "LIST",
     "do again what ended so in a run before, also where its file has been mended since:\n"
     "timeout, oom, crash, failed, unreadable, quarantined, degraded (done, with\n"
     "warnings), or all of these",
     CLI_VALUE(take_retry, batch_request, retry)},
    {0, "shard", "I/N",
     "only every N-th mesh, from the I-th on, I from 0 to N-1: each of N machines takes\n"
     "one; I may be slurm, kubernetes or aws: from the variable of an array of jobs",
     CLI_VALUES(take_shard)},
    {0, "dry-run", "N", "make N meshes of all in a folder that is dropped, and tell what all will take",
     CLI_NUMBER(batch_request, sample, 1, 100000)},
    {0, "pictures", "N", "show so many of the worst in index.html [48]",
     CLI_NUMBER(batch_request, pictures, 0, 2000)},
    {0, "to", "sqlite|parquet|webdataset|zarr",
     "what 'export' writes; the last three need the Python package", CLI_TEXT(batch_request, to)},
    {0, "max-bytes", "SIZE", "export, webdataset: of a tar [256M]",
     CLI_VALUE(export_size, batch_request, export_options)},
    {0, "content", "bits|files",
     "export, webdataset: grids, eight voxels a byte, or all files as they are [bits]",
     CLI_VALUE(export_choice, batch_request, export_options, .choices = contents)},
    {0, "shuffle", "SEED", "export, webdataset: meshes in an order that is drawn by this number",
     CLI_VALUE(export_seed, batch_request, export_options)},
    {0, "split", "NAME", "export, zarr: only meshes of this split, such as train",
     CLI_VALUE(export_text, batch_request, export_options)},
    {0, "chunk-bytes", "SIZE", "export, zarr: of a chunk of grids [4M]",
     CLI_VALUE(export_size, batch_request, export_options)},
    {0, "zarr-format", "2|3", "export, zarr: version of the format [that of the package zarr]",
     CLI_VALUE(export_choice, batch_request, export_options, .choices = zarr_formats)},
    CLI_OPTIONS_END};

static int processors(void) {
  cpu_set_t set;
  int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  return count < 1 ? 1 : count > 512 ? 512 : count;
}

/** CLI_OPTIONS_READ have gone into cli->read; the programs that make the grids need them as words. */
static bool hand_on_reading(const cli_run *cli, batch_words *words) {
  const vxm_mesh_read_options usual = VXM_MESH_READ_OPTIONS_INIT;
  bool good = true;
  if (cli->read.external != usual.external)
    good = batch_words_add(words, "--external=%s", cli_external_files[cli->read.external]);
  if (cli->read.deflection != usual.deflection)
    good = good && batch_words_add(words, "--deflection=%.17g", cli->read.deflection);
  return good;
}

/** Whether an option is one of the batch itself, not one of voxelize. */
static bool is_own(const cli_option *option) {
  for (const cli_option *own = batch_options; own->name; own++)
    if (own == option)
      return true;
  return false;
}

static bool is_of_export(const cli_option *option) {
  static const char *const others[] = {"output", "to", NULL};
  return option->to.at == offsetof(batch_request, export_options) ||
         cli_read_choice(option->name, others) >= 0;
}

static int read_options(cli_run *cli, batch_request *out) {
  const cli_option *option;
  const char *value;
  while (cli_next_option(cli, &option, &value) == CLI_END) {
    if (!option)
      return CLI_END;
    if (!is_own(option) || !is_of_export(option))
      out->of_run = option->name;
    if ((is_own(option) ? cli_take_option(cli, option, value, out)
                        : take_grid_option(cli, out, option, value)) == CLI_STOP)
      return CLI_STOP;
  }
  return CLI_STOP;
}

int batch_read_arguments(cli_run *cli, batch_request *out) {
  if (read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  out->dry_run = out->sample > 0;
  if (!hand_on_reading(cli, &out->grid_options))
    return cli_usage(cli, "out of memory: free some");
  if (out->jobs == 0)
    out->jobs = processors();
  if (out->no_grid && out->grid_options.count > 0)
    return cli_usage(cli, "%s is about grids, and --no-grid makes none", out->grid_options.words[0]);
  bool makes_any = !out->no_grid;
  for (int p = 0; p < BATCH_PRODUCTS; p++)
    makes_any = makes_any || out->products[p];
  return makes_any ? CLI_END : cli_usage(cli, "--no-grid leaves nothing to be made");
}
