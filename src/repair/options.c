/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/sized.h"
#include "repair/repair.h"

#include <inttypes.h>
#include <math.h>

vxm_status vxm_repair_check(vxm_repair_options *chosen, const vxm_repair_options *options, vxm_error *error) {
  *chosen = (vxm_repair_options)VXM_REPAIR_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "repair", error);
  if (status != VXM_OK)
    return status;
  options = chosen;
  if (options->weld != VXM_WELD_AUTO && options->weld != VXM_WELD_OFF && options->weld != VXM_WELD_TOLERANCE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: %d is no way of welding", (int)options->weld);
  if (!isfinite(options->weld_tolerance) || options->weld_tolerance < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: a weld tolerance of %g; it must be 0 or more",
                    options->weld_tolerance);
  if (options->level < VXM_LEVEL_CLEAN || options->level > VXM_LEVEL_SOLID ||
      options->hole_fill < VXM_HOLE_FILL_FAN || options->hole_fill > VXM_HOLE_FILL_SMOOTH)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: level %d or fill %d is unknown", (int)options->level,
                    (int)options->hole_fill);
  if (options->keep_orientation && options->level > VXM_LEVEL_CLEAN)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: a level above clean turns faces; leave out keep_orientation");
  if (!(options->wrap_alpha >= 0 && options->wrap_alpha <= 1) ||
      !(options->wrap_offset >= 0 && options->wrap_offset <= 1))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: wrap %g, %g; both are fractions of the diagonal, 0 to 1", options->wrap_alpha,
                    options->wrap_offset);
  if (options->wrap_alpha > 0 &&
      (options->fill_holes != 0 || options->hole_fill != VXM_HOLE_FILL_FAN || options->boolean_union ||
       options->max_change > 0 || options->keep_duplicates || options->keep_orientation))
    return vxm_fail(
        error, VXM_ERROR_ARGUMENT,
        "repair: a wrap makes a new surface, without holes, parts to compare or faces to keep; leave out "
        "fill_holes, hole_fill, boolean_union, max_change, keep_duplicates and keep_orientation");
  if (!(options->max_change >= 0) || !isfinite(options->max_change))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: a change of %g at most; it must be 0 or more",
                    options->max_change);
  if (!(options->fallback_alpha >= 0 && options->fallback_alpha <= 1) ||
      (options->fallback_alpha > 0 &&
       (options->wrap_alpha > 0 || !(options->boolean_union || options->level == VXM_LEVEL_SOLID))))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: a fallback of %g; it is a fraction of the diagonal, 0 to 1, for what cannot be "
                    "united: with boolean_union or the level solid, without wrap_alpha",
                    options->fallback_alpha);
  if (options->sheets < VXM_SHEETS_THICKEN || options->sheets > VXM_SHEETS_DROP)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: sheets %d is unknown", (int)options->sheets);
  if (!(options->thickness >= 0) || !isfinite(options->thickness))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: plates %g thick; it must be 0 or more",
                    options->thickness);
  if (options->drop_faces < 0 || !(options->drop_volume >= 0) || isinf(options->drop_volume))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: parts below %" PRId64 " faces or a volume of %g; both must be 0 or more",
                    options->drop_faces, options->drop_volume);
  return VXM_OK;
}
