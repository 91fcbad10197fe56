/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: its options. */
#include "cli/augment.h"
#include "cli/voxelize_common.h"

#include <string.h>

static int take_rotate(cli_run *cli, const cli_option *option, const char *value, void *request) {
  augment_request *out = request;
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
      return cli_usage(cli, "--%s '%s' is no axis", option->name, value);
    return CLI_END;
  }
  out->rotations = value;
  sampler->rotation = VXM_ROTATION_LIST;
  return CLI_END;
}

static int take_displace(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_sampler_options *sampler = member;
  static const char suffix[] = ",normal";
  char number[64];
  size_t length = strlen(value), behind = sizeof suffix - 1;
  bool normal = length > behind && strcmp(value + length - behind, suffix) == 0;
  sampler->displacement = normal ? VXM_DISPLACEMENT_NORMAL : VXM_DISPLACEMENT_UNIFORM;
  snprintf(number, sizeof number, "%.*s", (int)(normal ? length - behind : length), value);
  if (cli_read_number(&sampler->displace, number) && sampler->displace >= 0 && sampler->displace <= 1)
    return CLI_END;
  return cli_usage(cli, "--%s '%s' is not a number from 0 to 1, with or without ',normal'", option->name,
                   value);
}

static int take_mirror(cli_run *cli, const cli_option *option, const char *value, void *member) {
  unsigned *axes = member;
  *axes = 0;
  for (const char *c = value; *c; c++) {
    if (*c < 'x' || *c > 'z')
      return cli_usage(cli, "--%s '%s' names other axes than x, y and z", option->name, value);
    *axes |= 1U << (*c - 'x');
  }
  return CLI_END;
}

const cli_option augment_options[] = {
    {'o', "output", "DIR|-",
     "folder for a file of each variant, 000000.rle and so on (of several meshes: for\n"
     "a folder of each), or - for a stream of records of equal size on standard output",
     CLI_TEXT(augment_request, output)},
    {0, "format", "F",
     "of files: rle, raw, binvox, npy or nrrd [rle]; of a stream: bits, uint8 or\n"
     "float32 [bits]",
     CLI_TEXT(augment_request, format)},
    {'n', "count", "N", "how many variants [16]; 0 with -o -: no end, until the reader has enough",
     CLI_NUMBER(augment_request, count, 0, UINT32_MAX)},
    {0, "first", "I", "the number of the first one [0]", CLI_NUMBER(augment_request, first, 0, UINT32_MAX)},
    {0, "force", NULL, "replace variants of a former run: those in DIR with this number or above go",
     CLI_FLAG(augment_request, force)},
    {0, "seed", "S", "of the random numbers, up to 2^63 - 1 [0]",
     CLI_NUMBER(augment_request, sampler.seed, 0, INT64_MAX)},
    {0, "epoch", "E", "another epoch gives other variants [0]",
     CLI_NUMBER(augment_request, variant.epoch, 0, UINT32_MAX)},
    {0, "model", "M",
     "number of the model, or of the first of several; seed, epoch and model number\n"
     "together determine the variants [0]",
     CLI_NUMBER(augment_request, variant.model, 0, UINT32_MAX)},
    {'r', "resolution", "N", "voxels along each axis, up to 4096 [64]",
     CLI_NUMBER(augment_request, sampler.resolution, 1, 4096)},
    {0, "coverage", "2|4|8",
     "a number for each voxel: how much of it is filled, from so many sub-voxels along\n"
     "each axis; in files (npy, nrrd) and as uint8 0 to 255, as float32 0 to 1",
     CLI_VALUE(cli_take_subdivision, augment_request, sampler.coverage)},
    {0, "pad", "P", "keep P voxels free on each side, before the model is moved [0]",
     CLI_NUMBER(augment_request, sampler.pad, 0, 2047)},
    {0, "rotate", "none|any|x|y|z|X,Y,Z|FILE",
     "not at all; uniform over all rotations; about an axis; or by the matrices of\n"
     "a file, one after another: nine numbers each, row after row [none]",
     CLI_VALUES(take_rotate)},
    {0, "scale", "F", "scale each axis by a factor of its own, from 1 - F to 1 + F; F below 1 [0]",
     CLI_REAL(augment_request, sampler.scale, 0, CLI_BELOW_1, "a number from 0 to below 1")},
    {0, "displace", "F[,normal]",
     "displace vertices along each axis by up to this part of the width of the grid;\n"
     "with normal, by a normal distribution of that deviation [0]",
     CLI_VALUE(take_displace, augment_request, sampler)},
    {0, "noise", "N", "displacements in the buffer that all variants read [65536]",
     CLI_NUMBER(augment_request, sampler.noise, 1, 1 << 24)},
    {0, "mirror", "AXES", "mirror half of the variants along each of these axes, such as x or xyz",
     CLI_VALUE(take_mirror, augment_request, sampler.mirror)},
    {0, "translate", "F", "move by up to this part, 0 to 1, of the room on each side [0]",
     CLI_REAL(augment_request, sampler.translate, 0, 1, "a number from 0 to 1")},
    {0, "fill", NULL, "the longest side fills the grid, not the diagonal; without --rotate only",
     CLI_FLAG(augment_request, sampler.fill)},
    {0, "mode", "solid|surface|both", "as in 'voxmend voxelize' [solid]",
     CLI_CHOICE(augment_request, voxelize.mode, cli_modes)},
    {0, "surface", "KIND", "as in 'voxmend voxelize' [conservative]",
     CLI_CHOICE(augment_request, voxelize.surface, cli_surfaces)},
    {0, "thin", "keep|drop|26", "parts thinner than a voxel: as in 'voxmend voxelize' [keep]",
     CLI_CHOICE_FROM(VXM_THIN_KEEP, augment_request, voxelize.thin, cli_thin_parts)},
    {0, "no-repair", NULL, "take the mesh as it is in the file", CLI_FLAG(augment_request, no_repair)},
    {0, "weld", "auto|off|EPS", "as in 'voxmend repair' [auto]",
     CLI_VALUE(cli_take_weld, augment_request, repair)},
    {0, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it",
     CLI_FLAG(augment_request, repair.keep_duplicates)},
    {0, "engine", "E",
     "what computes the variants, one after another: cpu; or as in 'voxmend voxelize'\n"
     "[cpu]",
     CLI_TEXT(augment_request, engine.name)},
    CLI_OPTIONS_ENGINE_METHODS(augment_request),
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

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
  if (sampler->coverage > 0 && cli_is_given(cli, "thin"))
    return cli_usage(cli, "--coverage counts what is inside, and --thin adds voxels; give one of them");
  if (sampler->resolution * (sampler->coverage > 0 ? sampler->coverage : 1) > 4096)
    return cli_usage(cli, "-r and --coverage make more than 4096 sub-voxels along an axis");
  if (given->force && augment_is_stream(given))
    return cli_usage(cli, "--force replaces files, and -o - writes none");
  if (cli_is_given(cli, "noise") && sampler->displace == 0)
    return cli_usage(cli, "--noise goes with --displace");
  if (cli_check_surface(cli, &given->voxelize) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_thin(cli, &given->voxelize) == CLI_STOP)
    return CLI_STOP;
  return cli_check_repair(cli);
}

int augment_read_arguments(cli_run *cli, augment_request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
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
