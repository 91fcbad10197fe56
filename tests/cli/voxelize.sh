#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend voxelize: summary, JSON, voxel spaces, streams, and nothing left behind after a failure.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend voxelize in/cube.off -o cube.npy -r 8'
run 'voxmend voxelize in/degenerate.off -o cube.binvox -r 8 --json'
run 'voxmend voxelize in/open_box.off -o open.rle -r 16 -v'
run 'voxmend voxelize in/doubled.off -o doubled.npy -r 16 --no-repair --strict --thin drop'

say "# spaces"
run 'voxmend voxelize in/l_prism.off -o a.npy --fit tight -r 16'
run 'voxmend voxelize in/l_prism.off -o a.npy --fit sphere -r 16'
run 'voxmend voxelize in/l_prism.off -o a.npy -r 16x16x8'
run 'voxmend voxelize in/l_prism.off -o a.npy -r 16 --pad 2'
run 'voxmend voxelize in/l_prism.off -o a.npy --voxel-size 0.25 --fit tight --pad 1'
run 'voxmend voxelize in/l_prism.off -o a.npy --voxel-size 0.25,0.5,0.125 --fit tight'
run 'voxmend voxelize in/l_prism.off -o a.binvox --voxel-size 0.25,0.5,0.125 --fit tight'
run 'voxmend voxelize in/l_prism.off -o a.npy --bounds 0,0,0,2,2,1 -r 16'
run 'voxmend voxelize in/l_prism.off -o b.npy --bounds -1,-1,-1,3,3,3 --voxel-size 0.5'
run 'voxmend voxelize in/rocket.off -o r.npy --bounds=-1,-1,2,1,1,4 -r 16'
run 'voxmend voxelize in/rocket.off -o r.npy --bounds=-1,-1,2,1,1,4 -r 16 --thin drop --json | grep -E "hold no|_parts.:"'
run 'voxmend voxelize in/rocket.off -o r.npy --bounds 9,9,9,10,10,10 -r 16'
run 'voxmend voxelize in/cube.off -o c.npy --like b.npy'
run 'voxmend voxelize in/cube.off -o c.npy --like in/cube.off'

say "# methods, votes and parts"
for options in '--method x' '--method y' '--method z' '--method tetra' '--vote any' '--vote all' '--parts group' '--parts whole'; do
  run "voxmend voxelize in/missing.off -o m.npy -r 32 $options | grep -E '^(parts|voxels|contested|hash)'"
done

say "# surfaces"
for options in '' '--surface conservative' '--surface thin' '--surface shell26' '--surface shell18' '--surface shell6'; do
  run "voxmend voxelize in/rocket.off -o s.npy -r 64 --mode surface $options | grep -E '^(voxels|hash)'"
done
run "voxmend voxelize in/rocket.off -o s.npy -r 64 --mode both --surface thin | grep -E '^(voxels|hash)'"
for options in '--mode surface' '--mode both' '--mode surface --surface shell18'; do
  run "voxmend voxelize in/rocket.off -o whole.npy -r 300 $options | grep -E '^(voxels|hash)'"
  run "voxmend voxelize in/rocket.off -o pieces.npy -r 300 $options --memlimit 26M --threads 1 | grep -E '^(estimate|voxels|hash)'"
  run 'cmp whole.npy pieces.npy'
done

say "# thin parts"
# a sheet, askew; a rod thinner than a voxel; and a body
printf 'OFF\n16 8 0\n0 0 4\n5 1 5\n4 6 6\n-1 5 5\n0 0 0\n4 0.5 1\n4 0.6 1\n0 0.1 0.1\n' >thin.off
for z in 7 9; do printf '1 1 %s\n3 1 %s\n3 3 %s\n1 3 %s\n' $z $z $z $z; done >>thin.off
printf '4 0 1 2 3\n4 4 5 6 7\n4 11 10 9 8\n4 12 13 14 15\n4 8 9 13 12\n4 9 10 14 13\n4 10 11 15 14\n4 11 8 12 15\n' >>thin.off
run 'voxmend voxelize thin.off -o keep.npy -r 24'
run 'voxmend voxelize thin.off -o drop.npy -r 24 --thin drop'
run 'voxmend voxelize thin.off -o octree.npy -r 24 --sparse -q && cmp octree.npy keep.npy'
for options in '' '--thin keep' '--thin drop' '--thin 26' '--method winding' '--method winding --thin keep' '--vote any' '--mode both' '--mode surface --surface shell6'; do
  run "voxmend voxelize thin.off -o t.npy -r 24 $options 2>/dev/null | grep -E '^(voxels|thin|hash)'"
