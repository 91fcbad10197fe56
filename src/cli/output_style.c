/* SPDX-License-Identifier: BSD-3-Clause */
/** How an output is written, in options that several commands have, and whether its format heeds them. */
#include "cli/cli.h"

#include <string.h>
#include <sys/stat.h>

int cli_check_polygons(cli_run *cli, bool keep_polygons, const char *format) {
  static const char *const of_polygons[] = {"obj", "ply", "off", NULL};
  if (keep_polygons && cli_read_choice(format, of_polygons) < 0)
    return cli_usage(cli, "--polygons keep goes with .obj, .ply and .off, not .%s", format);
  return CLI_END;
}

int cli_check_style(cli_run *cli, const vxm_grid_write_options *write) {
  static const char *const blocks[] = {"schem", "litematic", NULL};
  static const char *const turned[] = {"schem", "litematic", "glb", NULL};
  const char *format = write->format;
  if (write->blocks && cli_read_choice(format, blocks) < 0)
    return cli_usage(cli, "--blocks goes with .schem and .litematic, not .%s", format);
  if (write->up && cli_read_choice(format, turned) < 0)
    return cli_usage(cli, "--up goes with .schem, .litematic and .glb, not .%s", format);
  if (cli_check_polygons(cli, write->keep_polygons, format) == CLI_STOP)
    return CLI_STOP;
  if (write->keep_contacts && cli_read_choice(format, cli_mesh_formats) < 0)
    return cli_usage(cli, "--no-manifold goes with .obj, .ply, .stl and .off, not .%s", format);
  return CLI_END;
}

int cli_check_surface_file(cli_run *cli, const char *path, const char *format) {
  struct stat info;
  bool is_mesh = cli_read_choice(format, cli_mesh_formats) >= 0 ||
                 (vxm_grid_format_traits(format) & VXM_FORMAT_SURFACE) != 0;
  if (cli_is_given(cli, "force") || !is_mesh || strcmp(path, "-") == 0 || stat(path, &info) != 0 ||
      !S_ISREG(info.st_mode))
    return CLI_END;
  return cli_usage(cli, "%s is there already, and may be a mesh that is still needed; --force replaces it",
                   path);
}

int cli_check_grid_output(cli_run *cli, const char *path, vxm_grid_write_options *write, cli_formats formats,
                          bool may_be_labels) {
  write->format = cli_output_format(cli, path, write->format, formats.name);
  if (!write->format)
    return CLI_STOP;
  cli_writes(cli, "-o", path, cli_has_json(write->format, may_be_labels));
  if (cli_check_names(cli) == CLI_STOP || cli_check_style(cli, write) == CLI_STOP)
    return CLI_STOP;
  return cli_check_surface_file(cli, path, write->format);
}
