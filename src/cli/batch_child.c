/* SPDX-License-Identifier: BSD-3-Clause */
/** In a child: goes through the commands of a job and says what came of it. */
#include "batch/companions.h"
#include "batch/digest.h"
#include "batch/outputs.h"
#include "cli/batch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- Results ---- */

/** A text in which `words`, where they stand first, are replaced by others; to be freed. */
static char *with_words_replaced(const char *text, const char *words, const char *others) {
  const char *found = strstr(text, words);
  char *out = NULL;
  if (!found || asprintf(&out, "%.*s%s%s", (int)(found - text), text, others, found + strlen(words)) < 0)
    return strdup(text);
  return out;
}

/** Messages about standard input, as they are of a member of an archive: it has another name, and though
 * there are files beside it, it is read alone, and no option changes that. */
static char *of_item(const char *text, const json_t *job) {
  static const char *const misleading[] = {
      "was not opened: a mesh that is not a file has no folder (--external any opens it)",
      "was not opened: there is no such file"};
  char *out = with_words_replaced(text, "<stdin>", batch_json_text(job, "item"));
  for (int m = 0; m < 2 && out && batch_json_text(job, "member"); m++) {
    char *line = with_words_replaced(
        out, misleading[m],
        "was not opened: a mesh in an archive is read without the files beside it; unpack "
        "the archive, and give its folder");
    free(out);
    out = line;
  }
  return out;
}

/** A report without what depends on the run or the machine, so that those of the same mesh are equal. */
static json_t *without_run_details(const json_t *report) {
  static const char *const passing[] = {"input", "output", "time_ms", "peak_bytes", "estimate", "warnings"};
  json_t *kept = json_copy((json_t *)(uintptr_t)report);
  for (size_t k = 0; kept && k < sizeof passing / sizeof *passing; k++)
    json_object_del(kept, passing[k]);
  return kept;
}

/** Of passes of a repair only those that changed something are told in a journal. */
static json_t *short_report(const json_t *report) {
  json_t *kept = without_run_details(report), *passes = json_object_get(kept, "repair"), *pass,
         *counts = json_object();
  size_t p;
  json_array_foreach(passes, p, pass) if (json_integer_value(json_object_get(pass, "count")) > 0)
      json_object_set(counts, batch_json_text(pass, "pass") ? batch_json_text(pass, "pass") : "?",
                      json_object_get(pass, "count"));
  if (json_is_array(passes))
    json_object_set(kept, "repair", counts);
  json_decref(counts);
  static const char *const long_ones[] = {"parts", "defects", "passes", "label_table"};
  for (size_t k = 0; k < sizeof long_ones / sizeof *long_ones; k++)
    if (json_is_array(json_object_get(kept, long_ones[k])))
      json_object_del(kept, long_ones[k]);
  return kept;
}

/** Whether an error's file is this one; of long names it has the end alone. */
static bool names(const char *file, const char *path) {
  size_t length = strlen(file), whole = strlen(path);
  return length > 0 && length <= whole && strcmp(path + whole - length, file) == 0;
}

static batch_status status_of(const cli_capture *capture, const char *input) {
  switch (capture->error.code) {
  case VXM_ERROR_FORMAT:
  case VXM_ERROR_EMPTY:
    return BATCH_UNREADABLE;
  case VXM_ERROR_IO:
    return names(capture->error.file, input) ? BATCH_UNREADABLE : BATCH_FAILED;
  case VXM_ERROR_MEMORY:
  case VXM_ERROR_MEMORY_LIMIT:
    return BATCH_OOM;
  default:
    return BATCH_FAILED;
  }
}

