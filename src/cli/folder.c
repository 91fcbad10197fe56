/* SPDX-License-Identifier: BSD-3-Clause */
/** A folder given in place of a file: what is in it, and what to give instead. */
#include "cli/cli.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KNOWN_MAX = 128, WORDS_SIZE = 1024, NAME_SIZE = 256 };

/** Extensions of meshes and grids, also of those that need a module. */
typedef struct extensions {
  const char *name[KNOWN_MAX];
  int count;
  char words[WORDS_SIZE]; /**< those that are words of a text */
} extensions;

typedef struct content {
  extensions known;
  int64_t files[KNOWN_MAX], others, folders;
  char example[NAME_SIZE]; /**< the first file, by name, of the kind that most are of */
} content;

const char **cli_mesh_extensions(void) {
  enum { MOST = 64 };
  vxm_reading_info readers = VXM_READING_INFO_INIT;
  const char **list = calloc(MOST + 1, sizeof *list);
  char own[CLI_LIST_MAX], *text = NULL;
  vxm_reading_find(&readers, NULL);
  if (!list ||
      asprintf(&text, "%s %s %s", cli_list(own, cli_mesh_formats),
               readers.assimp ? readers.assimp_formats : "", readers.occt ? readers.occt_formats : "") < 0) {
    free(list);
    return NULL;
  }
  int count = 0;
  char *rest = text;
  for (char *word; count < MOST && (word = strsep(&rest, ", "));)
    if (*word)
      list[count++] = word;
  return list;
}

void cli_mesh_extensions_free(const char **list) {
  if (list)
    free((char *)(uintptr_t)list[0]); /* all of them are words of one text */
  free(list);
}

