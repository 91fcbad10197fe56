/* SPDX-License-Identifier: BSD-3-Clause */
/** Which files a run reads and writes: none of those written may be one of the others. */
#include "cli/cli.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- Whether two names are of one file ---- */

/** The folder that a file is in, with all links followed; NULL if there is none. To be freed. */
static char *folder_of(const char *path) {
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path + 1)) : strdup(".");
  char *real = folder ? realpath(folder, NULL) : NULL;
  free(folder);
  return real;
}

/** Folder and name put together; to be freed. */
static char *join(const char *folder, size_t length, const char *name) {
  size_t size = length + strlen(name) + 2;
  char *path = malloc(size);
  if (path)
    snprintf(path, size, "%.*s/%s", (int)length, folder, name);
  return path;
}

/** Where a link to nothing leads; NULL if it is no link. To be freed. */
static char *target_of(const char *path) {
  char target[4096];
  ssize_t length = readlink(path, target, sizeof target - 1);
  if (length <= 0)
    return NULL;
  target[length] = '\0';
  const char *slash = strrchr(path, '/');
  return target[0] == '/' || !slash ? strdup(target) : join(path, (size_t)(slash - path), target);
}

/** What a file that is not there yet will be; NULL if it cannot be. To be freed. */
static char *future_of(const char *path) {
  enum { LINKS_MAX = 40 };
  char *name = strdup(path), *target;
  for (int links = 0; name && links < LINKS_MAX && (target = target_of(name)); links++) {
    free(name);
    name = target;
  }
  char *folder = name ? folder_of(name) : NULL, *whole = NULL;
  if (folder) {
    const char *slash = strrchr(name, '/');
    whole = join(folder, strlen(folder), slash ? slash + 1 : name);
  }
  free(folder);
  free(name);
  return whole;
}

/** "-" is what standard input or output is; a terminal or a pipe is no file. */
static bool look_at(struct stat *info, const char *path, int standard) {
  return (strcmp(path, "-") == 0 ? fstat(standard, info) : stat(path, info)) == 0;
}

static bool is_same(const char *a, int a_standard, const char *b, int b_standard) {
  struct stat first, second;
  bool a_is_there = look_at(&first, a, a_standard), b_is_there = look_at(&second, b, b_standard);
  if (a_is_there && b_is_there)
    return S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
  if (a_is_there || b_is_there)
    return false;
  char *a_future = future_of(a), *b_future = future_of(b);
  bool same = a_future && b_future && strcmp(a_future, b_future) == 0;
  free(b_future);
  free(a_future);
  return same;
}

/* ---- What belongs to a file that is read ---- */

enum { PATH_SIZE = 4096 };

/** The name with something in place of its extension, or behind the whole; "" if that is too long. */
static const char *beside(char out[PATH_SIZE], const char *path, size_t kept, const char *behind) {
  int length = snprintf(out, PATH_SIZE, "%.*s%s", (int)kept, path, behind);
  if (length < 0 || length >= PATH_SIZE)
    out[0] = '\0';
  return out;
}

/** The JSON in a file; NULL if there is none, or more than can be looked through in passing. */
static json_t *load_json(const char *path) {
  const off_t most = 64 << 20;
  struct stat info;
  return stat(path, &info) == 0 && S_ISREG(info.st_mode) && info.st_size <= most
             ? json_load_file(path, 0, NULL)
             : NULL;
}

/** Whether a file is the description of a grid, and not a report, say, of the same name. */
static bool is_description(const char *path) {
  json_t *root = load_json(path);
  const char *format = json_string_value(json_object_get(root, "format"));
  bool is_one = format && strncmp(format, "voxmend ", strlen("voxmend ")) == 0;
  json_decref(root);
  return is_one;
}

/** A relative name out of a URI, where "%20" stands for a blank; what is no code stays, as does %00. It is
 * the name that the reader opens (vxm_uri_decode), which is not seen from here. */
static void decode(char *text) {
  char *to = text;
  for (const char *from = text; *from; from++, to++) {
    bool is_code = *from == '%' && isxdigit((unsigned char)from[1]) && isxdigit((unsigned char)from[2]) &&
                   strncmp(from, "%00", 3) != 0;
    *to = is_code ? (char)strtoul((const char[]){from[1], from[2], '\0'}, NULL, 16) : *from;
    from += is_code ? 2 : 0;
  }
  *to = '\0';
}

/** Whether a glTF file names the output as one of its buffers or pictures. */
static bool is_part_of_gltf(const char *path, const char *output, int standard) {
  static const char *const lists[] = {"buffers", "images"};
  json_t *root = load_json(path), *item;
  const char *slash = strrchr(path, '/');
  bool found = false;
  for (size_t l = 0, i; l < 2 && !found; l++)
    json_array_foreach(json_object_get(root, lists[l]), i, item) {
      char name[PATH_SIZE];
      const char *uri = json_string_value(json_object_get(item, "uri"));
      if (!uri || uri[0] == '/' || strncmp(uri, "data:", strlen("data:")) == 0)
        continue;
      int folder = slash ? (int)(slash - path + 1) : 0;
      int length = snprintf(name, sizeof name, "%.*s%s", folder, path, uri);
      if (length >= PATH_SIZE)
        continue;
      decode(name + folder);
      found |= length > 0 && is_same(name, 0, output, standard);
    }
  json_decref(root);
  return found;
}

