/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What the subcommands share: options, messages, tables, JSON and progress. The command line sees the library
 * through voxmend.h alone.
 */
#ifndef VXM_CLI_CLI_H
#define VXM_CLI_CLI_H

#include "cli/option_tables.h"
#include "voxmend.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>

/** Exit status, a contract with scripts. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_WRONG_USAGE = 2, CLI_WARNED = 3 };

#define CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))

/** What functions that read options and their values return. */
enum { CLI_END = 0, CLI_STOP = -1 };

typedef struct cli_run cli_run;
typedef struct cli_option cli_option;

/** Reads the value of an option into a member of the request; CLI_STOP after a line about wrong usage. */
typedef int cli_reader(cli_run *cli, const cli_option *option, const char *value, void *member);

/** Where the value of an option goes. */
typedef struct cli_target {
  cli_reader *read; /**< NULL = nowhere: cli_is_given says that the option was there */
  size_t at, size;  /**< of the member in the request of the command */
  bool is_of_run;   /**< or in cli_run */
  const char *const *choices;
  int64_t min, max; /**< of a number; min is what the first choice stands for, too */
  double low, high; /**< of a real number */
  const char *what; /**< of a real number: its meaning and range, for who gives another */
} cli_target;

/** A row of a command's table, which serves getopt, the help and the reading; option_tables.h has the macros
 * for the targets. */
struct cli_option {
  char letter;          /**< 0 = none */
  const char *name;     /**< long name; NULL ends a list */
  const char *argument; /**< what it takes, as shown in the help; NULL = nothing */
  const char *help;     /**< a line, or several separated by '\n' */
  cli_target to;
};

typedef struct cli_command {
  const char *name;
  const char *arguments; /**< shown behind the name in the usage line */
  const char *summary;   /**< one line */
  const char *notes;     /**< shown below the options: defaults and examples */
  const cli_option *options;
  const cli_option
      *others;           /**< those of another command that are taken too, but of names above; NULL = none */
  const char *others_of; /**< that command */
  const char *const *others_refused; /**< names of those of them that are not; NULL = none */
  bool many;                         /**< takes any number of files */
  void (*print_help)(void);          /**< for options of another kind; NULL = the help is made of the table */
  bool folders;                      /**< takes folders too; else cli_check_names refuses them */
  void (*print_choices)(void);       /**< prints lists for the help, shown before the notes; NULL = none */
  int (*run)(cli_run *cli);          /**< returns an exit status */
} cli_command;

extern const cli_command cli_command_info, cli_command_repair, cli_command_voxelize, cli_command_convert,
    cli_command_batch, cli_command_compare, cli_command_augment, cli_command_remesh, cli_command_view,
    cli_command_bench, cli_command_carve, cli_command_engines, cli_command_combine, cli_command_help,
    cli_command_binvox;

enum { CLI_COMMANDS_MAX = 24 };

/** All of them, in the order in which they are shown (main.c); NULL ends them. */
extern const cli_command *const cli_commands[CLI_COMMANDS_MAX + 1];

enum { CLI_OPTIONS_MAX = 96, CLI_LIST_MAX = 1024, CLI_NAMES_MAX = 8 };

/** A file that a run writes. */
typedef struct cli_written {
  const char *option, *path;
  bool has_json; /**< and "PATH.json" beside it */
} cli_written;

/** What a command has come to, for who runs it from within. */
typedef struct cli_capture {
  const char *format; /**< of meshes from standard input; NULL = by their content */
  json_t *report;     /**< in place of --json, to be released; NULL after a failure */
  json_t *companions; /**< array to which names of files are added that were read beside a mesh; or NULL */
  vxm_error error;    /**< code VXM_OK where its line was on standard error alone */
} cli_capture;

/** Runs a command by its name; the first of the words is that name. Its exit status. */
int cli_capture_command(const char *name, int count, char **words, cli_capture *capture);

