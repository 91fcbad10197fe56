/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/field.h"
#include "base/clock.h"
#include "base/exact_math.h"
#include "grid/bit_transpose.h"
#include "gridio/formats/octree/octree_values.h"
#include "gridio/gridio.h"
#include "voxel/fields/distance_nodes.h"

#include <math.h>
#include <string.h>

/** What is made of a model. */
typedef struct request {
  const vxm_space *space;
  const char *path;
  const vxm_grid_format *format;
  vxm_about about;
  vxm_values_spec values;
} request;

/** The format of a file, if it holds such values. */
static vxm_status choose_format(request *r, const char *format, vxm_error *error) {
  r->values.about = &r->about;
  r->values.channels = 1;
  r->format = vxm_grid_format_holding(r->path, format, VXM_HOLDS_NUMBERS, "a number per voxel goes", error);
  if (!r->format)
    return VXM_ERROR_ARGUMENT;
  const vxm_values_writer_kind *kind = r->format->values;
  return kind && kind->check ? kind->check(r->space, &r->values, r->path, error) : VXM_OK;
}

/** Whether slices are written as they are made; else all are made first. */
static bool streams(const request *r) {
  return r->format->values && (r->format->values->holds & VXM_HOLDS_NUMBERS);
}

static bool takes_tiles(const request *r) {
  return streams(r) && r->format->values->put_tile;
}

/** The order in which values are made. */
static vxm_layout layout_of(const request *r) {
  return streams(r) ? r->format->values->layout : (vxm_layout)VXM_PLANE_Z_FAST;
}

static uint64_t values_bytes(const request *r) {
  return vxm_space_voxels(r->space) * vxm_scalar_bytes(r->values.scalar);
}

/* ---- A file in the making ---- */

typedef struct field_file {
  const request *request;
  vxm_values_writer writer;
  vxm_field *whole; /**< NULL: values are written as they come */
  double write_ms;
} field_file;

static vxm_status put_values(void *payload, const void *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  field_file *file = payload;
  double start = vxm_clock_ms();
  vxm_status status = vxm_values_writer_put(&file->writer, values, begin, end, error);
  file->write_ms += vxm_clock_ms() - start;
  return status;
}

static vxm_status put_tile(void *payload, const vxm_value_tile *tile, vxm_error *error) {
  field_file *file = payload;
  return file->writer.kind->put_tile(&file->writer, tile, error);
}

static vxm_status open_file(field_file *file, vxm_field_target *target, vxm_context *context,
                            const request *r, vxm_error *error) {
  *file = (field_file){.request = r};
  *target = (vxm_field_target){.layout = layout_of(r), .put = put_values, .payload = file};
  if (takes_tiles(r))
    target->put_tile = put_tile;
  if (streams(r))
    return vxm_values_writer_open(&file->writer, r->format->values, context, r->space, &r->values, r->path,
                                  error);
  vxm_status status = vxm_field_make(&file->whole, context, r->space, r->about.kind, r->values.scalar, error);
  if (status != VXM_OK)
    return status;
  file->whole->about.is_declared = true;
  target->whole = file->whole->values;
  return VXM_OK;
}

/** Ends a file: with `status` not VXM_OK none is left. */
static vxm_status close_file(field_file *file, vxm_status status, vxm_error *error) {
  double start = vxm_clock_ms();
  if (status == VXM_OK && file->whole)
    status = vxm_gridio_write_field(file->whole, file->request->path, file->request->format->name, error);
  else if (status == VXM_OK)
    status = vxm_values_writer_commit(&file->writer, error);
  else
    vxm_values_writer_abort(&file->writer);
  vxm_field_destroy(file->whole);
  file->write_ms += vxm_clock_ms() - start;
  return status;
}

static void set_times(vxm_voxelize_report *report, const field_file *file, double start) {
  report->write_ms = file->write_ms;
  report->fill_ms = vxm_clock_ms() - start - file->write_ms;
}

/* ---- Coverage and distance ---- */

static vxm_status request_coverage(request *out, const vxm_space *space, const char *path,
                                   const vxm_coverage_options *options, vxm_error *error) {
  *out = (request){.space = space,
                   .path = path,
                   .about = {.is_declared = true, .kind = VXM_FIELD_COVERAGE},
                   .values = {.scalar = options->scalar}};
  return choose_format(out, options->format, error);
}

vxm_status vxm_field_write_coverage(vxm_coverage_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_coverage_options *options, vxm_error *error) {
  request r;
  field_file file;
  vxm_field_target target;
  double start = vxm_clock_ms();
  vxm_status status = request_coverage(&r, space, path, options, error);
  if (status == VXM_OK)
    status = open_file(&file, &target, model->context, &r, error);
  if (status != VXM_OK)
    return status;
  status = vxm_coverage_run(&target, report, model, space, options, error);
  status = close_file(&file, status, error);
  set_times(report->voxelize, &file, start);
  return status;
}

