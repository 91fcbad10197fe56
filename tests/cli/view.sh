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
say "# colours and labels of a mesh: those of voxelize"
run 'voxmend view in/torus.off -o v.png -r 24 --color position -q && voxmend voxelize in/torus.off -o v.npy -r 24 --color position -q && voxmend view v.npy -o v2.png -q && cmp v.png v2.png'
run 'voxmend view in/torus.off -o v.png -r 24 --labels part -q && voxmend voxelize in/torus.off -o v.npy -r 24 --labels part -q && voxmend view v.npy -o v2.png -q && cmp v.png v2.png'
cat >tetra.ply <<'END'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 4
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
0 1 0 0 0 255
0 0 1 255 255 0
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
END
run 'voxmend view tetra.ply -o v.png -r 24 --color mesh && voxmend voxelize tetra.ply -o v.npy -r 24 --color mesh -q && voxmend view v.npy -o v2.png -q && cmp v.png v2.png'
run 'voxmend view in/torus.off -o x.png --color mesh'
run 'voxmend view in/torus.off -o x.png --color part --labels part'
run 'voxmend view in/torus.off -o x.png --labels part -r 600'
run 'voxmend view in/torus.off -o x.png --threshold 1'
run 'voxmend view t.npy -o x.png --labels part'
say "# numbers: what of them is drawn"
run 'voxmend voxelize in/torus.off -o d.npy --like t.npy --distance signed -q && voxmend view d.npy -o d.png && cmp d.png t.png'
run 'voxmend view d.npy -o wide.png --below 0.1 -q && cmp -s wide.png t.png'
run 'voxmend voxelize in/torus.off -o c.npy --like t.npy --coverage 8 -q && voxmend view c.npy -o c.png --json'
run 'voxmend convert c.npy -o half.rle --threshold 0.5 -q && voxmend view half.rle -o half.png -q && cmp half.png c.png'
run 'voxmend voxelize in/torus.off -o l.npy --like t.npy --labels part -q && voxmend view l.npy -o l.png -q && cmp -s l.png t.png'
run 'voxmend convert l.npy -o l.binvox -q && voxmend view l.binvox -o l2.png -q && cmp l2.png l.png'
run 'voxmend voxelize in/torus.off -o k.npy --like t.npy --color position -q && voxmend view k.npy -o k.png -q && cmp -s k.png t.png'
run 'voxmend convert k.npy -o k.nrrd -q && voxmend view k.nrrd -o k2.png -q && cmp k2.png k.png'
(printf '\223NUMPY\001\000\166\000%-117s\n' "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2), }" && printf '\000\000\200\077\000\000\000\100') >f.npy
run 'voxmend view f.npy -o out.png'
run 'voxmend view f.npy -o f.png --threshold 1.5 -q && size f.png'

say "# slices, seen where the axis says"
run 'voxmend view t.npy -o s.png --slice z=0.5 && size s.png'
run 'voxmend view d.npy -o s1.png --slice x=1 --size 100x50 -q && voxmend view d.npy -o s2.png --slice x=0.99 --size 100x50 -q && cmp s1.png s2.png'
run 'voxmend view d.npy -o s3.png --slice x=0.5 --size 100x50 -q && cmp -s s1.png s3.png'
run 'voxmend view d.npy -o x.png --slice z=1.5'
run 'voxmend view d.npy -o x.png --slice z=0.5 --elevation 10'
say "# pages"
run 'voxmend view t.npy -o t.html'
run 'cp in/torus.off torus.obj && voxmend view torus.obj -o m.html -r 16'
run 'voxmend view t.npy -o t.html -r 16'
run 'voxmend view t.npy -o t.html --slice z=0'
run 'voxmend view t.npy -o t.htm'
say "# the header of an octree tells what a page does not take: its values are not read"
run 'voxmend voxelize in/torus.off -o l.octree --labels part -r 800x800x110 -q && voxmend view l.octree -o l.html --memlimit 64M'
run 'voxmend voxelize in/torus.off -o s.octree -r 2049x9x9 -q && voxmend view s.octree -o s.html'
run 'ls l.html s.html'

say "# failures"
run 'voxmend view missing.npy -o out.png'
run 'voxmend view in/truth.tsv -o out.png'
run 'voxmend view t.npy -o no/such/out.png'
run 'ls out.png'
finish
