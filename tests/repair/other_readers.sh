#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What is written, read by other programs (other_readers.py); skipped where READERS_PYTHON has no trimesh, which ./check
# --all has from PyPI.
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c 'import numpy, trimesh' 2>/dev/null || { echo "no Python with trimesh"; exit 77; }
samples=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-readers.XXXXXX")
trap 'rm -rf "$samples"' EXIT
"$BUILDDIR/samples/generate_samples" "$samples"
"$python" "$SRCDIR/tests/repair/other_readers.py" "$VOXMEND" "$samples" "$SRCDIR/../shared/meshes" --seconds "${READERS_SECONDS:-30}"
