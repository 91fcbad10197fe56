#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Grids that are written, read by other programs (other_grid_readers.py); skipped where READERS_PYTHON has no trimesh,
# which ./check --all has from PyPI.
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c "import numpy, trimesh, rtree, scipy" 2>/dev/null || { echo "no Python with trimesh and rtree"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-grids.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$BUILDDIR/samples/generate_samples" "$work"
"$python" "$SRCDIR/tests/gridio/other_grid_readers.py" "$VOXMEND" "$work" "$SRCDIR/../shared/meshes"
