/* SPDX-License-Identifier: BSD-3-Clause */
/** Reading the command line: one table per command serves getopt, the help text and the reading. */
#include "cli/cli.h"

#include <getopt.h>
#include <stdarg.h>
#include <string.h>

static cli_reader show_help, take_report, take_progress;

static const cli_option common_options[] = {
    {0, "json", NULL, "print the report as JSON on standard output instead of the summary",
     CLI_RUN_VALUE(cli_take_flag, json)},
    {0, "report", "FILE.json", "write the report as JSON into a file too",
     CLI_RUN_VALUE(take_report, report)},
    {0, "threads", "N", "threads to work with, 1 to 256 [one per processor]",
     CLI_RUN_VALUE(cli_take_number, limits.threads, .min = 1, .max = 256)},
    {0, "memlimit", "SIZE",
     "fail rather than hold more memory than this, in bytes\nor with a binary suffix: 512M, 4G [what the "
     "machine has]",
     CLI_RUN_VALUE(cli_take_size, limits.memory_limit)},
    {'q', "quiet", NULL, "print neither the summary nor warnings", CLI_RUN_VALUE(cli_take_flag, quiet)},
    {'v', "verbose", NULL, "print more: tags, passes that changed nothing, threads and memory",
     CLI_RUN_VALUE(cli_take_flag, verbose)},
    {0, "progress", "WHEN", "auto (where standard error is a terminal), always or never [auto]",
     CLI_RUN_VALUE(take_progress, progress)},
    {0, "strict", NULL, "exit with status 3 if there were warnings", CLI_RUN_VALUE(cli_take_flag, strict)},
    {'h', "help", NULL, "show this help", {.read = show_help, .is_of_run = true}},
    CLI_OPTIONS_END};

const char *const cli_mesh_formats[] = {"off", "obj", "stl", "ply", NULL};

cli_formats cli_formats_with(unsigned traits) {
  cli_formats found = {{NULL}};
  int count = 0;
  for (int64_t i = 0; *vxm_grid_format_name(i) && count + 1 < CLI_FORMATS_MAX; i++)
    if (vxm_grid_format_traits(vxm_grid_format_name(i)) & traits)
      found.name[count++] = vxm_grid_format_name(i);
  return found;
}

cli_formats cli_formats_without(cli_formats formats, const char *name) {
  int kept = 0;
  for (int f = 0; formats.name[f]; f++)
    if (strcmp(formats.name[f], name) != 0)
      formats.name[kept++] = formats.name[f];
  formats.name[kept] = NULL;
  return formats;
}

/* ---- Help ---- */

enum { HELP_COLUMN = 30 };

static void print_option(const cli_option *option) {
  char text[96];
  char letter[8] = "    ";
  if (option->letter)
    snprintf(letter, sizeof letter, "-%c, ", option->letter);
  int used = snprintf(text, sizeof text, "  %s--%s%s%s", letter, option->name, option->argument ? " " : "",
                      option->argument ? option->argument : "");
  if (used < HELP_COLUMN)
    printf("%-*s", HELP_COLUMN, text);
  else
    printf("%s\n%*s", text, HELP_COLUMN, "");
  for (const char *c = option->help; *c; c++) {
    putchar(*c);
    if (*c == '\n')
      printf("%*s", HELP_COLUMN, "");
  }
  putchar('\n');
}

/** Whether a command has an option of its own by the name of a common one, which it replaces. */
static bool is_replaced(const cli_command *command, const cli_option *common) {
  for (const cli_option *option = command->options; option->name; option++)
    if (strcmp(option->name, common->name) == 0)
      return true;
  return false;
}

bool cli_is_refused(const cli_command *command, const char *name) {
  return command->others_refused && cli_read_choice(name, command->others_refused) >= 0;
}

