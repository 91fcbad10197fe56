/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend voxelize: its options. */
#include "cli/baseline.h"
#include "cli/voxelize_common.h"

#include <string.h>

enum {
  KEY_SIZE = CLI_KEY_COMMAND,
  KEY_FIT,
  KEY_BOUNDS,
  KEY_PAD,
  KEY_LIKE,
  KEY_MODE,
  KEY_SURFACE,
  KEY_METHOD,
  KEY_VOTE,
  KEY_PARTS,
  KEY_THIN,
  KEY_CAVITIES,
  KEY_COVERAGE,
  KEY_SCALAR,
  KEY_DISTANCE,
  KEY_BAND,
  KEY_LABELS,
  KEY_COLOR,
  KEY_COLOR_AVERAGE,
  KEY_CONFIDENCE,
  KEY_SPARSE,
  KEY_COORDS,
  KEY_NO_REPAIR,
  KEY_WELD,
  KEY_KEEP,
  KEY_FORMAT,
  KEY_FORCE,
  KEY_POLYGONS,
  KEY_CONTACTS,
  KEY_BLOCKS,
  KEY_UP,
  KEY_DRY_RUN,
  KEY_BASELINE
};

const cli_option voxelize_options[] = {
    {'o', "output", "GRID", CLI_GRID_FILES "; '-' is standard output"},
    {KEY_FORMAT, "format", "F", CLI_GRID_FORMATS},
    CLI_OPTION_FORCE(KEY_FORCE),
    CLI_OPTIONS_SURFACE(KEY_POLYGONS, KEY_CONTACTS),
    CLI_OPTIONS_STYLE(KEY_BLOCKS, KEY_UP),
    {'r', "resolution", "N|NXxNYxNZ", "voxels along the longest side, or along each axis [128]"},
    {KEY_SIZE, "voxel-size", "S|SX,SY,SZ", "sides of a voxel in model units, instead of -r"},
    {KEY_FIT, "fit", "cube|tight|sphere",
     "cube: N x N x N, the model's longest side fills it, the model is centred;\n"
     "tight: the box of the model; sphere: N x N x N, the diagonal of the box\n"
     "fills it, so that every rotation stays inside [cube]"},
    {KEY_PAD, "pad", "P", "keep P voxels free on each side: within -r, in addition to --voxel-size [0]"},
    {KEY_BOUNDS, "bounds", "X0,Y0,Z0,X1,Y1,Z1",
     "cover this box, whatever the model's size: from its least corner on,\n"
     "rounded up to whole voxels; exactly with three numbers (-r 64x32x16)"},
    {KEY_LIKE, "like", "GRID", "take dimensions, origin and voxel size from this grid"},
    {KEY_MODE, "mode", "solid|surface|both",
     "solid: the inside, by voxel centres and --thin; surface: as --surface says;\n"
     "both: either (a conservative surface has all that --thin would add) [solid]"},
    {KEY_THIN, "thin", "keep|drop|26",
     "parts thinner than a voxel: keep = add the few voxels that hold them together\n"
     "and through which no path from face to face leaks; 26 = nor one over edges and\n"
     "corners; drop = only voxels whose centre is inside [keep; drop where --method or\n"
     "--vote chooses another rule]"},
    {KEY_SURFACE, "surface", "conservative|thin|shell26|shell18|shell6",
     "conservative: every voxel whose box meets a face; thin: 6-separating, fewer\n"
     "voxels, through which no path from face to face leaks; shell26, 18, 6: voxels of the solid beside an\n"
     "empty one, over corners, edges or faces [conservative]"},
    {KEY_METHOD, "method", "vote|x|y|z|tetra|winding",
     "how inside is told: parity along one axis, the XOR of tetrahedra, a\n"
     "vote (--vote; all agree wherever the mesh is closed), or the winding\n"
     "number, which always has an answer [vote]"},
    {KEY_VOTE, "vote", "auto|majority|any|all",
     "what is inside where the mesh is open: auto = close holes by caps over their\n"
     "rims; what stays open by what x, y and z agree on, else by the winding number;\n"
     "majority = what two of x, y and z say; any, all = what any or all of the four say [auto]"},
    {KEY_PARTS, "parts", "auto|group|whole",
     "what is voxelized alone, then united: auto = each closed component, and\n"
     "all others together; group = each component; whole = no splitting [auto]"},
    {KEY_CAVITIES, "cavities", "auto|keep|fill",
     "with --parts auto, what a closed component inside another is: auto = a cavity if\n"
     "it is wound against that, else solid; keep = a cavity; fill = solid [auto]"},
    {KEY_COVERAGE, "coverage", "2|4|8",
     "write how much of each voxel is filled instead, from 2, 4 or 8 sub-voxels along\n"
     "each axis; .npy, .nrrd, .vdb, .octree, .nii, .vti, .vtk, .tif, .h5 or .zarr"},
    {KEY_SCALAR, "scalar", "float32|uint8",
     "what --coverage writes: 0 to 1, or 0 to 255, as .png needs [float32]"},
    {KEY_DISTANCE, "distance", "signed|unsigned",
     "write the distance from each centre to the mesh instead, in model units;\n"
     "signed: negative inside; .npy, .nrrd, .vdb, .octree, .nii, .vti, .vtk, .tif,\n"
     ".h5 or .zarr"},
    {KEY_BAND, "band", "B", "how many voxels from the mesh --distance is exact; 0 = everywhere [3]"},
    {KEY_LABELS, "labels", "part|group|material",
     "write which part, group or material each voxel belongs to instead, from 1 on:\n"
     "bodies fill what they enclose, patches of a surface have the voxels at it;\n"
     ".npy, .nrrd, .nii, .vti, .vtk, .tif, .h5, .zarr, .vdb, .octree or .binvox, with\n"
     "the names in a .json beside it; .vox, .schem, .litematic or .glb"},
    {KEY_COLOR, "color", "mesh|noise|position|part|FILE",
     "write a colour for each set voxel instead: that of the nearest point of the mesh,\n"
     "by its vertices, faces, materials and textures; Perlin's noise, where it is, its\n"
     "part, a function in GLSL (FILE.frag, needs --engine opengl), or the numbers or\n"
     "colours of a volume (such as FILE.nrrd) there; .npy, .ply, .vox, .glb, .schem,\n"
     ".litematic, .nrrd, .octree, .nii, .vti, .vtk, .tif, .h5 or .zarr"},
    {KEY_COLOR_AVERAGE, "color-average", NULL,
     "with --color mesh: the mean over the surface within a voxel, where there is any"},
    {KEY_CONFIDENCE, "confidence", "FILE.npy", "write how sure each voxel is too, 0 to 255"},
    {KEY_SPARSE, "sparse", NULL,
     "make the voxels as an octree, whose memory follows the surface, for 1024 and more\n"
     "along a side; a .octree file follows it too, is made so without being asked, and\n"
     "'convert --window' cuts grids out of it"},
    {KEY_COORDS, "coords", "FILE.npy", "write the coordinates of set voxels too, int32, n rows of i, j, k"},
    {KEY_BASELINE, "baseline", "NAME",
     "use a published method instead, as it was published, for comparison: fang-chen,\n"
     "chen-tu, tetra-listed, tetra-full, tetra-anew, tetra-layers, eisemann (solids);\n"
     "density, simple, specialized, sorted, zhang (surfaces); faieghi and faieghi-voxels\n"
     "(surfaces, with --engine opencl)"},
    {KEY_DRY_RUN, "dry-run", NULL, "tell the grid and the memory it takes, and write nothing"},
    {KEY_NO_REPAIR, "no-repair", NULL, "take the mesh as it is in the file"},
    {KEY_WELD, "weld", "auto|off|EPS", "as in 'voxmend repair' [auto]"},
    {KEY_KEEP, "keep-duplicates", NULL, "leave faces that repeat another, or lie back to back with it"},
    CLI_OPTIONS_ENGINE,
    CLI_OPTIONS_READ,
    {0, NULL, NULL, NULL}};

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

