/* SPDX-License-Identifier: BSD-3-Clause */
/** The results of `voxmend bench` as a picture: a line for each phase and number of threads. */
#include "cli/bench.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Pixels: the field with the lines, and the room around it for the axes and the legend. */
enum { WIDTH = 960, HEIGHT = 620, LEFT = 90, RIGHT = 720, TOP = 70, BOTTOM = 550, LEGEND = 750, ROW = 20 };

static const char *const colours[] = {"#777777", "#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#8c510a", "#5e3c99", "#000000"};
static const char *const dashes[] = {"none", "7 4", "2 3", "10 3 2 3", "14 4"};
enum { COLOURS = sizeof colours / sizeof colours[0], DASHES = sizeof dashes / sizeof dashes[0] };

/** Phases of the mesh are not drawn and take no colour. */
static const char *colour_of(int phase) {
  int index = 0;
  for (int i = 0; i < phase; i++)
    index += bench_phases[i].per_grid;
  return colours[index % COLOURS];
}

/** What the field spans: logarithms to base 2 of the resolution and to base 10 of milliseconds. */
typedef struct plot_range {
  double low_x, high_x;
  int low_y, high_y;
} plot_range;

static bool is_drawn(const bench_result *item) {
  return item->resolution > 0 && !*item->left_out && item->median_ms > 0;
}

static plot_range find_range(const bench_plan *plan, const bench_results *results) {
  double least = INFINITY, most = 0;
  for (int i = 0; i < results->count; i++)
    if (is_drawn(&results->items[i])) {
      least = fmin(least, results->items[i].median_ms);
      most = fmax(most, results->items[i].median_ms);
    }
  plot_range range = {log2((double)plan->resolutions[0]) - 0.25,
                      log2((double)plan->resolutions[plan->resolution_count - 1]) + 0.25, 0, 1};
  if (most > 0) {
    range.low_y = (int)floor(log10(least));
    range.high_y = (int)ceil(log10(most));
  }
  if (range.high_y == range.low_y)
    range.high_y++;
  return range;
}

static double x_of(const plot_range *range, int64_t resolution) {
  double share = (log2((double)resolution) - range->low_x) / (range->high_x - range->low_x);
  return LEFT + share * (RIGHT - LEFT);
}

static double y_of(const plot_range *range, double ms) {
  double share = (log10(ms) - range->low_y) / (range->high_y - range->low_y);
  return BOTTOM - share * (BOTTOM - TOP);
}

/** Text as XML has it; what is not UTF-8 or no character becomes a question mark. */
static void put_text(FILE *file, const char *text) {
  json_t *valid = cli_json_text(text);
  for (const char *c = valid ? json_string_value(valid) : ""; *c; c++)
    switch (*c) {
    case '&':
      fputs("&amp;", file);
      break;
    case '<':
      fputs("&lt;", file);
      break;
    case '>':
      fputs("&gt;", file);
      break;
    default:
      fputc((unsigned char)*c < ' ' ? '?' : *c, file);
    }
  json_decref(valid);
}

static const char *base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static void put_title(FILE *file, const bench_subject *subject) {
  const bench_machine *machine = &subject->machine;
  fprintf(file, "<text x=\"%d\" y=\"30\" font-size=\"17\">", LEFT);
  put_text(file, base_name(subject->input.path));
  fprintf(file, ": %" PRId64 " triangles</text>\n<text x=\"%d\" y=\"50\" fill=\"#555\">",
          subject->repaired.triangles, LEFT);
  put_text(file, *machine->processor ? machine->processor : machine->architecture);
  fprintf(file, ", %d core%s; medians; voxmend %s</text>\n", machine->cores, machine->cores == 1 ? "" : "s",
          vxm_version());
}

static void put_y_axis(FILE *file, const plot_range *range) {
  for (int decade = range->low_y; decade <= range->high_y; decade++) {
    double value = pow(10, decade), y = y_of(range, value);
    fprintf(file, "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#bbb\"/>\n", LEFT, y, RIGHT, y);
    fprintf(file, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.*f</text>\n", LEFT - 8, y + 4,
            decade < 0 ? -decade : 0, value);
    for (int i = 2; i < 10 && decade < range->high_y; i++) {
      y = y_of(range, i * value);
      fprintf(file, "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#eee\"/>\n", LEFT, y, RIGHT,
              y);
    }
  }
  int middle = (TOP + BOTTOM) / 2;
  fprintf(file, "<text x=\"25\" y=\"%d\" text-anchor=\"middle\" transform=\"rotate(-90 25 %d)\">%s</text>\n",
          middle, middle, "milliseconds");
}

