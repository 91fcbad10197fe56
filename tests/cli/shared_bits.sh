#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# No release changes a bit of real meshes unknowingly: those of the shared collection that are small, by every way that people
# choose, have the sums that shared_bits.txt holds. Skipped where the collection is not there. With MESH_BYTES=N, which
# slow builds have, a third of those that are not larger. REFRESH=1 writes the list anew: read the difference.
set -eu
meshes=$SRCDIR/../shared/meshes
known=$SRCDIR/tests/cli/shared_bits.txt
[ -d "$meshes" ] || exit 77
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-bits.XXXXXX")
trap 'rm -rf "$work"' EXIT
most=400000 each=1
if [ "${MESH_BYTES:-$most}" -lt "$most" ]; then
  most=$MESH_BYTES each=3
fi

# sum MESH WHAT EXTENSION COMMAND...: a line of the list.
sum() {
  mesh=$1 what=$2 extension=$3
  shift 3
  rm -f "$work"/x.*
  "$VOXMEND" "$@" "$meshes/$mesh" -o "$work/x.$extension" -q --threads 2 >"$work/out" 2>&1 || { cat "$work/out"; return 1; }
  echo "$mesh $what $(cksum <"$work/x.$extension" | cut -d ' ' -f 1)"
}

(cd "$meshes" && find cad classic messy modelnet paper -type f -size -"$most"c | grep -E '\.(off|obj|stl|ply)$') | LC_ALL=C sort | awk "NR % $each == 0" >"$work/meshes"
while read -r mesh; do
  sum "$mesh" solid rle voxelize -r 32
  sum "$mesh" centres rle voxelize -r 31x29x27 --thin drop
  sum "$mesh" conservative rle voxelize -r 32 --mode surface
  sum "$mesh" thin rle voxelize -r 32 --mode surface --surface thin
  sum "$mesh" winding rle voxelize -r 24 --method winding
  sum "$mesh" coverage npy voxelize -r 16 --coverage 4
  sum "$mesh" distance npy voxelize -r 24 --distance signed
  sum "$mesh" labels npy voxelize -r 24 --labels part
  sum "$mesh" manifold off repair --level manifold
done <"$work/meshes" >"$work/found"
if [ -n "${REFRESH:-}" ]; then
  cp "$work/found" "$known"
  exit 0
fi
# of those that were left out nothing is known
awk 'NR == FNR { chosen[$1] = 1; next } $1 in chosen' "$work/meshes" "$known" >"$work/known"
[ "$(wc -l <"$work/meshes")" -ge 8 ] || { echo "too few meshes: $(wc -l <"$work/meshes")"; exit 1; }
diff "$work/known" "$work/found" || { echo "bits have changed; if that is meant, REFRESH=1 writes them anew, and the changelog tells it"; exit 1; }
