/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend: finds the subcommand, runs it and ends with its exit status. */
#include "cli/cli.h"

#include <errno.h>
#include <signal.h>
#include <string.h>

static const cli_command *const commands[] = {
    &cli_command_info,    &cli_command_repair,  &cli_command_remesh,  &cli_command_voxelize,
    &cli_command_convert, &cli_command_compare, &cli_command_augment, &cli_command_batch,
    &cli_command_view,    &cli_command_bench,   &cli_command_engines};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void help(void) {
  printf("Usage: voxmend COMMAND [ARGUMENT]...\n"
         "Repairs messy meshes and turns them into voxel grids.\n\nCommands:\n");
  for (int i = 0; i < COMMANDS; i++)
    printf("  %-10s %s\n", commands[i]->name, commands[i]->summary);
  printf("\n'voxmend COMMAND --help' shows the options of a command; 'voxmend --version' the version.\n"
         "Meshes: .off .obj .stl .ply; where built with them, also .gltf .glb .3mf .dae .fbx .3ds and more\n"
         "(Assimp), .step and .iges (OpenCASCADE). Grids: .binvox .npy .raw .rle .nrrd, and .vdb (OpenVDB).\n"
         "'-' is standard input or output.\n\n"
         "Examples:\n"
         "  voxmend info chair.off                              what is wrong with it\n"
         "  voxmend repair chair.off -o fixed.ply               mend what can be mended\n"
         "  voxmend remesh chair.off -o smooth.ply -r 128       a closed surface around all of it\n"
         "  voxmend voxelize chair.off -o chair.binvox -r 64    64 x 64 x 64 voxels\n"
         "  voxmend view chair.binvox -o chair.png              look at them\n");
}

static const cli_command *find_command(const char *name) {
  for (int i = 0; i < COMMANDS; i++)
    if (strcmp(name, commands[i]->name) == 0)
      return commands[i];
  return NULL;
}

/** What was printed may still be lost when it is flushed, on a full disk for one. */
static int flush_output(cli_run *cli, int status) {
  if (fflush(stdout) == 0 && !ferror(stdout))
    return status;
  int reason = errno;
  return status == CLI_DONE || status == CLI_WARNED
             ? cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(reason))
             : status;
}

static int run(const cli_command *command, int argc, char **argv, cli_capture *capture) {
  cli_run cli = {.command = command,
                 .argc = argc,
                 .argv = argv,
                 .progress = "auto",
                 .limits = VXM_CONTEXT_OPTIONS_INIT,
                 .read = VXM_MESH_READ_OPTIONS_INIT,
                 .error = VXM_ERROR_INIT,
                 .warnings = json_array(),
                 .capture = capture,
                 .text = stdout};
  if (capture)
    cli.read.format = capture->format;
  int status = flush_output(&cli, command->run(&cli));
  vxm_context_drop_files(cli.context); /* a failed run leaves no output file */
  vxm_context_destroy(cli.context);
  json_decref(cli.warnings);
  if (capture)
    capture->error = cli.error;
  return status;
}

int cli_run_command(const char *name, int count, char **words, cli_capture *capture) {
  const cli_command *command = find_command(name);
  return command ? run(command, count, words, capture) : CLI_WRONG_USAGE;
}

int main(int argc, char **argv) {
  cli_run none = {0};
  if (argc < 2) {
    cli_usage(&none, "a command is missing");
    return none.status;
  }
  const char *name = argv[1];
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
    help();
    return flush_output(&none, CLI_DONE);
  }
  if (strcmp(name, "--version") == 0) {
    printf("voxmend %s\n", vxm_version());
    return flush_output(&none, CLI_DONE);
  }
  const cli_command *command = find_command(name);
  if (!command) {
    cli_usage(&none, name[0] == '-' ? "unknown option %s" : "unknown command '%s'", name);
    return none.status;
  }
  cli_json_start();
  signal(SIGXFSZ, SIG_IGN); /* a write beyond ulimit -f fails, and says so */
  int status = run(command, argc - 1, argv + 1, NULL);
  if (status == CLI_FAILED && cli_signal()) {
    signal(cli_signal(), SIG_DFL); /* ends as the sender of the signal expects */
    raise(cli_signal());
  }
  return status;
}
