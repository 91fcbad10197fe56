/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend combine: the union, intersection or difference of grids. */
#include "cli/combine.h"
#include "cli/values.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const cli_option known_options[] = {
    {'o', "output", "FILE", CLI_GRID_FILES "; '-' is standard output", CLI_TEXT(combine_request, output)},
    {0, "format", "F", CLI_GRID_FORMATS, CLI_TEXT(combine_request, write.format)},
    {0, "sparse", NULL,
     "combine octrees, whose memory follows the surface where files are .octree or\n"
     ".vdb [where the output is .octree]",
     CLI_FLAG(combine_request, sparse)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_SURFACE(combine_request),
    CLI_OPTIONS_THRESHOLD(combine_request),
    CLI_OPTIONS_END};

static const char *const operations[] = {"or", "and", "minus", "xor", NULL};
static const vxm_set_operation meant[] = {VXM_SET_UNION, VXM_SET_INTERSECTION, VXM_SET_DIFFERENCE,
                                          VXM_SET_SYMMETRIC_DIFFERENCE};

/** Grids and words between them take turns: only the grids are left as arguments, the words go to `words`. */
static int read_formula(cli_run *cli, int *words) {
  char list[CLI_LIST_MAX];
  int count = cli->argument_count;
  if (count < 3 || count % 2 == 0)
    return cli_usage(cli, "grids with %s between them are expected, such as a.npy or b.npy",
                     cli_list(list, operations));
  for (int i = 1; i < count; i += 2) {
    words[i / 2] = cli_read_choice(cli->arguments[i], operations);
    if (words[i / 2] < 0)
      return cli_usage(cli, "'%s' is none of %s", cli->arguments[i], cli_list(list, operations));
  }
  for (int i = 2; i < count; i += 2)
    cli->arguments[i / 2] = cli->arguments[i];
  cli->argument_count = count / 2 + 1;
  return CLI_END;
}

static int check_output(cli_run *cli, combine_request *out) {
  if (cli_check_grid_output(cli, out->output, &out->write, cli_formats_with(VXM_FORMAT_BITS), true) ==
      CLI_STOP)
    return CLI_STOP;
  out->sparse |= strcmp(out->write.format, "octree") == 0;
  return CLI_END;
}

/** Files hold a space to about nine digits. */
int combine_check_spaces(cli_run *cli, const vxm_space *a, const vxm_space *b, const char *const paths[2]) {
  const int64_t *m = a->dims, *n = b->dims;
  const double *o = a->origin, *p = b->origin, *s = a->voxel_size, *t = b->voxel_size;
  bool moved = false, scaled = false;
  if (m[0] != n[0] || m[1] != n[1] || m[2] != n[2])
    return cli_fail_text(cli,
                         "%s has %" PRId64 " x %" PRId64 " x %" PRId64 " voxels and %s %" PRId64 " x %" PRId64
                         " x %" PRId64 "; 'voxmend voxelize --like' makes equal grids",
                         paths[0], m[0], m[1], m[2], paths[1], n[0], n[1], n[2]);
  for (int axis = 0; axis < 3; axis++) {
    moved |= !(fabs(o[axis] - p[axis]) <= 1e-3 * s[axis]);
    scaled |= !(fabs(s[axis] - t[axis]) * (double)m[axis] <= 1e-3 * s[axis]);
  }
  if (scaled)
    return cli_fail_text(
        cli,
        "%s has voxels of %.9g x %.9g x %.9g and %s of %.9g x %.9g x %.9g; 'voxmend voxelize "
        "--like' makes equal grids",
        paths[0], s[0], s[1], s[2], paths[1], t[0], t[1], t[2]);
  if (moved)
    return cli_fail_text(cli,
                         "%s begins at (%.9g, %.9g, %.9g) and %s at (%.9g, %.9g, %.9g); 'voxmend voxelize "
                         "--like' makes equal grids",
                         paths[0], o[0], o[1], o[2], paths[1], p[0], p[1], p[2]);
  return CLI_DONE;
}

