/* SPDX-License-Identifier: BSD-3-Clause */
/** The options of binvox, which are words behind one dash, and its help. */
#include "cli/binvox.h"

#include <string.h>

const char *const binvox_types[BINVOX_TYPES + 1] = {"binvox", "nrrd", "raw", "vtk", "schematic", "msh", NULL};

typedef enum option {
  VOXELS,
  TYPE,
  OUTPUT,
  CARVING,
  DILATED,
  VOTING,
  EXACT,
  BOX,
  CENTRED,
  TURN_X,
  TURN_Y,
  TURN_Z,
  WIREFRAME,
  INTERNAL,
  FITTED,
  HALVE,
  LEAST,
  BLOCK,
  MATERIALS,
  PBUFFER,
  OPTIONS
} option;

static const struct {
  const char *name, *argument, *help;
  int values;
} options[OPTIONS] = {
    [VOXELS] = {"-d", "N", "voxels along each axis [256]", 1},
    [TYPE] = {"-t", "TYPE", "binvox, nrrd, raw, vtk, schematic or msh [binvox]", 1},
    [OUTPUT] = {"-o", "FILE", "write this file, rather than one beside the model", 1},
    [CARVING] = {"-c", "", "the solid, and what cannot be seen along an axis from outside", 0},
    [DILATED] = {"-dc", "", "the same, thicker by one voxel", 0},
    [VOTING] = {"-v", "", "what two of the parities along x, y and z call inside", 0},
    [EXACT] = {"-e", "", "each voxel that a face touches, and nothing inside", 0},
    [BOX] = {"-bb", "X0 Y0 Z0 X1 Y1 Z1", "take this box for the model's", 6},
    [CENTRED] = {"-cb", "", "centre the model in the cube of voxels", 0},
    [TURN_X] = {"-rotx", "", "turn the model by 90 degrees about x first, anticlockwise", 0},
    [TURN_Y] = {"-roty", "", "about y, anticlockwise", 0},
    [TURN_Z] = {"-rotz", "", "about z, clockwise; all may be given several times, in order", 0},
    [WIREFRAME] = {"-aw", "", "the surface too, thin", 0},
    [INTERNAL] = {"-ri", "", "leave out voxels with six neighbours", 0},
    [FITTED] = {"-fit", "", "write the box of the voxels that are set alone", 0},
    [HALVE] = {"-down", "", "make one voxel of 2 x 2 x 2; may be given several times", 0},
    [LEAST] = {"-dmin", "N", "how many of these eight have to be set [4]", 1},
    [BLOCK] = {"-bi", "ID", "the block of a schematic, 1 to 255 [1]", 1},
    [MATERIALS] = {"-mb", "", "with -e and -t schematic: blocks by material, such as usemtl blockid_35", 0},
    [PBUFFER] = {"-pb", "", "nothing: no window is needed", 0},
};

static void print_usage(void) {
  printf(
      "Usage: binvox [OPTION]... MODEL\n"
      "       voxmend binvox [OPTION]... MODEL\n"
      "Voxelizes a mesh as binvox's command line says, and writes MODEL.binvox beside it, or MODEL_1.binvox\n"
      "where that is there already, and so on.\n\nOptions:\n");
  for (int i = 0; i < OPTIONS; i++) {
    char text[40];
    snprintf(text, sizeof text, "%s %s", options[i].name, options[i].argument);
    printf("  %-24s %s\n", text, options[i].help);
  }
}

void binvox_print_help(void) {
  print_usage();
  printf("\nWithout -c, -v and -e the solid is that of 'voxmend voxelize': what is inside, holes closed, and "
         "thin\n"
         "parts kept. The model is repaired first. doc/binvox.md has the differences from binvox.\n\n"
         "Examples:\n"
         "  binvox -d 64 -cb chair.off\n"
         "  binvox -e -bb -0.5 -0.5 -0.5 0.5 0.5 0.5 -d 128 model.obj\n"
         "  binvox -c -d 200 -t vtk plane.ply\n");
}

/* ---- Values ---- */

static int read_type(cli_run *cli, binvox_request *out, const char *value) {
  char list[CLI_LIST_MAX];
  int found = cli_read_choice(value, binvox_types);
  cli_list(list, binvox_types);
  if (found < 0 && (strcmp(value, "hips") == 0 || strcmp(value, "mira") == 0))
    return cli_usage(cli, "-t %s: this format of binvox is not written here; there are %s", value, list);
  if (found < 0)
    return cli_usage(cli, "-t '%s' is none of %s", value, list);
  out->type = (binvox_type)found;
  return CLI_END;
}

static int read_box(cli_run *cli, binvox_request *out, char **values) {
  for (int i = 0; i < 6; i++)
    if (!cli_read_number(&out->box[i], values[i]))
      return cli_usage(cli, "-bb: '%s' is not a number", values[i]);
  for (int axis = 0; axis < 3; axis++)
    if (!(out->box[axis] < out->box[axis + 3]))
      return cli_usage(cli, "-bb: the box is empty along %c", 'x' + axis);
  out->has_box = true;
  return CLI_END;
}

static int read_number(cli_run *cli, int64_t *out, const char *name, const char *value, int64_t most) {
  return cli_read_integer(out, value, 1, most)
             ? CLI_END
             : cli_usage(cli, "%s '%s' is not a number from 1 to %lld", name, value, (long long)most);
}

