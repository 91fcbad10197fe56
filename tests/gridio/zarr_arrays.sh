#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Zarr arrays, there and back, by the package zarr (zarr_arrays.py); skipped where Python lacks it.
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c "import numpy, zarr" 2>/dev/null || { echo "no Python with zarr"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-zarr.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$python" "$SRCDIR/tests/gridio/zarr_arrays.py" "$VOXMEND" "$work"
