/* SPDX-License-Identifier: BSD-3-Clause */
/** index.html: one file that needs no network, the worst first. */
#include "batch/plan.h"
#include "batch/summary.h"

#include <nettle/base64.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** page.html, whole. */
static const char page[] = {
#include "batch_page.inc"
};

enum { ROWS_MAX = 5000 };

/* ---- Order ---- */

typedef struct ranked {
  double score;
  int64_t item;
} ranked;

/** How much a mesh is worth a look: failures, then warnings, then what was uncertain, then what took long. */
static double score_of(const batch_state *state, int64_t i) {
  const batch_end *end = &state->ends[i];
  batch_status status = state->manifest.items[i].status;
  double score = (double)end->contested + 0.2 * (double)end->thin + 1e-8 * (double)end->wall_ms;
  return status == BATCH_PENDING  ? -1
         : !batch_is_done(status) ? 1000 + score
                                  : score + (end->warnings ? 1 : 0);
}

static int by_score(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->score != y->score)
    return x->score > y->score ? -1 : 1;
  return (x->item > y->item) - (x->item < y->item);
}

/* ---- Pictures ---- */

/** The bytes of a file as base64, to be freed. */
static char *base64_of(const char *path) {
  enum { MOST = 1 << 20 };
  FILE *file = fopen(path, "re");
  uint8_t *bytes = file ? malloc(MOST) : NULL;
  size_t size = bytes ? fread(bytes, 1, MOST, file) : 0;
  char *text = size > 0 && size < MOST ? calloc(BASE64_ENCODE_RAW_LENGTH(size) + 1, 1) : NULL;
  if (text)
    base64_encode_raw(text, size, bytes);
  if (file)
    fclose(file);
  free(bytes);
  return text;
}

/** A picture of what was made of an item, to be freed; NULL = none, as of a duplicate: it would be the same
 * picture once more. */
static char *picture_of(const batch_item *item, const char *output, const batch_summary_hooks *hooks) {
  bool is_drawn = batch_is_done(item->status) && item->status != BATCH_DUPLICATE;
  char *name = is_drawn ? hooks->viewed(item, hooks->payload) : NULL, *path = NULL, *text = NULL;
  char *picture = batch_plan_path(output, "picture.png");
  if (name && picture && asprintf(&path, "%s/%s", output, name) >= 0 &&
      hooks->draw(item, path, picture, hooks->payload))
    text = base64_of(picture);
  if (picture)
    unlink(picture);
  free(picture);
  free(path);
  free(name);
  return text;
}

/* ---- Rows ---- */

static void set_text(json_t *row, const char *key, const char *text) {
  if (text && *text)
    json_object_set_new(row, key, batch_json_string(text));
}

static json_t *row_of(const batch_state *state, int64_t i, const batch_summary_hooks *hooks) {
  const batch_item *item = &state->manifest.items[i];
  const batch_end *end = &state->ends[i];
  json_t *row =
      json_pack("{s:s, s:f, s:f, s:f, s:I, s:I}", "status", batch_status_names[item->status], "contested",
                (double)end->contested, "thin", (double)end->thin, "wall_ms", (double)end->wall_ms,
                "peak_bytes", (json_int_t)end->peak_bytes, "output_bytes", (json_int_t)end->output_bytes);
  set_text(row, "item", item->id);
  set_text(row, "class", item->kind);
  set_text(row, "split", item->split);
  set_text(row, "message", end->message);
  if (!batch_is_done(item->status) && item->status != BATCH_PENDING) {
    char *command = hooks->command_line(item, end->stage, hooks->payload);
    set_text(row, "command", command);
    free(command);
  }
  return row;
}

static json_t *rows_of(const batch_state *state, const char *output, const batch_summary_hooks *hooks) {
  int64_t count = state->manifest.count;
  int pictures = 0;
  ranked *order = malloc((size_t)(count + 1) * sizeof *order);
  json_t *rows = order ? json_array() : NULL;
  for (int64_t i = 0; order && i < count; i++)
    order[i] = (ranked){score_of(state, i), i};
  if (order)
    qsort(order, (size_t)count, sizeof *order, by_score);
  for (int64_t k = 0; rows && k < count && k < ROWS_MAX; k++) {
    json_t *row = row_of(state, order[k].item, hooks);
    char *picture =
        pictures < hooks->pictures ? picture_of(&state->manifest.items[order[k].item], output, hooks) : NULL;
    pictures += picture != NULL;
    set_text(row, "picture", picture);
    free(picture);
    json_array_append_new(rows, row);
  }
  free(order);
  return rows;
}

/* ---- The page ---- */

/** JSON in a page: "</script>" must not end it. */
static void put_data(FILE *file, const char *text) {
  for (; *text; text++)
    if (*text == '<')
      fputs("\\u003c", file);
    else
      fputc(*text, file);
}

static void put_page(FILE *file, const char *data) {
  static const char mark[] = "@DATA@";
  const char *found = strstr(page, mark);
  fwrite(page, 1, (size_t)(found - page), file);
  put_data(file, data);
  fputs(found + sizeof mark - 1, file);
}

bool batch_page_write(const batch_state *state, const json_t *summary, const char *output,
                      const batch_summary_hooks *hooks, batch_error *error) {
  json_t *data = json_pack("{s:O, s:o}", "summary", summary, "rows", rows_of(state, output, hooks));
  char *json = data ? json_dumps(data, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL, *text = NULL,
       *path = NULL;
  size_t size = 0;
  FILE *file = json ? open_memstream(&text, &size) : NULL;
  if (file)
    put_page(file, json);
  bool good = file && fclose(file) == 0 && asprintf(&path, "%s/index.html", output) >= 0
                  ? batch_write_file(path, text, size, error)
                  : batch_fail(error, "out of memory: free some");
  json_decref(data);
  free(json);
  free(text);
  free(path);
  return good;
}
