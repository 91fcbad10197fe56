#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Slices as TIFF files by a pattern: there and back for all that a grid holds, and what is refused.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-slices.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
"$BUILDDIR/samples/generate_samples" .
fail() {
  echo "FAILED: $1"
  exit 1
}
for options in '' '--distance signed' '--coverage 4 --scalar uint8' '--labels part' '--color position' '--sparse'; do
  rm -f s_* a.npy* b.npy*
  "$VOXMEND" voxelize cavity.off -r 9x12x7 --fit tight -q $options -o s_%02d.tif
  "$VOXMEND" voxelize cavity.off -r 9x12x7 --fit tight -q $options -o a.npy
  [ "$(ls s_*.tif | wc -l)" -eq 7 ] || fail "'$options': $(ls)"
  "$VOXMEND" convert s_%02d.tif -o b.npy 2>message >/dev/null
  [ ! -s message ] || fail "'$options': $(cat message)"
  cmp a.npy b.npy && cmp a.npy.json b.npy.json || fail "'$options' there and back"
done
# A slice is a file of its own, in its place; without the JSON the place is not known.
"$VOXMEND" info s_03.tif --json | tr -d ' \n' | grep -q '"dims":\[9,12,1\]' || fail "a slice alone"
rm s_%02d.tif.json
"$VOXMEND" convert s_%02d.tif -o b.npy 2>message >/dev/null && cmp a.npy b.npy || fail "no JSON"
grep -q 'no .json' message || fail "no JSON: $(cat message)"
refused() {
  status=0
  rm -f out.*
  "$VOXMEND" "$@" -o out.npy 2>message || status=$?
  [ $status -ne 0 ] && [ "$(wc -l <message)" -eq 1 ] && [ ! -e out.npy ] || fail "$*: $(cat message)"
  grep -q "$words" message || fail "not '$words': $(cat message)"
}
words='no slice 0 or 1' refused convert t_%d.tif
"$VOXMEND" voxelize cavity.off -r 9x12x7 -q -o stack.tif
cp s_02.tif kept
cp stack.tif s_02.tif
words='7 pages' refused convert s_%02d.tif
head -c 300 kept >s_02.tif
words='s_02.tif' refused convert s_%02d.tif
"$VOXMEND" voxelize cavity.off -r 8x8x7 --fit tight -q -o o_%02d.tif
cp o_02.tif s_02.tif
words='first slice' refused convert s_%02d.tif
