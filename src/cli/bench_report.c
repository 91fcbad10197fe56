/* SPDX-License-Identifier: BSD-3-Clause */
/** The results of `voxmend bench` as tables and as JSON. */
#include "cli/baseline.h"
#include "cli/bench.h"
#include "cli/defects.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- The table ---- */

/* The chart beside the table: a logarithmic scale from 1 us to 10 s. */
enum { DECADES = 7, DECADE_WIDTH = 4, CHART_WIDTH = DECADES * DECADE_WIDTH };

/** As many digits as say something, in ten columns. */
static const char *show_ms(char *text, size_t size, double ms) {
  snprintf(text, size, "%10.*f", ms < 0.01 ? 6 : ms < 1 ? 4 : ms < 10 ? 3 : ms < 1000 ? 2 : 0, ms);
  return text;
}

static const char *show_bar(char bar[CHART_WIDTH + 1], double ms) {
  int length = ms > 0 ? (int)lround((log10(ms) + 3) * DECADE_WIDTH) : 0;
  if (length < 1)
    length = 1;
  if (length > CHART_WIDTH)
    length = CHART_WIDTH;
  memset(bar, '#', (size_t)length);
  bar[length] = '\0';
  return bar;
}

/** "solid_x", or "solid_x by opengl" for engines behind the first. */
static const char *show_name(char *text, size_t size, const bench_plan *plan, const bench_result *item) {
  bool other = item->engine > 0;
  snprintf(text, size, "%s%s%s", item->phase->name, other ? " by " : "",
           other ? plan->engines[item->engine] : "");
  return text;
}

static int name_width(const bench_plan *plan, const bench_results *results) {
  int width = (int)strlen("phase");
  for (int i = 0; i < results->count; i++) {
    char name[96];
    int length = (int)strlen(show_name(name, sizeof name, plan, &results->items[i]));
    width = length > width ? length : width;
  }
  return width;
}

static void print_row(const cli_run *cli, const bench_plan *plan, const bench_result *item, int width) {
  char name[96], grid[24] = "", of_memset[24] = "", median[32], least[32], bar[CHART_WIDTH + 1];
  if (item->resolution > 0)
    snprintf(grid, sizeof grid, "%" PRId64, item->resolution);
  show_name(name, sizeof name, plan, item);
  if (*item->left_out) {
    fprintf(cli->text, "%-*s %6s  left out: %s\n", width, name, grid, item->left_out);
    return;
  }
  if (item->of_memset > 0)
    snprintf(of_memset, sizeof of_memset, "%.*f", item->of_memset < 100 ? 1 : 0, item->of_memset);
  double rate = 1e3 / item->median_ms;
  fprintf(cli->text, "%-*s %6s %s %s %9.*f %8s  %s\n", width, name, grid,
          show_ms(median, sizeof median, item->median_ms), show_ms(least, sizeof least, item->least_ms),
          rate < 100 ? 2 : 0, rate, of_memset, show_bar(bar, item->median_ms));
  if (item->figures) {
    char figures[512];
    cli_figures_text(figures, sizeof figures, item->figures);
    fprintf(cli->text, "%-*s %6s  %s\n", width, "", "", figures);
  }
}

static void print_threads(const cli_run *cli, const bench_plan *plan, const bench_results *results,
                          int threads) {
  int width = name_width(plan, results);
  fprintf(cli->text, "\n%d thread%s\n%-*s %6s %10s %10s %9s %8s  %s\n", threads, threads == 1 ? "" : "s",
          width, "phase", "grid", "median ms", "least ms", "per s", "x memset", "1us 10  100 1ms 10  100 1s");
  int64_t last = 0;
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (item->threads != threads)
      continue;
    if (item->resolution != last && i > 0)
      fputc('\n', cli->text);
    last = item->resolution;
    print_row(cli, plan, item, width);
  }
}

