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
#include <stdio.h>

/** Exit status, a contract with scripts. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_WRONG_USAGE = 2, CLI_WARNED = 3 };

#define CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))

/** Keys of options without a letter. The common options take the numbers below CLI_KEY_COMMAND. */
enum {
  CLI_KEY_COMMON = 256,
  CLI_KEY_THRESHOLD = 500,
  CLI_KEY_BELOW,
  CLI_KEY_ENGINE = 505,
  CLI_KEY_DEVICE,
  CLI_KEY_CL_METHOD,
  CLI_KEY_GL_METHOD,
  CLI_KEY_GL_AXIS,
  CLI_KEY_GL_DISPLACE,
  CLI_KEY_DEFLECTION,
  CLI_KEY_EXTERNAL,
  CLI_KEY_COMMAND
};

/** What cli_next_option returns beside an option's key, and functions that read arguments return. */
enum { CLI_END = 0, CLI_STOP = -1 };

typedef struct cli_option {
  int key;              /**< the option's letter, or a number from CLI_KEY_COMMAND on */
  const char *name;     /**< long name; NULL ends a list */
  const char *argument; /**< what it takes, as shown in the help; NULL = nothing */
  const char *help;     /**< a line, or several separated by '\n' */
} cli_option;

typedef struct cli_run cli_run;

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
  vxm_error error;    /**< code VXM_OK where its line was on standard error alone */
} cli_capture;

/** Runs a command by its name; the first of the words is that name. Its exit status. */
int cli_capture_command(const char *name, int count, char **words, cli_capture *capture);

/** One run of the program. */
struct cli_run {
  const cli_command *command;
  int argc;
  char **argv;
  char **arguments; /**< what is left after the options */
  int argument_count;
  int status; /**< exit status once something has returned CLI_STOP */

  bool is_reading; /**< options, that is */
  bool json, quiet, verbose, strict;
  const char *report;
  const char *progress;
  vxm_context_options limits;
  vxm_mesh_read_options read;

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

/**
 * Returns the key of the next option of the command, its argument in *value; CLI_END after the last, then
 * cli->arguments are set; CLI_STOP when the program is to end with cli->status (help shown, or wrong usage).
 */
int cli_next_option(cli_run *cli, const char **value);
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
/** Whether a file of this format has a .json beside it. */
bool cli_has_json(const char *format, bool may_be_labels);
/** Whether a file name ends in '.' and this extension, in any case. */
bool cli_is_extension(const char *path, const char *extension);

/* ---- making.c: what is made of a mesh, for voxelize and augment ---- */

/** The arguments of --mode and --surface: CLI_END or CLI_STOP. */
int cli_read_mode(cli_run *cli, vxm_voxelize_options *options, const char *value);
int cli_read_surface(cli_run *cli, vxm_voxelize_options *options, const char *value);
/** The argument of --voxel-size, "0.5" or "0.5,0.5,2": CLI_END or CLI_STOP. */
int cli_read_voxel_size(cli_run *cli, vxm_space_options *space, const char *value);
/** The argument of --thin: CLI_END or CLI_STOP. */
int cli_read_thin(cli_run *cli, vxm_voxelize_options *options, const char *value);
/** CLI_STOP if --surface, where it was given, does not go with the mode. */
int cli_check_surface(cli_run *cli, const vxm_voxelize_options *options, bool is_given);
/** CLI_STOP if --thin, where it was given, does not go with the mode. */
int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options, bool is_given);

/* ---- engine.c: who makes the voxels ---- */

/** The words for --cl-method and --gl-method, in the order of their enums; NULL ends each list. */
extern const char *const cli_cl_methods[], *const cli_gl_methods[];

typedef struct cli_engine {
  const char *name; /**< NULL = not given */
  vxm_engine_options options;
  bool is_cl_tuned;          /**< options of OpenCL were given */
  bool is_tuned, is_slicing; /**< options of OpenGL, and of its slices, were given */
  vxm_engine *engine;        /**< made by cli_engine_open; NULL = the CPU, as nothing was asked for */
} cli_engine;

#define CLI_ENGINE_INIT \
  { NULL, VXM_ENGINE_OPTIONS_INIT, false, false, false, NULL }

