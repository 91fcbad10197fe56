/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/baseline.h"

#include <inttypes.h>

static json_t *sparse_json(const voxelize_outcome *results) {
  json_t *object = json_object();
  json_object_set_new(object, "bricks", json_integer(results->sparse.bricks));
  json_object_set_new(object, "nodes", json_integer(results->sparse.nodes));
  json_object_set_new(object, "bytes", json_integer((json_int_t)results->sparse.bytes));
  return object;
}

static json_t *thin_json(const vxm_voxelize_report *report) {
  json_t *object = json_object();
  json_object_set_new(object, "voxels", json_integer(report->thin_voxels));
  json_object_set_new(object, "share", cli_json_number(report->thin_share));
  return object;
}

static json_t *estimate_json(const vxm_estimate *estimate, bool octree) {
  json_t *object = json_object();
  json_object_set_new(object, "grid_bytes", json_integer((json_int_t)estimate->grid_bytes));
  if (octree) /* its memory follows the surface, which is not known before */
    return object;
  json_object_set_new(object, "memory_bytes", json_integer((json_int_t)estimate->memory_bytes));
  json_object_set_new(object, "passes", json_integer(estimate->passes));
  return object;
}

json_t *voxelize_report(const cli_run *cli, const voxelize_request *given, const voxelize_outcome *results) {
  json_t *votes = json_object();
  json_object_set_new(votes, "contested", json_integer(results->voxelize.contested));
  json_object_set_new(votes, "winding_decided", json_integer(results->voxelize.winding_decided));
  json_t *times = json_object();
  json_object_set_new(times, "read", json_real(results->input.read_ms));
  json_object_set_new(times, "repair", json_real(results->input.repair_ms));
  json_object_set_new(times, "voxelize", json_real(results->voxelize_ms));
  json_object_set_new(times, "write", json_real(results->write_ms));
  json_object_set_new(times, "total", json_real(results->total_ms));
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "repair", cli_passes_json(&results->input.repair));
  if (!given->field.labels && given->baseline < 0)
    json_object_set_new(report, "estimate", estimate_json(&results->estimate, results->octree));
  json_object_set_new(report, "grid", cli_json_space(&results->space));
  if (given->dry_run) {
    json_decref(votes);
    json_decref(times);
    json_object_set(report, "warnings", cli->warnings);
    return report;
  }
  if (given->engine.engine)
    json_object_set_new(report, "engine", cli_engine_json(&given->engine));
  json_object_set_new(report, "components", json_integer(results->voxelize.components));
  if (given->baseline >= 0) {
    json_object_set_new(report, "baseline", json_string(cli_baseline_names[given->baseline]));
    json_object_set(report, "figures", results->figures);
  }
  json_object_set_new(report, "parts", json_integer(results->voxelize.parts));
  json_object_set_new(report, "closed_parts", json_integer(results->voxelize.closed_parts));
  json_object_set_new(report, "capped_parts", json_integer(results->voxelize.capped_parts));
  json_object_set_new(report, "caps", json_integer(results->voxelize.caps));
  json_object_set_new(report, "cavities", json_integer(results->voxelize.cavities));
  json_object_set_new(report, "self_overlapping_parts",
                      json_integer(results->voxelize.self_overlapping_parts));
  json_object_set_new(report, "hollow_overlaps", json_integer(results->voxelize.hollow_overlaps));
  json_object_set_new(report, "filled_overlaps", json_integer(results->voxelize.filled_overlaps));
  json_object_set_new(report, "empty_parts", json_integer(results->voxelize.empty_parts));
  json_object_set_new(report, "outside_parts", json_integer(results->voxelize.outside_parts));
  json_object_set_new(report, "votes", votes);
  if (!given->field.coverage && !given->field.distance)
    json_object_set_new(report, "thin", thin_json(&results->voxelize));
  if (cli_field_wanted(&given->field))
    cli_field_json(report, &given->field);
  else {
    json_object_set_new(report, "voxels", json_integer(results->voxelize.voxels));
    json_object_set_new(report, "hash", cli_json_hash(results->voxelize.hash));
    if (results->octree)
      json_object_set_new(report, "sparse", sparse_json(results));
  }
  json_object_set_new(report, "time_ms", times);
  json_object_set_new(report, "peak_bytes", json_integer((json_int_t)vxm_context_peak_bytes(cli->context)));
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

/** "exact_weld 12, degenerate 3", or "nothing to do". */
static void summarize_repair(const cli_run *cli, const vxm_repair_report *repair) {
  const char *separator = "";
  fprintf(cli->text, "%-10s ", "repair");
  for (int i = 0; i < repair->pass_count; i++)
    if (repair->passes[i].count > 0 || cli->verbose) {
      fprintf(cli->text, "%s%s %" PRId64, separator, repair->passes[i].pass, repair->passes[i].count);
      separator = ", ";
    }
  fprintf(cli->text, "%s\n", *separator ? "" : repair->pass_count ? "nothing to do" : "not wanted");
}

/** "3 made of 5 components: 1 closed, 1 closed by caps over 7 rims, 1 of all that stay open"; kinds without a
 * part are left out. */
