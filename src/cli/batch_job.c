/* SPDX-License-Identifier: BSD-3-Clause */
/** A mesh of a batch: which commands it goes through. */
#include "batch/plan.h"
#include "cli/batch.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- Commands ---- */

static const char *const product_commands[BATCH_PRODUCTS] = {"repair", "voxelize", "remesh", "augment",
                                                             "view"};

/** The value of --format in options, or what is taken without. */
static const char *format_in(const char *options, const char *usual, char text[16]) {
  const char *found = options ? strstr(options, "--format") : NULL;
  if (!found)
    return usual;
  found += strlen("--format");
  found += strspn(found, "= \t");
  size_t length = strcspn(found, " \t");
  snprintf(text, 16, "%.*s", (int)(length < 15 ? length : 15), found);
  return text;
}

/** Name of a product below the folder of outputs, to be freed. Where the only product is a mesh, its name has
 * no ".repaired" or ".remeshed". */
static char *product_name(const batch_request *given, batch_product product, const batch_item *item) {
  char format[16], *name = NULL;
  const char *options = given->products[product];
  bool is_alone = given->no_grid && !(given->products[BATCH_REPAIRED] && given->products[BATCH_REMESHED]);
  int got = -1;
  switch (product) {
  case BATCH_GRID:
    got = asprintf(&name, "%s.%s", item->output, given->format);
    break;
  case BATCH_REPAIRED:
  case BATCH_REMESHED:
    got = asprintf(&name, "%s%s.%s", item->output,
                   is_alone                    ? ""
                   : product == BATCH_REPAIRED ? ".repaired"
                                               : ".remeshed",
                   format_in(options, "ply", format));
    break;
  case BATCH_VARIANTS:
    got = asprintf(&name, "%s.variants", item->output);
    break;
  default:
    got = asprintf(&name, "%s.png", item->output);
  }
  return got < 0 ? NULL : name;
}

static bool is_wanted(const batch_request *given, batch_product product) {
  return product == BATCH_GRID ? !given->no_grid : given->products[product] != NULL;
}

/** Whether a grid of this format can be looked at; else the mesh is. */
static bool can_be_viewed(const char *format) {
  return (vxm_grid_format_traits(format) & VXM_FORMAT_READ) != 0;
}

/** Whether a picture is drawn of the grid; else of the mesh. */
static bool draws_grid(const batch_request *given) {
  return !given->no_grid && can_be_viewed(given->format);
}

bool batch_reads_colors(const batch_request *given, const char *options) {
  bool reads = options && strstr(options, "--col"); /* names may be shortened */
  for (int w = 0; w < given->grid_options.count; w++)
    reads = reads || strcmp(given->grid_options.words[w], "--color=mesh") == 0;
  return reads || (given->products[BATCH_PICTURE] && !draws_grid(given));
}

/** Options of one mesh may say how its grid is made, and not what is written where. Names may be shortened.
 */
static bool check_own(const batch_words *words, int first, batch_error *error) {
  static const char *const refused[] = {"report",  "confidence", "coords", "output",
                                        "dry-run", "help",       "json",   "format"};
  for (int w = first; w < words->count; w++) {
    const char *word = words->words[w];
    size_t length = strncmp(word, "--", 2) == 0 ? strcspn(word + 2, "=") : 0;
    bool is_refused = strncmp(word, "-o", 2) == 0 || strcmp(word, "-h") == 0 || strcmp(word, "--") == 0;
    for (size_t r = 0; length > 0 && r < sizeof refused / sizeof *refused; r++)
      is_refused = is_refused || strncmp(word + 2, refused[r], length) == 0;
    if (is_refused)
      return batch_fail(error, "its options have %s, which is for all meshes alike", word);
  }
  return true;
}

