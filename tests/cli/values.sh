#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Numbers in files stay numbers: convert, compare, view and --like with distances, coverage, labels, confidence and colours.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend voxelize in/sphere.off -o solid.rle -r 24 --pad 4 -q'
run 'voxmend voxelize in/sphere.off -o d.nrrd --like solid.rle --distance signed -q'
run 'voxmend convert d.nrrd -o d.npy'
run 'voxmend convert d.npy -o - --format nrrd -q | cmp - d.nrrd'
run 'voxmend convert d.npy -o again.npy --json'
run 'cmp again.npy d.npy && cmp again.npy.json d.npy.json'

say "# bits only by a threshold"
mkdir out
for format in rle raw binvox obj stl; do
  run "voxmend convert d.npy -o out/x.$format"
done
run 'voxmend compare d.npy solid.rle'
run 'voxmend convert d.npy -o below.rle --below 0 && cmp below.rle solid.rle'
run 'voxmend convert d.npy -o above.rle --threshold 0 -q && voxmend compare above.rle below.rle'
run 'voxmend convert d.npy -o band.npy --threshold -0.05 --below 0.05'
run 'voxmend compare d.npy solid.rle --below 0 --strict'
run 'voxmend convert d.npy -o ball.obj --below 0.1'
run 'voxmend convert solid.rle -o same.rle --below 0 && cmp same.rle solid.rle'
run 'voxmend convert d.npy -o out/x.rle --below nan'
run 'voxmend convert d.npy -o out/x.rle --threshold deep'
run 'voxmend voxelize in/cube.off -o like.rle --like d.npy'
run 'ls out'

say "# coverage, labels, confidence and colours"
run 'voxmend voxelize in/sphere.off -o c.npy -r 24 --coverage 2 --scalar uint8 -q && voxmend convert c.npy -o c.nrrd'
run 'voxmend convert c.nrrd -o out/x.binvox'
cat >pair.obj <<'END'
v 0 0 0
v 1 0 0
v 3 0 0
v 0 1 0
v 1 1 0
v 3 1 0
v 0 0 1
v 1 0 1
v 3 0 1
v 0 1 1
v 1 1 1
v 3 1 1
g small
f 1 4 5 2
f 7 8 11 10
f 1 2 8 7
f 4 10 11 5
f 1 7 10 4
f 2 5 11 8
g large
f 2 5 6 3
f 8 9 12 11
f 2 3 9 8
f 5 11 12 6
f 3 6 12 9
f 2 8 11 5
END
for more in '' --no-repair; do # boxes that share a wall
  run "voxmend voxelize pair.obj -o pair.npy --voxel-size 0.25 --fit tight --labels group $more && grep -A1 name pair.npy.json"
done
run 'voxmend view pair.obj -o pair.html --labels group -r 12'
run 'voxmend voxelize in/sphere.off -o l.npy -r 24x20x22 --fit tight --labels part -q && voxmend convert l.npy -o l.binvox'
run 'voxmend convert l.binvox -o l2.npy -q && voxmend convert l2.npy -o l3.binvox -q && cmp l3.binvox l.binvox && cmp l2.npy.json l.npy.json'
run 'voxmend convert l.npy -o l.rle'
run 'voxmend voxelize in/sphere.off -o s.rle -r 24 --confidence sure.npy -q && voxmend convert sure.npy -o sure.nrrd'
run 'voxmend convert sure.npy -o out/x.raw'
run 'voxmend voxelize in/sphere.off -o k.npy -r 24 --color position -q && voxmend convert k.npy -o k.nrrd'
run 'voxmend convert k.nrrd -o k2.npy -q && cmp k2.npy k.npy && cmp k2.npy.json k.npy.json && voxmend convert k.nrrd -o k.vox -q && voxmend convert k.nrrd -o k.ply -q'
run 'voxmend voxelize in/sphere.off -o k3.vox -r 24 --color position -q && cmp k3.vox k.vox'
run 'voxmend convert k.npy -o out/x.vdb'
run 'voxmend convert k.npy -o k.rle --threshold 1 -q && voxmend voxelize in/sphere.off -o k2.rle -r 24 -q && cmp k.rle k2.rle'
run 'voxmend convert solid.rle -o out/x.vox'
run 'ls out'

say "# arrays of other programs: 2 x 1 x 2 numbers"
array() {
  printf '\223NUMPY\001\000\166\000%-117s\n' "{'descr': '$1', 'fortran_order': False, 'shape': (2, 1, 2), }"
}
(array '|u1'; printf '\000\001\001\000') >bits.npy
(array '|u1'; printf '\000\377\377\000') >mask.npy
(array '|u1'; printf '\000\003\377\000') >bytes.npy
(array '<f4'; printf '\000\000\000\000\000\000\200\077\000\000\200\077\000\000\000\200') >floats.npy
(array '>i2'; printf '\000\000\000\001\377\377\001\000') >whole.npy
for name in bits mask bytes floats whole; do
  run "voxmend convert $name.npy -o $name.nrrd -q && grep -a type $name.nrrd"
  run "voxmend convert $name.npy -o $name.rle -q && voxmend compare $name.rle bits.npy -q --report $name.json && grep only $name.json"
done
run 'voxmend convert whole.npy -o whole.binvox'
finish
