#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend remesh: closed surfaces, whatever the mesh; its volume, formats and refusals.
. "$SRCDIR/tests/cli/lib.sh"

# Times differ between runs.
summary() {
  sed -E 's/[0-9.]+ ms/T ms/; s/(read|repair|remesh|write) [0-9.]+/\1 T/g'
}
facts() {
  voxmend info "$1" | grep -E "^closed|^open|components  |watertight|volume"
}

run 'voxmend remesh in/torus.off -o t.ply --force -r 48 | summary'
run 'facts in/torus.off; facts t.ply'
say "# the same in each format, with any threads, and from standard input"
run 'for f in off obj stl; do voxmend remesh in/torus.off -o t.$f -r 48 -q --threads 7 && facts t.$f | grep volume; done'
run 'voxmend remesh - -o - --format ply -r 48 -q <in/torus.off | cmp - t.ply'
say "# a sheet comes out as a plate, or not at all without what holds thin parts together"
printf 'OFF\n4 1 0\n0 0 0\n8 0 0\n8 8 0\n0 8 0\n4 0 1 2 3\n' >sheet.off
run 'voxmend remesh sheet.off -o s.ply --voxel-size 0.5 -q && facts s.ply'
run 'voxmend remesh sheet.off -o s2.ply --voxel-size 0.5 --thin drop -q && facts s2.ply'
say "# a plate with a face on voxel centres and a stud, of volume 537.3"
awk 'function box(low, high, bottom, top, i) { for (i = 0; i < 8; i++)
    print i % 2 ? high : low, int(i / 2) % 2 ? high : low, i < 4 ? bottom : top }
  function faces(n) { printf "4 %d %d %d %d\n", n, n + 2, n + 3, n + 1; printf "4 %d %d %d %d\n", n + 4, n + 5, n + 7, n + 6
    printf "4 %d %d %d %d\n", n, n + 1, n + 5, n + 4; printf "4 %d %d %d %d\n", n + 2, n + 6, n + 7, n + 3
    printf "4 %d %d %d %d\n", n, n + 4, n + 6, n + 2; printf "4 %d %d %d %d\n", n + 1, n + 3, n + 7, n + 5 }
  BEGIN { print "OFF\n16 12 0"; box(0, 24, 0.5, 1.4); box(9, 12, 0, 3); faces(0); faces(8) }' >plate.off
run 'voxmend remesh plate.off -o p.ply --voxel-size 1 -q && facts p.ply'
say "# with voxels that are no cubes"
run 'voxmend remesh in/torus.off -o flat.ply --voxel-size 0.02,0.04,0.06 -q && facts flat.ply'
say "# two cubes that touch along an edge are one, and two without what holds thin parts together"
printf 'o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n' >a.obj
sed -e '/^f/d' a.obj | awk '/^v/ { print "v", $2 + 1, $3 + 1, $4 }' >b.obj
sed -n '/^f/p' a.obj | awk '{ print "f", $2 + 8, $3 + 8, $4 + 8, $5 + 8 }' >>b.obj
run 'cat a.obj b.obj >two.obj; voxmend remesh two.obj -o two.ply -r 16 -q && facts two.ply'
run 'voxmend remesh two.obj -o apart.ply -r 16 --thin drop -q && facts apart.ply'
say "# refusals"
run 'voxmend remesh in/torus.off -o t.ply --force -r 0'
run 'voxmend remesh in/torus.off -o t.ply --force -r 32 --voxel-size 1'
run 'voxmend remesh in/torus.off -o t.ply --force -r 32 --voxel-size 1,1,2'
run 'voxmend remesh in/torus.off -o t.ply --force --voxel-size 1,2'
run 'voxmend remesh in/torus.off -o t.npy'
awk 'NR > 2 && NF == 3 { printf "%.17g %.17g %.17g\n", $1 + 1e9, $2, $3; next } { print }' in/cube.off >far.off
run 'voxmend remesh far.off -o far.stl -r 8'
run 'voxmend remesh in/torus.off -o big.ply -r 4000 --memlimit 100M; test -e big.ply'
say "# more than the machine has"
run "voxmend remesh in/cube.off -o huge.off -r 1048576 2>&1 | sed -E 's/has [0-9.]+ .iB and .* are in use/has N and M are in use/'"
finish