/** The number behind "--model" in words from the first on, 0 without; false where it is none. */
static bool model_in(const batch_words *words, int first, int64_t *model) {
  static const char option[] = "--model";
  size_t length = strlen(option);
  *model = 0;
  for (int w = first; w < words->count; w++) {
    const char *word = words->words[w], *value = NULL;
    if (strncmp(word, option, length) != 0)
      continue;
    if (word[length] == '=')
      value = word + length + 1;
    else if (!word[length])
      value = w + 1 < words->count ? words->words[++w] : "";
    if (value && !cli_read_integer(model, value, 0, UINT32_MAX))
      return false;
  }
  return true;
}

/** Models are counted up from the number that the options have, as 'voxmend augment' counts those of a
 * folder: they would all be turned alike else. It depends on the plan alone, not on what is made when. */
static bool add_model(batch_words *words, int first, const batch_item *item, batch_error *error) {
  int64_t model;
  if (!model_in(words, first, &model))
    return true; /* augment says what is wrong with it */
  model += item->number;
  if (model > UINT32_MAX)
    return batch_fail(error, "its model number, %" PRId64 ", goes beyond 4294967295: lower --model", model);
  return batch_words_add(words, "--model=%" PRId64, model) || batch_fail(error, "out of memory: free some");
}

/** The axis that is up in a picture: what the options of pictures say, or else what is usual in the mesh's
 * format, since a grid does not tell. */
static char up_of(const batch_request *given, const batch_item *item) {
  static const char option[] = "--u"; /* names may be shortened */
  batch_words words = {0};
  batch_error error;
  char up = cli_usual_up(item->member ? item->member : item->path);
  if (given->products[BATCH_PICTURE] && batch_words_split(&words, given->products[BATCH_PICTURE], &error))
    for (int w = 0; w < words.count; w++)
      if (strncmp(words.words[w], option, strlen(option)) == 0) {
        const char *value = strchr(words.words[w], '=');
        value = value ? value + 1 : w + 1 < words.count ? words.words[w + 1] : "";
        up = *value ? *value : up;
      }
  batch_words_free(&words);
  return up;
}

bool batch_add_up(batch_words *words, const batch_request *given, const batch_item *item) {
  char up = up_of(given, item);
  return up == 'z' || batch_words_add(words, "--up=%c", up);
}

/** The options of a product, and those of the item behind them. */
static bool add_options(batch_words *words, const batch_request *given, batch_product product,
                        const batch_item *item, batch_error *error) {
  int before = words->count;
  if (product == BATCH_PICTURE && !batch_add_up(words, given, item))
    return batch_fail(error, "out of memory: free some");
  if (product != BATCH_GRID)
    return batch_words_split(words, given->products[product], error) &&
           (product != BATCH_VARIANTS || add_model(words, before, item, error));
  for (int w = 0; w < given->grid_options.count; w++)
    if (!batch_words_add(words, "%s", given->grid_options.words[w]))
      return batch_fail(error, "out of memory: free some");
  int first = words->count;
  return !item->options || (batch_words_split(words, item->options, error) && check_own(words, first, error));
}

/** "voxelize OPTIONS -o NAME [--] INPUT" */
static bool add_command(batch_words *words, const batch_request *given, batch_product product,
                        const batch_item *item, const char *input, const char *output, batch_error *error) {
  if (!batch_words_add(words, "%s", product_commands[product]))
    return batch_fail(error, "out of memory: free some");
  if (!add_options(words, given, product, item, error))
    return false;
  bool good = batch_words_add(words, "-o") && batch_words_add(words, "%s", output);
  if (product == BATCH_GRID)
    good = good && batch_words_add(words, "--format=%s", given->format);
  if (input[0] == '-' && input[1])
    good = good && batch_words_add(words, "--");
  good = good && batch_words_add(words, "%s", input);
  return good || batch_fail(error, "out of memory: free some");
}

/** Options of a child, which is one of many. */
static bool add_limits(batch_words *words, const batch_request *given, uint64_t memory,
                       batch_product product) {
  bool good = batch_words_add(words, "--quiet") && batch_words_add(words, "--progress=never") &&
              batch_words_add(words, "--threads=%" PRId64, given->threads);
  if (memory > 0)
    good = good && batch_words_add(words, "--memlimit=%" PRIu64, memory);
  if (product != BATCH_PICTURE) /* what is left of a run that was ended */
    good = good && batch_words_add(words, "--force");
  return good;
}

