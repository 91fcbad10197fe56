/* SPDX-License-Identifier: BSD-3-Clause */
#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const bound bounds[DAMAGE_COUNT] = {
    [DAMAGE_NONE] = {1, 1},
    [DAMAGE_DOUBLED] = {1, 0.999},
    [DAMAGE_FLIPPED] = {0.9999, 0.999},
    [DAMAGE_REMOVED_1] = {0.9995, 0.999},
    [DAMAGE_REMOVED_5] = {0.996, 0.999},
    [DAMAGE_REMOVED_20] = {0.97, 0.999},
    [DAMAGE_COPIES] = {0.9999, 0.999},
    [DAMAGE_SHAKEN] = {0, 0},
    [DAMAGE_MOVED] = {0.998, 0.999},
    [DAMAGE_SHEET] = {0.9995, 0.999},
    [DAMAGE_CAVITY] = {1, 0.999},
    [DAMAGE_HOLE] = {0, 0},
    [DAMAGE_PANELS] = {0.999, 0},
    [DAMAGE_PANELS_DOUBLED] = {0.999, 0},
    [DAMAGE_ALL] = {0.99, 0},
};

const double winding_slack = 0.001;

/* Times: at most this much for repair and solid of a mesh of no more triangles, this often the clean mesh's
 * with 1 % removed. */
static const double time_bound = 200, mild_factor = 3;
static const size_t time_triangles = 70000;

/* ---- Picking figures ---- */

/** A figure of an answer, by its place in it. */
typedef const figure *(*pick)(const answer *from, int by);

static const figure *pick_iou(const answer *from, int by) {
  return &from->iou[by];
}

static const figure *pick_time(const answer *from, int by) {
  return &from->time[by];
}

static const figure *pick_repair_time(const answer *from, int by) {
  (void)by;
  return &from->repair_time;
}

/** The figures of one kind over all meshes. */
typedef struct summary {
  size_t count;
  double least, most, median;
  const char *least_name, *most_name;
} summary;

