#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# .vdb files that OpenVDB itself has written, of every kind, are read as it says; damaged ones are refused. And OpenVDB
# reads what voxmend has written, number for number.
set -eu
peer=$BUILDDIR/tests/gridio/vdb_peer
[ -x "$peer" ] || { echo "built without OpenVDB"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-vdb.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() {
  echo "FAILED: $1"
  exit 1
}

# ---- What OpenVDB writes ----
mkdir kinds
"$peer" write kinds
for truth in kinds/*.raw; do
  file=${truth%.raw}.vdb
  case $file in
  */mask.vdb | */bool*.vdb) level= ;;
  */fog.vdb | */unknown.vdb) level='--threshold 0.50000006' ;; # above a half
  *) level='--below 0' ;;
  esac
  "$VOXMEND" compare "$file" "$truth" $level --json >report.json 2>warnings || fail "$file: $(cat warnings)"
  grep -q '"iou": 1.0' report.json || fail "$file: $(cat report.json)"
  ! grep -q 'origins\|sizes' report.json || fail "$file: $(cat report.json)"
  [ -z "$level" ] || ! "$VOXMEND" compare "$file" "$truth" 2>/dev/null || fail "$file is taken for bits"
done
for numbers in kinds/*.values; do
  "$VOXMEND" convert "${numbers%.values}.vdb" -o numbers.npy -q
  tail -c +129 numbers.npy | cmp - "$numbers" || fail "numbers of $numbers"
done
refused() {
  status=0
  "$VOXMEND" convert "kinds/$1.vdb" -o out.npy 2>message || status=$?
  [ $status -eq 1 ] && grep -q "$2" message && [ "$(wc -l <message)" -eq 1 ] || fail "$1: $(cat message)"
}
refused turned 'turned or mirrored'
refused mirrored 'turned or mirrored'
refused frustum 'not linear'
refused wind 'Tree_vec3s_5_4_3'
refused empty 'has no size'
refused far 'more than 1048576 voxels'
"$VOXMEND" convert kinds/second.vdb -o out.npy 2>&1 | grep -q 'of its 2 grids "ball" is read' || fail "second"

# ---- What OpenVDB reads ----
# The values lie behind 128 bytes of header in .npy files.
"$BUILDDIR/samples/generate_samples" .
for options in '' '--mode surface' '--sparse' '--coverage 4' '--distance signed' '--distance signed --band 0' \
  '--distance unsigned --band 2'; do
  common="--bounds -1,-2,-1.5,1.5,2,1.2 -r 37x50x41 -q $options"
  "$VOXMEND" voxelize torus.off -o a.vdb $common
  "$VOXMEND" voxelize torus.off -o a.npy $common
  "$peer" dump a.vdb 37 50 41 >told
  tail -c +129 a.npy | cmp - a.vdb.values || fail "values of '$options'"
  case $options in
  '' | *surface | *sparse) expected='Tree_bool_5_4_3, unknown, solid,' ;;
  *coverage*) expected='Tree_float_5_4_3, fog volume, coverage,' ;;
  *unsigned*) expected='Tree_float_5_4_3, unknown, distance,' ;;
  *) expected='Tree_float_5_4_3, level set, distance,' ;;
  esac
  grep -qF "$expected" told || fail "'$options': $(cat told)"
  # 2.5 / 37, 4 / 50 and 2.7 / 41
  grep -qF 'first centre -0.966216216 -1.96 -1.46707317, voxel size 0.0675675676 0.08 0.0658536585' told ||
    fail "'$options': $(cat told)"
done
# By way of other formats, and whole numbers, whose type the metadata tell.
for options in '--coverage 4' '--distance signed' '--labels part'; do
  "$VOXMEND" voxelize torus.off -o a.npy -r 37x50x41 --bounds -1,-2,-1.5,1.5,2,1.2 -q $options
  "$VOXMEND" convert a.npy -o a.nrrd -q
  "$VOXMEND" convert a.nrrd -o a.vdb -q
  "$peer" dump a.vdb 37 50 41 >told
  "$VOXMEND" convert a.vdb -o b.npy -q
  cmp a.npy b.npy && cmp a.npy.json b.npy.json || fail "'$options' there and back"
  [ "$options" = '--labels part' ] || tail -c +129 a.npy | cmp - a.vdb.values || fail "values of '$options'"
done
grep -qF 'Tree_float_5_4_3, unknown, labels,' told || fail "labels: $(cat told)"
"$VOXMEND" voxelize torus.off -o - --format vdb -r 30 -q >stream.vdb
"$VOXMEND" voxelize torus.off -o b.vdb -r 30 -q
"$peer" dump stream.vdb 30 30 30 >told
"$peer" dump b.vdb 30 30 30 >told
cmp stream.vdb.values b.vdb.values || fail "standard output"

# ---- Damage ----
if [ -x "$BUILDDIR/tests/gridio/test_vdb" ]; then
  for kind in level_set zip mask half_plain stream; do
    "$BUILDDIR/tests/gridio/test_vdb" "kinds/$kind.vdb" >log 2>&1 || fail "damaged $kind: $(tail -n 20 log)"
  done
fi