static json_t *words_json(const batch_words *words) {
  json_t *array = json_array();
  for (int w = 0; w < words->count; w++)
    json_array_append_new(array, cli_json_text(words->words[w]));
  return array;
}

/** Adds a command and its output to a job. */
static bool add_product(json_t *job, const batch_maker *maker, batch_product product, const batch_item *item,
                        uint64_t memory, batch_error *error) {
  const batch_request *given = maker->given;
  batch_words words = {0};
  char *name = product_name(given, product, item), *path = NULL, *grid = NULL, *grid_path = NULL;
  bool good = name && asprintf(&path, "%s/%s", maker->output, name) >= 0;
  const char *input = item->member ? "-" : item->path;
  if (good && product == BATCH_PICTURE && draws_grid(given)) {
    grid = product_name(given, BATCH_GRID, item);
    good = grid && asprintf(&grid_path, "%s/%s", maker->output, grid) >= 0;
    input = grid_path;
  }
  good = good ? add_command(&words, given, product, item, input, path, error)
              : batch_fail(error, "out of memory: free some");
  /* limits first: what the user says comes behind, and is heard */
  batch_words all = {0};
  good = good && batch_words_add(&all, "%s", words.words[0]) && add_limits(&all, given, memory, product);
  for (int w = 1; good && w < words.count; w++)
    good = batch_words_add(&all, "%s", words.words[w]);
  if (good) {
    json_array_append_new(json_object_get(job, "commands"), words_json(&all));
    json_array_append_new(json_object_get(job, "outputs"), cli_json_text(name));
  }
  batch_words_free(&all);
  batch_words_free(&words);
  free(grid_path);
  free(grid);
  free(path);
  free(name);
  return good;
}

json_t *batch_make_job(const batch_item *item, uint64_t memory, void *payload, batch_error *error) {
  const batch_maker *maker = payload;
  json_t *job = json_pack("{s:o, s:o, s:o, s:o, s:o}", "item", cli_json_text(item->id), "input",
                          cli_json_text(item->path), "root", cli_json_text(maker->output), "commands",
                          json_array(), "outputs", json_array());
  if (item->member)
    json_object_set_new(job, "member", cli_json_text(item->member));
  json_object_set_new(job, "colors", json_boolean(batch_reads_colors(maker->given, item->options)));
  bool good = job != NULL;
  for (int p = 0; good && p < BATCH_PRODUCTS; p++)
    if (is_wanted(maker->given, (batch_product)p))
      good = add_product(job, maker, (batch_product)p, item, memory, error);
  if (good && maker->given->reports) {
    char *name = NULL;
    good = asprintf(&name, "%s.report.json", item->output) >= 0;
    if (good) {
      json_array_append_new(json_object_get(job, "outputs"), cli_json_text(name));
      json_object_set_new(job, "report", cli_json_text(name));
    }
    free(name);
  }
  if (good)
    return job;
  json_decref(job);
  return NULL;
}

/** Notes the bytes of the file that an option of grids names, if it does, and of the description beside it.
 */
static void add_file(json_t *settings, const batch_request *given, const char *option) {
  const char *path = NULL;
  size_t length = strlen(option);
  for (int w = 0; w < given->grid_options.count; w++)
    if (strncmp(given->grid_options.words[w], option, length) == 0 &&
        given->grid_options.words[w][length] == '=')
      path = given->grid_options.words[w] + length + 1;
  bool is_word = path && strcmp(option, "--color") == 0 && !strchr(path, '.'); /* such as "mesh" */
  char *key = NULL, *digest = path && !is_word ? batch_file_digest(path) : NULL;
  if (digest && asprintf(&key, BATCH_FILE_OF "%s", option) >= 0)
    json_object_set_new(settings, key, json_string(digest));
  free(key);
  free(digest);
}

