/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend voxelize: its options. */
#include "cli/baseline.h"
#include "cli/voxelize_common.h"

#include <string.h>

/* ---- Values ---- */

static const char *const fits[] = {"cube", "tight", "sphere", NULL};
static const char *const methods[] = {"vote", "x", "y", "z", "tetra", "winding", NULL};
static const char *const votes[] = {"auto", "majority", "any", "all", NULL};
static const char *const parts[] = {"auto", "group", "whole", NULL};
static const char *const cavities[] = {"auto", "keep", "fill", NULL};

/** "64", or "64x32x16". */
static bool read_resolution(int64_t out[3], const char *text) {
  enum { MOST = 1 << 20 };
  int64_t value[3] = {0, 0, 0};
  int count = 0;
  for (;;) {
    size_t digits = strspn(text, "0123456789");
    char number[16] = "";
    if (digits >= sizeof number || count == 3)
      return false;
    memcpy(number, text, digits);
    if (!cli_read_integer(&value[count++], number, 1, MOST))
      return false;
    text += digits;
    if (!*text)
      break;
    if (*text++ != 'x')
      return false;
  }
  if (count == 2)
    return false;
  memcpy(out, value, sizeof value);
  return true;
}

static int take_resolution(cli_run *cli, const cli_option *option, const char *value, void *member) {
  (void)option;
  if (read_resolution(member, value))
    return CLI_END;
  return cli_usage(cli, "-r '%s' is neither N nor NXxNYxNZ, each from 1 to 1048576", value);
}

static int take_pad(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (cli_read_integer(member, value, option->to.min, option->to.max))
    return CLI_END;
  return cli_usage(cli, "--pad '%s' is not a number of voxels from 0 to 524288", value);
}

static int take_bounds(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_space_options *space = member;
  (void)option;
  space->use_bounds = true;
  if (!cli_read_numbers(space->bounds, 6, value))
    return cli_usage(cli, "--bounds '%s' is not X0,Y0,Z0,X1,Y1,Z1", value);
  for (int axis = 0; axis < 3; axis++)
    if (!(space->bounds[axis] < space->bounds[axis + 3]))
      return cli_usage(cli, "--bounds '%s' is empty along %c", value, 'x' + axis);
  return CLI_END;
}

/* ---- The table ---- */

