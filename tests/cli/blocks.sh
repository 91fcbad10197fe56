#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The formats of games and artists: .schem and .litematic (Minecraft), .vox (MagicaVoxel) and .glb.
grep -q '^#define HAVE_ZLIB 1' "$BUILDDIR/config.h" || { echo "built without zlib"; exit 77; }
. "$SRCDIR/tests/cli/lib.sh"

say "# set voxels"
run 'voxmend voxelize in/sphere.off -o solid.npy -r 12 -q'
for format in schem litematic vox; do
  run "voxmend voxelize in/sphere.off -o solid.$format -r 12 -q && voxmend convert solid.npy -o - --format $format -q | cmp - solid.$format"
  run "voxmend convert solid.$format -o back.npy -q && cmp back.npy solid.npy && cmp back.npy.json solid.npy.json"
  run "voxmend convert - -o - --format $format -q <solid.$format | cmp - solid.$format"
done
run 'voxmend compare solid.vox solid.litematic --strict'
run 'voxmend voxelize in/sphere.off -o turned.schem -r 12x6x6 --up x --blocks oak_planks -q && voxmend convert turned.schem -o turned.npy'
# voxels that are no cubes look stretched in other programs, and come back as they are
run 'voxmend voxelize in/sphere.off -o flat.npy -r 12x12x6 --bounds=-1,-1,-1,1,1,1 --labels part -q'
for format in schem litematic vox; do
  run "voxmend convert flat.npy -o flat.$format && voxmend convert flat.$format -o back.npy --force -q && cmp flat.npy.json back.npy.json"
  run "voxmend voxelize in/sphere.off -o flat.$format -r 12x12x6 --bounds=-1,-1,-1,1,1,1 --force -q --strict"
done
rm flat.* back.*
run 'voxmend view solid.vox -o solid.png -q'

say "# labels and colours"
run 'voxmend voxelize in/sphere.off -o l.npy -r 12 --labels part -q'
run 'voxmend voxelize in/sphere.off -o k.npy -r 12 --color position -q'
for format in schem litematic vox; do
  run "voxmend voxelize in/sphere.off -o l.$format -r 12 --labels part -q && voxmend convert l.$format -o back.npy && cmp back.npy.json l.npy.json"
  run "voxmend voxelize in/sphere.off -o k.$format -r 12 --color position -q && voxmend convert k.$format -o back.npy -q && cmp back.npy.json k.npy.json"
done
run 'voxmend convert k.npy -o few.litematic --blocks white_wool,red_wool,blue_wool -q && voxmend convert few.litematic -o few.npy'

say "# the surface"
run 'voxmend convert solid.npy -o solid.glb'
run 'voxmend convert solid.npy -o solid.glb'
run 'voxmend convert solid.npy -o solid.glb --force --up y -q'
run 'voxmend convert solid.glb -o x.npy'
run 'voxmend convert solid.npy -o x.glb --polygons keep'
run 'voxmend combine solid.npy or solid.npy -o x.glb --no-manifold'
run 'voxmend voxelize in/sphere.off -o x.npy -r 12 --no-manifold'

say "# what cannot be"
run 'voxmend convert solid.npy -o x.npy --blocks stone'
run 'voxmend convert solid.npy -o x.vox --up y'
run 'voxmend convert solid.npy -o x.schem --up w'
run 'voxmend convert solid.npy -o x.schem --blocks "Stone bricks"'
run 'voxmend convert solid.npy -o x.schem --blocks air'
run 'voxmend convert k.npy -o x.schem --blocks glass'
run 'voxmend voxelize in/sphere.off -o x.schem -r 12 --sparse'
run 'voxmend voxelize in/sphere.off -o x.vox -r 12 --distance signed'
run 'voxmend voxelize in/sphere.off -o x.schem --bounds 0,0,0,70000,1,1 --voxel-size 1'
run 'head -c 100 solid.schem >cut.schem; voxmend convert cut.schem -o x.npy'
run 'head -c 100 solid.vox >cut.vox; voxmend convert cut.vox -o x.npy'
run 'ls'
finish
