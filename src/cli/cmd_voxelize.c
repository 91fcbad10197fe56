/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend voxelize: mesh in, voxel grid out. */
#include "cli/baseline.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- Work ---- */

/** Takes the space of the grid, or field, named by --like. */
static int read_like(cli_run *cli, vxm_space *out, const char *path) {
  vxm_grid *grid = NULL;
  if (vxm_grid_read_space(&grid, cli->context, path, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_grid(cli, path, grid);
  *out = *vxm_grid_space(grid);
  vxm_grid_destroy(grid);
  return CLI_DONE;
}

/** The most voxels that the model's box has along an axis, in parts. */
static double voxels_along(const vxm_mesh *mesh, const vxm_space *space) {
  const double *at = vxm_mesh_vertices(mesh);
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
  for (int64_t v = 0, count = vxm_mesh_vertex_count(mesh); v < count; v++, at += 3)
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], at[a]);
      high[a] = fmax(high[a], at[a]);
    }
  for (int a = 0; a < 3; a++)
    most = fmax(most, (high[a] - low[a]) / space->voxel_size[a]);
  return most;
}

/** Warns where the model fills few voxels of the grid of --like: most often that is in other units. */
static void warn_of_coarse_like(cli_run *cli, const voxelize_request *given,
                                const voxelize_outcome *results) {
  const double few = 3;
  double along = given->like ? voxels_along(results->input.mesh, &results->space) : few;
  if (along < few)
    cli_warn(cli,
             "%s: the model is %.2g voxels long in the grid of %s: is it in the same units? Without --like "
             "-r sets its size",
             cli_shown(given->input, "<stdin>"), along, given->like);
}

static void warn_of_model(cli_run *cli, const voxelize_request *given, const voxelize_outcome *results,
                          const vxm_model *model) {
  for (int64_t i = 0; i < vxm_model_warning_count(model); i++)
    cli_warn(cli, "%s: %s", cli_shown(given->input, "<stdin>"), vxm_model_warning(model, i));
  warn_of_coarse_like(cli, given, results);
  cli_warn_lattice(cli, given->output, given->write.format, &results->space);
}

/** Makes the grid as a whole, as its confidence and coordinates are made of it. */
static int write_whole(cli_run *cli, const voxelize_request *given, voxelize_outcome *results,
                       vxm_model *model) {
  double start = cli_clock();
  vxm_grid *grid = NULL;
  vxm_status status = vxm_grid_create(&grid, cli->context, &results->space, &cli->error);
  if (status == VXM_OK)
    status = vxm_model_voxelize(grid, &results->voxelize, model, NULL, &cli->error);
  double made = cli_clock();
  if (status == VXM_OK)
    status = vxm_grid_write(grid, given->output, &given->write, &cli->error);
  results->voxelize_ms += made - start;
  if (status == VXM_OK) {
    if (given->confidence)
      status = vxm_grid_write_confidence(grid, given->confidence, &cli->error);
    if (status == VXM_OK && given->coords)
      status = vxm_grid_write_coords(grid, given->coords, &cli->error);
  }
  results->write_ms = cli_clock() - made;
  vxm_grid_destroy(grid);
  if (status != VXM_OK)
    return cli_fail(cli);
  warn_of_model(cli, given, results, model);
  return CLI_DONE;
}

static int write_sparse(cli_run *cli, const voxelize_request *given, voxelize_outcome *results,
                        vxm_model *model) {
  vxm_sparse *sparse;
  double start = cli_clock();
  if (vxm_model_sparse(&sparse, &results->voxelize, model, &results->space, NULL, &cli->error) != VXM_OK)
    return cli_fail(cli);
  results->sparse.bricks = vxm_sparse_bricks(sparse);
  results->sparse.nodes = vxm_sparse_nodes(sparse);
  results->sparse.bytes = vxm_sparse_bytes(sparse);
  double made = cli_clock();
  vxm_status status = vxm_sparse_write(sparse, given->output, &given->write, &cli->error);
  results->voxelize_ms += made - start;
  if (status == VXM_OK) {
    if (given->coords)
      status = vxm_sparse_write_coords(sparse, given->coords, &cli->error);
  }
  results->write_ms = cli_clock() - made;
  vxm_sparse_destroy(sparse);
  if (status != VXM_OK)
    return cli_fail(cli);
  warn_of_model(cli, given, results, model);
  return CLI_DONE;
}