static void tell_failure(json_t *result, const cli_capture *capture, const char *command, const char *input,
                         const json_t *job) {
  bool is_known = capture->error.code != VXM_OK;
  batch_status status = status_of(capture, input);
  json_object_set_new(result, "status", json_string(batch_status_names[status]));
  json_object_set_new(result, "stage", json_string(status == BATCH_UNREADABLE ? "read" : command));
  if (!is_known)
    return; /* its line is on standard error */
  char *text = of_item(capture->error.text, job);
  json_object_set_new(result, "message", cli_json_text(text ? text : capture->error.text));
  json_object_set_new(result, "code", json_string(vxm_status_name(capture->error.code)));
  if (capture->error.system == ENOSPC || capture->error.system == EDQUOT)
    json_object_set_new(result, "disk_full", json_true());
  free(text);
}

/* ---- Commands ---- */

/** The words of a command; they belong to the job. */
static char **words_of(const json_t *command, int *count) {
  size_t length = json_array_size(command);
  char **words = calloc(length + 1, sizeof *words);
  for (size_t w = 0; words && w < length; w++)
    words[w] = (char *)(uintptr_t)json_string_value(json_array_get(command, w));
  *count = (int)length;
  return words;
}

static void add_warnings(json_t *result, const json_t *report, const json_t *job) {
  enum { MOST = 20 };
  json_t *all = json_object_get(result, "warnings"), *warnings = json_object_get(report, "warnings"),
         *warning;
  size_t w;
  json_array_foreach(warnings, w, warning) {
    char *text = json_array_size(all) < MOST ? of_item(json_string_value(warning), job) : NULL;
    if (text)
      json_array_append_new(all, cli_json_text(text));
    free(text);
  }
}

/** What the commands of a job have in common. */
typedef struct making {
  const json_t *job;
  json_t *result, *reports;
  json_t *companions; /**< names of files that were read beside the mesh */
} making;

/** Runs a command; false after a failure, which is told in the result. */
static bool do_command(const making *m, const json_t *command) {
  const json_t *job = m->job;
  json_t *result = m->result;
  const char *member = batch_json_text(job, "member");
  cli_capture capture = {.format = member ? batch_extension(member) : NULL,
                         .companions = member ? NULL : m->companions,
                         .error = VXM_ERROR_INIT};
  int count;
  char **words = words_of(command, &count);
  if (!words || count == 0)
    return false;
  lseek(STDIN_FILENO, 0, SEEK_SET);
  int status = cli_capture_command(words[0], count, words, &capture);
  if (status == CLI_DONE && capture.report) {
    json_object_set_new(result, words[0], short_report(capture.report));
    json_object_set_new(m->reports, words[0], without_run_details(capture.report));
    add_warnings(result, capture.report, job);
  } else
    tell_failure(result, &capture, words[0], member ? "<stdin>" : batch_json_text(job, "input"), job);
  json_decref(capture.report);
  free(words);
  return status == CLI_DONE;
}

/* ---- Files ---- */

/** All that the outputs consist of, with what lies beside them; NULL where one is not there. */
static json_t *list_files(const json_t *job, const char *root) {
  json_t *files = json_array(), *name;
  size_t n;
  bool good = true;
  json_array_foreach(json_object_get(job, "outputs"), n, name) {
    const char *text = json_string_value(name);
    char *beside = NULL;
    json_t *file = batch_output_describe(root, text);
    good = good && file;
    if (file)
      json_array_append_new(files, file);
    file = asprintf(&beside, "%s.json", text) >= 0 ? batch_output_describe(root, beside) : NULL;
    if (file)
      json_array_append_new(files, file);
    free(beside);
  }
  if (good)
    return files;
  json_decref(files);
  return NULL;
}