/** What tells how large voxels are; advice in messages names it. */
typedef enum cli_sizing {
  CLI_SIZED_BY_RESOLUTION = 0, /**< -r, in commands that have it */
  CLI_SIZED_BY_VOXEL_SIZE,
  CLI_SIZED_BY_LIKE
} cli_sizing;

/** One run of the program. */
struct cli_run {
  const cli_command *command;
  int argc;
  char **argv;
  char **arguments; /**< what is left after the options */
  int argument_count;
  int status; /**< exit status once something has returned CLI_STOP */

  bool is_reading;                          /**< options, that is */
  const cli_option *given[CLI_OPTIONS_MAX]; /**< those of the command, in the order in which they came last */
  int given_count;
  bool json, quiet, verbose, strict;
  const char *report;
  const char *progress;
  vxm_context_options limits;
  vxm_mesh_read_options read;

  cli_sizing sized_by;

  vxm_context *context; /**< made by cli_start */
  vxm_error error;      /**< hand &cli->error to the library, then cli_fail */
  json_t *warnings;     /**< array of strings for the report */
  int64_t warning_count;
  FILE *text; /**< where the summary goes: stdout, or stderr while stdout carries the output */
  const char *reads[CLI_NAMES_MAX];  /**< beside the arguments, which are all read */
  cli_written writes[CLI_NAMES_MAX]; /**< the output first; --report is added in the end */
  int read_count, write_count;
  cli_capture *capture; /**< who takes the report; NULL = nobody */
  char phase[48];
  double drawn; /**< time at which progress was last drawn; 0 = none on the screen */
};

/* ---- options.c: reading the command line ---- */

/** Reads the options into the request, as the command's table says, and sets cli->arguments. CLI_STOP when
 * the program is to end with cli->status: help was shown, or the usage is wrong. */
int cli_read_options(cli_run *cli, void *request);
/** The same an option at a time, for cli_take_option; *option is NULL after the last. */
int cli_next_option(cli_run *cli, const cli_option **option, const char **value);
int cli_take_option(cli_run *cli, const cli_option *option, const char *value, void *request);
/** Whether an option of the command was given. */
bool cli_is_given(const cli_run *cli, const char *name);
/** Which of these was given last, or NULL; NULL ends the names. */
const char *cli_last_given(const cli_run *cli, const char *const *names);
/** Prints one line about wrong usage, sets cli->status and returns CLI_STOP. */
int cli_usage(cli_run *cli, const char *format, ...) CLI_PRINTF(2, 3);
void cli_help(const cli_command *command);
/** Whether a command refuses an option that it would take of another command. */
bool cli_is_refused(const cli_command *command, const char *name);
/** The options of a command for programs, a line each: "--name", letter, argument and purpose, with tabs
 * between. @param is_all with those of another command that it takes too
 */
void cli_help_table(const cli_command *command, bool is_all);
/**
 * Makes the context, which holds the files that are written until cli_finish, and tries the report, so that a
 * wrong name fails before the work; false after a failure that has been printed.
 */
bool cli_start(cli_run *cli);

/* ---- option_values.c ---- */

/* Readers of the tables: of one of the choices, a number from min to max, bytes, ... */
cli_reader cli_take_flag, cli_take_text, cli_take_choice, cli_take_number, cli_take_real, cli_take_size;
/** The choices of options that several commands have; NULL ends each list. */
extern const char *const cli_axes[], *const cli_external_files[], *const cli_polygon_kinds[];

/* Strict readings: the whole text must be the value, in the C locale; false if it is not. */
bool cli_read_integer(int64_t *out, const char *text, int64_t low, int64_t high);
bool cli_read_number(double *out, const char *text);
/** Exactly `count` numbers separated by commas. */
bool cli_read_numbers(double *out, int count, const char *text);
/** Bytes, with a binary suffix K, M, G or T. */
bool cli_read_size(uint64_t *out, const char *text);
/** Position of `text` in the list, which ends with NULL, or -1. */
int cli_read_choice(const char *text, const char *const *choices);
/** "x, y, z" */
const char *cli_list(char list[CLI_LIST_MAX], const char *const *choices);
/** The position of an option's value in the list; CLI_STOP, and a line that lists all, if it is none of them.
 */