static int write_model(cli_run *cli, voxelize_request *given, voxelize_outcome *results, vxm_model *model) {
  double start = cli_clock();
  vxm_status status = cli_field_wanted(&given->field)
                          ? cli_field_write(cli, &given->field, &results->voxelize, model, &results->space,
                                            given->output, given->write.format)
                          : vxm_model_write(&results->voxelize, model, &results->space, given->output,
                                            &given->write, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  results->write_ms = results->voxelize.write_ms;
  results->voxelize_ms += cli_clock() - start - results->write_ms;
  warn_of_model(cli, given, results, model);
  return CLI_DONE;
}

/** From this size on a grid that would have to be held whole is made as an octree. */
static const uint64_t LARGE_GRID = UINT64_C(1) << 26;

/**
 * Whether the voxels are made as an octree. A grid that is written range after range of slices needs none,
 * and is faster without; what has to be held whole is another matter.
 */
static bool takes_octree(const voxelize_request *given, const voxelize_outcome *results) {
  if (given->sparse)
    return true;
  return given->coords && !given->confidence && !given->engine.name &&
         voxelize_is_sliced(given->write.format) && results->estimate.grid_bytes >= LARGE_GRID;
}

/** The memory of a grid, whose rows are whole words. */
static uint64_t bytes_of_bits(const vxm_space *space) {
  return (uint64_t)(space->dims[0] + 63) / 64 * 8 * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
}

/** Makes the model, tells the memory it will take, and, unless only that is wanted, writes the grid. */
static int make_file(cli_run *cli, voxelize_request *given, voxelize_outcome *results) {
  const vxm_mesh *mesh = results->input.mesh;
  vxm_model *model = NULL;
  double start = cli_clock();
  vxm_status status = vxm_space_fit(&results->space, mesh, &given->space, &cli->error);
  if (status == VXM_OK && !given->dry_run)
    status = cli_engine_open(cli, &given->engine);
  given->voxelize.engine = given->engine.engine;
  if (status == VXM_OK)
    status = vxm_model_create(&model, mesh, &given->voxelize, &cli->error);
  if (status == VXM_OK && given->sparse) /* what an octree takes is known when it is made */
    results->estimate.grid_bytes = bytes_of_bits(&results->space);
  else if (status == VXM_OK && cli_field_wanted(&given->field))
    status = cli_field_estimate(cli, &given->field, &results->estimate, model, &results->space, given->output,
                                given->write.format);
  else if (status == VXM_OK)
    status = vxm_model_estimate(&results->estimate, model, &results->space, given->output, &given->write,
                                &cli->error);
  results->octree = takes_octree(given, results);
  results->voxelize_ms = cli_clock() - start;
  int result = status == VXM_OK ? CLI_DONE : cli_fail(cli);
  if (result == CLI_DONE && cli_summary(cli) && voxelize_is_told_before(given, results)) {
    cli_progress_clear(cli);
    voxelize_summarize_begin(cli, given, results);
  }
  if (result == CLI_DONE && !given->dry_run)
    result = results->octree                      ? write_sparse(cli, given, results, model)
             : given->confidence || given->coords ? write_whole(cli, given, results, model)
                                                  : write_model(cli, given, results, model);
  vxm_model_destroy(model);
  return result;
}

/** As make_file, by a published method. */
static int make_baseline(cli_run *cli, voxelize_request *given, voxelize_outcome *results) {
  if (vxm_space_fit(&results->space, results->input.mesh, &given->space, &cli->error) != VXM_OK)
    return cli_fail(cli);
  results->estimate.grid_bytes = bytes_of_bits(&results->space);
  return cli_baseline_write(cli, given, results);
}

static int run(cli_run *cli) {
  voxelize_request given = {.baseline = -1,
                            .repair = VXM_REPAIR_OPTIONS_INIT,
                            .space = VXM_SPACE_OPTIONS_INIT,
                            .voxelize = VXM_VOXELIZE_OPTIONS_INIT,
                            .write = VXM_GRID_WRITE_OPTIONS_INIT,
                            .field = CLI_FIELD_INIT,
                            .engine = CLI_ENGINE_INIT};
  if (voxelize_read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  double start = cli_clock();
  vxm_space like;
  if (given.like) {
    if (read_like(cli, &like, given.like) != CLI_DONE)
      return CLI_FAILED;
    given.space.like = &like;
  }
  voxelize_outcome results = {.voxelize = VXM_VOXELIZE_REPORT_INIT, .estimate = VXM_ESTIMATE_INIT};
  const vxm_repair_options *repair = given.no_repair ? NULL : &given.repair;
  if (cli_read_divided(cli, &results.input, given.input, given.field.label_options.by, repair) != CLI_DONE)
    return CLI_FAILED;
  cli_color_take(&given.field, &results.input);
  int status = given.baseline >= 0 ? make_baseline(cli, &given, &results) : make_file(cli, &given, &results);
  vxm_mesh_destroy(results.input.mesh);
  vxm_mesh_destroy(results.input.as_read);
  if (status == CLI_DONE) {
    results.total_ms = cli_clock() - start;
    cli_progress_clear(cli);
    cli_engine_warn(cli, &given.engine);
    if (cli_summary(cli) && !given.dry_run)
      voxelize_summarize(cli, &given, &results);
    status = cli_finish(cli, voxelize_report(cli, &given, &results));
  }
  json_decref(given.field.label_table);
  json_decref(results.figures);
  vxm_engine_destroy(given.engine.engine);
  return status;
}

const cli_command cli_command_voxelize = {
    .name = "voxelize",
    .arguments = "MESH -o GRID [OPTION]...",
    .summary = "turn a mesh into a voxel grid",
    .notes =
        "The mesh is repaired first, as by 'voxmend repair'. Voxel (i,j,k) is set where its centre,\n"
        "origin + ((i,j,k) + 1/2) * size, is inside the mesh, and where parts thinner than a voxel would\n"
        "fall apart without it, unless --thin drop says that centres alone count.\n\n"
        "Examples:\n"
        "  voxmend voxelize chair.off -o chair.binvox\n"
        "  voxmend voxelize part.stl -o part.npy --voxel-size 0.5 --fit tight --pad 1\n"
        "  voxmend voxelize second.stl -o second.npy --like part.npy\n"
        "  voxmend voxelize chair.off -o chair.nrrd --distance signed --band 5\n"
        "  voxmend voxelize chair.off -o - --format rle -r 64 | wc -c",
    .options = voxelize_options,
    .run = run,
};