/** How much faster the most threads are than the fewest, where both were measured. */
static void print_speedup(const cli_run *cli, const bench_plan *plan, const bench_results *results) {
  int few = (int)plan->threads[0], many = (int)plan->threads[plan->thread_count - 1];
  int width = name_width(plan, results);
  fprintf(cli->text, "\n%d threads over %d, times as fast\n%-*s", many, few, width, "grid");
  for (int i = 0; i < plan->resolution_count; i++)
    fprintf(cli->text, " %6" PRId64, plan->resolutions[i]);
  fputc('\n', cli->text);
  for (int p = 0; bench_phases[p].name; p++) {
    if (!plan->chosen[p] || !bench_phases[p].per_grid || !bench_takes_part(plan, &bench_phases[p], 0))
      continue;
    fprintf(cli->text, "%-*s", width, bench_phases[p].name);
    for (int i = 0; i < plan->resolution_count; i++) {
      const bench_result *slow = bench_find(results, bench_phases[p].name, plan->resolutions[i], few, 0);
      const bench_result *fast = bench_find(results, bench_phases[p].name, plan->resolutions[i], many, 0);
      if (slow && fast && fast->median_ms > 0)
        fprintf(cli->text, " %6.2f", slow->median_ms / fast->median_ms);
      else
        fprintf(cli->text, " %6s", "-");
    }
    fputc('\n', cli->text);
  }
}

/** Whether a phase is measured with an engine and with the first. */
static bool is_compared(const bench_plan *plan, int phase, int engine) {
  return plan->chosen[phase] && bench_phases[phase].by_engine &&
         bench_takes_part(plan, &bench_phases[phase], 0) &&
         bench_takes_part(plan, &bench_phases[phase], engine);
}

/** How long the other engines take, in times of the first, with the most threads. */
static void print_engines(const cli_run *cli, const bench_plan *plan, const bench_results *results) {
  int width = name_width(plan, results), threads = (int)plan->threads[plan->thread_count - 1];
  for (int e = 1; e < plan->engine_count; e++) {
    fprintf(cli->text, "\n%s, times as long as %s\n%-*s", plan->engines[e], plan->engines[0], width, "grid");
    for (int i = 0; i < plan->resolution_count; i++)
      fprintf(cli->text, " %6" PRId64, plan->resolutions[i]);
    fputc('\n', cli->text);
    for (int p = 0; bench_phases[p].name; p++) {
      if (!is_compared(plan, p, e))
        continue;
      fprintf(cli->text, "%-*s", width, bench_phases[p].name);
      for (int i = 0; i < plan->resolution_count; i++) {
        const char *name = bench_phases[p].name;
        const bench_result *first = bench_find(results, name, plan->resolutions[i], threads, 0);
        const bench_result *other = bench_find(results, name, plan->resolutions[i], threads, e);
        if (first && other && first->median_ms > 0)
          fprintf(cli->text, " %6.2f", other->median_ms / first->median_ms);
        else
          fprintf(cli->text, " %6s", "-");
      }
      fputc('\n', cli->text);
    }
  }
}

/** The memory that the library held at most until a resolution was done. */
static void print_memory(const cli_run *cli, const bench_plan *plan, const bench_subject *subject,
                         const bench_results *results) {
  if (plan->resolution_count > 0) {
    fprintf(cli->text, "\nMiB held at most up to each grid\n%-11s", "grid");
    for (int i = 0; i < plan->resolution_count; i++)
      fprintf(cli->text, " %7" PRId64, plan->resolutions[i]);
  }
  for (int i = 0; i < results->memory_count; i++) {
    const bench_memory *memory = &results->memory[i];
    if (i % plan->resolution_count == 0)
      fprintf(cli->text, "\n%3d %-7s", memory->threads, memory->threads == 1 ? "thread" : "threads");
    fprintf(cli->text, " %7.1f", (double)memory->peak_bytes / (1 << 20));
  }
  char peak[24], resident[24];
  fprintf(cli->text, "\n%speak memory %s in the library, %s resident in all\n",
          plan->resolution_count > 0 ? "\n" : "", cli_bytes_text(peak, subject->peak_bytes),
          cli_bytes_text(resident, (uint64_t)bench_peak_rss()));
}

static void print_machine(const cli_run *cli, const bench_machine *machine) {
  fprintf(cli->text, "%-10s %s, vectors %s, %d core%s", "machine",
          *machine->processor ? machine->processor : machine->architecture, bench_cpu_names[machine->vectors],
          machine->cores, machine->cores == 1 ? "" : "s");
  for (int i = 0; i < machine->cache_count; i++)
    if (strcmp(machine->caches[i].type, "Instruction") != 0)
      fprintf(cli->text, ", L%d %" PRIu64 " KiB", machine->caches[i].level, machine->caches[i].bytes >> 10);
  fprintf(cli->text, ", %.1f GiB memory; %s; %s\n", (double)machine->memory_bytes / (1 << 30),
          machine->system, machine->compiler);
}

