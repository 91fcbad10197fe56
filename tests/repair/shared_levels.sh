#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared meshes at the levels of repair, judged by a reader of its own (levels.py); skipped where the meshes or numpy
# are missing. LEVELS and FOLDERS choose others, MARKDOWN=doc/repair.md writes the table anew.
set -eu
meshes=$SRCDIR/../shared/meshes
[ -d "$meshes" ] || { echo "no ../shared/meshes"; exit 77; }
"$TEST_PYTHON" -c 'import numpy' 2>/dev/null || { echo "no Python with numpy"; exit 77; }
levels=${LEVELS:-manifold,closed}
folders=${FOLDERS:-messy,cad,modelnet}
judge() {
  "$TEST_PYTHON" "$SRCDIR/tests/repair/levels.py" "$VOXMEND" "$meshes" --folders "$folders" "$@"
}
judge --levels "$levels" --formats ply ${MARKDOWN:+--markdown "$MARKDOWN"}
# What 32-bit floats do to vertices, where most may go wrong; other_readers.sh has decimal digits, too.
judge --levels "${levels##*,}" --formats stl
