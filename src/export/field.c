/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/field.h"
#include "base/clock.h"
#include "base/endian.h"
#include "grid/bit_transpose.h"
#include "gridio/common/format.h"
#include "gridio/formats/npy_header.h"
#include "gridio/formats/nrrd_header.h"
#include "gridio/formats/vdb_field.h"

#include <math.h>

static const vxm_sidecar_text npy_description = {"voxmend npy", "z fastest, then y, then x", NULL};

typedef enum file_format { NPY, NRRD, VDB } file_format;

/** A file of values in the making. */
typedef struct field_file {
  const char *path;
  vxm_output *output, *sidecar; /**< the second NULL where there is none */
  vxm_vdb_field *tree;          /**< NULL: values are written as they come */
  size_t slice_bytes;
  double write_ms;
} field_file;

static vxm_status find_format(file_format *out, const char *path, const char *format, vxm_error *error) {
  static const char *const names[] = {"npy", "nrrd", "vdb"};
  const char *name = format ? format : vxm_path_extension(path);
  for (int f = NPY; f <= VDB; f++)
    if (vxm_text_equal_nocase(name, names[f])) {
      *out = (file_format)f;
      return VXM_OK;
    }
  return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                     "a number per voxel goes into .npy, .nrrd or .vdb, not \"%s\"", name);
}

/** What stands before the values, or the tree that they make; the output is open. */
static vxm_status begin_file(field_file *file, file_format format, vxm_context *context,
                             const vxm_space *space, const vxm_vdb_kind *kind, vxm_field_kind values,
                             vxm_scalar scalar, vxm_error *error) {
  const vxm_about about = {.is_declared = true, .kind = values};
  const vxm_nrrd_values header = {"a number per voxel, at its centre", scalar, 1, &about};
  if (format == VDB)
    return vxm_vdb_field_create(&file->tree, context, space, kind, error);
  vxm_status status =
      vxm_output_expect(file->output, vxm_space_voxels(space) * vxm_scalar_bytes(scalar), error);
  if (status != VXM_OK)
    return status;
  if (format == NRRD)
    return vxm_nrrd_header_write(file->output, &header, space, error);
  vxm_npy_header_write(file->output,
                       scalar == VXM_UINT8 ? "|u1"
                       : vxm_le64(1) == 1  ? "<f4"
                                           : ">f4",
                       false, space->dims);
  return vxm_sidecar_open(&file->sidecar, context, space, file->path, &npy_description, &about, error);
}

/** The order in which values are made. */
static vxm_layout layout_of(file_format format) {
  return format == NRRD ? (vxm_layout)VXM_LAYOUT_GRID : (vxm_layout)VXM_PLANE_Z_FAST;
}

/** The format of a file, if it holds such values. */
static vxm_status choose_format(file_format *out, const char *path, const char *format, vxm_scalar scalar,
                                vxm_error *error) {
  vxm_status status = find_format(out, path, format, error);
  if (status == VXM_OK && *out == VDB && scalar != VXM_FLOAT32)
    status = vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                         ".vdb holds 32-bit floats; choose them, or .npy or .nrrd");
  return status;
}

static vxm_status open_file(field_file *file, vxm_field_target *target, vxm_context *context,
                            const vxm_space *space, const vxm_vdb_kind *kind, vxm_field_kind values,
                            vxm_scalar scalar, const char *path, const char *format, vxm_error *error) {
  file_format found = NPY;
  *file = (field_file){.path = path};
  vxm_status status = choose_format(&found, path, format, scalar, error);
  if (status == VXM_OK)
    status = vxm_output_open(&file->output, context, path, error);
  size_t size = vxm_scalar_bytes(scalar);
  if (status == VXM_OK)
    status = begin_file(file, found, context, space, kind, values, scalar, error);
  if (status != VXM_OK) {
    vxm_output_abort(file->output);
    return status;
  }
  target->layout = layout_of(found);
  file->slice_bytes = (size_t)(space->dims[target->layout.fast] * space->dims[target->layout.middle]) * size;
  return VXM_OK;
}

/** After a failed write; says why. */
static vxm_status give_up(field_file *file, vxm_error *error) {
  vxm_output *output = file->output;
  file->output = NULL;
  return vxm_output_commit(output, error);
}

static vxm_status put_values(void *payload, const void *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  field_file *file = payload;
  double start = vxm_clock_ms();
  vxm_status status = VXM_OK;
  if (file->tree)
    status = vxm_vdb_field_put(file->tree, values, begin, end, error);
  else
    for (int64_t s = begin; s < end && !vxm_output_failed(file->output); s++)
      vxm_output_write(file->output, (const char *)values + (size_t)(s - begin) * file->slice_bytes,
                       file->slice_bytes);
  file->write_ms += vxm_clock_ms() - start;
  return vxm_output_failed(file->output) ? give_up(file, error) : status;
}