/** The options that choose the voxel space. */
static int read_space_option(cli_run *cli, voxelize_request *out, int key, const char *value) {
  static const char *const fits[] = {"cube", "tight", "sphere", NULL};
  vxm_space_options *space = &out->space;
  int choice = 0, result;
  switch (key) {
  case 'r':
    out->resolution = true;
    if (!read_resolution(space->resolution, value))
      return cli_usage(cli, "-r '%s' is neither N nor NXxNYxNZ, each from 1 to 1048576", value);
    return CLI_END;
  case KEY_SIZE:
    out->size = true;
    return cli_read_voxel_size(cli, space, value);
  case KEY_FIT:
    out->fit = true;
    result = cli_choose(cli, &choice, "fit", value, fits);
    space->fit = (vxm_fit)choice;
    return result;
  case KEY_PAD:
    out->pad = true;
    if (!cli_read_integer(&space->pad, value, 0, 1 << 19))
      return cli_usage(cli, "--pad '%s' is not a number of voxels from 0 to 524288", value);
    return CLI_END;
  case KEY_BOUNDS:
    out->bounds = space->use_bounds = true;
    if (!cli_read_numbers(space->bounds, 6, value))
      return cli_usage(cli, "--bounds '%s' is not X0,Y0,Z0,X1,Y1,Z1", value);
    for (int axis = 0; axis < 3; axis++)
      if (!(space->bounds[axis] < space->bounds[axis + 3]))
        return cli_usage(cli, "--bounds '%s' is empty along %c", value, 'x' + axis);
    return CLI_END;
  default:
    out->like = value;
    return CLI_END;
  }
}

