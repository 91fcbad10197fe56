#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Batches that are killed at random moments: see kills.py. KILLS and MESHES may ask for more.
set -eu
hostile=$BUILDDIR/.libs/hostile.so
program=$BUILDDIR/.libs/voxmend
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
[ -f "$hostile" ] && [ -x "$program" ] || exit 77
# Sanitizers want to be the first library, and more memory than a mesh gets here.
if ldd "$program" | grep -qE 'lib[a-z]*san\.so'; then exit 77; fi
LD_LIBRARY_PATH=$BUILDDIR/.libs${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-kills-samples.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$BUILDDIR/samples/generate_samples" "$work"
"$TEST_PYTHON" "$SRCDIR/tests/batch/kills.py" "$program" "$hostile" "$work" "$SRCDIR/../shared/meshes" --kills "${KILLS:-8}" --meshes "${MESHES:-300}"
