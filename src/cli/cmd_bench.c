/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend bench: how long the phases of the work take on this machine. */
#include "cli/bench.h"
#include "cli/engine.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- Options ---- */

enum { ITEM_SIZE = 32 };

/** Takes the next item of a list off *text; false at its end. An item that is too long is cut. */
static bool next_item(char item[ITEM_SIZE], const char **text) {
  if (!*text)
    return false;
  size_t length = strcspn(*text, ",");
  snprintf(item, ITEM_SIZE, "%.*s", (int)(length < ITEM_SIZE ? length : ITEM_SIZE), *text);
  *text = (*text)[length] ? *text + length + 1 : NULL;
  return true;
}

/** Numbers separated by commas, into ascending order, none twice; false if they are not. */
static bool read_list(int64_t *out, int *count, const char *text, int64_t high) {
  char item[ITEM_SIZE];
  for (*count = 0; next_item(item, &text);) {
    int64_t value;
    if (!cli_read_integer(&value, item, 1, high))
      return false;
    int place = 0;
    while (place < *count && out[place] < value)
      place++;
    if (place < *count && out[place] == value)
      continue;
    if (*count == BENCH_LIST_MAX)
      return false;
    memmove(out + place + 1, out + place, (size_t)(*count - place) * sizeof *out);
    out[place] = value;
    ++*count;
  }
  return true;
}

/** Chooses all phases of a group, such as transfer_read and transfer_map of "transfer"; false if there is no
 * such group. */
static bool choose_group(bench_plan *plan, const char *group) {
  size_t length = strlen(group);
  bool found = false;
  for (int i = 0; bench_phases[i].name; i++)
    if (length > 0 && strncmp(bench_phases[i].name, group, length) == 0 &&
        bench_phases[i].name[length] == '_')
      found = plan->chosen[i] = true;
  return found;
}

static int take_phases(cli_run *cli, const cli_option *option, const char *text, void *member) {
  bench_plan *plan = member;
  char item[ITEM_SIZE];
  const char *names[BENCH_PHASES_MAX + 1] = {NULL};
  for (int i = 0; bench_phases[i].name; i++)
    names[i] = bench_phases[i].name;
  memset(plan->chosen, 0, sizeof plan->chosen);
  plan->forced = true;
  while (next_item(item, &text)) {
    int phase;
    if (choose_group(plan, item))
      continue;
    if (cli_choose(cli, &phase, option->name, item, names) == CLI_STOP)
      return CLI_STOP;
    plan->chosen[phase] = true;
  }
  return CLI_END;
}

/** The method behind a '/' in the name of an engine. */
static int read_method(cli_run *cli, vxm_engine_options *options, const char *name) {
  const char *slash = strchr(name, '/');
  int result = CLI_END, choice = 0;
  *options = (vxm_engine_options)VXM_ENGINE_OPTIONS_INIT;
  if (!slash)
    return CLI_END;
  if (strncmp(name, "opencl", 6) == 0) {
    result = cli_choose(cli, &choice, "engine opencl/...", slash + 1, cli_cl_methods);
    options->cl_method = (vxm_cl_method)choice;
  } else if (strncmp(name, "opengl", 6) == 0) {
    result = cli_choose(cli, &choice, "engine opengl/...", slash + 1, cli_gl_methods);
    options->gl_method = (vxm_gl_method)choice;
  } else
    result = cli_usage(cli, "--engine '%s': only opencl and opengl have methods", name);
  return result;
}

static int take_engines(cli_run *cli, const cli_option *option, const char *text, void *member) {
  bench_plan *plan = member;
  char item[ITEM_SIZE];
  int result = CLI_END;
  for (plan->engine_count = 0; result == CLI_END && next_item(item, &text); plan->engine_count++) {
    if (plan->engine_count == BENCH_ENGINES_MAX)
      return cli_usage(cli, "--%s names more than %d engines", option->name, BENCH_ENGINES_MAX);
    snprintf(plan->engines[plan->engine_count], sizeof plan->engines[0], "%s", item);
    result = read_method(cli, &plan->engine_options[plan->engine_count], item);
  }
  return result;
}

static int take_cpu(cli_run *cli, const cli_option *option, const char *text, void *member) {
  (void)member;
  int level;
  if (cli_choose(cli, &level, option->name, text, bench_cpu_names) == CLI_STOP)
    return CLI_STOP;
  if (vxm_cpu_limit((vxm_cpu_level)level, &cli->error) != VXM_OK)
    return cli_usage(cli, "--%s '%s': %s", option->name, text, cli->error.file);
  return CLI_END;
}

