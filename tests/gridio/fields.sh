#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Coverage and distance of a box, as .nrrd and .npy, read by plain Python. Skipped where there is no Python.
set -eu
folder=$(mktemp -d "${TMPDIR:-/tmp}/gridio-fields.XXXXXX")
trap 'rm -rf "$folder"' EXIT
printf 'OFF\n8 6 0\n1 1 1\n4 1 1\n1 3 1\n4 3 1\n1 1 2\n4 1 2\n1 3 2\n4 3 2\n' >"$folder/box.off"
printf '4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n' >>"$folder/box.off"
for format in nrrd npy; do
  space='--bounds 0,0,0.25,5,4,3.25 --voxel-size 0.5 -q'
  "$VOXMEND" voxelize "$folder/box.off" -o "$folder/coverage.$format" --coverage 4 $space
  "$VOXMEND" voxelize "$folder/box.off" -o "$folder/bytes.$format" --coverage 2 --scalar uint8 $space
  "$VOXMEND" voxelize "$folder/box.off" -o "$folder/distance.$format" --distance signed --band 2 $space
done
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
"$TEST_PYTHON" "$SRCDIR/tests/gridio/fields.py" "$folder"
