/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/baseline.h"

#include <stdlib.h>
#include <string.h>

enum { FAIEGHI = VXM_BASELINE_EISEMANN + 1, FAIEGHI_VOXELS };

const char *const cli_baseline_names[] = {
    "fang-chen",    "chen-tu",  "tetra-listed", "tetra-full",     "tetra-anew",
    "tetra-layers", "density",  "simple",       "specialized",    "sorted",
    "zhang",        "eisemann", "faieghi",      "faieghi-voxels", NULL};

static bool has_surfaces(int baseline) {
  return baseline >= VXM_BASELINE_SIMPLE && baseline <= VXM_BASELINE_SORTED;
}

int cli_baseline_check(cli_run *cli, const voxelize_request *given) {
  const vxm_voxelize_options *options = &given->voxelize;
  if (given->baseline < 0)
    return CLI_END;
  if (given->sparse || given->coords || given->confidence || given->dry_run ||
      cli_field_wanted(&given->field))
    return cli_usage(cli,
                     "--baseline writes a grid of voxels and nothing else; leave out --sparse, --coords, "
                     "--confidence, --coverage, --distance, --labels, --color and --dry-run");
  if (cli_is_given(cli, "vote") || cli_is_given(cli, "thin") || options->method != VXM_METHOD_VOTE ||
      options->split_mode != VXM_SPLIT_MODE_AUTO || options->cavities != VXM_CAVITIES_AUTO)
    return cli_usage(cli,
                     "--baseline %s is a method of its own; leave out --method, --vote, --parts, "
                     "--cavities and --thin",
                     cli_baseline_names[given->baseline]);
  if (options->mode != VXM_MODE_SOLID && (!has_surfaces(given->baseline) || options->mode == VXM_MODE_BOTH ||
                                          options->surface > VXM_SURFACE_THIN))
    return cli_usage(cli,
                     "--baseline simple, specialized and sorted have --mode surface, conservative or thin; "
                     "of others leave out --mode");
  if (given->engine.name && given->baseline < FAIEGHI)
    return cli_usage(cli, "--baseline %s is done by the CPU; leave out --engine",
                     cli_baseline_names[given->baseline]);
  if (!given->engine.name && given->baseline >= FAIEGHI)
    return cli_usage(cli, "--baseline faieghi is a program for OpenCL; add --engine opencl");
  return CLI_END;
}

/* ---- Figures ---- */

static void add_count(json_t *figures, const char *name, int64_t value) {
  if (value > 0)
    json_object_set_new(figures, name, json_integer(value));
}

json_t *cli_baseline_figures(const vxm_baseline_report *report) {
  json_t *figures = json_object();
  json_object_set_new(figures, "setup_ms", json_real(report->setup_ms));
  json_object_set_new(figures, "fill_ms", json_real(report->fill_ms));
  add_count(figures, "parts", report->parts);
  add_count(figures, "rounds", report->rounds);
  add_count(figures, "tests", report->tests);
  add_count(figures, "sections", report->sections);
  if (report->boxes[0] + report->boxes[1] + report->boxes[2] > 0) {
    json_object_set_new(figures, "boxes_1d", json_integer(report->boxes[0]));
    json_object_set_new(figures, "boxes_2d", json_integer(report->boxes[1]));
    json_object_set_new(figures, "boxes_3d", json_integer(report->boxes[2]));
  }
  add_count(figures, "bytes", (int64_t)report->bytes);
  return figures;
}

/** The same of the OpenCL program. */
static json_t *published_figures(const vxm_published_report *report) {
  json_t *figures = json_object();
  json_object_set_new(figures, "kernel_ms", json_real(report->kernel_ms));
  json_object_set_new(figures, "profiled", json_boolean(report->profiled));
  add_count(figures, "triangles", report->triangles);
  add_count(figures, "work_group", report->work_group);
  add_count(figures, "tests", report->tests);
  return figures;
}