done
run 'voxmend voxelize thin.off -o t.npy -r 24 --json | grep -A 3 thin\"'
run 'voxmend voxelize thin.off -o t.npy -r 24 --thin drop --json 2>&1 | grep -A 3 thin\"'
run 'voxmend voxelize in/cube.off -o t.npy -r 24 | grep ^thin'
run 'voxmend voxelize in/rocket.off -o t.npy -r 16 --coverage 2 2>&1 | grep -E "^coverage|surface"'

run 'voxmend voxelize thin.off -o t.npy -r 24 --distance signed 2>&1 | grep -c "no distance there is negative"'
run 'voxmend voxelize in/cube.off -o t.npy -r 24 --distance signed 2>&1 | grep -c "no distance there is negative"'

say "# beyond the grid"
printf 'OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n' >floor.off
run 'voxmend voxelize floor.off -o t.npy -r 8 --bounds 0,0,0,1,1,1 2>&1 | grep -E "^voxels|outside"'
run 'voxmend voxelize in/cube.off -o t.npy -r 8 --bounds 0,0,0,1,1,0.5 2>&1 | grep -E "^voxels|outside"'
run 'voxmend voxelize in/cube.off -o like.npy -r 8 --bounds 0.5,0,0,2,1,1 -q; voxmend voxelize in/cube.off -o t.npy --like like.npy --mode surface --json -q | grep outside'

say "# a number per voxel"
run 'voxmend voxelize in/cube.off -o c.nrrd -r 8 --pad 1 --coverage 4'
run 'voxmend voxelize in/cube.off -o c.npy -r 8 --pad 1 --coverage 2 --scalar uint8 --json'
run 'voxmend voxelize in/cube.off -o d.nrrd -r 8 --pad 2 --distance signed --band 2'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --distance unsigned --band 0 --json'
run 'head -n 12 d.nrrd && wc -c <d.nrrd && cat d.npy.json && wc -c <d.npy'
run 'voxmend voxelize in/cube.off -o - --format nrrd -r 8 --pad 2 --distance signed --band 2 -q | cmp - d.nrrd'
run 'voxmend voxelize in/rocket.off -o whole.nrrd -r 120 --coverage 8 --scalar uint8 -q'
run 'voxmend voxelize in/rocket.off -o pieces.nrrd -r 120 --coverage 8 --scalar uint8 -q --memlimit 48M --threads 1'
run 'cmp whole.nrrd pieces.nrrd'

say "# the same bits for any number of threads"
for threads in 1 2 7; do
  run "voxmend voxelize in/rocket.off -o t$threads.npy -r 100 --threads $threads | grep -E '^(voxels|hash)'"
done
run 'cmp t1.npy t2.npy && cmp t1.npy t7.npy'

say "# streams and reports"
run 'voxmend voxelize - -o - --format rle -r 8 <in/cube.off >cube.rle'
run 'voxmend voxelize in/cube.off -o cube2.rle -r 8 -q && cmp cube.rle cube2.rle'
run 'voxmend voxelize in/cube.off -o cube.binvox -r 8 -q --report r.json && cat r.json'
run 'voxmend voxelize in/cube.off -o - --format raw -r 8'
run 'voxmend voxelize in/cube.off -o cube.raw -r 8 -q && wc -c <cube.raw && cat cube.raw.json'

