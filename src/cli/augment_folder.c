/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: a folder with a file of each variant. */
#include "cli/augment.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
  CHUNK = 64, /**< files made by all threads between two looks at the progress */
  PATH_SIZE = 4096
};

/* ---- Names ---- */

static bool has_json(const char *format) {
  return strcmp(format, "raw") == 0 || strcmp(format, "npy") == 0;
}

static void name_file(char *out, const augment_request *given, int64_t made, const char *behind) {
  snprintf(out, PATH_SIZE, "%s/%06" PRId64 ".%s%s", given->output, given->first + made, given->format,
           behind);
}

/** The number of the variant that a file name, without its folder, stands for; -1 = none. */
static int64_t number_of(const char *name, const char *format) {
  char made[64];
  if (!isdigit((unsigned char)*name))
    return -1;
  long long number = strtoll(name, NULL, 10);
  int length = snprintf(made, sizeof made, "%06lld.%s", number, format);
  bool is_one = strncmp(name, made, (size_t)length) == 0 &&
                (name[length] == '\0' || (has_json(format) && strcmp(name + length, ".json") == 0));
  return is_one ? number : -1;
}

static bool is_wanted(const augment_request *given, int64_t number) {
  return number >= given->first && number - given->first < given->count;
}

/** The same, whatever the format. */
static int64_t number_of_any(const char *name) {
  int64_t number = -1;
  for (int f = 0; number < 0 && augment_file_formats[f]; f++)
    number = number_of(name, augment_file_formats[f]);
  return number;
}

/** Whether a file of this name, without its folder, is one that will be written, or removed. */
static bool will_be_replaced(const augment_request *given, const char *name) {
  return given->force ? number_of_any(name) >= given->first
                      : is_wanted(given, number_of(name, given->format));
}

/** CLI_STOP if a file of the folder that will be replaced is `path`, whatever its name there. */
static int check_name(cli_run *cli, const augment_request *given, const char *path, const char *what) {
  char folder[PATH_SIZE], inside[PATH_SIZE + NAME_MAX];
  const char *slash = strrchr(path, '/');
  struct stat own, other;
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
  bool is_met = stat(folder, &own) == 0 && stat(given->output, &other) == 0 && own.st_dev == other.st_dev &&
                own.st_ino == other.st_ino && will_be_replaced(given, slash ? slash + 1 : path);
  DIR *list = !is_met && stat(path, &own) == 0 && S_ISREG(own.st_mode) ? opendir(given->output) : NULL;
  for (struct dirent *entry; list && !is_met && (entry = readdir(list));) {
    snprintf(inside, sizeof inside, "%s/%s", given->output, entry->d_name);
    is_met = will_be_replaced(given, entry->d_name) && stat(inside, &other) == 0 &&
             own.st_dev == other.st_dev && own.st_ino == other.st_ino;
  }
  if (list)
    closedir(list);
  return is_met ? cli_usage(cli, "a file in %s would overwrite %s, which is %s", given->output, path, what)
                : CLI_END;
}

int augment_check_folder(cli_run *cli, const augment_request *given) {
  if (strlen(given->output) > PATH_SIZE - 64)
    return cli_usage(cli, "the name of the folder is too long");
  if (check_name(cli, given, given->input, "read") == CLI_STOP ||
      (given->rotations && check_name(cli, given, given->rotations, "read") == CLI_STOP))
    return CLI_STOP;
  return cli->report ? check_name(cli, given, cli->report, "written by --report") : CLI_END;
}

/* ---- A former run ---- */

int augment_check_former(cli_run *cli, const augment_request *given) {
  char found[NAME_MAX + 1] = "";
  DIR *list = given->force ? NULL : opendir(given->output);
  for (struct dirent *entry; list && (entry = readdir(list));)
    if (is_wanted(given, number_of_any(entry->d_name)) && (!found[0] || strcmp(entry->d_name, found) < 0))
      snprintf(found, sizeof found, "%s", entry->d_name);
  if (list)
    closedir(list);
  return found[0] ? cli_usage(cli,
                              "%s has variants of a former run (%s); give another -o, or --force to replace "
                              "them",
                              given->output, found)
                  : CLI_END;
}

/** Removes variants of a longer former run, or in another format, which would pass for some of this one.
 * Called once all of this run are there, so that nothing is lost if it fails. */
static void remove_former(const augment_request *given) {
  char path[PATH_SIZE + NAME_MAX];
  DIR *list = opendir(given->output);
  for (struct dirent *entry; list && (entry = readdir(list));)
    if (number_of_any(entry->d_name) >= given->first &&
        !is_wanted(given, number_of(entry->d_name, given->format))) {
      snprintf(path, sizeof path, "%s/%s", given->output, entry->d_name);
      unlink(path);
    }
  if (list)
    closedir(list);
}

/* ---- Work ---- */

