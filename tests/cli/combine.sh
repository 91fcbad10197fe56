#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend combine: the four operations against the bytes of the files, chains, formats, and what does not fit together.
. "$SRCDIR/tests/cli/lib.sh"
voxmend voxelize in/sphere.off -o a.npy -r 70x33x41 --fit cube -q
voxmend voxelize in/torus.off -o b.npy --like a.npy -q
voxmend voxelize in/cube.off -o c.binvox -r 16 -q
voxmend voxelize in/cube.off -o other.npy -r 70x33x40 -q
voxmend voxelize in/cube.off -o moved.npy -r 70x33x41 --bounds 1,1,1,2,2,2 -q
voxmend voxelize in/cube.off -o distance.npy --distance signed --like a.npy -q

run 'voxmend combine a.npy or b.npy -o or.npy'
for operation in and minus xor; do
  run "voxmend combine a.npy $operation b.npy -o $operation.npy -q"
done
if command -v python3 >/dev/null; then
  python3 - <<'END' || { echo "FAILED: other voxels than the bytes of the files give"; exit 1; }
import operator
def read(name):
    data = open(name, "rb").read()
    assert data[:6] == b"\x93NUMPY" and b"'|b1'" in data[:128] or b"'|u1'" in data[:128], data[:128]
    return data[10 + int.from_bytes(data[8:10], "little"):]
a, b = read("a.npy"), read("b.npy")
assert len(a) == 70 * 33 * 41 and 0 < sum(a) != sum(b) > 0
for name, function in [("or", operator.or_), ("and", operator.and_), ("xor", operator.xor), ("minus", lambda x, y: x & (1 - y))]:
    assert read(name + ".npy") == bytes(map(function, a, b)), name
END
fi
run 'voxmend combine a.npy minus b.npy or and.npy and a.npy -o a2.npy -q && voxmend compare a.npy a2.npy | tail -n 3'
run 'voxmend combine a.npy xor a.npy -o none.binvox'
run 'voxmend combine c.binvox or c.binvox -o c.obj -q && voxmend info c.obj | grep -E "closed|volume"'
run 'voxmend combine c.binvox or c.binvox -o c.obj'
run 'voxmend combine c.binvox or c.binvox -o c.obj --force -q'
run 'voxmend combine a.npy and distance.npy --below 0 -o inside.npy --json'
run 'voxmend combine - or c.binvox -o - --format binvox <c.binvox 2>err | cmp - c.binvox; cat err'

say "# octrees"
voxmend convert a.npy -o a.octree -q
voxmend convert b.npy -o b.octree -q
run 'voxmend combine a.octree or b.octree -o or.octree'
for operation in or and minus xor; do
  run "voxmend combine a.octree $operation b.npy -o x.rle --sparse -q && voxmend compare x.rle $operation.npy -q --strict && rm x.rle"
done
run 'voxmend combine a.octree minus b.octree or and.npy and a.octree -o a2.octree -q && cmp a2.octree a.octree'
run 'voxmend combine a.npy and distance.npy --below 0 -o inside.octree -q && voxmend compare inside.octree inside.npy -q --strict'
run 'voxmend combine a.octree or other.npy -o x.octree'
run 'voxmend combine a.octree or distance.npy -o x.octree'
run 'voxmend combine a.octree or b.octree -o x.stl --sparse'

say "# what does not go"
run 'voxmend combine a.npy or other.npy -o x.npy'
run 'voxmend combine a.npy or moved.npy -o x.npy'
cp b.npy shifted.npy
sed 's/-2.12121[0-9]*/5/' b.npy.json >shifted.npy.json
run 'voxmend combine a.npy or shifted.npy -o x.npy'
run 'voxmend combine a.npy or distance.npy -o x.npy'
run 'voxmend combine a.npy or missing.npy -o x.npy'
run 'voxmend combine a.npy b.npy -o x.npy'
run 'voxmend combine a.npy or -o x.npy'
run 'voxmend combine a.npy nor b.npy -o x.npy'
run 'voxmend combine - or - -o x.npy <a.npy'
run 'voxmend compare - - <a.npy'
run 'voxmend combine a.npy or b.npy'
run 'voxmend combine a.npy or b.npy -o a.npy'
run 'voxmend combine a.npy or b.npy -o x.dwg'
run 'voxmend combine in or b.npy -o x.npy'
run 'ls x*'
finish
