/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Work inside CGAL under the rules of a context: its memory counts against the limit, it reports progress and
 * can be cancelled.
 *
 * CGAL allocates by operator new, with no room for an allocator of ours. The module therefore has operators
 * of its own (budget.cc), which hand on to the program's and count for the meter of the thread. They also
 * look at the clock, so that algorithms without a hook for progress can be cancelled where they allocate.
 */
#ifndef VXM_MODULES_CGAL_BUDGET_H
#define VXM_MODULES_CGAL_BUDGET_H

#include <cstddef>
#include <new>

#include "base/context.h"

namespace vxm {

/** Leaves the work with a status; the error is filled already. Whoever handles a lack of memory handles this
 * too. */
struct Stopped : std::bad_alloc {
  explicit Stopped(vxm_status reason) : status(reason) {
  }
  const char *what() const noexcept override {
    return "stopped";
  }
  vxm_status status;
};

/** Throws Stopped unless a call into the base folder went well. */
inline void check(vxm_status status) {
  if (status != VXM_OK)
    throw Stopped(status);
}

/** One at a time in a thread, for the time of a call into the module. */
class Meter {
public:
  Meter(vxm_context *context, const char *phase, vxm_error *error);
  ~Meter();
  Meter(const Meter &) = delete;
  Meter &operator=(const Meter &) = delete;

  vxm_context *context() const {
    return context_;
  }
  vxm_error *error() const {
    return error_;
  }
  /** How far the work has come; reported when enough time has passed. Throws Stopped if the work is to end.
   */
  void progress(double fraction) {
    fraction_ = fraction;
    tick();
  }
  /** A step of the work: now and then looks at the clock. */
  void tick() {
    if (++ticks_ % TICKS == 0)
      look();
  }
  /** Names the next phase of the work. */
  void phase(const char *name) {
    phase_ = name;
    fraction_ = 0;
  }

  /**
   * While one lives nothing is thrown for memory or for cancelling, as what CGAL is building could not be
   * destroyed half done: the list of a constraint that is being inserted is not there yet when its owner
   * frees it. The next step behind it makes up for that, so that what is done within one is to be small.
   */
  class Whole {
  public:
    explicit Whole(Meter &meter) : meter_(meter) {
      meter_.whole_++;
    }
    ~Whole() {
      meter_.whole_--;
    }
    Whole(const Whole &) = delete;
    Whole &operator=(const Whole &) = delete;

  private:
    Meter &meter_;
  };

  /** For the operators: memory was taken (throws Stopped beyond the limit) or given back. */
  void took(size_t bytes);
  void gave(size_t bytes) noexcept {
    used_ -= (long long)bytes;
  }

private:
  enum : unsigned { TICKS = 1024 };
  void look();

  vxm_context *context_;
  const char *phase_;
  vxm_error *error_;
  double fraction_ = 0, last_;
  unsigned ticks_ = 0, whole_ = 0;
  int unwinding_;
  long long used_ = 0, booked_ = 0;
};

} // namespace vxm

#endif