static int take_resolutions(cli_run *cli, const cli_option *option, const char *text, void *member) {
  bench_plan *plan = member;
  (void)option;
  if (read_list(plan->resolutions, &plan->resolution_count, text, 1 << 20))
    return CLI_END;
  return cli_usage(cli, "-r '%s' is not a list such as 64,256 of numbers from 1 to 1048576", text);
}

static int take_threads(cli_run *cli, const cli_option *option, const char *text, void *member) {
  bench_plan *plan = member;
  if (read_list(plan->threads, &plan->thread_count, text, 256))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a list such as 1,2 of numbers from 1 to 256", option->name, text);
}

static int take_time(cli_run *cli, const cli_option *option, const char *text, void *member) {
  int64_t time;
  if (!cli_read_integer(&time, text, 0, 3600000))
    return cli_usage(cli, "--%s '%s' is not a number of milliseconds from 0 to 3600000", option->name, text);
  *(double *)member = (double)time;
  return CLI_END;
}

static const cli_option known_options[] = {
    {'r', "resolution", "LIST",
     "voxels along each axis, such as 64,256 [64,128,256,512,1024; with\n"
     "--augment 32,64]",
     CLI_VALUES(take_resolutions)},
    {0, "threads", "LIST", "numbers of threads, such as 1,2, each 1 to 256 [1 and one per processor]",
     CLI_VALUES(take_threads)},
    {0, "phases", "LIST",
     "what to measure, out of the phases below; named here, a phase is measured\n"
     "however slow it is; 'solid' is all that begin with solid_ [all, but what takes\n"
     "over two seconds is left out, and what needs OpenCL without --engine opencl]",
     CLI_VALUES(take_phases)},
    {0, "engine", "LIST",
     "what computes the grids, such as cpu,opencl,opencl/tiles: as in 'voxmend voxelize',\n"
     "and behind a '/' the method; others are compared with the first [cpu]",
     CLI_VALUES(take_engines)},
    {0, "augment", NULL, "measure making variants for training instead: the augment_ phases below",
     CLI_FLAG(bench_plan, augment)},
    {0, "displace", "F", "by how much the vertices of variants are displaced, as in augment [0.01]",
     CLI_REAL(bench_plan, displace, 0, 0.4, "a number from 0 to 0.4")},
    {0, "cpu", "LEVEL",
     "use the vectors of such processors and no higher: plain (SSE2), avx2 or avx512; what\n"
     "is made is the same [the highest that this processor has]",
     CLI_VALUES(take_cpu)},
    {0, "time", "MS", "repeat each for at least so many milliseconds, and at least 5 times [200]",
     CLI_VALUE(take_time, bench_plan, time_ms)},
    {0, "plot", "FILE.svg", "draw the times over the resolution", CLI_TEXT(bench_plan, plot)},
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

/** Whether any phase that depends on the resolution is chosen. */
static bool has_grids(const bench_plan *plan) {
  for (int i = 0; bench_phases[i].name; i++)
    if (plan->chosen[i] && bench_phases[i].per_grid)
      return true;
  return false;
}

/** Without -r: networks take small grids. */
static void choose_resolutions(bench_plan *plan) {
  static const int64_t usual[] = {64, 128, 256, 512, 1024, 32, 64};
  if (plan->resolution_count > 0)
    return;
  plan->resolution_count = plan->augment ? 2 : 5;
  memcpy(plan->resolutions, usual + (plan->augment ? 5 : 0), (size_t)plan->resolution_count * sizeof *usual);
}

/** Whether a phase is measured where none is named. */
static bool is_usual(const bench_plan *plan, const bench_phase *phase) {
  if (plan->augment)
    return phase->kind == BENCH_AUGMENT;
  return phase->kind == BENCH_USUAL || (phase->kind == BENCH_OPENCL && bench_names_opencl(plan));
}

static int read_arguments(cli_run *cli, bench_plan *plan) {
  for (int i = 0; bench_phases[i].name; i++)
    plan->chosen[i] = true;
  if (cli_read_options(cli, plan) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  plan->path = cli->arguments[0];
  if (plan->augment && plan->forced)
    return cli_usage(cli, "--augment and --phases both say what to measure");
  choose_resolutions(plan);
  for (int i = 0; bench_phases[i].name && !plan->forced; i++)
    plan->chosen[i] = is_usual(plan, &bench_phases[i]);
  if (strcmp(plan->path, "-") == 0)
    return cli_usage(cli, "the mesh is read many times, which standard input cannot be; name a file");
  if (plan->plot && !cli_is_extension(plan->plot, "svg"))
    return cli_usage(cli, "--plot '%s': the name must end in .svg", plan->plot);
  cli_writes(cli, "--plot", plan->plot, false);
  if (cli_check_names(cli) == CLI_STOP)
    return CLI_STOP;
  if (!has_grids(plan)) {
    if (plan->plot)
      return cli_usage(cli, "--plot shows times over the resolution, and none of the phases depends on it");
    plan->resolution_count = 0;
  }
  return CLI_END;
}

/* ---- Work ---- */

typedef struct bench_work {
  cli_run *cli;
  bench_plan plan;
  bench_subject subject;
  bench_results results;
  int done, total; /**< measurements */
} bench_work;

static int count_measurements(const bench_plan *plan) {
  int total = 0;
  for (int i = 0; bench_phases[i].name; i++)
    for (int e = 0; e < plan->engine_count; e++)
      if (plan->chosen[i] && bench_takes_part(plan, &bench_phases[i], e))
        total += bench_phases[i].per_grid ? plan->resolution_count : 1;
  return total * plan->thread_count;
}

/** Drawing takes time of its own: while the library works, its progress is only asked whether to stop. */
static int on_progress(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction, (void)payload;
  return cli_signal() != 0;
}

static int next_context(cli_run *cli, int threads) {
  vxm_context_destroy(cli->context);
  cli->context = NULL;
  cli->limits.threads = threads;
  cli->limits.progress = on_progress;
  return vxm_context_create(&cli->context, &cli->limits, &cli->error) == VXM_OK ? CLI_DONE : cli_fail(cli);
}

static int measure(bench_work *work, bench_stage *stage, int phase, int64_t resolution) {
  char label[64];
  const char *name = bench_phases[phase].name, *plural = stage->threads == 1 ? "" : "s";
  if (resolution > 0)
    snprintf(label, sizeof label, "%s %lld, %d thread%s", name, (long long)resolution, stage->threads,
             plural);
  else
    snprintf(label, sizeof label, "%s, %d thread%s", name, stage->threads, plural);
  work->cli->drawn = 0; /* a phase that takes long is not to run under the name of the one before */
  cli_progress(work->cli, label, (double)work->done++ / (double)work->total);
  return bench_measure(&work->results, stage, &work->plan, &bench_phases[phase], resolution) == VXM_OK
             ? CLI_DONE
             : cli_fail(work->cli);
}

/** All phases that depend on the resolution, one after another, so that their ratios are of one moment. */
static int measure_resolution(bench_work *work, bench_stage *stage, int64_t resolution) {
  if (bench_stage_resize(stage, resolution) != VXM_OK)
    return cli_fail(work->cli);
  for (int i = 0; bench_phases[i].name; i++)
    for (int e = 0; e < work->plan.engine_count; e++) {
      stage->engine = e;
      if (work->plan.chosen[i] && bench_phases[i].per_grid &&
          bench_takes_part(&work->plan, &bench_phases[i], e) &&
          measure(work, stage, i, resolution) != CLI_DONE)
        return CLI_FAILED;
    }
  work->results.memory[work->results.memory_count++] =
      (bench_memory){resolution, stage->threads, vxm_context_peak_bytes(work->cli->context)};
  return CLI_DONE;
}

static int measure_stage(bench_work *work, bench_stage *stage) {
  stage->engine = 0;
  if (bench_stage_open(stage, &work->plan) != VXM_OK)
    return cli_fail(work->cli);
  for (int i = 0; bench_phases[i].name; i++)
    if (work->plan.chosen[i] && !bench_phases[i].per_grid)
      if (measure(work, stage, i, 0) != CLI_DONE)
        return CLI_FAILED;
  for (int i = 0; i < work->plan.resolution_count; i++)
    if (measure_resolution(work, stage, work->plan.resolutions[i]) != CLI_DONE)
      return CLI_FAILED;
  return CLI_DONE;
}

static int measure_threads(bench_work *work, int threads) {
  cli_run *cli = work->cli;
  if (next_context(cli, threads) != CLI_DONE)
    return CLI_FAILED;
  bench_stage stage = {
      .cli = cli, .path = work->plan.path, .threads = threads, .displace = work->plan.displace};
  int status = measure_stage(work, &stage);
  bench_stage_close(&stage);
  uint64_t peak = vxm_context_peak_bytes(cli->context);
  if (peak > work->subject.peak_bytes)
    work->subject.peak_bytes = peak;
  return status;
}

static int write_plot(bench_work *work) {
  cli_run *cli = work->cli;
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  if (stream)
    bench_plot(stream, &work->plan, &work->subject, &work->results);
  if (!stream || fclose(stream) != 0)
    return cli_fail_text(cli, "%s: cannot write the plot: %s", work->plan.plot, strerror(errno));
  vxm_status status =
      vxm_context_hold_files(cli->context, &cli->error); /* the context is the last of several */
  if (status == VXM_OK)
    status = vxm_file_write(cli->context, work->plan.plot, text, size, &cli->error);
  free(text);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** Looks at the mesh once, so that what is wrong with it is told before the work, and once. */
static int look_at_mesh(bench_work *work) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  cli_input *input = &work->subject.input;
  int status = cli_read_repaired(work->cli, input, work->plan.path, &options);
  work->subject.repaired = (vxm_census)VXM_CENSUS_INIT;
  if (status == CLI_DONE &&
      vxm_mesh_census(&work->subject.repaired, input->mesh, &work->cli->error) != VXM_OK)
    status = cli_fail(work->cli);
  vxm_mesh_destroy(input->mesh);
  input->mesh = NULL;
  return status;
}

/** Without --threads: one, and what the library takes by itself. */
static void choose_threads(bench_plan *plan, const cli_run *cli) {
  int most = vxm_context_threads(cli->context);
  if (plan->thread_count > 0)
    return;
  plan->threads[plan->thread_count++] = 1;
  if (most > 1)
    plan->threads[plan->thread_count++] = most;
}

/** An error if nothing at all could be measured. */
static int check_results(const bench_work *work) {
  const bench_results *results = &work->results;
  for (int i = 0; i < results->count; i++)
    if (!*results->items[i].left_out)
      return CLI_DONE;
  return cli_fail_text(work->cli, "nothing was measured; %s: %s", results->items[0].phase->name,
                       results->items[0].left_out);
}

static int bench(bench_work *work) {
  cli_run *cli = work->cli;
  if (work->plan.plot && !cli_try_file(cli, work->plan.plot))
    return CLI_FAILED;
  if (look_at_mesh(work) != CLI_DONE)
    return CLI_FAILED;
  choose_threads(&work->plan, cli);
  work->total = count_measurements(&work->plan);
  for (int i = 0; i < work->plan.thread_count; i++)
    if (measure_threads(work, (int)work->plan.threads[i]) != CLI_DONE)
      return CLI_FAILED;
  cli_progress_clear(cli);
  if (check_results(work) != CLI_DONE || (work->plan.plot && write_plot(work) != CLI_DONE))
    return CLI_FAILED;
  if (cli_summary(cli))
    bench_print(cli, &work->plan, &work->subject, &work->results);
  return cli_finish(cli, bench_json(cli, &work->plan, &work->subject, &work->results));
}

static int run(cli_run *cli) {
  bench_work work = {.cli = cli,
                     .plan = {.engines = {"cpu"},
                              .engine_options = {VXM_ENGINE_OPTIONS_INIT},
                              .engine_count = 1,
                              .displace = 0.01,
                              .time_ms = 200}};
  if (read_arguments(cli, &work.plan) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  bench_machine_read(&work.subject.machine);
  int status = bench(&work);
  bench_results_drop(&work.results);
  return status;
}

static void print_phases(void) {
  printf("\nPhases:\n");
  for (const bench_phase *phase = bench_phases; phase->name; phase++)
    printf("  %-16s %s\n", phase->name, phase->help);
}

const cli_command cli_command_bench = {
    .name = "bench",
    .arguments = "MESH [OPTION]...",
    .summary = "measure how long each phase of the work takes",
    .notes = "Each phase is run once to warm up, then again and again; median and least time are told. The\n"
             "mesh is repaired first and fills the grid, as by 'voxmend voxelize'. Grids are made into\n"
             "memory that exists, without a report.\n\n"
             "Examples:\n"
             "  voxmend bench bunny.ply\n"
             "  voxmend bench chair.off -r 32,64,256 --threads 1 --phases memset,solid_vote\n"
             "  voxmend bench bunny.ply --cpu avx2 --phases solid\n"
             "  voxmend bench bunny.ply --augment -r 32,64\n"
             "  voxmend bench bunny.ply --json --plot bunny.svg >bunny.json",
    .options = known_options,
    .print_choices = print_phases,
    .run = run,
};