/** Whether writing an output would overwrite a file that belongs to an input: a part of a glTF, an .mtl, the
 * .json beside a grid. */
static bool is_companion(const char *input, const char *output, int standard) {
  char name[PATH_SIZE];
  struct stat info;
  if (strcmp(input, "-") == 0 || !look_at(&info, output, standard) || !S_ISREG(info.st_mode))
    return false;
  if (cli_is_extension(input, "gltf") && is_part_of_gltf(input, output, standard))
    return true;
  if (cli_is_extension(input, "obj") &&
      is_same(beside(name, input, strlen(input) - strlen("obj"), "mtl"), 0, output, standard))
    return true;
  return is_same(beside(name, input, strlen(input), ".json"), 0, output, standard) && is_description(name);
}

/* ---- Checks ---- */

void cli_reads(cli_run *cli, const char *path) {
  if (path && cli->read_count < CLI_NAMES_MAX)
    cli->reads[cli->read_count++] = path;
}

void cli_writes(cli_run *cli, const char *option, const char *path, bool has_json) {
  if (path && cli->write_count < CLI_NAMES_MAX)
    cli->writes[cli->write_count++] = (cli_written){option, path, has_json};
}

/** CLI_STOP if `path`, the output or the .json beside it, is an input or belongs to one. */
static int check_input(cli_run *cli, const cli_written *output, const char *path, const char *input) {
  if (is_same(path, STDOUT_FILENO, input, STDIN_FILENO))
    return cli_usage(cli, "%s would overwrite %s, which is read", output->option,
                     cli_shown(input, "<stdin>"));
  if (is_companion(input, path, STDOUT_FILENO))
    return cli_usage(cli, "%s would overwrite %s, which belongs to %s", output->option,
                     cli_shown(path, "<stdout>"), input);
  return CLI_END;
}

static int check_inputs(cli_run *cli, const cli_written *output, const char *path) {
  for (int i = 0; i < cli->argument_count; i++)
    if (check_input(cli, output, path, cli->arguments[i]) == CLI_STOP)
      return CLI_STOP;
  for (int i = 0; i < cli->read_count; i++)
    if (check_input(cli, output, path, cli->reads[i]) == CLI_STOP)
      return CLI_STOP;
  return CLI_END;
}

/** The names under which an output is written: its own, and with `k` 1 that of the .json beside it. */
static const char *name_of(char out[PATH_SIZE], const cli_written *output, int k) {
  if (k == 0)
    return output->path;
  return output->has_json && strcmp(output->path, "-") != 0
             ? beside(out, output->path, strlen(output->path), ".json")
             : NULL;
}

static bool share_a_name(const cli_written *a, const cli_written *b) {
  char a_name[PATH_SIZE], b_name[PATH_SIZE];
  for (int k = 0; k < 4; k++) {
    const char *first = name_of(a_name, a, k / 2), *second = name_of(b_name, b, k % 2);
    if (first && second && is_same(first, STDOUT_FILENO, second, STDOUT_FILENO))
      return true;
  }
  return false;
}

/** Standard input can be read once only. */
static int check_standard_input(cli_run *cli) {
  int inputs = 0;
  for (int i = 0; i < cli->argument_count; i++)
    inputs += strcmp(cli->arguments[i], "-") == 0;
  for (int i = 0; i < cli->read_count; i++)
    inputs += strcmp(cli->reads[i], "-") == 0;
  return inputs > 1 ? cli_usage(cli, "standard input can be but one of the files that are read") : CLI_END;
}

int cli_check_names(cli_run *cli) {
  char name[PATH_SIZE];
  if (check_standard_input(cli) == CLI_STOP || cli_check_folders(cli) == CLI_STOP)
    return CLI_STOP;
  cli_writes(cli, "--report", cli->report, false);
  for (int i = 0; i < cli->write_count; i++) {
    const cli_written *output = &cli->writes[i];
    for (int k = 0; k < 2; k++) {
      const char *path = name_of(name, output, k);
      if (path && check_inputs(cli, output, path) == CLI_STOP)
        return CLI_STOP;
    }
    for (int j = 0; j < i; j++)
      if (share_a_name(output, &cli->writes[j]))
        return cli_usage(cli, "%s and %s name the same file", output->option, cli->writes[j].option);
  }
  return CLI_END;
}

/** The part of a name before the last '/', "/" or "."; to be freed. */
static char *folder_name(const char *path) {
  const char *slash = strrchr(path, '/');
  size_t length = slash ? (size_t)(slash - path) : 0;
  return slash ? strndup(path, length > 0 ? length : 1) : strdup(".");
}

bool cli_check_output_folders(cli_run *cli) {
  bool good = true;
  for (int i = 0; i < cli->write_count && good; i++) {
    const cli_written *output = &cli->writes[i];
    struct stat info;
    char *folder = strcmp(output->path, "-") == 0 ? NULL : folder_name(output->path);
    good = !folder || (stat(folder, &info) == 0 && S_ISDIR(info.st_mode));
    if (!good)
      cli_fail_text(cli, "%s '%s': there is no folder %s; make it first", output->option, output->path,
                    folder);
    free(folder);
  }
  return good;
}
