#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The command line on a disk that fails: see writes.py. FAULTS=all takes minutes rather than seconds.
set -eu
shim=$BUILDDIR/.libs/fail_writes.so
program=$BUILDDIR/.libs/voxmend
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
[ -f "$shim" ] && [ -x "$program" ] || exit 77
# Sanitizers want to be the first library; and the program itself, not the script that stands for it, is to fail.
if ldd "$program" | grep -qE 'lib[a-z]*san\.so'; then exit 77; fi
LD_LIBRARY_PATH=$BUILDDIR/.libs${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-writes.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$BUILDDIR/samples/generate_samples" "$work"
"$TEST_PYTHON" "$SRCDIR/tests/faults/writes.py" "$program" "$shim" "$work/rocket.off"