/** Takes the value of one of CLI_OPTIONS_ENGINE. */
int cli_engine_read(cli_run *cli, cli_engine *out, int key, const char *value);
/** CLI_STOP if the options contradict each other. */
int cli_engine_check(cli_run *cli, const cli_engine *engine);
/** Makes the engine, if one was named; a failure is in cli->error. */
vxm_status cli_engine_open(cli_run *cli, cli_engine *engine);
/** The row, and the object of the report; only where one was named. */
void cli_engine_summarize(const cli_run *cli, const cli_engine *engine);
json_t *cli_engine_json(const cli_engine *engine);
/** Warns of devices that failed while others went on. */
void cli_engine_warn(cli_run *cli, const cli_engine *engine);

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
/** The warnings from reading a file. */
void cli_warn_mesh(cli_run *cli, const char *path, const vxm_mesh *mesh);
void cli_warn_grid(cli_run *cli, const char *path, const vxm_grid *grid);
/** A row of a summary, "label  text", to cli->text. */
void cli_row(const cli_run *cli, const char *label, const char *format, ...) CLI_PRINTF(3, 4);
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

/** Warns of a grid in a .bt file that other programs will see in a slightly other place. */
void cli_warn_lattice(cli_run *cli, const char *path, const char *format, const vxm_space *space);

/* ---- names.c: which files are read and written ---- */

/* A file that is read beside the arguments, or written; NULL = none. All are told before cli_check_names. */
void cli_reads(cli_run *cli, const char *path);
void cli_writes(cli_run *cli, const char *option, const char *path, bool has_json);
/**
 * CLI_STOP if a file that is written is one that is read, by whatever name or link, or belongs to it, or if
 * two that are written are the same.
 */
int cli_check_names(cli_run *cli);
/** Whether there are the folders that outputs are to be in; false after a line. */
bool cli_check_places(cli_run *cli);
/** CLI_STOP if an argument is a folder where the command takes files (folder.c); among many it is left alone.
 */
int cli_check_folders(cli_run *cli);
/** All extensions of meshes that this build reads, ended by NULL, which is what there is without memory, too.
 */
const char **cli_mesh_extensions(void);
void cli_mesh_extensions_free(const char **extensions);
/** The one rule for what is there already: CLI_STOP if a mesh would be written in place of a file, which may
 * be the mesh that all else is made of. Grids, pictures and reports replace what was there. */
int cli_check_surface_file(cli_run *cli, const char *path, const char *format, bool is_forced);
/** How blocks and meshes stand: of vxm_grid_write_options. */
typedef struct cli_style {
  const char *blocks;
  int up;
} cli_style;
/** Takes over the argument of --up: CLI_END or CLI_STOP. */
int cli_read_up(cli_run *cli, cli_style *style, const char *value);
/** CLI_STOP if the format has no use for what was given. */
int cli_check_style(cli_run *cli, const cli_style *style, const char *format);
/** CLI_STOP if the format is not one of meshes that heed --polygons keep and --no-manifold. */
int cli_check_quads(cli_run *cli, bool keep_polygons, bool keep_contacts, const char *format);
/** Takes over the argument of --polygons: CLI_END or CLI_STOP. */
int cli_read_polygons(cli_run *cli, bool *keep, const char *value);
/* ---- values.c: bits and numbers in files ---- */

/** What a file holds: bits, or numbers; the other is NULL. */
typedef struct cli_values {
  vxm_grid *grid;
  vxm_field *field;
} cli_values;

/** The argument of --threshold or --below: CLI_END or CLI_STOP. */
int cli_threshold_read(cli_run *cli, vxm_threshold_options *out, int key, const char *value);
/** Whether one of them was given. */
bool cli_threshold_given(const vxm_threshold_options *threshold);
/** Reads either and tells the warnings; a failure is in cli->error. */
vxm_status cli_values_read(cli_run *cli, cli_values *out, const char *path);
void cli_values_free(cli_values *values);
const vxm_space *cli_values_space(const cli_values *values);
/**
 * Makes bits of numbers: by the threshold, or if none is given where nothing is lost by it. CLI_FAILED, and a
 * line that names the options, where something would be.
 *
 * @param why why they have to be bits, for that line
 */
int cli_values_to_bits(cli_run *cli, cli_values *values, const vxm_threshold_options *threshold,
                       const char *path, const char *why);
/** Reads set voxels, as cli_values_read and cli_values_to_bits do. CLI_FAILED, and said so, if not. */
int cli_bits_read(cli_run *cli, vxm_grid **out, const vxm_threshold_options *threshold, const char *path,
                  const char *why);
/** The same as an octree; *out is NULL before. */
int cli_sparse_read(cli_run *cli, vxm_sparse **out, const vxm_threshold_options *threshold, const char *path,
                    const char *why);
/** The row about voxels or numbers, and the keys of the report. */
void cli_values_row(const cli_run *cli, const cli_values *values);
void cli_values_json(json_t *report, const cli_values *values, bool has_hash);