static int read_option(cli_run *cli, voxelize_request *out, int key, const char *value) {
  static const char *const methods[] = {"vote", "x", "y", "z", "tetra", "winding", NULL};
  static const char *const votes[] = {"auto", "majority", "any", "all", NULL};
  static const char *const parts[] = {"auto", "group", "whole", NULL};
  static const char *const cavities[] = {"auto", "keep", "fill", NULL};
  int choice = 0, result = CLI_END;
  switch (key) {
  case 'o':
    out->output = value;
    return CLI_END;
  case KEY_FORMAT:
    out->format = value;
    return CLI_END;
  case KEY_MODE:
    return cli_read_mode(cli, &out->voxelize, value);
  case KEY_SURFACE:
    out->surface = true;
    return cli_read_surface(cli, &out->voxelize, value);
  case KEY_METHOD:
    out->method = true;
    result = cli_choose(cli, &choice, "method", value, methods);
    out->voxelize.method = (vxm_method)choice;
    return result;
  case KEY_VOTE:
    out->vote = true;
    result = cli_choose(cli, &choice, "vote", value, votes);
    out->voxelize.vote = (vxm_vote)choice;
    return result;
  case KEY_PARTS:
    out->parts = true;
    result = cli_choose(cli, &choice, "parts", value, parts);
    out->voxelize.split_mode = (vxm_split_mode)choice;
    return result;
  case KEY_THIN:
    out->thin = true;
    return cli_read_thin(cli, &out->voxelize, value);
  case KEY_CAVITIES:
    out->cavities = true;
    result = cli_choose(cli, &choice, "cavities", value, cavities);
    out->voxelize.cavities = (vxm_cavities)choice;
    return result;
  case KEY_COVERAGE:
    return cli_field_read_coverage(cli, &out->field, value);
  case KEY_SCALAR:
    return cli_field_read_scalar(cli, &out->field, value);
  case KEY_DISTANCE:
    return cli_field_read_distance(cli, &out->field, value);
  case KEY_BAND:
    return cli_field_read_band(cli, &out->field, value);
  case KEY_LABELS:
    return cli_field_read_labels(cli, &out->field, value);
  case KEY_COLOR:
    return cli_color_read(cli, &out->field, value);
  case KEY_COLOR_AVERAGE:
    out->field.color_options.average = true;
    return CLI_END;
  case KEY_CONFIDENCE:
    out->confidence = value;
    out->voxelize.confidence = true;
    return CLI_END;
  case KEY_SPARSE:
    out->sparse = true;
    return CLI_END;
  case KEY_COORDS:
    out->coords = value;
    return CLI_END;
  case KEY_FORCE:
    out->force = true;
    return CLI_END;
  case KEY_CONTACTS:
    out->keep_contacts = true;
    return CLI_END;
  case KEY_BLOCKS:
    out->style.blocks = value;
    return CLI_END;
  case KEY_UP:
    return cli_read_up(cli, &out->style, value);
  case KEY_POLYGONS:
    return cli_read_polygons(cli, &out->keep_polygons, value);
  case KEY_DRY_RUN:
    out->dry_run = true;
    return CLI_END;
  case KEY_BASELINE:
    out->baseline_name = value;
    return cli_choose(cli, &out->baseline, "baseline", value, cli_baseline_names);
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
  case CLI_KEY_GL_DISPLACE:
    return cli_engine_read(cli, &out->engine, key, value);
  default:
    return read_space_option(cli, out, key, value);
  }
}

static bool is_npy(const char *path) {
  size_t length = strlen(path);
  return length > 4 && strcmp(path + length - 4, ".npy") == 0;
}

/** Options about what is inside, where others make them of no effect. What is reported of a surface has its
 * parts and cavities. */
