#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The command line and the library where memory fails: see allocations.py. FAULTS=all takes half an hour rather than seconds.
set -eu
shim=$BUILDDIR/.libs/fail_allocations.so
program=$BUILDDIR/.libs/voxmend
library=$BUILDDIR/tests/faults/.libs/library
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
[ -f "$shim" ] && [ -x "$program" ] && [ -x "$library" ] || exit 77
# Sanitizers bring an allocator of their own.
if ldd "$program" | grep -qE 'lib[a-z]*san\.so'; then exit 77; fi
LD_LIBRARY_PATH=$BUILDDIR/.libs${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
"$TEST_PYTHON" "$SRCDIR/tests/faults/allocations.py" "$program" "$library" "$shim"
