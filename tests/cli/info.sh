#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend info: tables, JSON, several files, damaged and missing files.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend info in/cube.off'
run 'voxmend info in/rocket.off in/degenerate.off'
run 'voxmend info -v in/rocket.off in/degenerate.off'
run 'voxmend info --list 1 in/cube.off in/degenerate.off'
run 'voxmend info --json in/nonfinite.off'
run 'voxmend info --json in/cube.off in/open_box.off'
run 'voxmend info - <in/l_prism.off'
# A group of two bodies, which materials name, and a face of neither.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\ng two\nusemtl left\nf 1 3 2\nf 1 2 4\nusemtl right\nf 2 3 4\ng bolt\nf 3 1 4\n' >named.obj
run 'voxmend info --json named.obj | sed -n "/\"tags\"/,/]/p"; rm named.obj'
# A tetrahedron with a corner on one edge, for one of its two sides: the face without area between them stays.
printf 'OFF\n5 6 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n1 0 0\n3 0 2 4\n3 4 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 0 4 1\n' >gap.off
run 'voxmend info gap.off'
run 'voxmend repair gap.off -o kept.off -q && voxmend info gap.off kept.off'
run 'voxmend info -q in/cube.off'

say "# damage"
head -n 28 in/star_prism.off >cut.off
head -n 10 in/star_prism.off >stump.off
printf 'g side\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n' >index.obj
printf '\377\376 not a mesh' >junk.stl
: >empty.off
run 'voxmend info cut.off'
run 'voxmend info --strict cut.off'
run 'voxmend info --strict -q cut.off'
run 'voxmend info -v index.obj'
run 'voxmend info --json --strict index.obj'
run 'voxmend info --json -q index.obj in/cube.off | grep -A 2 warnings' # each has its own
run 'voxmend info stump.off'
run 'voxmend info junk.stl'
run 'voxmend info empty.off'
run 'voxmend info missing.off'
run 'voxmend info missing.off in/cube.off empty.off'
run 'voxmend info --json missing.off in/cube.off empty.off'
run 'voxmend info --memlimit 1K in/torus.off'

say "# grids"
voxmend voxelize in/cavity.off -o g.npy -r 8 --labels part -q
voxmend voxelize in/cavity.off -o g.nrrd -r 8 --distance signed -q
voxmend voxelize in/cavity.off -o g.binvox -r 8 -q
voxmend voxelize in/cavity.off -o g.octree -r 16 --sparse -q
run 'voxmend info g.npy'
run 'voxmend info g.nrrd'
run 'voxmend info g.binvox'
run 'voxmend info g.* in/cube.off'
run 'voxmend info g.npy g.binvox --json'
run 'voxmend info g.binvox --list 3'
run 'voxmend info g.raw'
run 'voxmend info - <g.binvox' # which is read as a mesh
run 'voxmend info - <g.octree'
run 'voxmend info - <g.nrrd'
run 'voxmend info - - <in/cube.off'

say "# nothing that repair would leave, vertices that are not finite, and names that would steer a terminal"
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >flat.off
sed '3s/.*/nan nan nan/' in/cube.off >nan.off
run 'voxmend info flat.off | head -2'
run 'voxmend info nan.off --strict | head -2; voxmend info flat.off nan.off; voxmend voxelize nan.off -o nan.npy -r 4 -q --strict; rm flat.off nan.*'
name=$(printf 'es\033[31mc')
cp in/cube.off "$name.obj"
voxmend voxelize in/cube.off -o "$name.npy" -r 4 -q
run 'for f in es*.obj es*.npy; do voxmend info "$f"; done | head -1; voxmend info es*'
run 'voxmend voxelize es*.obj -o "$name.npy" -r 4 --threads 1 | head -1; voxmend info "no$name"; rm es*'

say "# report and progress"
run 'voxmend info -q --report r.json in/cube.off && cat r.json'
run 'voxmend info -q --report no/such/r.json in/cube.off'
run 'voxmend info -q in/cube.off --threads 3 --memlimit 1g --progress never'
run 'voxmend info in/cube.off >/dev/full'
run 'voxmend info --json in/cube.off >/dev/full'
run 'ls'
finish
