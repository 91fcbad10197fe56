#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What repair does with the module for OpenMesh: holes filled with the least area.
. "$SRCDIR/tests/cli/lib.sh"
[ -e "$BUILDDIR/.libs/voxmend-openmesh.so" ] || exit 77
# a tray in the shape of an L
cat >tray.off <<'end'
OFF
12 7 0
0 0 0  3 0 0  3 1 0  1 1 0  1 2 0  0 2 0
0 0 1  3 0 1  3 1 1  1 1 1  1 2 1  0 2 1
6 5 4 3 2 1 0
4 0 1 7 6
4 1 2 8 7
4 2 3 9 8
4 3 4 10 9
4 4 5 11 10
4 5 0 6 11
end
run 'voxmend repair tray.off -o closed.off --level closed --fill minimal'
run 'cat closed.off'
run 'voxmend repair tray.off -o open.off -q --fill-holes 5 --fill minimal && voxmend info open.off'
run 'voxmend repair tray.off -o flat.off -q --fill-holes 6 --fill minimal && voxmend info flat.off'
say "# two holes that touch at a vertex: two of the four squares of a lid are missing"
cat >box.off <<'end'
OFF
17 11 0
0 0 0  1 0 0  2 0 0  2 1 0  2 2 0  1 2 0  0 2 0  0 1 0
0 0 1  1 0 1  2 0 1  2 1 1  2 2 1  1 2 1  0 2 1  0 1 1
1 1 1
8 7 6 5 4 3 2 1 0
4 0 1 9 8
4 1 2 10 9
4 2 3 11 10
4 3 4 12 11
4 4 5 13 12
4 5 6 14 13
4 6 7 15 14
4 7 0 8 15
4 8 9 16 15
4 16 11 12 13
end
run 'voxmend repair box.off -o closed.ply --force --level closed --fill minimal'
run 'voxmend repair box.off -o closed.ply --force --ascii --fill-holes 4 --fill minimal --level manifold -q && cat closed.ply'
run 'voxmend repair box.off -o closed.ply --force --fill-holes 4 --fill minimal'
finish