static bool is_folder(const char *path) {
  struct stat info;
  return strcmp(path, "-") != 0 && stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static void add_known(extensions *known, const char *name) {
  for (int k = 0; k < known->count; k++)
    if (strcmp(known->name[k], name) == 0)
      return;
  if (known->count < KNOWN_MAX)
    known->name[known->count++] = name;
}

static void find_known(extensions *known) {
  vxm_reading_info readers = VXM_READING_INFO_INIT;
  vxm_reading_find(&readers, NULL);
  for (int i = 0; cli_mesh_formats[i]; i++)
    add_known(known, cli_mesh_formats[i]);
  snprintf(known->words, sizeof known->words, "%s %s", readers.assimp_formats, readers.occt_formats);
  char *rest = known->words;
  for (char *word; (word = strsep(&rest, " "));)
    if (*word)
      add_known(known, word);
  cli_formats grids = cli_formats_with(VXM_FORMAT_READ);
  for (int i = 0; grids.name[i]; i++)
    if (strcmp(grids.name[i], "png") != 0) /* pictures of any kind */
      add_known(known, grids.name[i]);
}

/** The longest that fits: "scan.nii.gz" is no other .gz. */
static int kind_of(const extensions *known, const char *name) {
  int best = -1;
  size_t length = strlen(name), longest = 0;
  for (int k = 0; k < known->count; k++) {
    size_t own = strlen(known->name[k]);
    if (own > longest && length > own + 1 && name[length - own - 1] == '.' &&
        strcasecmp(name + length - own, known->name[k]) == 0) {
      best = k;
      longest = own;
    }
  }
  return best;
}

/** A folder that is one grid: a Zarr array, whatever its name, or what its reader says more of. */
static bool is_grid(const char *path) {
  static const char *const marks[] = {".zarray", ".zgroup", "zarr.json"};
  char inner[4096];
  for (int m = 0; m < 3; m++) {
    int length = snprintf(inner, sizeof inner, "%s/%s", path, marks[m]);
    if (length > 0 && length < (int)sizeof inner && access(inner, F_OK) == 0)
      return true;
  }
  return false;
}

static int commonest(const content *found) {
  int best = 0;
  for (int k = 1; k < found->known.count; k++)
    if (found->files[k] > found->files[best])
      best = k;
  return found->files[best] > 0 ? best : -1;
}

static void count(content *out, const char *folder, const struct dirent *entry) {
  char path[4096];
  if (entry->d_name[0] == '.')
    return;
  int length = snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
  int kind = kind_of(&out->known, entry->d_name);
  if (length > 0 && length < (int)sizeof path && is_folder(path) && !(kind >= 0 && is_grid(path)))
    out->folders++;
  else if (kind >= 0)
    out->files[kind]++;
  else
    out->others++;
}

static void find_example(content *out, struct dirent **entries, int number) {
  int kind = commonest(out);
  for (int i = 0; i < number && kind >= 0 && !out->example[0]; i++)
    if (entries[i]->d_name[0] != '.' && kind_of(&out->known, entries[i]->d_name) == kind)
      snprintf(out->example, sizeof out->example, "%s", entries[i]->d_name);
}

/** False if it cannot be looked into. */
static bool look_into(content *out, const char *folder) {
  struct dirent **entries;
  int number = scandir(folder, &entries, NULL, alphasort);
  *out = (content){.others = 0};
  find_known(&out->known);
  for (int i = 0; i < number; i++)
    count(out, folder, entries[i]);
  find_example(out, entries, number < 0 ? 0 : number);
  for (int i = 0; i < number; i++)
    free(entries[i]);
  if (number >= 0)
    free(entries);
  return number >= 0;
}

static void add(char text[CLI_LIST_MAX], int64_t number, const char *one, const char *many) {
  size_t used = strlen(text);
  if (number > 0)
    snprintf(text + used, CLI_LIST_MAX - used, "%s%lld %s", used > 0 ? ", " : "", (long long)number,
             number == 1 ? one : many);
}

/** "3 .off, 1 .stl, 2 other files, 1 folder" */
static void describe(char text[CLI_LIST_MAX], const content *found) {
  char name[16];
  text[0] = '\0';
  for (int k = 0; k < found->known.count; k++) {
    snprintf(name, sizeof name, ".%s", found->known.name[k]);
    add(text, found->files[k], name, name);
  }
  bool any = text[0] != '\0';
  add(text, found->others, any ? "other file" : "file of no known name",
      any ? "other files" : "files of no known name");
  add(text, found->folders, "folder", "folders");
}

static int refuse(cli_run *cli, const char *path) {
  content found;
  char text[CLI_LIST_MAX];
  size_t length = strlen(path);
  const char *slash = length > 0 && path[length - 1] == '/' ? "" : "/";
  if (!look_into(&found, path))
    return cli_usage(cli, "%s is a folder", path);
  int kind = commonest(&found);
  describe(text, &found);
  if (kind < 0)
    return cli_usage(cli, "%s is a folder with %s; a file is expected", path,
                     text[0] ? text : "nothing in it");
  /* as the example has it, also in capitals and with two dots */
  const char *extension = found.example + strlen(found.example) - strlen(found.known.name[kind]) - 1;
  if (cli->command->many)
    return cli_usage(cli, "%s is a folder with %s; 'voxmend %s %s%s*%s' takes all of a kind", path, text,
                     cli->command->name, path, slash, extension);
  if (cli_find_command("batch"))
    return cli_usage(cli,
                     "%s is a folder with %s; give one file, such as %s%s%s, or see 'voxmend help batch'",
                     path, text, path, slash, found.example);
  return cli_usage(cli, "%s is a folder with %s; give one file, such as %s%s%s", path, text, path, slash,
                   found.example);
}

int cli_check_folders(cli_run *cli) {
  if (cli->command->folders || (cli->command->many && cli->argument_count > 1))
    return CLI_END;
  for (int i = 0; i < cli->argument_count; i++)
    if (is_folder(cli->arguments[i]) && !is_grid(cli->arguments[i]))
      return refuse(cli, cli->arguments[i]);
  return CLI_END;
}
