/* SPDX-License-Identifier: BSD-3-Clause */
/** Lists of paths, and tables as RFC 4180 has them (.csv), or with tabs (.tsv). */
#include "batch/inputs.h"
#include "batch/placement.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { COLUMNS_MAX = 256, CELL_BYTES = 1 << 16 };
enum { PATH, ID, KIND, SPLIT, OPTIONS, KNOWN };

typedef struct table {
  FILE *file;
  const char *name; /**< for messages */
  char separator;   /**< '\0' = a list: a line is a path */
  char *folder;     /**< that paths are relative to, with its slash */
  int64_t line;     /**< of the present row's beginning */
  int64_t next_line;
  char *cells[COLUMNS_MAX];
  int cell_count;
  int columns[KNOWN]; /**< which column has it; -1 = none */
} table;

static void free_cells(table *t) {
  for (int c = 0; c < t->cell_count; c++)
    free(t->cells[c]);
  t->cell_count = 0;
}

/* ---- Rows ---- */

/** Whether all of the file that has been read is the mark that Windows and spreadsheets put before UTF-8. */
static bool is_mark(const table *t, const char *buffer, size_t length) {
  return t->line == 1 && t->cell_count == 0 && length == 3 && memcmp(buffer, "\xef\xbb\xbf", 3) == 0;
}

static bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

/** The length without blanks at the end, behind what stood in quotes; the ends of lines of Windows count as
 * such. */
static size_t trimmed(const table *t, const char *buffer, size_t length, size_t quoted, int end) {
  bool is_last = end != t->separator || !t->separator;
  while (length > quoted &&
         ((is_last && buffer[length - 1] == '\r') || (t->separator && is_blank(buffer[length - 1]))))
    length--;
  return length;
}

/**
 * Reads a cell into a buffer, of a table without blanks around it. Returns what ended it: the separator, '\n'
 * or EOF; -2 if it is too long or a quote is not closed.
 */
static int read_cell(table *t, char *buffer, size_t *length) {
  bool quoted = false, was_quoted = false;
  size_t in_quotes = 0;
  *length = 0;
  for (;;) {
    int c = getc(t->file);
    if (c == '\n')
      t->next_line++;
    if (t->separator && *length == 0 && !was_quoted && c != t->separator && is_blank((char)c))
      continue;
    if (c == '"' && t->separator && !quoted && *length == 0 && !was_quoted) {
      quoted = was_quoted = true;
      continue;
    }
    if (c == '"' && quoted) {
      int after = getc(t->file);
      if (after != '"') {
        quoted = false;
        in_quotes = *length;
        ungetc(after, t->file);
        continue;
      }
    }
    if (c == EOF && quoted)
      return -2;
    if (c == EOF || (!quoted && (c == '\n' || (t->separator && c == t->separator)))) {
      *length = trimmed(t, buffer, *length, in_quotes, c);
      return c;
    }
    if (*length + 1 >= CELL_BYTES || c == '\0')
      return -2;
    buffer[(*length)++] = (char)c;
    if (!was_quoted && is_mark(t, buffer, *length))
      *length = 0;
  }
}

/** 1; 0 at the end; -1 after a failure. */
static int read_row(table *t, batch_error *error) {
  static char buffer[CELL_BYTES];
  free_cells(t);
  t->line = t->next_line;
  for (;;) {
    size_t length;
    int end = read_cell(t, buffer, &length);
    if (end == -2)
      batch_fail(error, "%s, line %lld: a cell is too long, or its quotes are not closed", t->name,
                 (long long)t->line);
    else if (t->cell_count == COLUMNS_MAX)
      batch_fail(error, "%s, line %lld: more than %d columns", t->name, (long long)t->line, COLUMNS_MAX);
    if (end == -2 || t->cell_count == COLUMNS_MAX)
      return -1;
    if (end == EOF && t->cell_count == 0 && length == 0)
      return 0;
    char *cell = strndup(buffer, length);
    if (!cell) {
      batch_fail(error, "out of memory for %s: free some", t->name);
      return -1;
    }
    t->cells[t->cell_count++] = cell;
    if (end == '\n' || end == EOF)
      return 1;
  }
}

/* ---- Items ---- */

static char *cell(const table *t, int what) {
  int column = t->columns[what];
  return column >= 0 && column < t->cell_count && t->cells[column][0] ? t->cells[column] : NULL;
}

static bool is_empty(const table *t) {
  return t->cell_count == 0 ||
         (t->cell_count == 1 && (!t->cells[0][0] || (!t->separator && t->cells[0][0] == '#')));
}

/** The name of a column, a class or a split: without blanks around it, in quotes either. */
static char *bare(char *word) {
  if (!word)
    return NULL;
  while (is_blank(*word))
    word++;
  for (size_t length = strlen(word); length > 0 && is_blank(word[length - 1]);)
    word[--length] = '\0';
  return *word ? word : NULL;
}

