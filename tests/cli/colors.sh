#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Colours from the mesh: vertices, faces, materials, textures; what is damaged, missing or leads elsewhere.
. "$SRCDIR/tests/cli/lib.sh"
for library in HAVE_PNG HAVE_JPEG; do
  grep -q "^#define $library" "$BUILDDIR/config.h" || exit 77
done
python=${TEST_PYTHON:-python3}
"$python" "$SRCDIR/tests/cli/colors.py" make
paint() {
  rm -f out.npy
  voxmend voxelize "$1" -o out.npy -q -r 8 --fit tight --pad 1 --color mesh ${2:-} &&
    "$python" "$SRCDIR/tests/cli/colors.py" list out.npy
}
# libpng and libjpeg say in their own words what is damaged.
said() {
  paint "$@" 2>&1 | sed 's/\(damaged [PJ][NE]G\|damaged JPEG\): .*/\1: .../'
}
run 'paint cube.obj'
run 'paint half.obj --color-average'
run 'paint photo_jpg.obj'
run 'paint plain.obj'
run 'paint vertices.obj'
run 'paint faces.off'
run 'voxmend info cube.obj | grep -E "colours|materials|textures"'
run 'voxmend info --json cube.obj | grep -A 12 colors'
run 'voxmend info vertices.obj faces.off -v | grep -E "colours|materials|textures"'
run 'voxmend voxelize vertices.obj -o c.npy -r 8 --color mesh --color-average --json | grep color'
run 'voxmend voxelize vertices.obj -o c.npy -r 8 --color noise --color-average'

say "# nothing to be had"
rm -f c.npy
run 'paint in/cube.off'
run 'paint no_library.obj'
run 'paint nan.obj'
for mesh in torn_png cut_jpg huge_png drawing_bmp empty_png; do
  run "said $mesh.obj"
done
run 'voxmend voxelize huge_png.obj -o c.npy -r 8 --color mesh --memlimit 200M 2>&1 | sed "s/needs .*/.../"'
run 'ls c.npy'

say "# what leads elsewhere is not opened; the colour of the material is there"
run 'paint away.obj'
run 'voxmend voxelize away.obj -o d.npy -r 8 --color mesh 2>&1 | grep -c "was not opened: it lies outside the folder"'
run 'paint absolute.obj'
run 'voxmend info absolute.obj 2>&1 | grep warning'
run 'voxmend voxelize cube.obj -o c.npy -q -r 8 --color mesh --external none'
run 'voxmend voxelize - -o c.npy -q -r 8 --color mesh <cube.obj'

say "# as in ShapeNet: the pictures stand beside the folder of the mesh"
mkdir -p net/models net/images
cp cube.obj net/models/
cp maps/* net/images/
sed 's,maps/,../images/,' cube.mtl >net/models/cube.mtl
run 'paint net/models/cube.obj'
run 'voxmend voxelize net/models/cube.obj -o d.npy -r 8 --color mesh 2>&1 | grep -o "was not opened: .*"'
run 'paint cube.obj >inside.txt && paint net/models/cube.obj "--external any" | diff inside.txt -'

say "# without --color mesh nothing of it is looked at"
run 'voxmend voxelize absolute.obj -o c.npy -q -r 8'

say "# threads"
for threads in 1 2 7; do
  voxmend voxelize half.obj -o t$threads.npy -q -r 40 --color mesh --color-average --threads $threads
done
run 'cmp t1.npy t2.npy && cmp t1.npy t7.npy'
finish
