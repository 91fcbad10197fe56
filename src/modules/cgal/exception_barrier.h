/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The way into the module: C++ in, a status out. */
#ifndef VXM_MODULES_CGAL_EXCEPTION_BARRIER_H
#define VXM_MODULES_CGAL_EXCEPTION_BARRIER_H

#include <exception>

#include "modules/cgal/budget.h"

namespace vxm {

/** Sets what CGAL keeps for the whole thread, so that results depend on the input alone and nothing is
 * printed. */
void prepare_cgal();

/** The status of the exception that is being handled; fills the error unless that was done before. */
vxm_status status_of_exception(const char *phase, vxm_error *error) noexcept;

/**
 * Runs work(meter) and makes a status of whatever comes out of it.
 *
 * @param phase what is being done, such as "looking for self-intersections"
 */
template <class Work>
vxm_status guarded(vxm_context *context, const char *phase, vxm_error *error, Work &&work) noexcept {
  vxm_error local = VXM_ERROR_INIT, *told = error != nullptr ? error : &local;
  try {
    prepare_cgal();
    Meter meter(context, phase, told);
    work(meter);
    return VXM_OK;
  } catch (...) {
    return status_of_exception(phase, told);
  }
}

} // namespace vxm

#endif