static int combine_grids(cli_run *cli, vxm_grid **grid, const vxm_grid *other, int operation) {
  vxm_grid *combined;
  if (vxm_grid_combine(&combined, *grid, other, meant[operation], &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_grid_destroy(*grid);
  *grid = combined;
  return CLI_DONE;
}

static int combine_octrees(cli_run *cli, vxm_sparse **set, const vxm_sparse *other, int operation) {
  vxm_sparse *combined;
  if (vxm_sparse_combine(&combined, *set, other, meant[operation], &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_sparse_destroy(*set);
  *set = combined;
  return CLI_DONE;
}

static int combine_fields(cli_run *cli, vxm_field **field, const vxm_field *other, int operation) {
  vxm_field *combined;
  if (vxm_field_combine(&combined, *field, other, meant[operation], &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_field_destroy(*field);
  *field = combined;
  return CLI_DONE;
}

static int combine_two(cli_run *cli, combine_operand *out, const combine_operand *other, int operation) {
  return out->field    ? combine_fields(cli, &out->field, other->field, operation)
         : out->sparse ? combine_octrees(cli, &out->sparse, other->sparse, operation)
                       : combine_grids(cli, &out->grid, other->grid, operation);
}

/** From left to right. */
static int combine_all(cli_run *cli, combine_operand *out, const combine_request *given, const int *words,
                       json_t *renumbered) {
  const char *first = cli_shown(cli->arguments[0], "<stdin>");
  int status = combine_read(cli, out, given, cli->arguments[0], NULL);
  for (int i = 1; i < cli->argument_count && status == CLI_DONE; i++) {
    combine_operand other = {NULL, NULL, NULL};
    status = combine_read(cli, &other, given, cli->arguments[i], out);
    const char *paths[2] = {first, cli_shown(cli->arguments[i], "<stdin>")};
    if (status == CLI_DONE)
      status = combine_check_spaces(cli, combine_space(out), combine_space(&other), paths);
    int64_t named = vxm_field_label_count(out->field);
    if (status == CLI_DONE)
      status = combine_two(cli, out, &other, words[i - 1]);
    if (status == CLI_DONE && out->field)
      combine_note_labels(renumbered, cli->arguments[i], other.field, named, meant[words[i - 1]], out->field);
    combine_free(&other);
  }
  return status;
}

/** What was made: counted and hashed once. */
typedef struct outcome {
  const vxm_space *space;
  int64_t voxels;
  uint64_t hash;
} outcome;

static outcome outcome_of(const combine_operand *set) {
  if (set->sparse)
    return (outcome){vxm_sparse_space(set->sparse), vxm_sparse_count(set->sparse),
                     vxm_sparse_hash(set->sparse)};
  return (outcome){vxm_grid_space(set->grid), vxm_grid_count(set->grid), vxm_grid_hash(set->grid)};
}

/** The part of the report that tells what was asked for. */
static json_t *make_report(const cli_run *cli, const combine_request *given, const int *words) {
  json_t *report = json_object(), *inputs = json_array(), *names = json_array();
  for (int i = 0; i < cli->argument_count; i++)
    json_array_append_new(inputs, cli_json_text(cli->arguments[i]));
  for (int i = 1; i < cli->argument_count; i++)
    json_array_append_new(names, json_string(operations[words[i - 1]]));
  json_object_set_new(report, "inputs", inputs);
  json_object_set_new(report, "operations", names);
  json_object_set_new(report, "output", cli_json_text(given->output));
  return report;
}

static int write_set(cli_run *cli, const combine_request *given, const combine_operand *set,
                     const int *words) {
  vxm_status status = set->sparse ? vxm_sparse_write(set->sparse, given->output, &given->write, &cli->error)
                                  : vxm_grid_write(set->grid, given->output, &given->write, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  const outcome made = outcome_of(set);
  json_t *report = make_report(cli, given, words);
  cli_progress_clear(cli);
  cli_warn_lattice(cli, given->output, given->write.format, made.space);
  if (cli_summary(cli)) {
    cli_rows_space(cli, made.space);
    cli_row(cli, "voxels", "%" PRId64, made.voxels);
    cli_row(cli, "hash", "%016" PRIx64, made.hash);
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
  }
  json_object_set_new(report, "grid", cli_json_space(made.space));
  json_object_set_new(report, "voxels", json_integer(made.voxels));
  json_object_set_new(report, "hash", cli_json_hash(made.hash));
  json_object_set(report, "warnings", cli->warnings);
  return cli_finish(cli, report);
}

/** In memory. */
static int combine_here(cli_run *cli, const combine_request *given, const int *words) {
  combine_operand set = {NULL, NULL, NULL};
  json_t *renumbered = json_array();
  int status = combine_all(cli, &set, given, words, renumbered);
  if (status == CLI_DONE)
    status = set.field
                 ? combine_write_field(cli, given, set.field, make_report(cli, given, words), renumbered)
                 : write_set(cli, given, &set, words);
  json_decref(renumbered);
  combine_free(&set);
  return status;
}

/** From file to file where that goes. */
static int combine(cli_run *cli, const combine_request *given, const int *words) {
  bool made = false;
  int status = CLI_DONE;
  if (combine_are_octrees(cli, given)) {
    vxm_set_operation *list = calloc((size_t)cli->argument_count, sizeof *list);
    if (!list)
      return cli_fail_text(cli, "out of memory for the command line");
    for (int i = 1; i < cli->argument_count; i++)
      list[i - 1] = meant[words[i - 1]];
    status = combine_files(cli, given, list, make_report(cli, given, words), &made);
    free(list);
  }
  return made || status != CLI_DONE ? status : combine_here(cli, given, words);
}

static int run(cli_run *cli) {
  combine_request given = {.threshold = VXM_THRESHOLD_OPTIONS_INIT, .write = VXM_GRID_WRITE_OPTIONS_INIT};
  if (cli_read_options(cli, &given) == CLI_STOP)
    return cli->status;
  int *words = calloc((size_t)cli->argument_count / 2 + 1, sizeof *words);
  if (!words)
    return cli_fail_text(cli, "out of memory for the command line");
  int status = CLI_FAILED;
  if (read_formula(cli, words) == CLI_STOP || check_output(cli, &given) == CLI_STOP)
    status = cli->status;
  else if (cli_start(cli))
    status = combine(cli, &given, words);
  free(words);
  return status;
}

const cli_command cli_command_combine = {
    .name = "combine",
    .arguments = "GRID or|and|minus|xor GRID... -o FILE [OPTION]...",
    .summary = "unite, intersect or subtract grids",
    .notes =
        "or: what either has; and: what both have; minus: what the first has and the second has not; xor:\n"
        "what one alone has. More than two go from left to right. The grids must have equal dimensions,\n"
        "origins and voxel sizes, as 'voxmend voxelize --like' makes them; a file without a place, such as "
        "a\n"
        ".npy without its .json, lies at the origin with voxels of 1.\n\n"
        "Values of one kind and type are combined, too. Labels, colours and numbers other than 0 go with\n"
        "their voxels; where both grids have one the first one's stays. Labels are one if their names are,\n"
        "and new names are numbered behind those of the first. Of signed distances 'or' is the lesser,\n"
        "'and' the greater, 'minus' the greater of the first and the second's negative, 'xor' is 'or' minus\n"
        "'and'. .octree files with values go from file to file to an .octree. With --threshold or --below\n"
        "numbers become set and clear voxels instead; a file of such voxels is taken as it is.\n\n"
        "Examples:\n"
        "  voxmend combine body.npy or lid.npy -o box.npy\n"
        "  voxmend combine block.binvox minus drill.binvox minus slot.binvox -o part.stl\n"
        "  voxmend combine city.octree minus road.octree -o rest.octree\n"
        "  voxmend combine frame-labels.octree or glass-labels.octree -o car-labels.octree",
    .options = known_options,
    .run = run,
};