int cli_choose(cli_run *cli, int *choice, const char *option, const char *value, const char *const *choices);

/**
 * Format that the output's name or --format asks for, out of `known`; NULL with cli->status set if there is
 * none. Sends the summary to stderr where the output goes to stdout.
 */
const char *cli_output_format(cli_run *cli, const char *path, const char *format, const char *const *known);
extern const char *const cli_mesh_formats[];
/** Formats of grids, and NULL. */
enum { CLI_FORMATS_MAX = 64 };
typedef struct cli_formats {
  const char *name[CLI_FORMATS_MAX];
} cli_formats;
/** Those with one of these traits (vxm_format_trait). */
cli_formats cli_formats_with(unsigned traits);
/** These but one. */
cli_formats cli_formats_without(cli_formats formats, const char *name);
/** Whether a file of this format has a .json beside it. */
bool cli_has_json(const char *format, bool may_be_labels);
/** Whether a file name ends in '.' and this extension, in any case. */
bool cli_is_extension(const char *path, const char *extension);
/** 'y' or 'z': the axis that points up in most files of a mesh's format, by its name. COLLADA says which, and
 * is turned to y where it is read. */
char cli_usual_up(const char *mesh);

/* ---- entry.c ---- */

/** The status; CLI_FAILED after a line where what was printed is lost when it is flushed, on a full disk for
 * one. */
int cli_flush_output(cli_run *cli, int status);
/** Runs a command as the whole program; returns its exit status, or ends by the signal that stopped it. */
int cli_run_command(const cli_command *command, int argc, char **argv);

/* ---- cmd_help.c: the commands ---- */

void cli_help_overview(void);
/** NULL if there is none of that name. */
const cli_command *cli_find_command(const char *name);
/** As cli_suggestion, for a command. */
const char *cli_suggest_command(char text[CLI_LIST_MAX], const char *typed);

/* ---- suggest.c ---- */

/**
 * "; did you mean --a or --b?", or "" where none of the names is like what was typed.
 *
 * @param before put before each name
 * @param names  NULL ends them
 */
const char *cli_suggestion(char text[CLI_LIST_MAX], const char *typed, const char *before,
                           const char *const *names);

/* ---- output.c: messages, tables and reports ---- */

/** Prints cli->error as one line and returns CLI_FAILED. */
int cli_fail(cli_run *cli);
/** As cli_fail, with a message of the program itself. */
int cli_fail_text(cli_run *cli, const char *format, ...) CLI_PRINTF(2, 3);
/** Notes a warning for the report and prints it unless --quiet. */
void cli_warn(cli_run *cli, const char *format, ...) CLI_PRINTF(2, 3);
/** The warnings from reading a file, and from repairing it, but for the first, which have been told. */
void cli_warn_mesh(cli_run *cli, const char *path, const vxm_mesh *mesh, int64_t told);
void cli_warn_grid(cli_run *cli, const char *path, const vxm_grid *grid);
/** Tells who runs the command which files were read beside a mesh. */
void cli_note_companions(cli_run *cli, const vxm_mesh *mesh);
/** A row of a summary, "label  text", to cli->text. */
void cli_row(const cli_run *cli, const char *label, const char *format, ...) CLI_PRINTF(3, 4);
/** A text of a stranger, such as the name of a file, to cli->text: without control codes, and as wide at
 * least. */
void cli_put_text(const cli_run *cli, const char *text, int width);
/** A line of a message or of a summary, without its end, likewise. */
void cli_put_line(FILE *to, const char *format, va_list arguments);
/** The rows about a voxel space. */
void cli_rows_space(const cli_run *cli, const vxm_space *space);
/** Whether the summary is wanted: neither --json nor --quiet. */
bool cli_summary(const cli_run *cli);
/** The name of a file in messages: "-" stands for `standard`. */
const char *cli_shown(const char *path, const char *standard);
/** Milliseconds since an arbitrary start. */
double cli_clock(void);

