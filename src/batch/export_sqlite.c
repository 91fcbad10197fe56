/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/export_sqlite.h"
#include "batch/journal.h"
#include "batch/plan.h"
#include "config.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef HAVE_SQLITE
#include <sqlite3.h>

static const char schema[] =
    "CREATE TABLE meshes (item TEXT PRIMARY KEY, path TEXT, member TEXT, class TEXT, split TEXT, bytes "
    "INTEGER,"
    " status TEXT, stage TEXT, message TEXT, attempt INTEGER, sha256 TEXT, duplicate_of TEXT, voxels INTEGER,"
    " hash TEXT, parts INTEGER, contested INTEGER, thin_share REAL, origin_x REAL, origin_y REAL, origin_z "
    "REAL,"
    " voxel_size REAL, wall_ms REAL, cpu_ms REAL, peak_bytes INTEGER, record TEXT) WITHOUT ROWID;"
    "CREATE TABLE outputs (item TEXT, path TEXT, bytes INTEGER, sha256 TEXT);"
    "CREATE TABLE warnings (item TEXT, text TEXT);";
static const char insert_mesh[] = "INSERT INTO meshes (item, path, member, class, split, bytes, status) "
                                  "VALUES (?1, ?2, ?3, ?4, ?5, ?6, 'pending')";
static const char update_mesh[] =
    "UPDATE meshes SET status = ?2, stage = ?3, message = ?4, attempt = ?5, sha256 = ?6, duplicate_of = ?7,"
    " voxels = ?8, hash = ?9, parts = ?10, contested = ?11, thin_share = ?12, origin_x = ?13, origin_y = ?14,"
    " origin_z = ?15, voxel_size = ?16, wall_ms = ?17, cpu_ms = ?18, peak_bytes = ?19, record = ?20 WHERE "
    "item = ?1";

typedef struct database {
  sqlite3 *handle;
  sqlite3_stmt *insert, *update, *output, *warning, *forget[2];
  int64_t rows;
} database;

/* ---- Binding ---- */

static void bind(sqlite3_stmt *statement, int at, const json_t *value) {
  if (json_is_string(value))
    sqlite3_bind_text(statement, at, json_string_value(value), -1, SQLITE_TRANSIENT);
  else if (json_is_integer(value))
    sqlite3_bind_int64(statement, at, json_integer_value(value));
  else if (json_is_real(value))
    sqlite3_bind_double(statement, at, json_real_value(value));
  else
    sqlite3_bind_null(statement, at);
}

static bool step(sqlite3_stmt *statement) {
  bool good = sqlite3_step(statement) == SQLITE_DONE;
  sqlite3_reset(statement);
  return good;
}

/* ---- Rows ---- */

static bool take_item(const json_t *item, void *payload) {
  static const char *const keys[] = {"item", "path", "member", "class", "split", "bytes"};
  database *d = payload;
  for (int k = 0; k < 6; k++)
    bind(d->insert, k + 1, json_object_get(item, keys[k]));
  d->rows++;
  return step(d->insert);
}

static bool take_rows(const database *d, const json_t *item, const json_t *record) {
  json_t *value;
  size_t at;
  bool good = true;
  for (int f = 0; f < 2; f++) {
    bind(d->forget[f], 1, item);
    good = good && step(d->forget[f]);
  }
  json_array_foreach(json_object_get(record, "outputs"), at, value) {
    static const char *const keys[] = {"path", "bytes", "sha256"};
    bind(d->output, 1, item);
    for (int k = 0; k < 3; k++)
      bind(d->output, k + 2, json_object_get(value, keys[k]));
    good = good && step(d->output);
  }
  json_array_foreach(json_object_get(record, "warnings"), at, value) {
    bind(d->warning, 1, item);
    bind(d->warning, 2, value);
    good = good && step(d->warning);
  }
  return good;
}

