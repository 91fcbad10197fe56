/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend info: what is wrong with a mesh. */
#include "cli/cli.h"

enum { KEY_LOCATE = CLI_KEY_COMMAND, KEY_LIST, KEY_INTERSECTIONS };

static const cli_option known_options[] = {
    {KEY_LOCATE, "locate", "FILE.ply", "show what is wrong, in colour on the mesh; for one mesh"},
    {KEY_LIST, "list", "N", "list what is wrong, up to N of each kind, with indices and coordinates"},
    {KEY_INTERSECTIONS, "intersections", NULL,
     "count faces that cut through others, and show them with --locate and\n--list (CGAL)"},
    CLI_OPTIONS_READ,
    {0, NULL, NULL, NULL}};

static json_t *describe_json(const cli_run *cli, const char *path, const vxm_mesh *mesh,
                             const vxm_census *census, const cli_found *found) {
  json_t *object = json_object();
  json_object_set_new(object, "file", cli_json_text(path));
  json_object_set_new(object, "format", cli_json_text(vxm_mesh_format(mesh)));
  cli_census_json(object, census);
  cli_intersections_json(object, found->intersections);
  if (found->list)
    json_object_set(object, "defects", found->list);
  json_object_set(object, "warnings", cli->warnings);
  return object;
}

static void describe(const cli_run *cli, const char *path, const vxm_mesh *mesh, const vxm_census *census,
                     const cli_found *found) {
  fprintf(cli->text, "%s\n  %-26s %12s\n", cli_shown(path, "<stdin>"), "format", vxm_mesh_format(mesh));
  if (cli->verbose && vxm_mesh_tag_count(mesh) > 0)
    fprintf(cli->text, "  %-26s %12lld\n", "tags", (long long)vxm_mesh_tag_count(mesh));
  cli_census_print(cli, census);
  cli_census_print_intersections(cli, found->intersections);
}

/** Adds the file's object to `reports` if it can be read. */
static int examine(cli_run *cli, json_t *reports, const char *path, const cli_defects *wanted) {
  json_array_clear(cli->warnings);
  vxm_mesh *mesh = NULL;
  vxm_census census = VXM_CENSUS_INIT;
  if (vxm_mesh_read_with(&mesh, cli->context, path, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_mesh(cli, path, mesh);
  cli_found found;
  int status = cli_defects_show(cli, &found, wanted, mesh);
  if (status == CLI_DONE && vxm_mesh_census(&census, mesh, &cli->error) != VXM_OK)
    status = cli_fail(cli);
  if (status == CLI_DONE) {
    cli_progress_clear(cli);
    if (cli_summary(cli)) {
      if (json_array_size(reports) > 0)
        fputc('\n', cli->text);
      describe(cli, path, mesh, &census, &found);
    }
    if (cli_summary(cli))
      cli_defects_print(cli, found.list);
    json_array_append_new(reports, describe_json(cli, path, mesh, &census, &found));
  }
  json_decref(found.list);
  vxm_mesh_destroy(mesh);
  return status;
}

static int read_arguments(cli_run *cli, cli_defects *wanted) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END) {
    if (key == CLI_STOP)
      return CLI_STOP;
    if (key == KEY_LOCATE)
      wanted->locate = value;
    else if (key == KEY_INTERSECTIONS)
      wanted->intersections = true;
    else if (cli_defects_read_list(cli, wanted, value) == CLI_STOP)
      return CLI_STOP;
  }
  if (cli->argument_count < 1)
    return cli_usage(cli, "a mesh is missing");
  if (wanted->locate && cli->argument_count > 1)
    return cli_usage(cli, "--locate is for one mesh, not %d", cli->argument_count);
  if (cli_defects_check(cli, wanted) == CLI_STOP)
    return CLI_STOP;
  cli_writes(cli, "--locate", wanted->locate, false);
  return cli_check_names(cli);
}

static int run(cli_run *cli) {
  cli_defects wanted = {0};
  if (read_arguments(cli, &wanted) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  json_t *reports = json_array();
  int failed = 0;
  for (int i = 0; i < cli->argument_count && !cli_signal(); i++)
    failed += examine(cli, reports, cli->arguments[i], &wanted) != CLI_DONE;
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
    .arguments = "MESH... [OPTION]...",
    .summary = "tell what is wrong with meshes",
    .notes =
        "Edges, components and repeated faces are counted after welding vertices at identical positions.\n"
        "--json prints one object for one mesh and an array for several. Files that cannot be read are\n"
        "named, the others are reported, and the exit status is 1.\n\n"
        "Examples:\n"
        "  voxmend info chair.off\n"
        "  voxmend info --json *.obj > census.json\n"
        "  voxmend info part.stl --locate wrong.ply",
    .options = known_options,
    .run = run,
};
