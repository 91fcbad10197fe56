#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The sample programs do what samples/README.md says, and the generator writes the same files every time.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-samples.XXXXXX")
trap 'rm -rf "$work"' EXIT
programs=$BUILDDIR/samples
mkdir "$work/a" "$work/b"
"$programs/generate_samples" "$work/a"
"$programs/generate_samples" "$work/b"
diff -r "$work/a" "$work/b"
test "$(head -c 7 "$work/a/rocket.off")" = OFF3674
cmp "$work/a/rocket.off" "$SRCDIR/samples/rocket.off" # what the README shows

fail() {
  echo "FAILED: $*"
  exit 1
}

cd "$work"
"$programs/voxelize_file" a/cube.off cube.npy 8 >out
test "$(cat out)" = "512 voxels" || fail "voxelize_file: $(cat out)"
"$VOXMEND" voxelize a/rocket.off -o cli.npy -r 32 -q
"$programs/voxelize_file" a/rocket.off api.npy 32 >out
cmp cli.npy api.npy || fail "voxelize_file and the command line differ"
if "$programs/voxelize_file" no/such.off x.npy >out 2>err; then
  fail "voxelize_file read a file that does not exist"
fi
test "$(wc -l <err)" -eq 1 && test ! -e x.npy || fail "voxelize_file: $(cat err)"

"$programs/voxelize_arrays" >out || fail "voxelize_arrays"
grep -q '^16 x 24 x 20 voxels, volume 96$' out || fail "voxelize_arrays: $(head -1 out)"
grep -q '^cancelled: cancelled$' out || fail "voxelize_arrays did not cancel"

"$programs/repair_report" a/doubled.off fixed.ply >out
grep -Eq '^opposite duplicate faces +1152 +0$' out || fail "repair_report: $(cat out)"
grep -Eq '^watertight +no +yes$' out || fail "repair_report: $(cat out)"
test "$("$VOXMEND" info --json fixed.ply | grep -c '"watertight": true')" -eq 1 || fail "the repaired mesh"

"$programs/import_part" a/open_box.off 16 >out || fail "import_part: $(cat out)"
grep -q '^the mesh is closed$' out || fail "import_part: $(cat out)"
grep -Eq '^handed over: .* [1-9][0-9]* of 4096 voxels$' out || fail "import_part: $(cat out)"
"$programs/import_part" a/inner_sheet.off 16 >out || fail "import_part: $(cat out)"
grep -q '^not closed: 4 boundary_edges$' out || fail "import_part: $(cat out)"
"$programs/import_part" a/cracks.off 16 0.01 >out || fail "import_part: $(cat out)"
grep -q '^the mesh is closed$' out || fail "import_part at a tolerance: $(cat out)"
code=0
"$programs/import_part" a/rocket.off 16 0 0 >out 2>err || code=$?
test "$code" -eq 3 && test "$(wc -l <err)" -eq 1 || fail "import_part does not cancel: $(cat out err)"