json_t *batch_make_settings(const batch_request *given) {
  json_t *settings = json_object();
  add_file(settings, given, "--like");
  add_file(settings, given, "--color");
  for (int p = 0; p < BATCH_PRODUCTS; p++) {
    char *text =
        p == BATCH_GRID ? batch_words_text(given->grid_options.words, given->grid_options.count) : NULL;
    if (is_wanted(given, (batch_product)p))
      json_object_set_new(settings, product_commands[p],
                          cli_json_text(p == BATCH_GRID ? (text ? text : "") : given->products[p]));
    free(text);
  }
  if (!given->no_grid)
    json_object_set_new(settings, "format", cli_json_text(given->format));
  json_object_set_new(settings, "reports", json_string(given->reports ? "yes" : "no"));
  return settings;
}

/** The command that unpacks one member of an archive to standard output. */
static const char *unpacker_of(const char *archive) {
  const char *dot = strrchr(archive, '.');
  return dot && strcasecmp(dot, ".zip") == 0 ? "unzip -p" : "bsdtar -xOf";
}

/** The last part of a name: where a command of its own writes to. Belongs to the name. */
static const char *base_of(const char *name) {
  const char *slash = strrchr(name, '/');
  return slash ? slash + 1 : name;
}

/** "unzip -p ARCHIVE MEMBER | ", or "" where the mesh is a file, to be freed. */
static char *unpacking_of(const batch_item *item) {
  batch_words source = {0};
  char *words = NULL, *text = NULL;
  if (!item->member)
    return strdup("");
  if (batch_words_add(&source, "%s", item->path) && batch_words_add(&source, "%s", item->member))
    words = batch_words_text(source.words, source.count);
  if (words && asprintf(&text, "%s %s | ", unpacker_of(item->path), words) < 0)
    text = NULL;
  batch_words_free(&source);
  free(words);
  return text;
}

/** The command that makes a product alone, to be freed; NULL where there is none. */
static char *product_line(const batch_item *item, const batch_request *given, batch_product product) {
  bool is_of_grid = product == BATCH_PICTURE && draws_grid(given);
  batch_words words = {0};
  batch_error error;
  char *name = product_name(given, product, item), *grid = product_name(given, BATCH_GRID, item);
  char *unpacking = is_of_grid ? strdup("") : unpacking_of(item), *text = NULL, *line = NULL;
  const char *input = is_of_grid && grid ? base_of(grid) : item->member ? "-" : item->path;
  if (name && grid && batch_words_add(&words, "voxmend") &&
      add_command(&words, given, product, item, input, base_of(name), &error))
    text = batch_words_text(words.words, words.count);
  if (text && unpacking && asprintf(&line, "%s%s", unpacking, text) < 0)
    line = NULL;
  batch_words_free(&words);
  free(text);
  free(unpacking);
  free(grid);
  free(name);
  return line;
}

/** Whether a product plays a part in what failed at a stage: a picture is drawn of the grid. */
static bool is_of_stage(const batch_request *given, batch_product product, const char *stage) {
  bool is_command = false;
  for (int p = 0; p < BATCH_PRODUCTS; p++)
    is_command = is_command || (stage && strcmp(stage, product_commands[p]) == 0);
  return !is_command || strcmp(stage, product_commands[product]) == 0 ||
         (product == BATCH_GRID && draws_grid(given) && strcmp(stage, product_commands[BATCH_PICTURE]) == 0);
}

char *batch_command_line(const batch_item *item, const char *stage, const batch_maker *maker) {
  const batch_request *given = maker->given;
  char *all = NULL;
  if (item->is_misnamed) /* nothing was run, and what a journal has of the name is another one */
    return NULL;
  for (int p = 0; p < BATCH_PRODUCTS; p++) {
    batch_product product = (batch_product)p;
    bool is_meant = is_wanted(given, product) && is_of_stage(given, product, stage);
    char *line = is_meant ? product_line(item, given, product) : NULL, *joined = NULL;
    if (!line)
      continue;
    if (asprintf(&joined, "%s%s%s", all ? all : "", all ? " && " : "", line) < 0)
      joined = NULL;
    free(line);
    free(all);
    all = joined;
  }
  return all;
}
