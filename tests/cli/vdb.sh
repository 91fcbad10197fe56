#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# .vdb files from the command line. Without the module they are refused by a line that tells what to install.
. "$SRCDIR/tests/cli/lib.sh"
if [ ! -e "$VOXMEND_MODULES/voxmend-openvdb.so" ]; then
  "$VOXMEND" voxelize in/cube.off -o x.vdb 2>told.txt && exit 1
  grep -q 'writing .vdb files needs .*configure --with-openvdb; Debian: libopenvdb-dev' told.txt && [ ! -e x.vdb ] || exit 1
  echo "built without OpenVDB"
  exit 77
fi
run 'voxmend voxelize in/torus.off -o t.npy -r 24 -q'
run 'voxmend voxelize in/torus.off -o t.vdb -r 24'
run 'voxmend compare t.vdb t.npy'
run 'voxmend convert t.vdb -o back.npy -q && cmp back.npy t.npy && cmp back.npy.json t.npy.json'
run 'voxmend convert t.npy -o again.vdb -q && cmp again.vdb t.vdb'
run 'voxmend voxelize in/torus.off -o sparse.vdb -r 24 --sparse -q && cmp sparse.vdb t.vdb'
run 'voxmend voxelize in/torus.off -o one.vdb -r 24 --threads 1 -q && cmp one.vdb t.vdb'
run 'voxmend convert t.vdb -o - --format vdb -q | voxmend compare - t.npy'
run 'voxmend voxelize in/sphere.off -o s.vdb --like t.vdb -q && voxmend compare s.vdb t.vdb --json'
run 'voxmend voxelize in/torus.off -o x.vdb -r 24 --sparse --dry-run'

say "# a number per voxel"
run 'voxmend voxelize in/sphere.off -o d.vdb -r 24 --pad 4 --distance signed --json | grep -A 6 distance'
run 'voxmend voxelize in/sphere.off -o solid.npy -r 24 --pad 4 -q && voxmend compare d.vdb solid.npy --below 0'
run 'voxmend convert d.vdb -o d.npy && voxmend convert d.npy -o d2.vdb -q && cmp d2.vdb d.vdb'
run 'voxmend convert d.vdb -o d.rle'
run 'voxmend voxelize in/sphere.off -o c.vdb -r 24 --pad 4 --coverage 4'
run 'voxmend compare c.vdb solid.npy --threshold 0.5'
run 'voxmend voxelize in/sphere.off -o l.npy -r 24 --labels part -q && voxmend convert l.npy -o l.vdb && voxmend convert l.vdb -o l2.npy -q && cmp l2.npy l.npy && cmp l2.npy.json l.npy.json'
run 'voxmend voxelize in/sphere.off -o u.vdb -r 24 --distance unsigned -q && voxmend convert u.vdb -o u.rle --below 0.5'
run 'voxmend voxelize in/sphere.off -o x.vdb -r 24 --coverage 2 --scalar uint8'

say "# failures leave nothing"
mkdir out
head -c 3000 t.vdb >cut.vdb
run 'voxmend convert cut.vdb -o out/x.npy'
cp t.vdb bad.vdb
printf '\377\377\0\0' | dd of=bad.vdb bs=1 seek=61 conv=notrunc 2>dd.log
run 'voxmend convert bad.vdb -o out/x.npy'
run 'voxmend voxelize in/cube.off -o out/x.vdb -r 20 --memlimit 400K'
run 'voxmend voxelize in/cube.off -o out/x.vdb -r 20 --bounds 0,0,0,1e-5,1e-5,1e-5'
run 'voxmend voxelize in/cube.off -o no/such/x.vdb -r 20 -q'
run 'ls out'
finish

# Pictures, where the library can draw.
if "$VOXMEND" view t.npy -o npy.png -q 2>told.txt; then
  "$VOXMEND" view t.vdb -o vdb.png -q
  cmp npy.png vdb.png
fi

# ---- What OpenVDB itself says, where its tools are ----
command -v vdb_print >/dev/null || exit 0
check() {
  vdb_print -l "$1" >told.txt
  shift
  for line; do
    grep -qE -e "$line" told.txt || {
      echo "FAILED: no '$line' in:"
      cat told.txt
      exit 1
    }
  done
}
"$VOXMEND" voxelize in/cube.off -o box.vdb -r 10x20x40 --bounds -1,-1,-1,1.5,4,9 -q
check box.vdb 'Type: Tree_bool_5_4_3' 'Name: solid' 'voxel size: \(?0\.25' 'Number of active voxels: +64$' \
  'Bounding box of active voxels: \[4, 4, 4\] -> \[7, 7, 7\]' 'voxmend_dims: \[10, 20, 40\]' '-0\.875, -0\.875, -0\.875, 1'
check d.vdb 'class: level set' 'Name: distance' 'Type: Tree_float_5_4_3' 'Background value: 0\.37'
check c.vdb 'class: fog volume' 'Name: coverage' 'Background value: 0$'
