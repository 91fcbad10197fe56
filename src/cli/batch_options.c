/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch: its options. Those of voxelize stand beside them. */
#include "cli/batch.h"
#include "cli/voxelize.h"

#include <inttypes.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

enum {
  KEY_REPAIR = CLI_KEY_COMMAND + 200,
  KEY_REMESH,
  KEY_AUGMENT,
  KEY_VIEW,
  KEY_NO_GRID,
  KEY_REPORTS,
  KEY_THREADS,
  KEY_TIME_LIMIT,
  KEY_FILE_LIMIT,
  KEY_RETRY,
  KEY_SHARD,
  KEY_DRY_RUN,
  KEY_PICTURES,
  KEY_FORMAT,
  KEY_MEMLIMIT,
  KEY_TO, /* from here on of an export */
  KEY_MAX_BYTES,
  KEY_CONTENT,
  KEY_SHUFFLE,
  KEY_SPLIT,
  KEY_CHUNK_BYTES,
  KEY_ZARR_FORMAT
};

const char *const batch_refused[] = {"confidence", "coords", "dry-run", "output", "force", NULL};

const cli_option batch_options[] = {
    {'o', "output", "DIR", "folder of what is made; its folders are those of the inputs"},
    {KEY_FORMAT, "format", "F",
     "of the grids: binvox, npy, raw, rle, nrrd, vdb, octree, bt, nii, nii.gz, vti, vtk,\n"
     "tif, h5, zarr, obj, ply, stl, off, glb, vox, schem or litematic [binvox]"},
    {KEY_REPAIR, "repair", "OPTIONS",
     "write the repaired meshes too, with these options of 'voxmend repair', such as\n"
     "\"--level closed --format ply\""},
    {KEY_REMESH, "remesh", "OPTIONS", "write meshes by 'voxmend remesh' too, with these options"},
    {KEY_AUGMENT, "augment", "OPTIONS",
     "write a folder of variants of each by 'voxmend augment' too; model numbers count from\n"
     "its --model on, in the order of names"},
    {KEY_VIEW, "view", "OPTIONS", "write a picture of each grid by 'voxmend view' too"},
    {KEY_REPORTS, "reports", NULL,
     "write the report of each mesh beside what is made of it, as .report.json"},
    {KEY_NO_GRID, "no-grid", NULL, "make no grids, only what the options above ask for"},
    {'j', "jobs", "N", "meshes at a time [one per processor]"},
    {KEY_THREADS, "threads", "N", "threads for each mesh, 1 to 256 [1]"},
    {KEY_TIME_LIMIT, "time-limit", "SECONDS", "end a mesh that takes longer; 0 = never [300]"},
    {KEY_MEMLIMIT, "memlimit", "SIZE",
     "end a mesh that takes more memory, such as 512M or 4G [four fifths of the\n"
     "memory over -j; what needs more runs once more, alone, with all of it]"},
    {KEY_FILE_LIMIT, "file-limit", "SIZE", "largest file that may be written [64G]"},
    {KEY_RETRY, "retry", "LIST",
     "do again what ended so in a run before, also where its file has been mended since:\n"
     "timeout, oom, crash, failed, unreadable, quarantined, degraded (done, with\n"
     "warnings), or all of these"},
    {KEY_SHARD, "shard", "I/N",
     "only every N-th mesh, from the I-th on, I from 0 to N-1: each of N machines takes\n"
     "one; I may be slurm, kubernetes or aws: from the variable of an array of jobs"},
    {KEY_DRY_RUN, "dry-run", "N",
     "make N meshes of all in a folder that is dropped, and tell what all will take"},
    {KEY_PICTURES, "pictures", "N", "show so many of the worst in index.html [48]"},
    {KEY_TO, "to", "sqlite|parquet|webdataset|zarr",
     "what 'export' writes; the last three need the Python package"},
    {KEY_MAX_BYTES, "max-bytes", "SIZE", "export, webdataset: of a tar [256M]"},
    {KEY_CONTENT, "content", "bits|files",
     "export, webdataset: grids, eight voxels a byte, or all files as they are [bits]"},
    {KEY_SHUFFLE, "shuffle", "SEED", "export, webdataset: meshes in an order that is drawn by this number"},
    {KEY_SPLIT, "split", "NAME", "export, zarr: only meshes of this split, such as train"},
    {KEY_CHUNK_BYTES, "chunk-bytes", "SIZE", "export, zarr: of a chunk of grids [4M]"},
    {KEY_ZARR_FORMAT, "zarr-format", "2|3", "export, zarr: version of the format [that of the package zarr]"},
    {0, NULL, NULL, NULL}};