static int compare_numbers(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double *numbers_for(const survey *all) {
  double *numbers = calloc(all->mesh_count + 1, sizeof *numbers);
  if (!numbers)
    exit(1);
  return numbers;
}

static const answer *answer_at(const survey *all, size_t mesh, int kind) {
  return &all->answers[mesh * DAMAGE_COUNT + (size_t)kind];
}

static summary summarize(const survey *all, int kind, pick choose, int by) {
  summary sum = {.least = INFINITY, .most = -INFINITY};
  double *numbers = numbers_for(all);
  for (size_t m = 0; m < all->mesh_count; m++) {
    const figure *chosen = choose(answer_at(all, m, kind), by);
    if (!chosen->known)
      continue;
    numbers[sum.count++] = chosen->value;
    if (chosen->value < sum.least) {
      sum.least = chosen->value;
      sum.least_name = all->names[m];
    }
    if (chosen->value > sum.most) {
      sum.most = chosen->value;
      sum.most_name = all->names[m];
    }
  }
  qsort(numbers, sum.count, sizeof *numbers, compare_numbers);
  if (sum.count > 0)
    sum.median = (numbers[(sum.count - 1) / 2] + numbers[sum.count / 2]) / 2;
  free(numbers);
  return sum;
}

static bool is_measured(const survey *all, int by) {
  for (size_t i = 0; i < all->mesh_count * DAMAGE_COUNT; i++)
    if (all->answers[i].iou[by].known)
      return true;
  return false;
}

/* ---- Tables of all methods ---- */

static void print_heads(FILE *to, const survey *all, const char *first, const char *upper) {
  fprintf(to, "| %s |", first);
  for (int by = 0; by < METHOD_COUNT; by++)
    if (is_measured(all, by))
      fprintf(to, " %s: median | %s |", method_names[by], upper);
}

static void print_rule(FILE *to, const survey *all, int columns) {
  for (int by = 0; by < METHOD_COUNT; by++)
    columns += is_measured(all, by) ? 2 : 0;
  fprintf(to, "\n|");
  for (int i = 0; i < columns; i++)
    fprintf(to, "---|");
  fprintf(to, "\n");
}

void report_iou(FILE *to, const survey *all) {
  print_heads(to, all, "damage | meshes", "worst");
  print_rule(to, all, 2);
  for (int kind = 0; kind < DAMAGE_COUNT; kind++) {
    fprintf(to, "| %s |", damage_names[kind]);
    size_t meshes = summarize(all, kind, pick_repair_time, 0).count;
    fprintf(to, " %zu |", meshes);
    for (int by = 0; by < METHOD_COUNT; by++) {
      summary sum = summarize(all, kind, pick_iou, by);
      if (sum.count > 0)
        fprintf(to, " %.5f | %.5f %s |", sum.median, sum.least, sum.least_name);
      else if (is_measured(all, by))
        fprintf(to, " - | - |");
    }
    fprintf(to, "\n");
  }
}

void report_times(FILE *to, const survey *all) {
  print_heads(to, all, "damage | repair: median | slowest", "slowest");
  print_rule(to, all, 3);
  for (int kind = 0; kind < DAMAGE_COUNT; kind++) {
    summary sum = summarize(all, kind, pick_repair_time, 0);
    fprintf(to, "| %s | %.1f | %.1f |", damage_names[kind], sum.median, sum.count ? sum.most : 0);
    for (int by = 0; by < METHOD_COUNT; by++) {
      sum = summarize(all, kind, pick_time, by);
      if (sum.count > 0)
        fprintf(to, " %.1f | %.1f |", sum.median, sum.most);
      else if (is_measured(all, by))
        fprintf(to, " - | - |");
    }
    fprintf(to, "\n");
  }
}

/* ---- Bounds ---- */

/** Ends a row that says whether a bound is kept. */
static bool print_verdict(FILE *to, bool kept) {
  fprintf(to, " %s |\n", kept ? "ok" : "short");
  return kept;
}

/** The meshes below a floor, each with its number. */
static void print_below(FILE *to, const survey *all, int kind, double floor) {
  const char *before = " ";
  for (size_t m = 0; m < all->mesh_count; m++) {
    const figure *iou = pick_iou(answer_at(all, m, kind), METHOD_AUTO);
    if (!iou->known || iou->value >= floor)
      continue;
    fprintf(to, "%s%s %.5f", before, all->names[m], iou->value);
    before = ", ";
  }
  fprintf(to, " |");
}

static bool report_floor(FILE *to, const survey *all, int kind) {
  summary sum = summarize(all, kind, pick_iou, METHOD_AUTO);
  if (sum.count == 0 || bounds[kind].worst == 0)
    return true;
  fprintf(to, "| %s: worst | %.4f | %.5f |", damage_names[kind], bounds[kind].worst, sum.least);
  print_below(to, all, kind, bounds[kind].worst);
  bool kept = print_verdict(to, sum.least >= bounds[kind].worst);
  if (bounds[kind].median == 0)
    return kept;
  fprintf(to, "| %s: median | %.3f | %.5f | |", damage_names[kind], bounds[kind].median, sum.median);
  return print_verdict(to, sum.median >= bounds[kind].median) && kept;
}

/** A number of one mesh and one damage, if both are measured. */
typedef figure (*derive)(const survey *all, size_t mesh, int kind);

/** What the winding number of the oriented mesh is better by. */
static figure winding_gap(const survey *all, size_t mesh, int kind) {
  const answer *a = answer_at(all, mesh, kind);
  return (figure){a->reference.known && a->iou[METHOD_AUTO].known,
                  a->reference.value - a->iou[METHOD_AUTO].value};
}

static figure whole_time(const survey *all, size_t mesh, int kind) {
  const answer *a = answer_at(all, mesh, kind);
  return (figure){a->time[METHOD_AUTO].known && all->triangles[mesh] <= time_triangles,
                  a->repair_time.value + a->time[METHOD_AUTO].value};
}

/** The largest derived number of all meshes and damages, which must not pass a limit. */
static bool report_most(FILE *to, const survey *all, const char *text, derive from, double limit,
                        int digits) {
  double most = -INFINITY;
  size_t at = 0;
  for (size_t i = 0; i < all->mesh_count * DAMAGE_COUNT; i++) {
    figure found = from(all, i / DAMAGE_COUNT, (int)(i % DAMAGE_COUNT));
    if (!found.known || found.value <= most)
      continue;
    most = found.value;
    at = i;
  }
  if (isinf(most))
    return true;
  fprintf(to, "| %s | %g | %.*f | %s, %s |", text, limit, digits, most, all->names[at / DAMAGE_COUNT],
          damage_names[at % DAMAGE_COUNT]);
  return print_verdict(to, most <= limit);
}

/** The greatest of the meshes' quotients of two times. */
static bool report_quotient(FILE *to, const survey *all, const char *text, int over, int under, double most) {
  double worst = -INFINITY;
  const char *name = "";
  for (size_t m = 0; m < all->mesh_count; m++) {
    const figure *a = pick_time(answer_at(all, m, over), METHOD_AUTO);
    const figure *b = pick_time(answer_at(all, m, under), METHOD_AUTO);
    if (!a->known || !b->known)
      continue;
    double quotient = a->value / b->value;
    if (quotient <= worst)
      continue;
    worst = quotient;
    name = all->names[m];
  }
  if (isinf(worst))
    return true;
  fprintf(to, "| %s | %.0f | %.2f | %s |", text, most, worst, name);
  return print_verdict(to, worst <= most);
}

bool report_bounds(FILE *to, const survey *all) {
  bool kept = true;
  fprintf(to, "| what | bound | measured | where | |\n|---|---|---|---|---|\n");
  for (int kind = 0; kind < DAMAGE_COUNT; kind++)
    kept &= report_floor(to, all, kind);
  kept &=
      report_most(to, all, "winding number of the oriented mesh, less ours", winding_gap, winding_slack, 5);
  kept &= report_most(to, all, "ms, repair and solid, up to 70 000 triangles", whole_time, time_bound, 1);
  kept &=
      report_quotient(to, all, "time with 1 % removed / clean", DAMAGE_REMOVED_1, DAMAGE_NONE, mild_factor);
  return kept;
}

/* ---- The document ---- */

static void print_processor(FILE *to) {
  char line[256];
  FILE *info = fopen("/proc/cpuinfo", "r");
  while (info && fgets(line, sizeof line, info)) {
    char *colon = strchr(line, ':');
    if (strncmp(line, "model name", 10) != 0 || !colon)
      continue;
    line[strcspn(line, "\n")] = 0;
    fprintf(to, "%s, ", colon + 2);
    break;
  }
  if (info)
    fclose(info);
}

void report_setting(FILE *to, const survey *all) {
  print_processor(to);
  fprintf(to, "%d threads, resolution %" PRId64 ", %zu meshes (with their triangles): ", all->threads,
          all->resolution, all->mesh_count);
  for (size_t m = 0; m < all->mesh_count; m++)
    fprintf(to, "%s%s (%zu)", m ? ", " : "", all->names[m], all->triangles[m]);
  fprintf(to, ".\n");
}

static void print_document(FILE *to, const survey *all) {
  fprintf(to, "\n");
  report_setting(to, all);
  fprintf(to, "\n### Intersection over union\n\n");
  report_iou(to, all);
  fprintf(to, "\n### Milliseconds\n\n");
  report_times(to, all);
  fprintf(to, "\n### Bounds\n\n");
  report_bounds(to, all);
  fprintf(to, "\n");
}

static char *read_text(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file)
    return NULL;
  size_t room = 1 << 20, size;
  char *text = calloc(room + 1, 1);
  if (!text)
    exit(1);
  size = fread(text, 1, room, file);
  fclose(file);
  text[size] = 0;
  return text;
}

bool report_markdown(const char *path, const survey *all) {
  static const char begin[] = "<!-- accuracy: begin -->", end[] = "<!-- accuracy: end -->";
  char *text = read_text(path), *from = text ? strstr(text, begin) : NULL,
       *to = from ? strstr(from, end) : NULL;
  FILE *file = to ? fopen(path, "w") : NULL;
  if (!file) {
    free(text);
    return false;
  }
  fprintf(file, "%.*s%s\n", (int)(from - text), text, begin);
  print_document(file, all);
  fputs(to, file);
  bool good = !ferror(file);
  free(text);
  return fclose(file) == 0 && good;
}
