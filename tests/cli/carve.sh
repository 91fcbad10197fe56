#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend carve: paths of all kinds, grids and octrees alike, a path that comes line by line, and what is refused.
. "$SRCDIR/tests/cli/lib.sh"
timeless() {
  sed -E 's/in [0-9.]+ ms \([0-9]+ a second\)/in T ms (N a second)/; s/("(carve_ms|steps_per_second)": )[0-9.e+-]+/\1N/'
}
voxmend voxelize in/cube.off -o stock.npy -r 40x32x24 --bounds 0,0,0,1,1,1 -q
voxmend convert stock.npy -o stock.nrrd -q
cat >tool.off <<'END'
OFF
6 8 0
.2 0 0
-.2 0 0
0 .2 0
0 -.2 0
0 0 .3
0 0 -.3
3 0 2 4
3 2 1 4
3 1 3 4
3 3 0 4
3 2 0 5
3 1 2 5
3 3 1 5
3 0 3 5
END
cat >path.csv <<'END'
x, y, z
# along an edge, across, and somewhere else
-0.9, 0.1, 0.8
1.9, 0.1, 0.8

0.8, 0.8, 1
0.6, 0.7, 0.2
END
cat >turns.csv <<'END'
.5,.5,1,1,0,0,0
.5,.5,1,1,0,1,0
.8,.3,.6,0,0,2,0
END
cat >matrices.csv <<'END'
1,0,0,.5,0,1,0,.5,0,0,1,1
0,0,1,.5,0,1,0,.5,-1,0,0,1
-1,0,0,.8,0,1,0,.3,0,0,-1,.6
END
run 'voxmend carve stock.npy -t tool.off -p path.csv -o rest.npy | timeless'
run 'voxmend carve stock.npy -t tool.off -p turns.csv -o turned.npy | timeless'
run '{ printf "\357\273\277"; cat turns.csv; } >marked.csv; voxmend carve stock.npy -t tool.off -p marked.csv -o x.npy -q && cmp x.npy turned.npy && echo equal'
run 'voxmend carve stock.npy -t tool.off -p matrices.csv -o x.npy -q && cmp x.npy turned.npy && echo equal'
run 'voxmend carve stock.npy -t tool.off -p - -o x.npy -q <path.csv && cmp x.npy rest.npy && echo equal'
run 'voxmend convert rest.npy -o rest.nrrd -q && voxmend carve - -t tool.off -p path.csv -o - --format nrrd -q <stock.nrrd | cmp - rest.nrrd && echo equal'
run 'for t in 1 3; do voxmend carve stock.npy -t tool.off -p turns.csv -o x.npy -q --threads $t && cmp x.npy turned.npy && echo equal; done'
run 'voxmend carve stock.npy -t tool.off -p path.csv -o x.npy --json | timeless'

say "# octrees"
voxmend convert stock.npy -o stock.octree -q
voxmend convert rest.npy -o rest.octree -q
run 'voxmend carve stock.octree -t tool.off -p path.csv -o x.octree -q && cmp x.octree rest.octree && echo equal'
run 'voxmend carve stock.npy -t tool.off -p path.csv -o x.rle --sparse -q && voxmend compare x.rle rest.npy -q --strict && echo equal'

say "# what does not go"
printf '1,2\n' >two.csv
printf '1,2,3\n1,2,3,1,0,0,0\n' >mixed.csv
printf '0,0,0\n1,2,3x\n' >wrong.csv
printf '0,0,0,0,0,0,0\n' >null.csv
printf '1,0,0,0,0,1,0,0,0,0,-1,0\n' >mirror.csv
printf '0,0,0\n0,0,1e99\n' >far.csv
printf 'x,y,z\n# nothing\n' >empty.csv
printf '1 2,3,4\n' >blank.csv
printf 'O,0,0\n0,0,0\n' >letter.csv
printf 'nan,0,0\n0,0,0\n' >nan.csv
printf 'x,y,z\nx,y,z\n0,0,0\n' >twice.csv
for name in two mixed wrong null mirror far empty blank letter nan twice missing; do
  run "voxmend carve stock.npy -t tool.off -p $name.csv -o y.npy"
done
run 'voxmend carve stock.npy -t tool.off -o y.npy'
run 'voxmend carve stock.npy -p path.csv -o y.npy'
run 'voxmend carve -t tool.off -p path.csv -o y.npy'
run 'voxmend carve - -t tool.off -p - -o y.npy </dev/null'
run 'voxmend carve stock.npy -t tool.off -p path.csv -o path.csv --format npy'
run 'voxmend carve stock.npy -t missing.off -p path.csv -o y.npy'
run 'ls y.npy'
finish
