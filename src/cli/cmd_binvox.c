/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend binvox, and the program binvox: binvox's command line, made by what 'voxmend voxelize' is made by.
 */
#include "cli/binvox.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_SIZE = 4096 };

typedef struct box {
  double low[3], high[3];
} box;

/* ---- The model: turned, and its box ---- */

/** Quarter turns do not round: they exchange two coordinates, and change the sign of one, but not of 0. */
static void turn(double p[3], char axis) {
  double x = p[0], y = p[1], z = p[2];
  if (axis == 'x') {
    p[1] = 0 - z;
    p[2] = y;
  } else if (axis == 'y') {
    p[0] = z;
    p[2] = 0 - x;
  } else {
    p[0] = y;
    p[1] = 0 - x;
  }
}

/** The names of groups and materials, for vxm_mesh_create; to be freed, NULL where memory is lacking. */
static const char **names_of_tags(const vxm_mesh *mesh) {
  int64_t count = vxm_mesh_tag_count(mesh);
  const char **names = malloc((size_t)(count + 1) * sizeof *names);
  for (int64_t tag = 0; names && tag < count; tag++)
    names[tag] = vxm_mesh_tag_name(mesh, tag);
  return names;
}

/** Replaces the mesh by one whose vertices are turned. */
static int turn_mesh(cli_run *cli, vxm_mesh **mesh, const char *turns) {
  int64_t count = vxm_mesh_vertex_count(*mesh), faces = vxm_mesh_face_count(*mesh);
  double(*vertices)[3] = malloc((size_t)(count + 1) * sizeof *vertices);
  if (!vertices)
    return cli_fail_text(cli, "out of memory for the turned model: free some");
  memcpy(vertices, vxm_mesh_vertices(*mesh), (size_t)count * sizeof *vertices);
  for (int64_t v = 0; v < count; v++)
    for (const char *axis = turns; *axis; axis++)
      turn(vertices[v], *axis);
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = vertices;
  arrays.vertex_count = count;
  arrays.offsets = (const int64_t *)vxm_mesh_offsets(*mesh); /* below 2^63 */
  arrays.index_scalar = VXM_UINT32;
  arrays.indices = vxm_mesh_indices(*mesh);
  arrays.index_count = faces > 0 ? arrays.offsets[faces] : 0;
  arrays.face_count = faces;
  const char **tags = NULL;
  if (vxm_mesh_face_tags(*mesh) && !(tags = names_of_tags(*mesh))) {
    free(vertices);
    return cli_fail_text(cli, "out of memory for the turned model: free some");
  }
  arrays.tags = tags;
  arrays.tag_count = tags ? vxm_mesh_tag_count(*mesh) : 0;
  arrays.face_tags = vxm_mesh_face_tags(*mesh);
  vxm_mesh *turned = NULL;
  vxm_status status = vxm_mesh_create(&turned, cli->context, &arrays, &cli->error);
  free(tags);
  free(vertices);
  if (status != VXM_OK)
    return cli_fail(cli);
  vxm_mesh_destroy(*mesh);
  *mesh = turned;
  return CLI_DONE;
}

/** The box of the finite vertices that faces have; false if there is none with an extent. */
static bool find_box(box *out, const vxm_mesh *mesh) {
  int64_t faces = vxm_mesh_face_count(mesh);
  const uint64_t corners = faces > 0 ? vxm_mesh_offsets(mesh)[faces] : 0;
  const uint32_t *indices = vxm_mesh_indices(mesh);
  *out = (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (uint64_t c = 0; c < corners; c++) {
    const double *p = vxm_mesh_vertices(mesh) + 3 * (size_t)indices[c];
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
      continue;
    for (int axis = 0; axis < 3; axis++) {
      out->low[axis] = fmin(out->low[axis], p[axis]);
      out->high[axis] = fmax(out->high[axis], p[axis]);
    }
  }
  return out->low[0] < out->high[0] || out->low[1] < out->high[1] || out->low[2] < out->high[2];
}

static double longest(const box *b) {
  return fmax(b->high[0] - b->low[0], fmax(b->high[1] - b->low[1], b->high[2] - b->low[2]));
}

/** A cube on the longest side, whose least corner is the box's, or whose centre is. */
static vxm_space place(const binvox_request *given, const box *b) {
  double side = longest(b);
  vxm_space space = {.dims = {given->voxels, given->voxels, given->voxels}};
  for (int axis = 0; axis < 3; axis++) {
    space.voxel_size[axis] = side / (double)given->voxels;
    space.origin[axis] = given->centred ? (b->low[axis] / 2 + b->high[axis] / 2) - side / 2 : b->low[axis];
  }
  return space;
}

/* ---- The voxels ---- */

static vxm_voxelize_options voxelize_options_of(const binvox_request *given) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  if (given->exact) {
    options.mode = VXM_MODE_SURFACE;
    return options;
  }
  if (given->voting && !given->carving) {
    options.vote = VXM_VOTE_MAJORITY;
    options.vote_always = true;
  }
  if (given->wireframe) {
    options.mode = VXM_MODE_BOTH;
    options.surface = VXM_SURFACE_THIN;
  }
  return options;
}