/** Once, before any JSON: notices where jansson lacks memory, which it seldom tells; cli_finish fails then.
 */
void cli_json_start(void);
/* JSON values that jansson would refuse: not UTF-8, not finite. */
json_t *cli_json_text(const char *text);
json_t *cli_json_number(double value);
json_t *cli_json_numbers(const double *values, int count);
/** {dims, origin, voxel_size} */
json_t *cli_json_space(const vxm_space *space);
/** 16 hexadecimal digits, as JSON has no 64-bit unsigned numbers. */
json_t *cli_json_hash(uint64_t hash);
/** Whether a file may be written there, before anything else is; false after a line. */
bool cli_try_file(cli_run *cli, const char *path);
/**
 * Names the files that were written: from here on they are there, all of them. Nothing but this replaces a
 * file. CLI_FAILED after a line; then all is as it was before.
 */
int cli_publish(cli_run *cli);
/** "1.5 GiB" */
const char *cli_bytes_text(char text[24], uint64_t bytes);
/** Prints the report with --json, writes it with --report, frees it, and publishes. Returns an exit status.
 */
int cli_finish(cli_run *cli, json_t *report);

/* ---- lattice.c ---- */

/** Warns of a grid that other programs will see in a slightly other place (.bt), or stretched (.schem,
 * .litematic, .vox). */
void cli_warn_lattice(cli_run *cli, const char *path, const char *format, const vxm_space *space);

/* ---- file_conflicts.c: which files are read and written ---- */

/* A file that is read beside the arguments, or written; NULL = none. All are told before cli_check_names. */
void cli_reads(cli_run *cli, const char *path);
void cli_writes(cli_run *cli, const char *option, const char *path, bool has_json);
/**
 * CLI_STOP if a file that is written is one that is read, by whatever name or link, or belongs to it, or if
 * two that are written are the same.
 */
int cli_check_names(cli_run *cli);
/** Whether there are the folders that outputs are to be in; false after a line. */
bool cli_check_output_folders(cli_run *cli);
/** CLI_STOP if an argument is a folder where the command takes files (folder.c); among many it is left alone.
 */
int cli_check_folders(cli_run *cli);
/** All extensions of meshes that this build reads, ended by NULL, which is what there is without memory, too.
 */
const char **cli_mesh_extensions(void);
void cli_mesh_extensions_free(const char **extensions);

/* ---- output_style.c ---- */

/** The one rule for what is there already: CLI_STOP if a mesh would be written in place of a file, which may
 * be the mesh that all else is made of, without --force. Grids, pictures and reports replace what was there.
 */
int cli_check_surface_file(cli_run *cli, const char *path, const char *format);
/** CLI_STOP if the format has no use for --blocks, --up, --polygons keep or --no-manifold. */
int cli_check_style(cli_run *cli, const vxm_grid_write_options *write);
/** All checks of a grid's -o, after cli_reads; finds the format, one of these. */
int cli_check_grid_output(cli_run *cli, const char *path, vxm_grid_write_options *write, cli_formats formats,
                          bool may_be_labels);
/** The same of --polygons keep alone. */
int cli_check_polygons(cli_run *cli, bool keep_polygons, const char *format);

/* ---- progress.c ---- */

/** Sets the context options up for progress on stderr and for cancelling by a signal. */
void cli_progress_init(cli_run *cli);
/** Reports progress to the user; true if a signal has asked to stop. */
bool cli_progress(cli_run *cli, const char *phase, double fraction);
/** Clears the progress line before something else is printed. */
void cli_progress_clear(cli_run *cli);
/** The signal that asked to stop, or 0. */
int cli_signal(void);
/** A failed run ends by this signal, which was caught elsewhere. */
void cli_set_signal(int number);

#endif