/** Ends a file: with `status` not VXM_OK none is left. */
static vxm_status close_file(field_file *file, vxm_status status, vxm_error *error) {
  double start = vxm_clock_ms();
  if (status == VXM_OK && file->tree)
    status = vxm_vdb_field_write(file->tree, file->output, error);
  if (status == VXM_ERROR_IO && file->output && vxm_output_failed(file->output))
    status = give_up(file, error);
  if (status == VXM_OK)
    status = vxm_output_commit_both(file->output, file->sidecar, error);
  else {
    vxm_output_abort(file->sidecar);
    vxm_output_abort(file->output);
  }
  vxm_vdb_field_destroy(file->tree);
  file->write_ms += vxm_clock_ms() - start;
  return status;
}

/* ---- Coverage and distance ---- */

vxm_status vxm_field_write_coverage(vxm_coverage_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_coverage_options *options, vxm_error *error) {
  static const vxm_vdb_kind kind = {VXM_VDB_FOG, "coverage", 0, NULL};
  field_file file;
  vxm_field_target target = {.put = put_values, .payload = &file};
  double start = vxm_clock_ms();
  vxm_status status = open_file(&file, &target, model->context, space, &kind, VXM_FIELD_COVERAGE,
                                options->scalar, path, options->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_coverage_run(&target, report, model, space, options, error);
  status = close_file(&file, status, error);
  report->voxelize->write_ms = file.write_ms;
  report->voxelize->fill_ms = vxm_clock_ms() - start - file.write_ms;
  return status;
}

/** Without a band there is no number for what lies beyond: that of the diagonal stands for it. */
static vxm_vdb_kind distance_kind(const vxm_distance_options *options, const vxm_space *space) {
  vxm_vdb_kind kind = {options->is_unsigned ? VXM_VDB_NUMBERS : VXM_VDB_LEVEL_SET, "distance",
                       vxm_distance_limit(options, space), NULL};
  double square = 0;
  for (int a = 0; a < 3; a++)
    square += pow((double)space->dims[a] * space->voxel_size[a], 2);
  if (isinf(kind.background))
    kind.background = (float)sqrt(square);
  return kind;
}

vxm_status vxm_field_write_distance(vxm_distance_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_distance_options *options, vxm_error *error) {
  vxm_vdb_kind kind = distance_kind(options, space);
  field_file file;
  vxm_field_target target = {.put = put_values, .payload = &file};
  double start = vxm_clock_ms();
  vxm_status status = open_file(&file, &target, model->context, space, &kind, VXM_FIELD_DISTANCE, VXM_FLOAT32,
                                path, options->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_distance_run(&target, report, model, space, options, error);
  status = close_file(&file, status, error);
  report->voxelize->write_ms = file.write_ms;
  report->voxelize->fill_ms = vxm_clock_ms() - start - file.write_ms;
  return status;
}

/* ---- Estimates ---- */

/** The files' own buffers and the sidecar. */
static const uint64_t file_bytes = UINT64_C(1) << 19;

static vxm_estimate estimate_of(const vxm_field_plan *plan, const vxm_space *space, vxm_layout layout,
                                vxm_scalar scalar) {
  const int64_t *n = space->dims;
  return (vxm_estimate){.grid_bytes =
                            (uint64_t)n[0] * (uint64_t)n[1] * (uint64_t)n[2] * vxm_scalar_bytes(scalar),
                        .memory_bytes = plan->memory + file_bytes,
                        .passes = (n[layout.slow] + plan->slices - 1) / plan->slices};
}

vxm_status vxm_field_estimate_coverage(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_coverage_options *options,
                                       vxm_error *error) {
  file_format format = NPY;
  vxm_field_plan plan;
  vxm_status status = choose_format(&format, path, options->format, options->scalar, error);
  if (status == VXM_OK)
    status = vxm_coverage_plan(&plan, model, space, layout_of(format), false, options, error);
  if (status == VXM_OK)
    *out = estimate_of(&plan, space, layout_of(format), options->scalar);
  return status;
}

vxm_status vxm_field_estimate_distance(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_distance_options *options,
                                       vxm_error *error) {
  file_format format = NPY;
  vxm_field_plan plan;
  vxm_status status = choose_format(&format, path, options->format, VXM_FLOAT32, error);
  if (status == VXM_OK)
    status = vxm_distance_plan(&plan, model, space, layout_of(format), false, options, error);
  if (status == VXM_OK)
    *out = estimate_of(&plan, space, layout_of(format), VXM_FLOAT32);
  return status;
}