void cli_help(const cli_command *command) {
  if (command->print_help) {
    command->print_help();
    return;
  }
  printf("Usage: voxmend %s %s\n%s\n", command->name, command->arguments, command->summary);
  if (command->options[0].name)
    printf("\nOptions:\n");
  for (const cli_option *option = command->options; option->name; option++)
    print_option(option);
  printf("\nCommon options:\n");
  for (const cli_option *option = common_options; option->name; option++)
    if (!is_replaced(command, option))
      print_option(option);
  if (command->others)
    printf("  ... and the options of 'voxmend %s', but those that name a file of one mesh\n",
           command->others_of);
  if (command->print_choices)
    command->print_choices();
  printf("\n%s\n\nExit status: 0 done; 1 failed, and no output file is left; 2 wrong usage;\n"
         "3 done with warnings, and only with --strict.\n",
         command->notes);
}

/** The first line of the help, which is enough for a list. */
static void print_row(const cli_option *option) {
  char letter[3] = "";
  if (option->letter)
    snprintf(letter, sizeof letter, "-%c", option->letter);
  printf("--%s\t%s\t%s\t%.*s\n", option->name, letter, option->argument ? option->argument : "",
         (int)strcspn(option->help, "\n"), option->help);
}

void cli_help_table(const cli_command *command, bool is_all) {
  if (command->print_help)
    return;
  for (const cli_option *option = command->options; option->name; option++)
    print_row(option);
  for (const cli_option *option = is_all ? command->others : NULL; option && option->name; option++)
    if (!is_replaced(command, option) && !cli_is_refused(command, option->name))
      print_row(option);
  for (const cli_option *option = common_options; option->name; option++)
    if (!is_replaced(command, option))
      print_row(option);
}

/* ---- Options ---- */

enum { WITHOUT_LETTER = 256 /**< and the number of the option stand for it to getopt */ };

static const cli_option *known_options[CLI_OPTIONS_MAX];
static struct option long_options[CLI_OPTIONS_MAX + 1];
static char letters[2 * CLI_OPTIONS_MAX + 2];

static void add_option(const cli_option *option, size_t *count, size_t *used) {
  if (*count >= CLI_OPTIONS_MAX)
    return;
  int takes = option->argument ? required_argument : no_argument;
  int key = option->letter ? option->letter : WITHOUT_LETTER + (int)*count;
  known_options[*count] = option;
  long_options[(*count)++] = (struct option){option->name, takes, NULL, key};
  if (!option->letter)
    return;
  letters[(*used)++] = option->letter;
  if (option->argument)
    letters[(*used)++] = ':';
}

static void build_tables(cli_run *cli) {
  size_t count = 0, used = 0;
  letters[used++] = ':'; /* tells a missing argument from an unknown option */
  for (const cli_option *option = cli->command->options; option->name; option++)
    add_option(option, &count, &used);
  for (const cli_option *option = cli->command->others; option && option->name; option++)
    if (!is_replaced(cli->command, option))
      add_option(option, &count, &used);
  for (const cli_option *option = common_options; option->name; option++)
    if (!is_replaced(cli->command, option))
      add_option(option, &count, &used);
  long_options[count] = (struct option){NULL, 0, NULL, 0};
  letters[used] = '\0';
  opterr = 0;
  optind = 0; /* begins anew: another command may have been read before */
}

int cli_usage(cli_run *cli, const char *format, ...) {
  fprintf(stderr, "voxmend: ");
  va_list arguments;
  va_start(arguments, format);
  cli_put_line(stderr, format, arguments);
  va_end(arguments);
  if (cli->command)
    fprintf(stderr, " (see 'voxmend %s --help')\n", cli->command->name);
  else
    fprintf(stderr, " (see 'voxmend --help')\n");
  cli->status = CLI_WRONG_USAGE;
  return CLI_STOP;
}

/** The option that a key stands for, which is one of them. */
static const cli_option *option_of(int key) {
  int i = 0;
  while (long_options[i].val != key)
    i++;
  return known_options[i];
}

