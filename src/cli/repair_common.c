/* SPDX-License-Identifier: BSD-3-Clause */
/** Reading and repairing a mesh, which repair, voxelize and view have in common. */
#include "cli/repair_common.h"

#include <inttypes.h>
#include <string.h>

int cli_take_weld(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_repair_options *options = member;
  double tolerance;
  if (strcmp(value, "auto") == 0)
    options->weld = VXM_WELD_AUTO;
  else if (strcmp(value, "off") == 0)
    options->weld = VXM_WELD_OFF;
  else if (cli_read_number(&tolerance, value) && tolerance > 0) {
    options->weld = VXM_WELD_TOLERANCE;
    options->weld_tolerance = tolerance;
  } else
    return cli_usage(cli, "--%s '%s' is neither auto, off nor a positive distance", option->name, value);
  return CLI_END;
}

int cli_check_repair(cli_run *cli) {
  static const char *const of_repair[] = {"weld", "keep-duplicates", NULL};
  if (cli_is_given(cli, "no-repair") && cli_last_given(cli, of_repair))
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
    cli_warn(cli,
             "%s: %lld %s less after the repair than before; --keep-duplicates or --weld off may keep "
             "%s, and voxmend voxelize --no-repair takes %s",
             cli_shown(path, "<stdin>"), (long long)report->lost_parts,
             report->lost_parts == 1 ? "part encloses" : "parts enclose",
             report->lost_parts == 1 ? "it" : "them",
             report->lost_parts == 1 ? "it as it is" : "them as they are");
}

void cli_advise(cli_run *cli, const char *advice) {
  size_t used = strlen(cli->error.text);
  snprintf(cli->error.text + used, sizeof cli->error.text - used, "; %s", advice);
}

/** Adds the passes that have changed something, but for vertices of no face, as all are at the end. */
static void add_passes(char *text, size_t size, const vxm_repair_report *report) {
  bool any = false;
  for (int i = 0; i < report->pass_count; i++)
    if (report->passes[i].count > 0 && strcmp(report->passes[i].pass, "unused_vertices") != 0) {
      size_t used = strlen(text);
      snprintf(text + used, size - used, "%s%s %" PRId64, any ? ", " : " (", report->passes[i].pass,
               report->passes[i].count);
      any = true;
    }
  if (any && strlen(text) + 1 < size)
    strcat(text, ")");
}

static bool has_rounded(const vxm_repair_report *report) {
  for (int i = 0; i < report->pass_count; i++)
    if (strcmp(report->passes[i].pass, "rounding") == 0 && report->passes[i].count > 0)
      return true;
  return false;
}

void cli_no_face(cli_run *cli, const char *path, int64_t faces, const vxm_repair_report *report) {
  char *text = cli->error.text;
  cli->error.code = VXM_ERROR_EMPTY;
  snprintf(text, sizeof cli->error.text, "%.300s: %s", cli_shown(path, "<stdin>"),
           faces == 0 ? "there is no face in it" : "no face is left after repair");
  if (faces == 0)
    return;
  add_passes(text, sizeof cli->error.text, report);
  if (has_rounded(report))
    cli_advise(cli, "the 32-bit floats of .stl may be too coarse here: write another format");
}

static void drop_as_read(cli_input *input) {
  vxm_mesh_destroy(input->as_read);
  input->as_read = NULL;
}

int cli_read_repaired(cli_run *cli, cli_input *input, const char *path, const vxm_repair_options *options) {
  return cli_read_divided(cli, input, path, VXM_LABEL_PART, options);
}

static vxm_status divide(cli_run *cli, vxm_mesh **mesh, vxm_label_by by) {
  vxm_mesh *whole = *mesh;
  if (by == VXM_LABEL_PART)
    return VXM_OK;
  vxm_status status = vxm_mesh_divide(mesh, whole, by, &cli->error);
  vxm_mesh_destroy(whole);
  return status;
}

int cli_read_divided(cli_run *cli, cli_input *input, const char *path, vxm_label_by by,
                     const vxm_repair_options *options) {
  *input = (cli_input){.path = path, .repair = VXM_REPAIR_REPORT_INIT};
  double start = cli_clock();
  if (vxm_mesh_read_with(&input->mesh, cli->context, path, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_note_companions(cli, input->mesh);
  cli_warn_mesh(cli, path, input->mesh, 0);
  int64_t told = vxm_mesh_warning_count(input->mesh);
  snprintf(input->format, sizeof input->format, "%s", vxm_mesh_format(input->mesh));
  input->vertices = vxm_mesh_vertex_count(input->mesh);
  input->faces = vxm_mesh_face_count(input->mesh);
  double read = cli_clock();
  input->read_ms = read - start;
  if (divide(cli, &input->mesh, by) != VXM_OK)
    return cli_fail(cli);
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
  cli_no_face(cli, path, input->faces, &input->repair);
  return cli_fail(cli);
}
