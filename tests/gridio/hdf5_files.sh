#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# .h5 files in: our own, damaged ones, and those of h5py where it is there (hdf5_files.py).
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c "import numpy" 2>/dev/null || { echo "no Python with numpy"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-hdf5.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$BUILDDIR/samples/generate_samples" "$work"
"$python" "$SRCDIR/tests/gridio/hdf5_files.py" "$VOXMEND" "$work"
