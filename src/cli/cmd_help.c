/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend help: the commands, the options of one, and both as a table for the completion of shells. */
#include "cli/cli.h"

#include <string.h>

typedef struct request {
  bool is_table, is_all;
} request;

static const cli_option known_options[] = {
    {0, "table", NULL,
     "as lines with tabs, for programs: the names of the commands with what they do,\n"
     "or the options of one, each with its letter, what it takes, and what it is for",
     CLI_FLAG(request, is_table)},
    {0, "all", NULL, "the same with the options of another command that one takes too",
     CLI_FLAG(request, is_all)},
    CLI_OPTIONS_END};

void cli_help_overview(void) {
  printf("Usage: voxmend COMMAND [ARGUMENT]...\n"
         "Repairs messy meshes and turns them into voxel grids.\n\nCommands:\n");
  for (int i = 0; cli_commands[i]; i++)
    printf("  %-10s %s\n", cli_commands[i]->name, cli_commands[i]->summary);
  printf("\n'voxmend help COMMAND' shows the options of a command; 'voxmend --version' the version.\n"
         "Meshes: .off .obj .stl .ply; where built with them, also .gltf .glb .3mf .dae .fbx .3ds and more\n"
         "(Assimp), .step and .iges (OpenCASCADE). Grids: .binvox .npy .raw .rle .nrrd .octree\n"
         ".nii .nii.gz .vti .vtk .tif .zarr .vox .schem .litematic, .vdb (OpenVDB), .bt (OctoMap),\n"
         ".h5 (HDF5) and, to write, .glb. Slices as pictures: slice_%%04d.png, .tif.\n"
         "'-' is standard input or output.\n\n"
         "Examples:\n"
         "  voxmend info chair.off                              what is wrong with it\n"
         "  voxmend repair chair.off -o fixed.ply               mend what can be mended\n"
         "  voxmend remesh chair.off -o smooth.ply -r 128       a closed surface around all of it\n"
         "  voxmend voxelize chair.off -o chair.binvox -r 64    64 x 64 x 64 voxels\n"
         "  voxmend view chair.binvox -o chair.png              look at them\n");
}

const cli_command *cli_find_command(const char *name) {
  for (int i = 0; cli_commands[i]; i++)
    if (strcmp(name, cli_commands[i]->name) == 0)
      return cli_commands[i];
  return NULL;
}

const char *cli_suggest_command(char text[CLI_LIST_MAX], const char *typed) {
  const char *names[CLI_COMMANDS_MAX + 1];
  int count = 0;
  for (; cli_commands[count] && count < CLI_COMMANDS_MAX; count++)
    names[count] = cli_commands[count]->name;
  names[count] = NULL;
  return cli_suggestion(text, typed, "", names);
}

static void print_table(const cli_command *command, bool is_all) {
  if (command) {
    cli_help_table(command, is_all);
    return;
  }
  for (int i = 0; cli_commands[i]; i++)
    printf("%s\t%s\n", cli_commands[i]->name, cli_commands[i]->summary);
}

static int run(cli_run *cli) {
  char hint[CLI_LIST_MAX];
  request given = {false, false};
  if (cli_read_options(cli, &given) == CLI_STOP)
    return cli->status;
  if (cli->argument_count > 1)
    cli_usage(cli, "one command is expected, not %d", cli->argument_count);
  const char *name = cli->argument_count > 0 ? cli->arguments[0] : NULL;
  const cli_command *command = name ? cli_find_command(name) : NULL;
  if (name && !command && cli->status == 0)
    cli_usage(cli, "unknown command '%s'%s", name, cli_suggest_command(hint, name));
  if (cli->status != 0)
    return cli->status;
  if (given.is_table || given.is_all)
    print_table(command, given.is_all);
  else if (command)
    cli_help(command);
  else
    cli_help_overview();
  return CLI_DONE;
}

const cli_command cli_command_help = {
    .name = "help",
    .arguments = "[COMMAND] [--table|--all]",
    .summary = "show the commands, or the options of one",
    .notes = "'man voxmend' has more to say, and so has the page of each command, such as 'man "
             "voxmend-voxelize'.\n\n"
             "Examples:\n"
             "  voxmend help\n"
             "  voxmend help voxelize",
    .options = known_options,
    .run = run,
};
