/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend repair: a repaired mesh, and a table of what changed. */
#include "cli/cli.h"

#include <inttypes.h>
#include <string.h>

enum { KEY_WELD = CLI_KEY_COMMAND, KEY_KEEP, KEY_TURNED, KEY_CLOSE, KEY_ASCII, KEY_FORMAT };

static const cli_option known_options[] = {
    {'o', "output", "MESH", "file to write; '-' is standard output (needs --format)"},
    {KEY_WELD, "weld", "auto|off|EPS",
     "which vertices become one: auto = those at identical positions, and\n"
     "near ones where that closes cracks; off = identical positions only;\n"
     "EPS = all that are no farther apart, in model units [auto]"},
    {KEY_KEEP, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it"},
    {KEY_TURNED, "keep-orientation", NULL,
     "leave faces turned as they are, rather than consistently and outward"},
    {KEY_CLOSE, "close", NULL,
     "close holes: triangles from the middle of each rim to its edges. Sheets,\n"
     "which that would only cover a second time, stay open"},
    {KEY_ASCII, "ascii", NULL, "write .stl and .ply as text rather than binary"},
    {KEY_FORMAT, "format", "F", "off, obj, stl or ply [by the name of the output]"},
    CLI_OPTION_DEFLECTION,
    {0, NULL, NULL, NULL}};

typedef struct request {
  const char *input, *output, *format;
  vxm_repair_options repair;
  vxm_mesh_write_options write;
} request;

/** CLI_DONE, or CLI_STOP with cli->status set. */
static int read_arguments(cli_run *cli, request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END) {
    switch (key) {
    case 'o':
      out->output = value;
      break;
    case KEY_WELD:
      if (!cli_read_weld(&out->repair, value))
        return cli_usage(cli, "--weld '%s' is neither auto, off nor a positive distance", value);
      break;
    case KEY_KEEP:
      out->repair.keep_duplicates = true;
      break;
    case KEY_TURNED:
      out->repair.keep_orientation = true;
      break;
    case KEY_CLOSE:
      out->repair.close = true;
      break;
    case KEY_ASCII:
      out->write.ascii = true;
      break;
    case KEY_FORMAT:
      out->format = value;
      break;
    default:
      return CLI_STOP;
    }
  }
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  out->write.format = cli_output_format(cli, out->output, out->format, cli_mesh_formats);
  return out->write.format ? CLI_DONE : CLI_STOP;
}

static json_t *make_report(const cli_run *cli, const request *given, const cli_input *input) {
  json_t *before = json_object(), *after = json_object(), *report = json_object();
  cli_census_json(before, &input->repair.before);
  cli_census_json(after, &input->repair.after);
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "passes", cli_passes_json(&input->repair));
  json_object_set_new(report, "nonorientable_patches", json_integer(input->repair.nonorientable_patches));
  json_object_set_new(report, "open_parts", json_integer(input->repair.open_parts));
  json_object_set_new(report, "before", before);
  json_object_set_new(report, "after", after);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static void summarize(const cli_run *cli, const vxm_repair_report *repair) {
  cli_census_print_both(cli, &repair->before, &repair->after);
  fprintf(cli->text, "\n%-28s %12s\n", "Pass", "Changed");
  for (int i = 0; i < repair->pass_count; i++)
    fprintf(cli->text, "  %-26s %12" PRId64 "\n", repair->passes[i].pass, repair->passes[i].count);
  if (repair->nonorientable_patches > 0)
    fprintf(cli->text, "\n%" PRId64 " patches cannot be turned consistently (like a Moebius strip)\n",
            repair->nonorientable_patches);
  if (repair->open_parts > 0)
    fprintf(cli->text,
            "\n%" PRId64 " components stay open: sheets, which closing would only cover a second time\n",
            repair->open_parts);
}

static int run(cli_run *cli) {
  request given = {.repair = VXM_REPAIR_OPTIONS_INIT, .write = VXM_MESH_WRITE_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  cli_input input;
  if (cli_read_repaired(cli, &input, given.input, &given.repair) != CLI_DONE)
    return CLI_FAILED;
  vxm_status status = vxm_mesh_write(input.mesh, given.output, &given.write, &cli->error);
  vxm_mesh_destroy(input.mesh);
  if (status != VXM_OK)
    return cli_fail(cli);
  cli->made = given.output;
  cli->made_format = given.write.format;
  cli_progress_clear(cli);
  if (cli_summary(cli))
    summarize(cli, &input.repair);
  return cli_finish(cli, make_report(cli, &given, &input));
}

const cli_command cli_command_repair = {
    .name = "repair",
    .arguments = "MESH -o MESH [OPTION]...",
    .summary = "mend a mesh, and show it before and after",
    .notes =
        "Removes vertices that are not finite with their faces, welds vertices, removes faces without area,\n"
        "repeated faces (of two that lie back to back one stays) and unused vertices, and turns faces\n"
        "consistently, outward where they enclose something. Repairing the result again changes nothing.\n\n"
        "Examples:\n"
        "  voxmend repair scan.obj -o scan.ply\n"
        "  voxmend repair part.stl -o part.off --weld 0.001\n"
        "  voxmend repair scan.ply -o closed.stl --close\n"
        "  cat part.stl | voxmend repair - -o - --format obj > part.obj",
    .options = known_options,
    .run = run,
};
