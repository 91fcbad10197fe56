#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend convert, compare and view.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend voxelize in/torus.off -o t.npy -r 24 -q'
run 'voxmend convert t.npy -o t.binvox'
run 'voxmend convert t.binvox -o t.rle --json'
run 'voxmend convert t.rle -o t.raw -q'
run 'voxmend convert t.raw -o back.npy -q && voxmend compare t.npy back.npy'
run 'voxmend convert - -o - --format binvox <t.npy 2>err.log | cmp - t.binvox; cat err.log'
run 'gzip -c t.npy | voxmend convert - -o zipped.npy'
run 'voxmend convert t.npy -o t.obj -q && voxmend info t.obj'
run 'voxmend convert t.npy -o t.grid --format rle -q && cmp t.rle t.grid'
run 'voxmend convert t.npy -o t.nrrd && voxmend compare t.nrrd t.npy --strict -q && voxmend convert t.nrrd -o back.npy -q'
run 'cmp back.npy t.npy && cmp back.npy.json t.npy.json && head -n 12 t.nrrd'
run 'voxmend convert t.npy -o - --format nrrd -q | voxmend compare - t.nrrd -q'
run 'voxmend voxelize in/torus.off -o direct.nrrd --like t.nrrd -q && cmp direct.nrrd t.nrrd'
run 'voxmend voxelize in/torus.off -o direct.nrrd -r 24 --sparse -q && cmp direct.nrrd t.nrrd'

say "# octrees and windows"
run 'voxmend convert t.npy -o t.octree && voxmend convert t.octree -o back.npy -q && cmp back.npy t.npy'
run 'voxmend voxelize in/torus.off -o direct.octree -r 24 --sparse -q && cmp direct.octree t.octree'
run 'voxmend voxelize in/torus.off -o - --format octree -r 24 -q | cmp - t.octree'
run 'voxmend convert t.octree -o part.npy --window 3:20,4:14,6:18'
run 'voxmend convert t.npy -o part2.npy --window 3:20,4:14,6:18 -q && cmp part.npy part2.npy && cmp part.npy.json part2.npy.json'
run 'voxmend voxelize in/torus.off -o d.nrrd --distance signed -r 24 -q && voxmend convert d.nrrd --window 3:20,4:14,6:18 -o d.npy'
run 'voxmend convert d.npy --below 0 -o d.rle -q && voxmend compare d.rle part.npy -q --strict'
run 'voxmend convert t.octree -o x.npy --window 3:20,4:14,6:99'
run 'voxmend convert t.octree -o x.npy --window 3:20,5:6'
run 'voxmend convert t.octree -o x.npy --window 3:20,6:6,0:9'
run 'voxmend convert t.octree -o c.npy --coverage 4 && voxmend convert t.npy -o c2.npy --coverage 4 -q && cmp c.npy c2.npy'
run 'voxmend voxelize in/torus.off -o f.octree -r 24 --thin drop -q && voxmend convert f.octree -o c.npy --coverage 4 -q'
run 'voxmend voxelize in/torus.off -o c2.npy -r 6 --coverage 4 -q && cmp c.npy c2.npy && cmp c.npy.json c2.npy.json'
run 'voxmend convert f.octree -o c3.nrrd --coverage 4 --window 1:5,0:2,2:4 -q && voxmend convert c2.npy -o c4.nrrd --window 1:5,0:2,2:4 -q && cmp c3.nrrd c4.nrrd'
run 'voxmend convert d.nrrd -o c.npy --below 0 --coverage 8 | grep values'
run 'voxmend convert d.nrrd -o x.npy --coverage 8'
run 'voxmend convert t.octree -o x.npy --coverage 8 --window 0:3,0:3,0:4'
# a grid of its own would take 128 MiB: a .octree is made as one without being asked
run 'voxmend voxelize in/torus.off -o large.octree -r 1024 --memlimit 64M -q && voxmend voxelize in/torus.off -o asked.octree -r 1024 --sparse -q && cmp large.octree asked.octree && rm large.octree asked.octree'
run 'voxmend convert t.octree -o x.npy --coverage 3'
run 'voxmend convert t.octree -o x.rle --coverage 4'
for choice in '--labels part' '--color position' '--distance signed' '--coverage 2'; do
  run "voxmend voxelize in/rocket.off -o v.octree -r 40 $choice --sparse -q && voxmend voxelize in/rocket.off -o v.nrrd -r 40 $choice -q"
  run 'voxmend convert v.octree -o w.nrrd -q && cmp w.nrrd v.nrrd && voxmend convert v.nrrd -o w.octree -q && cmp w.octree v.octree'
  run 'voxmend convert v.octree -o w.nrrd --window 3:30,10:24,16:38 && voxmend convert v.nrrd -o w2.nrrd --window 3:30,10:24,16:38 -q && cmp w.nrrd w2.nrrd'