static void summarize_parts(const cli_run *cli, const vxm_voxelize_report *report) {
  int64_t open = report->parts - report->closed_parts - report->capped_parts;
  const char *separator = ": ";
  fprintf(cli->text, "%-10s %" PRId64, "parts", report->parts);
  if (report->components > report->parts)
    fprintf(cli->text, " made of %" PRId64 " components", report->components);
  if (report->closed_parts > 0) {
    fprintf(cli->text, "%s%" PRId64 " closed", separator, report->closed_parts);
    separator = ", ";
  }
  if (report->capped_parts > 0) {
    fprintf(cli->text, "%s%" PRId64 " closed by caps over %" PRId64 " rims", separator, report->capped_parts,
            report->caps);
    separator = ", ";
  }
  if (open > 0)
    fprintf(cli->text, "%s%" PRId64 " %s", separator, open,
            open == 1 && report->components > report->parts ? "of all that stay open" : "open");
  fputc('\n', cli->text);
}

/** What is known before the voxels are made. */
static void summarize_input(const cli_run *cli, const voxelize_outcome *results) {
  const cli_input *input = &results->input;
  cli_row(cli, "input", "%s (%s): %" PRId64 " vertices, %" PRId64 " faces", cli_shown(input->path, "<stdin>"),
          input->format, input->vertices, input->faces);
  summarize_repair(cli, &input->repair);
  cli_rows_space(cli, &results->space);
}

bool voxelize_is_told_before(const voxelize_request *given, const voxelize_outcome *results) {
  const uint64_t large = UINT64_C(1) << 26; /* 64 MiB */
  return given->baseline < 0 && (given->dry_run || results->estimate.grid_bytes >= large);
}

static void summarize_estimate(const cli_run *cli, const voxelize_request *given,
                               const voxelize_outcome *results) {
  const vxm_estimate *estimate = &results->estimate;
  char size[24], memory[24];
  cli_bytes_text(size, estimate->grid_bytes);
  if (results->octree)
    cli_row(cli, "estimate", "%s of voxels, made as an octree: its memory follows the surface", size);
  else
    cli_row(cli, "estimate", "%s of %s; up to %s of memory, %s", size,
            cli_field_wanted(&given->field) ? "values" : "voxels",
            cli_bytes_text(memory, estimate->memory_bytes),
            estimate->passes > 1 ? "slices at a time" : "all at once");
  fflush(cli->text);
}

void voxelize_summarize_begin(const cli_run *cli, const voxelize_request *given,
                              const voxelize_outcome *results) {
  summarize_input(cli, results);
  summarize_estimate(cli, given, results);
}

void voxelize_summarize(const cli_run *cli, const voxelize_request *given, const voxelize_outcome *results) {
  const cli_input *input = &results->input;
  const vxm_voxelize_report *report = &results->voxelize;
  const vxm_space *space = &results->space;
  double cells = (double)space->dims[0] * (double)space->dims[1] * (double)space->dims[2];
  char bytes[24];
  if (!voxelize_is_told_before(given, results))
    summarize_input(cli, results);
  cli_engine_summarize(cli, &given->engine);
  if (report->parts > 0) /* none were looked for where no solid was made */
    summarize_parts(cli, report);
  if (report->cavities > 0)
    cli_row(cli, "cavities", "%" PRId64, report->cavities);
  if (report->self_overlapping_parts > 0)
    cli_row(cli, "overlap", "%" PRId64 " of the parts run%s through %s, and %s filled there",
            report->self_overlapping_parts, report->self_overlapping_parts == 1 ? "s" : "",
            report->self_overlapping_parts == 1 ? "itself" : "themselves",
            report->self_overlapping_parts == 1 ? "is" : "are");
  if (cli_field_wanted(&given->field))
    cli_field_summarize(cli, &given->field);
  else
    cli_row(cli, "voxels", "%" PRId64 " (%.2f %%)", report->voxels, 100.0 * (double)report->voxels / cells);
  if (report->thin_voxels > 0 && report->thin_share == 0)
    cli_row(cli, "thin", "%" PRId64 " voxels added at rims and tips that are thinner than a voxel",
            report->thin_voxels);
  else if (report->thin_voxels > 0)
    cli_row(cli, "thin",
            "%" PRId64 " voxels added for the %.3g %% of the surface that is thinner than a voxel",
            report->thin_voxels, 100 * report->thin_share);
  if (given->baseline >= 0) {
    char figures[512];
    cli_figures_text(figures, sizeof figures, results->figures);
    cli_row(cli, "baseline", "%s: %s", cli_baseline_names[given->baseline], figures);
  } else
    cli_row(cli, "contested", "%" PRId64 "%s", report->contested,
            report->contested == 0        ? ""
            : report->winding_decided > 0 ? " (open parts, decided by the winding number)"
                                          : " (open parts: the voters disagreed there)");
  if (report->winding_decided > report->contested)
    cli_row(cli, "winding", "%" PRId64 " voxels decided by the winding number", report->winding_decided);
  if (results->octree)
    cli_row(cli, "octree", "%" PRId64 " bricks, %" PRId64 " nodes, %s", results->sparse.bricks,
            results->sparse.nodes, cli_bytes_text(bytes, results->sparse.bytes));
  if (!cli_field_wanted(&given->field))
    cli_row(cli, "hash", "%016" PRIx64, report->hash);
  cli_row(cli, "time", "%.1f ms: read %.1f, repair %.1f, voxelize %.1f, write %.1f", results->total_ms,
          input->read_ms, input->repair_ms, results->voxelize_ms, results->write_ms);
  if (cli->verbose) {
    cli_row(cli, "threads", "%d", vxm_context_threads(cli->context));
    cli_row(cli, "memory", "%s", cli_bytes_text(bytes, vxm_context_peak_bytes(cli->context)));
  }
  cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
}