say "# bounded memory, and what it will take"
run 'voxmend voxelize in/rocket.off -o whole.npy -r 600 | grep -E "^(voxels|hash)"'
run 'voxmend voxelize in/rocket.off -o pieces.npy -r 600 --memlimit 24M --threads 1 | grep -E "^(estimate|voxels|hash)"'
run 'cmp whole.npy pieces.npy'
run 'voxmend voxelize in/rocket.off -o not.npy -r 2000 --dry-run --memlimit 100M --threads 2 | sed "s/up to .* of memory/up to N of memory/"'
run 'voxmend voxelize in/rocket.off -o not.npy -r 2000 --dry-run --json --memlimit 100M --threads 2'
run 'voxmend voxelize in/rocket.off -o not.npy -r 1000 --coverage 4 --dry-run --threads 2 | sed "s/up to .* of memory/up to N of memory/"'
run 'voxmend voxelize in/rocket.off -o not.npy -r 1000 --coverage 2 --scalar uint8 --dry-run --json --threads 2 | grep -A 4 estimate | sed "s/memory_bytes.: .*,/memory_bytes\": N,/"'
run 'voxmend voxelize in/rocket.off -o not.nrrd -r 1000 --distance signed --dry-run --memlimit 60M --threads 2 | sed "s/up to .* of memory/up to N of memory/"'
run 'voxmend voxelize in/rocket.off -o not.nrrd -r 1000 --distance unsigned --dry-run --memlimit 1M'
say "# advice names what told the size of voxels"
voxmend voxelize thin.off -o like.npy -r 24 -q
run 'voxmend voxelize in/rocket.off -o not.nrrd --voxel-size 0.004 --distance unsigned --dry-run --memlimit 1M'
run 'voxmend voxelize in/rocket.off -o not.nrrd --like like.npy --distance unsigned --dry-run --memlimit 20K'
run "voxmend voxelize in/cube.off -o not.npy --voxel-size 0.00001 2>&1 | sed -E 's/needs .* are in use/needs N and more/'"
for options in '-r 24' '--voxel-size 0.5' '--like like.npy'; do
  run "voxmend voxelize thin.off -o few.npy $options --thin drop >/dev/null"
  run "voxmend voxelize thin.off -o near.npy $options --distance signed >/dev/null"
done
run 'test -e not.npy || test -e not.nrrd || echo nothing written'

say "# octrees and coordinates"
for options in '' '--mode both' '--mode surface --surface thin' '--vote majority'; do
  run "voxmend voxelize in/rocket.off -o whole.rle -r 100 --coords whole.npy $options | grep -E '^(voxels|octree|hash)'"
  run "voxmend voxelize in/rocket.off -o octree.rle -r 100 --coords octree.npy $options --sparse | grep -E '^(voxels|octree|hash)'"
  run 'cmp whole.rle octree.rle && cmp whole.npy octree.npy'
done
run 'voxmend voxelize in/rocket.off -o octree.rle -r 100 --sparse --json | grep -A 4 sparse'
# large grids that would be held whole are made as octrees by themselves
large='in/cube.off -r 4096x4096x40 --bounds=-20,-20,-20,20,20,20'
run 'voxmend voxelize $large -o large.rle --coords large.npy | grep -E "^(estimate|voxels|octree|hash)"'
run 'voxmend voxelize $large -o sparse.rle --coords sparse.npy --sparse -q && cmp large.rle sparse.rle && cmp large.npy sparse.npy'
run 'voxmend voxelize $large -o dense.rle | grep -E "^(voxels|octree|hash)" && cmp large.rle dense.rle'
run 'voxmend voxelize in/cube.off -o x.obj --sparse'
run 'voxmend voxelize in/cube.off -o x.npy --sparse --confidence y.npy'
run 'voxmend voxelize in/cube.off -o x.npy --coords x.npy'
run 'voxmend voxelize in/cube.off -o x.npy --coords x.txt'

say "# failures leave nothing"
mkdir out
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >flat.off
run 'voxmend voxelize flat.off -o out/x.npy'
run 'voxmend voxelize flat.off -o out/x.npy --no-repair --thin drop'
run 'voxmend voxelize missing.off -o out/x.npy'
run 'voxmend voxelize in/cube.off -o no/such/x.npy -r 8'
run 'voxmend voxelize in/cube.off -o out/x.npy -r 4096 --memlimit 10M'
run 'voxmend voxelize in/cube.off -o out/x.obj -r 4096 --memlimit 100M'
run 'voxmend voxelize in/cube.off -o out/x.npy --voxel-size 1e-12'
run 'voxmend voxelize in/cube.off -o out/x.npy --pad 64'
run 'voxmend voxelize in/cube.off -o out/x.binvox --bounds 0,0,0,1,1,2 -r 8x8x8'
run 'voxmend voxelize in/cube.off -o out/x.npy -r 8 --report no/such/r.json'
run 'voxmend voxelize in/cube.off -o out/x.raw -r 8 --report no/such/r.json'
run 'voxmend voxelize in/cube.off -o - --format npy -r 64 >/dev/full'
run 'ls out'
finish