void cli_figures_text(char *text, size_t size, const json_t *figures) {
  const char *name;
  json_t *value;
  size_t length = 0;
  *text = '\0';
  json_object_foreach((json_t *)figures, name, value) {
    const char *separator = length > 0 ? ", " : "";
    int added = json_is_boolean(value)   ? snprintf(text + length, size - length, "%s%s %s", separator, name,
                                                  json_is_true(value) ? "yes" : "no")
                : json_is_integer(value) ? snprintf(text + length, size - length, "%s%s %lld", separator,
                                                    name, (long long)json_integer_value(value))
                                         : snprintf(text + length, size - length, "%s%s %.3g", separator,
                                                    name, json_real_value(value));
    length += added > 0 ? (size_t)added : 0;
    if (length >= size)
      return;
  }
}

/* ---- Grids ---- */

static vxm_status make_baseline(vxm_grid **out, cli_run *cli, voxelize_request *given,
                                voxelize_outcome *results) {
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  vxm_baseline_report report = VXM_BASELINE_REPORT_INIT;
  options.method = (vxm_baseline)given->baseline;
  options.thin = given->voxelize.surface == VXM_SURFACE_THIN;
  vxm_status status = vxm_grid_create(out, cli->context, &results->space, &cli->error);
  if (status == VXM_OK)
    status = vxm_baseline_voxelize(*out, &report, results->input.mesh, &options, &cli->error);
  results->figures = cli_baseline_figures(&report);
  return status;
}

/** A grid of the bytes of the published program, x fastest. */
static vxm_status pack(vxm_grid **out, cli_run *cli, const vxm_space *space, const uint8_t *bytes) {
  vxm_status status = vxm_grid_create(out, cli->context, space, &cli->error);
  for (int64_t k = 0; status == VXM_OK && k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < space->dims[0]; i++)
        if (*bytes++)
          vxm_grid_set(*out, i, j, k, true);
  return status;
}

static vxm_status read_voxels(vxm_grid **out, cli_run *cli, vxm_published *published,
                              const vxm_space *space) {
  size_t count = (size_t)space->dims[0] * (size_t)space->dims[1] * (size_t)space->dims[2];
  uint8_t *bytes = malloc(count); /* the device has as many */
  if (!bytes) {
    cli->error.code = VXM_ERROR_MEMORY;
    snprintf(cli->error.text, sizeof cli->error.text, "no memory for %zu voxels of a byte each", count);
    return VXM_ERROR_MEMORY;
  }
  vxm_status status = vxm_published_read(bytes, NULL, published, VXM_TRANSFER_READ, &cli->error);
  if (status == VXM_OK)
    status = pack(out, cli, space, bytes);
  free(bytes);
  return status;
}

/** Its grid is its own: the box of the vertices, divided by the size of a voxel. */
static vxm_status make_published(vxm_grid **out, cli_run *cli, voxelize_request *given,
                                 voxelize_outcome *results) {
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  vxm_published_report report = VXM_PUBLISHED_REPORT_INIT;
  vxm_published *published = NULL;
  options.voxel_size = results->space.voxel_size[0];
  options.count_tests = true;
  options.by_voxel = given->baseline == FAIEGHI_VOXELS;
  vxm_status status = cli_engine_open(cli, &given->engine);
  if (status == VXM_OK)
    status = vxm_published_create(&published, &results->space, given->engine.engine, results->input.mesh,
                                  &options, &cli->error);
  if (status == VXM_OK)
    status = vxm_published_voxelize(&report, published, &cli->error);
  if (status == VXM_OK)
    status = read_voxels(out, cli, published, &results->space);
  results->figures = published_figures(&report);
  vxm_published_destroy(published);
  return status;
}

int cli_baseline_write(cli_run *cli, voxelize_request *given, voxelize_outcome *results) {
  vxm_grid *grid = NULL;
  double start = cli_clock();
  vxm_status status = given->baseline >= FAIEGHI ? make_published(&grid, cli, given, results)
                                                 : make_baseline(&grid, cli, given, results);
  double made = cli_clock();
  if (status == VXM_OK)
    status = vxm_grid_write(grid, given->output, &given->write, &cli->error);
  results->voxelize_ms = made - start;
  results->write_ms = cli_clock() - made;
  if (status == VXM_OK) {
    results->voxelize.voxels = vxm_grid_count(grid);
    results->voxelize.hash = vxm_grid_hash(grid);
    cli_warn_lattice(cli, given->output, given->write.format, &results->space);
  }
  vxm_grid_destroy(grid);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}
