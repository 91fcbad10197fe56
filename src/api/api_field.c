/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make a number per voxel: they check arguments and call down. */
#include "api/api_results.h"
#include "base/exact_math.h"
#include "export/field.h"
#include "grid/bit_transpose.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

static vxm_status fail_null(const char *what, vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: an argument is NULL", what);
}

/** The array of a caller: [x][y][z] in C order. */
static vxm_field_target array_of(void *values) {
  return (vxm_field_target){.layout = VXM_PLANE_Z_FAST, .whole = values};
}

/* ---- Coverage ---- */

static vxm_status check_coverage(vxm_coverage_options *chosen, const vxm_space *space,
                                 const vxm_coverage_options *options, vxm_error *error) {
  *chosen = (vxm_coverage_options)VXM_COVERAGE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "coverage", error);
  if (status != VXM_OK)
    return status;
  int n = chosen->subdivision;
  if (n != 2 && n != 4 && n != 8)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "coverage: a subdivision of %d is none of 2, 4 and 8", n);
  if (chosen->scalar != VXM_FLOAT32 && chosen->scalar != VXM_UINT8)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "coverage: scalar %d is neither VXM_FLOAT32 nor VXM_UINT8",
                    (int)chosen->scalar);
  return vxm_space_check(space, error);
}

vxm_status vxm_model_coverage(void *values, vxm_coverage_report *report, vxm_model *model,
                              const vxm_space *space, const vxm_coverage_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_coverage_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!values || !model || !space)
    return fail_null("coverage", error);
  vxm_coverage_options chosen;
  vxm_status status = check_coverage(&chosen, space, options, error);
  if (status == VXM_OK && (uintptr_t)values % vxm_scalar_bytes(chosen.scalar) != 0)
    status = vxm_fail(error, VXM_ERROR_ARGUMENT, "coverage: the array is not aligned as float has to be");
  vxm_field_target target = array_of(values);
  if (status == VXM_OK)
    status = vxm_coverage_run(&target, &results.made, model, space, &chosen, error);
  VXM_RESULTS_END(&results, status);
  return status;
}

vxm_status vxm_model_write_coverage(vxm_coverage_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_coverage_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_coverage_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!model || !space || !path)
    return fail_null("coverage", error);
  vxm_coverage_options chosen;
  vxm_status status = check_coverage(&chosen, space, options, error);
  if (status == VXM_OK)
    status = vxm_field_write_coverage(&results.made, model, space, path, &chosen, error);
  VXM_RESULTS_END(&results, status);
  return status;
}

vxm_status vxm_model_estimate_coverage(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_coverage_options *options,
                                       vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !model || !space || !path)
    return fail_null("coverage", error);
  vxm_coverage_options chosen;
  vxm_status status = check_coverage(&chosen, space, options, error);
  vxm_estimate made = {0};
  if (status == VXM_OK)
    status = vxm_field_estimate_coverage(&made, model, space, path, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(out, &made);
  return status;
}

/* ---- Distance ---- */

/** Distances are 32-bit floats: voxels that these cannot measure would all have one number, 0 or infinity. */
static vxm_status check_float_range(const vxm_space *space, double band, vxm_error *error) {
  const double *size = space->voxel_size;
  double longest = fmax(fmax(size[0], size[1]), size[2]), side[3];
  for (int a = 0; a < 3; a++)
    side[a] = (double)space->dims[a] * size[a];
  double farthest = band > 0 ? band * longest : vxm_length3(side[0], side[1], side[2]);
  if (!(farthest <= FLT_MAX))
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "distance: voxels of %g have distances beyond 32-bit floats; scale the model down",
                    longest);
  if (longest < FLT_MIN)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "distance: voxels of %g have distances too small for 32-bit floats; scale the model up",
                    longest);
  return VXM_OK;
}

static vxm_status check_distance(vxm_distance_options *chosen, const vxm_model *model, const vxm_space *space,
                                 const vxm_distance_options *options, vxm_error *error) {
  *chosen = (vxm_distance_options)VXM_DISTANCE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "distance", error);
  if (status != VXM_OK)
    return status;
  if (!(chosen->band >= 0) || isinf(chosen->band))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "distance: a band of %g voxels is not possible", chosen->band);
  if (!chosen->is_unsigned && model->options.mode != VXM_MODE_SOLID)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "distance: the sign is that of the solid; make the model with VXM_MODE_SOLID");
  status = vxm_space_check(space, error);
  return status == VXM_OK ? check_float_range(space, chosen->band, error) : status;
}

vxm_status vxm_model_distance(float *values, vxm_distance_report *report, vxm_model *model,
                              const vxm_space *space, const vxm_distance_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_distance_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!values || !model || !space)
    return fail_null("distance", error);
  vxm_distance_options chosen;
  vxm_status status = check_distance(&chosen, model, space, options, error);
  vxm_field_target target = array_of(values);
  if (status == VXM_OK)
    status = vxm_distance_run(&target, &results.made, model, space, &chosen, error);
  VXM_RESULTS_END(&results, status);
  return status;
}

vxm_status vxm_model_write_distance(vxm_distance_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_distance_options *options, vxm_error *error) {
  VXM_RESULTS(vxm_distance_report) results;
  VXM_RESULTS_BEGIN(&results, report);
  if (!model || !space || !path)
    return fail_null("distance", error);
  vxm_distance_options chosen;
  vxm_status status = check_distance(&chosen, model, space, options, error);
  if (status == VXM_OK)
    status = vxm_field_write_distance(&results.made, model, space, path, &chosen, error);
  VXM_RESULTS_END(&results, status);
  return status;
}

vxm_status vxm_model_estimate_distance(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_distance_options *options,
                                       vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !model || !space || !path)
    return fail_null("distance", error);
  vxm_distance_options chosen;
  vxm_status status = check_distance(&chosen, model, space, options, error);
  vxm_estimate made = {0};
  if (status == VXM_OK)
    status = vxm_field_estimate_distance(&made, model, space, path, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(out, &made);
  return status;
}