/** "distance, float32 from -0.1 to 0.2" */
void cli_values_text(char text[128], const vxm_field *field);

/* ---- grid_info.c: what info tells of grids ---- */

/** Where it stands among several files. */
typedef struct cli_grid_row {
  int width;        /**< of the names */
  bool has_heading; /**< it is the first of the table */
  bool is_next;     /**< something was told before */
} cli_grid_row;

/** Whether a name is that of a grid file that can be read. */
bool cli_is_grid_name(const char *path);
/** Tells of a grid, in full or as a row of a table, and adds its object to `reports`. */
int cli_grid_info(cli_run *cli, json_t *reports, const char *path, const cli_grid_row *row, bool is_row);

/* ---- progress.c ---- */

/** Sets the context options up for progress on stderr and for cancelling by a signal. */
void cli_progress_init(cli_run *cli);
/** Reports progress to the user; true if a signal has asked to stop. */
bool cli_progress(cli_run *cli, const char *phase, double fraction);
/** Clears the progress line before something else is printed. */
void cli_progress_clear(cli_run *cli);
/** The signal that asked to stop, or 0. */
int cli_signal(void);

/* ---- census.c ---- */

/** A row for each count, with what it means where it is not zero. */
/** An area or volume, or that it is beyond the range of numbers. */
const char *cli_measure_text(char text[24], int digits, double value);
/** The same of a volume; "-" where nothing is enclosed that could have one. */
const char *cli_volume_text(char text[24], int digits, bool closed, double value);

enum { CLI_SENTENCE = 200 };

/** What has to be closed, as repair --level closed sees it. */
typedef struct cli_openings {
  bool known;
  int64_t sheets, holes;
} cli_openings;

/**
 * What is wrong with a mesh in a sentence, and which command mends it.
 *
 * @param intersections pairs of faces that cut through each other; -1 = not looked for
 */
const char *cli_verdict(char text[CLI_SENTENCE], const vxm_census *census, const cli_openings *openings,
                        int64_t intersections);
void cli_census_print(const cli_run *cli, const vxm_census *census);
/** A number of self-intersections, which is "at least" one where they were not counted to the end. */
const char *cli_intersections_text(char text[32], int64_t count);
/** Adds "self_intersections", and where they were not counted to the end "self_intersections_at_least": true;
 * nothing if they were not looked for (-1). */
void cli_intersections_json(json_t *object, int64_t count);
/** A row for self-intersections; nothing if they were not looked for (-1). */
void cli_census_print_intersections(const cli_run *cli, int64_t count);
/** Both in one table, "Original" and "Final". */
void cli_census_print_both(const cli_run *cli, const vxm_census *before, const vxm_census *after);
/** Adds the census's keys to an object. */
void cli_census_json(json_t *object, const vxm_census *census);

/* ---- repairing.c: the options and results of a repair, for repair, voxelize and view ---- */

/** A mesh that was read, and repaired unless that was not wanted. */
typedef struct cli_input {
  const char *path;
  char format[48];
  int64_t vertices, faces; /**< as read */
  vxm_mesh *mesh;
  vxm_mesh *as_read;        /**< with its colours, where these are read and the mesh is repaired; or NULL */
  vxm_repair_report repair; /**< no passes without repair */
  double read_ms, repair_ms;
} cli_input;

/** The argument of --weld: CLI_END or CLI_STOP. */
int cli_read_weld(cli_run *cli, vxm_repair_options *options, const char *value);
/** CLI_STOP if options about the repair were given with --no-repair. */
int cli_check_repair(cli_run *cli, bool no_repair, bool repair_options);
json_t *cli_passes_json(const vxm_repair_report *report);
/** Warns of parts that the repair has lost. */
void cli_warn_lost(cli_run *cli, const char *path, const vxm_repair_report *report);
/** Reads, and repairs unless `options` is NULL. After CLI_FAILED a line was printed and input->mesh is NULL.
 */
int cli_read_repaired(cli_run *cli, cli_input *input, const char *path, const vxm_repair_options *options);

/* ---- defects.c: what is wrong and where, for info and repair ---- */

typedef struct cli_defects {
  const char *locate; /**< .ply to show them in, or NULL */
  int64_t list;       /**< list so many of each kind in the report; 0 = none */
  bool intersections; /**< self-intersections too */
} cli_defects;

typedef struct cli_found {
  json_t *list;          /**< NULL = not wanted */
  int64_t intersections; /**< pairs of faces; -1 = not looked for */
} cli_found;