static bool take_record(json_t *record, void *payload) {
  static const char *const keys[] = {"status", "stage", "message", "attempt", "sha256", "duplicate_of"};
  static const char *const costs[] = {"wall_ms", "cpu_ms", "peak_bytes"};
  database *d = payload;
  const char *event = batch_json_text(record, "event");
  const json_t *item = json_object_get(record, "item"), *made = json_object_get(record, "voxelize");
  const json_t *grid = json_object_get(made, "grid"), *origin = json_object_get(grid, "origin");
  if (!event || (strcmp(event, "end") != 0 && strcmp(event, "changed") != 0))
    return true;
  bind(d->update, 1, item);
  for (int k = 0; k < 6; k++)
    bind(d->update, k + 2, json_object_get(record, keys[k]));
  bind(d->update, 8, json_object_get(made, "voxels"));
  bind(d->update, 9, json_object_get(made, "hash"));
  bind(d->update, 10, json_object_get(made, "parts"));
  bind(d->update, 11, json_object_get(json_object_get(made, "votes"), "contested"));
  bind(d->update, 12, json_object_get(json_object_get(made, "thin"), "share"));
  for (size_t a = 0; a < 3; a++)
    bind(d->update, 13 + (int)a, json_array_get(origin, a));
  bind(d->update, 16, json_array_get(json_object_get(grid, "voxel_size"), 0));
  for (int k = 0; k < 3; k++)
    bind(d->update, k + 17, json_object_get(record, costs[k]));
  char *text = json_dumps(record, JSON_COMPACT);
  sqlite3_bind_text(d->update, 20, text, -1, SQLITE_TRANSIENT);
  free(text);
  return step(d->update) && take_rows(d, item, record);
}

/* ---- A database ---- */

static bool prepare(database *d, const char *path) {
  return sqlite3_open(path, &d->handle) == SQLITE_OK &&
         sqlite3_exec(d->handle, "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN", NULL, NULL,
                      NULL) == SQLITE_OK &&
         sqlite3_exec(d->handle, schema, NULL, NULL, NULL) == SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, insert_mesh, -1, &d->insert, NULL) == SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, update_mesh, -1, &d->update, NULL) == SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, "INSERT INTO outputs VALUES (?, ?, ?, ?)", -1, &d->output, NULL) ==
             SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, "INSERT INTO warnings VALUES (?, ?)", -1, &d->warning, NULL) ==
             SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, "DELETE FROM outputs WHERE item = ?", -1, &d->forget[0], NULL) ==
             SQLITE_OK &&
         sqlite3_prepare_v2(d->handle, "DELETE FROM warnings WHERE item = ?", -1, &d->forget[1], NULL) ==
             SQLITE_OK;
}

static bool fill(database *d, const char *output, batch_error *error) {
  json_t *run = batch_plan_read(output, error);
  int shards = (int)json_integer_value(json_object_get(run, "shards"));
  json_decref(run);
  bool good = run && batch_plan_each(output, take_item, d, error);
  for (int s = 0; good && s < shards; s++) {
    char *journal = batch_journal_path(output, s, shards);
    if (journal && access(journal, F_OK) == 0)
      good = batch_journal_read(journal, take_record, d, NULL, error);
    free(journal);
  }
  return good;
}

static void finalize(database *d) {
  sqlite3_stmt *const all[] = {d->insert, d->update, d->output, d->warning, d->forget[0], d->forget[1]};
  for (size_t s = 0; s < sizeof all / sizeof *all; s++)
    sqlite3_finalize(all[s]);
  sqlite3_close(d->handle);
}

/** SQLite says no more than that it cannot open the file. */
static bool need_folder(const char *path, batch_error *error) {
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, slash > path ? (size_t)(slash - path) : 1) : strdup(".");
  struct stat info;
  bool good = folder || batch_fail(error, "out of memory: free some");
  if (good && (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode)))
    good = batch_fail(error, "%s: there is no folder %s to write it in; make that first", path, folder);
  free(folder);
  return good;
}

bool batch_export_sqlite(const char *output, const char *path, int64_t *rows, batch_error *error) {
  database d = {0};
  char *temporary = NULL;
  if (!need_folder(path, error))
    return false;
  if (asprintf(&temporary, "%s.%ld.tmp", path, (long)getpid()) < 0)
    return batch_fail(error, "out of memory: free some");
  unlink(temporary);
  error->text[0] = '\0';
  bool good = prepare(&d, temporary) && fill(&d, output, error) &&
              sqlite3_exec(d.handle, "COMMIT", NULL, NULL, NULL) == SQLITE_OK;
  if (!good && !error->text[0])
    batch_fail(error, "%s: cannot write the database: %s", path,
               d.handle ? sqlite3_errmsg(d.handle) : "out of memory");
  finalize(&d);
  good = good && (rename(temporary, path) == 0 || batch_fail_errno(error, "%s: cannot write", path));
  if (!good)
    unlink(temporary);
  free(temporary);
  *rows = d.rows;
  return good;
}
#else
bool batch_export_sqlite(const char *output, const char *path, int64_t *rows, batch_error *error) {
  (void)output, (void)rows;
  return batch_fail(error, "%s: this build writes no databases (SQLite was not found when it was configured)",
                    path);
}
#endif