/** What its row and the folders of its id tell, or of its path, where the id names none. */
static bool add_placed(batch_manifest *out, batch_item *item, const char *name, batch_error *error) {
  const char *known = item->split ? batch_split_named(item->split, strlen(item->split)) : NULL;
  char *kind = item->kind ? strdup(item->kind) : NULL;
  char *split = item->split ? strdup(known ? known : item->split) : NULL;
  bool good = !kind == !item->kind && !split == !item->split &&
              batch_place(&kind, &split, strchr(item->id, '/') ? item->id : name);
  item->kind = kind;
  item->split = split;
  good = good ? batch_manifest_add(out, item, error)
              : batch_fail(error, "out of memory for the list of meshes: free some");
  free(kind);
  free(split);
  return good;
}

static bool add_row(batch_manifest *out, const table *t, batch_error *error) {
  char *name = cell(t, PATH), *path = name;
  struct stat info;
  if (!name)
    return batch_fail(error, "%s, line %lld: the path is missing", t->name, (long long)t->line);
  if (name[0] != '/' && asprintf(&path, "%s%s", t->folder, name) < 0)
    return batch_fail(error, "out of memory for %s: free some", t->name);
  bool is_there = stat(path, &info) == 0; /* what is missing is told of when its turn comes */
  batch_item item = {.id = cell(t, ID) ? cell(t, ID) : name,
                     .path = path,
                     .kind = bare(cell(t, KIND)),
                     .split = bare(cell(t, SPLIT)),
                     .options = cell(t, OPTIONS),
                     .bytes = is_there ? (uint64_t)info.st_size : 0,
                     .modified = is_there ? batch_modified(&info) : 0};
  while (item.id[0] == '.' && item.id[1] == '/')
    item.id += 2;
  bool good = add_placed(out, &item, name, error);
  if (path != name)
    free(path);
  return good;
}

/* ---- The names of the columns ---- */

static int column_named(const char *name) {
  static const char *const names[KNOWN] = {"path", "id", "class", "split", "options"};
  for (int k = 0; k < KNOWN; k++)
    if (strcasecmp(name, names[k]) == 0)
      return k;
  return -1;
}

/** Once, of the first table that has such; so many names as there is room for. */
static void warn_of_columns(batch_manifest *out, const table *t, char *const *names, int count) {
  char list[300] = "";
  size_t used = 0;
  int told = 0;
  if (count == 0 || *out->warning)
    return;
  for (; told < count && used + strlen(names[told]) + 5 < sizeof list; told++)
    used += (size_t)snprintf(list + used, sizeof list - used, "%s'%s'", told ? ", " : "", names[told]);
  snprintf(
      out->warning, sizeof out->warning,
      "%.300s: the column%s %s%s %s not used; the names that are known are path, id, class, split, options",
      t->name, count == 1 ? "" : "s", list,
      told == count ? ""
      : told == 0   ? "with long names"
                    : ", ...",
      count == 1 ? "is" : "are");
}

static bool read_columns(batch_manifest *out, table *t, batch_error *error) {
  char *others[COLUMNS_MAX];
  int other_count = 0, got = read_row(t, error);
  if (got <= 0)
    return got == 0 ? batch_fail(error, "%s: the table is empty", t->name) : false;
  for (int c = 0; c < t->cell_count; c++) {
    char *name = bare(t->cells[c]);
    int known = name ? column_named(name) : -1;
    if (known >= 0)
      t->columns[known] = c;
    else if (name)
      others[other_count++] = name;
  }
  warn_of_columns(out, t, others, other_count);
  return t->columns[PATH] >= 0 ||
         batch_fail(error,
                    "%s, line 1: no column is named 'path'; the others may be id, class, split, options",
                    t->name);
}

static bool read_table(batch_manifest *out, table *t, batch_error *error) {
  if (t->separator && !read_columns(out, t, error))
    return false;
  int got;
  while ((got = read_row(t, error)) > 0)
    if (!is_empty(t) && !add_row(out, t, error))
      return false;
  if (got == 0 && ferror(t->file))
    return batch_fail_errno(error, "%s: cannot read it", t->name);
  return got == 0;
}

bool batch_table_read(batch_manifest *out, const char *path, batch_error *error) {
  bool is_standard = strcmp(path, "-") == 0;
  const char *slash = strrchr(path, '/'), *extension = batch_extension(path);
  table t = {.name = is_standard ? "<stdin>" : path, .next_line = 1, .columns = {0, -1, -1, -1, -1}};
  t.separator = strcasecmp(extension, "csv") == 0 ? ',' : strcasecmp(extension, "tsv") == 0 ? '\t' : '\0';
  if (t.separator)
    t.columns[PATH] = -1;
  t.folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup("");
  t.file = is_standard ? stdin : fopen(path, "re");
  bool good =
      t.file && t.folder ? read_table(out, &t, error) : batch_fail_errno(error, "%s: cannot read it", path);
  free_cells(&t);
  free(t.folder);
  if (t.file && !is_standard)
    fclose(t.file);
  return good;
}
