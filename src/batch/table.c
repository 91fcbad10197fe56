/* SPDX-License-Identifier: BSD-3-Clause */
/** Lists of paths, and tables as RFC 4180 has them (.csv), or with tabs (.tsv). */
#include "batch/inputs.h"

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

/**
 * Reads a cell into a buffer. Returns what ended it: the separator, '\n' or EOF; -2 if it is too long or a
 * quote is not closed.
 */
static int read_cell(table *t, char *buffer, size_t *length) {
  bool quoted = false, was_quoted = false;
  *length = 0;
  for (;;) {
    int c = getc(t->file);
    if (c == '\n')
      t->next_line++;
    if (c == '"' && t->separator && !quoted && *length == 0 && !was_quoted) {
      quoted = was_quoted = true;
      continue;
    }
    if (c == '"' && quoted) {
      int after = getc(t->file);
      if (after != '"') {
        quoted = false;
        ungetc(after, t->file);
        continue;
      }
    }
    if (c == EOF)
      return quoted ? -2 : EOF;
    if (!quoted && (c == '\n' || (t->separator && c == t->separator)))
      return c;
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
    if (end != t->separator || !t->separator)
      while (length > 0 && buffer[length - 1] == '\r')
        length--;
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
                     .kind = cell(t, KIND),
                     .split = cell(t, SPLIT),
                     .options = cell(t, OPTIONS),
                     .bytes = is_there ? (uint64_t)info.st_size : 0,
                     .modified =
                         is_there ? (int64_t)info.st_mtim.tv_sec * 1000000000 + info.st_mtim.tv_nsec : 0};
  while (item.id[0] == '.' && item.id[1] == '/')
    item.id += 2;
  bool good = batch_manifest_add(out, &item, error);
  if (path != name)
    free(path);
  return good;
}

static bool read_columns(table *t, batch_error *error) {
  static const char *const names[KNOWN] = {"path", "id", "class", "split", "options"};
  int got = read_row(t, error);
  if (got <= 0)
    return got == 0 ? batch_fail(error, "%s: the table is empty", t->name) : false;
  for (int c = 0; c < t->cell_count; c++)
    for (int k = 0; k < KNOWN; k++)
      if (strcasecmp(t->cells[c], names[k]) == 0)
        t->columns[k] = c;
  return t->columns[PATH] >= 0 ||
         batch_fail(error,
                    "%s, line 1: no column is named 'path'; the others may be id, class, split, options",
                    t->name);
}

static bool read_table(batch_manifest *out, table *t, batch_error *error) {
  if (t->separator && !read_columns(t, error))
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