/* ---- Values ---- */

/** "timeout,oom", "all" */
static int read_retry(cli_run *cli, batch_request *out, const char *value) {
  char list[256];
  if (strlen(value) >= sizeof list)
    return cli_usage(cli, "--retry '%s' is too long", value);
  strcpy(list, value);
  char *rest = list;
  for (char *word; (word = strsep(&rest, ","));) {
    batch_status status = batch_status_of(word);
    bool is_all = strcmp(word, "all") == 0;
    if (!is_all && (status == BATCH_STATUSES || status <= BATCH_OK || status == BATCH_DUPLICATE))
      return cli_usage(
          cli, "--retry '%s' is none of timeout, oom, crash, failed, unreadable, quarantined, degraded, all",
          word);
    for (int s = BATCH_DEGRADED; s < BATCH_STATUSES; s++)
      if (s != BATCH_DUPLICATE && (is_all || s == (int)status))
        out->retry[s] = true;
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

static int read_shard(cli_run *cli, batch_request *out, const char *value) {
  const char *slash = strchr(value, '/');
  char number[32] = "";
  size_t length = slash ? (size_t)(slash - value) : 0;
  if (!slash || length >= sizeof number || !cli_read_integer(&out->shards, slash + 1, 1, 1000000))
    return cli_usage(cli, "--shard '%s' is not I/N, such as 0/16 or slurm/16", value);
  memcpy(number, value, length);
  const char *variable = from_variable(value, length), *given = variable ? getenv(variable) : number;
  if (variable && !given)
    return cli_usage(cli, "--shard '%s': the variable %s is not set", value, variable);
  if (!cli_read_integer(&out->shard, given, 0, out->shards - 1))
    return cli_usage(cli, "--shard '%s': '%s' is not a number from 0 to %lld", value, given,
                     (long long)out->shards - 1);
  return CLI_END;
}

static int read_count(cli_run *cli, int64_t *out, const char *option, const char *value, int64_t low,
                      int64_t high) {
  if (cli_read_integer(out, value, low, high))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a number from %lld to %lld", option, value, (long long)low,
                   (long long)high);
}

/** Options of voxelize that name a file: each mesh would write the same. */
static int refuse_file(cli_run *cli, const char *name) {
  return cli_usage(cli, "--%s is about one mesh; leave it out of a batch", name);
}

/** Of one of the lists; its name is NULL if it is in none. */
static const cli_option *option_of(int key, const cli_option *options) {
  while (options->name && options->key != key)
    options++;
  return options;
}

/** An option of an export is handed on to what writes it, sizes as numbers. */
static int take_export_option(cli_run *cli, batch_request *out, int key, const char *value) {
  const cli_option *option = option_of(key, batch_options);
  static const char *const contents[] = {"bits", "files", NULL}, *const formats[] = {"2", "3", NULL};
  char number[24];
  uint64_t bytes;
  int64_t seed;
  int choice;
  if (key == KEY_MAX_BYTES || key == KEY_CHUNK_BYTES) {
    if (!cli_read_size(&bytes, value) || bytes == 0 || bytes > INT64_MAX)
      return cli_usage(cli, "--%s '%s' is not a size such as 512M or 4G", option->name, value);
    snprintf(number, sizeof number, "%" PRIu64, bytes);
    value = number;
  }
  if (key == KEY_SHUFFLE && !cli_read_integer(&seed, value, 0, INT64_MAX))
    return cli_usage(cli, "--shuffle '%s' is not a number from 0 on", value);
  if (key == KEY_CONTENT && cli_choose(cli, &choice, "content", value, contents) == CLI_STOP)
    return CLI_STOP;
  if (key == KEY_ZARR_FORMAT && cli_choose(cli, &choice, "zarr-format", value, formats) == CLI_STOP)
    return CLI_STOP;
  bool good = batch_words_add(&out->export_options, "--%s=%s", option->name, value);
  return good ? CLI_END : cli_usage(cli, "out of memory: free some");
}

/** An option of voxelize is handed on as it is. */
static int take_grid_option(cli_run *cli, batch_request *out, int key, const char *value) {
  const cli_option *option = option_of(key, voxelize_options);
  if (!option->name)
    return cli_usage(cli, "an option is not known");
  if (cli_is_refused(cli->command, option->name))
    return refuse_file(cli, option->name);
  bool good = option->argument ? batch_words_add(&out->grid_options, "--%s=%s", option->name, value)
                               : batch_words_add(&out->grid_options, "--%s", option->name);
  return good ? CLI_END : cli_usage(cli, "out of memory: free some");
}

/** A picture for each slice is no file of a grid. */
static cli_formats grid_formats(void) {
  return cli_formats_without(cli_formats_with(VXM_FORMAT_BITS | VXM_FORMAT_COLORS), "png");
}

static int read_format(cli_run *cli, const char *value) {
  cli_formats formats = grid_formats();
  return cli_read_choice(value, formats.name) >= 0
             ? CLI_END
             : cli_usage(cli, "--format '%s' is none of %s", value,
                         cli_list((char[CLI_LIST_MAX]){""}, formats.name));
}

static int read_option(cli_run *cli, batch_request *out, int key, const char *value) {
  if (key > KEY_TO && key <= KEY_ZARR_FORMAT)
    return take_export_option(cli, out, key, value);
  if (key != 'o' && key != KEY_TO) {
    const cli_option *own = option_of(key, batch_options);
    out->of_run = own->name ? own->name : option_of(key, voxelize_options)->name;
  }
  switch (key) {
  case 'o':
    out->output = value;
    return CLI_END;
  case 'j':
    return read_count(cli, &out->jobs, "jobs", value, 1, 512);
  case KEY_FORMAT:
    out->format = value;
    return read_format(cli, value);
  case KEY_REPAIR:
    out->products[BATCH_REPAIRED] = value;
    return CLI_END;
  case KEY_REMESH:
    out->products[BATCH_REMESHED] = value;
    return CLI_END;
  case KEY_AUGMENT:
    out->products[BATCH_VARIANTS] = value;
    return CLI_END;
  case KEY_VIEW:
    out->products[BATCH_PICTURE] = value;
    return CLI_END;
  case KEY_NO_GRID:
    out->no_grid = true;
    return CLI_END;
  case KEY_REPORTS:
    out->reports = true;
    return CLI_END;
  case KEY_THREADS:
    return read_count(cli, &out->threads, "threads", value, 1, 256);
  case KEY_TIME_LIMIT:
    return cli_read_number(&out->time_limit, value) && out->time_limit >= 0 && out->time_limit < 1e9
               ? CLI_END
               : cli_usage(cli, "--time-limit '%s' is not a number of seconds", value);
  case KEY_MEMLIMIT:
    return cli_read_size(&cli->limits.memory_limit, value)
               ? CLI_END
               : cli_usage(cli, "--memlimit '%s' is not a size such as 512M or 4G", value);
  case KEY_FILE_LIMIT:
    return cli_read_size(&out->file_limit, value)
               ? CLI_END
               : cli_usage(cli, "--file-limit '%s' is not a size such as 512M or 4G", value);
  case KEY_RETRY:
    return read_retry(cli, out, value);
  case KEY_SHARD:
    return read_shard(cli, out, value);
  case KEY_DRY_RUN:
    out->dry_run = true;
    return read_count(cli, &out->sample, "dry-run", value, 1, 100000);
  case KEY_TO:
    out->to = value;
    return CLI_END;
  case KEY_PICTURES:
    return read_count(cli, &out->pictures, "pictures", value, 0, 2000);
  default:
    return take_grid_option(cli, out, key, value);
  }
}

static int processors(void) {
  cpu_set_t set;
  int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  return count < 1 ? 1 : count > 512 ? 512 : count;
}

/** How meshes are read has been taken for this program (CLI_OPTIONS_READ), and is for those that make grids.
 */
static bool hand_on_reading(const cli_run *cli, batch_words *words) {
  static const char *const external[] = {"folder", "any", "none"}; /* in the order of the enumeration */
  const vxm_mesh_read_options usual = VXM_MESH_READ_OPTIONS_INIT;
  bool good = true;
  if (cli->read.external != usual.external)
    good = batch_words_add(words, "--external=%s", external[cli->read.external]);
  if (cli->read.deflection != usual.deflection)
    good = good && batch_words_add(words, "--deflection=%.17g", cli->read.deflection);
  return good;
}

int batch_read_arguments(cli_run *cli, batch_request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END)
    if (key == CLI_STOP || read_option(cli, out, key, value) == CLI_STOP)
      return CLI_STOP;
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
