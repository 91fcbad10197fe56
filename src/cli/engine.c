/* SPDX-License-Identifier: BSD-3-Clause */
/** The options that say which engine makes the voxels. */
#include "cli/engine.h"

#include <string.h>

const char *const cli_cl_methods[] = {"auto", "triangles", "tiles", NULL};
const char *const cli_gl_methods[] = {"columns", "slices", "tetra-vertex", NULL};

int cli_take_displacement(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_engine_options *options = member;
  char text[64];
  const char *comma = strchr(value, ',');
  int64_t seed = 0;
  size_t length = comma ? (size_t)(comma - value) : strlen(value);
  snprintf(text, sizeof text, "%.*s", (int)(length < sizeof text ? length : sizeof text), value);
  if (!cli_read_number(&options->displacement, text) || options->displacement < 0 ||
      (comma && !cli_read_integer(&seed, comma + 1, 0, INT64_MAX)))
    return cli_usage(cli, "--%s '%s' is not D or D,SEED: voxels, 0 or more, and a whole number", option->name,
                     value);
  options->seed = (uint64_t)seed;
  return CLI_END;
}

int cli_engine_check(cli_run *cli, const cli_engine *engine) {
  bool is_auto = engine->name && strcmp(engine->name, "auto") == 0;
  bool is_opencl = engine->name && strncmp(engine->name, "opencl", 6) == 0;
  bool is_slicing = cli_is_given(cli, "gl-axis") || cli_is_given(cli, "gl-displace");
  bool is_opengl = engine->name && strncmp(engine->name, "opengl", 6) == 0;
  if (!is_opencl && !is_auto && (engine->options.device || cli_is_given(cli, "cl-method")))
    return cli_usage(cli, "--device and --cl-method go with --engine opencl");
  if (is_opencl && engine->options.device && strcmp(engine->name, "opencl") != 0)
    return cli_usage(cli, "--engine %s names a device already; leave out --device", engine->name);
  if (!is_opengl && (is_slicing || cli_is_given(cli, "gl-method")))
    return cli_usage(cli, "options that begin with --gl go with --engine opengl");
  if (is_slicing && engine->options.gl_method == VXM_GL_COLUMNS)
    return cli_usage(cli, "--gl-axis and --gl-displace go with --gl-method slices or tetra-vertex");
  return CLI_END;
}

vxm_status cli_engine_open(cli_run *cli, cli_engine *engine) {
  if (!engine->name)
    return VXM_OK;
  return vxm_engine_create(&engine->engine, cli->context, engine->name, &engine->options, &cli->error);
}

void cli_engine_summarize(const cli_run *cli, const cli_engine *engine) {
  const vxm_engine_info *info = vxm_engine_describe(engine->engine);
  if (!info)
    return;
  cli_row(cli, "engine", "%s%s%s%s%s%s", info->name, *info->renderer ? " on " : "", info->renderer,
          *info->note ? " (" : "", info->note, *info->note ? ")" : "");
}

void cli_engine_warn(cli_run *cli, const cli_engine *engine) {
  const vxm_engine_info *info = vxm_engine_describe(engine->engine);
  if (info && info->lost_devices > 0)
    cli_warn(cli, "%s", info->note);
}

json_t *cli_engine_json(const cli_engine *engine) {
  const vxm_engine_info *info = vxm_engine_describe(engine->engine);
  json_t *object = json_object();
  json_object_set_new(object, "name", json_string(info->name));
  json_object_set_new(object, "renderer", cli_json_text(info->renderer));
  json_object_set_new(object, "note", cli_json_text(info->note));
  json_object_set_new(object, "devices", json_integer(info->devices));
  json_object_set_new(object, "lost_devices", json_integer(info->lost_devices));
  return object;
}
