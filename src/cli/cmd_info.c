/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend info: what is wrong with a mesh, or what a grid holds. */
#include "cli/defects.h"
#include "cli/field.h"
#include "cli/values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const cli_option known_options[] = {
    {0, "locate", "FILE.ply", "show what is wrong, in colour on the mesh; for one mesh",
     CLI_TEXT(cli_defects, locate)},
    {0, "list", "N", "list what is wrong, up to N of each kind, with indices and coordinates",
     CLI_NUMBER(cli_defects, list, 1, CLI_LISTED_MAX)},
    {0, "intersections", NULL,
     "count faces that cut through others, and show them with --locate and\n--list (CGAL)",
     CLI_FLAG(cli_defects, intersections)},
    {0, "force", NULL, "replace a mesh that is there with --locate", CLI_NOTED},
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

/** What is known of a mesh. */
typedef struct description {
  const char *path, *verdict;
  const vxm_mesh *mesh;
  vxm_census census;
  cli_found found;
} description;

/** Names of groups, parts and materials, with their faces; NULL where there are none, or no memory. */
static json_t *tags_json(const vxm_mesh *mesh) {
  int64_t count = vxm_mesh_tag_count(mesh), faces = vxm_mesh_face_count(mesh);
  const uint32_t *tags = vxm_mesh_face_tags(mesh);
  int64_t *sizes = count > 0 && tags ? calloc((size_t)count, sizeof *sizes) : NULL;
  json_t *list = sizes ? json_array() : NULL;
  for (int64_t f = 0; sizes && f < faces; f++)
    sizes[tags[f]]++;
  for (int64_t t = 0; list && t < count; t++)
    json_array_append_new(list, json_pack("{s:o, s:I}", "name", cli_json_text(vxm_mesh_tag_name(mesh, t)),
                                          "faces", (json_int_t)sizes[t]));
  free(sizes);
  return list;
}

static json_t *describe_json(const cli_run *cli, const description *d) {
  json_t *object = json_object();
  json_object_set_new(object, "file", cli_json_text(d->path));
  json_object_set_new(object, "format", cli_json_text(vxm_mesh_format(d->mesh)));
  json_object_set_new(object, "verdict", cli_json_text(d->verdict));
  json_t *tags = tags_json(d->mesh);
  if (tags)
    json_object_set_new(object, "tags", tags);
  cli_look_json(object, d->mesh);
  cli_census_json(object, &d->census);
  cli_intersections_json(object, d->found.intersections);
  if (d->found.list)
    json_object_set(object, "defects", d->found.list);
  json_object_set_new(object, "warnings", json_copy(cli->warnings));
  return object;
}

static void describe(const cli_run *cli, const description *d) {
  cli_put_text(cli, cli_shown(d->path, "<stdin>"), 0);
  fprintf(cli->text, "\n%s\n", d->verdict);
  fprintf(cli->text, "  %-26s %12s\n", "format", vxm_mesh_format(d->mesh));
  if (cli->verbose && vxm_mesh_tag_count(d->mesh) > 0)
    fprintf(cli->text, "  %-26s %12lld\n", "tags", (long long)vxm_mesh_tag_count(d->mesh));
  cli_look_print(cli, d->mesh);
  cli_census_print(cli, &d->census);
  cli_census_print_intersections(cli, d->found.intersections);
}

/** Several files are a row each, unless more is wanted of them. */
static bool is_table(const cli_run *cli, const cli_defects *wanted) {
  return cli->argument_count > 1 && !cli->verbose && !wanted->list;
}

static int name_width(const cli_run *cli) {
  size_t width = strlen("file"), most = 100;
  for (int i = 0; i < cli->argument_count; i++) {
    size_t length = strlen(cli_shown(cli->arguments[i], "<stdin>"));
    width = length > width ? length : width;
  }
  return (int)(width < most ? width : most);
}