done
run 'voxmend voxelize in/cavity.off -o l.npy -r 16 --labels part --strict -q && voxmend voxelize in/cavity.off -o l.octree -r 16 --labels part --strict -q' # the cavity needs no voxel
run 'voxmend voxelize in/rocket.off -o l.octree -r 40 --labels part -q && grep -c name l.octree.json && voxmend convert l.octree -o l.npy -q && grep -c name l.npy.json'
run 'voxmend info l.octree'
run 'voxmend combine l.octree or l.octree -o x.octree'
run 'voxmend combine l.octree or l.octree -o x.octree --threshold 1 -q && voxmend voxelize in/rocket.off -o y.octree -r 40 -q && cmp x.octree y.octree'
run 'voxmend convert l.octree -o x.npy --coverage 4'
run 'voxmend convert l.octree -o x.npy --coverage 4 --threshold 1 -q && voxmend convert y.octree -o y.npy --coverage 4 -q && cmp x.npy y.npy'
run 'voxmend voxelize in/rocket.off -o x.nrrd -r 40 --labels part --sparse'
head -c 300 l.octree >cut.octree
run 'voxmend convert cut.octree -o x.npy'
head -c 300 t.octree >cut.octree
run 'voxmend convert cut.octree -o x.npy'

say "# slices as pictures"
if voxmend convert t.npy -o s%02d.png -q 2>no_png; then
  run 'ls s??.png | wc -l && voxmend convert s%02d.png -o back.npy && cmp t.npy back.npy && cmp t.npy.json back.npy.json'
  rm s03.png
  run 'voxmend convert s%02d.png -o x.npy'
  run 'voxmend convert t.npy -o x.png'
  run 'voxmend convert d.npy -o x%d.png'
  run 'voxmend convert no%d.png -o x.npy'
else
  grep -q libpng no_png
  sed -n '/# slices as pictures/,/# compare/p' "$expected" | sed '1d;$d' >>transcript
fi

say "# compare"
run 'voxmend voxelize in/sphere.off -o s.npy --like t.npy -q'
run 'voxmend compare t.npy s.npy'
run 'voxmend compare t.npy s.npy --json'
run 'voxmend voxelize in/torus.off -o moved.npy -r 24 --pad 1 -q && voxmend compare t.npy moved.npy --strict'
run 'voxmend voxelize in/torus.off -o small.npy -r 12 -q && voxmend compare t.npy small.npy'
run 'voxmend compare t.npy in/torus.off'
run 'voxmend compare t.npy missing.npy'

say "# convert: failures leave nothing"
mkdir out
head -c 200 t.npy >cut.npy
run 'voxmend convert cut.npy -o out/x.rle'
run 'voxmend convert in/cube.off -o out/x.rle'
run 'voxmend convert t.npy -o no/such/x.rle'
run 'voxmend convert t.npy -o out/x.rle --report no/such/x.json'
run 'ls out'
finish