/** Suggests options that are spelt like an unknown one; "" if there are none. */
static const char *suggest_option(char text[CLI_LIST_MAX], const char *word) {
  const char *names[CLI_OPTIONS_MAX + 1];
  char typed[64];
  int count = 0;
  for (; long_options[count].name; count++)
    names[count] = long_options[count].name;
  names[count] = NULL;
  snprintf(typed, sizeof typed, "%.*s", (int)strcspn(word + 2, "="), word + 2);
  return cli_suggestion(text, typed, "--", names);
}

/** What getopt refused; `word` is the argument that it was looking at. */
static int refuse(cli_run *cli, int result, const char *word) {
  char hint[CLI_LIST_MAX];
  if (result == ':')
    return cli_usage(cli, "option --%s needs a value", option_of(optopt)->name);
  if (optopt >= WITHOUT_LETTER || (optopt && word[0] == '-' && word[1] == '-'))
    return cli_usage(cli, "option --%s takes no value", option_of(optopt)->name);
  if (optopt)
    return cli_usage(cli, "unknown option -%c", optopt);
  return cli_usage(cli, "unknown option %s%s", word, suggest_option(hint, word));
}

static int show_help(cli_run *cli, const cli_option *option, const char *value, void *member) {
  (void)option, (void)value, (void)member;
  cli_help(cli->command);
  cli->status = CLI_DONE;
  return CLI_STOP;
}

static int take_report(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (strcmp(value, "-") == 0)
    return cli_usage(cli, "--report names a file; --json prints the report on standard output");
  return cli_take_text(cli, option, value, member);
}

static int take_progress(cli_run *cli, const cli_option *option, const char *value, void *member) {
  static const char *const when[] = {"auto", "always", "never", NULL};
  int choice;
  cli_take_text(cli, option, value, member);
  return cli_choose(cli, &choice, option->name, value, when);
}

/** Puts an option behind all others that were given. */
static void note_given(cli_run *cli, const cli_option *option) {
  int kept = 0;
  for (int g = 0; g < cli->given_count; g++)
    if (cli->given[g] != option)
      cli->given[kept++] = cli->given[g];
  cli->given[kept++] = option;
  cli->given_count = kept;
}

const char *cli_last_given(const cli_run *cli, const char *const *names) {
  for (int g = cli->given_count - 1; g >= 0; g--)
    if (cli_read_choice(cli->given[g]->name, names) >= 0)
      return cli->given[g]->name;
  return NULL;
}

bool cli_is_given(const cli_run *cli, const char *name) {
  return cli_last_given(cli, (const char *const[]){name, NULL}) != NULL;
}

int cli_take_option(cli_run *cli, const cli_option *option, const char *value, void *request) {
  return option->to.read ? option->to.read(cli, option, value, (char *)request + option->to.at) : CLI_END;
}

int cli_next_option(cli_run *cli, const cli_option **option, const char **value) {
  if (!cli->is_reading)
    build_tables(cli);
  cli->is_reading = true;
  for (;;) {
    int index = optind > 0 ? optind : 1;
    int result = getopt_long(cli->argc, cli->argv, letters, long_options, NULL);
    if (result == -1)
      break;
    if (result == '?' || result == ':')
      return refuse(cli, result, cli->argv[optind > index ? optind - 1 : index]);
    *option = option_of(result);
    *value = optarg;
    if (!(*option)->to.is_of_run) {
      note_given(cli, *option);
      return CLI_END;
    }
    if (cli_take_option(cli, *option, *value, cli) == CLI_STOP)
      return CLI_STOP;
  }
  *option = NULL;
  cli->arguments = cli->argv + optind;
  cli->argument_count = cli->argc - optind;
  return CLI_END;
}

int cli_read_options(cli_run *cli, void *request) {
  const cli_option *option;
  const char *value;
  while (cli_next_option(cli, &option, &value) == CLI_END)
    if (!option)
      return CLI_END;
    else if (cli_take_option(cli, option, value, request) == CLI_STOP)
      return CLI_STOP;
  return CLI_STOP;
}