/** Warnings name options of voxmend; these are what binvox has instead. The longest come first. */
static void warn_of_model(cli_run *cli, const char *model, const char *text) {
  static const char *const words[][2] = {
      {"wider --bounds, a larger grid for --like, or neither of them take in all",
       "a wider -bb, or none, takes in all"},
      {"check --bounds or --like", "check -bb"},
      {"see --bounds and --like", "see -bb"},
      {"'voxmend repair --level closed' closes it before, --confidence tells how sure each voxel is",
       "'voxmend repair --level closed' closes it before"},
      {"--vote auto asks the winding number", "without -v and -c the winding number is asked"},
      {"--thin keep or a higher resolution (-r)", "-aw, or more voxels (-d)"},
      {"--thin keep keeps them, and so may a higher resolution (-r)",
       "-aw keeps them, and so may more voxels (-d)"},
      {"a higher resolution (-r)", "more voxels (-d)"},
  };
  char line[1024];
  for (size_t w = 0; w < sizeof words / sizeof words[0]; w++) {
    const char *at = strstr(text, words[w][0]);
    if (!at)
      continue;
    snprintf(line, sizeof line, "%.*s%s%s", (int)(at - text), text, words[w][1], at + strlen(words[w][0]));
    cli_warn(cli, "%s: %s", model, line);
    return;
  }
  cli_warn(cli, "%s: %s", model, text);
}

/** Makes the grid, which is NULL before. */
static int voxelize(cli_run *cli, const binvox_request *given, vxm_grid **grid, binvox_blocks *blocks,
                    const vxm_mesh *mesh, const vxm_space *space) {
  vxm_voxelize_options options = voxelize_options_of(given);
  vxm_model *model = NULL;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_status status = vxm_model_create(&model, mesh, &options, &cli->error);
  if (status == VXM_OK)
    status = vxm_grid_create(grid, cli->context, space, &cli->error);
  if (status == VXM_OK)
    status = vxm_model_voxelize(*grid, &report, model, NULL, &cli->error);
  for (int64_t i = 0; status == VXM_OK && i < vxm_model_warning_count(model); i++)
    warn_of_model(cli, given->model, vxm_model_warning(model, i));
  int result = status == VXM_OK ? CLI_DONE : cli_fail(cli);
  if (result == CLI_DONE && given->materials && given->type == BINVOX_SCHEMATIC)
    result = binvox_blocks_make(cli, given, blocks, mesh, space);
  vxm_model_destroy(model);
  return result;
}

static int change(cli_run *cli, const binvox_request *given, vxm_grid **grid) {
  int status = CLI_DONE;
  bool carved = !given->exact && ((given->carving && !given->voting) || given->dilated);
  if (carved)
    status = binvox_carve(cli, *grid);
  if (status == CLI_DONE && carved && given->dilated)
    status = binvox_dilate(cli, *grid);
  for (int64_t n = 0; status == CLI_DONE && n < given->halvings; n++)
    status = binvox_halve(cli, grid, given->least);
  if (status == CLI_DONE && given->internal_gone)
    status = binvox_remove_internal(cli, *grid);
  if (status == CLI_DONE && given->fitted)
    status = binvox_crop(cli, grid);
  return status;
}

/* ---- What scripts read ---- */

static void say_model(const box *b, double side) {
  const double *l = b->low, *h = b->high;
  printf("bounding box: [%g, %g, %g, 1] - [%g, %g, %g, 1]\n", l[0], l[1], l[2], h[0], h[1], h[2]);
  printf("normalization transform:\n  (1) translate [%g, %g, %g, 1], (2) scale %g, (3) translate [0, 0, 0]\n",
         0 - l[0], 0 - l[1], 0 - l[2], 1 / side);
  printf("longest length: %g\n", side);
}

