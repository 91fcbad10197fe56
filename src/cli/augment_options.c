/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: its options. */
#include "cli/augment.h"
#include "cli/voxelize_common.h"

#include <string.h>

enum {
  KEY_FORMAT = CLI_KEY_COMMAND,
  KEY_FIRST,
  KEY_SEED,
  KEY_EPOCH,
  KEY_MODEL,
  KEY_PAD,
  KEY_ROTATE,
  KEY_SCALE,
  KEY_DISPLACE,
  KEY_NOISE,
  KEY_MIRROR,
  KEY_TRANSLATE,
  KEY_FILL,
  KEY_MODE,
  KEY_SURFACE,
  KEY_THIN,
  KEY_NO_REPAIR,
  KEY_WELD,
  KEY_KEEP,
  KEY_COVERAGE,
  KEY_FORCE
};

const cli_option augment_options[] = {
    {'o', "output", "DIR|-",
     "folder for a file of each variant, 000000.rle and so on (of several meshes: for\n"
     "a folder of each), or - for a stream of records of equal size on standard output"},
    {KEY_FORMAT, "format", "F",
     "of files: rle, raw, binvox, npy or nrrd [rle]; of a stream: bits, uint8 or\n"
     "float32 [bits]"},
    {'n', "count", "N", "how many variants [16]; 0 with -o -: no end, until the reader has enough"},
    {KEY_FIRST, "first", "I", "the number of the first one [0]"},
    {KEY_FORCE, "force", NULL, "replace variants of a former run: those in DIR with this number or above go"},
    {KEY_SEED, "seed", "S", "of the random numbers, up to 2^63 - 1 [0]"},
    {KEY_EPOCH, "epoch", "E", "another epoch gives other variants [0]"},
    {KEY_MODEL, "model", "M",
     "number of the model, or of the first of several; seed, epoch and model number\n"
     "together determine the variants [0]"},
    {'r', "resolution", "N", "voxels along each axis, up to 4096 [64]"},
    {KEY_COVERAGE, "coverage", "2|4|8",
     "a number for each voxel: how much of it is filled, from so many sub-voxels along\n"
     "each axis; in files (npy, nrrd) and as uint8 0 to 255, as float32 0 to 1"},
    {KEY_PAD, "pad", "P", "keep P voxels free on each side, before the model is moved [0]"},
    {KEY_ROTATE, "rotate", "none|any|x|y|z|X,Y,Z|FILE",
     "not at all; uniform over all rotations; about an axis; or by the matrices of\n"
     "a file, one after another: nine numbers each, row after row [none]"},
    {KEY_SCALE, "scale", "F", "scale each axis by a factor of its own, from 1 - F to 1 + F; F below 1 [0]"},
    {KEY_DISPLACE, "displace", "F[,normal]",
     "displace vertices along each axis by up to this part of the width of the grid;\n"
     "with normal, by a normal distribution of that deviation [0]"},
    {KEY_NOISE, "noise", "N", "displacements in the buffer that all variants read [65536]"},
    {KEY_MIRROR, "mirror", "AXES", "mirror half of the variants along each of these axes, such as x or xyz"},
    {KEY_TRANSLATE, "translate", "F", "move by up to this part, 0 to 1, of the room on each side [0]"},
    {KEY_FILL, "fill", NULL, "the longest side fills the grid, not the diagonal; without --rotate only"},
    {KEY_MODE, "mode", "solid|surface|both", "as in 'voxmend voxelize' [solid]"},
    {KEY_SURFACE, "surface", "KIND", "as in 'voxmend voxelize' [conservative]"},
    {KEY_THIN, "thin", "keep|drop|26", "parts thinner than a voxel: as in 'voxmend voxelize' [keep]"},
    {KEY_NO_REPAIR, "no-repair", NULL, "take the mesh as it is in the file"},
    {KEY_WELD, "weld", "auto|off|EPS", "as in 'voxmend repair' [auto]"},
    {KEY_KEEP, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it"},
    {CLI_KEY_ENGINE, "engine", "E",
     "what computes the variants, one after another: cpu; or as in 'voxmend voxelize'\n"
     "[cpu]"},
    CLI_OPTIONS_ENGINE_METHODS,
    CLI_OPTIONS_READ,
    {0, NULL, NULL, NULL}};

/** A whole number into *out, or a line about wrong usage. */
static int read_number_of(cli_run *cli, int64_t *out, const char *name, const char *value, int64_t low,
                          int64_t high) {
  if (cli_read_integer(out, value, low, high))
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a number from %lld to %lld", name, value, (long long)low,
                   (long long)high);
}

static int read_part(cli_run *cli, double *out, const char *name, const char *value) {
  if (cli_read_number(out, value) && *out >= 0 && *out <= 1)
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a number from 0 to 1", name, value);
}

