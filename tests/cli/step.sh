#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# STEP and IGES through OpenCASCADE: parts as tags, closed solids, --deflection, damage.
. "$SRCDIR/tests/cli/lib.sh"
if ! "$VOXMEND" info -q in/stool.step 2>err.txt; then
  grep -q 'reading .step files needs voxmend.s module "occt".*--with-occt.*libocct-data-exchange-dev' err.txt ||
    { cat err.txt; exit 1; }
  exit 77
fi
# A sanitizer would take the signals by which the library may end.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:handle_segv=0:handle_abort=0"
# How many triangles a round leg gets is the library's choice.
facts() {
  grep -E '^  (format|tags|components  .*|boundary edges|nonmanifold edges|inconsistent edges|watertight|greatest corner) '
}
run 'voxmend info -v in/stool.step | facts'
run 'voxmend info -v - <in/stool.step | facts'
run 'voxmend repair -q in/stool.step -o stool.obj && grep -E "^g" stool.obj'
run 'voxmend info stool.obj | facts'
run 'voxmend repair -q in/stool.step -o stool.stl && voxmend info stool.stl | facts'
run 'voxmend voxelize in/stool.step -o stool.npy --voxel-size 5 -q && voxmend convert stool.npy -o stool.binvox | grep voxels'

say "# deflection: a finer one makes more triangles, a coarser one no more"
triangles() {
  voxmend info --json "$@" | grep '"triangles"' | grep -oE '[0-9]+'
}
usual=$(triangles in/stool.step)
compare() {
  if [ "$(triangles in/stool.step --deflection "$1")" "$2" "$3" ]; then say "--deflection $1: as expected"; else
    say "--deflection $1: not $2 $3"; fi
}
compare 0.001 -eq "$usual"
compare 0.1 -le "$usual"
compare 0.00001 -gt $((2 * usual))
run 'voxmend voxelize in/stool.step -o x.npy --voxel-size 10 -q --deflection 0.01 && voxmend view in/stool.step -q -o stool.png --deflection 0.01'
run 'voxmend repair -q in/stool.step -o x.stl --force --deflection 1'
run 'voxmend info in/stool.step --deflection 0'
run 'voxmend repair in/stool.step -o x.stl --force --deflection 1.5'
run 'voxmend view in/stool.step -o x.png --deflection fine'

say "# IGES: lists of faces, which are sewn, and solids"
"$BUILDDIR/tests/meshio/write_iges" faces.igs 0
"$BUILDDIR/tests/meshio/write_iges" solids.igs 1
run 'voxmend info -v faces.igs | facts'
run 'voxmend info -v - <faces.igs | facts'
run 'voxmend info -v solids.igs | facts'
run 'voxmend repair -q faces.igs -o faces.stl && voxmend info faces.stl | facts'

say "# damage"
head -c 8000 in/stool.step >cut.step
head -c 6000 faces.igs >cut.igs
sed 's/,#[0-9]*)/,#999999)/' in/stool.step >lost.step
printf 'what is this\n' >words.step
cp words.step words.igs
: >empty.igs
# What becomes of damage is the library's choice: a message, or a warning and what is left.
told() {
  status=0
  "$VOXMEND" info "$1" >out2.txt 2>err2.txt || status=$?
  if [ "$status" -le 1 ] && grep -qE "^voxmend: (warning: )?$1: " err2.txt; then echo "told"; fi
  rm out2.txt err2.txt
}
for file in cut.step cut.igs lost.step words.step words.igs; do
  run "told $file"
done
run 'voxmend info empty.igs'
run 'ls'
finish
