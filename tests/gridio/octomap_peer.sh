#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# .bt files that OctoMap itself has written are read as it says, damaged ones are refused, and OctoMap reads what
# voxmend has written, voxel for voxel, in its place.
set -eu
peer=$BUILDDIR/tests/gridio/octomap_peer
[ -x "$peer" ] || { echo "built without OctoMap"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-octomap.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() {
  echo "FAILED: $1"
  exit 1
}
# The bytes of an array of bits.
values() {
  tail -c +129 "$1"
}

# ---- What OctoMap writes ----
"$peer" write .
"$VOXMEND" convert any.bt -o any.npy -q
values any.npy | cmp - any.values || fail "voxels of OctoMap"
tr -d ' \n' <any.npy.json | grep -q '"dims":\[64,64,64\],"origin":\[-2.0,-2.0,-2.0\]' ||
  fail "place of OctoMap's voxels: $(cat any.npy.json)"
"$VOXMEND" convert any.bt -o any.octree -q
"$VOXMEND" convert any.octree -o of_octree.npy -q
cmp any.npy of_octree.npy || fail "as an octree"

# ---- What OctoMap reads ----
# A grid at random, through slices, and on the lattice.
"$VOXMEND" convert any.npy -o again.bt 2>message >/dev/null
[ ! -s message ] || fail "OctoMap prints, or warns of a grid on the lattice: $(cat message)"
"$peer" dump again.bt -20 -20 -20 64 64 64 >told
cmp again.bt.values any.values || fail "a grid at random"
grep -q 'resolution 0.10000000000000001, .* free leaves 0$' told || fail "$(cat told)"
grep -qx 'res 0.1' again.bt || fail "the resolution is not plain"
"$BUILDDIR/samples/generate_samples" .
# -3.2 / 0.08 is -40; -3.13 is 0.875 of a voxel farther, and goes to -39.
for place in -3.2:-40 -3.13:-39; do
  low=${place%:*}
  for options in '' '--mode surface' '--sparse'; do
    common="--bounds $low,$low,$low,3,3,3 --voxel-size 0.08 -q $options"
    "$VOXMEND" voxelize torus.off -o a.bt ${common% -q*} $options 2>message >/dev/null || fail "$(cat message)"
    case $low in
    -3.13) grep -q 'moved by 0.01 0.01 0.01 onto' message || fail "no warning: $(cat message)" ;;
    *) [ ! -s message ] || fail "$(cat message)" ;;
    esac
    "$VOXMEND" voxelize torus.off -o a.npy $common
    rm -f b.npy
    "$VOXMEND" convert a.bt -o b.npy -q
    cmp a.npy b.npy && cmp a.npy.json b.npy.json || fail "'$options' at $low there and back"
    dims=$(tr -d ' \n' <a.npy.json | sed 's/.*"dims":\[\([0-9]*\),\([0-9]*\),\([0-9]*\)\].*/\1 \2 \3/')
    at=${place#*:}
    "$peer" dump a.bt "$at" "$at" "$at" $dims >told
    values a.npy | cmp - a.bt.values || fail "'$options' at $low: $(cat told)"
    set=$(od -An -v -tu1 -w1 a.bt.values | grep -c 1)
    grep -q "occupied voxels $set, free leaves 0\$" told || fail "more than the box: $(cat told), not $set"
    if [ "$options" = --sparse ]; then cmp a.bt solid.bt || fail "octree and slices differ"; fi
    if [ -z "$options" ]; then cp a.bt solid.bt; fi
  done
done
# Without the JSON, or with that of another, the grid is the box of what is set.
rm a.bt.json
"$VOXMEND" convert a.bt -o c.npy -q
[ "$(values c.npy | od -An -v -tu1 -w1 | grep -c 1)" = "$(values a.npy | od -An -v -tu1 -w1 | grep -c 1)" ] || fail "no JSON"
cp again.bt.json a.bt.json
"$VOXMEND" convert a.bt -o d.npy 2>message >/dev/null && cmp c.npy d.npy || fail "another JSON"
grep -q 'is of another' message || fail "another JSON: $(cat message)"

# ---- What is refused ----
refused() {
  status=0
  rm -f out.*
  "$VOXMEND" "$@" 2>message || status=$?
  [ $status -ne 0 ] && [ "$(wc -l <message)" -eq 1 ] && ! ls out.* >/dev/null 2>&1 || fail "$*: $(cat message)"
}
saying() {
  grep -q "$1" message || fail "not '$1' but $(cat message)"
}
refused voxelize torus.off -o out.bt --bounds -1,-2,-3,1,2,3 -r 10x10x10
saying 'cubes'
refused voxelize torus.off -o out.bt --bounds 4000,0,0,4001,1,1 --voxel-size 0.1
saying 'less than 32768'
refused voxelize torus.off -o out.bt -r 8 --distance signed --format bt
# Each length, and deep trees.
size=$(wc -c <again.bt)
for length in 30 60 100 $((size / 2)) $((size - 1)); do
  head -c "$length" again.bt >short.bt
  refused convert short.bt -o out.npy
done
saying 'cut short'
deep() {
  printf '# Octomap OcTree binary file\nid OcTree\nsize %d\nres 0.5\ndata\n' "$1"
  n=0
  while [ $n -lt "$2" ]; do
    printf '\003\000'
    n=$((n + 1))
  done
  printf '\002\000'
}
deep 17 15 >deep.bt
"$VOXMEND" convert deep.bt -o deep.npy -q || fail "16 levels"
deep 18 16 >deep.bt
refused convert deep.bt -o out.npy
saying 'more than 16 levels'
deep 5 15 >deep.bt
refused convert deep.bt -o out.npy
saying 'as many nodes'
for change in 's/^res .*/res nan/' 's/^res .*/res -1/' 's/^res .*/res 0/' 's/^id .*/id ColorOcTree/' '/^data/d' 's/^size .*/size 0/'; do
  LC_ALL=C sed "$change" deep.bt >changed.bt
  refused convert changed.bt -o out.npy
done
saying 'no size'
