#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend view: pictures of grids and meshes. Skipped where the library was built without libpng.
. "$SRCDIR/tests/cli/lib.sh"
voxmend voxelize in/torus.off -o t.npy -r 24 -q
if voxmend view t.npy -o probe.png 2>err.log >/dev/null; then
  rm probe.png
elif grep -q libpng err.log; then
  exit 77
fi

# Width and height stand in bytes 16 to 23 of a PNG file.
size() {
  od -An -tu1 -j 16 -N 8 "$1" | awk '{ print $3 * 256 + $4, $7 * 256 + $8 }'
}

run 'voxmend view t.npy -o t.png && size t.png'
run 'voxmend view in/cube.off -o cube.PNG --size 320x240 --azimuth -60 --elevation 90 --up y --json && size cube.PNG'
run 'cp t.npy grid; voxmend view grid -o grid.png -q && cmp grid.png t.png'
run 'cp in/torus.off mesh; voxmend view mesh -o mesh.png'
run 'voxmend view - -o pipe.png -q <t.npy && cmp pipe.png t.png'
run 'voxmend view t.npy -o again.png -q --threads 7 && cmp again.png t.png'
run 'voxmend view missing.npy -o out.png'
run 'voxmend view in/truth.tsv -o out.png'
run 'voxmend view t.npy -o no/such/out.png'
run 'ls out.png'
finish
