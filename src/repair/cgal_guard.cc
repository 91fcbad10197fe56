/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "repair/cgal_guard.h"

#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/exceptions.h>

namespace vxm {

namespace {

void silent(const char *, const char *, const char *, int, const char *) {
}

} // namespace

void prepare_cgal() {
  /* Failed checks become exceptions. */
  CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION);
  CGAL::set_error_handler(silent);
  CGAL::set_warning_handler(silent);
  /* Otherwise it starts from the time of day. */
  CGAL::get_default_random() = CGAL::Random(0);
}

vxm_status status_of_exception(const char *phase, vxm_error *error) noexcept {
  try {
    throw;
  } catch (const Stopped &stopped) {
    return stopped.status;
  } catch (const std::bad_alloc &) {
    return vxm_fail(error, VXM_ERROR_MEMORY, "out of memory while %s", phase);
  } catch (const CGAL::Failure_exception &failure) {
    return vxm_fail(error, VXM_ERROR_RANGE, "CGAL gave up %s: its check of \"%s\" failed", phase,
                    failure.expression().c_str());
  } catch (const std::exception &failure) {
    return vxm_fail(error, VXM_ERROR_RANGE, "CGAL gave up %s (%s)", phase, failure.what());
  } catch (...) {
    return vxm_fail(error, VXM_ERROR_RANGE, "CGAL gave up %s", phase);
  }
}

} // namespace vxm