static int read_rotate(cli_run *cli, augment_request *out, const char *value) {
  static const char *const names[] = {"none", "any", "x", "y", "z", NULL};
  vxm_sampler_options *sampler = &out->sampler;
  int choice = cli_read_choice(value, names);
  memset(sampler->axis, 0, sizeof sampler->axis);
  out->rotations = NULL;
  sampler->rotation = choice == 0 ? VXM_ROTATION_NONE : choice == 1 ? VXM_ROTATION_ANY : VXM_ROTATION_AXIS;
  if (choice >= 2)
    sampler->axis[choice - 2] = 1;
  if (choice >= 0)
    return CLI_END;
  if (cli_read_numbers(sampler->axis, 3, value)) {
    const double *axis = sampler->axis;
    if (axis[0] == 0 && axis[1] == 0 && axis[2] == 0)
      return cli_usage(cli, "--rotate '%s' is no axis", value);
    return CLI_END;
  }
  out->rotations = value;
  sampler->rotation = VXM_ROTATION_LIST;
  return CLI_END;
}

static int read_displace(cli_run *cli, augment_request *out, const char *value) {
  static const char suffix[] = ",normal";
  char number[64];
  size_t length = strlen(value), behind = sizeof suffix - 1;
  bool normal = length > behind && strcmp(value + length - behind, suffix) == 0;
  out->sampler.displacement = normal ? VXM_DISPLACEMENT_NORMAL : VXM_DISPLACEMENT_UNIFORM;
  snprintf(number, sizeof number, "%.*s", (int)(normal ? length - behind : length), value);
  if (cli_read_number(&out->sampler.displace, number) && out->sampler.displace >= 0 &&
      out->sampler.displace <= 1)
    return CLI_END;
  return cli_usage(cli, "--displace '%s' is not a number from 0 to 1, with or without ',normal'", value);
}

static int read_mirror(cli_run *cli, augment_request *out, const char *value) {
  out->sampler.mirror = 0;
  for (const char *c = value; *c; c++) {
    if (*c < 'x' || *c > 'z')
      return cli_usage(cli, "--mirror '%s' names other axes than x, y and z", value);
    out->sampler.mirror |= 1U << (*c - 'x');
  }
  return CLI_END;
}

static int read_coverage(cli_run *cli, augment_request *out, const char *value) {
  static const char *const counts[] = {"2", "4", "8", NULL};
  int choice;
  if (cli_choose(cli, &choice, "coverage", value, counts) == CLI_STOP)
    return CLI_STOP;
  out->sampler.coverage = 2 << choice;
  return CLI_END;
}

static int read_option(cli_run *cli, augment_request *out, int key, const char *value) {
  const int64_t most = UINT32_MAX;
  int64_t number = 0;
  int result = CLI_END;
  switch (key) {
  case 'o':
    out->output = value;
    return CLI_END;
  case KEY_FORMAT:
    out->format = value;
    return CLI_END;
  case 'n':
    return read_number_of(cli, &out->count, "count", value, 0, most);
  case KEY_FIRST:
    return read_number_of(cli, &out->first, "first", value, 0, most);
  case KEY_FORCE:
    out->force = true;
    return CLI_END;
  case KEY_SEED:
    result = read_number_of(cli, &number, "seed", value, 0, INT64_MAX);
    out->sampler.seed = (uint64_t)number;
    return result;
  case KEY_EPOCH:
    result = read_number_of(cli, &number, "epoch", value, 0, most);
    out->variant.epoch = (uint32_t)number;
    return result;
  case KEY_MODEL:
    result = read_number_of(cli, &number, "model", value, 0, most);
    out->variant.model = (uint32_t)number;
    return result;
  case 'r':
    return read_number_of(cli, &out->sampler.resolution, "resolution", value, 1, 4096);
  case KEY_PAD:
    return read_number_of(cli, &out->sampler.pad, "pad", value, 0, 2047);
  case KEY_ROTATE:
    return read_rotate(cli, out, value);
  case KEY_SCALE:
    if (!cli_read_number(&out->sampler.scale, value) || out->sampler.scale < 0 || out->sampler.scale >= 1)
      return cli_usage(cli, "--scale '%s' is not a number from 0 to below 1", value);
    return CLI_END;
  case KEY_DISPLACE:
    return read_displace(cli, out, value);
  case KEY_NOISE:
    out->noise = true;
    result = read_number_of(cli, &number, "noise", value, 1, 1 << 24);
    out->sampler.noise = (uint32_t)number;
    return result;
  case KEY_MIRROR:
    return read_mirror(cli, out, value);
  case KEY_TRANSLATE:
    return read_part(cli, &out->sampler.translate, "translate", value);
  case KEY_COVERAGE:
    return read_coverage(cli, out, value);
  case KEY_FILL:
    out->sampler.fill = true;
    return CLI_END;
  case KEY_NO_REPAIR:
    out->no_repair = true;
    return CLI_END;
  case KEY_WELD:
    out->repair_options = true;
    return cli_read_weld(cli, &out->repair, value);
  case KEY_KEEP:
    out->repair_options = out->repair.keep_duplicates = true;
    return CLI_END;
  case CLI_KEY_ENGINE:
  case CLI_KEY_DEVICE:
  case CLI_KEY_CL_METHOD:
  case CLI_KEY_GL_METHOD:
  case CLI_KEY_GL_AXIS:
    return cli_engine_read(cli, &out->engine, key, value);
  case KEY_MODE:
    return cli_read_mode(cli, &out->voxelize, value);
  case KEY_THIN:
    out->thin = true;
    return cli_read_thin(cli, &out->voxelize, value);
  default:
    out->surface = true;
    return cli_read_surface(cli, &out->voxelize, value);
  }
}