/** Without a band there is no number for what lies beyond: that of the diagonal stands for it. */
static float distance_beyond(const vxm_distance_options *options, const vxm_space *space) {
  float limit = vxm_distance_limit(options, space);
  double side[3];
  for (int a = 0; a < 3; a++)
    side[a] = (double)space->dims[a] * space->voxel_size[a];
  return isinf(limit) ? (float)vxm_length3(side[0], side[1], side[2]) : limit;
}

static vxm_status request_distance(request *out, const vxm_space *space, const char *path,
                                   const vxm_distance_options *options, vxm_error *error) {
  *out = (request){.space = space,
                   .path = path,
                   .about = {.is_declared = true, .kind = VXM_FIELD_DISTANCE},
                   .values = {.scalar = VXM_FLOAT32,
                              .is_signed = !options->is_unsigned,
                              .background = distance_beyond(options, space)}};
  vxm_status status = choose_format(out, options->format, error);
  out->values.in_tiles = status == VXM_OK && takes_tiles(out) && vxm_distance_is_narrow(options);
  return status;
}

/** Whether only what is near the surface is made, for an octree. */
static bool takes_nodes(const request *r, const vxm_model *model, const vxm_distance_options *options) {
  return r->format->values == &vxm_octree_values && vxm_distance_nodes_are_for(options) &&
         !model->options.confidence;
}

static vxm_status write_nodes(vxm_distance_report *report, vxm_model *model, const request *r,
                              const vxm_distance_options *options, vxm_error *error) {
  vxm_distance_nodes *nodes;
  vxm_values_writer writer = {0};
  double start = vxm_clock_ms();
  vxm_status status = vxm_distance_nodes_create(&nodes, model, r->space, options, error);
  if (status != VXM_OK)
    return status;
  vxm_node_maker maker = vxm_distance_nodes_maker(nodes);
  status = vxm_values_writer_open(&writer, &vxm_octree_values, model->context, r->space, &r->values, r->path,
                                  error);
  if (status == VXM_OK)
    status = vxm_octree_values_make(&writer, &maker, error);
  if (status == VXM_OK)
    status = vxm_distance_nodes_report(report, nodes, error);
  vxm_distance_nodes_destroy(nodes);
  report->voxelize->fill_ms = vxm_clock_ms() - start;
  if (status == VXM_OK)
    status = vxm_values_writer_commit(&writer, error);
  vxm_values_writer_abort(&writer);
  report->voxelize->write_ms = vxm_clock_ms() - start - report->voxelize->fill_ms;
  return status;
}

vxm_status vxm_field_write_distance(vxm_distance_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_distance_options *options, vxm_error *error) {
  request r;
  field_file file;
  vxm_field_target target;
  double start = vxm_clock_ms();
  vxm_status status = request_distance(&r, space, path, options, error);
  if (status == VXM_OK && takes_nodes(&r, model, options))
    return write_nodes(report, model, &r, options, error);
  if (status == VXM_OK)
    status = open_file(&file, &target, model->context, &r, error);
  if (status != VXM_OK)
    return status;
  status = vxm_distance_run(&target, report, model, space, options, error);
  status = close_file(&file, status, error);
  set_times(report->voxelize, &file, start);
  return status;
}

/* ---- Estimates ---- */

/** The files' own buffers and the sidecar. */
static const uint64_t file_bytes = UINT64_C(1) << 19;

static vxm_estimate estimate_of(const vxm_field_plan *plan, const request *r) {
  uint64_t values = values_bytes(r);
  const vxm_values_writer_kind *kind = r->format->values;
  uint64_t held = streams(r) && kind->held_bytes ? kind->held_bytes(r->space, &r->values) : 0;
  return (vxm_estimate){.grid_bytes = values,
                        .memory_bytes = plan->memory + (streams(r) ? 0 : values) + held + file_bytes,
                        .passes = (r->space->dims[layout_of(r).slow] + plan->slices - 1) / plan->slices};
}

vxm_status vxm_field_estimate_coverage(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_coverage_options *options,
                                       vxm_error *error) {
  request r;
  vxm_field_plan plan;
  vxm_status status = request_coverage(&r, space, path, options, error);
  if (status == VXM_OK)
    status = vxm_coverage_plan(&plan, model, space, layout_of(&r), !streams(&r), options, error);
  if (status == VXM_OK)
    *out = estimate_of(&plan, &r);
  return status;
}

vxm_status vxm_field_estimate_distance(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_distance_options *options,
                                       vxm_error *error) {
  request r;
  vxm_field_plan plan;
  vxm_status status = request_distance(&r, space, path, options, error);
  if (status == VXM_OK && takes_nodes(&r, model, options)) {
    uint64_t memory = vxm_distance_nodes_bytes(model, options) + file_bytes;
    *out = (vxm_estimate){.grid_bytes = values_bytes(&r), .memory_bytes = memory, .passes = 1};
    return vxm_memory_check(model->context, memory, "distances", error);
  }
  if (status == VXM_OK)
    status = vxm_distance_plan(&plan, model, space, layout_of(&r),
                               vxm_distance_way_of(!streams(&r), takes_tiles(&r), options), options, error);
  if (status == VXM_OK)
    *out = estimate_of(&plan, &r);
  return status;
}