static bool write_report(json_t *result, const json_t *job, json_t *reports, const char *root) {
  const char *name = batch_json_text(job, "report");
  char *path = NULL, *text = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (!name)
    return true;
  json_object_set(reports, "warnings", json_object_get(result, "warnings"));
  text = json_dumps(reports, JSON_INDENT(2) | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
  bool good = text && asprintf(&path, "%s/%s", root, name) >= 0 &&
              vxm_file_write(NULL, path, text, strlen(text), &error) == VXM_OK;
  if (!good) {
    cli_capture capture = {.error = error};
    tell_failure(result, &capture, "report", "", job);
  }
  free(path);
  free(text);
  return good;
}

/* ---- A job ---- */

/** Called after the work, like digest_input: by then it is known which files were read. */
static void tell_companions(json_t *result, const json_t *job, const json_t *names) {
  json_t *companions =
      json_array_size(names) > 0 ? batch_companions_describe(batch_json_text(job, "input"), names) : NULL;
  if (companions)
    json_object_set_new(result, "companions", companions);
}

static bool do_commands(json_t *result, const json_t *job, const char *root) {
  const making m = {job, result, json_object(), json_array()};
  json_t *command;
  size_t c;
  bool good = true;
  json_array_foreach(json_object_get(job, "commands"), c, command) good = good && do_command(&m, command);
  good = good && write_report(result, job, m.reports, root);
  tell_companions(result, job, m.companions);
  json_decref(m.companions);
  json_decref(m.reports);
  return good;
}

static bool digest_input(json_t *result, const json_t *job) {
  char digest[BATCH_DIGEST];
  uint64_t bytes;
  bool is_member = json_object_get(job, "member") != NULL;
  const char *path = batch_json_text(job, "input");
  bool good =
      is_member ? batch_digest_open(digest, &bytes, STDIN_FILENO) : batch_digest_file(digest, &bytes, path);
  if (good) {
    json_object_set_new(result, "sha256", json_string(digest));
    json_object_set_new(result, "bytes", json_integer((json_int_t)bytes));
  }
  if (good && !is_member && batch_refers_to_others(path, json_is_true(json_object_get(job, "colors"))))
    json_object_set_new(result, "refers_to_others", json_true());
  return good;
}

static json_t *make_outputs(const json_t *job, const char *root) {
  json_t *result = json_pack("{s:[]}", "warnings");
  if (do_commands(result, job, root)) {
    size_t warnings = json_array_size(json_object_get(result, "warnings"));
    json_t *files = list_files(job, root);
    batch_status status = !files ? BATCH_FAILED : warnings ? BATCH_DEGRADED : BATCH_OK;
    json_object_set_new(result, "status", json_string(batch_status_names[status]));
    if (files)
      json_object_set_new(result, "outputs", files);
    else
      json_object_set_new(result, "message",
                          json_string("its options keep it from writing what was asked for"));
  }
  digest_input(result, job); /* behind the work: what cannot be read has been told in other words */
  return result;
}

/** Of what is to be compared with others: "" for a file that cannot be read, or that means something else in
 * another folder. */
static json_t *digest_files(const json_t *paths, const json_t *options, const batch_maker *maker) {
  json_t *result = json_object(), *digests = json_array(), *path;
  size_t p;
  json_array_foreach(paths, p, path) {
    char digest[BATCH_DIGEST] = "";
    uint64_t bytes;
    const char *name = json_string_value(path), *own = json_string_value(json_array_get(options, p));
    if (batch_refers_to_others(name, batch_reads_colors(maker->given, own)) ||
        !batch_digest_file(digest, &bytes, name))
      digest[0] = '\0';
    json_array_append_new(digests, json_string(digest));
  }
  json_object_set_new(result, "hash", digests);
  return result;
}

int batch_do_job(const char *request, int descriptor, void *payload) {
  json_t *job = json_loads(request, 0, NULL), *result;
  if (!job)
    return 1;
  const json_t *paths = json_object_get(job, "hash");
  result = paths ? digest_files(paths, json_object_get(job, "options"), payload)
                 : make_outputs(job, batch_json_text(job, "root"));
  char *text = json_dumps(result, JSON_COMPACT | JSON_REAL_PRECISION(17));
  fflush(NULL);
  return text && batch_write_all(descriptor, text, strlen(text)) ? 0 : 1;
}