static void put_x_axis(FILE *file, const bench_plan *plan, const plot_range *range) {
  double last = -INFINITY;
  for (int i = 0; i < plan->resolution_count; i++) {
    double x = x_of(range, plan->resolutions[i]);
    fprintf(file, "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#bbb\"/>\n", x, TOP, x, BOTTOM);
    if (x - last < 40) /* the labels would overlap */
      continue;
    fprintf(file, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%" PRId64 "</text>\n", x, BOTTOM + 20,
            plan->resolutions[i]);
    last = x;
  }
  fprintf(file, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">resolution: voxels along each axis</text>\n",
          (LEFT + RIGHT) / 2, BOTTOM + 45);
}

/** A line with a dot at each resolution that was measured. */
static void put_line(FILE *file, const bench_results *results, const plot_range *range, int phase,
                     int threads, int engine, int style) {
  const char *separator = "", *colour = colour_of(phase);
  fprintf(file,
          "<g stroke=\"%s\" fill=\"%s\">\n<polyline fill=\"none\" stroke-width=\"2\" stroke-dasharray=\"%s\" "
          "points=\"",
          colour, colour, dashes[style % DASHES]);
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (!is_drawn(item) || item->phase != &bench_phases[phase] || item->threads != threads ||
        item->engine != engine)
      continue;
    fprintf(file, "%s%.1f,%.1f", separator, x_of(range, item->resolution), y_of(range, item->median_ms));
    separator = " ";
  }
  fputs("\"/>\n", file);
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (!is_drawn(item) || item->phase != &bench_phases[phase] || item->threads != threads ||
        item->engine != engine)
      continue;
    fprintf(file,
            "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\"><title>%s, %" PRId64
            ", %d thread%s: %.4g ms</title></circle>\n",
            x_of(range, item->resolution), y_of(range, item->median_ms), item->phase->name, item->resolution,
            threads, threads == 1 ? "" : "s", item->median_ms);
  }
  fputs("</g>\n", file);
}

static bool has_line(const bench_results *results, int phase, int threads, int engine) {
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (is_drawn(item) && item->phase == &bench_phases[phase] && item->threads == threads &&
        item->engine == engine)
      return true;
  }
  return false;
}

static void put_lines(FILE *file, const bench_plan *plan, const bench_results *results,
                      const plot_range *range) {
  int y = TOP + ROW / 2;
  for (int group = 0; group < plan->thread_count * plan->engine_count; group++) {
    int t = plan->thread_count - 1 - group / plan->engine_count, engine = group % plan->engine_count;
    int threads = (int)plan->threads[t], style = group;
    fprintf(file, "<text x=\"%d\" y=\"%d\" font-weight=\"bold\">%d thread%s%s%s</text>\n", LEGEND, y, threads,
            threads == 1 ? "" : "s", engine > 0 ? ", " : "", engine > 0 ? plan->engines[engine] : "");
    y += ROW;
    for (int phase = 0; bench_phases[phase].name; phase++) {
      if (!has_line(results, phase, threads, engine))
        continue;
      put_line(file, results, range, phase, threads, engine, style);
      fprintf(file,
              "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"%s\" stroke-width=\"2\" "
              "stroke-dasharray=\"%s\"/>\n",
              LEGEND, y - 4, LEGEND + 36, y - 4, colour_of(phase), dashes[style % DASHES]);
      fprintf(file, "<text x=\"%d\" y=\"%d\">%s</text>\n", LEGEND + 44, y, bench_phases[phase].name);
      y += ROW;
    }
    y += ROW / 2;
  }
}

/** The legend may be longer than the field is high. */
static int find_height(const bench_plan *plan, const bench_results *results) {
  int height = TOP + ROW;
  for (int t = 0; t < plan->thread_count; t++)
    for (int e = 0; e < plan->engine_count; e++) {
      height += ROW + ROW / 2;
      for (int phase = 0; bench_phases[phase].name; phase++)
        height += has_line(results, phase, (int)plan->threads[t], e) ? ROW : 0;
    }
  return height > HEIGHT ? height : HEIGHT;
}

void bench_plot(FILE *file, const bench_plan *plan, const bench_subject *subject,
                const bench_results *results) {
  plot_range range = find_range(plan, results);
  int height = find_height(plan, results);
  fprintf(file,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
          "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
          WIDTH, height, WIDTH, height, WIDTH, height);
  put_title(file, subject);
  put_y_axis(file, &range);
  put_x_axis(file, plan, &range);
  fprintf(file, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#555\"/>\n", LEFT,
          TOP, RIGHT - LEFT, BOTTOM - TOP);
  put_lines(file, plan, results, &range);
  fputs("</svg>\n", file);
}