bool augment_is_stream(const augment_request *given) {
  return strcmp(given->output, "-") == 0;
}

const char *const augment_file_formats[] = {"rle", "raw", "binvox", "npy", "nrrd", NULL};

/** The format, by default the first one known. */
static int check_format(cli_run *cli, augment_request *given) {
  static const char *const streams[] = {"bits", "uint8", "float32", NULL};
  enum { NUMBERS = 3 /**< the first of the files that hold numbers; of streams it is the second */ };
  char list[CLI_LIST_MAX];
  bool stream = augment_is_stream(given), shares = given->sampler.coverage > 0;
  const char *const *known = stream ? streams + shares : augment_file_formats + (shares ? NUMBERS : 0);
  int choice = given->format ? cli_read_choice(given->format, known) : 0;
  if (choice < 0)
    return cli_usage(cli, "--format '%s' is none of %s, which %s%s", given->format, cli_list(list, known),
                     stream ? "a stream has" : "files have", shares ? " with --coverage" : "");
  given->format = known[choice];
  given->voxels = stream ? (vxm_voxel_format)(choice + shares) : VXM_VOXEL_FORMAT_UINT8;
  if (stream && cli->json)
    return cli_usage(cli, "-o - and --json both want standard output; use --report FILE.json");
  if (stream)
    cli->text = stderr;
  else if (given->count == 0)
    return cli_usage(cli, "-n 0 has no end, which a folder has; it goes with -o -");
  return CLI_END;
}

static int check_conflicts(cli_run *cli, const augment_request *given) {
  const vxm_sampler_options *sampler = &given->sampler;
  if (given->is_several && given->count == 0)
    return cli_usage(cli, "-n 0 has no end, and the second mesh would never come; give -n or one mesh");
  if (given->first + given->count > (int64_t)UINT32_MAX + 1)
    return cli_usage(cli, "--first and -n go beyond variant 4294967295");
  if (sampler->fill && sampler->rotation != VXM_ROTATION_NONE)
    return cli_usage(cli, "--fill leaves no room to rotate in; leave out --rotate");
  if (sampler->coverage > 0 && given->voxelize.mode != VXM_MODE_SOLID)
    return cli_usage(cli, "--coverage goes with --mode solid, which fills voxels");
  if (sampler->coverage > 0 && given->thin)
    return cli_usage(cli, "--coverage counts what is inside, and --thin adds voxels; give one of them");
  if (sampler->resolution * (sampler->coverage > 0 ? sampler->coverage : 1) > 4096)
    return cli_usage(cli, "-r and --coverage make more than 4096 sub-voxels along an axis");
  if (given->force && augment_is_stream(given))
    return cli_usage(cli, "--force replaces files, and -o - writes none");
  if (given->noise && sampler->displace == 0)
    return cli_usage(cli, "--noise goes with --displace");
  if (cli_check_surface(cli, &given->voxelize, given->surface) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_thin(cli, &given->voxelize, given->thin) == CLI_STOP)
    return CLI_STOP;
  return cli_check_repair(cli, given->no_repair, given->repair_options);
}

int augment_read_arguments(cli_run *cli, augment_request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END)
    if (key == CLI_STOP || read_option(cli, out, key, value) == CLI_STOP)
      return CLI_STOP;
  if (cli->argument_count < 1)
    return cli_usage(cli, "a mesh is missing");
  out->is_several = augment_has_several(cli);
  out->input = out->is_several ? NULL : cli->arguments[0];
  if (!out->output)
    return cli_usage(cli, "-o DIR or -o - is missing");
  cli_reads(cli, out->rotations);
  if (augment_is_stream(out))
    cli_writes(cli, "-o", out->output, false);
  if (cli_check_names(cli) == CLI_STOP || cli_engine_check(cli, &out->engine) == CLI_STOP ||
      check_format(cli, out) == CLI_STOP || check_conflicts(cli, out) == CLI_STOP)
    return CLI_STOP;
  if (augment_is_stream(out) || out->is_several)
    return CLI_END;
  return augment_check_folder(cli, out) == CLI_STOP ? CLI_STOP : augment_check_former(cli, out);
}