/** Notes which of the next files replace others; false without memory. */
static bool note_present(augment_folder *f, const augment_request *given, size_t count) {
  char path[PATH_SIZE];
  unsigned char *grown = realloc(f->was_there, (size_t)f->made + count);
  if (!grown)
    return false;
  f->was_there = grown;
  for (size_t i = 0; i < count; i++) {
    name_file(path, given, f->made + (int64_t)i, "");
    grown[(size_t)f->made + i] = !f->is_new && access(path, F_OK) == 0;
  }
  return true;
}

/** The first files say what the others will take. */
static int check_room(cli_run *cli, const augment_folder *f, const augment_request *given) {
  struct statvfs disk;
  char needed[24], room[24];
  /* What is replaced makes room. */
  if (f->made != CHUNK || f->replaced > 0 || statvfs(given->output, &disk) != 0 || disk.f_blocks == 0)
    return CLI_DONE;
  double block = (double)disk.f_frsize, each = 0;
  for (int64_t i = 0; i < f->made; i++) /* in whole blocks, as they lie on the disk */
    each += block * (double)((f->sizes[i] + disk.f_frsize - 1) / disk.f_frsize) / (double)f->made;
  double wanted = each * (double)(given->count - f->made);
  double available = block * (double)(geteuid() == 0 ? disk.f_bfree : disk.f_bavail);
  if (wanted <= available)
    return CLI_DONE;
  return cli_fail_text(cli,
                       "%s: cannot write: the other %" PRId64 " files need about %s, and %s are free on "
                       "its disk",
                       given->output, given->count - f->made,
                       cli_bytes_text(needed, (uint64_t)(wanted < 1e19 ? wanted : 1e19)),
                       cli_bytes_text(room, (uint64_t)available));
}

static int write_files(cli_run *cli, augment_folder *f, const augment_request *given, vxm_sampler *sampler,
                       char *names, size_t count) {
  vxm_variant variants[CHUNK];
  const char *paths[CHUNK];
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  options.format = given->format;
  if (!note_present(f, given, count))
    return cli_fail_text(cli, "out of memory");
  for (size_t i = 0; i < count; i++) {
    variants[i] = given->variant;
    variants[i].index = (uint32_t)(given->first + f->made + (int64_t)i);
    name_file(names + i * PATH_SIZE, given, f->made + (int64_t)i, "");
    paths[i] = names + i * PATH_SIZE;
  }
  vxm_status status =
      given->sampler.coverage > 0
          ? augment_write_numbers(cli, paths, sampler, variants, count, given->format, f->written)
          : vxm_sampler_files(paths, sampler, variants, count, &options, f->written, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  for (size_t i = 0; i < count; i++) {
    struct stat info;
    f->written[i] = false; /* but counted */
    f->sizes[i] = stat(paths[i], &info) == 0 ? (uint64_t)info.st_size : 0;
    f->bytes += f->sizes[i];
    f->replaced += f->was_there[(size_t)f->made + i];
  }
  f->made += (int64_t)count;
  return check_room(cli, f, given);
}

static int write_chunks(cli_run *cli, augment_folder *f, const augment_request *given, vxm_sampler *sampler,
                        char *names) {
  while (f->made < given->count) {
    if (cli_progress(cli, "augmenting",
                     ((double)given->model_at + (double)f->made / (double)given->count) /
                         (double)given->model_of)) {
      cli->error.code = VXM_ERROR_CANCELLED;
      return cli_fail(cli);
    }
    int64_t left = given->count - f->made;
    if (write_files(cli, f, given, sampler, names, left < CHUNK ? (size_t)left : CHUNK) != CLI_DONE)
      return CLI_FAILED;
  }
  return CLI_DONE;
}

int augment_write_folder(cli_run *cli, augment_folder *f, const augment_request *given,
                         vxm_sampler *sampler) {
  char *names = malloc((size_t)CHUNK * PATH_SIZE);
  if (!names)
    return cli_fail_text(cli, "out of memory");
  vxm_context_drop_files(cli->context); /* there are too many files to hold all of them */
  f->is_new = mkdir(given->output, 0777) == 0;
  int status = CLI_DONE;
  if (!f->is_new && errno != EEXIST)
    status = cli_fail_text(cli, "%s: cannot make the folder: %s", given->output, strerror(errno));
  else {
    status = write_chunks(cli, f, given, sampler, names);
    if (status == CLI_DONE && given->force && !f->is_new)
      remove_former(given);
  }
  free(names);
  return status;
}

void augment_remove_files(const augment_folder *f, const augment_request *given) {
  char path[PATH_SIZE];
  for (int64_t i = 0; f->was_there && i < f->made + CHUNK; i++) {
    if ((i >= f->made && !f->written[i - f->made]) || f->was_there[i])
      continue;
    name_file(path, given, i, "");
    unlink(path);
    name_file(path, given, i, ".json");
    if (has_json(given->format))
      unlink(path);
  }
  if (f->is_new)
    rmdir(given->output);
}