/** "counted" begins a line with two whole numbers and no more: scripts take all that are in it. */
static void say_voxels(const vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  int64_t begin[3], end[3];
  printf("dimensions: %" PRId64 " x %" PRId64 " x %" PRId64 "\n", dims[0], dims[1], dims[2]);
  printf("counted %" PRId64 " set voxels out of %" PRId64 "\n", vxm_grid_count(grid),
         dims[0] * dims[1] * dims[2]);
  vxm_grid_box(begin, end, grid);
  printf("area filled: %" PRId64 " x %" PRId64 " x %" PRId64 "\n", end[0] - begin[0], end[1] - begin[1],
         end[2] - begin[2]);
}

/* ---- Files ---- */

static bool is_there(const char *path) {
  struct stat info;
  return lstat(path, &info) == 0;
}

/** MODEL.type, or MODEL_1.type, MODEL_2.type ... where there are such files; false if the name is too long.
 */
static bool name_output(char path[PATH_SIZE], const binvox_request *given) {
  const char *slash = strrchr(given->model, '/'), *dot = strrchr(given->model, '.');
  const char *base = slash ? slash + 1 : given->model, *type = binvox_types[given->type];
  int kept = (int)(dot && dot > base ? dot - given->model : (ptrdiff_t)strlen(given->model));
  int length = snprintf(path, PATH_SIZE, "%.*s.%s", kept, given->model, type);
  for (int n = 1; length < PATH_SIZE && is_there(path); n++)
    length = snprintf(path, PATH_SIZE, "%.*s_%d.%s", kept, given->model, n, type);
  return length < PATH_SIZE;
}

static int write_file(cli_run *cli, const binvox_request *given, const vxm_grid *grid,
                      const binvox_blocks *blocks) {
  char path[PATH_SIZE];
  if (given->output)
    snprintf(path, sizeof path, "%s", given->output);
  else if (!name_output(path, given))
    return cli_fail_text(cli, "%.200s...: the name of the model is too long", given->model);
  if (binvox_write(cli, given, grid, blocks, path) != VXM_OK)
    return cli_fail(cli);
  cli_progress_clear(cli);
  printf("writing voxel file: %s\ndone\n", path);
  return cli_finish(cli, NULL);
}

/* ---- The whole ---- */

static int make(cli_run *cli, const binvox_request *given, vxm_mesh **mesh) {
  if (given->turns[0] && turn_mesh(cli, mesh, given->turns) != CLI_DONE)
    return CLI_FAILED;
  box found;
  if (!find_box(&found, *mesh))
    return cli_fail_text(cli, "%s: the model has no extent", given->model);
  if (given->has_box)
    for (int axis = 0; axis < 3; axis++) {
      found.low[axis] = given->box[axis];
      found.high[axis] = given->box[axis + 3];
    }
  vxm_space space = place(given, &found);
  say_model(&found, longest(&found));
  printf("voxel model dimension: %" PRId64 "\n", given->voxels);
  vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
  if (vxm_mesh_prepare_in_place(mesh, NULL, &repair, &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_grid *grid = NULL;
  binvox_blocks blocks = {.ids = NULL};
  int status = voxelize(cli, given, &grid, &blocks, *mesh, &space);
  if (status == CLI_DONE)
    status = change(cli, given, &grid);
  if (status == CLI_DONE) {
    say_voxels(grid);
    status = write_file(cli, given, grid, &blocks);
  }
  binvox_blocks_free(&blocks);
  vxm_grid_destroy(grid);
  return status;
}

static int run(cli_run *cli) {
  binvox_request given;
  if (binvox_read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  cli->arguments = (char **)&given.model;
  cli->argument_count = 1;
  cli_writes(cli, "-o", given.output, false);
  if (cli_check_names(cli) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  printf("binvox of voxmend %s, for the command lines of binvox\nloading model file: %s\n", vxm_version(),
         given.model);
  vxm_mesh *mesh = NULL;
  if (vxm_mesh_read_with(&mesh, cli->context, given.model, &cli->read, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_mesh(cli, given.model, mesh, 0);
  printf("  %s, %" PRId64 " vertices, %" PRId64 " faces\n", vxm_mesh_format(mesh),
         vxm_mesh_vertex_count(mesh), vxm_mesh_face_count(mesh));
  int status = make(cli, &given, &mesh);
  vxm_mesh_destroy(mesh);
  return status;
}

static const cli_option no_options[] = {CLI_OPTIONS_END};

const cli_command cli_command_binvox = {
    .name = "binvox",
    .arguments = "[OPTION]... MODEL",
    .summary = "voxelize a mesh as binvox's command line says",
    .notes = "",
    .options = no_options,
    .print_help = binvox_print_help,
    .run = run,
};