/** The argument of --list: CLI_END or CLI_STOP. */
int cli_defects_read_list(cli_run *cli, cli_defects *defects, const char *value);
/** CLI_STOP if --locate has a wrong name. */
int cli_defects_check(cli_run *cli, const cli_defects *defects);
/** CLI_STOP if --locate would replace a file. */
int cli_defects_check_file(cli_run *cli, const cli_defects *defects, bool is_forced);
/** Prints the list that cli_defects_show has made; NULL = none. */
void cli_defects_print(const cli_run *cli, const json_t *list);
/** Finds, lists, counts and draws the defects of a mesh; CLI_DONE or CLI_FAILED. */
int cli_defects_show(cli_run *cli, cli_found *out, const cli_defects *wanted, const vxm_mesh *mesh);

/* ---- field.c: coverage and distance, for voxelize; labels.c: labels ---- */

typedef struct cli_field {
  bool coverage, scalar, distance, band, labels, color; /**< which options were given */
  const char *color_name;                               /**< a function that is built in, or a file */
  const char *color_mesh;                               /**< the mesh that gives the colours, for messages */
  vxm_coverage_options coverage_options;
  vxm_distance_options distance_options;
  vxm_label_options label_options;
  vxm_color_options color_options;
  vxm_coverage_report coverage_report;
  vxm_distance_report distance_report;
  vxm_label_report label_report;
  json_t *label_table; /**< of the labels that were made, or NULL */
} cli_field;

#define CLI_FIELD_INIT                                                                            \
  {                                                                                               \
    .coverage_options = VXM_COVERAGE_OPTIONS_INIT, .distance_options = VXM_DISTANCE_OPTIONS_INIT, \
    .label_options = VXM_LABEL_OPTIONS_INIT, .color_options = VXM_COLOR_OPTIONS_INIT,             \
    .coverage_report = VXM_COVERAGE_REPORT_INIT, .distance_report = VXM_DISTANCE_REPORT_INIT,     \
    .label_report = VXM_LABEL_REPORT_INIT                                                         \
  }

/** The formats of what is wanted. */
cli_formats cli_field_formats(const cli_field *field);
/** Whether a number per voxel is wanted rather than a grid. */
bool cli_field_wanted(const cli_field *field);
/* The arguments of --coverage, --scalar, --distance, --band and --labels: CLI_END or CLI_STOP. */
int cli_field_read_coverage(cli_run *cli, cli_field *field, const char *value);
int cli_field_read_scalar(cli_run *cli, cli_field *field, const char *value);
int cli_field_read_distance(cli_run *cli, cli_field *field, const char *value);
int cli_field_read_band(cli_run *cli, cli_field *field, const char *value);
int cli_field_read_labels(cli_run *cli, cli_field *field, const char *value);
/** Tell what a mesh looks like that was read with its colours; nothing where there is nothing (look.c). */
void cli_look_json(json_t *report, const vxm_mesh *mesh);
void cli_look_print(const cli_run *cli, const vxm_mesh *mesh);

/** The argument of --color (colors.c). */
int cli_color_read(cli_run *cli, cli_field *field, const char *value);
/** Takes the mesh that gives the colours. */
void cli_color_take(cli_field *field, const cli_input *input);
/** Says of the mesh what it lacks: puts its name before the error. */
void cli_color_name_mesh(cli_run *cli, const char *path);
/** Writes the file of --color; a failure is in cli->error. */
vxm_status cli_color_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format);
/** CLI_STOP if they contradict each other, --mode, --dry-run (`is_tried`) or --confidence (`is_sure`). */
int cli_field_check(cli_run *cli, const cli_field *field, vxm_mode mode, bool is_tried, bool is_sure);
/** Writes the file; a failure is in cli->error. */
vxm_status cli_field_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format);
/** What that will take; zeros for labels. A failure is in cli->error. */
vxm_status cli_field_estimate(cli_run *cli, const cli_field *field, vxm_estimate *out, const vxm_model *model,
                              const vxm_space *space, const char *path, const char *format);
/** Adds "coverage", "distance", "labels" or "color". */
void cli_field_json(json_t *report, const cli_field *field);
void cli_field_summarize(const cli_run *cli, const cli_field *field);
/* The same for labels alone. */
vxm_status cli_labels_write(cli_run *cli, cli_field *field, vxm_model *model, const vxm_space *space,
                            const char *path);
void cli_labels_json(json_t *report, const cli_field *field);
void cli_labels_summarize(const cli_run *cli, const cli_field *field);

#endif
