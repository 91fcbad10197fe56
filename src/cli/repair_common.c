/* SPDX-License-Identifier: BSD-3-Clause */
/** Reading and repairing a mesh, which repair, voxelize and view have in common. */
#include "cli/repair_common.h"

#include <string.h>

int cli_read_weld(cli_run *cli, vxm_repair_options *options, const char *value) {
  double tolerance;
  if (strcmp(value, "auto") == 0)
    options->weld = VXM_WELD_AUTO;
  else if (strcmp(value, "off") == 0)
    options->weld = VXM_WELD_OFF;
  else if (cli_read_number(&tolerance, value) && tolerance > 0) {
    options->weld = VXM_WELD_TOLERANCE;
    options->weld_tolerance = tolerance;
  } else
    return cli_usage(cli, "--weld '%s' is neither auto, off nor a positive distance", value);
  return CLI_END;
}

int cli_check_repair(cli_run *cli, bool no_repair, bool repair_options) {
  if (no_repair && repair_options)
    return cli_usage(cli, "--weld and --keep-duplicates are about the repair; leave out --no-repair");
  return CLI_END;
}

json_t *cli_passes_json(const vxm_repair_report *report) {
  json_t *passes = json_array();
  for (int i = 0; i < report->pass_count; i++) {
    json_t *pass = json_object();
    json_object_set_new(pass, "pass", json_string(report->passes[i].pass));
    json_object_set_new(pass, "count", json_integer(report->passes[i].count));
    json_array_append_new(passes, pass);
  }
  return passes;
}

void cli_warn_lost(cli_run *cli, const char *path, const vxm_repair_report *report) {
  if (report->lost_parts > 0)
    cli_warn(
        cli,
        "%s: %lld parts enclose less after the repair than before; --keep-duplicates or --weld off may keep "
        "them, and voxmend voxelize --no-repair takes them as they are",
        cli_shown(path, "<stdin>"), (long long)report->lost_parts);
}

static void drop_as_read(cli_input *input) {
  vxm_mesh_destroy(input->as_read);
  input->as_read = NULL;
}

int cli_read_repaired(cli_run *cli, cli_input *input, const char *path, const vxm_repair_options *options) {
  *input = (cli_input){.path = path, .repair = VXM_REPAIR_REPORT_INIT};
  double start = cli_clock();
  if (vxm_mesh_read_with(&input->mesh, cli->context, path, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_mesh(cli, path, input->mesh, 0);
  int64_t told = vxm_mesh_warning_count(input->mesh);
  snprintf(input->format, sizeof input->format, "%s", vxm_mesh_format(input->mesh));
  input->vertices = vxm_mesh_vertex_count(input->mesh);
  input->faces = vxm_mesh_face_count(input->mesh);
  double read = cli_clock();
  input->read_ms = read - start;
  if (!options)
    return CLI_DONE;
  vxm_status status;
  if (cli->read.colors) {
    input->as_read = input->mesh;
    input->mesh = NULL;
    status = vxm_mesh_prepare(&input->mesh, &input->repair, input->as_read, options, &cli->error);
  } else
    status = vxm_mesh_prepare_in_place(&input->mesh, &input->repair, options, &cli->error);
  input->repair_ms = cli_clock() - read;
  if (status != VXM_OK) {
    drop_as_read(input);
    return cli_fail(cli);
  }
  cli_warn_mesh(cli, path, input->mesh, told);
  cli_warn_lost(cli, path, &input->repair);
  if (vxm_mesh_face_count(input->mesh) > 0)
    return CLI_DONE;
  vxm_mesh_destroy(input->mesh);
  input->mesh = NULL;
  drop_as_read(input);
  return cli_fail_text(cli, "%s: no face is left after repair", cli_shown(path, "<stdin>"));
}