void bench_print(const cli_run *cli, const bench_plan *plan, const bench_subject *subject,
                 const bench_results *results) {
  const cli_input *input = &subject->input;
  const vxm_census *mended = &subject->repaired;
  print_machine(cli, &subject->machine);
  cli_row(cli, "mesh", "%s (%s): %" PRId64 " vertices, %" PRId64 " faces; repaired %" PRId64 " triangles, %s",
          input->path, input->format, input->vertices, input->faces, mended->triangles,
          mended->closed ? "closed" : "open");
  for (int i = 0; i < plan->thread_count; i++)
    print_threads(cli, plan, results, (int)plan->threads[i]);
  if (plan->thread_count > 1 && plan->resolution_count > 0)
    print_speedup(cli, plan, results);
  if (plan->resolution_count > 0)
    print_engines(cli, plan, results);
  print_memory(cli, plan, subject, results);
  if (plan->plot)
    cli_row(cli, "plot", "%s", plan->plot);
}

/* ---- JSON ---- */

static json_t *key_json(const bench_plan *plan, const bench_result *item) {
  json_t *object = json_object();
  json_object_set_new(object, "phase", json_string(item->phase->name));
  json_object_set_new(object, "engine", json_string(plan->engines[item->engine]));
  json_object_set_new(object, "resolution", json_integer(item->resolution));
  json_object_set_new(object, "threads", json_integer(item->threads));
  return object;
}

static json_t *result_json(const bench_plan *plan, const bench_result *item) {
  json_t *object = key_json(plan, item);
  json_object_set_new(object, "median_ms", json_real(item->median_ms));
  json_object_set_new(object, "min_ms", json_real(item->least_ms));
  json_object_set_new(object, "runs", json_integer(item->runs));
  json_object_set_new(object, "bytes", json_integer((json_int_t)item->bytes));
  json_object_set_new(object, "voxels", json_integer(item->voxels));
  json_object_set_new(object, "per_second", cli_json_number(1e3 / item->median_ms));
  json_object_set_new(object, "of_memset", item->of_memset > 0 ? json_real(item->of_memset) : json_null());
  if (item->figures)
    json_object_set(object, "figures", item->figures);
  return object;
}

static json_t *memory_json(const bench_memory *memory) {
  json_t *object = json_object();
  json_object_set_new(object, "resolution", json_integer(memory->resolution));
  json_object_set_new(object, "threads", json_integer(memory->threads));
  json_object_set_new(object, "peak_bytes", json_integer((json_int_t)memory->peak_bytes));
  return object;
}

static json_t *mesh_json(const bench_subject *subject) {
  const cli_input *input = &subject->input;
  json_t *object = json_object();
  json_object_set_new(object, "file", cli_json_text(input->path));
  json_object_set_new(object, "format", cli_json_text(input->format));
  json_object_set_new(object, "vertices", json_integer(input->vertices));
  json_object_set_new(object, "faces", json_integer(input->faces));
  json_t *repaired = json_object();
  cli_census_json(repaired, &subject->repaired);
  json_object_set_new(object, "triangles", json_integer(subject->repaired.triangles));
  json_object_set_new(object, "repaired", repaired);
  return object;
}

json_t *bench_json(const cli_run *cli, const bench_plan *plan, const bench_subject *subject,
                   const bench_results *results) {
  json_t *measured = json_array(), *left_out = json_array(), *memory = json_array();
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (!*item->left_out) {
      json_array_append_new(measured, result_json(plan, item));
      continue;
    }
    json_t *object = key_json(plan, item);
    json_object_set_new(object, "reason", cli_json_text(item->left_out));
    json_array_append_new(left_out, object);
  }
  for (int i = 0; i < results->memory_count; i++)
    json_array_append_new(memory, memory_json(&results->memory[i]));
  json_t *report = json_object();
  json_object_set_new(report, "machine", bench_machine_json(&subject->machine));
  json_object_set_new(report, "mesh", mesh_json(subject));
  json_object_set_new(report, "results", measured);
  json_object_set_new(report, "left_out", left_out);
  json_object_set_new(report, "memory", memory);
  json_object_set_new(report, "peak_bytes", json_integer((json_int_t)subject->peak_bytes));
  json_object_set_new(report, "peak_rss_bytes", json_integer((json_int_t)bench_peak_rss()));
  json_object_set(report, "warnings", cli->warnings);
  return report;
}
