/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/field.h"
#include "base/clock.h"
#include "gridio/bytes.h"
#include "gridio/format.h"
#include "gridio/npy_header.h"
#include "gridio/nrrd_header.h"
#include "gridio/planes.h"

static const vxm_sidecar_text npy_description = {"voxmend npy", "z fastest, then y, then x", NULL};

/** A file of values in the making. */
typedef struct field_file {
  vxm_output *output, *sidecar; /**< the second NULL where there is none */
  size_t slice_bytes;
  double write_ms;
} field_file;

static vxm_status find_format(bool *is_nrrd, const char *path, const char *format, vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  *is_nrrd = vxm_text_equal_nocase(name, "nrrd");
  if (*is_nrrd || vxm_text_equal_nocase(name, "npy"))
    return VXM_OK;
  return vxm_fail_at(error, VXM_ERROR_ARGUMENT, (vxm_place){path, 0, -1, -1},
                     "a number per voxel goes into .npy or .nrrd, not \"%s\"", name);
}

static vxm_status open_file(field_file *file, vxm_field_target *target, vxm_context *context,
                            const vxm_space *space, vxm_scalar scalar, const char *path, const char *format,
                            vxm_error *error) {
  bool is_nrrd;
  *file = (field_file){.output = NULL};
  vxm_status status = find_format(&is_nrrd, path, format, error);
  if (status == VXM_OK)
    status = vxm_output_open(&file->output, context, path, error);
  if (status == VXM_OK && !is_nrrd)
    status = vxm_sidecar_open(&file->sidecar, context, space, path, &npy_description, error);
  size_t size = vxm_scalar_bytes(scalar);
  if (status == VXM_OK && is_nrrd)
    status = vxm_nrrd_header_write(file->output, "a number per voxel, at its centre",
                                   size == 1 ? "uchar" : "float", size, space, error);
  if (status != VXM_OK) {
    vxm_output_abort(file->output);
    return status;
  }
  target->layout = is_nrrd ? (vxm_layout)VXM_LAYOUT_GRID : (vxm_layout)VXM_PLANE_Z_FAST;
  file->slice_bytes = (size_t)(space->dims[target->layout.fast] * space->dims[target->layout.middle]) * size;
  if (!is_nrrd)
    vxm_npy_header_write(file->output,
                         size == 1          ? "|u1"
                         : vxm_le64(1) == 1 ? "<f4"
                                            : ">f4",
                         false, space->dims);
  return VXM_OK;
}

static vxm_status put_values(void *payload, const void *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  field_file *file = payload;
  double start = vxm_clock_ms();
  for (int64_t s = begin; s < end && !vxm_output_failed(file->output); s++)
    vxm_output_write(file->output, (const char *)values + (size_t)(s - begin) * file->slice_bytes,
                     file->slice_bytes);
  file->write_ms += vxm_clock_ms() - start;
  if (!vxm_output_failed(file->output))
    return VXM_OK;
  vxm_output *output = file->output;
  file->output = NULL;
  return vxm_output_commit(output, error); /* which tells the reason */
}

/** Ends a file: with `status` not VXM_OK none is left. */
static vxm_status close_file(field_file *file, const char *path, vxm_status status, vxm_error *error) {
  double start = vxm_clock_ms();
  if (status == VXM_OK)
    status = vxm_sidecar_commit(file->output, file->sidecar, path, error);
  else {
    vxm_output_abort(file->sidecar);
    vxm_output_abort(file->output);
  }
  file->write_ms += vxm_clock_ms() - start;
  return status;
}

vxm_status vxm_field_write_coverage(vxm_coverage_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_coverage_options *options, vxm_error *error) {
  field_file file;
  vxm_field_target target = {.put = put_values, .payload = &file};
  double start = vxm_clock_ms();
  vxm_status status =
      open_file(&file, &target, model->context, space, options->scalar, path, options->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_coverage_run(&target, report, model, space, options, error);
  status = close_file(&file, path, status, error);
  report->voxelize.write_ms = file.write_ms;
  report->voxelize.fill_ms = vxm_clock_ms() - start - file.write_ms;
  return status;
}

vxm_status vxm_field_write_distance(vxm_distance_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_distance_options *options, vxm_error *error) {
  field_file file;
  vxm_field_target target = {.put = put_values, .payload = &file};
  double start = vxm_clock_ms();
  vxm_status status =
      open_file(&file, &target, model->context, space, VXM_FLOAT32, path, options->format, error);
  if (status != VXM_OK)
    return status;
  status = vxm_distance_run(&target, report, model, space, options, error);
  status = close_file(&file, path, status, error);
  report->voxelize.write_ms = file.write_ms;
  report->voxelize.fill_ms = vxm_clock_ms() - start - file.write_ms;
  return status;
}
