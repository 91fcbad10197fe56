/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/exception_barrier.h"

#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/exceptions.h>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <gmp.h>
#include <new>

namespace vxm {

namespace {

void silent(const char *, const char *, const char *, int, const char *) {
}

/* ---- GMP, which ends the program where memory runs out ---- */

void *allocate_number(size_t size) {
  void *block = std::malloc(size);
  return block != nullptr ? block : throw std::bad_alloc();
}

void *grow_number(void *block, size_t, size_t size) {
  void *grown = std::realloc(block, size);
  return grown != nullptr ? grown : throw std::bad_alloc();
}

void release_number(void *block, size_t) {
  std::free(block);
}

/** Unless the program has given it functions of its own, which own what they have allocated. */
void let_numbers_throw() {
  void *(*allocate)(size_t) = nullptr;
  mp_get_memory_functions(&allocate, nullptr, nullptr);
  Dl_info info;
  if (dladdr(reinterpret_cast<void *>(allocate), &info) != 0 && info.dli_fname != nullptr &&
      std::strstr(info.dli_fname, "libgmp") != nullptr)
    mp_set_memory_functions(allocate_number, grow_number, release_number);
}

} // namespace

void prepare_cgal() {
  /* Failed checks become exceptions. */
  CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION);
  CGAL::set_error_handler(silent);
  CGAL::set_warning_handler(silent);
  /* Otherwise it starts from the time of day. */
  CGAL::get_default_random() = CGAL::Random(0);
  let_numbers_throw();
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
