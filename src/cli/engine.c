/* SPDX-License-Identifier: BSD-3-Clause */
/** The options that say which engine makes the voxels. */
#include "cli/engine.h"

#include <string.h>

const char *const cli_cl_methods[] = {"auto", "triangles", "tiles", NULL};
const char *const cli_gl_methods[] = {"columns", "slices", "tetra-vertex", NULL};

static int read_displacement(cli_run *cli, cli_engine *out, const char *value) {
  char text[64];
  const char *comma = strchr(value, ',');
  int64_t seed = 0;
  size_t length = comma ? (size_t)(comma - value) : strlen(value);
  snprintf(text, sizeof text, "%.*s", (int)(length < sizeof text ? length : sizeof text), value);
  if (!cli_read_number(&out->options.displacement, text) || out->options.displacement < 0 ||
      (comma && !cli_read_integer(&seed, comma + 1, 0, INT64_MAX)))
    return cli_usage(cli, "--gl-displace '%s' is not D or D,SEED: voxels, 0 or more, and a whole number",
                     value);
  out->options.seed = (uint64_t)seed;
  return CLI_END;
}

int cli_engine_read(cli_run *cli, cli_engine *out, int key, const char *value) {
  static const char *const axes[] = {"x", "y", "z", NULL};
  int choice = 0, result;
  switch (key) {
  case CLI_KEY_ENGINE:
    out->name = value;
    return CLI_END;
  case CLI_KEY_DEVICE:
    out->options.device = value;
    return CLI_END;
  case CLI_KEY_CL_METHOD:
    out->is_cl_tuned = true;
    result = cli_choose(cli, &choice, "cl-method", value, cli_cl_methods);
    out->options.cl_method = (vxm_cl_method)choice;
    return result;
  case CLI_KEY_GL_METHOD:
    out->is_tuned = true;
    result = cli_choose(cli, &choice, "gl-method", value, cli_gl_methods);
    out->options.gl_method = (vxm_gl_method)choice;
    return result;
  case CLI_KEY_GL_AXIS:
    out->is_slicing = true;
    result = cli_choose(cli, &choice, "gl-axis", value, axes);
    out->options.slice_axis = choice;
    return result;
  default:
    out->is_slicing = true;
    return read_displacement(cli, out, value);
  }
}

int cli_engine_check(cli_run *cli, const cli_engine *engine) {
  bool is_auto = engine->name && strcmp(engine->name, "auto") == 0;
  bool is_opencl = engine->name && strncmp(engine->name, "opencl", 6) == 0;
  bool is_opengl = engine->name && strncmp(engine->name, "opengl", 6) == 0;
  if (!is_opencl && !is_auto && (engine->options.device || engine->is_cl_tuned))
    return cli_usage(cli, "--device and --cl-method go with --engine opencl");
  if (is_opencl && engine->options.device && strcmp(engine->name, "opencl") != 0)
    return cli_usage(cli, "--engine %s names a device already; leave out --device", engine->name);
  if (!is_opengl && (engine->is_tuned || engine->is_slicing))
    return cli_usage(cli, "options that begin with --gl go with --engine opengl");
  if (engine->is_slicing && engine->options.gl_method == VXM_GL_COLUMNS)
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