static void print_heading(const cli_run *cli) {
  fprintf(cli->text, "%-*s %9s %9s %7s %7s %8s %7s %8s %7s  %s\n", name_width(cli), "file", "vertices",
          "faces", "parts", "open", "forked", "turned", "repeated", "no area", "verdict");
}

static void print_row(const cli_run *cli, const description *d) {
  const vxm_census *c = &d->census;
  cli_put_text(cli, cli_shown(d->path, "<stdin>"), name_width(cli));
  fprintf(cli->text,
          " %9" PRId64 " %9" PRId64 " %7" PRId64 " %7" PRId64 " %8" PRId64 " %7" PRId64 " %8" PRId64
          " %7" PRId64 "  %.*s\n",
          c->vertices, c->faces, c->components, c->boundary_edges, c->nonmanifold_edges,
          c->inconsistent_edges, c->duplicate_faces + c->opposite_duplicate_faces, c->degenerate_faces,
          (int)strcspn(d->verdict, ";"), d->verdict);
}

/** Counts what repair would have to close. Only where something is, or may be: it takes as long as
 * the repair. */
static int count_openings(cli_run *cli, cli_openings *out, const description *d) {
  *out = (cli_openings){.known = true};
  const vxm_census *census = &d->census;
  bool may_vanish = census->degenerate_faces == census->faces;
  if ((census->closed && census->nonmanifold_edges == 0 && !may_vanish) || census->faces == 0)
    return CLI_DONE;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  options.level = VXM_LEVEL_CLOSED;
  options.sheets = VXM_SHEETS_KEEP;
  vxm_mesh *closed = NULL;
  vxm_status status = vxm_mesh_repair(&closed, &report, d->mesh, &options, &cli->error);
  out->empty = status == VXM_OK && vxm_mesh_face_count(closed) == 0;
  vxm_mesh_destroy(closed);
  out->sheets = report.open_parts;
  out->holes = report.filled_holes;
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** What stands in the output so far. */
typedef struct told {
  bool any, is_grid; /**< is_grid: the last file was one */
} told;

/** Whether a file needs a heading: it is the first, or follows one of the other kind. */
static bool begins_table(told *before, bool is_grid) {
  bool begins = !before->any || before->is_grid != is_grid;
  *before = (told){true, is_grid};
  return begins;
}

static void put_between(const cli_run *cli, told *before) {
  if (before->any)
    fputc('\n', cli->text);
  before->any = true;
}

static void show(const cli_run *cli, const description *d, const cli_defects *wanted, told *before) {
  if (is_table(cli, wanted)) {
    if (begins_table(before, false))
      print_heading(cli);
    print_row(cli, d);
    return;
  }
  put_between(cli, before);
  describe(cli, d);
  cli_defects_print(cli, d->found.list);
}

static int look_at(cli_run *cli, json_t *reports, description *d, const cli_defects *wanted, told *before) {
  if (vxm_mesh_census(&d->census, d->mesh, &cli->error) != VXM_OK)
    return cli_fail(cli);
  char sentence[CLI_SENTENCE];
  cli_openings openings;
  if (count_openings(cli, &openings, d) != CLI_DONE)
    return CLI_FAILED;
  d->verdict = cli_verdict(sentence, &d->census, &openings, d->found.intersections);
  cli_progress_clear(cli);
  if (cli_summary(cli))
    show(cli, d, wanted, before);
  json_array_append_new(reports, describe_json(cli, d));
  return CLI_DONE;
}

static int examine_grid(cli_run *cli, json_t *reports, const char *path, const cli_defects *wanted,
                        told *before) {
  told now = *before;
  cli_grid_row row = {name_width(cli), begins_table(&now, true), before->any};
  int status = cli_grid_info(cli, reports, path, &row, is_table(cli, wanted));
  if (status == CLI_DONE)
    *before = now;
  return status;
}

/** Whether a file is only what stands beside a grid, "grid.npy.json", among many. */
static bool is_beside_grid(const cli_run *cli, const char *path) {
  char *grid = cli_is_extension(path, "json") ? strndup(path, strlen(path) - strlen(".json")) : NULL;
  bool is_one = grid && cli->argument_count > 1 && cli_is_grid_name(grid) && access(grid, R_OK) == 0;
  free(grid);
  return is_one;
}

/** Adds the file's object to `reports` if it can be read. */
static int examine(cli_run *cli, json_t *reports, const char *path, const cli_defects *wanted, told *before) {
  json_array_clear(cli->warnings);
  if (is_beside_grid(cli, path))
    return CLI_DONE;
  if (cli_is_grid_name(path))
    return examine_grid(cli, reports, path, wanted, before);
  vxm_mesh *mesh = NULL;
  if (vxm_mesh_read_with(&mesh, cli->context, path, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_mesh(cli, path, mesh, 0);
  description d = {.path = path, .mesh = mesh, .census = VXM_CENSUS_INIT};
  int status = cli_defects_show(cli, &d.found, wanted, mesh);
  if (status == CLI_DONE)
    status = look_at(cli, reports, &d, wanted, before);
  json_decref(d.found.list);
  vxm_mesh_destroy(mesh);
  return status;
}

static int read_arguments(cli_run *cli, cli_defects *wanted) {
  if (cli_read_options(cli, wanted) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count < 1)
    return cli_usage(cli, "a mesh or grid is missing");
  if (wanted->locate && cli->argument_count > 1)
    return cli_usage(cli, "--locate is for one mesh, not %d", cli->argument_count);
  if (cli_is_given(cli, "force") && !wanted->locate)
    return cli_usage(cli, "--force goes with --locate");
  for (int i = 0; i < cli->argument_count; i++)
    if ((wanted->locate || wanted->list || wanted->intersections) && cli_is_grid_name(cli->arguments[i]))
      return cli_usage(cli, "--locate, --list and --intersections are for meshes, and %s is a grid",
                       cli->arguments[i]);
  if (cli_defects_check(cli, wanted) == CLI_STOP)
    return CLI_STOP;
  cli_writes(cli, "--locate", wanted->locate, false);
  return cli_check_names(cli) == CLI_STOP ? CLI_STOP : cli_defects_check_file(cli, wanted);
}

static int run(cli_run *cli) {
  cli_defects wanted = {0};
  if (read_arguments(cli, &wanted) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  cli->read.colors = true;
  json_t *reports = json_array();
  int failed = 0;
  told before = {false, false};
  for (int i = 0; i < cli->argument_count && !cli_signal(); i++)
    failed += examine(cli, reports, cli->arguments[i], &wanted, &before) != CLI_DONE;
  if (failed == cli->argument_count || cli_signal()) {
    json_decref(reports);
    return CLI_FAILED;
  }
  json_t *report = reports;
  if (cli->argument_count == 1) {
    report = json_incref(json_array_get(reports, 0));
    json_decref(reports);
  }
  int status = cli_finish(cli, report);
  return failed > 0 ? CLI_FAILED : status;
}

const cli_command cli_command_info = {
    .name = "info",
    .arguments = "MESH|GRID... [OPTION]...",
    .summary = "tell what is wrong with meshes, and what grids hold",
    .notes =
        "Edges, components and repeated faces are counted after welding vertices at identical positions.\n"
        "Of several meshes each is a row of a table: open, forked and turned are edges of one face, of more\n"
        "than two, and of two that are wound against each other; with --verbose or --list, each is told in\n"
        "full. --json prints one object for one mesh and an array for several. Files that cannot be read "
        "are\n"
        "named, the others are reported, and the exit status is 1.\n"
        "Of a grid it tells dimensions, voxel size, where it lies, and what is set: ranges of numbers, the\n"
        "voxels of each label with their names. Standard input is read as a mesh.\n\n"
        "Examples:\n"
        "  voxmend info chair.off\n"
        "  voxmend info --json *.obj > census.json\n"
        "  voxmend info part.stl --locate wrong.ply\n"
        "  voxmend info grids/*.npy",
    .options = known_options,
    .many = true,
    .run = run,
};
