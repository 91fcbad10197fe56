#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend voxelize --baseline: published methods as grids, and the same in voxmend bench. Their bits are held by
# tests/experimental.
. "$SRCDIR/tests/cli/lib.sh"
without_leak_check
masked() {
  sed -E 's/_ms(": | )[0-9][0-9.e+-]*/_ms\1T/g; s/bytes(": | )[0-9]+/bytes\1N/g'
}

# count OPTION...: the voxels.
count() {
  voxmend voxelize "$@" --json | sed -n 's/^  "voxels": \([0-9]*\),*$/\1/p'
}

run 'voxmend voxelize in/overlapping.off -o a.npy -r 24 --no-repair --baseline chen-tu | masked'
run 'voxmend voxelize in/overlapping.off -o a.npy -r 24 --baseline chen-tu --json | masked | sed -n "/\"baseline\"/,/}/p"'
for solid in fang-chen chen-tu tetra-listed tetra-full tetra-anew tetra-layers eisemann; do
  run "count in/torus.off -o $solid.npy -r 20 --baseline $solid"
  run "voxmend voxelize in/torus.off -o ours.npy -r 20 --thin drop -q; cmp $solid.npy ours.npy"
done
for surface in simple specialized sorted; do
  for kind in conservative thin; do
    run "count in/torus.off -o $surface.npy -r 20 --baseline $surface --mode surface --surface $kind"
    run "voxmend voxelize in/torus.off -o ours.npy -r 20 --mode surface --surface $kind -q; cmp $surface.npy ours.npy"
  done
done
run 'count in/torus.off -o zhang.npy -r 20 --baseline zhang'
run 'count in/torus.off -o density.npy -r 20 --baseline density'
run 'voxmend bench in/torus.off -r 16 --threads 1 --time 0 --phases baseline_thin_sorted,baseline_tetra_listed --json | masked |
  grep -A 9 -E "\"figures\""'
run 'voxmend bench in/torus.off -r 8 --threads 1 --time 0 | grep -c baseline'

say "# wrong usage"
run 'voxmend voxelize in/torus.off -o no.npy --baseline chen'
run 'voxmend voxelize in/torus.off -o no.npy --baseline simple --sparse'
run 'voxmend voxelize in/torus.off -o no.npy --baseline simple --method x'
run 'voxmend voxelize in/torus.off -o no.npy --baseline zhang --mode surface --surface thin'
run 'voxmend voxelize in/torus.off -o no.npy --baseline simple --mode surface --surface shell6'
run 'voxmend voxelize in/torus.off -o no.npy --baseline zhang --engine opencl'
run 'voxmend voxelize in/torus.off -o no.npy --baseline faieghi'
run 'voxmend voxelize in/torus.off -o no.npy -r 3000x9x9 --bounds 0,0,0,.01,.01,.01 --baseline simple'
run 'ls no.npy'
finish
