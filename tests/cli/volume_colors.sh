#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Colours of voxels from a volume: of numbers, of colours, of bits; in every format that has colours; what is refused.
. "$SRCDIR/tests/cli/lib.sh"
voxmend voxelize in/torus.off -o distance.nrrd -r 12 --pad 2 --distance signed -q
voxmend voxelize in/torus.off -o bits.npy -r 12 -q
voxmend voxelize in/torus.off -o labels.npy -r 12 --labels part -q
voxmend voxelize in/torus.off -o colors.npy -r 12 --color position -q
run 'voxmend voxelize in/torus.off -o c.npy -r 8 --color distance.nrrd'
run 'voxmend voxelize in/torus.off -o c.npy -r 8 --color bits.npy -q; voxmend convert c.npy -o d.nrrd -q'
say "# where the volume has the same voxels, it has the same colours"
run 'voxmend voxelize in/torus.off -o c.npy -r 12 --color colors.npy -q && cmp c.npy colors.npy'
for format in ply vox glb nii vti; do
  run "voxmend voxelize in/torus.off -o c.$format -r 8 --color distance.nrrd --json | grep '\"color\"'"
done
say "# refused"
run 'voxmend voxelize in/torus.off -o e.npy -r 8 --color labels.npy'
run 'voxmend voxelize in/torus.off -o e.npy -r 8 --color missing.nrrd'
run 'voxmend voxelize in/torus.off -o e.npy -r 8 --color volume'
run 'voxmend voxelize in/torus.off -o distance.nrrd -r 8 --color distance.nrrd'
run 'voxmend voxelize in/rocket.off -o e.npy -r 8 --bounds 100,100,100,110,110,110 --color distance.nrrd'
run 'ls e.npy'
finish
