#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Thin parts of real meshes, judged by a reader of its own (thin.py); skipped where the meshes or numpy are missing.
# RESOLUTIONS="32 64" chooses others.
set -eu
meshes=$SRCDIR/../shared/meshes
[ -d "$meshes" ] || { echo "no ../shared/meshes"; exit 77; }
"$TEST_PYTHON" -c 'import numpy' 2>/dev/null || { echo "no Python with numpy"; exit 77; }
exec "$TEST_PYTHON" "$SRCDIR/tests/voxel/thin.py" "$VOXMEND" "$meshes" ${RESOLUTIONS:-32 64}
