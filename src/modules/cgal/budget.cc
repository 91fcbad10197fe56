/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/budget.h"

#include <dlfcn.h>
#include <exception>
#include <malloc.h>

#include "base/clock.h"

namespace vxm {

namespace {

thread_local Meter *meter_of_thread = nullptr;

/* Memory is booked in pieces of this size, so that few allocations touch the context. */
constexpr long long BOOKED_AT_ONCE = 1 << 20;
constexpr double MILLISECONDS_BETWEEN_REPORTS = 30;

using Allocate = void *(*)(size_t);
using Release = void (*)(void *);

/**
 * The operators that the rest of the program uses: those it was linked with, or else those of this module's
 * own library. What the C++ library allocates in its own code and we release, or the other way round, so
 * stays in one pair of hands.
 */
template <class Function> Function program_operator(const char *name) {
  void *found = dlsym(RTLD_DEFAULT, name);
  return reinterpret_cast<Function>(found != nullptr ? found : dlsym(RTLD_NEXT, name));
}

void *allocate(size_t size) {
  static const auto program_new = program_operator<Allocate>(sizeof(size_t) == 8 ? "_Znwm" : "_Znwj");
  void *block = program_new(size);
  if (meter_of_thread != nullptr) {
    try {
      meter_of_thread->took(malloc_usable_size(block));
    } catch (...) {
      ::operator delete(block);
      throw;
    }
  }
  return block;
}

void release(void *block) noexcept {
  static const auto program_delete = program_operator<Release>("_ZdlPv");
  if (block == nullptr)
    return;
  if (meter_of_thread != nullptr)
    meter_of_thread->gave(malloc_usable_size(block));
  program_delete(block);
}

} // namespace

Meter::Meter(vxm_context *context, const char *phase, vxm_error *error)
    : context_(context), phase_(phase), error_(error), last_(vxm_clock_ms()),
      unwinding_(std::uncaught_exceptions()) {
  check(vxm_progress(context, phase, 0.0, error));
  meter_of_thread = this;
}

Meter::~Meter() {
  meter_of_thread = nullptr;
  if (booked_ > 0)
    vxm_memory_give(context_, (size_t)booked_);
}

void Meter::took(size_t bytes) {
  used_ += (long long)bytes;
  /* While another exception is on its way nothing more may be thrown. */
  if (whole_ > 0 || std::uncaught_exceptions() != unwinding_)
    return;
  if (used_ > booked_) {
    long long more = used_ - booked_ + BOOKED_AT_ONCE;
    check(vxm_memory_take(context_, (size_t)more, error_));
    booked_ += more;
  }
  tick();
}

void Meter::look() {
  double now = vxm_clock_ms();
  if (now - last_ < MILLISECONDS_BETWEEN_REPORTS)
    return;
  last_ = now;
  /* The callback is the program's code: what it allocates is its own. */
  meter_of_thread = nullptr;
  vxm_status status = vxm_progress(context_, phase_, fraction_, error_);
  meter_of_thread = this;
  check(status);
}

} // namespace vxm

void *operator new(size_t size) {
  return vxm::allocate(size);
}

void *operator new[](size_t size) {
  return vxm::allocate(size);
}

void operator delete(void *block) noexcept {
  vxm::release(block);
}

void operator delete[](void *block) noexcept {
  vxm::release(block);
}

void operator delete(void *block, size_t) noexcept {
  vxm::release(block);
}

void operator delete[](void *block, size_t) noexcept {
  vxm::release(block);
}