static int add_turn(cli_run *cli, binvox_request *out, char axis) {
  size_t count = strlen(out->turns);
  if (count == BINVOX_TURNS_MAX)
    return cli_usage(cli, "more than %d turns", BINVOX_TURNS_MAX);
  out->turns[count] = axis;
  out->turns[count + 1] = '\0';
  return CLI_END;
}

static int take(cli_run *cli, binvox_request *out, int which, char **values) {
  bool *const flags[OPTIONS] = {[CARVING] = &out->carving,        [DILATED] = &out->dilated,
                                [VOTING] = &out->voting,          [EXACT] = &out->exact,
                                [CENTRED] = &out->centred,        [WIREFRAME] = &out->wireframe,
                                [INTERNAL] = &out->internal_gone, [FITTED] = &out->fitted,
                                [MATERIALS] = &out->materials};
  switch (which) {
  case VOXELS:
    return read_number(cli, &out->voxels, "-d", values[0], 1 << 20);
  case TYPE:
    return read_type(cli, out, values[0]);
  case OUTPUT:
    out->output = values[0];
    return CLI_END;
  case BOX:
    return read_box(cli, out, values);
  case TURN_X:
  case TURN_Y:
  case TURN_Z:
    return add_turn(cli, out, (char)('x' + which - TURN_X));
  case HALVE:
    out->halvings++;
    return CLI_END;
  case LEAST:
    return read_number(cli, &out->least, "-dmin", values[0], 8);
  case BLOCK:
    return read_number(cli, &out->block, "-bi", values[0], 255);
  default:
    if (flags[which])
      *flags[which] = true;
    return CLI_END;
  }
}

/* ---- Words ---- */

static int find(const char *word) {
  for (int i = 0; i < OPTIONS; i++)
    if (strcmp(word, options[i].name) == 0)
      return i;
  return -1;
}

/** Options that some binvox has or had, and why there are none here. */
static const char *const gone[][2] = {
    {"-nf", "the model fills the cube; -bb makes room around it"},
    {"-dilate", "-dc dilates by one voxel"},
    {"-rx", "turns by 90 degrees are -rotx, -roty and -rotz"},
    {"-ry", "turns by 90 degrees are -rotx, -roty and -rotz"},
    {"-rz", "turns by 90 degrees are -rotx, -roty and -rotz"},
    {"-ncs", "what it does in binvox is described nowhere"},
};

static int refuse_option(cli_run *cli, const char *word) {
  for (size_t i = 0; i < sizeof gone / sizeof gone[0]; i++)
    if (strcmp(word, gone[i][0]) == 0)
      return cli_usage(cli, "%s is not taken: %s", word, gone[i][1]);
  char hint[CLI_LIST_MAX];
  const char *names[OPTIONS + 1] = {NULL};
  for (int i = 0; i < OPTIONS; i++)
    names[i] = options[i].name + 1;
  return cli_usage(cli, "unknown option %s%s", word, cli_suggestion(hint, word + 1, "-", names));
}

static bool asks_for_help(const char *word) {
  return strcmp(word, "-h") == 0 || strcmp(word, "-help") == 0 || strcmp(word, "--help") == 0;
}

/** Takes the word at cli->argv[*index] with its values. */
static int take_word(cli_run *cli, binvox_request *out, int *index) {
  const char *word = cli->argv[*index];
  if (word[0] != '-' || !word[1]) {
    if (out->model)
      cli_warn(cli, "'%s' is not read: the last name is the model", out->model);
    out->model = word;
    return CLI_END;
  }
  if (asks_for_help(word)) {
    binvox_print_help();
    cli->status = CLI_DONE;
    return CLI_STOP;
  }
  if (strcmp(word, "-license") == 0 || strcmp(word, "-gpl") == 0) {
    printf("This binvox is a part of voxmend %s, and has its licence: BSD-3-Clause. It shares nothing but "
           "the command\n"
           "line with the program of Patrick Min.\n",
           vxm_version());
    cli->status = CLI_DONE;
    return CLI_STOP;
  }
  int which = find(word);
  if (which < 0)
    return refuse_option(cli, word);
  if (cli->argc - 1 - *index < options[which].values)
    return cli_usage(cli, "option %s needs %s", word, options[which].argument);
  *index += options[which].values;
  return take(cli, out, which, cli->argv + *index - options[which].values + 1);
}

static int check(cli_run *cli, const binvox_request *given) {
  if (given->materials && given->type == BINVOX_SCHEMATIC && !given->exact)
    return cli_usage(cli, "-mb: the blocks of a schematic are those of faces, which goes with -e");
  if (given->output && strcmp(given->output, "-") == 0)
    return cli_usage(cli, "-o names a file; what is printed goes to standard output");
  if (strcmp(given->model, "-") == 0 && !given->output)
    return cli_usage(cli, "a model from standard input needs -o FILE");
  if (given->exact && given->dilated)
    cli_warn(cli, "-e makes a surface: -dc is not applied");
  return CLI_END;
}

int binvox_read_arguments(cli_run *cli, binvox_request *out) {
  *out = (binvox_request){.voxels = 256, .least = 4, .block = 1};
  for (int i = 1; i < cli->argc; i++)
    if (take_word(cli, out, &i) == CLI_STOP)
      return CLI_STOP;
  if (!out->model)
    return cli_usage(cli, "a model is missing");
  return check(cli, out);
}