const cli_option voxelize_options[] = {
    {'o', "output", "GRID", CLI_GRID_FILES "; '-' is standard output", CLI_TEXT(voxelize_request, output)},
    {0, "format", "F", CLI_GRID_FORMATS, CLI_TEXT(voxelize_request, write.format)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_SURFACE(voxelize_request),
    CLI_OPTIONS_STYLE(voxelize_request),
    {'r', "resolution", "N|NXxNYxNZ", "voxels along the longest side, or along each axis [128]",
     CLI_VALUE(take_resolution, voxelize_request, space.resolution)},
    {0, "voxel-size", "S|SX,SY,SZ", "sides of a voxel in model units, instead of -r",
     CLI_VALUE(cli_take_voxel_size, voxelize_request, space)},
    {0, "fit", "cube|tight|sphere",
     "cube: N x N x N, the model's longest side fills it, the model is centred;\n"
     "tight: the box of the model; sphere: N x N x N, the diagonal of the box\n"
     "fills it, so that every rotation stays inside [cube]",
     CLI_CHOICE(voxelize_request, space.fit, fits)},
    {0, "pad", "P", "keep P voxels free on each side: within -r, in addition to --voxel-size [0]",
     CLI_VALUE(take_pad, voxelize_request, space.pad, .max = 1 << 19)},
    {0, "bounds", "X0,Y0,Z0,X1,Y1,Z1",
     "cover this box, whatever the model's size: from its least corner on,\n"
     "rounded up to whole voxels; exactly with three numbers (-r 64x32x16)",
     CLI_VALUE(take_bounds, voxelize_request, space)},
    {0, "like", "GRID", "take dimensions, origin and voxel size from this grid",
     CLI_TEXT(voxelize_request, like)},
    {0, "mode", "solid|surface|both",
     "solid: the inside, by voxel centres and --thin; surface: as --surface says;\n"
     "both: either (a conservative surface has all that --thin would add) [solid]",
     CLI_CHOICE(voxelize_request, voxelize.mode, cli_modes)},
    {0, "thin", "keep|drop|26",
     "parts thinner than a voxel: keep = add the few voxels that hold them together\n"
     "and through which no path from face to face leaks; 26 = nor one over edges and\n"
     "corners; drop = only voxels whose centre is inside [keep; drop where --method or\n"
     "--vote chooses another rule]",
     CLI_CHOICE_FROM(VXM_THIN_KEEP, voxelize_request, voxelize.thin, cli_thin_parts)},
    {0, "surface", "conservative|thin|shell26|shell18|shell6",
     "conservative: every voxel whose box meets a face; thin: 6-separating, fewer\n"
     "voxels, through which no path from face to face leaks; shell26, 18, 6: voxels of the solid beside an\n"
     "empty one, over corners, edges or faces [conservative]",
     CLI_CHOICE(voxelize_request, voxelize.surface, cli_surfaces)},
    {0, "method", "vote|x|y|z|tetra|winding",
     "how inside is told: parity along one axis, the XOR of tetrahedra, a\n"
     "vote (--vote; all agree wherever the mesh is closed), or the winding\n"
     "number, which always has an answer [vote]",
     CLI_CHOICE(voxelize_request, voxelize.method, methods)},
    {0, "vote", "auto|majority|any|all",
     "what is inside where the mesh is open: auto = close holes by caps over their\n"
     "rims; what stays open by what x, y and z agree on, else by the winding number;\n"
     "majority = what two of x, y and z say; any, all = what any or all of the four say [auto]",
     CLI_CHOICE(voxelize_request, voxelize.vote, votes)},
    {0, "parts", "auto|group|whole",
     "what is voxelized alone, then united: auto = each closed component, and\n"
     "all others together; group = each component; whole = no splitting [auto]",
     CLI_CHOICE(voxelize_request, voxelize.split_mode, parts)},
    {0, "cavities", "auto|keep|fill",
     "with --parts auto, what a closed component inside another is: auto = a cavity if\n"
     "it is wound against that, else solid; keep = a cavity; fill = solid [auto]",
     CLI_CHOICE(voxelize_request, voxelize.cavities, cavities)},
    {0, "coverage", "2|4|8",
     "write how much of each voxel is filled instead, from 2, 4 or 8 sub-voxels along\n"
     "each axis; .npy, .nrrd, .vdb, .octree, .nii, .vti, .vtk, .tif, .h5 or .zarr",
     CLI_VALUE(cli_take_subdivision, voxelize_request, field.coverage_options.subdivision)},
    {0, "scalar", "float32|uint8", "what --coverage writes: 0 to 1, or 0 to 255, as .png needs [float32]",
     CLI_CHOICE_FROM(VXM_FLOAT32, voxelize_request, field.coverage_options.scalar, cli_scalars)},
    {0, "distance", "signed|unsigned",
     "write the distance from each centre to the mesh instead, in model units;\n"
     "signed: negative inside; .npy, .nrrd, .vdb, .octree, .nii, .vti, .vtk, .tif,\n"
     ".h5 or .zarr",
     CLI_CHOICE(voxelize_request, field.distance_options.is_unsigned, cli_signs)},
    {0, "band", "B", "how many voxels from the mesh --distance is exact; 0 = everywhere [3]",
     CLI_REAL(voxelize_request, field.distance_options.band, 0, DBL_MAX, "a number of voxels from 0 on")},
    {0, "labels", "part|group|material",
     "write which part, group or material each voxel belongs to instead, from 1 on:\n"
     "bodies fill what they enclose, patches of a surface have the voxels at it;\n"
     ".npy, .nrrd, .nii, .vti, .vtk, .tif, .h5, .zarr, .vdb, .octree or .binvox, with\n"
     "the names in a .json beside it; .vox, .schem, .litematic or .glb",
     CLI_CHOICE(voxelize_request, field.label_options.by, cli_label_kinds)},
    {0, "color", "mesh|noise|position|part|FILE",
     "write a colour for each set voxel instead: that of the nearest point of the mesh,\n"
     "by its vertices, faces, materials and textures; Perlin's noise, where it is, its\n"
     "part, a function in GLSL (FILE.frag, needs --engine opengl), or the numbers or\n"
     "colours of a volume (such as FILE.nrrd) there; .npy, .ply, .vox, .glb, .schem,\n"
     ".litematic, .nrrd, .octree, .nii, .vti, .vtk, .tif, .h5 or .zarr",
     CLI_VALUE(cli_take_color, voxelize_request, field)},
    {0, "color-average", NULL,
     "with --color mesh: the mean over the surface within a voxel, where there is any",
     CLI_FLAG(voxelize_request, field.color_options.average)},
    {0, "confidence", "FILE.npy", "write how sure each voxel is too, 0 to 255",
     CLI_TEXT(voxelize_request, confidence)},
    {0, "sparse", NULL,
     "make the voxels as an octree, whose memory follows the surface, for 1024 and more\n"
     "along a side; a .octree file follows it too, is made so without being asked, and\n"
     "'convert --window' cuts grids out of it",
     CLI_FLAG(voxelize_request, sparse)},
    {0, "coords", "FILE.npy", "write the coordinates of set voxels too, int32, n rows of i, j, k",
     CLI_TEXT(voxelize_request, coords)},
    {0, "baseline", "NAME",
     "use a published method instead, as it was published, for comparison: fang-chen,\n"
     "chen-tu, tetra-listed, tetra-full, tetra-anew, tetra-layers, eisemann (solids);\n"
     "density, simple, specialized, sorted, zhang (surfaces); faieghi and faieghi-voxels\n"
     "(surfaces, with --engine opencl)",
     CLI_CHOICE(voxelize_request, baseline, cli_baseline_names)},
    {0, "dry-run", NULL, "tell the grid and the memory it takes, and write nothing",
     CLI_FLAG(voxelize_request, dry_run)},
    {0, "no-repair", NULL, "take the mesh as it is in the file", CLI_FLAG(voxelize_request, no_repair)},
    {0, "weld", "auto|off|EPS", "as in 'voxmend repair' [auto]",
     CLI_VALUE(cli_take_weld, voxelize_request, repair)},
    {0, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it",
     CLI_FLAG(voxelize_request, repair.keep_duplicates)},
    CLI_OPTIONS_ENGINE(voxelize_request),
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

/* ---- Checks ---- */

static bool is_npy(const char *path) {
  size_t length = strlen(path);
  return length > 4 && strcmp(path + length - 4, ".npy") == 0;
}

/** Options about what is inside, where others make them of no effect. What is reported of a surface has its
 * parts and cavities. */
static int check_rules(cli_run *cli, const voxelize_request *given) {
  static const char *const of_solid[] = {"method", "vote", NULL};
  static const char *const of_parts[] = {"parts", "cavities", NULL};
  const vxm_voxelize_options *options = &given->voxelize;
  bool tells_inside = cli_last_given(cli, of_solid) != NULL;
  if (cli_is_given(cli, "vote") && options->method != VXM_METHOD_VOTE)
    return cli_usage(cli, "--vote goes with --method vote only");
  if (cli_is_given(cli, "cavities") && options->split_mode != VXM_SPLIT_MODE_AUTO)
    return cli_usage(cli, "--cavities goes with --parts auto only");
  if (tells_inside && !cli_makes_solid(options))
    return cli_usage(cli,
                     "--method and --vote are about the solid; leave them out with --mode surface, unless "
                     "--surface is a shell");
  if ((tells_inside || cli_last_given(cli, of_parts)) && given->field.distance &&
      given->field.distance_options.is_unsigned)
    return cli_usage(cli, "--method, --vote, --parts and --cavities are about the solid; leave them out with "
                          "--distance unsigned");
  return CLI_END;
}

/** Options that contradict each other. */
static int check_conflicts(cli_run *cli, const voxelize_request *given) {
  static const char *const of_space[] = {"resolution", "voxel-size", "fit", "pad", "bounds", NULL};
  bool has_bounds = cli_is_given(cli, "bounds"), is_thin = cli_is_given(cli, "thin");
  if (given->like && cli_last_given(cli, of_space))
    return cli_usage(cli, "--like takes the whole grid from a file; leave out -r, --voxel-size, --fit, "
                          "--pad and --bounds");
  if (cli_is_given(cli, "resolution") && cli_is_given(cli, "voxel-size"))
    return cli_usage(cli, "-r and --voxel-size exclude each other");
  if (has_bounds && cli_is_given(cli, "pad"))
    return cli_usage(cli, "--bounds says what is covered; leave out --pad");
  if (has_bounds && cli_is_given(cli, "fit"))
    return cli_usage(cli, "--bounds says what is covered; leave out --fit");
  if (check_rules(cli, given) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_surface(cli, &given->voxelize) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_thin(cli, &given->voxelize) == CLI_STOP)
    return CLI_STOP;
  if (is_thin && (given->field.coverage || given->field.distance))
    return cli_usage(cli, "--thin is about set voxels; leave it out with --coverage and --distance");
  if (given->confidence && !is_npy(given->confidence))
    return cli_usage(cli, "--confidence '%s': the name must end in .npy", given->confidence);
  if (given->confidence && given->sparse)
    return cli_usage(cli, "--confidence needs the whole grid; leave out --sparse");
  if (given->coords && cli_field_wanted(&given->field))
    return cli_usage(cli, "--coords is about set voxels; leave out --coverage, --distance, --labels and "
                          "--color");
  if (given->coords && !is_npy(given->coords))
    return cli_usage(cli, "--coords '%s': the name must end in .npy", given->coords);
  if (cli_engine_check(cli, &given->engine) == CLI_STOP || cli_baseline_check(cli, given) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_repair(cli) == CLI_STOP)
    return CLI_STOP;
  return cli_field_check(cli, &given->field, given->voxelize.mode, given->dry_run, given->confidence);
}

static int check_names(cli_run *cli, const voxelize_request *given) {
  cli_reads(cli, given->like);
  if (given->field.color &&
      (given->field.color_options.by == VXM_COLOR_GLSL || given->field.color_options.by == VXM_COLOR_VOLUME))
    cli_reads(cli, given->field.color_name);
  cli_writes(cli, "-o", given->output, cli_has_json(given->write.format, given->field.labels));
  cli_writes(cli, "--confidence", given->confidence, true);
  cli_writes(cli, "--coords", given->coords, false);
  if (cli_check_names(cli) == CLI_STOP)
    return CLI_STOP;
  return given->dry_run ? CLI_END : cli_check_surface_file(cli, given->output, given->write.format);
}

bool voxelize_is_sliced(const char *format) {
  return (vxm_grid_format_traits(format) & VXM_FORMAT_SLICES) != 0;
}

int voxelize_read_arguments(cli_run *cli, voxelize_request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  out->voxelize.confidence = out->confidence != NULL;
  out->field.coverage = cli_is_given(cli, "coverage");
  out->field.distance = cli_is_given(cli, "distance");
  out->field.labels = cli_is_given(cli, "labels");
  out->field.color = cli_is_given(cli, "color");
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  if (check_conflicts(cli, out) == CLI_STOP)
    return CLI_STOP;
  cli->sized_by = out->like                         ? CLI_SIZED_BY_LIKE
                  : cli_is_given(cli, "voxel-size") ? CLI_SIZED_BY_VOXEL_SIZE
                                                    : CLI_SIZED_BY_RESOLUTION;
  cli_formats formats =
      cli_field_wanted(&out->field) ? cli_field_formats(&out->field) : cli_formats_with(VXM_FORMAT_BITS);
  out->write.format = cli_output_format(cli, out->output, out->write.format, formats.name);
  bool is_octree = out->write.format && strcmp(out->write.format, "octree") == 0;
  /* faster at any resolution, and in little memory; an engine and the confidence fill whole grids */
  out->sparse |= is_octree && !cli_field_wanted(&out->field) && !out->confidence && !out->engine.name &&
                 out->baseline < 0;
  if (out->write.format && out->sparse && !voxelize_is_sliced(out->write.format))
    return cli_usage(cli, "--sparse: .%s needs the whole grid", out->write.format);
  if (out->write.format && out->sparse && cli_field_wanted(&out->field)) {
    if (!is_octree)
      return cli_usage(cli,
                       "--sparse: of --coverage, --distance, --labels and --color .octree alone is "
                       "sparse, not .%s",
                       out->write.format);
    out->sparse = false; /* the file is an octree as it is */
  }
  if (out->write.format && cli_check_style(cli, &out->write) == CLI_STOP)
    return CLI_STOP;
  out->field.label_options.blocks = out->field.color_options.blocks = out->write.blocks;
  out->field.label_options.up = out->field.color_options.up = out->write.up;
  return out->write.format ? check_names(cli, out) : CLI_STOP;
}