static int check_rules(cli_run *cli, const voxelize_request *given) {
  const vxm_voxelize_options *options = &given->voxelize;
  if (given->vote && options->method != VXM_METHOD_VOTE)
    return cli_usage(cli, "--vote goes with --method vote only");
  if (given->cavities && options->split_mode != VXM_SPLIT_MODE_AUTO)
    return cli_usage(cli, "--cavities goes with --parts auto only");
  if ((given->method || given->vote) && !cli_makes_solid(options))
    return cli_usage(cli,
                     "--method and --vote are about the solid; leave them out with --mode surface, unless "
                     "--surface is a shell");
  if ((given->method || given->vote || given->parts || given->cavities) && given->field.distance &&
      given->field.distance_options.is_unsigned)
    return cli_usage(cli, "--method, --vote, --parts and --cavities are about the solid; leave them out with "
                          "--distance unsigned");
  return CLI_END;
}

/** Options that contradict each other. */
static int check_conflicts(cli_run *cli, const voxelize_request *given) {
  if (given->like && (given->resolution || given->size || given->fit || given->pad || given->bounds))
    return cli_usage(cli, "--like takes the whole grid from a file; leave out -r, --voxel-size, --fit, "
                          "--pad and --bounds");
  if (given->resolution && given->size)
    return cli_usage(cli, "-r and --voxel-size exclude each other");
  if (given->bounds && given->pad)
    return cli_usage(cli, "--bounds says what is covered; leave out --pad");
  if (given->bounds && given->fit)
    return cli_usage(cli, "--bounds says what is covered; leave out --fit");
  if (check_rules(cli, given) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_surface(cli, &given->voxelize, given->surface) == CLI_STOP)
    return CLI_STOP;
  if (cli_check_thin(cli, &given->voxelize, given->thin) == CLI_STOP)
    return CLI_STOP;
  if (given->thin && (given->field.coverage || given->field.distance))
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
  if (cli_check_repair(cli, given->no_repair, given->repair_options) == CLI_STOP)
    return CLI_STOP;
  return cli_field_check(cli, &given->field, given->voxelize.mode, given->dry_run, given->confidence);
}

static int check_names(cli_run *cli, const voxelize_request *given) {
  cli_reads(cli, given->like);
  if (given->field.color &&
      (given->field.color_options.by == VXM_COLOR_GLSL || given->field.color_options.by == VXM_COLOR_VOLUME))
    cli_reads(cli, given->field.color_name);
  cli_writes(cli, "-o", given->output, cli_has_json(given->format, given->field.labels));
  cli_writes(cli, "--confidence", given->confidence, true);
  cli_writes(cli, "--coords", given->coords, false);
  if (cli_check_names(cli) == CLI_STOP)
    return CLI_STOP;
  return cli_check_surface_file(cli, given->output, given->format, given->force || given->dry_run);
}

bool voxelize_is_sliced(const char *format) {
  return (vxm_grid_format_traits(format) & VXM_FORMAT_SLICES) != 0;
}

int voxelize_read_arguments(cli_run *cli, voxelize_request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END)
    if (key == CLI_STOP || read_option(cli, out, key, value) == CLI_STOP)
      return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  if (check_conflicts(cli, out) == CLI_STOP)
    return CLI_STOP;
  cli->sized_by = out->like   ? CLI_SIZED_BY_LIKE
                  : out->size ? CLI_SIZED_BY_VOXEL_SIZE
                              : CLI_SIZED_BY_RESOLUTION;
  cli_formats formats =
      cli_field_wanted(&out->field) ? cli_field_formats(&out->field) : cli_formats_with(VXM_FORMAT_BITS);
  out->format = cli_output_format(cli, out->output, out->format, formats.name);
  bool is_octree = out->format && strcmp(out->format, "octree") == 0;
  /* faster at any resolution, and in little memory; an engine and the confidence fill whole grids */
  out->sparse |= is_octree && !cli_field_wanted(&out->field) && !out->confidence && !out->engine.name &&
                 !out->baseline_name;
  if (out->format && out->sparse && !voxelize_is_sliced(out->format))
    return cli_usage(cli, "--sparse: .%s needs the whole grid", out->format);
  if (out->format && out->sparse && cli_field_wanted(&out->field)) {
    if (!is_octree)
      return cli_usage(cli,
                       "--sparse: of --coverage, --distance, --labels and --color .octree alone is "
                       "sparse, not .%s",
                       out->format);
    out->sparse = false; /* the file is an octree as it is */
  }
  if (out->format && (cli_check_style(cli, &out->style, out->format) == CLI_STOP ||
                      cli_check_quads(cli, out->keep_polygons, out->keep_contacts, out->format) == CLI_STOP))
    return CLI_STOP;
  out->field.label_options.blocks = out->field.color_options.blocks = out->style.blocks;
  out->field.label_options.up = out->field.color_options.up = out->style.up;
  return out->format ? check_names(cli, out) : CLI_STOP;
}