bool cli_start(cli_run *cli) {
  cli_progress_init(cli);
  if (!cli_check_output_folders(cli))
    return false;
  if (vxm_context_create(&cli->context, &cli->limits, &cli->error) == VXM_OK &&
      vxm_context_hold_files(cli->context, &cli->error) == VXM_OK)
    return !cli->report || cli_try_file(cli, cli->report);
  cli_fail(cli);
  return false;
}

/* ---- Names of formats ---- */

/** Part of a name behind the last '.', or "", or the extension of a grid format, which may have two parts, or
 * a slash behind it. */
static const char *extension_of(const char *path) {
  const char *grid = vxm_grid_format_of(path);
  if (*grid)
    return grid;
  const char *slash = strrchr(path, '/');
  const char *dot = strrchr(slash ? slash + 1 : path, '.');
  return dot ? dot + 1 : "";
}

static bool equal_nocase(const char *a, const char *b) {
  while (*a && (*a | 0x20) == (*b | 0x20)) {
    a++;
    b++;
  }
  return !*a && !*b;
}

bool cli_has_json(const char *format, bool may_be_labels) {
  unsigned traits = vxm_grid_format_traits(format);
  return (traits & VXM_FORMAT_JSON) || (may_be_labels && (traits & VXM_FORMAT_LABELS_JSON));
}

bool cli_is_extension(const char *path, const char *extension) {
  return equal_nocase(extension_of(path), extension);
}

static const char *find_format(const char *name, const char *const *known) {
  for (; *known; known++)
    if (equal_nocase(name, *known))
      return *known;
  return NULL;
}

/** Whether the name tells a format, be it one of grids or of meshes. */
static bool tells_format(const char *path) {
  return *vxm_grid_format_of(path) || find_format(extension_of(path), cli_mesh_formats);
}

/** Lists those of the formats that go to standard output, too: no folders, and no file for each slice. */
static void list_streams(char list[CLI_LIST_MAX], const char *const *known) {
  const char *streams[CLI_FORMATS_MAX];
  size_t count = 0;
  for (; *known && count + 1 < CLI_FORMATS_MAX; known++)
    if (strcmp(*known, "zarr") != 0 && strcmp(*known, "png") != 0)
      streams[count++] = *known;
  streams[count] = NULL;
  cli_list(list, streams);
}

const char *cli_output_format(cli_run *cli, const char *path, const char *format, const char *const *known) {
  char list[CLI_LIST_MAX];
  if (!path) {
    cli_usage(cli, "-o FILE is missing");
    return NULL;
  }
  if (strcmp(path, "-") == 0)
    list_streams(list, known);
  else
    cli_list(list, known);
  const char *found = find_format(format ? format : extension_of(path), known);
  if (!found && format)
    cli_usage(cli, "--format '%s' is none of %s", format, list);
  else if (!found && strcmp(path, "-") == 0)
    cli_usage(cli, "-o - needs --format: %s", list);
  else if (!found && tells_format(path))
    cli_usage(cli, "-o '%s': what is asked for does not go into .%s; choose one of %s", path,
              extension_of(path), list);
  else if (!found && *extension_of(path))
    cli_usage(cli, "-o '%s': .%s is not written; choose one of %s, or give --format", path,
              extension_of(path), list);
  else if (!found)
    cli_usage(cli, "the name '%s' does not tell the format; give --format: %s", path, list);
  if (found && strcmp(found, "png") == 0 && !strchr(path, '%')) {
    cli_usage(cli, "-o '%s': .png is a picture for each slice, whose name needs a number: slice_%%04d.png",
              path);
    return NULL;
  }
  if (!found || strcmp(path, "-") != 0)
    return found;
  if (cli->json) {
    cli_usage(cli, "-o - and --json both want standard output; use --report FILE.json");
    return NULL;
  }
  cli->text = stderr;
  return found;
}
