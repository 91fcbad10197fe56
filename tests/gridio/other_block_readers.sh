#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# .schem, .litematic, .vox and .glb, read by other programs (other_block_readers.py); skipped where READERS_PYTHON has no
# nbtlib, litemapy and trimesh, which ./check --all has from PyPI.
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c 'import numpy, nbtlib, litemapy, trimesh' 2>/dev/null || { echo "no Python with nbtlib, litemapy and trimesh"; exit 77; }
folder=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-blocks.XXXXXX")
trap 'rm -rf "$folder"' EXIT
"$BUILDDIR/samples/generate_samples" "$folder"
"$python" "$SRCDIR/tests/gridio/other_block_readers.py" "$VOXMEND" "$folder" "$folder/rocket.off" "$folder/edge_cubes.off" "$folder/overlapping.off"
