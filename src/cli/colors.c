/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend voxelize --color: a colour per voxel. */
#include "cli/field.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { SOURCE_MAX = 1 << 20 };

/** The text of a file of GLSL; NULL after a failure, which is in cli->error. */
static char *read_source(cli_run *cli, const char *path) {
  FILE *file = fopen(path, "rb");
  char *text = file ? malloc(SOURCE_MAX + 1) : NULL;
  size_t size = text ? fread(text, 1, SOURCE_MAX + 1, file) : 0;
  bool is_read = text && !ferror(file) && size <= SOURCE_MAX && !memchr(text, 0, size);
  int reason = errno;
  if (file)
    fclose(file);
  if (is_read) {
    text[size] = '\0';
    return text;
  }
  free(text);
  cli->error.code = VXM_ERROR_IO;
  snprintf(cli->error.text, sizeof cli->error.text, "%.200s: cannot read the colour function: %s", path,
           file && size > SOURCE_MAX ? "it has more than 1 MiB"
           : file && size > 0        ? "it is no text"
                                     : strerror(reason));
  return NULL;
}

int cli_take_color(cli_run *cli, const cli_option *option, const char *value, void *member) {
  static const char *const choices[] = {"noise", "position", "part", "mesh", NULL};
  static const vxm_color_by by[] = {VXM_COLOR_NOISE, VXM_COLOR_POSITION, VXM_COLOR_PART, VXM_COLOR_MESH};
  cli_field *field = member;
  int choice = cli_read_choice(value, choices);
  char list[CLI_LIST_MAX];
  bool is_function = cli_is_extension(value, "frag");
  if (choice < 0 && !is_function && !strchr(value, '.'))
    return cli_usage(cli, "--%s '%s' is none of %s, and no FILE.frag or FILE.nrrd", option->name, value,
                     cli_list(list, choices));
  field->color_name = value;
  field->color_options.by = choice >= 0 ? by[choice] : is_function ? VXM_COLOR_GLSL : VXM_COLOR_VOLUME;
  cli->read.colors = field->color_options.by == VXM_COLOR_MESH;
  return CLI_END;
}

void cli_color_name_mesh(cli_run *cli, const char *path) {
  char text[sizeof cli->error.text];
  snprintf(text, sizeof text, "%.200s: %.300s", path, cli->error.text);
  memcpy(cli->error.text, text, sizeof text);
}

vxm_status cli_color_write(cli_run *cli, cli_field *field, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const char *path, const char *format) {
  vxm_color_options options = field->color_options;
  char *source = NULL;
  vxm_field *volume = NULL;
  options.format = format;
  if (options.by == VXM_COLOR_VOLUME) {
    vxm_status read = vxm_field_read(&volume, cli->context, field->color_name, &cli->error);
    if (read != VXM_OK)
      return read;
    for (int64_t i = 0; i < vxm_field_warning_count(volume); i++)
      cli_warn(cli, "%s: %s", field->color_name, vxm_field_warning(volume, i));
    options.volume = volume;
  }
  if (options.by == VXM_COLOR_GLSL) {
    source = read_source(cli, field->color_name);
    if (!source)
      return VXM_ERROR_IO;
    options.source = source;
  }
  vxm_status status = vxm_model_write_colors(report, model, space, path, &options, &cli->error);
  free(source);
  if (status == VXM_ERROR_ARGUMENT && (options.by == VXM_COLOR_MESH || options.by == VXM_COLOR_VOLUME))
    cli_color_name_mesh(cli, volume ? field->color_name : field->color_mesh);
  vxm_field_destroy(volume);
  return status;
}

void cli_color_take(cli_field *field, const cli_input *input) {
  field->color_mesh = cli_shown(input->path, "<stdin>");
  field->color_options.mesh = input->as_read ? input->as_read : input->mesh;
}
